"""Changes that every net makes alike: room for more, and new points.

What comes and goes with the tetras around a point is in the interface: `insert_tetra`, `delete_tetra`, `split_many`. None of
them reallocates but the last: call `reserve` first, go on with the net that it returns, and never use the old one again (an
edit on it raises).
"""

from typing import Any

from numba.extending import register_jitable

from tetrabench.jit import kernel
from tetrabench.tetra.interface import (
    Net,
    capacity,
    enter_point,
    grown_incidence,
    grown_layout,
    grown_slots,
    incidence_room,
    number_of_tetras,
)
from tetrabench.tetra.nearest import grown_tree, insert_node, nearest_point
from tetrabench.tetra.points import COUNT, SAME_POINT, STALE, append_point, grown_points


@register_jitable
def reserve(net: Net, tetras: int, points: int) -> Net:
    """A net with room for `tetras` more tetras and `points` more points: this one, or a grown one in its place.

    Arrays grow by a quarter, and by 1,024 at least. The outgrown storage is marked stale. In Python this is numpy at
    work; a kernel may call it too, once before a run of edits, at the price of some seconds of compilation.
    """
    wanted_tetras = number_of_tetras(net) + tetras
    wanted_points = net.points.counters[COUNT] + points
    if wanted_tetras <= capacity(net) and wanted_tetras <= incidence_room(net) and wanted_points <= len(net.points.xyz):
        return net
    return _grow(net, wanted_tetras, wanted_points)


@register_jitable
def _grow(net: Net, wanted_tetras: int, wanted_points: int) -> Net:
    slots = _enough(capacity(net), wanted_tetras)
    listed = _enough(incidence_room(net), wanted_tetras)
    points = _enough(len(net.points.xyz), wanted_points)
    grown = Net(
        grown_layout(net, slots),
        grown_slots(net, slots),
        grown_points(net.points, points),
        grown_incidence(net, points, listed),
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
    check_editable(net)
    if net.points.counters[COUNT] >= len(net.points.xyz):
        raise ValueError("no room for a point: call reserve first")
    point = append_point(net.points, x, y, z)
    insert_node(net.tree, net.points.xyz, point)
    enter_point(net, point)
    return point


@kernel(allocates=False)
def check_editable(net: Net) -> None:
    """Raise ValueError if the net was outgrown, and an edit would be lost."""
    if net.points.counters[STALE] != 0:
        raise ValueError("this storage was outgrown: go on with the net that reserve returned")
