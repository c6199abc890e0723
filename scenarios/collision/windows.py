"""windows: which objects lie in a rectangle, asked at random, as what a player sees or an explosion reaches."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.collision.interface import Numbers, Storage, query_rect
from tetrabench.collision.objects import Floats, Objects
from tetrabench.collision.simulation import Simulation
from tetrabench.jit import kernel
from tetrabench.jit.mix import mix_of_arrays, mixed_with
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.collision.base import CollisionScenario

SEED = 2025
"""Of the rectangles: the same for all contestants, models and machines."""
EXPECTED = 100
"""Objects in a window, where they are spread evenly."""
ITEM_BYTES = 16
"""Least traffic for an object that is found: to read its place."""


@dataclass
class Asked:
    """What a sample works on: a simulation, the lower left corners of windows, (q, 2) float64, their width and height."""

    simulation: Simulation
    corners: Floats
    width: float
    height: float

    def __post_init__(self) -> None:
        self.out = np.zeros(len(self.simulation), np.int32)

    @cached_property
    def lists(self) -> list[NDArray[np.int32]]:
        """What lies in each window, in the order of numbers."""
        return [self.simulation.query_rect(x, y, x + self.width, y + self.height) for x, y in self.corners]


class Windows(CollisionScenario):
    """Rectangles of the box's shape, which hold a hundred objects on average."""

    name = "windows"
    title = f"which objects lie in rectangles at random, of about {EXPECTED} objects each"
    options = {"queries": 1000}
    thesis = {"queries": 1000}

    def prepare(self, stage: Any, options: Options) -> Asked:
        """The objects at their start, and the windows."""
        simulation: Simulation = stage.simulation()
        start = simulation.start
        share = min(1.0, EXPECTED / max(1, len(simulation))) ** 0.5
        width, height = share * start.width, share * start.height
        corners = np.random.default_rng(SEED).random((options["queries"], 2))
        corners *= [start.width - width, start.height - height]
        return Asked(simulation, corners, width, height)

    def run(self, asked: Asked) -> tuple[int, int]:
        """Ask; how many objects all windows hold, and the sum of their numbers."""
        simulation = asked.simulation
        ask = simulation.contestant.callable(ask_all)
        count, total = ask(simulation.storage, simulation.objects, asked.corners, asked.width, asked.height, asked.out)
        return int(count), int(total)

    def answer(self, asked: Asked, outcome: tuple[int, int]) -> Answer:
        """What lies in each window, and what the timed loop has found."""
        sizes = [len(one) for one in asked.lists]
        numbers = np.concatenate([np.zeros(0, np.int32), *asked.lists])
        digest = mix_of_arrays(np.array(sizes, np.float64), numbers.astype(np.float64))
        return Answer(mixed_with(digest, *outcome), {"found": outcome[0]})

    def work(self, asked: Asked, outcome: tuple[int, int]) -> Work:
        """Windows, and the objects that had to be read for them."""
        return Work(len(asked.corners), "windows", ITEM_BYTES * outcome[0])


@kernel(allocates=False)
def ask_all(
    storage: Storage, objects: Objects, corners: Floats, width: float, height: float, out: Numbers
) -> tuple[int, int]:
    """How many objects all windows hold, and the sum of their numbers."""
    count: Any = 0
    total: Any = 0
    for query in range(len(corners)):
        x, y = corners[query, 0], corners[query, 1]
        found = query_rect(storage, objects.x, objects.y, x, y, x + width, y + height, out)
        count += found
        for place in range(found):
            total += np.int64(out[place])
    return count, total
