"""The workloads as pyperf's users write them: one script, a benchmark a scenario, in processes of its own each.

python tests/measuring/pyperf_script.py --contestant v3y --inherit-environ PYTHONPATH,TETRABENCH_CACHE -o v3y.json
"""

import functools
from time import perf_counter
from typing import Any

import pyperf

from tests.measuring.injected import FEW, SHARES
from tests.measuring.workload import workload

prepared = functools.cache(workload)  # in the process that measures, at its first turn


def spent(loops: int, name: str, contestant: str) -> float:
    """Wall time of so many runs, seconds; what prepares them is not in it (pyperf's `bench_time_func`)."""
    made = prepared(name, contestant)
    total = 0.0
    for _ in range(loops):
        subject = made.prepare()
        begin = perf_counter()
        made.run(subject)
        total += perf_counter() - begin
    return total


def hand_on(command: list[str], options: Any) -> None:
    """The contestant, for the processes that pyperf starts."""
    command += ["--contestant", options.contestant]


if __name__ == "__main__":
    runner = pyperf.Runner(add_cmdline_args=hand_on)
    runner.argparser.add_argument("--contestant", choices=SHARES, required=True)
    contestant = runner.parse_args().contestant
    for name in FEW:
        runner.bench_time_func(name, spent, name, contestant)
