"""Which tetra holds a point: by walking from the nearest point, as the source did it, or by asking every tetra.

A point is in a tetra when none of its four signed volumes is below -INSIDE times the tetra's volume. A point on a side
lies in both tetras, and any of them may be the answer.

`walk` goes through the side that p lies farthest behind, as seen from the tetra it stands in (visibility walk: Devillers,
Pion, Teillaud, Walking in a triangulation, 2002). Where that leaves the net, through its surface or a hole, or gets
nowhere, a grid of bounding boxes decides: a point outside a net that is not convex is normal, and must be cheap.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.jit import kernel
from tetrabench.tetra.geometry import signed_volume
from tetrabench.tetra.incidence import END, first_around, next_around, ref_around
from tetrabench.tetra.interface import (
    NONE,
    Net,
    first_tetra,
    neighbour,
    next_tetra,
    number_of_tetras,
    vertex,
)
from tetrabench.tetra.nearest import make_stack, nearest_point

METHODS = ("walk", "source", "brute")

INSIDE = 1e-12
"""How far outside, as a part of the tetra's volume, still is inside: rounding must not lose a point on a side."""

UNDECIDED = np.int64(-2)
_LONGEST_WALK = 500
_TETRAS_A_CELL = 2.0
_FLATTEST = 1e-3


class Grid(NamedTuple):
    """Tetras by the cells of a regular grid that their bounding boxes touch.

    Attributes:
        low: (3,) float64, corner of the grid; cell: (3,) float64, size of a cell; shape: (3,) int64, cells per axis.
        starts: (cells + 1,) int64; refs: (starts[-1],) int64: the tetras of cell c are refs[starts[c]:starts[c + 1]].
    """

    low: NDArray[np.float64]
    cell: NDArray[np.float64]
    shape: NDArray[np.int64]
    starts: NDArray[np.int64]
    refs: NDArray[np.int64]


def locate(
    net: Net, queries: NDArray[np.float64], method: str = "walk", grid: Grid | None = None
) -> tuple[NDArray[np.int64], Grid | None]:
    """The tetra that holds each query point.

    Args:
        net: the net.
        queries: (m, 3) float64.
        method: "walk"; "source": the tetras around the nearest point, then their side neighbours, then every tetra;
            "brute": every tetra.
        grid: what an earlier call on the same, unchanged net returned; "walk" builds one when it first needs it.

    Returns:
        (m,) int64 refs, -1 for a point outside; and the grid, for the next call.

    Raises:
        InputError: another method, or queries of another shape.
    """
    queries = np.require(queries, np.float64, ["C", "W", "O"])
    if queries.ndim != 2 or queries.shape[1] != 3:
        raise InputError(f"points to locate have the shape (m, 3), not {queries.shape}")
    refs = np.empty(len(queries), np.int64)
    if method not in METHODS:
        raise InputError(f"there is no way to locate called {method!r}: choose one of {', '.join(METHODS)}")
    with np.errstate(over="ignore", invalid="ignore"):  # a point may be so far away that its volumes are infinite
        if method == "brute":
            _ask_every_tetra(net, queries, refs)
        elif method == "source":
            _ask_as_the_source(net, queries, refs)
        elif _walk_to_all(net, queries, refs) > 0:
            grid = grid or build_grid(net)
            _ask_grid(net, grid, queries, refs)
    return refs, grid


@kernel(allocates=False)
def is_inside(net: Net, t: int, x: float, y: float, z: float) -> bool:
    """Whether (x, y, z) lies in tetra t or on its surface."""
    return _farthest_behind(net, t, x, y, z) == NONE


