"""Reverse Cuthill-McKee against a naive twin: the same order on every machine."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tetrabench.mesh import TetraMesh
from tetrabench.mesh.models import generate
from tetrabench.mesh.rcm import rcm_order


def naive(tets: list[list[int]], points: int) -> list[int]:
    """In plain Python, from the definition."""
    around: list[set[int]] = [set() for _ in range(points)]
    for four in tets:
        for point in four:
            around[point] |= set(four) - {point}

    def by_degree(some: set[int]) -> list[int]:
        return sorted(some, key=lambda point: (len(around[point]), point))

    def levels_from(first: int) -> dict[int, int]:
        """The points of a component in the order in which they are met, and how far they are."""
        levels = {first: 0}
        for point in (queue := [first]):
            for other in by_degree(around[point] - levels.keys()):
                levels[other] = levels[point] + 1
                queue.append(other)
        return levels

    order: list[int] = []
    for first in by_degree({point for point in range(points) if around[point]}):
        if first not in order:
            levels, length = levels_from(first), -1
            while max(levels.values()) > length:
                length = max(levels.values())
                last = [point for point, level in levels.items() if level == length]
                levels = levels_from(min(last, key=lambda point: len(around[point])))
            order += levels
    return order[::-1] + [point for point in range(points) if not around[point]]


def test_order_is_that_of_the_naive_twin(small_mesh: TetraMesh) -> None:
    points = len(small_mesh.points)
    assert rcm_order(small_mesh.tets, points).tolist() == naive(small_mesh.tets.tolist(), points)


@given(st.lists(st.lists(st.integers(0, 19), min_size=4, max_size=4, unique=True), max_size=9), st.integers(20, 22))
def test_order_of_anything(tets: list[list[int]], points: int) -> None:
    """Several components, and points without a tetra, at the end too."""
    order = rcm_order(np.array(tets, np.int32).reshape(-1, 4), points)
    assert order.dtype == np.int64
    assert order.tolist() == naive(tets, points)


@pytest.mark.parametrize("name", ["intake", "box"])
def test_order_of_a_model_numbered_at_random(name: str) -> None:
    mesh = generate(name, 1000, numbering="shuffled")
    assert rcm_order(mesh.tets, len(mesh.points)).tolist() == naive(mesh.tets.tolist(), len(mesh.points))
