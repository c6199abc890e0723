"""What measuring costs: where the time of a run goes, and how much memory its parent takes."""

import os
import subprocess
import sys
import time
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

from tests.measuring.record import Part
from tests.measuring.tools import spoken
from tests.measuring.workload import ROOT, environment
from tetrabench.bench.environment import describe_environment
from tetrabench.bench.record import read_results
from tetrabench.jit import cache_root

RUNS = {
    "cost-10k": ["--model", "nozzle", "--tets", "10k"],
    "cost-120k": ["--model", "nozzle", "--tets", "120k", "--backend", "v3y,v4,v5y"],
    "cost-1M": ["--model", "nozzle", "--tets", "1M", "--quick", "--backend", "v3y,v4,v5y"],
}
"""Part -> what `tetrabench run` is told. The last two leave out the backends that take minutes for one sample."""

MODELS = {
    "cost-10k": "nozzle-10000-natural-0*.nas",
    "cost-120k": "nozzle-120000-natural-0*.nas",
    "cost-1M": "nozzle-1000000-natural-0*.nas",
}
"""Their files in the user's cache."""

OUTSIDE = ("starting", "yardsticks", "waiting")
"""Of `Launch.seconds`, what is neither sample, preparation nor compilation; and so is all that it does not name."""

LOOK_S = 0.02
"""How often to look at the parent."""


def measure(part: str, folder: Path, *, tiny: bool) -> Part:
    """A run, its model generated anew, on the machine as it is."""
    folder.mkdir(parents=True, exist_ok=True)
    file = folder / "results.json"
    file.unlink(missing_ok=True)
    chosen = ["--model", "box", "--tets", "2k", "--quick", "--scenario", "alfa"] if tiny else RUNS[part]
    if not tiny:  # generating the model is a part of the run
        for model in (cache_root() / "models").glob(MODELS[part]):
            model.unlink()
    command = [sys.executable, "-m", "tetrabench", "run", *chosen, "-o", str(file)]
    begun, start = datetime.now(UTC).isoformat(timespec="seconds"), time.monotonic()
    with (folder / "log").open("w") as log:
        parent = subprocess.Popen(command, cwd=ROOT, env=environment(), stdout=log, stderr=log)
        peak = 0
        while parent.poll() is None:
            peak = max(peak, high_water(parent.pid))
            time.sleep(LOOK_S)
    seconds = time.monotonic() - start
    if parent.returncode != 0:
        raise RuntimeError(f"{spoken(command)}: exit code {parent.returncode}, see {folder / 'log'}")
    results = read_results(file)
    spent: dict[str, float] = {}
    for launch in results.launches:
        for what, seconds_of_it in launch.seconds.items():
            spent[what] = spent.get(what, 0.0) + seconds_of_it
    return Part(
        part=part,
        tool="tetrabench",
        version=version("tetrabench"),
        command=[spoken(command).replace(str(folder), "out")],
        begun=begun,
        seconds=round(seconds, 1),
        load_1_minute=round(os.getloadavg()[0], 2),
        environment=describe_environment(),
        facts={
            "parent_peak_bytes": peak,
            "model_size": results.models[0].size,
            "backends": len(results.backends),
            "samples": len(results.samples),
            "spent_s": {what: round(value, 2) for what, value in spent.items()},
        },
    )


def high_water(pid: int) -> int:
    """VmHWM of a process, bytes: at most so much memory it had so far. 0 when it is gone."""
    try:
        lines = Path(f"/proc/{pid}/status").read_text().splitlines()
    except OSError:
        return 0
    return next((int(line.split()[1]) * 1024 for line in lines if line.startswith("VmHWM:")), 0)


def overhead(part: Part) -> float:
    """Share of the run's time that is neither sample, preparation nor compilation."""
    inside = sum(seconds for what, seconds in part.facts["spent_s"].items() if what not in OUTSIDE)
    return 1 - inside / part.seconds
