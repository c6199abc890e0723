"""locate: find the tetra of a point close to each side 0, three ways: a walk, as the source did it, by brute force.

The points are the hard case for a search that begins at the nearest point: 0.5 % of the way from the centre of side 0 to
the vertex opposite it. They come in the order of the tetras, or at random. Thesis, 4.6.5.
"""

from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.tetra.base import TetraScenario
from tetrabench.tetra.digest import found_answer
from tetrabench.tetra.interface import Net, vertex
from tetrabench.tetra.net import TetraNet

INWARD = 0.005


class Search(NamedTuple):
    """Which points to look for in which net, by which method, and the tetras that they were made in."""

    net: TetraNet
    points: NDArray[np.float64]
    method: str
    refs: NDArray[np.int64]


class Locate(TetraScenario):
    """One point in every tetra, found by walking from one to the next along a curve."""

    name = "locate"
    title = "find the tetra of one point in every tetra: put in order, then walk from one to the next"
    method: ClassVar[str] = "walk"
    options = thesis = {"every_nth_tetra": 1, "shuffled": 0}

    def prepare(self, stage: Any, options: Options) -> Search:
        """The points, in iteration order or, `shuffled`, in a random one."""
        net = stage.net()
        refs = self.choose(net.refs, options)
        points = points_near_sides(net.storage, refs)
        net.locate(points, self.method)  # a walk that gets stuck leaves a grid behind, which later ones find
        return Search(net, points, self.method, refs)

    def choose(self, refs: NDArray[np.int64], options: Options) -> NDArray[np.int64]:
        """The tetras to look for."""
        refs = refs[:: options["every_nth_tetra"]]
        return np.random.default_rng(0).permutation(refs) if options["shuffled"] else refs.copy()

    def run(self, search: Search) -> NDArray[np.int64]:
        """Find them all."""
        return search.net.locate(search.points, search.method)

    def answer(self, search: Search, found: NDArray[np.int64]) -> Answer:
        """Which tetra each point was found in; `missed` counts those that are not the one it was made in."""
        return found_answer(search.net.storage, found, missed=int((found != search.refs).sum()))

    def work(self, search: Search, found: NDArray[np.int64]) -> Work:
        """Found points."""
        return Work(len(search.points), "points")


class LocateSource(Locate):
    """The same by the source's method: tetras around the nearest point, their side neighbours, else every tetra."""

    name = "locate-source"
    title = "the same by the source's method: around the nearest point, beside those, else every tetra"
    method = "source"


class LocateBrute(Locate):
    """A sample of the same points, found by asking every tetra."""

    name = "locate-brute"
    title = "a sample of 200 of these points, found by asking every tetra"
    method = "brute"
    options = thesis = {"points": 200}

    def choose(self, refs: NDArray[np.int64], options: Options) -> NDArray[np.int64]:
        """A sample spread evenly over the net."""
        step = max(len(refs) // options["points"], 1)
        return refs[step // 2 :: step].copy()


@kernel
def points_near_sides(net: Net, refs: Any) -> Any:
    """In each tetra of `refs` (m,) the point INWARD of the way from the centre of side 0 to vertex 0: (m, 3) float64."""
    xyz = net.points.xyz
    points = np.empty((len(refs), 3))
    for n in range(len(refs)):
        p0, p1 = vertex(net, refs[n], 0), vertex(net, refs[n], 1)
        p2, p3 = vertex(net, refs[n], 2), vertex(net, refs[n], 3)
        for k in range(3):
            centre = (xyz[p1, k] + xyz[p2, k] + xyz[p3, k]) / 3.0
            points[n, k] = centre + INWARD * (xyz[p0, k] - centre)
    return points
