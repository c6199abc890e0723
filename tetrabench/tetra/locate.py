"""Which tetra holds a point: by walking there, as the source did it, or by asking every tetra.

A point is in a tetra when none of its four signed volumes is below -INSIDE times the tetra's volume. (Where the tetra is
flat that says nothing, so the point must be in its bounding box, too.) A point on a side lies in both tetras, and any of
them may be the answer.

`walk` goes through the side that p lies farthest behind, as seen from the tetra it stands in (visibility walk: Devillers,
Pion, Teillaud, Walking in a triangulation, 2002). It begins where the last walk ended if that is near (remembering walk),
else at the nearest point; many points are taken in the order of a Hilbert curve, so that it nearly always is. Where both
leave the net, through its surface or a hole, or get nowhere, a grid of bounding boxes decides, then and from there on: a
point outside a net that is not convex is normal, and must be cheap.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.jit import kernel
from tetrabench.mesh.hilbert import hilbert_keys
from tetrabench.tetra.interface import (
    NONE,
    Net,
    a_tetra_around,
    fill_around,
    first_tetra,
    neighbour,
    next_tetra,
    number_of_tetras,
    tetras_around,
    vertex,
)
from tetrabench.tetra.nearest import make_stack, nearest_point
from tetrabench.tetra.points import COUNT

METHODS = ("walk", "source", "brute")

INSIDE = 1e-12
"""How far outside, as a part of the tetra's volume, still is inside: rounding must not lose a point on a side."""

_SLACK = 1e-9
"""How far outside, as a part of its size, still is inside a tetra's bounding box. Boxes that only say where to look are
larger by twice that."""

_NEAR = 4.0
"""How many edges of a tetra there may be between a query and the last one, for a walk to go on where the last one ended."""

_MANY, _MANY_A_POINT = 500, 0.01
"""How many queries, and how many for each point of the net, are worth the time to put them in order."""

_X, _Y, _Z = np.int64(0), np.int64(1), np.int64(2)  # (a plain number would make numba compile a kernel for each)
_BITS = 10  # an axis: a key then leaves room in a word for the row
_LONGEST_WALK = 500  # steps; where the net is not Delaunay, a walk may go round in a circle
_TETRAS_A_CELL = 4.0
_FLATTEST = 1e-3
_FEW = 12  # tetras of a point are asked first: mostly one of them holds the query, and the others need not be fetched


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


EVERYWHERE = np.array([[-1.0] * 3, [1.0] * 3]) * np.finfo(np.float64).max
NO_GRID = Grid(np.empty(0), np.empty(0), np.empty(0, np.int64), np.empty(0, np.int64), np.empty(0, np.int64))


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
        else:
            order, box = _way_through(net, queries)
            done = _walk_to_all(net, grid or NO_GRID, queries, order, box, refs)
            if done < len(order):
                grid = build_grid(net)
                _walk_to_all(net, grid, queries, order[done:], box, refs)
    return refs, grid


def _way_through(net: Net, queries: NDArray[np.float64]) -> tuple[NDArray[np.uint64], NDArray[np.float64]]:
    """In which order to walk to the queries, (m,) uint64, and the box, (2, 3) float64, outside of which no tetra is.

    Of few queries the order is their own, and the box is not looked for.
    """
    rows = np.arange(len(queries), dtype=np.uint64)
    if len(queries) < _MANY or len(queries) < _MANY_A_POINT * net.points.counters[COUNT]:
        return rows, EVERYWHERE
    box, pulled_in = np.empty((2, 3)), np.empty_like(queries)
    _pull_in(net, queries, box, pulled_in)
    keys = hilbert_keys(pulled_in, _BITS) << np.uint64(32) | rows  # (sorted in half the time that argsort takes)
    return np.sort(keys) & np.uint64(2**32 - 1), box


