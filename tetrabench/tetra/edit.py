"""Changes of a net: insert and delete points and tetras, keep neighbours, incidence and search tree right; grow.

Written once, against the interface. `insert_tetra` and `delete_tetra` never reallocate: call `reserve` first, go on with
the net that it returns, and never use the old one again (an edit on it raises).
"""

from typing import Any

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.tetra.geometry import set_geometry
from tetrabench.tetra.incidence import (
    END,
    add_incidence,
    first_around,
    grown_incidence,
    next_around,
    ref_around,
    remove_incidence,
)
from tetrabench.tetra.interface import (
    NONE,
    STATES,
    Net,
    capacity,
    centroid,
    drop_slot,
    grown_layout,
    grown_slots,
    neighbour,
    number_of_tetras,
    set_neighbour,
    set_state,
    set_vertex,
    state,
    take_slot,
    vertex,
)
from tetrabench.tetra.nearest import grown_tree, insert_node, make_stack, nearest_point
from tetrabench.tetra.points import COUNT, EDITS, SAME_POINT, STALE, append_point, grown_points

FIRST = np.int64(0)
"""A zero of the type that sides have: a plain 0 would be another type to numba, and compile what it is passed to twice."""


@register_jitable
def reserve(net: Net, tetras: int, points: int) -> Net:
    """A net with room for `tetras` more tetras and `points` more points: this one, or a grown one in its place.

    Arrays grow by a quarter, and by 1,024 at least. The outgrown storage is marked stale. In Python this is numpy at
    work; a kernel may call it too, once before a run of edits, at the price of some seconds of compilation.
    """
    wanted_tetras = number_of_tetras(net) + tetras
    wanted_points = net.points.counters[COUNT] + points
    if (
        wanted_tetras <= capacity(net)
        and 4 * wanted_tetras <= len(net.incidence.entries)
        and wanted_points <= len(net.points.xyz)
    ):
        return net
    return _grow(net, wanted_tetras, wanted_points)


