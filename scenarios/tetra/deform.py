"""deform: move the points by a given map; static data and search tree anew. From the thesis' assignment page."""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.tetra.base import TetraScenario
from tetrabench.tetra.net import TetraNet

TWIST = 0.1
"""Radians over the length of the bounding box's diagonal."""


class Move(NamedTuple):
    """Which net is to be moved where."""

    net: TetraNet
    points: NDArray[np.float64]


class Deform(TetraScenario):
    """Twist the whole net around the z axis, the more the farther up: every tetra is touched."""

    name = "deform"
    title = "move all points (a twist around z); static data and search tree anew"

    def prepare(self, stage: Any, options: Options) -> Move:
        """A net of its own, and the new places of its points."""
        net = stage.own_net()
        return Move(net, twisted(net.points))

    def run(self, move: Move) -> int:
        """Move them; returns how many tetras were touched."""
        return move.net.deform(lambda _: move.points)

    def answer(self, move: Move, touched: int) -> Answer:
        """All of the net with its new volumes."""
        whole = move.net.answer()
        return Answer(whole.digest, {**whole.figures, "touched": touched})

    def work(self, move: Move, touched: int) -> Work:
        """Touched tetras."""
        return Work(touched, "tetras")


def twisted(points: NDArray[np.float64]) -> NDArray[np.float64]:
    """Points (n, 3), turned around the z axis by TWIST times their height over the diagonal: volumes stay as they are."""
    angle = TWIST * points[:, 2] / np.linalg.norm(np.ptp(points, axis=0))
    x, y, z = points.T
    return np.stack([x * np.cos(angle) - y * np.sin(angle), x * np.sin(angle) + y * np.cos(angle), z], axis=1)
