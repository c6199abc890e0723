"""What the machine can do, whatever is stored how: bandwidth of memory, and the latency of a step through it.

Copy and triad are those of STREAM (McCalpin 1995), counted as there: bytes that the program names, not those that the
caches add. The walk is that of lmbench (McVoy and Staelin 1996): each place holds the next one, in one random cycle
through all cache lines, so that no step can begin before the last has ended.
"""

import time
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.bench.record import Yardsticks
from tetrabench.jit import kernel

ARRAY_BYTES = 2**25
"""Of each array: more than the share of a last-level cache that one core has."""
LINE = 16  # int32 in a cache line of 64 bytes
STEPS = 400_000
REPEATS = 5


def measure_yardsticks(array_bytes: int = ARRAY_BYTES, steps: int = STEPS) -> Yardsticks:
    """Measure them on the core that this thread runs on, the best of REPEATS: by thread CPU time, in about a second.

    Args:
        array_bytes: of each of the three arrays; smaller ones for a test.
        steps: of the walk.
    """
    count = array_bytes // 8
    a, b, c = np.zeros(count), np.ones(count), np.full(count, 2.0)
    walk = random_cycle(array_bytes // 4)
    copy(a[:8], b[:8])  # compiles
    triad(a[:8], b[:8], c[:8])
    follow(walk, 1)
    copy_s = min(_seconds(copy, a, b) for _ in range(REPEATS))
    triad_s = min(_seconds(triad, a, b, c) for _ in range(REPEATS))
    follow_s = min(_seconds(follow, walk, steps) for _ in range(2))
    return Yardsticks(
        copy_gb_s=2 * array_bytes / copy_s / 1e9,
        triad_gb_s=3 * array_bytes / triad_s / 1e9,
        latency_ns=follow_s / steps * 1e9,
    )


def random_cycle(places: int) -> NDArray[np.int32]:
    """An array where each first place of a cache line holds that of another, in one cycle through all lines (Sattolo
    1986, as a random order of the lines).

    Args:
        places: length, int32.
    """
    order = np.random.default_rng(0).permutation(places // LINE).astype(np.int32) * np.int32(LINE)
    walk = np.zeros(places, np.int32)
    walk[order] = np.roll(order, -1)
    return walk


@kernel(allocates=False)
def copy(a: NDArray[np.float64], b: NDArray[np.float64]) -> None:
    """a = b."""
    for i in range(a.size):
        a[i] = b[i]


@kernel(allocates=False)
def triad(a: NDArray[np.float64], b: NDArray[np.float64], c: NDArray[np.float64]) -> None:
    """a = b + 3 c."""
    for i in range(a.size):
        a[i] = b[i] + 3.0 * c[i]


@kernel(allocates=False)
def follow(walk: NDArray[np.int32], steps: int) -> int:
    """Take so many steps; return the place reached."""
    place = np.int32(0)
    for _ in range(steps):
        place = walk[place]
    return int(place)


def _seconds(work: Any, *arguments: Any) -> float:
    begin = time.thread_time()
    work(*arguments)
    return time.thread_time() - begin
