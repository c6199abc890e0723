"""The k-d tree against a linear search, for kind and unkind points."""

import re

import numpy as np
import pytest

from tetrabench.errors import InputError
from tetrabench.tetra import nearest
from tetrabench.tetra.nearest import build_tree, nearest_points
from tetrabench.tetra.points import grown

KINDS = {
    "random": lambda rng: rng.random((400, 3)),
    "grid": lambda rng: np.stack(np.meshgrid(*[np.arange(6.0)] * 3), -1).reshape(-1, 3),
    "line": lambda rng: np.outer(np.linspace(0, 1, 200), [1.0, 2.0, 0.0]),
    "sorted": lambda rng: np.sort(rng.random((300, 3)), axis=0),
    "few values": lambda rng: rng.integers(0, 3, (300, 3)).astype(float),
    "coincident": lambda rng: np.repeat(rng.random((5, 3)), 40, axis=0),
    "all in one place": lambda rng: np.ones((100, 3)),
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


@pytest.mark.parametrize("kind", sorted(KINDS))
def test_a_built_tree_is_balanced_and_sound(kind, rng):
    """Each point once, with its coordinates, on the right side of all above it, no deeper than so many nodes need."""
    points = KINDS[kind](rng)
    tree = build_tree(points)

    def subtree(place, depth):
        """The points under a node, and the longest path."""
        if place == nearest.NOTHING:
            return [], depth
        node, axis = tree.nodes[place], depth % 3
        left, left_depth = subtree(node["left"], depth + 1)
        right, right_depth = subtree(node["right"], depth + 1)
        assert (points[left, axis] <= node["at"][axis]).all()
        assert (points[right, axis] >= node["at"][axis]).all()
        assert (node["at"] == points[node["point"]]).all()
        return [*left, node["point"], *right], max(left_depth, right_depth)

    held, depth = subtree(tree.counters[nearest.ROOT], 0)
    assert sorted(held) == list(range(len(points)))
    assert depth == tree.counters[nearest.DEPTH] == len(points).bit_length()


@pytest.mark.parametrize("kind", sorted(KINDS))
@pytest.mark.parametrize("axis", [0, 1, 2])
def test_selection_parts_a_range(kind, axis, rng):
    points = KINDS[kind](rng)
    nodes = np.zeros(len(points), nearest.NODE)
    low, high = len(points) // 9, len(points) - 1 - len(points) // 7
    for middle in {low, (low + high) // 2, high}:
        nodes["at"], nodes["point"] = points, np.arange(len(points))
        nearest._select(nodes, low, high, middle, axis)
        value = nodes["at"][middle, axis]
        assert (nodes["at"][low:middle, axis] <= value).all()
        assert (nodes["at"][middle : high + 1, axis] >= value).all()
        assert (nodes["at"] == points[nodes["point"]]).all()
        assert sorted(nodes["point"]) == list(range(len(points)))
        outside = [*range(low), *range(high + 1, len(points))]
        assert nodes["point"][outside].tolist() == outside


@pytest.mark.parametrize("shape", [(3,), (4, 2), (2, 2, 3)])
def test_queries_of_another_shape(shape):
    points = np.eye(3)
    with pytest.raises(InputError, match=re.escape(f"(m, 3), not {shape}")):
        nearest_points(build_tree(points), points, np.zeros(shape))


def test_a_query_that_is_no_point_disturbs_no_other(rng):
    points, queries = rng.random((400, 3)), rng.random((50, 3))
    expected = nearest_points(build_tree(points), points, queries)
    queries[7, 1] = np.nan
    expected[7] = -1
    np.testing.assert_array_equal(nearest_points(build_tree(points), points, queries), expected)
