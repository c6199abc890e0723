"""build: put the objects into the structure."""

from typing import Any

from tetrabench.collision.digest import pairs_answer
from tetrabench.collision.interface import Storage
from tetrabench.collision.simulation import Simulation
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.collision.base import CollisionScenario

OBJECT_BYTES = 24
"""Least traffic for an object: to read its place and its radius."""


class Build(CollisionScenario):
    """From arrays of places and radii to a structure that can be asked."""

    name = "build"
    title = "put the objects into the structure"

    def prepare(self, stage: Any, options: Options) -> Simulation:
        """The objects, in memory."""
        simulation: Simulation = stage.simulation()
        return simulation

    def run(self, simulation: Simulation) -> Storage:
        """Build."""
        objects = simulation.objects
        return simulation.contestant.make(objects.x, objects.y, objects.r)

    def answer(self, simulation: Simulation, storage: Storage) -> Answer:
        """All pairs in contact."""
        simulation.storage = storage
        return pairs_answer(simulation.find_pairs())

    def work(self, simulation: Simulation, storage: Storage) -> Work:
        """Objects held."""
        return Work(len(simulation), "objects", OBJECT_BYTES * len(simulation))
