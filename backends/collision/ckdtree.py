"""ckdtree: scipy's k-d tree, built anew in each step: what a user of Python would take. It is no storage for kernels.

Source: scipy.spatial.cKDTree (median splits, sliding midpoint where it is not balanced), `query_pairs`.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.spatial import cKDTree

from tetrabench.collision import interface
from tetrabench.collision.objects import Floats
from tetrabench.jit import implements
from tetrabench.protocols import Options

MARGIN = 1 + 1e-9
"""The tree rounds distances in its own way: it is asked for a little more, and the interface's test decides."""


class ScipyTree(NamedTuple):
    """A tree and how it is built; `reach`: the largest sum of two radii; `rebuilds`: built so often after the first time."""

    tree: Any
    reach: float
    capacity: int
    is_balanced: bool
    rebuilds: int


def make_ckdtree(x: Floats, y: Floats, r: Floats, values: Options) -> ScipyTree:
    """The tree of where they are."""
    reach = 2 * float(r.max(initial=0.0))
    storage = ScipyTree(None, reach, values["capacity"], bool(values["balanced"]), -1)
    built: ScipyTree = update(storage, x, y)
    return built


@implements(interface.update, ScipyTree)
def update(storage, x, y):
    tree = cKDTree(
        np.column_stack([x, y]),
        leafsize=storage.capacity,
        balanced_tree=storage.is_balanced,
        compact_nodes=storage.is_balanced,
    )
    return storage._replace(tree=tree, rebuilds=storage.rebuilds + 1)


@implements(interface.pairs, ScipyTree)
def pairs(storage, x, y, r, out):
    near = storage.tree.query_pairs(storage.reach * MARGIN, output_type="ndarray")
    i, j = near[:, 0], near[:, 1]
    dx, dy, reach = x[i] - x[j], y[i] - y[j], r[i] + r[j]
    found = near[dx * dx + dy * dy < reach * reach]
    room = min(len(found), len(out))
    out[:room] = found[:room]
    return len(found)


@implements(interface.query_rect, ScipyTree)
def query_rect(storage, x, y, x_low, y_low, x_high, y_high, out):
    if not (x_low <= x_high and y_low <= y_high) or storage.tree.n == 0:
        return 0
    (left, bottom), (right, top) = storage.tree.mins, storage.tree.maxes  # ends may be infinite, and a middle may not
    x_low, y_low, x_high, y_high = max(x_low, left), max(y_low, bottom), min(x_high, right), min(y_high, top)
    if not (x_low <= x_high and y_low <= y_high):
        return 0
    middle = (0.5 * x_low + 0.5 * x_high, 0.5 * y_low + 0.5 * y_high)
    half = max(x_high - middle[0], middle[0] - x_low, y_high - middle[1], middle[1] - y_low)
    near = np.array(storage.tree.query_ball_point(middle, half * MARGIN, p=np.inf), np.int64)
    inside = near[(x[near] >= x_low) & (x[near] <= x_high) & (y[near] >= y_low) & (y[near] <= y_high)]
    room = min(len(inside), len(out))
    out[:room] = inside[:room]
    return len(inside)


@implements(interface.stats, ScipyTree)
def stats(storage):
    return {"rebuilds": storage.rebuilds}


@implements(interface.leaf_rectangles, ScipyTree)
def leaf_rectangles(storage):
    rectangles = []

    def visit(node, box):
        if node.split_dim < 0:
            rectangles.append(box)
            return
        below, above = list(box), list(box)
        below[node.split_dim + 2] = above[node.split_dim] = node.split
        visit(node.lesser, below)
        visit(node.greater, above)

    if storage.tree.n:
        visit(storage.tree.tree, [-np.inf, -np.inf, np.inf, np.inf])
    return np.array(rectangles).reshape(-1, 4)


@implements(interface.structure_bytes, ScipyTree)
def structure_bytes(storage):
    tree = storage.tree
    nodes = tree.size * NODE_BYTES
    return {"points": (tree.data.nbytes,) * 2, "indices": (tree.indices.nbytes,) * 2, "nodes": (nodes, nodes)}


NODE_BYTES = 72
"""Of a node of scipy's tree: three counts, a split, its axis, two pointers and two places, as its source declares them."""
