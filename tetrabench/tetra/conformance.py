"""What every tetra contestant must do, as rules that say what is wrong in words: ours pass them, and anybody's has to.

Each rule takes a contestant and yields sentences, which name the function of the interface and the situation; none where all
is well. The net is compared with `twin.Twin`. What a rule cannot go on after ends it: the first sentence is the one to mend.
"""

import random
from collections.abc import Callable, Iterator
from copy import deepcopy
from functools import wraps
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.jit.generic import is_implemented, lacks
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.models import generate
from tetrabench.protocols import Rule
from tetrabench.tetra import edit, interface
from tetrabench.tetra.audit import CHECKS, audit
from tetrabench.tetra.contestant import TetraContestant
from tetrabench.tetra.incidence import Incidence
from tetrabench.tetra.interface import IN_THE_WAY, NONE, STATES, Net
from tetrabench.tetra.nearest import make_stack
from tetrabench.tetra.net import TetraNet
from tetrabench.tetra.points import COUNT, EDITS
from tetrabench.tetra.twin import Corners, Twin, corners_of

STEPS = 60
"""Edits of the history that every contestant is led through."""

_BY_LISTS = {"set_vertex", "set_neighbour", "take_slot", "drop_slot"}
"""What only `tetrabench.tetra.incidence` calls: a topology of one's own does without."""

_OF_RELEASE = {"hold", "let_go"}
"""What only storages need that implement `release`."""

_MAY_LACK = {"release", "columns"}
"""What a storage may do without."""


class _Broken(Exception):  # noqa: N818 - a sentence, which ends a rule
    """What is wrong, so that a rule cannot go on."""


def _rule(faults: Callable[[TetraContestant], Iterator[str]]) -> Callable[[TetraContestant], Iterator[str]]:
    """A rule that ends with what breaks it."""

    @wraps(faults)
    def until_broken(contestant: TetraContestant) -> Iterator[str]:
        try:
            yield from faults(contestant)
        except _Broken as broken:
            yield str(broken)

    return until_broken


# ---------------------------------------------------------------------------------------------------- meshes


def _mesh(points: Any, tets: Any) -> TetraMesh:
    points, tets = np.array(points, np.float64).reshape(-1, 3), np.array(tets, np.int32).reshape(-1, 4)
    return TetraMesh(points, tets, np.arange(1, len(points) + 1), np.arange(1, len(tets) + 1))


def _meshes() -> dict[str, TetraMesh]:
    """Small ones, by what is special about them."""
    corner = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]
    fan = [[0, 0, -1], [0, 0, 1], *([np.cos(a), np.sin(a), 0] for a in np.arange(70) * 2 * np.pi / 70)]
    return {
        "no tetra": _mesh([], []),
        "one tetra": _mesh(corner, [[0, 1, 2, 3]]),
        "two tetras, one of them inside out": _mesh([*corner, [1, 1, 1]], [[0, 1, 2, 3], [4, 3, 2, 1]]),
        "a tetra without volume": _mesh([*corner, [1, 1, 0]], [[0, 1, 2, 3], [0, 1, 2, 4]]),
        "two tetras that share an edge, and a point alone": _mesh(
            [*corner, [-1, 0, 0], [-1, -1, 0], [9, 9, 9]], [[0, 3, 1, 2], [0, 3, 4, 5]]
        ),
        "70 tetras around an edge": _mesh(fan, [[0, 1, 2 + n, 2 + (n + 1) % 70] for n in range(70)]),
        "a box": _box(),
    }


def _box() -> TetraMesh:
    return generate("box", 24, numbering="shuffled", seed=1)


# ---------------------------------------------------------------------------------------------------- kernels


@kernel
def _visit(net: Net, refs: Any) -> int:
    """Store the refs in iteration order, as many as fit; returns how many."""
    n = 0
    cursor = interface.first_tetra(net)
    while cursor.tetra != NONE and n < len(refs):
        refs[n] = cursor.tetra
        n += 1
        if n < len(refs):
            cursor = interface.next_tetra(net, cursor)
    return n


@kernel
def _count(net: Net, numbers: Any) -> None:
    """What the net says of itself as a whole: see `_Look.numbers`."""
    numbers[0] = interface.number_of_tetras(net)
    numbers[1] = interface.last_tetra(net) if interface.number_of_tetras(net) > 0 else NONE
    numbers[2] = interface.slots_used(net)
    numbers[3] = interface.capacity(net)
    numbers[4] = interface.incidence_room(net)


