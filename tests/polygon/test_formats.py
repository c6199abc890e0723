"""Every format gives the same lists, from the same start, for every query on every element; those of a naive twin."""

import numpy as np
import pytest
from hypothesis import given

from tests.polygon.meshes import ALL, divisions
from tests.polygon.twin import Twin, as_lists
from tetrabench.backends.polygon import FORMATS
from tetrabench.jit import kernel
from tetrabench.polygon import interface
from tetrabench.polygon.net import PolygonNet
from tetrabench.polygon.queries import QUERIES

NAMES = sorted(FORMATS)
KEEP_BOTH = {"by-node"}
"""Formats in which a corner of the domain has its right edge's condition, too."""


@kernel
def list_stars(storage, nodes, cells, counts):
    for v in range(len(counts)):
        counts[v] = interface.node_star(storage, v, nodes[v], cells[v])


def stars_of(net):
    """What `node_star` says of each node: its neighbours, and its cells."""
    nodes, cells = np.full((2, net.number_of_nodes, net.room), -999, np.int32)
    counts = np.zeros(net.number_of_nodes, np.int64)
    list_stars(net.storage, nodes, cells, counts)
    return [(n[:count].tolist(), c[:count].tolist()) for n, c, count in zip(nodes, cells, counts, strict=True)]


def expected(twin, query, name):
    """What a format must answer: the twin's lists, and at corners the condition that some formats keep besides."""
    lists = twin.lists(query)
    if query == "node-cells" and name in KEEP_BOTH:
        for v in twin.corners:
            lists[v] = [*lists[v], twin.conditions(v)[1]]
    return lists


def assert_as_the_twin(mesh, name):
    twin, net = Twin(mesh), PolygonNet(mesh, FORMATS[name])
    assert (len(net), net.number_of_nodes) == (len(twin.cells), twin.number_of_nodes)
    for query in QUERIES:
        assert as_lists(*net.lists(query)) == expected(twin, query, name), query
    assert stars_of(net) == [twin.star(v) for v in range(twin.number_of_nodes)]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("mesh", ALL)
def test_every_list_of_every_element(mesh, name):
    assert_as_the_twin(ALL[mesh](), name)


@given(divisions())
def test_any_division_in_all_formats(mesh):
    for name in NAMES:
        assert_as_the_twin(mesh, name)


@pytest.mark.parametrize("mesh", ALL)
def test_the_lists_fit_together(mesh):
    """Without the twin: cells and nodes see each other, as often; around a node the cells join one another."""
    mesh = ALL[mesh]()
    lists = {query: as_lists(*PolygonNet(mesh, FORMATS["by-edge"]).lists(query)) for query in QUERIES}
    cells, nodes = lists["cell-nodes"], lists["node-cells"]
    pairs = {(c, v) for c, cell in enumerate(cells) for v in cell}
    assert pairs == {(c, v) for v, around in enumerate(nodes) for c in around if c >= 0}
    assert len(pairs) == len(mesh.nodes)
    for v, around in enumerate(lists["node-neighbours"]):
        assert len(set(around)) == len(around) == len(nodes[v])
        assert all(v in lists["node-neighbours"][other] for other in around)
        for j, c in enumerate(nodes[v]):
            if c >= 0:  # counter-clockwise: the cell goes from the later neighbour to v, and on to the earlier one
                later, earlier = around[(j + 1) % len(around)], around[j]
                place = cells[c].index(v)
                assert [cells[c][place - 1], cells[c][(place + 1) % len(cells[c])]] == [later, earlier]
    for c, beyond in enumerate(lists["cell-neighbours"]):
        assert all(lists["cell-neighbours"][d].count(c) == beyond.count(d) for d in beyond if d >= 0)


# Boundary conditions, which formats may keep one or two of around a node.


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("mesh", ALL)
def test_conditions_around_a_node(mesh, name):
    """None within; at the boundary the left edge's last, behind it the right one's where it differs and the format keeps it."""
    mesh = ALL[mesh]()
    twin, net = Twin(mesh), PolygonNet(mesh, FORMATS[name])
    for v, around in enumerate(as_lists(*net.lists("node-cells"))):
        left_and_right = twin.conditions(v)
        kept = 2 if name in KEEP_BOTH and len(set(left_and_right)) == 2 else 1
        assert [c for c in around if c < 0] == left_and_right[:kept]
        assert [c < 0 for c in around] == sorted(c < 0 for c in around)


@pytest.mark.parametrize("name", NAMES)
def test_the_left_condition_is_that_of_the_edge_to_the_last_neighbour(name):
    """On a square whose sides are told apart by eye: node 0 is bottom left, 1 bottom right, 2 top right, 3 top left."""
    mesh = ALL["quad, 1 cells, natural"]()
    left_below, right_below = 0, 1
    assert mesh.points[[left_below, right_below]].tolist() == [[0, 0], [1, 0]]
    net = PolygonNet(mesh, FORMATS[name])
    assert net.node_neighbours(left_below)[0] == right_below  # the right one for who looks at it from below
    bottom, left = -1, -4
    assert net.node_cells(left_below).tolist() == [0, left, bottom][: 3 if name in KEEP_BOTH else 2]
    assert net.cell_neighbours(0).tolist() == [-1, -2, -3, -4]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("mesh", ALL)
def test_conditions_of_cells_are_at_their_places(mesh, name):
    mesh = ALL[mesh]()
    starts, items = PolygonNet(mesh, FORMATS[name]).lists("cell-neighbours")
    np.testing.assert_array_equal(starts, mesh.starts)
    np.testing.assert_array_equal(np.minimum(items, 0), mesh.conditions)
