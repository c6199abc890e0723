"""Make a tree: all objects are inserted one after the other, in an order at random.

Source: section 3.2. In the order of their places the tree would be a chain; objects that come along a curve do so, too.
"""

import numpy as np

from tetrabench.backends.collision.kdtree.insert import insert_movers
from tetrabench.backends.collision.kdtree.storage import MOVERS, OWN_LEAF, PER_LEAF, PER_OBJECT, KdTree, empty_tree
from tetrabench.collision.objects import Floats
from tetrabench.protocols import Options

SEED = 2025
"""Of the order: the same for all."""


def make_kdtree(x: Floats, y: Floats, r: Floats, values: Options) -> KdTree:
    """A tree that finds all contacts."""
    return plant(x, y, r, values, PER_LEAF if values["per_leaf"] else PER_OBJECT)


def make_leaf_only(x: Floats, y: Floats, r: Floats, values: Options) -> KdTree:
    """A tree that searches leaves alone."""
    return plant(x, y, r, values, OWN_LEAF)


def plant(x: Floats, y: Floats, r: Floats, values: Options, search: int) -> KdTree:
    """A tree with the options of both."""
    tree = empty_tree(
        r, values["capacity"], recycles=bool(values["recycle"]), by_median=bool(values["median"]), search=search
    )
    tree.movers[:] = np.random.default_rng(SEED).permutation(len(r))
    tree.state[MOVERS] = len(r)
    planted: KdTree = insert_movers(tree, x, y)
    return planted
