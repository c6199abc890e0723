"""Self-audit of a net: everything it stores, checked against everything else it stores."""

from typing import Any

import numpy as np

from tetrabench.jit import kernel
from tetrabench.tetra.geometry import side_geometry, signed_volume
from tetrabench.tetra.interface import (
    NONE,
    STATES,
    Net,
    centroid,
    first_tetra,
    incidence_faults,
    neighbour,
    next_tetra,
    number_of_tetras,
    side_area,
    side_normal,
    slot_faults,
    state,
    tetras_around,
    vertex,
    volume,
)
from tetrabench.tetra.nearest import COUNT as NODES
from tetrabench.tetra.nearest import DEPTH, NOTHING, ROOT
from tetrabench.tetra.points import COUNT

CHECKS = {
    "slots": "the bookkeeping of free slots contradicts itself",
    "iteration": "iteration does not visit each live tetra once",
    "vertices": "a tetra has a vertex twice, or one that is no point",
    "neighbours": "neighbours are not mutual, or do not share the side, or one that is there is missing",
    "geometry": "static data is not that of the points",
    "states": "a state is not finite",
    "incidence": "the tetras around a point are not those that use it",
    "tree": "the search tree does not hold each point once, in its place",
    "points": "a point is not finite",
}
"""What is checked, by name, with the sentence for a person."""


def audit(net: Net) -> list[str]:
    """What is wrong with a net: names of CHECKS, empty if it is sound. O(n log n), and safe on damaged nets.

    (An address that is no node of the net is never followed; a damaged link of the list of nodes can be.)
    """
    if _slot_faults(net) > 0:
        return ["slots"]  # nothing else can be trusted, not even to end
    faults = np.zeros(len(CHECKS), np.int64)
    refs = np.full(int(number_of_tetras(net)) + 1, NONE)
    visited = _visit(net, refs)
    if visited != len(refs) - 1:
        faults[1] += 1
    refs = np.sort(refs[:visited])
    if (refs[1:] == refs[:-1]).any():
        faults[1] += 1
    elif not faults[1] and _check_vertices(net, refs, faults):
        faults[6] += incidence_faults(net, refs)
        _check_tetras(net, refs, faults)
    _check_tree(net, faults)
    return [name for name, count in zip(CHECKS, faults, strict=True) if count]


@kernel
def _slot_faults(net: Net) -> int:
    return slot_faults(net)


@kernel
def _visit(net: Net, refs: Any) -> int:
    """Store the refs in iteration order; gives up when there is one too many."""
    n = 0
    cursor = first_tetra(net)
    while cursor.tetra != NONE and n < len(refs):
        refs[n] = cursor.tetra
        n += 1
        if n < len(refs):
            cursor = next_tetra(net, cursor)
    return n


@kernel
def is_known(refs: Any, t: int) -> Any:
    """Whether t is among refs (n,) int64, ascending."""
    place = np.searchsorted(refs, t)
    return place < len(refs) and refs[place] == t


@kernel
def _check_vertices(net: Net, refs: Any, faults: Any) -> bool:
    """Points, and the vertices of tetras; whether these can be relied upon."""
    points = net.points.counters[COUNT]
    if points < 0 or points > len(net.points.xyz):
        faults[8] += 1
        return False
    for point in range(points):
        for k in range(3):
            faults[8] += int(not np.isfinite(net.points.xyz[point, k]))
    for t in refs:
        for i in range(4):
            v = vertex(net, t, i)
            if v < 0 or v >= points:
                faults[2] += 1
            for j in range(i):
                faults[2] += int(vertex(net, t, j) == v)
    return faults[2] == 0


