"""The answer to what structures are asked: where all objects are, to the last bit, and which are in contact."""

import numpy as np

from tetrabench.collision.interface import Pairs
from tetrabench.collision.simulation import Simulation
from tetrabench.jit.mix import mix_of_arrays, mixed_with
from tetrabench.protocols import Answer


def state_answer(simulation: Simulation) -> Answer:
    """Digest of all places and velocities, and of how many contacts the last step found; energy and contacts for people."""
    objects = simulation.objects
    digest = mix_of_arrays(objects.x, objects.y, objects.vx, objects.vy)
    figures = {"energy": simulation.energy(), "contacts": simulation.contacts}
    return Answer(mixed_with(digest, simulation.contacts, simulation.steps_done), figures)


def pairs_answer(found: Pairs) -> Answer:
    """Digest of pairs, which are in order."""
    digest = mix_of_arrays(found.astype(np.float64))
    return Answer(mixed_with(digest, len(found)), {"contacts": len(found)})
