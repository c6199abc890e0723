"""A session of each tool: at its default effort, judged by its own rule; the parts of the evidence are made of these.

A session puts every contestant of the plug-in beside the reference in every scenario. What the tools themselves say is
taken: pyperf's `compare_to`, pytest-benchmark's `--benchmark-compare-fail`, the t-test that comes with hyperfine.
"""

import json
import os
import re
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from datetime import UTC, datetime
from functools import partial
from importlib.metadata import version
from math import hypot
from pathlib import Path
from typing import Any, NamedTuple

from tests.measuring.busy import busy
from tests.measuring.injected import FEW, NAMES, REFERENCE, SHARES
from tests.measuring.record import Comparison, Part
from tests.measuring.workload import MODEL, ROOT, TETS, environment
from tetrabench.bench.environment import cpu_ticks, describe_environment
from tetrabench.bench.record import Results, read_results
from tetrabench.bench.statistics import Row, launch_ratios, summary


class Session(NamedTuple):
    """What a tool found, and how."""

    rule: str
    version: str
    command: list[str]
    comparisons: list[Comparison]
    sides: int
    controls: list[Comparison] = []
    facts: Mapping[str, Any] = {}


Tool = Callable[[int, Path, bool], Session]
"""tool(seed, folder for its files, tiny): `tiny` makes as little as it can, to try it out."""


def measure(part: str, tool: str, seed: int, folder: Path, *, tiny: bool) -> Part:
    """A session on a busy machine."""
    begun, start, ticks = datetime.now(UTC).isoformat(timespec="seconds"), time.monotonic(), cpu_ticks()
    folder.mkdir(parents=True, exist_ok=True)
    with busy(seed):
        session = TOOLS[tool](seed, folder, tiny)
    seconds = time.monotonic() - start
    stolen, passed = (b - a for a, b in zip(ticks or (0, 0), cpu_ticks() or (0, 0), strict=True))
    return Part(
        part=part,
        tool=tool,
        version=session.version,
        rule=session.rule,
        command=session.command,
        seed=seed,
        begun=begun,
        seconds=round(seconds, 1),
        side_s=round(seconds / session.sides, 2),
        load_1_minute=round(os.getloadavg()[0], 2),
        steal_share=round(stolen / passed, 4) if passed else None,
        environment=describe_environment(),
        comparisons=session.comparisons,
        controls=session.controls,
        facts=dict(session.facts),
    )


def call(command: list[str], ok: tuple[int, ...] = (0,), **variables: str) -> "subprocess.CompletedProcess[str]":
    """Run a command and take what it says.

    Raises:
        RuntimeError: its exit code is none of those that are `ok`.
    """
    done = subprocess.run(command, cwd=ROOT, env={**environment(), **variables}, capture_output=True, text=True)
    if done.returncode not in ok:
        raise RuntimeError(f"{' '.join(command)}: exit code {done.returncode}\n{done.stdout}\n{done.stderr}")
    return done


def spoken(command: list[str]) -> str:
    """A command as a person types it."""
    return " ".join(["python" if word == sys.executable else word for word in command]).replace(f"{ROOT}/", "")


def by_tetrabench(
    seed: int, folder: Path, tiny: bool, *, backends: Sequence[str] = (), names: Sequence[str] = NAMES
) -> Session:
    """`tetrabench run`: all contestants in one ring."""
    file = folder / "results.json"
    chosen = ["--backend", ",".join(backends)] if backends else []
    command = [sys.executable, "-m", "tetrabench", "run", "--model", MODEL, "--tets", f"{TETS // 1000}k"]
    command += ["--family", "injected", *chosen, "--scenario", ",".join(names), "--seed", str(seed)]
    command += [*(["--quick"] if tiny else []), "-o", str(file)]
    call(command)
    results = read_results(file)
    rows = summary(results)
    wrong = [
        f"{row.task} on {row.backend}: {row.verdict}" for row in rows if row.ratio is None and not is_reference(row)
    ]
    if wrong:
        raise RuntimeError(f"{file}: cells that did not end well: {wrong}")
    return Session(
        rule="the verdict of `tetrabench run`: the interval over launches, 95 % for all contestants of a scenario together",
        version=version("tetrabench"),
        command=[f"PYTHONPATH=.:tests/measuring/plugin {spoken(command)}".replace(str(folder), "out")],
        comparisons=[_judged(row, results) for row in rows if not row.control and not is_reference(row)],
        sides=len({row.backend for row in rows}) * len(names),
        controls=[_judged(row, results) for row in rows if row.control],
        facts={
            "launches": results.effort.launches,
            "rounds": results.effort.rounds,
            "elapsed_s": round(results.elapsed_s, 1),
            "doubted": sum(row.verdict == "inconclusive" and bool(row.reason) for row in rows),
        },
    )


