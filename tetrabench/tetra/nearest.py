"""Nearest point: a balanced k-d tree, a point in each node, median splits by x, y, z in turn.

Search with incremental distances to the cells (Arya and Mount, Algorithms for fast vector quantization, 1993).
Points may be inserted, each as a new leaf; the tree is built anew when its longest path has become too long.
"""

from typing import Any, NamedTuple

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.jit import kernel
from tetrabench.mesh.hilbert import hilbert_order
from tetrabench.tetra.points import grown

COUNT, ROOT, DEPTH, REBUILDS = 0, 1, 2, 3  # places in the counters
NOTHING = -1

LONGEST_PATH = 2.5
"""The tree is rebuilt when its longest path exceeds this multiple of log2 of the points (plus 4 for small nets)."""

NODE = np.dtype([("at", np.float64, 3), ("left", np.int32), ("right", np.int32), ("point", np.int32)], align=True)

RANGE = np.dtype([(name, np.int64) for name in ("begin", "end", "axis")])

_DEEPEST = 192  # longer than any path that `insert_node` lets be
_FINE = 10  # bits an axis of the Hilbert curve along which queries are taken: what one cell needs fits into a cache
_LONG = 64  # nodes from which on the pivot of a partition is chosen among nine


class Tree(NamedTuple):
    """A k-d tree of points.

    Attributes:
        nodes: (capacity,) records of NODE: coordinates (a copy, to be found where the search is), children, point ref.
        counters: (4,) int64: COUNT nodes, ROOT node, DEPTH (nodes on the longest path), REBUILDS so far.
    """

    nodes: NDArray[np.void]
    counters: NDArray[np.int64]


def build_tree(points: NDArray[np.float64]) -> Tree:
    """A balanced tree of the points (n, 3) float64, finite."""
    points = np.require(points, np.float64, ["C", "W", "O"])
    tree = Tree(np.zeros(len(points), NODE), np.zeros(4, np.int64))
    rebuild(tree, points, len(points))
    return tree


def nearest_points(tree: Tree, points: NDArray[np.float64], queries: NDArray[np.float64]) -> NDArray[np.int32]:
    """The point nearest to each query.

    Args:
        tree: from `build_tree(points)`.
        points: (n, 3) float64, the points that the tree was built from. (The tree keeps a copy of the coordinates;
            they are asked for so that a leaner tree can take this one's place.)
        queries: (m, 3) float64.

    Returns:
        (m,) int32 indices into `points`, -1 where there is no point at all, or the query is none (NaN, or too far away
        for a distance). Of several equally near ones, any.

    Raises:
        InputError: queries of another shape.
    """
    queries = np.require(queries, np.float64, ["C", "W", "O"])
    if queries.ndim != 2 or queries.shape[1] != 3:
        raise InputError(f"queries have the shape (m, 3), not {queries.shape}")
    found = np.empty(len(queries), np.int32)
    # in an order in which one search finds in the cache what the last one left there: twice as fast at random
    _search_all(tree, queries, hilbert_order(queries, _FINE), found)
    return found


@kernel
def _search_all(tree: Tree, queries: Any, order: Any, found: Any) -> None:
    stack = make_stack()
    for q in order:
        found[q] = nearest_point(tree, queries[q, 0], queries[q, 1], queries[q, 2], stack)[0]


@kernel
def make_stack() -> Any:
    """Room for one search after another: rows of (distance to the cell, its three parts, node, axis)."""
    return np.empty((_DEEPEST, 6), np.float64)


@kernel(allocates=False)
def nearest_point(tree: Tree, x: float, y: float, z: float, stack: Any) -> tuple[Any, float]:
    """The point nearest to (x, y, z) and the square of its distance; (-1, inf) in an empty tree."""
    best: Any = np.int64(NOTHING)
    best_distance = np.inf
    height = 0
    if tree.counters[ROOT] != NOTHING:
        stack[0, 0] = stack[0, 1] = stack[0, 2] = stack[0, 3] = 0.0
        stack[0, 4], stack[0, 5] = float(tree.counters[ROOT]), 0.0
        height = 1
    while height > 0:
        height -= 1
        cell_distance = stack[height, 0]
        if cell_distance >= best_distance:
            continue
        # how far the cell is from the query along each axis
        away_x, away_y, away_z = stack[height, 1], stack[height, 2], stack[height, 3]
        place, axis = np.int64(stack[height, 4]), np.int64(stack[height, 5])
        while place != NOTHING:
            node = tree.nodes[place]
            dx, dy, dz = x - node["at"][0], y - node["at"][1], z - node["at"][2]
            distance = dx * dx + dy * dy + dz * dz
            if distance < best_distance:
                best, best_distance = np.int64(node["point"]), distance
            beyond = dx if axis == 0 else (dy if axis == 1 else dz)
            away = away_x if axis == 0 else (away_y if axis == 1 else away_z)
            near, far = np.int64(node["left"]), np.int64(node["right"])
            if beyond >= 0.0:
                near, far = far, near
            following: Any = axis + 1 if axis < 2 else 0
            far_distance = cell_distance - away * away + beyond * beyond
            if far != NOTHING and far_distance < best_distance:
                stack[height, 0] = far_distance
                stack[height, 1] = beyond if axis == 0 else away_x
                stack[height, 2] = beyond if axis == 1 else away_y
                stack[height, 3] = beyond if axis == 2 else away_z
                stack[height, 4], stack[height, 5] = float(far), float(following)
                height += 1
            place, axis = near, following
    return best, best_distance


