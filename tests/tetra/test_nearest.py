"""The k-d tree against a linear search, for kind and unkind points."""

import numpy as np
import pytest

from tetrabench.tetra import nearest
from tetrabench.tetra.nearest import build_tree, nearest_points
from tetrabench.tetra.points import grown

KINDS = {
    "random": lambda rng: rng.random((400, 3)),
    "grid": lambda rng: np.stack(np.meshgrid(*[np.arange(6.0)] * 3), -1).reshape(-1, 3),
    "line": lambda rng: np.outer(np.linspace(0, 1, 200), [1.0, 2.0, 0.0]),
    "coincident": lambda rng: np.repeat(rng.random((5, 3)), 40, axis=0),
    "one": lambda rng: np.array([[1.0, 2.0, 3.0]]),
}


def distances(points, queries, refs):
    return ((points[refs] - queries) ** 2).sum(axis=1)


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_against_linear_search(kind, rng):
    points = KINDS[kind](rng)
    queries = np.concatenate([rng.random((200, 3)) * 3 - 1, points])
    found = nearest_points(build_tree(points), points, queries)
    assert found.dtype == np.int32
    best = ((queries[:, None] - points[None]) ** 2).sum(axis=2).min(axis=1)
    np.testing.assert_array_equal(distances(points, queries, found), best)


def test_no_points():
    assert nearest_points(build_tree(np.empty((0, 3))), np.empty((0, 3)), np.zeros((2, 3))).tolist() == [
        -1,
        -1,
    ]


@pytest.mark.parametrize("order", ["random", "sorted"])
def test_insertion_keeps_it_right_and_shallow(order, rng):
    points = rng.random((600, 3))
    if order == "sorted":  # each new leaf below the last one: the path would grow without end
        points = points[np.argsort(points[:, 0])]
    tree = build_tree(points[:50])
    tree = tree._replace(nodes=grown(tree.nodes, 600))
    for n in range(50, 600):
        nearest.insert_node(tree, points[: n + 1], n)
    queries = rng.random((300, 3))
    found = nearest_points(tree, points, queries)
    best = ((queries[:, None] - points[None]) ** 2).sum(axis=2).min(axis=1)
    np.testing.assert_array_equal(distances(points, queries, found), best)
    assert tree.counters[nearest.DEPTH] <= nearest.LONGEST_PATH * np.log2(600) + 4
    assert (tree.counters[nearest.REBUILDS] > 0) == (order == "sorted")


def test_balanced(rng):
    tree = build_tree(rng.random((1000, 3)))
    assert tree.counters[nearest.DEPTH] == 10  # the least that 1000 nodes need