def is_reference(row: Row) -> bool:
    """Whether a row is that of what all others are compared with."""
    return row.backend == row.against


def _judged(row: Row, results: Results) -> Comparison:
    assert row.ratio is not None
    cell = {
        name: [s for s in results.samples if (s.model, s.task, s.backend) == (row.model, row.task, name)]
        for name in (row.backend, row.against)
    }
    launches = launch_ratios(cell[row.backend], cell[row.against], row.clock)
    return Comparison(
        scenario=row.task,
        contestant=row.backend,
        injected=SHARES.get(row.backend, 0.0),
        ratio=round(row.ratio, 4),
        low=None if row.low is None else round(row.low, 4),
        high=None if row.high is None else round(row.high, 4),
        verdict=row.verdict,
        launches=[round(ratio, 4) for ratio in launches.values()],
    )


def by_pyperf(seed: int, folder: Path, tiny: bool) -> Session:
    """pyperf: a suite for each contestant, then `pyperf compare_to`."""
    import pyperf

    files = {name: folder / f"{name}.json" for name in SHARES}
    commands = []
    for name, file in files.items():
        file.unlink(missing_ok=True)
        kept = "PYTHONPATH,TETRABENCH_CACHE,NUMBA_NUM_THREADS"
        command = [sys.executable, "tests/measuring/pyperf_script.py", "--contestant", name, "--quiet"]
        command += ["--inherit-environ", kept, *(["-p", "2", "-n", "2"] if tiny else []), "-o", str(file)]
        call(command)
        commands.append(spoken(command).replace(str(folder), "out"))
    suites = {
        name: {one.get_name(): one.mean() for one in pyperf.BenchmarkSuite.load(str(file)).get_benchmarks()}
        for name, file in files.items()
    }
    comparisons = []
    for contestant in COMPARED:
        command = [sys.executable, "-m", "pyperf", "compare_to", str(files[REFERENCE]), str(files[contestant])]
        said = call(command).stdout
        for name in FEW:
            ratio = suites[contestant][name] / suites[REFERENCE][name]
            comparisons.append(_compared(name, contestant, ratio, said_by_pyperf(said, name)))
    return Session(
        rule="`pyperf compare_to` (Student's t-test, all values, two-tailed, 95 %): slower or faster, else not significant",
        version=version("pyperf"),
        command=[commands[0], spoken(command).replace(str(folder), "out")],
        comparisons=comparisons,
        sides=len(SHARES) * len(FEW),
    )


def said_by_pyperf(text: str, name: str) -> str:
    """What `pyperf compare_to` says about a benchmark: "slower", "faster", "not significant".

    Raises:
        ValueError: it says nothing about it.
    """
    if match := re.search(rf"^{name}: Mean .*: (?:[\d.]+x (slower|faster)|no change)$", text, re.MULTILINE):
        return match[1] or "not significant"
    if re.search(rf"^Benchmark hidden because not significant .*\b{name}\b", text, re.MULTILINE):
        return "not significant"
    raise ValueError(f"pyperf says nothing about {name}:\n{text}")


COMPARED = [name for name in SHARES if name != REFERENCE]

FAILS = ("min:5%", "median:10%")
"""The example of pytest-benchmark's help, and what is milder to noise. Each is a row of its own."""