@kernel(allocates=False)
def insert_node(tree: Tree, points: Any, point: int) -> None:
    """Insert a point as a leaf; the room was made before. Rebuilds the whole tree where its path gets too long.

    `points` is (n, 3) float64 and holds all points up to this one.
    """
    place = tree.counters[COUNT]
    node = tree.nodes[place]
    for k in range(3):
        node["at"][k] = points[point, k]
    node["left"] = node["right"] = NOTHING
    node["point"] = point
    tree.counters[COUNT] = place + 1
    depth = 1
    if tree.counters[ROOT] == NOTHING:
        tree.counters[ROOT] = place
    else:
        parent, axis = tree.counters[ROOT], 0
        while True:
            depth += 1
            at = tree.nodes[parent]["at"][axis]
            child = tree.nodes[parent]["left"] if points[point, axis] < at else tree.nodes[parent]["right"]
            if child == NOTHING:
                if points[point, axis] < at:
                    tree.nodes[parent]["left"] = place
                else:
                    tree.nodes[parent]["right"] = place
                break
            parent, axis = np.int64(child), axis + 1 if axis < 2 else 0
    if depth > tree.counters[DEPTH]:
        tree.counters[DEPTH] = depth
        if depth > LONGEST_PATH * np.log2(place + 1.0) + 4.0:
            tree.counters[REBUILDS] += 1
            rebuild(tree, points, place + 1)


@register_jitable
def grown_tree(tree: Tree, capacity: int) -> Tree:
    """The same tree with room for `capacity` nodes, and counters of its own."""
    return Tree(grown(tree.nodes, capacity), tree.counters.copy())


@kernel
def rebuild(tree: Tree, points: Any, count: int) -> None:
    """Build the tree of the first `count` points, in the nodes that it has. O(n log n).

    A subtree is a range of nodes: its root, then its left subtree, then its right one.
    """
    nodes = tree.nodes
    for n in range(count):
        for k in range(3):
            nodes[n]["at"][k] = points[n, k]
        nodes[n]["point"] = n
    tree.counters[COUNT] = count
    tree.counters[ROOT] = 0 if count > 0 else NOTHING
    tree.counters[DEPTH] = 0
    while 1 << tree.counters[DEPTH] <= count:
        tree.counters[DEPTH] += 1
    waiting = np.empty(_DEEPEST, RANGE)
    waiting[0]["begin"], waiting[0]["end"], waiting[0]["axis"] = 0, count, 0
    height = 1
    while height > 0:
        height -= 1
        begin, end, axis = waiting[height]["begin"], waiting[height]["end"], waiting[height]["axis"]
        while begin < end:  # the right subtree waits
            middle = begin + (end - begin) // 2
            _select(nodes, begin, end - 1, middle, axis)
            _swap(nodes, begin, middle)
            nodes[begin]["left"] = begin + 1 if begin < middle else NOTHING
            nodes[begin]["right"] = middle + 1 if middle + 1 < end else NOTHING
            axis = axis + 1 if axis < 2 else 0
            if middle + 1 < end:
                waiting[height]["begin"], waiting[height]["end"], waiting[height]["axis"] = middle + 1, end, axis
                height += 1
            begin, end = begin + 1, middle + 1


@kernel(allocates=False)
def _select(nodes: Any, low: int, high: int, middle: int, axis: int) -> None:
    """Quickselect: what is left of `middle` is at most, what is right of it at least what stands there.

    Hoare, Algorithm 65: Find, 1961, with Lomuto's partition: each node is swapped, so that nothing depends on the outcome
    of a comparison but the place where the next one goes. A processor could not foresee it.
    """
    while low < high:
        _swap(nodes, _pivot(nodes, low, high, axis), high)
        value = nodes[high]["at"][axis]
        first: Any = low
        for n in range(low, high):
            less = np.int64(nodes[n]["at"][axis] < value)
            _swap(nodes, n, first)
            first += less
        _swap(nodes, first, high)
        last = first
        if first == low:  # nothing is less: what is equal goes beside it, or many equal ones would take quadratic time
            for n in range(low + 1, high + 1):
                if nodes[n]["at"][axis] == value:
                    last += 1
                    _swap(nodes, n, last)
        if middle > last:
            low = last + 1
        elif middle < first:
            high = first - 1
        else:
            low = high


@kernel(allocates=False)
def _pivot(nodes: Any, low: int, high: int, axis: int) -> int:
    """A node not far from the median: of three, in a long range of three such medians (Tukey's ninther)."""
    step, middle = (high - low) // 8, (low + high) // 2
    if high - low < _LONG:
        return _median(nodes, axis, low, middle, high)
    return _median(
        nodes,
        axis,
        _median(nodes, axis, low, low + step, low + 2 * step),
        _median(nodes, axis, middle - step, middle, middle + step),
        _median(nodes, axis, high - 2 * step, high - step, high),
    )


@kernel(allocates=False, inline=True)
def _median(nodes: Any, axis: int, a: int, b: int, c: int) -> int:
    """The one of three nodes whose coordinate is between the others'."""
    x, y, z = nodes[a]["at"][axis], nodes[b]["at"][axis], nodes[c]["at"][axis]
    if y < x:
        a, b, x, y = b, a, y, x
    return a if z < x else (c if z < y else b)


@kernel(allocates=False, inline=True)
def _swap(nodes: Any, a: int, b: int) -> None:
    """Exchange two nodes that have no children yet."""
    for k in range(3):
        nodes[a]["at"][k], nodes[b]["at"][k] = nodes[b]["at"][k], nodes[a]["at"][k]
    nodes[a]["point"], nodes[b]["point"] = nodes[b]["point"], nodes[a]["point"]