@register_jitable
def _grow(net: Net, wanted_tetras: int, wanted_points: int) -> Net:
    slots = _enough(capacity(net), wanted_tetras)
    listed = _enough(len(net.incidence.entries) // 4, wanted_tetras)
    points = _enough(len(net.points.xyz), wanted_points)
    grown = Net(
        grown_layout(net, slots),
        grown_slots(net, slots),
        grown_points(net.points, points),
        grown_incidence(net.incidence, points, listed),
        grown_tree(net.tree, points),
    )
    net.points.counters[STALE] = 1  # last: where there is no memory for one of them, the net stays what it was
    return grown


@register_jitable
def _enough(have: int, wanted: int) -> int:
    return have if wanted <= have else max(wanted, have + max(have // 4, 1024))


@kernel(allocates=False)
def insert_point(net: Net, x: float, y: float, z: float, stack: Any) -> int:
    """The ref of the point at (x, y, z): of an existing one within SAME_POINT of the net's size, else of a new one.

    `stack` is from `nearest.make_stack`. Needs room for a point.
    """
    found, distance = nearest_point(net.tree, x, y, z, stack)
    if distance < (SAME_POINT * net.points.diagonal) ** 2:
        return found
    _check_editable(net)
    if net.points.counters[COUNT] >= len(net.points.xyz):
        raise ValueError("no room for a point: call reserve first")
    point = append_point(net.points, x, y, z)
    insert_node(net.tree, net.points.xyz, point)
    return point


@kernel(allocates=False)
def insert_tetra(net: Net, a: int, b: int, c: int, d: int) -> int:
    """Insert the tetra of four points; its neighbours are found among the tetras around two of them. States are 0.

    Raises:
        ValueError: equal points, an unknown point, a tetra that is there already, a side that two tetras share
            already, no room, or a stale storage. The net is then as it was.
    """
    _check_editable(net)
    if a == b or a == c or a == d or b == c or b == d or c == d:
        raise ValueError("the four points of a tetra must differ")
    if min(min(a, b), min(c, d)) < 0 or max(max(a, b), max(c, d)) >= net.points.counters[COUNT]:
        raise ValueError("there is no such point")
    if number_of_tetras(net) >= capacity(net) or 4 * number_of_tetras(net) + 4 > len(net.incidence.entries):
        raise ValueError("no room for a tetra: call reserve first")
    # sides 1, 2, 3 hold point a: their other tetras are around a
    n0, n1, n2, n3 = NONE, NONE, NONE, NONE
    i0, i1, i2, i3 = FIRST, FIRST, FIRST, FIRST  # the side of the neighbour that is shared
    place = first_around(net.incidence, a)
    while place != END:
        u = ref_around(net.incidence, place)
        place = next_around(net.incidence, place)
        shared, other = FIRST, FIRST
        for j in range(4):
            v = vertex(net, u, j)
            match = np.int64(v == b) | np.int64(v == c) << 1 | np.int64(v == d) << 2
            shared |= match
            other += j * np.int64((match == 0) & (v != a))
        if shared == 0b111:
            raise ValueError("there is such a tetra already")
        if shared == 0b110:
            _check_free(net, u, other, n1)
            n1, i1 = u, other
        elif shared == 0b101:
            _check_free(net, u, other, n2)
            n2, i2 = u, other
        elif shared == 0b011:
            _check_free(net, u, other, n3)
            n3, i3 = u, other
    # side 0 is (b, c, d): its other tetra is around b, without a
    place = first_around(net.incidence, b)
    while place != END:
        u = ref_around(net.incidence, place)
        place = next_around(net.incidence, place)
        shared, other = FIRST, FIRST
        for j in range(4):
            v = vertex(net, u, j)
            match = np.int64(v == c) | np.int64(v == d) << 1
            shared |= match
            other += j * np.int64((match == 0) & (v != b))
        if shared == 0b11:
            _check_free(net, u, other, n0)
            n0, i0 = u, other

    t = take_slot(net)
    set_vertex(net, t, 0, a)
    set_vertex(net, t, 1, b)
    set_vertex(net, t, 2, c)
    set_vertex(net, t, 3, d)
    _join(net, t, 0, n0, i0)
    _join(net, t, 1, n1, i1)
    _join(net, t, 2, n2, i2)
    _join(net, t, 3, n3, i3)
    for k in range(STATES):
        set_state(net, t, k, 0.0)
    set_geometry(net, t)
    for i in range(4):
        add_incidence(net.incidence, vertex(net, t, i), t)
    net.points.counters[EDITS] += 1
    return t


@kernel(allocates=False, inline=True)
def delete_tetra(net: Net, t: int) -> None:
    """Delete tetra t: its neighbours lose a neighbour, its points a tetra; the points stay.

    Raises:
        ValueError: t is not a tetra of the net, or the storage is stale. The net is then as it was.
    """
    _check_editable(net)
    for i in range(4):
        if not remove_incidence(net.incidence, vertex(net, t, i), t):
            raise ValueError("there is no such tetra")
    for i in range(4):
        u = neighbour(net, t, i)
        if u != NONE:
            for j in range(4):
                if neighbour(net, u, j) == t:
                    set_neighbour(net, u, j, NONE)
    drop_slot(net, t)
    net.points.counters[EDITS] += 1


def split_many(net: Net, refs: NDArray[np.int64]) -> tuple[Net, int]:
    """Split each tetra of `refs` (n,) int64 into four around its centroid; a tetra whose centroid is a point is skipped.

    Child i is the parent with vertex i replaced by the centroid; children inherit the states. Returns the net to go
    on with and how many were skipped.
    """
    stack, states = make_stack(), np.empty(STATES)  # before the net is outgrown: there may be no memory for them
    net = reserve(net, 3 * len(refs) + 1, len(refs))
    return net, _split_all(net, refs, stack, states)


@kernel(allocates=False)
def _split_all(net: Net, refs: Any, stack: Any, states: Any) -> int:
    skipped = 0
    for t in refs:
        points = net.points.counters[COUNT]
        centre = insert_point(net, centroid(net, t, 0), centroid(net, t, 1), centroid(net, t, 2), stack)
        if centre < points:
            skipped += 1
            continue
        a, b, c, d = vertex(net, t, 0), vertex(net, t, 1), vertex(net, t, 2), vertex(net, t, 3)
        for k in range(STATES):
            states[k] = state(net, t, k)
        delete_tetra(net, t)
        for i in range(4):
            child = insert_tetra(
                net,
                centre if i == 0 else a,
                centre if i == 1 else b,
                centre if i == 2 else c,
                centre if i == 3 else d,
            )
            for k in range(STATES):
                set_state(net, child, k, states[k])
    return skipped


@kernel(allocates=False)
def _check_editable(net: Net) -> None:
    if net.points.counters[STALE] != 0:
        raise ValueError("this storage was outgrown: go on with the net that reserve returned")


@kernel(allocates=False)
def _check_free(net: Net, u: int, side: int, found: int) -> None:
    if found != NONE or neighbour(net, u, side) != NONE:
        raise ValueError("two tetras share that side already")


@register_jitable
def _join(net: Net, t: int, i: int, u: int, j: int) -> None:
    set_neighbour(net, t, i, u)
    if u != NONE:
        set_neighbour(net, u, j, t)
