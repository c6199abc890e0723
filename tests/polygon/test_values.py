"""How many values a format stores, counted from its arrays, against the published formulas and their boundary terms."""

import math
from typing import NamedTuple

import pytest

from tests.polygon.meshes import ALL
from tests.polygon.twin import Twin
from tetrabench.backends.polygon import FORMATS
from tetrabench.mesh.polygon.models import generate_polygons
from tetrabench.polygon.net import PolygonNet


class Counts(NamedTuple):
    """What a mesh has; corners: of the domain, where two boundary edges with different conditions meet."""

    cells: int
    edges: int
    nodes: int
    sides: int
    corners: int


EXACT = {
    "by-node": lambda n: n.cells + 2 * (2 * n.edges) + 2 * n.nodes + 2 * n.corners,
    "by-edge": lambda n: n.cells + 6 * n.edges + n.nodes,
    "by-cell": lambda n: 2 * n.sides + 2 * n.cells + n.nodes,
    "edge-cell": lambda n: n.sides + 2 * n.cells + 4 * n.edges + n.nodes,
    "edge-cell-node": lambda n: n.sides + 2 * n.cells + 4 * n.edges + 2 * n.edges + 2 * n.nodes,
    "half-edge": lambda n: n.cells + 8 * n.edges + n.nodes,
    "tables": lambda n: 2 * n.sides + n.cells + 1 + 2 * (2 * n.edges) + n.nodes + 1,
}
"""The formulas with what a mesh really has: i N is the sides of all cells, and k L is 2 K, each edge at both of its ends.

No term is left over but one: by-node holds two values more at each corner of the domain, itself and the second condition.
"""

REGULAR = {"triangle": 3, "quad": 4, "hexagon": 6}
"""model -> i, nodes of a cell; inner nodes have k = 6, 4, 3 edges."""

PER_CELL = {
    "by-node": {"triangle": 8, "quad": 11, "hexagon": 17},
    "by-edge": {"triangle": 10.5, "quad": 14, "hexagon": 21},
    "by-cell": {"triangle": 8.5, "quad": 11, "hexagon": 16},
    "edge-cell": {"triangle": 11.5, "quad": 15, "hexagon": 22},
    "edge-cell-node": {"triangle": 15, "quad": 20, "hexagon": 30},
    "half-edge": {"triangle": 13.5, "quad": 18, "hexagon": 27},
    "tables": {"triangle": 13.5, "quad": 18, "hexagon": 27},
}
"""Values for each cell: the source's table; the last two rows, which are ours, from their formulas."""

AT_THE_BOUNDARY = {
    "by-node": lambda b, d: 3 * b + 10,
    "by-edge": lambda b, d: 3.5 * b + 1,
    "by-cell": lambda b, d: 0.5 * b - 2 * d + 1,
    "edge-cell": lambda b, d: 2.5 * b - d + 1,
    "edge-cell-node": lambda b, d: 4 * b - d + 2,
    "half-edge": lambda b, d: 4.5 * b + 1,
    "tables": lambda b, d: 2.5 * b - 2 * d + 3,
}
"""What a rectangle of i-gons has beyond (values for each cell) N. It has B boundary sides, its cells lack d sides until each
has i; b = B - d. From 2 K = i N - d + B and Euler's N - K + L = 1: K = (i N + b) / 2, L = 1 + (i / 2 - 1) N + b / 2.
"""


@pytest.mark.parametrize("mesh", ALL)
def test_the_formulas_with_exact_counts(mesh):
    mesh = ALL[mesh]()
    twin = Twin(mesh)
    counts = Counts(len(twin.cells), len(twin.edges), twin.number_of_nodes, len(twin.owner), len(twin.corners))
    for name, contestant in FORMATS.items():
        net = PolygonNet(mesh, contestant)
        assert net.values() == EXACT[name](counts), name
        bytes_ = net.structure_bytes()
        assert sum(used for used, _ in bytes_.values()) == 4 * net.values(), name
        assert all(used == reserved for used, reserved in bytes_.values())
        assert set(bytes_) == set(net.storage._fields)


@pytest.mark.parametrize("model", REGULAR)
def test_values_of_a_cell_on_regular_meshes(model):
    mesh = generate_polygons(model, 2500, numbering="shuffled", seed=1)
    cells = mesh.number_of_cells
    boundary, lacking = int((mesh.conditions < 0).sum()), REGULAR[model] * cells - len(mesh.nodes)
    assert 0 <= lacking <= boundary <= 8 * math.sqrt(cells)  # so the boundary's terms are of the order of 1 / sqrt(N)
    assert not lacking or model == "hexagon"
    for name, contestant in FORMATS.items():
        beyond = AT_THE_BOUNDARY[name](boundary - lacking, lacking)
        assert PolygonNet(mesh, contestant).values() == PER_CELL[name][model] * cells + beyond, name
        assert abs(beyond) <= 40 * math.sqrt(cells), name


def test_quads_in_a_square():
    """A thousand by a thousand are these polynomials at n = 1000; here n = 30."""
    n = 30
    mesh = generate_polygons("quad", n * n)
    expected = {
        "by-node": 11 * n**2 + 12 * n + 10,
        "by-edge": 14 * n**2 + 14 * n + 1,
        "by-cell": 11 * n**2 + 2 * n + 1,
        "edge-cell": 15 * n**2 + 10 * n + 1,
        "edge-cell-node": 20 * n**2 + 16 * n + 2,
        "half-edge": 18 * n**2 + 18 * n + 1,
        "tables": 18 * n**2 + 10 * n + 3,
    }
    assert {name: PolygonNet(mesh, contestant).values() for name, contestant in FORMATS.items()} == expected


def test_one_cell_by_hand():
    """A square: every corner of it is one of the domain, too."""
    mesh = ALL["quad, 1 cells, natural"]()
    values = {name: PolygonNet(mesh, contestant).values() for name, contestant in FORMATS.items()}
    assert values == {
        "by-node": 4 * 2 + 2 * 4 * 3 + 1,  # three places for each node: both neighbours and itself; both conditions
        "by-edge": 4 * 6 + 1 + 4,
        "by-cell": 2 + 4 + 4 + 4,
        "edge-cell": 4 * 4 + 2 + 4 + 4,
        "edge-cell-node": 4 * 4 + 2 + 4 + 4 * 2 + 4 * 2,
        "half-edge": 8 * 4 + 1 + 4,
        "tables": 2 + 4 + 4 + 5 + 8 + 8,
    }
