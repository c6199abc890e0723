"""The rules of each format's arrays, one by one, against the mesh: neither through the queries nor what made the arrays."""

from itertools import pairwise

import numpy as np
import pytest

from tests.polygon.meshes import ALL
from tests.polygon.twin import Twin, sides_of
from tetrabench.backends.polygon import FORMATS
from tetrabench.polygon.net import PolygonNet

TARGET, NEXT, PREVIOUS, CELL = range(4)

every_mesh = pytest.mark.parametrize("mesh", ALL)


def stored(mesh, name):
    """The twin of a mesh, and its storage with arrays as nested lists."""
    mesh = ALL[mesh]()
    storage = PolygonNet(mesh, FORMATS[name]).storage
    return Twin(mesh), type(storage)(*(array.tolist() for array in storage))


def take_lists(lists, *items):
    """The lists that (start, length) describe: one behind the other, no item left over."""
    ends = np.cumsum([length for _, length in lists]).tolist()
    assert [start for start, _ in lists] == [0, *ends[:-1]]
    assert all(len(row) == ends[-1] for row in items)
    taken = [[row[start : start + length] for start, length in lists] for row in items]
    return taken[0] if len(items) == 1 else taken


def is_boundary(twin, v):
    return twin.star(v)[1][-1] < 0


def right_side(twin, v):
    """The side that a boundary node's cell begins with there: the right one for who looks at it from outside."""
    (side,) = [(a, b) for (a, b), condition in twin.condition.items() if a == v and condition < 0]
    return side


def check_edges(twin, rows):
    """V1, V2 run counter-clockwise in C1, and clockwise in C2; a boundary edge has its condition for C1; each edge once."""
    for v1, v2, c1, c2 in rows:
        assert twin.owner[v2, v1] == c2
        if c1 < 0:
            assert twin.condition[v2, v1] == c1
            assert (v1, v2) not in twin.owner
        else:
            assert twin.owner[v1, v2] == c1
    assert {frozenset(row[:2]) for row in rows} == twin.edges
    assert len(rows) == len(twin.edges)


def check_node_edges(twin, rows, node_edge):
    """An edge of each node; a boundary node's right boundary edge, which from outside runs towards the node."""
    assert len(node_edge) == twin.number_of_nodes
    for v, e in enumerate(node_edge):
        v1, v2, c1, _ = rows[e]
        if is_boundary(twin, v):
            assert (v2, v1) == right_side(twin, v)
            assert c1 < 0
        else:
            assert v in (v1, v2)


def check_cell_edges(twin, rows, cell_edges):
    """Edge j of a cell joins its nodes j and j + 1."""
    for cell, edges in zip(twin.cells, cell_edges, strict=True):
        assert [set(rows[e][:2]) for e in edges] == [set(side) for side in sides_of(cell)]


@pytest.mark.parametrize("name", sorted(FORMATS))
@pytest.mark.parametrize("mesh", ["three components", "one triangle", "torus"])
def test_arrays_are_int32_and_the_format_s_own(mesh, name):
    """Nothing is shared with the mesh: whoever changes that later has not changed what is stored."""
    mesh = ALL[mesh]()
    net = PolygonNet(mesh, FORMATS[name])
    digest = net.answer().digest
    for array in net.storage:
        assert array.dtype == np.int32
        assert array.flags["C_CONTIGUOUS"]
        assert array.flags["WRITEABLE"]
        assert not any(np.shares_memory(array, ours) for ours in (mesh.starts, mesh.nodes, mesh.conditions))
    mesh.starts[:], mesh.nodes[:], mesh.conditions[:] = 0, 0, 0
    assert net.answer().digest == digest


@every_mesh
def test_by_node(mesh):
    """Node before cell; a boundary node from the right to the left neighbour, its condition last; corners list themselves."""
    twin, storage = stored(mesh, "by-node")
    neighbours, cells = take_lists(storage.lists, storage.neighbours, storage.cells)
    for v, (nodes, around) in enumerate(zip(neighbours, cells, strict=True)):
        corner = nodes[-1] == v
        count = len(nodes) - corner
        inner = count - is_boundary(twin, v)
        for j in range(inner):  # cell j lies between neighbours j and j + 1
            assert twin.owner[v, nodes[j]] == twin.owner[nodes[(j + 1) % count], v] == around[j]
        if is_boundary(twin, v):
            assert (v, nodes[0]) == right_side(twin, v)
            left, right = twin.condition[nodes[count - 1], v], twin.condition[v, nodes[0]]
            assert around[inner:] == ([left, right] if left != right else [left])
            assert corner == (left != right)
        else:
            assert not corner
        assert set(nodes[:count]) == {w for edge in twin.edges if v in edge for w in edge} - {v}
    assert [cell[0] for cell in twin.cells] == storage.cell_node


