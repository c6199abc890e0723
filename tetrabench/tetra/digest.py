"""The answer of a net: one exact number that does not depend on how the net is stored, and sums for people.

The digest is the sum, modulo 2^64, over the live tetras of a mix of: the four vertex ids in rising order; behind the side
opposite each of them, in that order, the vertex ids of the neighbour (or that there is none); and the bits of volume and
states. A vertex id is the point's place in the file; inserted points follow in order of insertion. Nothing is rounded.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.jit.mix import SEED, mix, mixed_with
from tetrabench.protocols import Answer
from tetrabench.tetra.interface import (
    NONE,
    STATES,
    Net,
    first_tetra,
    neighbour,
    next_tetra,
    number_of_tetras,
    state,
    vertex,
    volume,
)
from tetrabench.tetra.points import COUNT

_NOBODY = np.uint64(0x5BD1E995)


def net_answer(net: Net) -> Answer:
    """Digest of a whole net, and its figures: tetras, points, volume, sides on the surface, sum, min and max of state 0."""
    sums = np.zeros(6)
    sums[4], sums[5] = np.inf, -np.inf
    total = np.zeros(1, np.uint64)
    with np.errstate(over="ignore"):  # 64 bits that wrap around are meant to, also with the JIT off
        _add_all(net, total, sums)
    figures: dict[str, int | float] = {
        "tetras": int(number_of_tetras(net)),
        "points": int(net.points.counters[COUNT]),
        "volume": float(sums[1]),
        "surface_sides": int(sums[2]),
        "state_sum": float(sums[3]),
        "state_min": float(sums[4]),
        "state_max": float(sums[5]),
    }
    if int(sums[0]) != figures["tetras"]:
        figures["tetras_visited"] = int(sums[0])
    return Answer(mixed_with(int(total[0]), figures["tetras"], figures["points"]), figures)


@kernel(allocates=False)
def mix_vertices(net: Net, t: int, h: Any) -> Any:
    """Mix the four vertex ids of tetra t, in rising order, into h."""
    a, b, c, d = vertex(net, t, 0), vertex(net, t, 1), vertex(net, t, 2), vertex(net, t, 3)
    a, b = min(a, b), max(a, b)
    c, d = min(c, d), max(c, d)
    a, c = min(a, c), max(a, c)
    b, d = min(b, d), max(b, d)
    b, c = min(b, c), max(b, c)
    h = mix(h ^ np.uint64(a))
    h = mix(h ^ np.uint64(b))
    h = mix(h ^ np.uint64(c))
    return mix(h ^ np.uint64(d))


@kernel
def _add_all(net: Net, total: Any, sums: Any) -> None:
    bits = np.empty(1)
    order = np.empty(4, np.int64)
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        t = cursor.tetra
        h = mix_vertices(net, t, np.uint64(SEED))
        for i in range(4):  # the sides in the order of their opposite vertex's id
            place = 0
            for j in range(4):
                place += int(vertex(net, t, j) < vertex(net, t, i))
            order[place] = i
        for place in range(4):
            u = neighbour(net, t, order[place])
            if u == NONE:
                h = mix(h ^ _NOBODY)
                sums[2] += 1.0
            else:
                h = mix_vertices(net, u, h)
        bits[0] = volume(net, t)
        h = mix(h ^ bits.view(np.uint64)[0])
        for k in range(STATES):
            bits[0] = state(net, t, k)
            h = mix(h ^ bits.view(np.uint64)[0])
        total[0] += h
        sums[0] += 1.0
        sums[1] += volume(net, t)
        value = state(net, t, 0)
        sums[3] += value
        sums[4], sums[5] = min(sums[4], value), max(sums[5], value)
        cursor = next_tetra(net, cursor)


def found_answer(net: Net, refs: NDArray[np.int64], **figures: int | float) -> Answer:
    """The answer to a list of questions: which tetra, by its vertices, for each place in `refs` (m,), -1 for none."""
    with np.errstate(over="ignore"):
        total = int(_add_found(net, refs))
    return Answer(mixed_with(total, len(refs)), {"found": int((refs != NONE).sum()), **figures})


@kernel
def _add_found(net: Net, refs: Any) -> Any:
    total = np.zeros(1, np.uint64)
    for q in range(len(refs)):
        h = mix(np.uint64(SEED) ^ np.uint64(q))
        total[0] += mix_vertices(net, refs[q], h) if refs[q] != NONE else mix(h ^ _NOBODY)
    return total[0]
