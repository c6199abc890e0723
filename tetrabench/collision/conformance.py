"""What every structure for collisions must find, as rules that say what is wrong in words; anybody's has to pass them.

Each rule takes a contestant and yields sentences, which name the function of the interface and the situation; none where all
is well. Objects are moved by `twin.Twin`, which looks at all pairs; a structure follows them.
"""

import dataclasses
from collections.abc import Iterator, Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from tetrabench.collision import interface
from tetrabench.collision.contestant import CollisionContestant
from tetrabench.collision.interface import Storage
from tetrabench.collision.objects import Objects, Start, make_objects
from tetrabench.collision.simulation import _pairs, _query_rect, _update
from tetrabench.collision.twin import Twin
from tetrabench.jit.generic import lacks
from tetrabench.protocols import Rule

STEPS = 5
SIZE = 40
UNTOUCHED = -7
"""What lies in `out` before it is written to: the number of no object."""


def _start(x: ArrayLike, y: ArrayLike, r: ArrayLike = 3.0, *, speed: float = 2.0) -> Start:
    """Objects with velocities at random, in a square of 100."""
    rng, count = np.random.default_rng(1), np.size(x)
    vx, vy = speed * rng.uniform(-1, 1, (2, count))
    return Start(make_objects(x, y, vx, vy, r, 5.0), 100.0, 100.0)