@kernel(allocates=False)
def _pull_in(net: Net, queries: Any, box: Any, pulled_in: Any) -> None:
    """The bounding box of the points of the net, and the queries, those outside moved to its surface."""
    for k in range(3):
        low, high = np.inf, -np.inf
        for point in range(net.points.counters[COUNT]):
            value = net.points.xyz[point, k]
            low, high = min(low, value), max(high, value)
        slack = 2.0 * _SLACK * (high - low)
        low, high = low - slack, high + slack
        box[0, k], box[1, k] = low, high
        for q in range(len(queries)):
            pulled_in[q, k] = min(max(queries[q, k], low), high)


@kernel
def _walk_to_all(net: Net, grid: Grid, queries: Any, order: Any, box: Any, refs: Any) -> int:
    """Find the tetra of every query, in `order`. Returns how far it came: as far as the first that needs a grid, if there
    is none.
    """
    stack = make_stack()
    has_grid = len(grid.starts) > 0
    t: Any = NONE  # where the last walk ended
    last_x, last_y, last_z = 0.0, 0.0, 0.0
    for n in range(len(order)):
        q = order[n]
        x, y, z = queries[q, 0], queries[q, 1], queries[q, 2]
        refs[q] = NONE
        if not _is_in_box(box, x, y, z):
            continue
        found: Any = NONE
        if t != NONE and _is_walk_from(net, t, x - last_x, y - last_y, z - last_z):
            t, found = _walk(net, t, x, y, z)
        if found == NONE and has_grid:
            found = _ask_grid(net, grid, x, y, z)
            t = found if found != NONE else t
        elif found == NONE:
            point, _ = nearest_point(net.tree, x, y, z, stack)
            beside = a_tetra_around(net, point) if point >= 0 else NONE
            if beside != NONE:
                t, found = _walk(net, beside, x, y, z)
            if found == NONE:
                return n
        refs[q] = found
        last_x, last_y, last_z = x, y, z
    return len(order)


@kernel(allocates=False)
def _is_in_box(box: Any, x: float, y: float, z: float) -> Any:
    """Whether a point is in a box; what is no number is not."""
    return (
        (box[0, 0] <= x and x <= box[1, 0])
        and (box[0, 1] <= y and y <= box[1, 1])
        and (box[0, 2] <= z and z <= box[1, 2])
    )


@kernel(allocates=False, inline=True)
def _is_walk_from(net: Net, t: int, dx: float, dy: float, dz: float) -> Any:
    """Whether a way is short beside the edges of t."""
    xyz = net.points.xyz
    p0, p1, _, _ = _corners(net, t)
    ax, ay, az = xyz[p1, 0] - xyz[p0, 0], xyz[p1, 1] - xyz[p0, 1], xyz[p1, 2] - xyz[p0, 2]
    return dx * dx + dy * dy + dz * dz < _NEAR * _NEAR * (ax * ax + ay * ay + az * az)


@kernel(allocates=False, inline=True)
def _walk(net: Net, t: int, x: float, y: float, z: float) -> tuple[Any, Any]:
    """Walk from t towards a point: the tetra where the walk ended, and that again if it holds the point, else NONE."""
    found: Any = NONE
    for _step in range(_LONGEST_WALK):
        following = _follow(net, t, x, y, z)
        if following == t:
            found = t
        if following == t or following == NONE:
            break
        t = following
    return t, found


