"""The interface of a tetrahedral net: what a contestant implements, and all that a scenario may call.

Three axes. The **layout** says where the fields of a tetra live; the **slot policy** says how free slots are found, skipped
and filled; the **incidence** says which tetras are around a point, and so how a tetra comes into the net and out of it.
Each is a NamedTuple of arrays, held in the net's fields `layout`, `slots` and `incidence`, with an implementation of the
functions below (`tetrabench.jit.implements`). All of them work in numba kernels and in plain Python, but for those that
say that they are plain Python. Most contestants take the lists of `tetrabench.tetra.incidence`, and choose on two axes.

Words: `t` is the ref of a tetra, an int64: an index in array layouts, an address in linked ones; NONE where there is no
tetra. Side `i` is the face opposite vertex `i`. `k` counts coordinates (0..2) or states (0..4).
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

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
    incidence: Any  # the tetras around each point
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
def columns(net: Net) -> Any:
    """The fields of all slots as arrays, by name ("vertex", "volume", ...): dict of (capacity, ...), views indexed by ref.
    Only layouts that have such arrays need implement it. Plain Python."""


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
def hold(net: Net) -> Any:
    """Give nothing back from now on that Python cannot see, and return the content of it, for `let_go`. Only storages that
    implement `release` need implement this and the next. Plain Python."""


@generic(on="slots")
def let_go(net: Net, held: Any, undo: bool) -> None:
    """Give back what is no longer wanted: what was held back; or, to undo what was done since, what came since, and then
    put the content that `hold` returned into its places. Plain Python."""


@generic(on="slots")
def slot_faults(net: Net) -> int:
    """Self-audit of the bookkeeping: how many of its own rules it breaks, 0 if it is sound."""


# ---------------------------------------------------------------------------------------------------- around a point


@generic(on="incidence")
def a_tetra_around(net: Net, point: int) -> int:
    """Any one of the tetras of a point, NONE where it has none, int64."""


@generic(on="incidence")
def fill_around(net: Net, point: int, buffer: NDArray[np.int64]) -> int:
    """Store the tetras of a point in `buffer` (any length,) int64, as many as fit, each once, in an order that lasts.

    Returns how many there are; where not all fit, any number above the length of the buffer will do, so that a
    contestant may stop there.
    """


IN_THE_WAY = ("there is such a tetra already", "two tetras share that side already")
"""What `insert_tetra` says where another tetra is in the way; one that is deleted, and waits for `collect`, is one, too."""


@generic(on="incidence")
def insert_tetra(net: Net, a: int, b: int, c: int, d: int) -> int:
    """Insert the tetra of four points, joined to its neighbours, and return its ref. States are 0. Counts as an edit.

    Raises:
        ValueError: equal points, an unknown point, a tetra that is there already, a side that two tetras share
            already, no room, or a stale storage. The net is then as it was. (Where deleted tetras wait for `collect`,
            one of them may be what is in the way.)
    """


@generic(on="incidence")
def delete_tetra(net: Net, t: int) -> None:
    """Delete tetra t: its neighbours lose a neighbour, its points a tetra; the points stay. Counts as an edit.

    A contestant may leave what it can for `collect`. Every question of this interface is answered as if t were gone
    altogether; but its slot takes room until then, and it may be in the way of an insertion.

    Raises:
        ValueError: t is not a tetra of the net, or the storage is stale. The net is then as it was.
    """


@generic(on="incidence")
def enter_point(net: Net, point: int) -> None:
    """Note what there is to note of a point without tetras that was appended just now. The room was made before."""


@generic(on="incidence")
def grown_incidence(net: Net, points: int, tetras: int) -> Any:
    """An incidence of the same type with room for at least so many points and tetras in all, never for less than now,
    with the same content and counters of its own."""


@generic(on="incidence")
def incidence_room(net: Net) -> int:
    """For how many live tetras in all the incidence has room; what waits for `collect` takes room, too."""


@generic(on="incidence")
def incidence_faults(net: Net, refs: NDArray[np.int64]) -> int:
    """Self-audit: in how many ways the tetras around points are not those that use them, 0 if all is sound.

    `refs` (n,) int64 are the live tetras, ascending; each has four different vertices that are points. Nothing else may
    be relied upon: a damaged incidence is never followed out of its arrays, nor in circles. Plain Python.
    """


@generic(on="incidence")
def split_many(net: Net, refs: NDArray[np.int64]) -> tuple[Net, int]:
    """Split each tetra of `refs` (n,) int64 into four around its centroid; a tetra whose centroid is a point is skipped.

    Child i is the parent with vertex i replaced by the centroid; children inherit the states. New points come in the
    order of `refs`. Returns the net to go on with and how many were skipped; nothing is left for `collect`. Plain Python.
    """


@generic(on="incidence")
def collect(net: Net) -> tuple[Net, bool]:
    """Finish what deletions have left. Returns the net to go on with, and whether refs may have changed by it.

    Where nothing was waiting: the same net, and False. Else it counts as an edit. Plain Python.
    """


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


@kernel
def tetras_around(net: Net, point: int) -> Any:
    """Refs of the tetras around a point, (n,) int64."""
    refs = np.empty(64, np.int64)  # a point of a usual net has some two dozen
    n = fill_around(net, point, refs)
    while n > len(refs):
        refs = np.empty(2 * n, np.int64)
        n = fill_around(net, point, refs)
    return refs[:n]
