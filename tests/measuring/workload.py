"""What the other tools measure: a scenario of the plug-in, same storage and model, as callables and as a command.

python -m tests.measuring.workload SCENARIO CONTESTANT      the command line that hyperfine times
"""

import argparse
import os
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

from tests.measuring.injected import NAMES, REFERENCE, SHARES, burn
from tetrabench import registry

ROOT = Path(__file__).parents[2]
PLUGIN = Path(__file__).with_name("plugin")

MODEL, TETS = "nozzle", 30_000
REPEATS = 10
"""Runs in one command, so that the workload is a good part of what the command takes."""


class Workload(NamedTuple):
    """prepare() makes what run(subject) works on."""

    prepare: Callable[[], Any]
    run: Callable[[Any], Any]


def workload(name: str, contestant: str) -> Workload:
    """A scenario on a contestant; its kernels are compiled, its net is built."""
    family = registry.family("injected")
    model = family.find_model(MODEL, size=TETS, numbering="natural", seed=0)
    stage = family.stage(registry.contestant("injected", contestant), model, chained=False)
    scenario = registry.scenario("injected", name)
    made = Workload(partial(scenario.prepare, stage, scenario.options), scenario.run)
    made.run(made.prepare())
    return made


def environment() -> dict[str, str]:
    """Variables that tools and their children need: the plug-in, and one thread."""
    path = os.pathsep.join([str(PLUGIN), str(ROOT), *filter(None, [os.environ.get("PYTHONPATH")])])
    return {**os.environ, "PYTHONPATH": path, "NUMBA_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}


def main() -> None:
    """Run a workload some times; a slowed contestant then burns its share of the whole command's CPU time."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("scenario", choices=NAMES)
    parser.add_argument("contestant", choices=SHARES)
    options = parser.parse_args()
    made = workload(options.scenario, REFERENCE)
    for _ in range(REPEATS):
        made.run(made.prepare())
    burn(time.thread_time() + SHARES[options.contestant] * time.process_time())


if __name__ == "__main__":
    main()
