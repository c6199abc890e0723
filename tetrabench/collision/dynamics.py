"""How objects move: written once, outside of all structures, so that all must lead to the same places, bit by bit.

A step is: the structure follows the objects; all pairs in contact, in the order of their numbers; velocities after contact;
gravity; walls; move. Source: chapters 2 and 4, of which the order of contacts differs, for there it was that of the leaves.

Contacts, as the source has them (`is_full` False): one hit an object and step, the first in order; both velocities are
turned about that of the centre of mass, v' = 2 v_cm - v. That keeps energy and momentum, and turns round what is tangential,
too. With `is_full`: all pairs that approach, one after the other, exchange momentum along the line of their centres
alone, as smooth discs do; those whose centres coincide, or all but do (NEAREST), have no such line, and pass.

A wall turns round what is outside of it and moves outward, times `bounce`; nothing is put back.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.collision.interface import Pairs, Storage, pairs, update
from tetrabench.collision.objects import Objects
from tetrabench.jit import kernel
from tetrabench.jit.clock import thread_time

PHASES = ("update", "pairs", "respond", "move")
"""Of a step: the structure follows, it finds the pairs, velocities after contact, all else."""
UPDATE, PAIRS, RESPOND, MOVE = range(4)

BITS = 11
"""Of a digit when pairs are put in order: the counts of 2,048 stay in the first cache."""

NEAREST = 1e-280
"""The least square of a distance that has a direction: what is smaller, or its parts, are not exact any more."""


class Rules(NamedTuple):
    """What holds in a box.

    gravity: change of the velocity in y in a step, downward; bounce: what a wall leaves of a velocity, 0 to 1;
    width, height: of the box; is_full: see above.
    """

    gravity: float
    bounce: float
    width: float
    height: float
    is_full: bool


class Desk(NamedTuple):
    """Where a step does its work. found, spare: (room, 2) int32, pairs; counts: (2^BITS,) int64; hit: (n,) bool, all False."""

    found: Pairs
    spare: Pairs
    counts: NDArray[np.int64]
    hit: NDArray[np.bool_]


def make_desk(objects: int) -> Desk:
    """A desk with room for a pair for every fourth object; it grows."""
    room = max(64, objects // 4)
    return Desk(
        np.empty((room, 2), np.int32),
        np.empty((room, 2), np.int32),
        np.empty(1 << BITS, np.int64),
        np.zeros(objects, np.bool_),
    )


@kernel
def advance(
    storage: Storage, objects: Objects, rules: Rules, desk: Desk, steps: int, seconds: NDArray[np.float64]
) -> tuple[Storage, Desk, int]:
    """Take steps.

    Args:
        storage: of the structure.
        objects: moved in place.
        rules, desk: see there.
        steps: how many.
        seconds: (4,) float64: CPU time of each of PHASES is added.

    Returns:
        storage and desk to go on with, and how many pairs the last step found.
    """
    found, spare, count = desk.found, desk.spare, 0
    for _ in range(steps):
        began = thread_time()
        storage = update(storage, objects.x, objects.y)
        updated = thread_time()
        count = pairs(storage, objects.x, objects.y, objects.r, found)
        while count > len(found):
            found, spare = room_for(count), room_for(count)
            count = pairs(storage, objects.x, objects.y, objects.r, found)
        searched = thread_time()
        put_in_order(found, spare, desk.counts, count, len(objects.x))
        if rules.is_full:
            exchange(objects, found, count)
        else:
            turn(objects, found, count, desk.hit)
        responded = thread_time()
        move(objects, rules)
        seconds[UPDATE] += updated - began
        seconds[PAIRS] += searched - updated
        seconds[RESPOND] += responded - searched
        seconds[MOVE] += thread_time() - responded
    return storage, Desk(found, spare, desk.counts, desk.hit), count


@kernel
def room_for(count: int) -> Pairs:
    """Room for so many pairs, and some more."""
    return np.empty((count + count // 4, 2), np.int32)


@kernel(allocates=False)
def put_in_order(found: Pairs, spare: Pairs, counts: NDArray[np.int64], count: int, objects: int) -> None:
    """Sort pairs by their first number, then by the second, in place: digit by digit from the last one (radix sort)."""
    if is_in_order(found, count):
        return
    digits = 1
    while objects >> (BITS * digits):
        digits += 1
    is_spare = False
    for column in (1, 0):
        for digit in range(digits):
            if is_spare:
                sort_by(spare, found, counts, count, column, BITS * digit)
            else:
                sort_by(found, spare, counts, count, column, BITS * digit)
            is_spare = not is_spare
    # two columns: the last of an even number of sorts went into `found`


@kernel(allocates=False)
def is_in_order(found: Pairs, count: int) -> bool:
    """Whether they are sorted already."""
    for k in range(1, count):
        if found[k, 0] < found[k - 1, 0] or (found[k, 0] == found[k - 1, 0] and found[k, 1] < found[k - 1, 1]):
            return False
    return True


@kernel(allocates=False)
def sort_by(found: Pairs, spare: Pairs, counts: NDArray[np.int64], count: int, column: int, shift: int) -> None:
    """Put pairs into `spare` by one digit of a column, those alike as they were."""
    mask = len(counts) - 1
    for digit in range(len(counts)):
        counts[digit] = 0
    for k in range(count):
        counts[(found[k, column] >> shift) & mask] += 1
    total: Any = 0
    for digit in range(len(counts)):
        here = counts[digit]
        counts[digit] = total
        total += here
    for k in range(count):
        digit = (found[k, column] >> shift) & mask
        spare[counts[digit], 0] = found[k, 0]
        spare[counts[digit], 1] = found[k, 1]
        counts[digit] += 1


@kernel(allocates=False)
def turn(objects: Objects, found: Pairs, count: int, hit: NDArray[np.bool_]) -> None:
    """The source's contacts: one an object, v' = 2 v_cm - v."""
    vx, vy, m = objects.vx, objects.vy, objects.m
    for k in range(count):
        i, j = found[k, 0], found[k, 1]
        if hit[i] or hit[j]:
            continue
        hit[i] = hit[j] = True
        total = m[i] + m[j]
        twice_x = 2 * (m[i] * vx[i] + m[j] * vx[j]) / total
        twice_y = 2 * (m[i] * vy[i] + m[j] * vy[j]) / total
        vx[i], vx[j] = twice_x - vx[i], twice_x - vx[j]
        vy[i], vy[j] = twice_y - vy[i], twice_y - vy[j]
    for k in range(count):
        hit[found[k, 0]] = hit[found[k, 1]] = False


@kernel(allocates=False)
def exchange(objects: Objects, found: Pairs, count: int) -> None:
    """Smooth discs: all pairs that approach, momentum along the line of centres."""
    x, y, vx, vy, m = objects.x, objects.y, objects.vx, objects.vy, objects.m
    for k in range(count):
        i, j = found[k, 0], found[k, 1]
        dx, dy = x[j] - x[i], y[j] - y[i]
        approach = (vx[j] - vx[i]) * dx + (vy[j] - vy[i]) * dy
        square = dx * dx + dy * dy
        if approach < 0 and square > NEAREST:
            share = 2 * approach / (square * (m[i] + m[j]))
            vx[i] += share * m[j] * dx
            vy[i] += share * m[j] * dy
            vx[j] -= share * m[i] * dx
            vy[j] -= share * m[i] * dy


@kernel(allocates=False)
def move(objects: Objects, rules: Rules) -> None:
    """Gravity, walls, and a step along the velocity."""
    x, y, vx, vy = objects.x, objects.y, objects.vx, objects.vy
    for i in range(len(x)):
        u, v = vx[i], vy[i] - rules.gravity
        if (x[i] > rules.width and u > 0) or (x[i] < 0 and u < 0):
            u *= -rules.bounce
        if (y[i] > rules.height and v > 0) or (y[i] < 0 and v < 0):
            v *= -rules.bounce
        vx[i], vy[i] = u, v
        x[i] += u
        y[i] += v