@kernel(allocates=False, inline=True)
def _follow(net: Net, t: int, x: float, y: float, z: float) -> Any:
    """One step towards a point: t where it holds the point, else the tetra behind the side that the point is farthest
    behind (by volume), NONE at the surface.

    The neighbours are read with the vertices, not when it is known which one it will be: memory is what a walk waits for.
    """
    xyz = net.points.xyz
    p0, p1, p2, p3 = _corners(net, t)
    n0, n1, n2, n3 = neighbour(net, t, 0), neighbour(net, t, 1), neighbour(net, t, 2), neighbour(net, t, 3)
    ax, ay, az = xyz[p1, 0] - xyz[p0, 0], xyz[p1, 1] - xyz[p0, 1], xyz[p1, 2] - xyz[p0, 2]
    bx, by, bz = xyz[p2, 0] - xyz[p0, 0], xyz[p2, 1] - xyz[p0, 1], xyz[p2, 2] - xyz[p0, 2]
    cx, cy, cz = xyz[p3, 0] - xyz[p0, 0], xyz[p3, 1] - xyz[p0, 1], xyz[p3, 2] - xyz[p0, 2]
    qx, qy, qz = x - xyz[p0, 0], y - xyz[p0, 1], z - xyz[p0, 2]
    # six times the volume of t, and of what it is with the point in the place of vertex 0, 1, 2, 3
    ux, uy, uz = by * cz - bz * cy, bz * cx - bx * cz, bx * cy - by * cx
    whole, v1 = ax * ux + ay * uy + az * uz, qx * ux + qy * uy + qz * uz
    v2 = qx * (cy * az - cz * ay) + qy * (cz * ax - cx * az) + qz * (cx * ay - cy * ax)
    v3 = qx * (ay * bz - az * by) + qy * (az * bx - ax * bz) + qz * (ax * by - ay * bx)
    v0 = whole - v1 - v2 - v3
    if whole < 0.0:
        whole, v0, v1, v2, v3 = -whole, -v0, -v1, -v2, -v3
    following: Any = t
    least = -INSIDE * whole
    if not v0 >= least:  # (so is what is no number)
        following, least = n0, v0
    if not v1 >= least:
        following, least = n1, v1
    if not v2 >= least:
        following, least = n2, v2
    if not v3 >= least:
        following, least = n3, v3
    if following == t and not (_is_among(qx, ax, bx, cx) and _is_among(qy, ay, by, cy) and _is_among(qz, az, bz, cz)):
        following = NONE
    return following


@kernel(allocates=False, inline=True)
def _is_among(q: float, a: float, b: float, c: float) -> Any:
    """Whether q is not beyond a, b, c and 0."""
    low, high = min(min(a, b), min(c, 0.0)), max(max(a, b), max(c, 0.0))
    slack = _SLACK * (high - low)
    return low - slack <= q and q <= high + slack


@kernel(allocates=False, inline=True)
def _corners(net: Net, t: int) -> tuple[Any, Any, Any, Any]:
    """The vertices of t, unsigned: at signed indices numba looks whether to count from the end."""
    return (
        np.uint64(vertex(net, t, 0)),
        np.uint64(vertex(net, t, 1)),
        np.uint64(vertex(net, t, 2)),
        np.uint64(vertex(net, t, 3)),
    )


@kernel(allocates=False, inline=True)
def is_inside(net: Net, t: int, x: float, y: float, z: float) -> bool:
    """Whether (x, y, z) lies in tetra t or on its surface."""
    return _is_about(net, t, x, y, z) and _follow(net, t, x, y, z) == t


@kernel(allocates=False, inline=True)
def _is_about(net: Net, t: int, x: float, y: float, z: float) -> Any:
    """Whether a point lies in the bounding box of t: what most tetras fail in, when many are asked."""
    low, high = _extent(net, t, _X)
    within = low <= x and x <= high
    if within:
        low, high = _extent(net, t, _Y)
        within = low <= y and y <= high
    if within:
        low, high = _extent(net, t, _Z)
        within = low <= z and z <= high
    return within


@kernel(allocates=False, inline=True)
def _extent(net: Net, t: int, k: int) -> tuple[float, float]:
    """From where to where t reaches along an axis, and a little more."""
    xyz = net.points.xyz
    p0, p1, p2, p3 = _corners(net, t)
    low = min(min(xyz[p0, k], xyz[p1, k]), min(xyz[p2, k], xyz[p3, k]))
    high = max(max(xyz[p0, k], xyz[p1, k]), max(xyz[p2, k], xyz[p3, k]))
    slack = 2.0 * _SLACK * (high - low)  # (more than `_is_among` takes, however both round)
    return low - slack, high + slack


