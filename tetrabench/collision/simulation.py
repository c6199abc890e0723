"""Simulation: the Python face of any structure: objects that move, and what can be asked about them."""

import operator
from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from tetrabench.collision import interface
from tetrabench.collision.contestant import CollisionContestant
from tetrabench.collision.dynamics import PHASES, Rules, advance, make_desk, put_in_order, room_for
from tetrabench.collision.objects import Floats, Start, check_box, check_objects, copy_objects
from tetrabench.errors import InputError, find_named, refuse_name
from tetrabench.jit import kernel
from tetrabench.memory import refuse_if_too_large

PEAK = 400.0  # bytes an object while a structure is built: measured 280 (kdtree with leaves of one object)
MOST = 2**31 - 1
MODES = {"paper": False, "full": True}


@kernel
def _update(storage: interface.Storage, x: Floats, y: Floats) -> interface.Storage:
    return interface.update(storage, x, y)


@kernel
def _pairs(storage: interface.Storage, x: Floats, y: Floats, r: Floats, out: interface.Pairs) -> int:
    return interface.pairs(storage, x, y, r, out)


@kernel
def _query_rect(
    storage: interface.Storage,
    x: Floats,
    y: Floats,
    x_low: float,
    y_low: float,
    x_high: float,
    y_high: float,
    out: interface.Numbers,
) -> int:
    return interface.query_rect(storage, x, y, x_low, y_low, x_high, y_high, out)