@kernel
def _check_tetras(net: Net, refs: Any, faults: Any) -> None:
    for t in refs:
        for k in range(STATES):
            faults[5] += int(not np.isfinite(state(net, t, k)))
        faults[4] += _geometry_faults(net, t)
        for i in range(4):
            u = neighbour(net, t, i)
            if u == NONE:
                faults[3] += int(faults[6] == 0 and _somebody_behind(net, t, i))
            elif u == t or not is_known(refs, u):
                faults[3] += 1
            else:
                mutual = 0
                for j in range(4):
                    mutual += int(neighbour(net, u, j) == t and _same_side(net, t, i, u, j))
                faults[3] += int(mutual != 1)


@kernel
def _geometry_faults(net: Net, t: int) -> int:
    """Static data that is not, bit for bit, what the points give."""
    xyz = net.points.xyz
    p = (vertex(net, t, 0), vertex(net, t, 1), vertex(net, t, 2), vertex(net, t, 3))
    faults = int(volume(net, t) != abs(signed_volume(xyz, p[0], p[1], p[2], p[3])))
    for k in range(3):
        faults += int(centroid(net, t, k) != (xyz[p[0], k] + xyz[p[1], k] + xyz[p[2], k] + xyz[p[3], k]) / 4.0)
    for i in range(4):
        area, x, y, z = side_geometry(xyz, p[(i + 1) & 3], p[(i + 2) & 3], p[(i + 3) & 3], p[i])
        faults += int(side_area(net, t, i) != area)
        faults += int(side_normal(net, t, i, 0) != x)
        faults += int(side_normal(net, t, i, 1) != y)
        faults += int(side_normal(net, t, i, 2) != z)
    return faults


@kernel
def _same_side(net: Net, t: int, i: int, u: int, j: int) -> bool:
    """Whether side i of t and side j of u have the same three vertices."""
    same = 0
    for a in range(4):
        for b in range(4):
            same += int(a != i and b != j and vertex(net, t, a) == vertex(net, u, b))
    return same == 3


@kernel
def _somebody_behind(net: Net, t: int, i: int) -> bool:
    """Whether another tetra has side i of t."""
    for u in tetras_around(net, vertex(net, t, (i + 1) & 3)):
        if u != t:
            for j in range(4):
                if _same_side(net, t, i, u, j):
                    return True
    return False


@kernel
def _check_tree(net: Net, faults: Any) -> None:
    """Each point is one node, with its coordinates, on the right side of every node above it."""
    nodes, count = net.tree.nodes, net.tree.counters[NODES]
    points = net.points.counters[COUNT]
    if count != points or count > len(nodes):
        faults[7] += 1
        return
    if count == 0:
        return
    held, reached = np.zeros(points, np.bool_), np.zeros(points, np.bool_)
    # nodes that wait, each with its depth and the box that the nodes above leave it
    places, depths, boxes = (
        np.empty(count + 1, np.int64),
        np.empty(count + 1, np.int64),
        np.empty((count + 1, 6)),
    )
    places[0], depths[0] = net.tree.counters[ROOT], 1
    boxes[0, :3], boxes[0, 3:] = -np.inf, np.inf
    height, visited, deepest = 1, 0, 0
    while height > 0:
        height -= 1
        place, depth = places[height], depths[height]
        if place < 0 or place >= count or reached[place]:
            faults[7] += 1
            return
        reached[place] = True
        visited += 1
        deepest = max(deepest, depth)
        node = nodes[place]
        point = node["point"]
        if point < 0 or point >= points or held[point]:
            faults[7] += 1
            return
        held[point] = True
        box = boxes[height].copy()
        for k in range(3):
            value = node["at"][k]
            faults[7] += int(value != net.points.xyz[point, k])
            faults[7] += int(not (box[k] <= value and value <= box[3 + k]))
        axis = (depth - 1) % 3
        value = node["at"][axis]
        for child, bound in ((node["left"], 3 + axis), (node["right"], axis)):
            if child != NOTHING:
                if height == count:
                    faults[7] += 1
                    return
                boxes[height] = box
                boxes[height, bound] = value
                places[height], depths[height] = child, depth + 1
                height += 1
    faults[7] += int(visited != points) + int(deepest != net.tree.counters[DEPTH])
