"""The interface of a tetrahedral net: what a contestant implements, and all that a scenario may call.

Two axes. The **layout** says where the fields of a tetra live; the **slot policy** says how free slots are found, skipped
and filled. Each is a NamedTuple of arrays, held in the net's fields `layout` and `slots`, with an implementation of the
functions below (`tetrabench.jit.implements`). All of them work in numba kernels and in plain Python.

Words: `t` is the ref of a tetra, an int64: an index in array layouts, an address in linked ones; NONE where there is no
tetra. Side `i` is the face opposite vertex `i`. `k` counts coordinates (0..2) or states (0..4).
"""

from typing import Any, NamedTuple

import numpy as np

from tetrabench.jit import generic, kernel

NONE = np.int64(-1)
"""The ref of no tetra: beyond the surface, nothing found, end of an iteration."""

STATES = 5
"""Length of a tetra's state vector."""

DEAD = -1.0
"""The volume that marks a free slot where a slot policy keeps flags. (Volumes are absolute, so never negative.)"""


class Net(NamedTuple):
    """The storage of a net: what kernels take, by value.

    An edit changes the arrays in place and never reallocates; `reserve` does, and returns the net to go on with.
    """

    layout: Any  # where the fields of a tetra live
    slots: Any  # which slots are free
    points: Any  # tetrabench.tetra.points.Points
    incidence: Any  # tetrabench.tetra.incidence.Incidence: the tetras around each point
    tree: Any  # tetrabench.tetra.nearest.Tree: nearest point


class Cursor(NamedTuple):
    """A place in an iteration over the net; over when `tetra` is NONE. The other fields are the slot policy's own."""

    tetra: int
    hole: int
    limit: int


# ---------------------------------------------------------------------------------------------------- layout


@generic(on="layout")
def vertex(net: Net, t: int, i: int) -> int:
    """Point ref of vertex i of tetra t, int64."""


@generic(on="layout")
def set_vertex(net: Net, t: int, i: int, point: int) -> None:
    """Store the point ref of vertex i."""


@generic(on="layout")
def neighbour(net: Net, t: int, i: int) -> int:
    """Tetra behind side i, NONE at the surface, int64."""


@generic(on="layout")
def set_neighbour(net: Net, t: int, i: int, other: int) -> None:
    """Store the tetra behind side i."""


@generic(on="layout")
def volume(net: Net, t: int) -> float:
    """Volume, absolute, in the cube of the points' unit of length."""


@generic(on="layout")
def set_volume(net: Net, t: int, value: float) -> None:
    """Store the volume; a slot policy with flags stores DEAD in free slots."""


@generic(on="layout")
def centroid(net: Net, t: int, k: int) -> float:
    """Coordinate k of the mean of the four vertices."""


@generic(on="layout")
def set_centroid(net: Net, t: int, k: int, value: float) -> None:
    """Store coordinate k of the centroid."""


@generic(on="layout")
def side_area(net: Net, t: int, i: int) -> float:
    """Area of side i."""


@generic(on="layout")
def set_side_area(net: Net, t: int, i: int, value: float) -> None:
    """Store the area of side i."""


@generic(on="layout")
def side_normal(net: Net, t: int, i: int, k: int) -> float:
    """Coordinate k of the outward unit normal of side i; 0 where the side has no area."""


@generic(on="layout")
def set_side_normal(net: Net, t: int, i: int, k: int, value: float) -> None:
    """Store coordinate k of the normal of side i."""


@generic(on="layout")
def state(net: Net, t: int, k: int) -> float:
    """Entry k of the state vector."""


@generic(on="layout")
def set_state(net: Net, t: int, k: int, value: float) -> None:
    """Store entry k of the state vector."""


@generic(on="layout")
def grown_layout(net: Net, capacity: int) -> Any:
    """A layout of the same type with at least `capacity` slots and the same content, as growth asks for one."""


@generic(on="layout")
def capacity(net: Net) -> int:
    """Slots that the layout has room for."""


# ---------------------------------------------------------------------------------------------------- slots


@generic(on="slots")
def number_of_tetras(net: Net) -> int:
    """Live tetras."""


@generic(on="slots")
def first_tetra(net: Net) -> Cursor:
    """Begin an iteration over the live tetras. The net must not change until it is over."""


@generic(on="slots")
def next_tetra(net: Net, cursor: Cursor) -> Cursor:
    """Go on to the next live tetra."""


@generic(on="slots")
def last_tetra(net: Net) -> int:
    """The last live tetra (highest index, or tail of the list), NONE in an empty net."""


@generic(on="slots")
def take_slot(net: Net) -> int:
    """Make room for one more tetra and return its ref. Needs the room that `reserve` made."""


@generic(on="slots")
def drop_slot(net: Net, t: int) -> None:
    """Free the slot of tetra t. Refs of other tetras stay as they are."""


@generic(on="slots")
def is_live(net: Net, t: int) -> bool:
    """Whether t is the ref of a tetra of this net. (A linked layout can only tell NONE from an address.)"""


@generic(on="slots")
def slots_used(net: Net) -> int:
    """Slots up to the last live tetra: what an iteration passes over."""


@generic(on="slots")
def grown_slots(net: Net, capacity: int) -> Any:
    """Slots of the same type for `capacity` tetras with the same content and counters of their own."""


@generic(on="slots")
def release(net: Net) -> None:
    """Give back what Python cannot see, such as nodes on the C heap. Only storages that hold such need implement it."""


@generic(on="slots")
def slot_faults(net: Net) -> int:
    """Self-audit of the bookkeeping: how many of its own rules it breaks, 0 if it is sound."""


# ---------------------------------------------------------------------------------------------------- for people


@kernel
def tetra_refs(net: Net) -> Any:
    """Refs of the live tetras in iteration order, (n,) int64."""
    refs = np.empty(number_of_tetras(net), np.int64)
    cursor, n = first_tetra(net), 0
    while cursor.tetra != NONE and n < len(refs):
        refs[n] = cursor.tetra
        cursor = next_tetra(net, cursor)
        n += 1
    return refs[:n]