def _starts() -> Mapping[str, Start]:
    """By what is special about them."""
    rng, numbers = np.random.default_rng(2), np.arange(SIZE)
    x, y = rng.uniform(0, 100, (2, SIZE))
    side = np.array([-1e9, -1e6, 0, 1e6, 1e9])
    return {
        "objects at random": _start(x, y),
        "objects in a corner": _start(0.05 * x, 0.05 * y, 0.2),
        "objects in one place": _start(np.full(SIZE, 30.0), np.full(SIZE, 40.0)),
        "objects in two places": _start(30.0 + 7 * (numbers % 2), np.full(SIZE, 40.0), speed=0.0),
        "circles that but touch": _start(4.0 * (numbers % 6), 4.0 * (numbers // 6), 2.0, speed=0.0),
        "objects far outside of the box": _start(x + side[numbers % 5], y + side[numbers // 5 % 5]),
        "one large object among small ones": _start(x, y, np.where(numbers == 7, 60.0, 0.5)),
        "coordinates that are powers of 2": _start(2.0 ** (numbers - 20), 2.0 ** (20 - numbers), 1.0),
        "objects at 0 and -0": _start(
            np.where(numbers % 3 == 0, -0.0, x - 50), np.where(numbers % 2 == 0, 0.0, y - 50)
        ),
        "no object": _start([], []),
        "one object": _start([50.0], [50.0]),
        "two objects": _start([50.0, 53.0], [50.0, 51.0]),
    }


class _Moving:
    """A structure, the objects that it follows, and their twin."""

    def __init__(self, contestant: CollisionContestant, start: Start) -> None:
        self.contestant = contestant
        self.twin = Twin(start, gravity=0.1, bounce=0.9)
        self.objects: Objects = Objects(*(column.copy() for column in start.objects))
        self.storage: Storage = contestant.make(self.objects.x, self.objects.y, self.objects.r)

    def move(self) -> None:
        """One step of the twin, which the structure follows."""
        self.twin.step()
        self.objects.x[:], self.objects.y[:] = self.twin.x, self.twin.y
        self.follow()

    def follow(self) -> None:
        """Call `update`."""
        self.storage = self.contestant.callable(_update)(self.storage, self.objects.x, self.objects.y)

    def pairs(self, room: int) -> tuple[int, list[tuple[int, int]], bool]:
        """What `pairs` returns, what it stores in so much room, and whether it wrote beyond."""
        out = np.full((room + 2, 2), UNTOUCHED, np.int32)
        o = self.objects
        count = int(self.contestant.callable(_pairs)(self.storage, o.x, o.y, o.r, out[:room]))
        stored = [(int(i), int(j)) for i, j in out[: max(min(room, count), 0)]]
        return count, stored, bool((out[room:] != UNTOUCHED).any())

    def within(self, rectangle: tuple[float, float, float, float], room: int) -> tuple[int, list[int], bool]:
        """The same of `query_rect`."""
        out = np.full(room + 2, UNTOUCHED, np.int32)
        count = int(
            self.contestant.callable(_query_rect)(self.storage, self.objects.x, self.objects.y, *rectangle, out[:room])
        )
        return count, out[: max(min(room, count), 0)].tolist(), bool((out[room:] != UNTOUCHED).any())


def _pair_faults(moving: _Moving, after: str) -> Iterator[str]:
    """Whether `pairs` finds what the twin finds; the first thing that is wrong."""
    wanted = moving.twin.pairs()
    count, found, _ = moving.pairs(len(wanted) + SIZE)
    if twice := {pair for pair in found if found.count(pair) > 1}:
        yield f"pairs, {after}: {min(twice)} comes twice"
    elif turned := [pair for pair in found if not pair[0] < pair[1]]:
        yield f"pairs, {after}: {turned[0]} has not the lesser number first"
    elif lost := sorted(set(wanted) - set(found)):
        yield f"pairs, {after}: {lost[0]} are in contact and not found, nor {len(lost) - 1} more of {len(wanted)}"
    elif more := sorted(set(found) - set(wanted)):
        yield f"pairs, {after}: {more[0]} are found and not in contact, and {len(more) - 1} more"
    elif count != len(wanted):
        yield f"pairs, {after}: it returns {count}, and there are {len(wanted)}"


# ---------------------------------------------------------------------------------------------------- rules


def _complete(contestant: CollisionContestant) -> Iterator[str]:
    start = _start([1.0, 2.0], [1.0, 2.0])
    storage = contestant.make(start.objects.x, start.objects.y, start.objects.r)
    if missing := lacks(interface, storage):
        yield f"{type(storage).__name__} does not implement {', '.join(missing)}"


def _contacts(contestant: CollisionContestant) -> Iterator[str]:
    """Before any step: `update` has nothing to do with it."""
    for name, start in _starts().items():
        yield from _pair_faults(_Moving(contestant, start), f"{name}, just built")


def _following(contestant: CollisionContestant) -> Iterator[str]:
    """Slow, fast, and all at once to where others were; twice, with nothing moved in between."""
    for name, start in _starts().items():
        moving = _Moving(contestant, start)
        for step in range(STEPS):
            moving.move()
            if step == 2:
                moving.follow()
            if faults := list(_pair_faults(moving, f"{name}, after update in step {step + 1}")):
                yield from faults
                break
        else:
            twin = moving.twin
            twin.x, twin.y = twin.y[::-1], twin.x[::-1]
            moving.objects.x[:], moving.objects.y[:] = twin.x, twin.y
            moving.follow()
            yield from _pair_faults(moving, f"{name}, after update, all objects in other places")


def _rectangles(contestant: CollisionContestant) -> Iterator[str]:
    """Some with centres on their border, inverted ones, without ends, of no numbers; before and after steps."""
    inf, nan = np.inf, np.nan
    special = [
        (-inf, -inf, inf, inf),
        (-inf, 40.0, inf, 60.0),
        (50.0, -inf, inf, inf),
        (inf, inf, -inf, -inf),
        (60.0, 0.0, 40.0, 100.0),
        (nan, 0.0, 100.0, 100.0),
        (0.0, 0.0, 100.0, nan),
        (-0.0, -0.0, 0.0, 0.0),
        (3e5, 3e5, 4e5, 4e5),
    ]
    for name, start in _starts().items():
        moving = _Moving(contestant, start)
        for step in range(3):
            twin = moving.twin
            between = [(twin.x[a], twin.y[a], twin.x[b], twin.y[b]) for a, b in pairwise(range(min(len(twin.x), 8)))]
            exact = [(x, y, x, y) for x, y in zip(twin.x[:4], twin.y[:4], strict=True)]
            for rectangle in [*special, *between, *exact]:
                count, found, _ = moving.within(rectangle, SIZE)
                wanted = twin.within(*rectangle)
                if sorted(found) != wanted or count != len(wanted):
                    yield f"query_rect{rectangle}, {name}, step {step}: it gives {sorted(found)}, and inside are {wanted}"
                    return
            moving.move()


def _room(contestant: CollisionContestant) -> Iterator[str]:
    """As many as fit, and how many there are."""
    moving = _Moving(contestant, _starts()["objects in a corner"])
    there, rectangle = moving.twin.pairs(), (0.0, 0.0, 3.0, 3.0)
    inside = moving.twin.within(*rectangle)
    for room in (0, 1, len(there) // 2, len(there)):
        count, stored, beyond = moving.pairs(room)
        if beyond:
            yield f"pairs writes beyond its room, {room} of {len(there)} pairs"
        if count != len(there) or len(set(stored) & set(there)) != room:
            yield f"pairs with room for {room} returns {count} and stores {stored}; there are {len(there)} pairs"
    for room in (0, 1, len(inside)):
        count, numbers, beyond = moving.within(rectangle, room)
        if beyond:
            yield f"query_rect writes beyond its room, {room} of {len(inside)} objects"
        if count != len(inside) or len(set(numbers) & set(inside)) != room:
            yield f"query_rect with room for {room} returns {count} and stores {numbers}; inside are {inside}"


def _told(contestant: CollisionContestant) -> Iterator[str]:
    """What is for people: `stats`, `leaf_rectangles`, `structure_bytes`."""
    for name in ("objects at random", "objects in one place", "no object"):
        moving = _Moving(contestant, _starts()[name])
        for _ in range(2):
            moving.move()
        for word, number in interface.stats(moving.storage).items():
            if not (np.isfinite(number) and number >= 0):
                yield f"stats, {name}: {word} is {number}"
        rectangles = np.asarray(interface.leaf_rectangles(moving.storage))
        if rectangles.ndim != 2 or rectangles.shape[1] != 4:
            yield f"leaf_rectangles, {name}: the shape is {rectangles.shape}, and should be (k, 4)"
        elif not (rectangles[:, :2] <= rectangles[:, 2:]).all():
            yield f"leaf_rectangles, {name}: one ends before it begins"
        for word, (used, reserved) in interface.structure_bytes(moving.storage).items():
            if not 0 <= used <= reserved:
                yield f"structure_bytes, {name}: {word} uses {used} of {reserved} bytes"


def _options(contestant: CollisionContestant) -> Iterator[str]:
    """Each option at both of its limits, the others as they are."""
    starts = _starts()
    for name, option in contestant.options.items():
        for value in sorted({option.least, option.most} - {option.value}):
            chosen = contestant.options | {name: dataclasses.replace(option, value=value)}  # type: ignore[operator]
            for start in ("objects at random", "objects in a corner", "objects in one place", "no object"):
                moving = _Moving(dataclasses.replace(contestant, options=chosen), starts[start])
                for _ in range(3):
                    moving.move()
                yield from _pair_faults(moving, f"with {name}={value}, {start}, after update in step 3")


RULES = (
    Rule("complete", "every function of the interface is there", _complete, essential=True),
    Rule("pairs", "all objects in contact, each pair once, where a structure was just built", _contacts),
    Rule("update", "the same while objects move", _following),
    Rule("rectangles", "query_rect: all objects in a rectangle, its border included", _rectangles),
    Rule("room", "as many answers as there is room for, and how many there are", _room),
    Rule("told", "stats, leaf_rectangles and structure_bytes are such", _told),
    Rule("options", "each option at its limits", _options),
)
"""In this order: what comes first is relied upon later."""
