"""generate: make a cube of n^3 subcubes, six tetras each. Examples 2 and 3 of the half-face thesis (Hromádka 2013, 7.4).

Example 2 has 12^3 subcubes, example 3 has 10^3 (`--option generate.cubes=10`). The model of the run plays no part.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.models.box import cut_cubes
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.tetra.base import TetraScenario
from tetrabench.tetra.contestant import TetraContestant
from tetrabench.tetra.edit import reserve
from tetrabench.tetra.interface import Net, insert_tetra
from tetrabench.tetra.net import TetraNet


class Order(NamedTuple):
    """Whose net is to be made, and of how many subcubes along each edge."""

    contestant: TetraContestant
    cubes: int


class Generate(TetraScenario):
    """Points and connectivity by formula, then the whole net from them at once."""

    name = "generate"
    title = "make a cube of 12 x 12 x 12 subcubes, six tetras each, at once; whatever the model"
    options = thesis = {"cubes": 12}

    def prepare(self, stage: Any, options: Options) -> Order:
        """Nothing of the model."""
        return Order(stage.contestant, options["cubes"])

    def run(self, order: Order) -> TetraNet:
        """Make it."""
        points, tets = cube(order.cubes)
        return TetraNet(TetraMesh(points, tets), order.contestant)

    def answer(self, order: Order, net: TetraNet) -> Answer:
        """All of the net."""
        answer = net.answer()
        net.close()
        return answer

    def work(self, order: Order, net: TetraNet) -> Work:
        """Tetras made."""
        return Work(6 * order.cubes**3, "tetras")


class GenerateByAdding(Generate):
    """The same points and connectivity, but one tetra after the other into a net that has only the points."""

    name = "generate-add"
    title = "make the same cube tetra by tetra"

    def run(self, order: Order) -> TetraNet:
        """Make it."""
        points, tets = cube(order.cubes)
        net = TetraNet(TetraMesh(points, np.empty((0, 4), np.int32)), order.contestant)
        net.storage = reserve(net.storage, len(tets), 0)
        insert_all(net.storage, tets)
        return net


def cube(n: int) -> tuple[NDArray[np.float64], NDArray[np.int32]]:
    """The unit cube, cut: points ((n + 1)^3, 3) float64, tets (6 n^3, 4) int32."""
    grid, tets = cut_cubes(n, n, n)
    return grid / n, tets


@kernel(allocates=False)
def insert_all(net: Net, tets: Any) -> None:
    """Insert tetras (n, 4) in their order; the room was made before."""
    for n in range(len(tets)):
        a, b, c, d = np.int64(tets[n, 0]), np.int64(tets[n, 1]), np.int64(tets[n, 2]), np.int64(tets[n, 3])
        insert_tetra(net, a, b, c, d)
