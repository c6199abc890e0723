"""The contestant's incidence: a half-face storage. Deleted tetras wait for `collect`, and many splits are one conjoin."""

from typing import Any

import numpy as np
from numba.extending import register_jitable
from numpy.typing import NDArray

from tetrabench.backends.tetra.halfface.audit import audit
from tetrabench.backends.tetra.halfface.collect import collect as collect_flagged
from tetrabench.backends.tetra.halfface.conjoin import conjoin
from tetrabench.backends.tetra.halfface.construct import construct
from tetrabench.backends.tetra.halfface.delete_flags import END, DeleteFlags
from tetrabench.backends.tetra.halfface.edit import (
    EQUAL,
    SHARED,
    TWICE,
    UNKNOWN,
    add_tetrahedron,
    add_vertex,
    set_delete_flag,
)
from tetrabench.backends.tetra.halfface.fields import TetraFields, make_tetra_fields
from tetrabench.backends.tetra.halfface.storage import (
    BORDERS,
    FLAGGED,
    FREE_BORDERS,
    FREE_RECORDS,
    LARGEST_FAN,
    RECORDS,
    STAMP,
    TETRAS,
    VISITED,
    HalfFaces,
    array_sizes,
    first_record,
    inner_of,
    is_flagged,
    reserve,
    tetra_of,
)
from tetrabench.backends.tetra.halfface.walks import walk_fan
from tetrabench.jit import implements, kernel
from tetrabench.mesh import TetraMesh
from tetrabench.tetra import edit, interface
from tetrabench.tetra.geometry import set_geometry
from tetrabench.tetra.interface import NONE, STATES, Net, centroid, is_live, set_state, state, vertex
from tetrabench.tetra.memory import buffers
from tetrabench.tetra.nearest import build_tree, make_stack
from tetrabench.tetra.points import COUNT, EDITS, STALE, grown, make_points


def make_halfface_net(mesh: TetraMesh) -> Net:
    """The net of a mesh, with exactly the room that it needs.

    Raises:
        InputError: a side is shared by more than two tetras, a tetra is there twice, or words of 32 bits cannot count them.
    """
    net = Net(
        make_tetra_fields(len(mesh.tets)),
        DeleteFlags(np.array([len(mesh.tets)], np.int64)),
        make_points(mesh.points),
        construct(mesh.tets, len(mesh.points)),
        build_tree(mesh.points),
    )
    _fill(net, 0, np.zeros((0, STATES)))
    return net