@kernel(allocates=False)
def _farthest_behind(net: Net, t: int, x: float, y: float, z: float) -> Any:
    """The side of t that the point is farthest behind (by signed volume), NONE if the point is inside."""
    xyz = net.points.xyz
    p0, p1, p2, p3 = vertex(net, t, 0), vertex(net, t, 1), vertex(net, t, 2), vertex(net, t, 3)
    whole = signed_volume(xyz, p0, p1, p2, p3)
    sign = 1.0 if whole >= 0.0 else -1.0
    least = -INSIDE * abs(whole)
    v0 = sign * _volume_with(xyz, p1, p3, p2, x, y, z)
    v1 = sign * _volume_with(xyz, p0, p2, p3, x, y, z)
    v2 = sign * _volume_with(xyz, p0, p3, p1, x, y, z)
    v3 = sign * _volume_with(xyz, p0, p1, p2, x, y, z)
    side = NONE  # (the comparisons are such that what is no number is not inside)
    if not v0 >= least:
        side, least = np.int64(0), v0
    if not v1 >= least:
        side, least = np.int64(1), v1
    if not v2 >= least:
        side, least = np.int64(2), v2
    if not v3 >= least:
        side, least = np.int64(3), v3
    return side


@kernel(allocates=False)
def _volume_with(xyz: Any, a: int, b: int, c: int, x: float, y: float, z: float) -> float:
    """Signed volume of the tetra of three points of the net and (x, y, z)."""
    ax, ay, az = xyz[a, 0] - x, xyz[a, 1] - y, xyz[a, 2] - z
    bx, by, bz = xyz[b, 0] - x, xyz[b, 1] - y, xyz[b, 2] - z
    cx, cy, cz = xyz[c, 0] - x, xyz[c, 1] - y, xyz[c, 2] - z
    return -(ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx)) / 6.0


@kernel
def _walk_to_all(net: Net, queries: Any, refs: Any) -> int:
    """Walk to every query; UNDECIDED where the walk ended without an answer. Returns how many those are."""
    stack = make_stack()
    undecided = 0
    for q in range(len(queries)):
        x, y, z = queries[q, 0], queries[q, 1], queries[q, 2]
        point, _ = nearest_point(net.tree, x, y, z, stack)
        found = UNDECIDED
        place = first_around(net.incidence, point) if point >= 0 else np.int64(END)
        if place != END:
            t = ref_around(net.incidence, place)
            for _step in range(_LONGEST_WALK):
                side = _farthest_behind(net, t, x, y, z)
                if side == NONE:
                    found = t
                    break
                t = neighbour(net, t, side)
                if t == NONE:
                    break
        refs[q] = found
        undecided += int(found == UNDECIDED)
    return undecided


@kernel
def _ask_as_the_source(net: Net, queries: Any, refs: Any) -> None:
    stack = make_stack()
    for q in range(len(queries)):
        x, y, z = queries[q, 0], queries[q, 1], queries[q, 2]
        point, _ = nearest_point(net.tree, x, y, z, stack)
        refs[q] = NONE
        if point >= 0:
            refs[q] = _around(net, point, x, y, z)
        if refs[q] == NONE:
            refs[q] = _first_that_holds(net, x, y, z)


@kernel(allocates=False)
def _around(net: Net, point: int, x: float, y: float, z: float) -> Any:
    """The tetra among those around a point, then among their side neighbours."""
    place = first_around(net.incidence, point)
    while place != END:
        t = ref_around(net.incidence, place)
        if is_inside(net, t, x, y, z):
            return t
        place = next_around(net.incidence, place)
    place = first_around(net.incidence, point)
    while place != END:
        t = ref_around(net.incidence, place)
        for i in range(4):
            if vertex(net, t, i) == point:  # all others of its neighbours are around the point themselves
                u = neighbour(net, t, i)
                if u != NONE and is_inside(net, u, x, y, z):
                    return u
        place = next_around(net.incidence, place)
    return NONE


@kernel(allocates=False)
def _ask_every_tetra(net: Net, queries: Any, refs: Any) -> None:
    for q in range(len(queries)):
        refs[q] = _first_that_holds(net, queries[q, 0], queries[q, 1], queries[q, 2])


@kernel(allocates=False)
def _first_that_holds(net: Net, x: float, y: float, z: float) -> Any:
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        if is_inside(net, cursor.tetra, x, y, z):
            return cursor.tetra
        cursor = next_tetra(net, cursor)
    return NONE


