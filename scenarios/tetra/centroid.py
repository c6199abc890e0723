"""centroid: the tetra in the middle of the net, and its volume. Example 1 of the half-face thesis (Hromádka 2013, 7.3).

Two sweeps: the centroid of the net, as the mean of the tetras' centroids weighted by their volumes; then the tetra whose
centroid is nearest to that. Both compute centroids and volumes from the coordinates, as the source does. Its step 3b
prints the sum of the centroids without weights, which divided by the whole volume is no mean; its text says weighted.
"""

from typing import Any, NamedTuple

import numpy as np

from tetrabench.jit import kernel
from tetrabench.jit.mix import mixed_with
from tetrabench.protocols import Answer, Work
from tetrabench.scenarios.tetra.base import TetraScenario
from tetrabench.tetra.geometry import signed_volume
from tetrabench.tetra.interface import NONE, Net, first_tetra, next_tetra, vertex
from tetrabench.tetra.net import TetraNet

SWEEP_BYTES = 4 * 4
"""Least traffic for a tetra in one sweep: its vertices. (Coordinates are shared by many, and may stay in the cache.)"""


class Middle(NamedTuple):
    """The tetra nearest to the centroid of the net, -1 for none; its volume; that centroid (for people)."""

    tetra: int
    volume: float
    x: float
    y: float
    z: float


class Centroid(TetraScenario):
    """Coordinates and vertices of every tetra, twice; no neighbours."""

    name = "centroid"
    title = "find the tetra nearest to the centroid of the net, in two sweeps over vertices and coordinates"

    def run(self, net: TetraNet) -> Middle:
        """Find it."""
        return Middle(*middle_of(net.storage))

    def answer(self, net: TetraNet, middle: Middle) -> Answer:
        """Which tetra, by its vertices, and the bits of its volume; none in a net without volume."""
        corners = sorted(net.vertices_of(middle.tetra)) if middle.tetra != NONE else []
        bits = int(np.float64(middle.volume).view(np.uint64))
        figures = {name: float(value) for name, value in zip(Middle._fields[1:], middle[1:], strict=True)}
        return Answer(mixed_with(bits, len(corners), *corners), figures)

    def work(self, net: TetraNet, middle: Middle) -> Work:
        """Visited tetras."""
        visits = 2 * len(net)
        return Work(visits, "tetra visits", visits * SWEEP_BYTES)


@kernel(allocates=False)
def middle_of(net: Net) -> tuple[Any, Any, Any, Any, Any]:
    """The fields of a `Middle`; a net without volume has none."""
    whole, x, y, z = centre_of(net)
    t, volume = nearest_to(net, x, y, z) if whole > 0.0 else (NONE, 0.0)
    return t, volume, x, y, z


@kernel(allocates=False)
def centre_of(net: Net) -> tuple[Any, Any, Any, Any]:
    """The volume of a net and its centroid; zeros where there is no volume."""
    whole, x, y, z = 0.0, 0.0, 0.0, 0.0
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        volume, cx, cy, cz = shape_of(net, cursor.tetra)
        whole += volume
        x, y, z = x + volume * cx, y + volume * cy, z + volume * cz
        cursor = next_tetra(net, cursor)
    if whole > 0.0:
        x, y, z = x / whole, y / whole, z / whole
    return whole, x, y, z


@kernel(allocates=False)
def nearest_to(net: Net, x: float, y: float, z: float) -> tuple[Any, Any]:
    """The tetra whose centroid is nearest to (x, y, z), the first of several, and its volume; NONE and 0 without any."""
    nearest, its_volume, least = NONE, 0.0, np.inf
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        volume, cx, cy, cz = shape_of(net, cursor.tetra)
        distance = (cx - x) * (cx - x) + (cy - y) * (cy - y) + (cz - z) * (cz - z)
        if distance < least:
            nearest, its_volume, least = cursor.tetra, volume, distance
        cursor = next_tetra(net, cursor)
    return nearest, its_volume


@kernel(allocates=False, inline=True)
def shape_of(net: Net, t: int) -> tuple[Any, Any, Any, Any]:
    """Volume and centroid of a tetra, from its coordinates."""
    xyz = net.points.xyz
    a, b = np.uint64(vertex(net, t, 0)), np.uint64(vertex(net, t, 1))
    c, d = np.uint64(vertex(net, t, 2)), np.uint64(vertex(net, t, 3))
    return (
        abs(signed_volume(xyz, a, b, c, d)),
        (xyz[a, 0] + xyz[b, 0] + xyz[c, 0] + xyz[d, 0]) / 4.0,
        (xyz[a, 1] + xyz[b, 1] + xyz[c, 1] + xyz[d, 1]) / 4.0,
        (xyz[a, 2] + xyz[b, 2] + xyz[c, 2] + xyz[d, 2]) / 4.0,
    )