@kernel(allocates=False)
def _fill(net: Net, begin: int, states: Any) -> None:
    """Static data of the tetras from `begin` on; their states, four with one row of `states` (n, 5) each, or zeros."""
    for t in range(begin, net.incidence.counters[TETRAS]):
        set_geometry(net, t)
        for k in range(STATES):
            set_state(net, t, k, states[(t - begin) // 4, k] if len(states) > 0 else 0.0)


@implements(interface.a_tetra_around, HalfFaces)
def a_tetra_around(net, point):
    return _a_tetra_around(net, point)


@kernel(allocates=False)
def _a_tetra_around(net: Net, point: int) -> Any:
    mesh, found = net.incidence, NONE
    record, _ = first_record(mesh, point)
    if record != NONE:
        found = tetra_of(mesh, inner_of(mesh, record))
        if is_flagged(mesh, found):
            found = NONE
            for n in range(walk_fan(mesh, point)):
                if not is_flagged(mesh, mesh.queue[n] >> 2):
                    found = mesh.queue[n] >> 2
    return found


@implements(interface.fill_around, HalfFaces)
def fill_around(net, point, buffer):
    return _fill_around(net, point, buffer)


@kernel(allocates=False)
def _fill_around(net: Net, point: int, buffer: Any) -> Any:
    mesh, count = net.incidence, 0
    for n in range(walk_fan(mesh, point)):
        t = mesh.queue[n] >> 2
        if not is_flagged(mesh, t):
            if count < len(buffer):
                buffer[count] = t
            count += 1
    return count


@implements(interface.insert_tetra, HalfFaces)
def insert_tetra(net, a, b, c, d):
    return _insert_tetra(net, a, b, c, d)


@kernel(allocates=False)
def _insert_tetra(net: Net, a: int, b: int, c: int, d: int) -> Any:
    edit.check_editable(net)
    if net.incidence.counters[TETRAS] >= len(net.layout.volume):  # fields and half-faces grow apart
        raise ValueError("no room for a tetra: call reserve first")
    t = add_tetrahedron(net.incidence, a, b, c, d)
    if t < 0:
        if t == EQUAL:
            raise ValueError("the four points of a tetra must differ")
        if t == UNKNOWN:
            raise ValueError("there is no such point")
        if t == TWICE:
            raise ValueError("there is such a tetra already")
        if t == SHARED:
            raise ValueError("two tetras share that side already")
        raise ValueError("no room for a tetra: call reserve first")
    _fill_one(net, t)
    net.slots.counters[END] = t + 1
    net.points.counters[EDITS] += 1
    return t


@kernel(allocates=False)
def _fill_one(net: Net, t: int) -> None:
    for k in range(STATES):
        set_state(net, t, k, 0.0)
    set_geometry(net, t)


@implements(interface.delete_tetra, HalfFaces)
def delete_tetra(net, t):
    _delete_tetra(net, t)


@kernel(allocates=False)
def _delete_tetra(net: Net, t: int) -> None:
    edit.check_editable(net)
    if not is_live(net, t):
        raise ValueError("there is no such tetra")
    set_delete_flag(net.incidence, t, True)
    end = net.slots.counters[END]
    while end > 0 and is_flagged(net.incidence, end - 1):
        end -= 1
    net.slots.counters[END] = end
    net.points.counters[EDITS] += 1


@implements(interface.enter_point, HalfFaces)
def enter_point(net, point):
    add_vertex(net.incidence, False)


@implements(interface.incidence_room, HalfFaces)
def incidence_room(net):
    mesh, counters = net.incidence, net.incidence.counters
    borders = (len(mesh.bhf2hf) - counters[BORDERS] + counters[FREE_BORDERS]) // 4
    records = (len(mesh.v2nhf) - counters[RECORDS] + counters[FREE_RECORDS]) // 8
    more = min(min(borders, records), len(mesh.queue) - counters[LARGEST_FAN])
    return min(len(mesh.connectivity), counters[TETRAS] + more) - counters[FLAGGED]


@implements(interface.grown_incidence, HalfFaces)
def grown_incidence(net, points, tetras):
    mesh, counters = net.incidence, net.incidence.counters
    slots = tetras + counters[FLAGGED]
    more = max(slots - counters[TETRAS], 0)
    fan = max(counters[LARGEST_FAN] + more, len(mesh.queue))
    table = len(mesh.table)
    while table < 2 * fan:
        table *= 2
    walk = mesh.walk.copy()
    walk[STAMP], walk[VISITED] = 1, 0
    return HalfFaces(
        _longer(mesh.connectivity, slots),
        _longer(mesh.adjacency, slots),
        _longer(mesh.bhf2hf, counters[BORDERS] - counters[FREE_BORDERS] + 4 * more),
        _longer(mesh.v2hf, points),
        _longer(mesh.vborders, points),
        _longer(mesh.v2nhf, counters[RECORDS] - counters[FREE_RECORDS] + 8 * more),
        counters.copy(),
        np.empty(fan, np.int64),
        np.zeros(table, np.int64),
        walk,
    )


@register_jitable
def _longer(array: Any, capacity: int) -> Any:
    return grown(array, max(capacity, len(array)))


@implements(interface.incidence_faults, HalfFaces)
def incidence_faults(net, refs):
    return len(audit(net.incidence))


@implements(interface.collect, HalfFaces)
def collect(net):
    """Collect, and let the fields follow."""
    if net.incidence.counters[FLAGGED] == 0:
        return net, False
    mesh, moved_from, moved_to = collect_flagged(net.incidence)
    for field in net.layout:
        field[moved_to] = field[moved_from]
    net.slots.counters[END] = mesh.counters[TETRAS]
    net.points.counters[EDITS] += 1
    return _with_topology(net, mesh), True


@implements(interface.split_many, HalfFaces)
def split_many(net, refs):
    """Flag the parents, collect them, and put all children in as one eventual mesh."""
    net, eventual, parents, states = _children(net, refs)
    _delete_all(net, parents)
    net, _ = interface.collect(net)
    before = int(net.incidence.counters[TETRAS])
    mesh, refusal = conjoin(net.incidence, eventual)
    if refusal:
        raise RuntimeError("children do not fit where their parents were")  # unless the storage is damaged
    net = _with_topology(net, mesh)
    net.slots.counters[END] = mesh.counters[TETRAS]
    _fill(net, before, states)
    net.points.counters[EDITS] += 1
    return net, len(refs) - len(parents)


def _children(net: Net, refs: NDArray[np.int64]) -> tuple[Net, HalfFaces, NDArray[np.int64], NDArray[np.float64]]:
    """Insert the centroids, and make an eventual mesh of all children.

    Returns the net, with room for them; the eventual mesh; the tetras to be split, (n,) int64, and their states (n, 5).
    Where there is no memory, the net stays what it was, but for points that there was room for.
    """
    stack, parents = make_stack(), np.empty(len(refs), np.int64)
    children, states = np.empty((4 * len(refs), 4), np.int32), np.empty((len(refs), STATES))
    grown_net = edit.reserve(net, 0, len(refs))
    try:
        split = int(_list_children(grown_net, refs, children, states, parents, stack))
        eventual = construct(children[: 4 * split], int(grown_net.points.counters[COUNT]))
        grown_net = _with_room(grown_net, 3 * split)
    except MemoryError:
        net.points.counters[STALE] = 0  # nothing of it was touched if it was outgrown
        raise
    return grown_net, eventual, parents[:split], states[:split]


def _with_room(net: Net, tetras: int) -> Net:
    """The net with room for so many more tetras."""
    mesh = reserve(
        net.incidence, tetras=tetras, borders=3 * tetras
    )  # before the parents' and the children's are joined
    if len(mesh.connectivity) > len(net.layout.volume):
        net = net._replace(layout=TetraFields(*(grown(field, len(mesh.connectivity)) for field in net.layout)))
    return _with_topology(net, mesh)


@kernel(allocates=False)
def _list_children(net: Net, refs: Any, children: Any, states: Any, parents: Any, stack: Any) -> Any:
    """Insert the centroids, list parents, children and states; returns how many there are to split."""
    split = 0
    for t in refs:
        points = net.points.counters[COUNT]
        centre = edit.insert_point(net, centroid(net, t, 0), centroid(net, t, 1), centroid(net, t, 2), stack)
        if centre == points:
            for i in range(4):
                for j in range(4):
                    children[4 * split + i, j] = centre if i == j else vertex(net, t, j)
            for k in range(STATES):
                states[split, k] = state(net, t, k)
            parents[split] = t
            split += 1
    return split


@kernel(allocates=False)
def _delete_all(net: Net, refs: Any) -> None:
    for t in refs:
        _delete_tetra(net, t)


def _with_topology(net: Net, mesh: HalfFaces) -> Net:
    """The net with another half-face storage in the place of its own, which is stale where it was outgrown."""
    if mesh is net.incidence:
        return net
    points = net.points._replace(counters=net.points.counters.copy())
    net.points.counters[STALE] = 1
    mesh = mesh._replace(counters=mesh.counters.copy())
    return net._replace(incidence=mesh, points=points, slots=DeleteFlags(net.slots.counters.copy()))


@buffers.register
def _(part: HalfFaces, net: Net) -> dict[str, tuple[int, int]]:
    return array_sizes(part)
