"""Hilbert keys: a curve through every cell, from neighbour to neighbour; and the order along it."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tetrabench.mesh.hilbert import BITS, BLOCK, hilbert_keys, hilbert_order

CELLS = st.integers(0, 2**BITS - 1)


def skilling(cell: list[int], bits: int) -> int:
    """The key of a cell as the paper has it: from axes to the transpose of the key, in place, then its bits in turn."""
    x = list(cell)
    q = 1 << (bits - 1)
    while q > 1:
        p = q - 1
        for i in range(3):
            if x[i] & q:
                x[0] ^= p
            else:
                t = (x[0] ^ x[i]) & p
                x[0] ^= t
                x[i] ^= t
        q >>= 1
    for i in (1, 2):
        x[i] ^= x[i - 1]
    t, q = 0, 1 << (bits - 1)
    while q > 1:
        if x[2] & q:
            t ^= q - 1
        q >>= 1
    x = [axis ^ t for axis in x]
    return int("".join(str(axis >> bit & 1) for bit in reversed(range(bits)) for axis in x), 2)


@given(st.lists(st.tuples(CELLS, CELLS, CELLS), max_size=2 * BLOCK))
def test_keys_are_those_of_the_paper(cells: list[tuple[int, int, int]]) -> None:
    corners = [(0, 0, 0), (2**BITS - 1,) * 3]  # so that the box has one unit of length a cell
    keys = hilbert_keys(np.array([*corners, *cells], np.float64))
    assert keys.dtype == np.uint64
    assert keys.tolist() == [skilling(list(cell), BITS) for cell in (*corners, *cells)]


@pytest.mark.parametrize("bits", [1, 2, 3, 4])
def test_curve_visits_every_cell_of_a_grid_from_neighbour_to_neighbour(bits: int, rng: np.random.Generator) -> None:
    grid = rng.permutation(np.indices((2**bits,) * 3).reshape(3, -1).T.astype(np.float64))
    keys = hilbert_keys(grid * 0.3 - 7, bits)
    assert sorted(keys.tolist()) == list(range(8**bits))
    steps = np.diff(grid[np.argsort(keys)], axis=0)
    assert (np.abs(steps).sum(axis=1) == 1).all()


@pytest.mark.parametrize("bits", [1, 5, 20])
def test_fewer_bits_are_the_first_ones_of_more(bits: int, rng: np.random.Generator) -> None:
    points = rng.normal(size=(500, 3))
    assert np.array_equal(hilbert_keys(points, bits), hilbert_keys(points) >> 3 * (BITS - bits))


def test_the_longest_edge_of_the_box_sets_the_scale(rng: np.random.Generator) -> None:
    """What is nearly flat is not pulled up to the height of the cube."""
    flat = np.concatenate([rng.random((300, 2)), np.full((300, 1), 5.0)], axis=1)
    nearly = flat + rng.uniform(0, 1e-9, (300, 1)) * [0, 0, 1]
    assert np.array_equal(hilbert_keys(flat, 10), hilbert_keys(nearly, 10))
    assert len(np.unique(hilbert_keys(flat))) == 300


@given(
    st.lists(st.tuples(*[st.sampled_from([0.0, 0.1, 0.2, 0.7, 1.0, np.nan])] * 3), max_size=100), st.integers(1, BITS)
)
def test_equal_keys_keep_their_order(rows: list[tuple[float, float, float]], bits: int) -> None:
    points = np.array(rows, np.float64).reshape(-1, 3)
    order = hilbert_order(points, bits)
    assert order.dtype == np.int64
    assert order.tolist() == np.argsort(hilbert_keys(points, bits), kind="stable").tolist()


def test_neighbours_along_the_curve_are_near_in_space(rng: np.random.Generator) -> None:
    points = rng.random((3000, 3))
    length = np.linalg.norm(np.diff(points[hilbert_order(points)], axis=0), axis=1)
    assert length.mean() < 1.5 * len(points) ** (-1 / 3)  # at random it is 0.66


def test_points_in_one_place_and_no_points() -> None:
    for points in (np.empty((0, 3)), np.array([[1.0, 2.0, 3.0]]), np.full((70, 3), -4.5)):
        assert hilbert_keys(points).tolist() == [0] * len(points)
        assert hilbert_order(points).tolist() == list(range(len(points)))


def test_points_on_a_line_are_told_apart() -> None:
    line = np.outer(np.linspace(-1, 1, 100), [0, 0, 1])
    assert len(np.unique(hilbert_keys(line))) == 100


@pytest.mark.parametrize("size", [5e-324, 1e-300, 1.7e308])
def test_no_size_is_too_small_or_too_large(size: float) -> None:
    corners = np.array([[-1, -1, -1], [1, 1, 1], [-1, 1, 1]], np.float64) * size
    expected = hilbert_keys(corners / size) if size > 1e-323 else np.zeros(3, np.uint64)
    assert np.array_equal(hilbert_keys(corners), expected)


def test_what_is_not_finite_is_taken_as_on_the_border_and_changes_no_others_key(rng: np.random.Generator) -> None:
    points = np.concatenate([np.zeros((1, 3)), np.ones((1, 3)), rng.random((100, 3))])
    strange = np.array([[np.inf, 0.3, 0.4], [0.6, -np.inf, 0.5], [0.5, 0.6, np.nan], [np.nan, np.inf, -np.inf]])
    border = np.array([[1.0, 0.3, 0.4], [0.6, 0.0, 0.5], [0.5, 0.6, 0.0], [0.0, 1.0, 0.0]])
    keys = hilbert_keys(np.concatenate([points, strange]))
    assert np.array_equal(keys, hilbert_keys(np.concatenate([points, border])))
    assert np.array_equal(keys[:-4], hilbert_keys(points))
    assert hilbert_keys(np.full((70, 3), np.nan)).tolist() == [0] * 70  # no box at all


def test_bits_out_of_range() -> None:
    for bits in (0, 22):
        with pytest.raises(ValueError, match=f"1 to 21 bits an axis, not {bits}"):
            hilbert_keys(np.zeros((1, 3)), bits)