@kernel
def _are_live(net: Net, refs: Any, live: Any) -> None:
    for n in range(len(refs)):
        live[n] = interface.is_live(net, refs[n])


@kernel
def _read(net: Net, refs: Any, integers: Any, floats: Any) -> None:
    """All fields of some tetras: integers (n, 8) int64 and floats (n, 25) float64, in the order of `_NAMES`."""
    for n in range(len(refs)):
        t = refs[n]
        floats[n, 0] = interface.volume(net, t)
        for k in range(3):
            floats[n, 1 + k] = interface.centroid(net, t, k)
        for i in range(4):
            integers[n, i] = interface.vertex(net, t, i)
            integers[n, 4 + i] = interface.neighbour(net, t, i)
            floats[n, 4 + i] = interface.side_area(net, t, i)
            for k in range(3):
                floats[n, 8 + 3 * i + k] = interface.side_normal(net, t, i, k)
        for k in range(STATES):
            floats[n, 20 + k] = interface.state(net, t, k)


@kernel
def _store(net: Net, t: int, column: int, value: float) -> None:
    """Set the float field of a column of `_read`."""
    if column == 0:
        interface.set_volume(net, t, value)
    elif column < 4:
        interface.set_centroid(net, t, column - 1, value)
    elif column < 8:
        interface.set_side_area(net, t, column - 4, value)
    elif column < 20:
        interface.set_side_normal(net, t, (column - 8) // 3, (column - 8) % 3, value)
    else:
        interface.set_state(net, t, column - 20, value)


@kernel
def _connect(net: Net, t: int, column: int, value: int) -> None:
    """Set the integer field of a column of `_read`."""
    if column < 4:
        interface.set_vertex(net, t, column, value)
    else:
        interface.set_neighbour(net, t, column - 4, value)


@kernel
def _ask_around(net: Net, point: int, buffer: Any, answers: Any) -> None:
    """What `a_tetra_around` and `fill_around` return, (2,) int64."""
    answers[0] = interface.a_tetra_around(net, point)
    answers[1] = interface.fill_around(net, point, buffer)


_INTEGERS = [*(f"vertex({{t}}, {i})" for i in range(4)), *(f"neighbour({{t}}, {i})" for i in range(4))]
_FLOATS = [
    "volume({t})",
    *(f"centroid({{t}}, {k})" for k in range(3)),
    *(f"side_area({{t}}, {i})" for i in range(4)),
    *(f"side_normal({{t}}, {i}, {k})" for i in range(4) for k in range(3)),
    *(f"state({{t}}, {k})" for k in range(STATES)),
]
"""How the fields are asked for, in the order of `_read`."""


class _Look(NamedTuple):
    """All that a net tells.

    Attributes:
        refs: (n,) int64, in iteration order.
        integers, floats: see `_read`.
        numbers: number_of_tetras, last_tetra, slots_used, capacity, incidence_room.
        known: ref of each tetra, by its vertices.
    """

    refs: NDArray[np.int64]
    integers: NDArray[np.int64]
    floats: NDArray[np.float64]
    numbers: list[int]
    known: dict[Corners, int]


def _look(net: Net, after: str) -> _Look:
    """Look at a net that iterates as it should.

    Raises:
        _Broken: it does not; nothing that such a ref leads to may be read.
    """
    numbers = np.zeros(5, np.int64)
    _count(net, numbers)
    count, last = int(numbers[0]), int(numbers[1])
    if not 0 <= count <= 10**6:
        raise _Broken(f"{after}: number_of_tetras gives {count}")
    refs, again = np.full((2, count + 1), NONE)
    visited = _visit(net, refs)
    seen: set[int] = set()
    for t in refs[:visited].tolist():
        if t in seen:
            raise _Broken(f"{after}: next_tetra gives tetra {t} twice")
        if t < 0:
            raise _Broken(f"{after}: first_tetra and next_tetra lead to {t}, which is no ref")
        seen.add(t)
    if visited != count:
        more = f"more than {count}" if visited > count else f"{visited}"
        raise _Broken(f"{after}: first_tetra and next_tetra lead to {more} tetras, and number_of_tetras gives {count}")
    _visit(net, again)
    if (refs != again).any():
        raise _Broken(f"{after}: next_tetra gives another order when asked again: {again[:-1]} after {refs[:-1]}")
    refs = refs[:count].copy()
    if last not in ({int(refs.max()), int(refs[-1])} if count else {int(NONE)}):
        raise _Broken(f"{after}: last_tetra gives {last}, and the last tetra of the iteration is {refs[-1]}")
    if not count <= numbers[2]:
        raise _Broken(f"{after}: slots_used gives {numbers[2]}, for {count} tetras")
    live = np.zeros(count, np.bool_)
    _are_live(net, refs, live)
    for t, is_live in zip(refs.tolist(), live, strict=True):
        if not is_live:
            raise _Broken(f"{after}: is_live({t}) is False, and the iteration leads to it")
    integers, floats = np.zeros((count, 8), np.int64), np.zeros((count, 25))
    _read(net, refs, integers, floats)
    known = dict(zip(corners_of(integers[:, :4].tolist()), refs.tolist(), strict=True))
    return _Look(refs, integers, floats, numbers.tolist(), known)


def _compare(net: Net, twin: Twin, after: str, *, with_audit: bool = True) -> _Look:
    """Look at a net that is as its twin.

    Raises:
        _Broken: it is not.
    """
    look = _look(net, after)
    if len(look.refs) != len(twin.states):
        raise _Broken(f"{after}: number_of_tetras gives {len(look.refs)}, and there are {len(twin.states)} tetras")
    for t, row in zip(look.refs.tolist(), corners_of(look.integers[:, :4].tolist()), strict=True):
        if row not in twin.states:
            raise _Broken(f"{after}: vertex gives {row} for tetra {t}, and there is no such tetra")
    if len(look.known) != len(look.refs):
        raise _Broken(f"{after}: vertex gives the same four points for two tetras of the iteration")
    _compare_floats(look, twin, after)
    _compare_neighbours(look, twin, after)
    if with_audit and (faults := audit(net)):
        names = {"slots": "slot_faults", "incidence": "incidence_faults"}
        told = "; ".join(f"{names.get(fault, fault)}: {CHECKS[fault]}" for fault in faults)
        raise _Broken(f"{after}: the self-audit finds faults in a sound net: {told}")
    return look


def _compare_floats(look: _Look, twin: Twin, after: str) -> None:
    for t, row, seen in zip(look.refs.tolist(), look.integers.tolist(), look.floats.tolist(), strict=True):
        wanted = twin.floats((row[0], row[1], row[2], row[3]))
        for ask, found, right in zip(_FLOATS, seen, wanted, strict=True):
            if found != right:
                raise _Broken(f"{after}: {ask.format(t=t)} is {found!r} and should be {right!r}")


def _compare_neighbours(look: _Look, twin: Twin, after: str) -> None:
    refs = {t: tetra for tetra, t in look.known.items()}
    behind = twin.behind()
    for t, row in zip(look.refs.tolist(), look.integers.tolist(), strict=True):
        for i in range(4):
            found, wanted = row[4 + i], behind[refs[t], i]
            right = NONE if wanted is None else look.known[wanted]
            if found != right:
                there = "there is none" if wanted is None else f"the tetra that shares that side is {right}"
                odd = ", which is no tetra of the net" if found not in refs and found != NONE else ""
                raise _Broken(
                    f"{after}: the neighbour behind side {i} of tetra {t}, neighbour({t}, {i}), is {found}{odd}, and {there}"
                )


# ---------------------------------------------------------------------------------------------------- rules


def missing(net: Net) -> list[str]:
    """The functions that a net's storage lacks, with their parameters."""
    may_lack = set(_MAY_LACK)
    if not isinstance(net.incidence, Incidence):
        may_lack |= _BY_LISTS
    if not is_implemented(interface.release, net):
        may_lack |= _OF_RELEASE
    return lacks(interface, net, may_lack)


@_rule
def _complete(contestant: TetraContestant) -> Iterator[str]:
    """Built of no tetra, for which nothing has to be there yet."""
    if absent := missing(contestant.build(_mesh([], []))):
        yield f"not implemented: {', '.join(absent)}"


@_rule
def _built(contestant: TetraContestant) -> Iterator[str]:
    for name, mesh in _meshes().items():
        with TetraNet(mesh, contestant) as net:
            look = _compare(net.storage, Twin(mesh), f"a fresh net of {name}")
            if look.numbers[3] < len(look.refs):
                yield f"a fresh net of {name}: capacity gives {look.numbers[3]}, for {len(look.refs)} tetras"
            if look.numbers[4] < len(look.refs):
                yield f"a fresh net of {name}: incidence_room gives {look.numbers[4]}, for {len(look.refs)} tetras"
            if list(look.known) != corners_of(mesh.tets.tolist()):
                yield f"a fresh net of {name}: first_tetra and next_tetra do not lead through it in the order of the mesh"


_REALS = [0.1, -0.0, 5e-324, -1.7976931348623157e308, np.inf, np.array([0x7FF8_0000_0000_1234]).view(np.float64)[0]]
_SIZES = [0.1, 0.0, 5e-324, 1.7976931348623157e308]  # volumes are never negative: that may mark a free slot
_IDS = [0, 1, 2**15, 2**16 + 7, 2**31 - 1]


@_rule
def _fields(contestant: TetraContestant) -> Iterator[str]:
    """Each setter with values that a narrower or another type would lose; after each, all fields of all tetras are read."""
    with TetraNet(_meshes()["two tetras that share an edge, and a point alone"], contestant) as net:
        net.storage = edit.reserve(net.storage, 1, 0)
        interface.insert_tetra(net.storage, 3, 4, 5, 6)
        storage, look = net.storage, _look(net.storage, "three tetras")
        values: list[Any] = []
        for t in look.refs.tolist():
            if is_implemented(interface.set_vertex, storage):
                values += [(_connect, t, i, np.int64(one)) for i in range(4) for one in _IDS]
            if is_implemented(interface.set_neighbour, storage):
                values += [(_connect, t, 4 + i, one) for i in range(4) for one in (NONE, *look.refs)]
            values += [(_store, t, c, np.float64(one)) for c in range(25) for one in (_REALS if c else _SIZES)]
        rows = {t: row for row, t in enumerate(look.refs.tolist())}
        integers, bits = look.integers.copy(), look.floats.view(np.int64).copy()
        for setter, t, column, value in values:
            setter(storage, np.int64(t), np.int64(column), value)
            if setter is _store:
                bits[rows[t], column] = np.float64(value).view(np.int64)
            else:
                integers[rows[t], column] = value
            found = np.zeros_like(integers), np.zeros(bits.shape)
            _read(storage, look.refs, *found)
            if (found[0] == integers).all() and (found[1].view(np.int64) == bits).all():
                continue
            names = _FLOATS if setter is _store else _INTEGERS
            ask = names[column].format(t=t)
            did = f"set_{ask.rstrip(')')}, {value})"
            for names, seen, wanted in ((_INTEGERS, *found[:1], integers), (_FLOATS, found[1], bits.view(np.float64))):
                differs = seen.view(np.int64) != wanted.view(np.int64)
                for row, other in zip(*np.nonzero(differs), strict=True):
                    it = names[other].format(t=look.refs[row])
                    if it == ask:
                        raise _Broken(f"{it.partition('(')[0]}: after {did}, {it} gives {seen[row, other]}")
                    raise _Broken(f"{did} changes {it} from {wanted[row, other]} to {seen[row, other]}")
    yield from ()


def _give_states(net: TetraNet, twin: Twin, beyond: float) -> None:
    """States that differ from tetra to tetra and from place to place, to a net and to its twin."""
    for n, states in enumerate(twin.states.values()):
        states[:] = [n + beyond, -n, 1 / (n + 1), 1e-300, 1e9]
    net.states = np.array([twin.states[tetra] for tetra in _look(net.storage, "before set_state").known])


_COLUMNS = {
    "vertex": (0, 4),
    "neighbour": (4, 8),
    "volume": (0, 1),
    "centroid": (1, 4),
    "side_area": (4, 8),
    "side_normal": (8, 20),
    "state": (20, 25),
}
"""The fields by name, and which columns of `_read` they are: the first two of its integers, the others of its floats."""


@_rule
def _columns(contestant: TetraContestant) -> Iterator[str]:
    """What numpy sees by ref is what the functions of the fields say; with states, what it writes, too."""
    with TetraNet(_box(), contestant) as net:
        storage = net.storage
        if not is_implemented(interface.columns, storage):
            return
        net.delete(net.last)
        net.states = np.arange(5.0 * len(net)).reshape(-1, 5)
        for told in ("", " after it was written to"):
            columns = interface.columns(storage)
            if told and "state" in columns:
                columns["state"][:] += 0.5
            look = _look(storage, f"columns{told}")
            for name, column in columns.items():
                if name not in _COLUMNS:
                    raise _Broken(f"columns: there is no field {name!r}; there are {', '.join(_COLUMNS)}")
                begin, end = _COLUMNS[name]
                wanted = (look.integers if name in ("vertex", "neighbour") else look.floats)[:, begin:end]
                if len(column) <= look.refs.max() or column[0].size != end - begin:
                    raise _Broken(f"columns: {name} is {column.shape}, and should have a row for each slot, by ref")
                found = column[look.refs].reshape(wanted.shape)
                for row, place in zip(*np.nonzero(found != wanted), strict=True):
                    ask = f"{name} of tetra {look.refs[row]}"
                    raise _Broken(f"columns: {ask} is {found[row, place]}{told}, and {name} says {wanted[row, place]}")
    yield from ()


@_rule
def _growth(contestant: TetraContestant) -> Iterator[str]:
    """Of a net with a hole: all that was there is there, and the outgrown storage refuses edits."""
    mesh = _box()
    with TetraNet(mesh, contestant) as net:
        twin, old = Twin(mesh), net.storage
        tetra = twin.tetras[5]
        t = _look(old, "a fresh net").known[tetra]
        _delete(old, twin, tetra, t)
        _compare(old, twin, f"delete_tetra({t})")
        _give_states(net, twin, 0.5)
        before = _look(old, "set_state")
        more = min(before.numbers[3], before.numbers[4], 10_000) + 50
        new = net.storage = edit.reserve(old, more, 60)
        if new is old:
            raise _Broken(
                f"capacity gives {before.numbers[3]} and incidence_room {before.numbers[4]}: no room for {more}"
            )
        _compare_layouts(before, _look(new, "after growth"), twin)
        look = _compare(new, twin, "after grown_layout, grown_slots and grown_incidence")
        if (look.refs != before.refs).any():
            yield f"after growth the iteration goes {look.refs}, and went {before.refs}"
        for name, room in zip(("capacity", "incidence_room"), look.numbers[3:], strict=True):
            if room < len(look.refs) + more:
                yield f"{name} gives {room} after growth to {len(look.refs) + more} tetras"
        stale = _look(old, "the outgrown storage").numbers[0]
        if not _refuses(lambda: interface.insert_tetra(old, *tetra)):
            yield "insert_tetra takes a tetra on a storage that was outgrown, where it is lost: check_editable"
        if not _refuses(lambda: interface.delete_tetra(old, int(look.refs[0]))):
            yield "delete_tetra takes a tetra out of a storage that was outgrown: check_editable"
        first = twin.tetras[0]
        _delete(new, twin, first, look.known[first])
        if (now := interface.number_of_tetras(old)) != stale:
            yield f"grown_slots: the new storage shares counters with the old, which now has {now} tetras, not {stale}"
        _compare(new, twin, "delete_tetra after growth")
        _fill_the_room(net, twin, 50)
        _compare(net.storage, twin, "50 times insert_tetra after growth")


def _compare_layouts(before: _Look, after: _Look, twin: Twin) -> None:
    """Field by field, so that the sentence says what was lost."""
    if (before.refs.shape != after.refs.shape) or (np.sort(before.refs) != np.sort(after.refs)).any():
        raise _Broken(f"grown_slots: the tetras are {after.refs}, and were {before.refs}")
    for names, old, new in (
        (_INTEGERS, before.integers, after.integers),
        (_FLOATS, before.floats, after.floats),
    ):
        for row, column in zip(*np.nonzero(old != new), strict=True):
            ask = names[column].format(t=before.refs[row])
            raise _Broken(f"grown_layout lost {ask}: it was {old[row, column]} and is {new[row, column]}")


def _fill_the_room(net: TetraNet, twin: Twin, count: int) -> None:
    """Insert so many tetras of new points, for which there is room: three of them with each point, and the next."""
    stack, begin = make_stack(), len(twin.points)
    for n in range(count + 3):
        place = (10.0 + n, float(n % 3), float(n % 5))
        point = edit.insert_point(net.storage, *place, stack)
        if point != len(twin.points):
            raise _Broken(f"enter_point: the point {place} has the ref {point}, and should have {len(twin.points)}")
        twin.points.append(place)
    for n in range(begin, begin + count):
        _insert(net.storage, twin, (n, n + 1, n + 2, n + 3), "after growth, with room for it")


def _refuses(do: Callable[[], Any]) -> bool:
    try:
        do()
    except ValueError:
        return True
    return False


@_rule
def _around(contestant: TetraContestant) -> Iterator[str]:
    """Fresh nets, and one with deletions that may wait."""
    for name, mesh in _meshes().items():
        with TetraNet(mesh, contestant) as net:
            twin, storage = Twin(mesh), net.storage
            _compare_around(storage, twin, _look(storage, f"a fresh net of {name}"), f"a fresh net of {name}")
            for tetra in twin.tetras[::3]:
                look = _look(storage, f"{name}, after delete_tetra")
                interface.delete_tetra(storage, look.known[tetra])
                twin.delete(tetra)
            after = f"{name}, every third tetra deleted"
            _compare_around(storage, twin, _look(storage, after), after)
    yield from ()


def _compare_around(net: Net, twin: Twin, look: _Look, after: str) -> None:
    answers = np.zeros(2, np.int64)
    for point in range(len(twin.points)):
        wanted = {look.known[tetra] for tetra in twin.around(point)}
        for size in sorted({0, 1, len(wanted) - 1, len(wanted), len(wanted) + 3} - {-1}):
            buffer = np.full(size + 2, -7)
            _ask_around(net, point, buffer[:size], answers)
            one, count = answers.tolist()
            stored = buffer[: min(size, len(wanted))].tolist()
            fill = f"{after}: fill_around({point}) with room for {size}"
            if one not in (wanted or {int(NONE)}):
                raise _Broken(f"{after}: a_tetra_around({point}) is {one}, and around it are {sorted(wanted)}")
            if count != len(wanted) if size >= len(wanted) else count <= size:
                raise _Broken(f"{fill} returns {count}, and around it are {len(wanted)} tetras")
            if not set(stored) <= wanted or len(set(stored)) < len(stored):
                raise _Broken(f"{fill} stores {stored}, and around it are {sorted(wanted)}")
            if (buffer[len(stored) :] != -7).any():
                raise _Broken(f"{fill} writes beyond the {len(stored)} that there are")


# ---- edits


def _insert(net: Net, twin: Twin, tetra: Corners, after: str, *, stable: bool = True) -> tuple[Net, int]:
    """Insert a tetra that can be inserted; where one that waits for `collect` is in the way, collect first."""
    edits = int(net.points.counters[EDITS])
    try:
        t = int(interface.insert_tetra(net, *tetra))
    except ValueError as error:
        if stable or str(error) not in IN_THE_WAY:
            raise _Broken(f"insert_tetra{tetra}, {after}, is refused, though nothing is in the way: {error}") from error
        net, _ = interface.collect(net)
        net = edit.reserve(net, 1, 0)
        try:
            t = int(interface.insert_tetra(net, *tetra))
        except ValueError as again:
            raise _Broken(f"insert_tetra{tetra}, {after}, is refused even after collect: {again}") from again
    if int(net.points.counters[EDITS]) == edits:
        raise _Broken(f"insert_tetra{tetra} does not count as an edit: points.counters[EDITS] stays {edits}")
    twin.insert(tetra)
    return net, t


def _delete(net: Net, twin: Twin, tetra: Corners, t: int) -> None:
    edits = int(net.points.counters[EDITS])
    try:
        interface.delete_tetra(net, t)
    except ValueError as error:
        raise _Broken(f"delete_tetra({t}) is refused, though it is a tetra of the net: {error}") from error
    if int(net.points.counters[EDITS]) == edits:
        raise _Broken(f"delete_tetra({t}) does not count as an edit: points.counters[EDITS] stays {edits}")
    twin.delete(tetra)


@_rule
def _edits(contestant: TetraContestant) -> Iterator[str]:
    """A history at random, the same for all: after each edit the whole net is compared, after a refused one too."""
    mesh, chance = _box(), random.Random(20110501)
    with TetraNet(mesh, contestant) as net:
        twin = Twin(mesh)
        look = _compare(net.storage, twin, "a fresh net")
        gone: list[Corners] = []
        linked = is_implemented(interface.release, net.storage)
        for step in range(STEPS):
            before, storage = look, net.storage
            dice = chance.random()
            if dice < 0.45 and twin.states:  # down to few and up again, so that the end moves, too
                tetra = chance.choice(twin.tetras) if step % 4 else list(look.known)[-1]
                t = look.known[tetra]
                _delete(storage, twin, tetra, t)
                gone.append(tetra)
                did = f"delete_tetra({t})"
                if not linked and t not in (now := _look(storage, did)).refs:
                    _ask_the_dead(storage, now, t, did)
                    if not _refuses(lambda: interface.delete_tetra(storage, t)):  # noqa: B023
                        raise _Broken(f"delete_tetra({t}) is not refused a second time")
            elif dice < 0.75 and gone:
                tetra = gone.pop(chance.randrange(len(gone)))
                if twin.refusal(tetra):
                    continue
                did = f"insert_tetra{tetra}"
                net.storage = edit.reserve(storage, 1, 0)
                net.storage, t = _insert(net.storage, twin, tetra, "again", stable=contestant.stable_refs)
                if (found := _look(net.storage, did).known.get(tetra)) != t:
                    raise _Broken(f"{did} returns {t}, and the tetra of these points is {found}")
            else:
                tetra, why = _odd(twin, chance)
                did = f"insert_tetra{tetra}, refused because {why}"
                net.storage = storage = edit.reserve(storage, 1, 0)
                if not _refuses(lambda: interface.insert_tetra(storage, *tetra)):  # noqa: B023
                    raise _Broken(f"insert_tetra{tetra} is not refused, and should be: {why}")
            look = _compare(net.storage, twin, did)
            _compare_refs(before, look, contestant, did)
            if step % 6 == 0:
                _compare_around(net.storage, twin, look, did)
        while twin.states:
            tetra = chance.choice(twin.tetras)
            _delete(net.storage, twin, tetra, look.known[tetra])
            look = _compare(net.storage, twin, f"delete_tetra({look.known[tetra]})", with_audit=len(twin.states) < 3)
    yield from ()


def _odd(twin: Twin, chance: random.Random) -> tuple[Corners, str]:
    """A tetra that cannot be inserted, and why."""
    while True:
        a, b, c, d = chance.choice(twin.tetras) if twin.states else (0, 1, 2, 3)
        outside = len(twin.points)
        tetra = chance.choice([(d, c, b, a), (a, b, c, a), (a, b, c, outside), (-1, b, c, d), (a, b, c, outside - 1)])
        if why := twin.refusal(tetra):
            return tetra, why


def _ask_the_dead(net: Net, look: _Look, t: int, after: str) -> None:
    """Refs that are none."""
    strange = np.array([t, NONE, int(look.refs.max(initial=0)) + 1, 2**40], np.int64)
    strange = strange[~np.isin(strange, look.refs)]
    live = np.zeros(len(strange), np.bool_)
    _are_live(net, strange, live)
    for ref, is_live in zip(strange.tolist(), live, strict=True):
        if is_live:
            raise _Broken(f"{after}: is_live({ref}) is True, and there is no such tetra")


def _compare_refs(before: _Look, after: _Look, contestant: TetraContestant, did: str) -> None:
    """Whoever lives on keeps ref and place, where refs are stable."""
    if not contestant.stable_refs:
        return
    for tetra, t in before.known.items():
        if (now := after.known.get(tetra, t)) != t:
            raise _Broken(f"{did}: tetra {t} is now {now}, and the contestant says stable_refs")
    stayed = before.known.keys() & after.known.keys()
    orders = [[tetra for tetra in look.known if tetra in stayed] for look in (before, after)]
    if orders[0] != orders[1]:
        raise _Broken(f"{did}: next_tetra leads through the tetras that stayed in another order than before")


@_rule
def _split(contestant: TetraContestant) -> Iterator[str]:
    """Three tetras, one of them with a centroid that is a point already, in no order."""
    mesh = _box()
    with TetraNet(mesh, contestant) as net:
        twin = Twin(mesh)
        _give_states(net, twin, 1.0)
        look = _look(net.storage, "a fresh net")
        chosen = [twin.tetras[n] for n in (7, 2, 11)]
        centre = twin.centroid(chosen[1])
        net.storage = edit.reserve(net.storage, 0, 1)
        edit.insert_point(net.storage, *centre, make_stack())
        twin.points.append(centre)
        refs = np.array([look.known[tetra] for tetra in chosen], np.int64)
        net.storage, skipped = interface.split_many(net.storage, refs)
        split = [twin.split(tetra) for tetra in chosen]
        did = f"split_many({refs.tolist()})"
        if skipped != split.count(False):
            yield f"{did} says that it skipped {skipped}, and the centroids of {split.count(False)} are points already"
        points = net.storage.points.xyz[: int(net.storage.points.counters[COUNT])].tolist()
        if points != [list(point) for point in twin.points]:
            raise _Broken(f"{did}: the points are not those of before and the centroids in the order of the refs")
        look = _compare(net.storage, twin, did)
        _compare_around(net.storage, twin, look, did)
        after, changed = interface.collect(net.storage)
        net.storage = after
        if changed:
            yield f"{did} leaves something for collect"
        net.storage, skipped = interface.split_many(net.storage, np.zeros(0, np.int64))
        _compare(net.storage, twin, "split_many of no tetra")


@_rule
def _collect(contestant: TetraContestant) -> Iterator[str]:
    mesh = _box()
    with TetraNet(mesh, contestant) as net:
        twin = Twin(mesh)
        storage, changed = interface.collect(net.storage)
        if changed or storage is not net.storage:
            yield "collect: nothing was waiting in a fresh net, and it gives another net, or says that refs have changed"
        net.storage = storage
        for tetra in twin.tetras[::4]:
            look = _look(net.storage, "delete_tetra")
            _delete(net.storage, twin, tetra, look.known[tetra])
        before = _compare(net.storage, twin, "delete_tetra, before collect")
        edits = int(net.storage.points.counters[EDITS])
        net.storage, changed = interface.collect(net.storage)
        look = _compare(net.storage, twin, "collect")
        _compare_around(net.storage, twin, look, "collect")
        if changed and contestant.stable_refs:
            yield "collect says that refs may have changed, and the contestant says stable_refs"
        if changed and int(net.storage.points.counters[EDITS]) == edits:
            yield "collect changes refs and does not count as an edit: points.counters[EDITS]"
        if not changed and look.known != before.known:
            yield "collect changes refs and does not say so: it returns False"
        if interface.collect(net.storage)[1]:
            yield "collect finds something again right after collect"


class _Undo(Exception):  # noqa: N818 - no error
    """What an edit is broken off by."""


@_rule
def _undone(contestant: TetraContestant) -> Iterator[str]:
    """The same edits twice: broken off, which leaves the net as it was, and for good."""
    mesh = _box()
    with TetraNet(mesh, contestant) as net:
        twin = Twin(mesh)
        _give_states(net, twin, 0.5)
        before, did = _look(net.storage, "set_state"), "an edit that was undone (hold, let_go)"
        try:
            with net.edit():
                _change(net, deepcopy(twin))
                raise _Undo
        except _Undo:
            pass
        after = _compare(net.storage, twin, did)
        if (after.refs != before.refs).any():
            raise _Broken(f"{did}: the refs are {after.refs}, and were {before.refs}")
        _delete(net.storage, twin, twin.tetras[9], after.known[twin.tetras[9]])
        _compare(net.storage, twin, f"delete_tetra after {did}")
        with net.edit():
            _change(net, twin)
        _compare(net.storage, twin, "an edit that was kept (hold, let_go)")
    yield from ()


def _change(net: TetraNet, twin: Twin) -> None:
    """Some edits of each kind, of a net and of its twin, with growth."""
    gone = twin.tetras[:3]
    for tetra in gone:
        _delete(net.storage, twin, tetra, _look(net.storage, "delete_tetra").known[tetra])
    net.collect()
    net.storage = edit.reserve(net.storage, 1, 0)
    net.storage, _ = _insert(net.storage, twin, gone[1], "again")
    chosen = twin.tetras[4:8]
    known = _look(net.storage, "insert_tetra").known
    for tetra in chosen:
        twin.split(tetra)
    net.split([known[tetra] for tetra in chosen])
    _give_states(net, twin, -0.5)


@_rule
def _released(contestant: TetraContestant) -> Iterator[str]:
    """Nets come and go, edited and grown before."""
    for _ in range(3):
        net = TetraNet(_box(), contestant)
        net.delete(net.last)
        net.split(net.refs[:3])
        storage, linked = net.storage, is_implemented(interface.release, net.storage)
        net.close()
        net.close()
        if linked and (left := int(interface.number_of_tetras(storage))):
            yield f"release: number_of_tetras is {left} after it, and a second release would give back what is gone"


RULES = (
    Rule("complete", "every function of the interface is there", _complete, essential=True),
    Rule("built", "a fresh net holds the mesh: vertices, neighbours, geometry, states, in its order", _built),
    Rule("fields", "each setter stores each value in its place, and touches no other", _fields),
    Rule("columns", "the arrays that numpy sees are those of the fields", _columns),
    Rule("growth", "growth keeps all, makes room, and leaves the outgrown storage stale", _growth),
    Rule("around", "the tetras around points, in buffers of any length", _around),
    Rule("edits", "insert and delete through a history at random, refused edits among them", _edits),
    Rule("split", "split_many: children, states, points, what is skipped", _split),
    Rule("collect", "collect finishes what deletions have left, and says so", _collect),
    Rule("undone", "what is undone has not been, and what is kept has", _undone),
    Rule("released", "nets are given back", _released),
)
"""In this order: what comes first is relied upon later."""