def build_grid(net: Net) -> Grid:
    """A grid with a few tetras a cell, made in two passes over the net."""
    low, high = np.empty(3), np.empty(3)
    _bounds(net, low, high)
    extent = high - low
    tetras = max(int(number_of_tetras(net)), 1)
    longest = extent.max() or 1.0
    relative = np.maximum(extent / longest, _FLATTEST)  # a flat net must not be cut into slices without end
    edge = (relative.prod() * _TETRAS_A_CELL / tetras) ** (1 / 3)
    shape = np.ceil(relative / edge).astype(np.int64)
    starts = np.zeros(int(shape.prod()) + 1, np.int64)
    grid = Grid(low, np.where(extent > 0, extent, longest) / shape, shape, starts, np.empty(0, np.int64))
    _enter(net, grid, count=True)
    starts[:] = np.concatenate(([0], np.cumsum(starts[:-1])))
    grid = grid._replace(refs=np.empty(int(starts[-1]), np.int64))
    _enter(net, grid, count=False)
    starts[1:] = starts[:-1].copy()  # filling moved each start to its end
    starts[0] = 0
    return grid


@kernel(allocates=False)
def _bounds(net: Net, low: Any, high: Any) -> None:
    """Bounding box of the live tetras."""
    low[:], high[:] = np.inf, -np.inf
    cursor = first_tetra(net)
    if cursor.tetra == NONE:
        low[:], high[:] = 0.0, 0.0
    while cursor.tetra != NONE:
        for i in range(4):
            for k in range(3):
                value = net.points.xyz[vertex(net, cursor.tetra, i), k]
                low[k], high[k] = min(low[k], value), max(high[k], value)
        cursor = next_tetra(net, cursor)


@kernel
def _enter(net: Net, grid: Grid, count: bool) -> None:
    """Count the tetras of each cell in `starts`, or fill `refs`, moving `starts`."""
    first, last = np.empty(3, np.int64), np.empty(3, np.int64)
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        t = cursor.tetra
        for k in range(3):
            low, high = np.inf, -np.inf
            for i in range(4):
                value = net.points.xyz[vertex(net, t, i), k]
                low, high = min(low, value), max(high, value)
            slack = 1e-9 * (high - low)  # a point that is_inside lets in lies in one of the cells
            first[k], last[k] = _cell(grid, low - slack, k), _cell(grid, high + slack, k)
        for a in range(first[0], last[0] + 1):
            for b in range(first[1], last[1] + 1):
                for c in range(first[2], last[2] + 1):
                    cell = (a * grid.shape[1] + b) * grid.shape[2] + c
                    if not count:
                        grid.refs[grid.starts[cell]] = t
                    grid.starts[cell] += 1
        cursor = next_tetra(net, cursor)


@kernel(allocates=False)
def _cell(grid: Grid, value: float, k: int) -> int:
    cell = np.int64(np.floor((value - grid.low[k]) / grid.cell[k]))
    return min(max(cell, 0), grid.shape[k] - 1)


@kernel(allocates=False)
def _ask_grid(net: Net, grid: Grid, queries: Any, refs: Any) -> None:
    for q in range(len(queries)):
        if refs[q] != UNDECIDED:
            continue
        refs[q] = NONE
        x, y, z = queries[q, 0], queries[q, 1], queries[q, 2]
        within = True
        for k in range(3):
            offset = queries[q, k] - grid.low[k]
            extent = grid.cell[k] * grid.shape[k]
            within &= -1e-9 * extent <= offset and offset <= (1.0 + 1e-9) * extent
        if not within:  # (so is a coordinate that is not a number)
            continue
        cell = (_cell(grid, x, 0) * grid.shape[1] + _cell(grid, y, 1)) * grid.shape[2] + _cell(grid, z, 2)
        for place in range(grid.starts[cell], grid.starts[cell + 1]):
            if is_inside(net, grid.refs[place], x, y, z):
                refs[q] = grid.refs[place]
                break
