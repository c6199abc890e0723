"""A busy machine that can be had again: on each core a process that works and rests, for random but seeded times.

python -m tests.measuring.busy [--seed N]      until it is stopped
"""

import argparse
import os
import random
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np

from tetrabench.bench.environment import usable_cores

MEAN_S = 0.5
LONGEST_S = 3.0
"""Times of work and of rest: exponential with this mean, cut at this length. So each core is taken half of the time."""
ARRAY_BYTES = 32 * 2**20
"""More than a core's own caches hold."""


def disturb(core: int, seed: int) -> None:
    """Work and rest on one core until whoever asked for it is gone."""
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {core})
    chance = random.Random(f"{seed} {core}")
    parent = os.getppid()
    source = np.ones(ARRAY_BYTES // 8)
    target = np.empty_like(source)
    few = np.linspace(0.0, 1.0, 1000)
    while os.getppid() == parent:
        time.sleep(a_while(chance))
        end = time.monotonic() + a_while(chance)
        if chance.random() < 0.5:
            while time.monotonic() < end:
                np.copyto(target, source)
        else:
            while time.monotonic() < end:
                np.sin(few)


def a_while(chance: random.Random) -> float:
    """How long to work or to rest, seconds."""
    return min(chance.expovariate(1 / MEAN_S), LONGEST_S)


@contextmanager
def busy(seed: int) -> Iterator[None]:
    """The machine is busy as long as this lasts."""
    command = [sys.executable, "-m", "tests.measuring.busy", "--seed", str(seed), "--core"]
    loads = [subprocess.Popen([*command, str(core)]) for core in usable_cores()]
    try:
        yield
    finally:
        for load in loads:
            load.terminate()
        for load in loads:
            load.wait()


def main() -> None:
    """One core, or all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--core", type=int, help="this one alone")
    options = parser.parse_args()
    if options.core is not None:
        disturb(options.core, options.seed)
        return
    with busy(options.seed):
        threading.Event().wait()


if __name__ == "__main__":
    main()
