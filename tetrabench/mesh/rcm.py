"""Reverse Cuthill-McKee: an order of points in which those that share an edge are near each other.

E. Cuthill and J. McKee, Reducing the bandwidth of sparse symmetric matrices, 1969; reversed as by A. George, 1971; begun
at a point from which the way to the farthest one is long (A. George and J. W. H. Liu, An implementation of a
pseudoperipheral node finder, 1979). scipy's begins at a point of least degree, and which one that is depends on the
processor, for numpy's sort does.
"""

from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel

Integers = NDArray[np.int64]


def rcm_order(tets: NDArray[np.int32], points: int) -> NDArray[np.int64]:
    """Order points by reverse Cuthill-McKee on the graph of the edges, one component after the other.

    Args:
        tets: (m, 4) int32, vertices of each tetra, from 0 to points - 1.
        points: the number of points.

    Returns:
        (points,) int64, the rows of the points in their new order; those that no tetra uses come last, in their order.
    """
    starts, ends = np.concatenate([tets[:, pair] for pair in combinations(range(4), 2)]).T
    return rcm_order_of_edges(starts, ends, points)


def rcm_order_of_edges(starts: NDArray[np.int32], ends: NDArray[np.int32], points: int) -> NDArray[np.int64]:
    """As `rcm_order`, on the edges from `starts` to `ends`, (k,) int32 each, in either direction and as often as they
    come."""
    from scipy.sparse import coo_array

    if not points:  # scipy takes no empty graph
        return np.arange(0)
    both = np.concatenate([starts, ends]), np.concatenate([ends, starts])
    edges = coo_array((np.ones(len(both[0]), bool), both), shape=(points, points)).tocsr()
    degrees = np.diff(edges.indptr).astype(np.int64)
    # The points next to each one in order of their degrees, equal ones in their own order.
    keys = np.repeat(np.arange(points), degrees) << 32 | degrees[edges.indices]
    others = edges.indices[np.argsort(keys, kind="stable")].astype(np.int64)
    order = np.empty(points, np.int64)
    by_degree = np.argsort(degrees, kind="stable")
    used = by_degree[degrees[by_degree] > 0]
    put_components(edges.indptr.astype(np.int64), others, degrees, used, order)
    order[: len(used)] = order[: len(used)][::-1].copy()
    order[len(used) :] = np.flatnonzero(degrees == 0)
    return order


@kernel
def put_components(starts: Integers, others: Integers, degrees: Integers, firsts: Integers, order: Integers) -> None:
    """Put the points of one component after the other into `order`, each nearest to its first point first.

    Args:
        starts: (n + 1,), where the points next to each one begin in `others`.
        others: the points next to each one, in order of their degrees.
        degrees: (n,), how many these are.
        firsts: where a component may begin, in order of degrees.
        order: out, (n,).
    """
    levels = np.full(len(degrees), -1)
    place = 0
    for candidate in firsts:
        if levels[candidate] < 0:
            first, farthest = candidate, -1
            end = spread(starts, others, first, place, levels, order)
            # From the end of a long way the way to the farthest point may be longer still.
            while levels[order[end - 1]] > farthest:
                farthest = levels[order[end - 1]]
                first = order[end - 1]
                for n in range(end - 1, place, -1):
                    if levels[order[n]] == farthest and degrees[order[n]] <= degrees[first]:
                        first = order[n]
                for n in range(place, end):
                    levels[order[n]] = -1
                spread(starts, others, first, place, levels, order)
            place = end


@kernel
def spread(starts: Integers, others: Integers, first: int, place: int, levels: Integers, order: Integers) -> int:
    """Put the points of a component into `order` from `place` on, those next to each one behind it, and the number of
    edges from the first one into `levels`, -1 for those not met so far; return the place behind the last."""
    order[place], levels[first] = first, 0
    end = place + 1
    while place < end:
        point = order[place]
        place += 1
        for n in range(starts[point], starts[point + 1]):
            if levels[others[n]] < 0:
                levels[others[n]] = levels[point] + 1
                order[end] = others[n]
                end += 1
    return end