class Simulation:
    """Objects in a box, held by the structure of a contestant.

    >>> import tetrabench
    >>> start = tetrabench.generate_objects("uniform", 100)
    >>> simulation = tetrabench.Simulation(start, tetrabench.contestant("collision", "grid"), gravity=0.1)
    >>> simulation.step(10)
    >>> simulation.steps_done, simulation.find_pairs().shape[1]
    (10, 2)

    Attributes:
        start: what it began with; its objects are left as they are.
        contestant: the structure.
        objects: as they are now. Whoever writes to them does it between steps, and calls `rebuild` after other radii.
        storage: the structure's arrays.
        steps_done: so many steps.
        contacts: pairs that the last step found.
    """

    def __init__(
        self,
        start: Start,
        contestant: CollisionContestant,
        *,
        gravity: float = 0.0,
        bounce: float = 1.0,
        mode: str = "paper",
    ) -> None:
        """Put objects into a structure; the contestant is an object, as `tetrabench.contestant("collision", "grid")` gives it.

        Args:
            gravity: change of the velocity in y in a step, downward.
            bounce: what a wall leaves of a velocity, 0 to 1.
            mode: "paper", one contact an object and step as the source has it, or "full", all of them: see `dynamics`.

        Raises:
            InputError: objects that are no circles, a box that is none, a rule out of its range, or a name in place of the
                contestant.
            MemoryRefusedError: there is not enough memory for them.
        """
        check_objects(start.objects)
        check_box(start.width, start.height)
        count = len(start.objects.x)
        if count > MOST:
            raise InputError(f"{count:,} objects: {MOST:,} at most")
        refuse_if_too_large(f"a simulation of {count:,} objects", count * PEAK)
        self.start = start
        self.objects = copy_objects(start.objects)
        self.gravity, self.bounce, self.mode = gravity, bounce, mode
        self._desk = make_desk(count)
        self._seconds = np.zeros(len(PHASES))
        self.steps_done = 0
        self.contacts = 0
        self.rebuild(contestant)

    def __len__(self) -> int:
        return len(self.objects.x)

    @property
    def gravity(self) -> float:
        """Change of the velocity in y in a step, downward."""
        return self._gravity

    @gravity.setter
    def gravity(self, gravity: float) -> None:
        if not np.isfinite(gravity):
            raise InputError(f"gravity: a finite number is needed, not {gravity}")
        self._gravity = float(gravity)

    @property
    def bounce(self) -> float:
        """What a wall leaves of a velocity."""
        return self._bounce

    @bounce.setter
    def bounce(self, bounce: float) -> None:
        if not 0 <= bounce <= 1:
            raise InputError(f"bounce: a number from 0 to 1 is needed, not {bounce}")
        self._bounce = float(bounce)

    @property
    def mode(self) -> str:
        """What contacts do: "paper" or "full"."""
        return self._mode

    @mode.setter
    def mode(self, mode: str) -> None:
        find_named("mode", MODES, mode)
        self._mode = mode

    @property
    def rules(self) -> Rules:
        """As a kernel takes them."""
        return Rules(self.gravity, self.bounce, float(self.start.width), float(self.start.height), MODES[self.mode])

    def rebuild(self, contestant: CollisionContestant) -> None:
        """Go on with another structure, or the same with other options.

        Raises:
            InputError: an option out of its range.
        """
        refuse_name(contestant, "collision")
        self.storage = contestant.make(self.objects.x, self.objects.y, self.objects.r)
        self.contestant = contestant

    def step(self, count: int = 1) -> None:
        """Take so many steps.

        Raises:
            InputError: a number below 0.
        """
        try:
            count = operator.index(count)
        except TypeError:
            count = -1
        if count < 0:
            raise InputError("steps: a whole number, 0 or more")
        self.storage, self._desk, found = self.contestant.callable(advance)(
            self.storage, self.objects, self.rules, self._desk, count, self._seconds
        )
        if count > 0:
            self.contacts = int(found)
        self.steps_done += count

    @property
    def phase_seconds(self) -> Mapping[str, float]:
        """CPU time of all steps so far, seconds, by phase: see `dynamics.PHASES`."""
        return dict(zip(PHASES, self._seconds.tolist(), strict=True))

    def find_pairs(self) -> NDArray[np.int32]:
        """All objects in contact where they are now, (k, 2) int32, in the order of their numbers."""
        self._follow()
        found, objects = self._desk.found, self.objects
        while (
            count := int(self.contestant.callable(_pairs)(self.storage, objects.x, objects.y, objects.r, found))
        ) > len(found):
            found = room_for(count)
        put_in_order(found, np.empty_like(found), self._desk.counts, count, len(self))
        return found[:count].copy()

    def query_rect(self, x_low: float, y_low: float, x_high: float, y_high: float) -> NDArray[np.int32]:
        """The objects with their centre in a rectangle, its border included, (k,) int32, in the order of their numbers."""
        self._follow()
        out = np.empty(len(self), np.int32)
        ends = (float(x_low), float(y_low), float(x_high), float(y_high))
        count = self.contestant.callable(_query_rect)(self.storage, self.objects.x, self.objects.y, *ends, out)
        return np.sort(out[:count])

    def stats(self) -> dict[str, float]:
        """What the structure counts, by name: see `interface.stats`."""
        return {name: float(number) for name, number in interface.stats(self.storage).items()}

    def leaf_rectangles(self) -> Floats:
        """(k, 4) float64: what the structure divides the plane into: see `interface.leaf_rectangles`."""
        rectangles: Floats = interface.leaf_rectangles(self.storage)
        return rectangles

    def structure_bytes(self) -> Mapping[str, tuple[int, int]]:
        """Bytes (used, reserved) of each array of the structure, by name."""
        sizes: Mapping[str, tuple[int, int]] = interface.structure_bytes(self.storage)
        return sizes

    def energy(self) -> float:
        """Kinetic energy, and that of height above y = 0."""
        vx, vy, y, m = self.objects.vx, self.objects.vy, self.objects.y, self.objects.m
        return float(np.sum(m * (0.5 * (vx * vx + vy * vy) + self.gravity * y)))

    def momentum(self) -> tuple[float, float]:
        """In x and in y."""
        return float(np.sum(self.objects.m * self.objects.vx)), float(np.sum(self.objects.m * self.objects.vy))

    def _follow(self) -> None:
        self.storage = self.contestant.callable(_update)(self.storage, self.objects.x, self.objects.y)
