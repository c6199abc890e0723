"""PolygonNet: what it refuses, and that one question and many at once have the same answers."""

import numpy as np
import pytest

from tests.polygon.meshes import ALL, fan, polygons, quads
from tests.polygon.twin import Twin, as_lists
from tetrabench import memory
from tetrabench.backends.polygon import FORMATS
from tetrabench.errors import InputError, MemoryRefusedError
from tetrabench.polygon.net import PolygonNet, list_room
from tetrabench.polygon.queries import QUERIES

NAMES = sorted(FORMATS)
SINGLE = {query: query.replace("-", "_") for query in QUERIES}


def strip(name="by-edge"):
    return PolygonNet(polygons(quads(4, 1)), FORMATS[name])


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("mesh", ["two holes", "degree 30 at the boundary", "pillow", "voronoi, 24 cells, shuffled"])
def test_many_at_once_are_the_single_ones(mesh, name, rng):
    net = PolygonNet(ALL[mesh](), FORMATS[name])
    for query, single in SINGLE.items():
        count = net.number_of_nodes if QUERIES[query].of_nodes else len(net)
        alone = [getattr(net, single)(x).tolist() for x in range(count)]
        assert as_lists(*net.lists(query)) == alone
        some = rng.integers(0, count, 2 * count)  # in any order, and more than once
        for asked in (some, some.tolist(), some.astype(np.uint64), some[::-2], np.flip(some.astype(np.int32))):
            assert as_lists(*net.lists(query, asked)) == [alone[int(x)] for x in asked]
        starts, items = net.lists(query, [])
        assert (starts.tolist(), items.tolist()) == ([0], [])
        assert (starts.dtype, items.dtype) == (np.int64, np.int32)


def test_an_answer_is_the_caller_s():
    net = strip()
    first, second = net.cell_nodes(0), net.cell_nodes(0)
    first[:] = -99
    assert second.tolist() == net.cell_nodes(np.int64(0)).tolist() == [0, 1, 6, 5]


@pytest.mark.parametrize("query", SINGLE.values())
@pytest.mark.parametrize("element", [-1, 1000, 2**40, 1.0, "0", None, np.float64(0), [0]])
def test_an_element_that_there_is_not(query, element):
    net, kind, last = strip(), query[:4], 3 if query.startswith("cell") else 9
    with pytest.raises(InputError, match=rf"^no {kind} .*: there are {kind}s 0 to {last}$"):
        getattr(net, query)(element)
    assert len(getattr(net, query)(last)) >= 2
    with pytest.raises(InputError, match=rf"^no {kind} {last + 1}: "):
        getattr(net, query)(last + 1)


@pytest.mark.parametrize("elements", [[4], [-1], [0, 1, 4], [0.0], [[0, 1]], 3, "0", ["0"], [True], [2**40], [None]])
def test_elements_that_there_are_not(elements):
    with pytest.raises(InputError, match="elements: a list of whole numbers from 0 to 3"):
        strip().lists("cell-nodes", elements)


def test_a_query_that_there_is_not():
    with pytest.raises(InputError, match="node-cells"):
        strip().lists("node_cells")


TOUCH_IN_A_NODE = [[0, 1, 2], [2, 3, 4]]
TWICE = [[0, 1, 2], [0, 1, 2]]
THREE_AT_A_SIDE = [[0, 1, 2], [1, 0, 3], [1, 0, 4]]
TURNED = [[0, 1, 2], [0, 1, 3]]
NODE_TWICE = [[0, 1, 2, 0, 3]]
UNUSED_NODE = [[0, 1, 3]]
HOLES_THAT_TOUCH = quads(4, 4, [5, 10])


@pytest.mark.parametrize(
    "cells", [TOUCH_IN_A_NODE, TWICE, THREE_AT_A_SIDE, TURNED, NODE_TWICE, UNUSED_NODE, HOLES_THAT_TOUCH]
)
@pytest.mark.parametrize("name", NAMES)
def test_what_no_format_can_hold(name, cells):
    with pytest.raises(InputError, match=r"no format can hold this mesh.*settle"):
        PolygonNet(polygons(cells), FORMATS[name])


@pytest.mark.parametrize(
    ("array", "place", "value"),
    [
        ("starts", 0, 1),
        ("starts", -1, 11),
        ("starts", -1, 13),
        ("starts", 1, 2),
        ("starts", 2, 3),
        ("nodes", 5, -1),
        ("nodes", 5, 99),
    ],
)
def test_arrays_that_do_not_belong_together(array, place, value):
    mesh = polygons(quads(3, 1))
    getattr(mesh, array)[place] = value
    with pytest.raises(InputError, match="do not belong together"):
        PolygonNet(mesh, FORMATS["by-edge"])


@pytest.mark.parametrize(("place", "value"), [("within", -1), ("boundary", 0), ("boundary", 1)])
def test_conditions_that_are_not_where_the_boundary_is(place, value):
    mesh = polygons(quads(3, 1))
    sides = np.flatnonzero(mesh.conditions == 0 if place == "within" else mesh.conditions < 0)
    mesh.conditions[sides[0]] = value
    with pytest.raises(InputError, match="no format can hold"):
        PolygonNet(mesh, FORMATS["by-edge"])


def test_no_cells_at_all():
    mesh = polygons([[0, 1, 2]])
    mesh.starts, mesh.nodes, mesh.conditions = mesh.starts[:1], mesh.nodes[:0], mesh.conditions[:0]
    with pytest.raises(InputError, match="do not belong together"):
        PolygonNet(mesh, FORMATS["by-edge"])


def test_arrays_of_other_kinds_are_taken():
    """Read-only, of 64 bits, not contiguous: as files and slices have them."""
    mesh = polygons(quads(3, 2))
    digest = PolygonNet(mesh, FORMATS["tables"]).answer().digest
    mesh.nodes = np.repeat(mesh.nodes.astype(np.int64), 2)[::2]
    mesh.starts.flags.writeable = False
    for contestant in FORMATS.values():
        assert PolygonNet(mesh, contestant).answer().digest == digest


def test_a_mesh_too_large_for_memory_is_refused(monkeypatch):
    monkeypatch.setattr(memory, "available_bytes", lambda: 1)
    with pytest.raises(MemoryRefusedError, match="a net of 4 cells"):
        strip()


@pytest.mark.parametrize("mesh", ALL)
def test_room_is_for_the_longest_list_and_two_conditions(mesh):
    mesh = ALL[mesh]()
    twin = Twin(mesh)
    longest = max(max(map(len, twin.cells)), *(len(twin.star(v)[0]) for v in range(twin.number_of_nodes)))
    assert longest <= list_room(mesh) <= longest + 2
    for contestant in FORMATS.values():
        net = PolygonNet(mesh, contestant)
        assert max(np.diff(net.lists(query)[0]).max() for query in QUERIES) <= net.room


def test_what_a_full_fan_looks_like():
    """By hand: node 0 has 5 triangles around it, each node of the rim two."""
    for name in NAMES:
        net = PolygonNet(polygons(fan(5, closed=True)), FORMATS[name])
        assert net.node_neighbours(0).tolist() == [1, 2, 3, 4, 5]
        assert net.node_cells(0).tolist() == [0, 1, 2, 3, 4]
        assert net.node_neighbours(3).tolist() == [4, 0, 2]
        assert net.node_cells(3).tolist() == [2, 1, -1]
        assert net.cell_neighbours(4).tolist() == [3, -1, 0]
