"""Faces: edge-cell in space. A cell lists its faces; a face lists its nodes and knows its cells; a node knows one face. Ours.

No contestant, for no other format here holds polyhedra. Around a node there is no order in space: lists of nodes and of cells
hold each once, in the order of a walk from face to face. All queries fill `out`, int32 and long enough, and return the length
of the list.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.polygon.lists import copy_items, describe_lists
from tetrabench.jit import kernel
from tetrabench.mesh.polyhedron import PolyhedronMesh, check_polyhedra


class Faces(NamedTuple):
    """(j + 2) N + (i + 4) M + L values: N cells of j faces, M faces of i nodes, L nodes.

    Attributes:
        face: (M, 2) int32: C1, C2. A boundary face has the boundary condition as its first cell.
        face_lists: (M, 2) int32: where the nodes of a face start, and how many they are.
        face_nodes: (i M,) int32: counter-clockwise seen from the first cell.
        cell_lists: (N, 2) int32: where the faces of a cell start, and how many they are.
        cell_faces: (j N,) int32.
        node_face: (L,) int32: a boundary node's is a boundary face; -1 for a node of no face.
    """

    face: NDArray[np.int32]
    face_lists: NDArray[np.int32]
    face_nodes: NDArray[np.int32]
    cell_lists: NDArray[np.int32]
    cell_faces: NDArray[np.int32]
    node_face: NDArray[np.int32]


def make_faces(mesh: PolyhedronMesh) -> Faces:
    """The storage of a mesh. Raises InputError: it is none of polyhedra."""
    check_polyhedra(mesh)
    cells = mesh.cells.ravel()  # of the two sides of each face, in turn
    order = np.argsort(cells, kind="stable")
    order = order[np.count_nonzero(cells < 0) :]
    face = np.repeat(np.arange(len(mesh.cells), dtype=np.int32), np.diff(mesh.starts))
    node_face = np.full(len(mesh.points), -1, np.int32)
    outside = mesh.cells[face, 0] < 0
    for chosen in (~outside, outside):  # the latter prevail
        node_face[mesh.nodes[chosen][::-1]] = face[chosen][::-1]
    return Faces(
        mesh.cells.astype(np.int32),
        describe_lists(np.diff(mesh.starts)),
        mesh.nodes.astype(np.int32),
        describe_lists(np.bincount(cells[order]).astype(np.int32)),
        (order // 2).astype(np.int32),
        node_face,
    )


@kernel(allocates=False)
def face_nodes(storage, f, out):
    """The nodes of face f, counter-clockwise seen from its first cell."""
    start, count = np.int64(storage.face_lists[np.uint64(f), 0]), np.int64(storage.face_lists[np.uint64(f), 1])
    copy_items(storage.face_nodes, start, count, out)
    return count


@kernel(allocates=False)
def cell_faces(storage, c, out):
    """The faces of cell c."""
    start, count = np.int64(storage.cell_lists[np.uint64(c), 0]), np.int64(storage.cell_lists[np.uint64(c), 1])
    copy_items(storage.cell_faces, start, count, out)
    return count


@kernel(allocates=False)
def cell_neighbours(storage, c, out):
    """What lies beyond each face of cell c, in the order of its faces: cells, and boundary conditions."""
    start, count = storage.cell_lists[np.uint64(c), 0], np.int64(storage.cell_lists[np.uint64(c), 1])
    for j in range(count):
        f = np.uint64(storage.cell_faces[np.uint64(start + j)])
        out[np.uint64(j)] = storage.face[f, np.uint64(storage.face[f, 0] == c)]
    return count


@kernel(allocates=False)
def cell_nodes(storage, c, out):
    """The nodes of cell c, each once."""
    start, count = storage.cell_lists[np.uint64(c), 0], 0
    for j in range(storage.cell_lists[np.uint64(c), 1]):
        f = np.uint64(storage.cell_faces[np.uint64(start + j)])
        begin = storage.face_lists[f, 0]
        for k in range(storage.face_lists[f, 1]):
            count = add_once(out, count, storage.face_nodes[np.uint64(begin + k)])
    return count


@kernel(allocates=False)
def node_cells(storage, v, out):
    """The cells around node v, each once: those that can be reached from its face over faces that meet in v."""
    f = storage.node_face[np.uint64(v)]
    if f < 0:
        return 0
    out[0] = storage.face[np.uint64(f), 1]
    count, done = 1, 0
    while done < count:  # the list is the queue of the walk
        c = out[np.uint64(done)]
        done += 1
        start = storage.cell_lists[np.uint64(c), 0]
        for j in range(storage.cell_lists[np.uint64(c), 1]):
            f = np.uint64(storage.cell_faces[np.uint64(start + j)])
            beyond = storage.face[f, np.uint64(storage.face[f, 0] == c)]
            if beyond >= 0 and place_in(storage, f, v) >= 0:
                count = add_once(out, count, beyond)
    return count


@kernel(allocates=False)
def node_neighbours(storage, v, cells, out):
    """The nodes that edges join with node v, each once; `cells`: room for the cells around it."""
    count = 0
    for n in range(node_cells(storage, v, cells)):
        c = cells[np.uint64(n)]
        start = storage.cell_lists[np.uint64(c), 0]
        for j in range(storage.cell_lists[np.uint64(c), 1]):
            f = np.uint64(storage.cell_faces[np.uint64(start + j)])
            begin, last = storage.face_lists[f, 0], storage.face_lists[f, 1] - 1
            place = place_in(storage, f, v)
            if place >= 0:
                count = add_once(out, count, storage.face_nodes[np.uint64(begin + (place + 1 if place < last else 0))])
                count = add_once(out, count, storage.face_nodes[np.uint64(begin + (place - 1 if place > 0 else last))])
    return count


@kernel(allocates=False, inline=True)
def place_in(storage, f, v):
    """The place of node v among the nodes of face f, -1 where it is none of them."""
    begin = storage.face_lists[np.uint64(f), 0]
    for k in range(storage.face_lists[np.uint64(f), 1]):
        if storage.face_nodes[np.uint64(begin + k)] == v:
            return k
    return -1


@kernel(allocates=False, inline=True)
def add_once(out, count, item):
    """Put an item at the end of a list of `count`, unless it is there; returns how many there are then."""
    for j in range(count):
        if out[np.uint64(j)] == item:
            return count
    out[np.uint64(count)] = item
    return count + 1