@kernel
def _ask_as_the_source(net: Net, queries: Any, refs: Any) -> None:
    stack, few = make_stack(), np.empty(_FEW, np.int64)
    for q in range(len(queries)):
        x, y, z = queries[q, 0], queries[q, 1], queries[q, 2]
        point, _ = nearest_point(net.tree, x, y, z, stack)
        refs[q] = NONE
        if point >= 0:
            refs[q] = _among_few(net, point, few, x, y, z)
            if refs[q] == NONE:
                refs[q] = _around(net, point, x, y, z)
        if refs[q] == NONE:
            refs[q] = _first_that_holds(net, x, y, z)


@kernel(allocates=False)
def _among_few(net: Net, point: int, few: Any, x: float, y: float, z: float) -> Any:
    """The tetra among the first around a point."""
    for n in range(min(fill_around(net, point, few), len(few))):
        if is_inside(net, few[n], x, y, z):
            return few[n]
    return NONE


@kernel
def _around(net: Net, point: int, x: float, y: float, z: float) -> Any:
    """The tetra among the others around a point, then among the side neighbours of all."""
    around = tetras_around(net, point)
    for t in around[_FEW:]:
        if is_inside(net, t, x, y, z):
            return t
    for t in around:
        for i in range(4):
            if vertex(net, t, i) == point:  # all others of its neighbours are around the point themselves
                u = neighbour(net, t, i)
                if u != NONE and is_inside(net, u, x, y, z):
                    return u
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
    extent = np.minimum(high - low, np.finfo(np.float64).max)
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


@kernel(allocates=False)
def _enter(net: Net, grid: Grid, count: bool) -> None:
    """Count the tetras of each cell in `starts`, or fill `refs`, moving `starts`."""
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        first_x, last_x = _cells(net, grid, cursor.tetra, _X)
        first_y, last_y = _cells(net, grid, cursor.tetra, _Y)
        first_z, last_z = _cells(net, grid, cursor.tetra, _Z)
        for a in range(first_x, last_x + 1):
            for b in range(first_y, last_y + 1):
                row = (a * grid.shape[1] + b) * grid.shape[2]
                for cell in range(row + first_z, row + last_z + 1):
                    if not count:
                        grid.refs[grid.starts[cell]] = cursor.tetra
                    grid.starts[cell] += 1
        cursor = next_tetra(net, cursor)


@kernel(allocates=False, inline=True)
def _cells(net: Net, grid: Grid, t: int, k: int) -> tuple[Any, Any]:
    """The first and the last cell along an axis that t may touch."""
    low, high = _extent(net, t, k)
    return _cell(grid, low, k), _cell(grid, high, k)


@kernel(allocates=False, inline=True)
def _cell(grid: Grid, value: float, k: int) -> Any:
    """The cell along an axis where a coordinate lies; the first or last one where it is outside."""
    place, last = (value - grid.low[k]) / grid.cell[k], grid.shape[k] - 1.0
    place = place if place > 0.0 else 0.0
    return np.int64(place if place < last else last)


@kernel(allocates=False, inline=True)
def _ask_grid(net: Net, grid: Grid, x: float, y: float, z: float) -> Any:
    """The tetra that holds a point, NONE if there is none."""
    found = NONE
    if _is_in_grid(grid, x, 0) and _is_in_grid(grid, y, 1) and _is_in_grid(grid, z, 2):
        cell = (_cell(grid, x, 0) * grid.shape[1] + _cell(grid, y, 1)) * grid.shape[2] + _cell(grid, z, 2)
        for place in range(grid.starts[cell], grid.starts[cell + 1]):
            if is_inside(net, grid.refs[place], x, y, z):
                found = grid.refs[place]
                break
    return found


@kernel(allocates=False, inline=True)
def _is_in_grid(grid: Grid, value: float, k: int) -> Any:
    """Whether a coordinate lies in the grid; what is no number does not."""
    offset, extent = value - grid.low[k], grid.cell[k] * grid.shape[k]
    slack = 2.0 * _SLACK * extent
    return -slack <= offset and offset <= extent + slack
