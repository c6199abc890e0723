"""What a kernel of one's own costs: docs/examples/own_kernel.py beside the scenario alfa, on the same net.

    python results/library.py [--tets 120k,640k] [--backend v3y,v5y,v4,halfface] [--turns 61] [-o results/library-speed.json]

Both sweep over one net in one process, in turn, the order alternating; a sample is the CPU time of so many sweeps as take
a tenth of a second, about. A row holds the medians, the median of the paired ratios own / scenario, and an interval that
holds it with 95 % (sign test). The bar is met where all of the interval is within 5 % of 1, either way. First the answers
are compared, bit for bit, which compiles everything, too.
"""

import argparse
import json
import sys
from collections.abc import Callable
from pathlib import Path
from statistics import median
from typing import Any

RESULTS = Path(__file__).parent
EXAMPLES = RESULTS.parent / "docs" / "examples"
SPEED = RESULTS / "library-speed.json"
APART = 1.05
"""How many times as long the one may take as the other."""
SAMPLE_S = 0.1


def compare(net: Any, turns: int) -> dict[str, Any]:
    """The row of a net: its sweeps a sample, median seconds of both, ratio, interval, whether it meets the bar.

    Raises:
        ValueError: the answers differ.
    """
    sys.path.insert(0, str(EXAMPLES))
    from own_kernel import smooth

    from tetrabench.bench.clock import read_clocks
    from tetrabench.bench.pairs import in_turn, paired_ratio
    from tetrabench.scenarios.tetra.alfa import Alfa, Averaging

    def timed(task: Callable[[], None]) -> float:
        begin = read_clocks()
        task()
        return read_clocks().since(begin).process_cpu_s

    def scenario() -> None:
        Alfa().run(Averaging(net, sweeps))

    def own() -> None:
        smooth(net.storage, sweeps)

    sweeps, states = 1, net.states
    answers = []
    for task in (scenario, own):
        net.states = states
        task()
        answers.append(net.answer().digest)
    if answers[0] != answers[1]:
        raise ValueError(f"{net}: the own kernel and the scenario give different answers")
    sweeps = max(1, round(SAMPLE_S / max(timed(scenario), 1e-6)))
    pairs = list(in_turn(turns, lambda: timed(own), lambda: timed(scenario)))
    own_s, scenario_s = zip(*pairs, strict=True)
    ratio, low, high = paired_ratio(own_s, scenario_s)
    return {
        "backend": net.contestant.name,
        "tets": len(net),
        "sweeps": sweeps,
        "own_s": median(own_s),
        "scenario_s": median(scenario_s),
        "ratio": ratio,
        "low": low,
        "high": high,
        "met": is_met(low, high),
        "pairs_s": pairs,
    }


def is_met(low: float, high: float) -> bool:
    """Whether an interval is within the bounds."""
    return low >= 1 / APART and high <= APART


def verdict(row: dict[str, Any]) -> str:
    """Whether a row meets the bar: an interval that is neither within the bounds nor outside cannot tell."""
    if row["met"]:
        return "met"
    return "**missed**" if row["low"] > APART or row["high"] < 1 / APART else "cannot tell"


def table(path: Path = SPEED) -> list[list[str]]:
    """The table of docs/library.md, as its cells."""
    lines = [["tetras", "storage", "own, ns a tetra", "scenario", "ratio", "95 %", ""], ["---:", "---"] + ["---:"] * 4]
    lines[1].append("---")
    for row in json.loads(path.read_text())["rows"]:
        visits = row["tets"] * row["sweeps"]
        times = [f"{1e9 * row[side] / visits:.2f}" for side in ("own_s", "scenario_s")]
        figures = [f"{row['ratio']:.3f}", f"{row['low']:.3f} to {row['high']:.3f}"]
        lines.append([f"{row['tets']:,}", row["backend"], *times, *figures, verdict(row)])
    return lines


def main() -> None:
    """Do what the command line says."""
    import numpy as np

    import tetrabench
    from tetrabench.bench.environment import describe_environment

    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tets", default="120k,640k")
    parser.add_argument("--backend", default="v3y,v5y,v4,halfface")
    parser.add_argument("--turns", type=int, default=61)
    parser.add_argument("-o", "--output", type=Path, default=SPEED)
    options = parser.parse_args()

    rows = []
    for size in options.tets.split(","):
        mesh = tetrabench.generate("nozzle", int(size.replace("k", "000")))
        states = np.random.default_rng(1).uniform(0, 1, (len(mesh.tets), 5))
        for backend in options.backend.split(","):
            with tetrabench.open(mesh, backend=backend) as net:
                net.states = states
                rows.append(compare(net, options.turns))
            row = rows[-1]
            print(f"{row['tets']:,} {backend}: {row['ratio']:.3f} [{row['low']:.3f}, {row['high']:.3f}]", flush=True)
    command = " ".join(["python", "results/library.py", *sys.argv[1:]])
    document = {"command": command, "environment": describe_environment(), "bar": APART, "rows": rows}
    options.output.write_text(json.dumps(document, indent=1) + "\n")


if __name__ == "__main__":
    main()