def by_pytest_benchmark(seed: int, folder: Path, tiny: bool) -> Session:
    """pytest-benchmark: the reference saved, then each contestant compared with it."""
    test = ["tests/measuring/pytest_benchmark_file.py"]
    command = [sys.executable, "-m", "pytest", "-q", "--noconftest", "-c", os.devnull, "--rootdir", str(ROOT), *test]
    command += ["-p", "no:cacheprovider", *(["--benchmark-max-time", "0.05"] if tiny else [])]
    command += ["--benchmark-storage", f"file://{folder}/saved-{os.getpid()}"]
    save_it = [*command, "--benchmark-save", REFERENCE, "--benchmark-json", str(folder / "base.json")]
    call(save_it, CONTESTANT=REFERENCE)
    base = _pytest_stats(folder / "base.json")
    comparisons = []
    for contestant in COMPARED:
        file = folder / f"{contestant}.json"
        compare = [*command, "--benchmark-compare", "0001"]
        compare += ["--benchmark-compare-fail", *FAILS]
        done = call([*compare, "--benchmark-json", str(file)], ok=(0, 1), CONTESTANT=contestant)  # 1: slower
        stats = _pytest_stats(file)
        for name in NAMES:
            for fail in FAILS:
                field = fail.partition(":")[0]
                verdict = said_by_pytest_benchmark(done.stdout + done.stderr, name, fail)
                ratio = stats[name][field] / base[name][field]
                comparisons.append(_compared(name, contestant, ratio, verdict, by=fail))
    return Session(
        rule="`--benchmark-compare-fail`: the run fails where the figure is above that of the saved run by more than this",
        version=version("pytest-benchmark"),
        command=[spoken(one).replace(str(folder), "out") for one in (save_it, compare)],
        comparisons=comparisons,
        sides=len(SHARES) * len(NAMES),
    )


def _pytest_stats(file: Path) -> dict[str, dict[str, float]]:
    """Seconds of each scenario: its min, median, ..."""
    return {one["params"]["name"]: one["stats"] for one in json.loads(file.read_text())["benchmarks"]}


def said_by_pytest_benchmark(text: str, name: str, fail: str) -> str:
    """What a rule such as "min:5%" made of a test: "slower" or "not slower"."""
    field, share = fail.removesuffix("%").split(":")
    pattern = (
        rf"test_workload\[{name}\].* - Field '{field}' has failed PercentageRegressionCheck: .* > {float(share):.9f}"
    )
    return "slower" if re.search(pattern, text) else "not slower"


def by_hyperfine(seed: int, folder: Path, tiny: bool) -> Session:
    """hyperfine: one call a scenario with all commands, then the t-test of its scripts/welch_ttest.py for each pair."""
    from scipy.stats import ttest_ind

    comparisons = []
    for name in NAMES:
        file = folder / f"{name}.json"
        words = {one: f"{sys.executable} -m tests.measuring.workload {name} {one}" for one in SHARES}
        command = ["hyperfine", "--style", "none", *(["--runs", "2"] if tiny else [])]
        command += ["--export-json", str(file), *words.values()]
        call(command)
        found = {one["command"]: one for one in json.loads(file.read_text())["results"]}
        base = found[words[REFERENCE]]
        for contestant in COMPARED:
            other = found[words[contestant]]
            ratio = other["mean"] / base["mean"]
            around = ratio * hypot(other["stddev"] / other["mean"], base["stddev"] / base["mean"])
            p = ttest_ind(base["times"], other["times"], equal_var=False).pvalue
            verdict = ("slower" if ratio > 1 else "faster") if p < 0.05 else "almost the same"
            comparisons.append(_compared(name, contestant, ratio, verdict, ratio - around, ratio + around))
    return Session(
        rule="scripts/welch_ttest.py of hyperfine (Welch's t-test, p < 0.05): there is a difference, or almost the same",
        version=call(["hyperfine", "--version"]).stdout.split()[-1],
        command=[spoken(command[:4]) + " out/NAME.json " + " ".join(f"'{spoken([w])}'" for w in words.values())],
        comparisons=comparisons,
        sides=len(SHARES) * len(NAMES),
    )


def _compared(
    name: str,
    contestant: str,
    ratio: float,
    verdict: str,
    low: float | None = None,
    high: float | None = None,
    by: str = "",
) -> Comparison:
    return Comparison(
        scenario=name,
        contestant=contestant,
        injected=SHARES[contestant],
        ratio=round(ratio, 4),
        low=None if low is None else round(low, 4),
        high=None if high is None else round(high, 4),
        verdict=verdict,
        by=by,
    )


TOOLS: dict[str, Tool] = {
    "tetrabench": by_tetrabench,
    "pyperf": by_pyperf,
    "pytest-benchmark": by_pytest_benchmark,
    "hyperfine": by_hyperfine,
    "pair": partial(by_tetrabench, backends=[REFERENCE, "slower-10"], names=["alfa"]),
}
"""`pair`: what it costs tetrabench to compare two, and no more."""