@every_mesh
def test_by_edge(mesh):
    """E1 is the next edge counter-clockwise around V1 and a side of C1, E2 around V2 and of C2; the boundary closes, too."""
    twin, storage = stored(mesh, "by-edge")
    rows = storage.edge
    check_edges(twin, [row[:4] for row in rows])
    check_node_edges(twin, [row[:4] for row in rows], storage.node_edge)
    for v1, v2, c1, c2, e1, e2 in rows:
        for v, other, c, e in ((v1, v2, c1, e1), (v2, v1, c2, e2)):
            (end,) = set(rows[e][:2]) - {v}
            if c >= 0:  # in the cell the next edge counter-clockwise around v is the side that ends there
                cell = twin.cells[c]
                place = cell.index(v)
                assert (cell[place - 1], cell[(place + 1) % len(cell)]) == (end, other)
            else:  # from the left boundary edge on to the right one, through where no cell is
                assert (v, end) == right_side(twin, v)
                assert rows[e][2] < 0
                assert (other, v) in twin.owner
    for cell, e in zip(twin.cells, storage.cell_edge, strict=True):
        assert set(rows[e][:2]) == {cell[-1], cell[0]}


@every_mesh
def test_by_cell(mesh):
    """Node before cell: neighbour j beyond nodes j and j + 1; a boundary node's cell has its right boundary side."""
    twin, storage = stored(mesh, "by-cell")
    nodes, neighbours = take_lists(storage.lists, storage.nodes, storage.neighbours)
    assert nodes == twin.cells
    for cell, around in zip(nodes, neighbours, strict=True):
        for (a, b), c in zip(sides_of(cell), around, strict=True):
            assert twin.owner.get((b, a), twin.condition[a, b]) == c
            assert c != 0 or (b, a) in twin.owner
    for v, c in enumerate(storage.node_cell):
        assert v in nodes[c]
        if is_boundary(twin, v):
            assert c == twin.owner[right_side(twin, v)]


@every_mesh
def test_edge_cell(mesh):
    twin, storage = stored(mesh, "edge-cell")
    check_edges(twin, storage.edge)
    check_node_edges(twin, storage.edge, storage.node_edge)
    check_cell_edges(twin, storage.edge, take_lists(storage.lists, storage.cell_edges))


@every_mesh
def test_edge_cell_node(mesh):
    """A node's edges follow one another around a cell each; boundary edges are first, the right one, and last."""
    twin, storage = stored(mesh, "edge-cell-node")
    rows = storage.edge
    check_edges(twin, rows)
    check_cell_edges(twin, rows, take_lists(storage.lists, storage.cell_edges))
    node_edges = take_lists(storage.node_lists, storage.node_edges)
    check_node_edges(twin, rows, [edges[0] for edges in node_edges])
    for v, edges in enumerate(node_edges):
        ends = [rows[e][1] if rows[e][0] == v else rows[e][0] for e in edges]
        boundary = is_boundary(twin, v)
        assert [rows[e][2] < 0 for e in edges] == [boundary, *[False] * (len(edges) - 2), boundary]
        for one, other in zip(ends, ends[1:] if boundary else ends[1:] + ends[:1], strict=not boundary):
            assert twin.owner[v, one] == twin.owner[other, v]
        if boundary:
            assert (ends[-1], v) in twin.owner
            assert rows[edges[-1]][0] == v
        assert {frozenset((v, end)) for end in ends} == {edge for edge in twin.edges if v in edge}
        assert len(ends) == len(set(ends))


@every_mesh
def test_half_edge(mesh):
    """h ^ 1 is the other side; after and before are inverse; what runs outside follows the boundary, and has its conditions."""
    twin, storage = stored(mesh, "half-edge")
    half = storage.half
    sides = []
    for h, (target, following, previous, c) in enumerate(half):
        origin = half[h ^ 1][TARGET]
        assert half[following][PREVIOUS] == half[previous][NEXT] == h
        assert half[following ^ 1][TARGET] == target
        assert half[previous][TARGET] == origin
        if c >= 0:
            assert twin.owner[origin, target] == c == half[following][CELL]
            sides.append((origin, target))
        else:
            assert twin.condition[target, origin] == c
            assert half[h ^ 1][CELL] >= 0 > half[following][CELL]
            assert (origin, target) not in twin.owner
    assert sorted(sides) == sorted(twin.owner)
    assert len(half) == 2 * len(twin.edges)
    for c, h in enumerate(storage.cell_half):
        assert (half[h ^ 1][TARGET], half[h][TARGET], half[h][CELL]) == (twin.cells[c][-1], twin.cells[c][0], c)
    for v, h in enumerate(storage.node_half):
        assert half[h ^ 1][TARGET] == v
        if is_boundary(twin, v):
            assert (v, half[h][TARGET]) == right_side(twin, v)
            assert half[h][CELL] >= 0 > half[h ^ 1][CELL]


@every_mesh
def test_tables(mesh):
    """Compressed rows: starts from 0 to the number of items, the two lists of an element beside each other."""
    twin, storage = stored(mesh, "tables")
    for starts, rows, queries in (
        (storage.cell_starts, (storage.cell_nodes, storage.cell_neighbours), ("cell-nodes", "cell-neighbours")),
        (storage.node_starts, (storage.node_neighbours, storage.node_cells), ("node-neighbours", "node-cells")),
    ):
        lists = [(begin, end - begin) for begin, end in pairwise(starts)]
        assert all(length >= 2 for _, length in lists)
        assert take_lists(lists, *rows) == [twin.lists(query) for query in queries]
