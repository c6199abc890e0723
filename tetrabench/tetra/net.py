"""TetraNet: the Python face of any tetra contestant."""

import operator
import os
import weakref
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any, Self, cast

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetrabench.errors import InputError, refuse_name
from tetrabench.io import check_target, write_mesh
from tetrabench.io.formats import BY_SUFFIX
from tetrabench.jit import kernel
from tetrabench.jit.generic import is_implemented
from tetrabench.memory import refuse_if_too_large
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.check import check_mesh
from tetrabench.mesh.incidence import vertex_tetras
from tetrabench.protocols import Answer
from tetrabench.tetra import audit, digest, edit, interface, memory, transaction
from tetrabench.tetra.by_ref import ByRef
from tetrabench.tetra.contestant import TetraContestant
from tetrabench.tetra.deform import deform
from tetrabench.tetra.interface import NONE, Net
from tetrabench.tetra.locate import Grid, locate
from tetrabench.tetra.nearest import make_stack, nearest_points
from tetrabench.tetra.points import COUNT, EDITS

PEAK = 390.0  # bytes a tetra while a net is built: measured 300 with arrays, 372 with linked nodes (10 M tetras)


class TetraNet:
    """A tetrahedral net in the storage of a contestant: ask it, change it, or hand `storage` to kernels of your own.

    A ref stands for a tetra: an int64. Where the contestant has `stable_refs` it is valid until that tetra is deleted; else
    `collect` ends all refs when it returns True, and so may `insert` and `split`, which collect where they have to.
    Arrays of refs are (n,) int64; -1 is no tetra. Properties over the whole net are in iteration order, that of `refs`.

    >>> import tetrabench
    >>> net = tetrabench.open(tetrabench.generate("box", 48), backend="v3y")
    >>> net
    <TetraNet v3y: 48 tetras, 27 points>
    >>> net.locate([net.points.mean(axis=0), [9.0, 9.0, 9.0]]) >= 0
    array([ True, False])
    >>> corners = net.vertices_of(0)
    >>> net.delete(0)
    >>> net.insert(*corners) in net
    True
    >>> net.split(net.refs[:10])  # none is skipped
    0
    >>> len(net), net.check()
    (78, [])
    """

    def __init__(self, mesh: TetraMesh, contestant: TetraContestant) -> None:
        """Build the net of a mesh: point refs are the rows of `mesh.points`; states are 0.

        The contestant is an object, as `tetrabench.contestant("tetra", "v3y")` gives it.

        Raises:
            InputError: the mesh is none that a net can hold (a repeated vertex, a side of three tetras, ...); a name in place
                of the contestant.
            MemoryRefusedError: there is not enough memory for it.
        """
        refuse_name(contestant, "tetra")
        check_mesh(mesh)
        refuse_if_too_large(f"a net of {len(mesh.tets):,} tetras", len(mesh.tets) * PEAK)
        self.contestant = contestant
        self._adopt(contestant.build(mesh))

    def _adopt(self, storage: Net) -> None:
        self._forget()
        self._is_edited = False  # inside `edit`
        # What Python cannot see (V4's nodes) goes when the last owner goes. Growth keeps the nodes and changes the
        # counters that lead to them, so the finalizer follows the box, not the storage of today.
        self._box = [storage]
        self._finalizer = weakref.finalize(self, _release, self._box)
        self._finalizer.atexit = False  # a process that ends gives everything back

    def _forget(self) -> None:
        """Forget all that was derived from the storage."""
        self._grid: tuple[int, Grid] | None = None
        self._live: tuple[int, set[int]] | None = None

    @property
    def storage(self) -> Net:
        """What kernels take. A kernel that edits returns the storage to go on with: assign it back.

        Raises:
            InputError: the net is closed.
        """
        if not self._box:
            raise InputError("this net is closed: its memory was given back")
        return self._box[0]

    @storage.setter
    def storage(self, storage: Net) -> None:
        if not self._box:
            raise InputError("this net is closed: its memory was given back")
        self._box[0] = storage

    def close(self) -> None:
        """Give the memory back now; the net is unusable afterwards. May come twice.

        Raises:
            InputError: inside `edit`.
        """
        if self._is_edited:
            raise InputError("this net cannot be closed inside of an edit: what would it go back to?")
        self._finalizer()
        self._forget()

    @property
    def is_open(self) -> bool:
        """False after `close`."""
        return bool(self._box)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    # ------------------------------------------------------------------ counts and whole-net arrays

    def __len__(self) -> int:
        return int(interface.number_of_tetras(self.storage))

    def __iter__(self) -> Iterator[int]:
        """Refs in iteration order, of the net as it is now: it may change on the way."""
        return iter(self.refs.tolist())

    def __contains__(self, t: object) -> bool:
        """Whether t is the ref of a tetra of this net. Anything may be asked; every method that takes a ref asks it."""
        try:
            ref = _whole(t)
        except InputError:
            return False
        if self._has_addresses:
            return ref in self._addresses()
        return ref >= 0 and bool(interface.is_live(self.storage, ref))

    @property
    def _has_addresses(self) -> bool:
        """Whether refs are addresses, of which none tells by itself whether a tetra is there."""
        return is_implemented(interface.release, self.storage)

    def _addresses(self) -> set[int]:
        """The refs of all tetras; listed anew where the net was edited by others than `insert` and `delete`."""
        edits = int(self.storage.points.counters[EDITS])
        if self._live is None or self._live[0] != edits:
            self._live = edits, set(self.refs.tolist())
        return self._live[1]

    def _drop_stale_addresses(self) -> None:
        """Forget the list of addresses if others have edited the net since it was made."""
        if self._live is not None and self._live[0] != int(self.storage.points.counters[EDITS]):
            self._live = None

    def _book(self, *, born: int | None = None, dead: int | None = None) -> None:
        """Keep the list of addresses in step with an edit: to list all after each would make a loop quadratic."""
        if self._live is not None:
            _, refs = self._live
            refs.discard(dead)
            refs.update([] if born is None else [born])
            self._live = int(self.storage.points.counters[EDITS]), refs

    @property
    def refs(self) -> NDArray[np.int64]:
        """Refs of all tetras, (n,) int64, in iteration order."""
        refs: NDArray[np.int64] = interface.tetra_refs(self.storage)
        return refs

    @property
    def last(self) -> int:
        """The last tetra (highest index, or tail of the list), -1 in an empty net."""
        return int(interface.last_tetra(self.storage)) if len(self) else int(NONE)

    @property
    def number_of_points(self) -> int:
        """Points, those that no tetra uses included; the last one has the ref one below."""
        return int(self.storage.points.counters[COUNT])

    @property
    def points(self) -> NDArray[np.float64]:
        """Coordinates, (n, 3) float64, a view that must not be written to (see `deform`)."""
        view = self.storage.points.xyz[: self.number_of_points]
        view.flags.writeable = False
        return view

    @property
    def vertices(self) -> NDArray[np.int32]:
        """Point refs, (n, 4) int32."""
        return _vertices(self.storage, self.refs)

    @property
    def neighbours(self) -> NDArray[np.int64]:
        """Refs of the tetras behind the sides, (n, 4) int64; side i is opposite vertex i; -1 at the surface."""
        return _neighbours(self.storage, self.refs)

    @property
    def around_points(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """The tetras around all points at once: starts (points + 1,) int64, refs (4 n,) int64.

        Those around point p are `refs[starts[p]:starts[p + 1]]`, in iteration order.
        """
        refs = self.refs
        starts, rows = vertex_tetras(_vertices(self.storage, refs), self.number_of_points)
        return starts, refs[rows]

    @property
    def volumes(self) -> NDArray[np.float64]:
        """Volumes, (n,) float64, absolute, in the cube of the points' unit."""
        return self._static()[:, 0]

    @property
    def centroids(self) -> NDArray[np.float64]:
        """Means of the vertices, (n, 3) float64."""
        return self._static()[:, 1:4]

    @property
    def side_areas(self) -> NDArray[np.float64]:
        """Areas of the sides, (n, 4) float64."""
        return self._static()[:, 4:8]

    @property
    def side_normals(self) -> NDArray[np.float64]:
        """Outward unit normals of the sides, (n, 4, 3) float64."""
        return self._static()[:, 8:].reshape(-1, 4, 3)

    def _static(self) -> NDArray[np.float64]:
        return _static(self.storage, self.refs)

    @property
    def states(self) -> NDArray[np.float64]:
        """State vectors, (n, 5) float64, a copy; assign an array of that shape to set them."""
        return _states(self.storage, self.refs)

    @states.setter
    def states(self, values: ArrayLike) -> None:
        _set_states(self.storage, self.refs, self._states_like(values, (len(self), interface.STATES)))

    def _states_like(self, values: ArrayLike, shape: tuple[int, ...]) -> NDArray[np.float64]:
        numbers = _numbers(values, "states")
        if numbers.shape != shape:
            raise InputError(f"these states must have the shape {shape}, not {numbers.shape}")
        return numbers

    @property
    def by_ref(self) -> ByRef:
        """The fields as they lie in memory, numpy arrays indexed by ref, without a copy: `net.by_ref.volumes[t]`.

        Not every contestant has them: see `ByRef`.
        """
        return ByRef(self.storage, self.contestant.name)

    # ------------------------------------------------------------------ one tetra

    # What the properties above say of all tetras, of one: InputError where there is no such tetra.

    def vertices_of(self, t: int) -> tuple[int, int, int, int]:
        """Point refs of a tetra."""
        a, b, c, d = _vertices(self.storage, self._one(t))[0].tolist()
        return a, b, c, d

    def neighbours_of(self, t: int) -> tuple[int, int, int, int]:
        """Tetras behind the four sides of a tetra, -1 at the surface."""
        a, b, c, d = _neighbours(self.storage, self._one(t))[0].tolist()
        return a, b, c, d

    def volume_of(self, t: int) -> float:
        """Volume of a tetra."""
        return float(self._static_of(t)[0])

    def centroid_of(self, t: int) -> NDArray[np.float64]:
        """Mean of the vertices of a tetra, (3,) float64."""
        return self._static_of(t)[1:4]

    def side_areas_of(self, t: int) -> NDArray[np.float64]:
        """Areas of the sides of a tetra, (4,) float64."""
        return self._static_of(t)[4:8]

    def side_normals_of(self, t: int) -> NDArray[np.float64]:
        """Outward unit normals of the sides of a tetra, (4, 3) float64."""
        return self._static_of(t)[8:].reshape(4, 3)

    def states_of(self, t: int) -> NDArray[np.float64]:
        """State vector of a tetra, (5,) float64, a copy: see `set_states_of`."""
        states: NDArray[np.float64] = _states(self.storage, self._one(t))[0]
        return states

    def set_states_of(self, t: int, values: ArrayLike) -> None:
        """Set the state vector of a tetra, (5,) numbers."""
        values = self._states_like(values, (interface.STATES,))
        _set_states(self.storage, self._one(t), values[None])

    def _static_of(self, t: int) -> NDArray[np.float64]:
        static: NDArray[np.float64] = _static(self.storage, self._one(t))[0]
        return static

    def _one(self, t: int) -> NDArray[np.int64]:
        ref = _whole(t)
        if ref not in self:
            raise InputError(f"there is no tetra {ref}")
        return np.array([ref], np.int64)

    # ------------------------------------------------------------------ points

    def point(self, point: int) -> NDArray[np.float64]:
        """Coordinates of a point, (3,) float64, a view that must not be written to."""
        return self.points[self._known_point(point)]

    def tetras_around(self, point: int) -> list[int]:
        """Refs of the tetras that use a point."""
        refs: list[int] = interface.tetras_around(self.storage, self._known_point(point)).tolist()
        return refs

    def _known_point(self, point: int) -> int:
        ref = _whole(point)
        if not 0 <= ref < self.number_of_points:
            raise InputError(f"there is no point {ref}: the net has {self.number_of_points}")
        return ref

    # ------------------------------------------------------------------ questions

    def locate(self, points: ArrayLike, method: str = "walk") -> NDArray[np.int64]:
        """The tetra that holds each point (m, 3): (m,) refs, -1 outside. See `tetrabench.tetra.locate`."""
        edits = int(self.storage.points.counters[EDITS])
        grid = self._grid[1] if self._grid and self._grid[0] == edits else None
        refs, grid = locate(self.storage, _numbers(points, "points"), method, grid)
        self._grid = (edits, grid) if grid is not None else None
        return refs

    def nearest_points(self, queries: ArrayLike) -> NDArray[np.int32]:
        """The point nearest to each query (m, 3): (m,) point refs."""
        return nearest_points(self.storage.tree, self.points, _numbers(queries, "queries"))

    def select(self, chosen: ArrayLike) -> NDArray[np.int64]:
        """Refs (m,) of the tetras where `chosen`, (n,) bool in iteration order, is true: `net.select(net.volumes > 1)`."""
        mask = np.asarray(chosen)
        if mask.shape != (len(self),) or mask.dtype != np.bool_:
            raise InputError(f"one bool for each of {len(self)} tetras is needed, not {mask.dtype} {mask.shape}")
        return self.refs[mask]

    def check(self) -> list[str]:
        """Audit the whole structure: sentences about what is wrong, empty if it is sound."""
        return [audit.CHECKS[name] for name in audit.audit(self.storage)]

    def answer(self) -> Answer:
        """A digest that is equal for equal nets, however they are stored, and sums for people."""
        return digest.net_answer(self.storage)

    def structure_bytes(self) -> dict[str, tuple[int, int]]:
        """Bytes (used, reserved) of each buffer, by name."""
        return memory.structure_bytes(self.storage)

    # ------------------------------------------------------------------ changes

    @contextmanager
    def edit(self) -> Iterator[Self]:
        """Changes that happen all or not at all: `with net.edit(): ...`

        An exception that leaves the block takes the net back to where it was when it began, bit for bit: tetras, points,
        states, refs, the order of iteration; it is then raised again. Everything is undone, by whomever it was done, a
        kernel of yours on `net.storage` too. A copy of the net is taken first: that costs as long, and as much memory, as
        `copy`; where the block fails it is the net from then on, and what was taken of `storage` or `by_ref` before is dead.

        >>> import tetrabench
        >>> net = tetrabench.open(tetrabench.generate("box", 48))
        >>> with net.edit():
        ...     net.delete_many(net.refs[:40])
        ...     net.delete(-1)
        Traceback (most recent call last):
        ...
        tetrabench.errors.InputError: there is no tetra -1
        >>> len(net)
        48

        Raises:
            InputError: inside of another edit of the same net.
            MemoryRefusedError: there is no room for a copy.
        """
        if self._is_edited:
            raise InputError("this net is being edited: an edit inside of another could not be undone alone")
        snapshot = transaction.take(self.storage)
        self._is_edited = True
        try:
            yield self
        except BaseException:
            self.storage = transaction.restore(self.storage, snapshot)
            self._forget()  # edits are counted from where they were
            raise
        else:
            transaction.drop(self.storage, snapshot)
        finally:
            self._is_edited = False

    def insert_points(self, points: ArrayLike) -> NDArray[np.int32]:
        """The refs, (m,) int32, of points (m, 3): existing ones or new ones, one after the other as by `insert_point`.

        Raises:
            InputError: another shape, or a coordinate that is not finite; the net is then as it was.
        """
        rows = _numbers(points, "points")
        if rows.ndim != 2 or rows.shape[1] != 3 or not np.isfinite(rows).all():
            raise InputError(f"points are finite numbers of the shape (m, 3); these are {rows.shape}")
        self.storage = edit.reserve(self.storage, 0, len(rows))
        refs: NDArray[np.int32] = _insert_points(self.storage, rows, make_stack())
        return refs

    def insert_many(self, tets: ArrayLike) -> NDArray[np.int64]:
        """Insert tetras, (m, 4) point refs, and return their refs, (m,) int64; states are 0.

        >>> import tetrabench
        >>> net = tetrabench.open(tetrabench.generate("box", 48))
        >>> net.insert_points([[2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 1.0], [3.0, 0.0, 0.0]])
        array([27, 28, 29, 30], dtype=int32)
        >>> net.insert_many([[27, 28, 29, 30]])
        array([48])

        Raises:
            InputError: what `insert` says of one of them; none is inserted then. (Deletions that waited may be collected.)
        """
        rows = _all_whole(tets, 4)
        refs, reason = self._insert_all(rows)
        if reason in interface.IN_THE_WAY and self.collect():  # what was deleted may have been in the way
            refs, reason = self._insert_all(rows)
        if reason:
            refused = tuple(rows[np.flatnonzero(refs == NONE)[0]].tolist())
            raise InputError(f"cannot insert the tetra {refused}: {reason}")
        return refs

    def _insert_all(self, rows: NDArray[np.int64]) -> tuple[NDArray[np.int64], str]:
        """The refs of the tetras, "" if all could be inserted; else none is, and NONE and the reason begin at the first one
        that could not be."""
        self.storage = edit.reserve(self.storage, len(rows), 0)
        self._live = None
        refs, reason = np.full(len(rows), NONE), ""
        try:
            _insert_many(self.storage, rows, refs)
        except BaseException as error:
            _delete_many(self.storage, refs[refs != NONE][::-1].copy())
            if not isinstance(error, ValueError):
                raise
            reason = str(error)
        return refs, reason

    def delete_many(self, refs: ArrayLike) -> None:
        """Delete tetras; their points stay.

        Raises:
            InputError: refs of another shape than (n,), one that is no tetra of the net, or that comes twice. The net is
                then as it was.
        """
        refs = self._distinct(refs, "a tetra can be deleted only once")
        self._live = None
        _delete_many(self.storage, refs)

    def insert_point(self, x: float, y: float, z: float) -> int:
        """The ref of the point there: an existing one, within 1e-9 of the net's diagonal, or a new one.

        The diagonal is that of the points which the net had when it was made, or deformed last.

        Raises:
            InputError: what is no finite number.
        """
        place = _numbers((x, y, z), "a point")
        if place.shape != (3,) or not np.isfinite(place).all():
            raise InputError(f"({x}, {y}, {z}) is no point")
        self.storage = edit.reserve(self.storage, 0, 1)
        return int(edit.insert_point(self.storage, *place.tolist(), make_stack()))

    def insert(self, a: int, b: int, c: int, d: int) -> int:
        """Insert the tetra of four points and return its ref; states are 0.

        Raises:
            InputError: equal or unknown points, a tetra that is there already, a side that two tetras share already. (Where
                deletions waited, and might have been what was in the way, they are collected by then.)
        """
        a, b, c, d = _whole(a), _whole(b), _whole(c), _whole(d)
        self.storage = edit.reserve(self.storage, 1, 0)
        self._drop_stale_addresses()
        try:
            t = self._insert(a, b, c, d)
        except ValueError as error:
            raise InputError(f"cannot insert the tetra ({a}, {b}, {c}, {d}): {error}") from None
        self._book(born=t)
        return t

    def _insert(self, a: int, b: int, c: int, d: int) -> int:
        try:
            return int(interface.insert_tetra(self.storage, a, b, c, d))
        except ValueError as error:
            if str(error) not in interface.IN_THE_WAY or not self.collect():
                raise
        self.storage = edit.reserve(self.storage, 1, 0)  # collecting takes room
        return int(interface.insert_tetra(self.storage, a, b, c, d))

    def delete(self, t: int) -> None:
        """Delete a tetra; its points stay.

        Raises:
            InputError: there is no such tetra.
        """
        ref = int(self._one(t)[0])
        try:
            interface.delete_tetra(self.storage, ref)
        except ValueError as error:
            raise InputError(f"cannot delete {ref}: {error}") from None
        self._book(dead=ref)

    def split(self, refs: ArrayLike) -> int:
        """Split tetras in four around their centroids; children inherit the states. Returns how many were skipped.

        Raises:
            InputError: refs of another shape than (n,), one that is no tetra of the net, or that comes twice. The net is
                then as it was.
        """
        self.storage, skipped = interface.split_many(
            self.storage, self._distinct(refs, "a tetra can be split only once")
        )
        return int(skipped)

    def _distinct(self, refs: ArrayLike, rule: str) -> NDArray[np.int64]:
        """What was given as refs: tetras of the net, each once, or InputError."""
        given = _all_whole(refs)
        strange = given[~np.isin(given, self.refs)]
        if len(strange):
            raise InputError(f"there is no tetra {strange[0]}")
        if len(np.unique(given)) < len(given):
            raise InputError(f"{rule}: a ref comes twice")
        return given

    def collect(self) -> bool:
        """Finish what deletions have left, where a contestant lets them wait (the half-face kernel does).

        Returns whether refs may have changed by it: take them anew then.
        """
        self.storage, changed = interface.collect(self.storage)
        return bool(changed)

    def deform(self, move: Callable[[NDArray[np.float64]], NDArray[np.float64]]) -> int:
        """Move the points by a map (n, 3) -> (n, 3); returns how many tetras were touched. See `tetra.deform`."""
        moved = _numbers(move(self.points.copy()), "new places of points")
        self.storage, touched = deform(self.storage, moved)
        return touched

    # ------------------------------------------------------------------ out of it

    def to_mesh(self) -> TetraMesh:
        """The live tetras in iteration order, with all points."""
        tets, points = self.vertices, np.array(self.points)
        return TetraMesh(points, tets, np.arange(1, len(points) + 1), np.arange(1, len(tets) + 1))

    def write(self, path: str | os.PathLike[str], *, states: bool | None = None, field: str | None = None) -> None:
        """Write the live tetras and all points in the format of the suffix: see `write_mesh`.

        Args:
            path: the file; one that exists is replaced.
            states: whether the states are kept, as values `state_0` to `state_4`, from which `tetrabench.open` takes them
                again. None: where the format keeps any: .msh, .vtk, .vtu and .xdmf do, Nastran and the others do not.
            field: the form of Nastran's fields; "free" keeps every bit of a coordinate.

        Raises:
            InputError: an unknown suffix, states that the format does not keep, or what its writer refuses.
        """
        suffix = check_target(path, field, has_values=bool(states))
        if states is None:
            states = suffix in BY_SUFFIX and BY_SUFFIX[suffix].keeps_values
        values = {f"state_{place}": column for place, column in enumerate(self.states.T.copy())} if states else None
        write_mesh(self.to_mesh(), path, field=field, values=values)

    def take_states(self, values: Mapping[str, NDArray[np.float64]]) -> bool:
        """Set the states from values of the tetras by name, as `read_values` reads what `write` has kept.

        Args:
            values: name -> (n,) float64, in iteration order.

        Returns:
            Whether they are all there; else the states stay as they are.

        Raises:
            InputError: values that are not one for each tetra.
        """
        names = [f"state_{place}" for place in range(interface.STATES)]
        if not set(names) <= set(values):
            return False
        self.states = np.stack([self._states_like(values[name], (len(self),)) for name in names], axis=1)
        return True

    def convert(self, contestant: TetraContestant | str) -> "TetraNet":
        """An independent net with the same points, tetras and states, in the storage of another contestant, "v5" say.

        Raises:
            InputError: there is no contestant of that name.
        """
        if isinstance(contestant, str):
            from tetrabench import registry  # by name alone are they found

            contestant = cast(TetraContestant, registry.contestant("tetra", contestant))
        twin = TetraNet(self.to_mesh(), contestant)
        twin.states = self.states
        return twin

    def copy(self) -> "TetraNet":
        """An independent net with the same points, tetras (without the holes between them) and states."""
        return self.convert(self.contestant)

    __copy__ = copy

    def __deepcopy__(self, _memo: Any) -> "TetraNet":
        return self.copy()

    def __reduce__(self) -> Any:  # a pickle goes through the mesh: a storage may hold addresses
        return _restore, (self.to_mesh(), self.contestant, self.states)

    def __repr__(self) -> str:
        if not self.is_open:
            return f"<TetraNet {self.contestant.name}: closed>"
        return f"<TetraNet {self.contestant.name}: {len(self):,} tetras, {len(self.points):,} points>"


def _restore(mesh: TetraMesh, contestant: TetraContestant, states: NDArray[np.float64]) -> TetraNet:
    net = TetraNet(mesh, contestant)
    net.states = states
    return net


def _whole(ref: object) -> int:
    """What was given as the ref of a tetra or a point: a whole number of 64 bits, or InputError."""
    try:
        number = operator.index(ref)  # type: ignore[arg-type]
    except TypeError:
        raise InputError(f"a ref is a whole number, not a {type(ref).__name__}") from None
    if not -(2**63) <= number < 2**63:
        raise InputError("a ref has 64 bits, and this number more")
    return number


def _numbers(values: ArrayLike, what: str) -> NDArray[np.float64]:
    """What was given as numbers: an array that a kernel may take, or InputError."""
    try:
        return np.require(values, np.float64, ["C", "W", "O"])
    except (TypeError, ValueError) as error:
        raise InputError(f"{what}: numbers are needed, and {error}") from None


def _all_whole(refs: ArrayLike, columns: int | None = None) -> NDArray[np.int64]:
    """What was given as refs: an array (n,), or (n, columns), that a kernel may take, or InputError."""
    shape = "(n,)" if columns is None else f"(n, {columns})"
    try:
        given = np.asarray(refs)
    except ValueError:  # rows of different lengths
        raise InputError(f"refs are whole numbers of the shape {shape}") from None
    if columns is not None and not given.size:
        given = np.empty((0, columns), np.int64)
    if given.shape[1:] != (() if columns is None else (columns,)) or given.ndim == 0:
        raise InputError(f"refs are whole numbers of the shape {shape}, not {given.dtype} {given.shape}")
    if given.dtype.kind not in "iu" and given.size:
        raise InputError(f"refs are whole numbers of the shape {shape}, not {given.dtype} {given.shape}")
    return np.require(given, np.int64, ["C", "W", "O"])


def _release(box: list[Net]) -> None:
    storage = box.pop()
    if is_implemented(interface.release, storage):
        _release_storage(storage)


@kernel
def _release_storage(net: Net) -> None:
    interface.release(net)


@kernel
def _insert_points(net: Net, points: Any, stack: Any) -> Any:
    refs = np.empty(len(points), np.int32)
    for n in range(len(points)):
        refs[n] = edit.insert_point(net, points[n, 0], points[n, 1], points[n, 2], stack)
    return refs


@kernel(allocates=False)
def _insert_many(net: Net, tets: Any, refs: Any) -> None:
    """Insert all tetras; where one is refused, `refs` tells how far that went."""
    for n in range(len(tets)):
        refs[n] = interface.insert_tetra(net, tets[n, 0], tets[n, 1], tets[n, 2], tets[n, 3])


@kernel(allocates=False)
def _delete_many(net: Net, refs: Any) -> None:
    for n in range(len(refs)):
        interface.delete_tetra(net, refs[n])


@kernel
def _vertices(net: Net, refs: Any) -> Any:
    values = np.empty((len(refs), 4), np.int32)
    for n in range(len(refs)):
        for i in range(4):
            values[n, i] = interface.vertex(net, refs[n], i)
    return values


@kernel
def _neighbours(net: Net, refs: Any) -> Any:
    values = np.empty((len(refs), 4), np.int64)
    for n in range(len(refs)):
        for i in range(4):
            values[n, i] = interface.neighbour(net, refs[n], i)
    return values


@kernel
def _static(net: Net, refs: Any) -> Any:
    """Rows of volume, centroid (3), side areas (4), side normals (4 x 3)."""
    values = np.empty((len(refs), 20))
    for n in range(len(refs)):
        values[n, 0] = interface.volume(net, refs[n])
        for k in range(3):
            values[n, 1 + k] = interface.centroid(net, refs[n], k)
        for i in range(4):
            values[n, 4 + i] = interface.side_area(net, refs[n], i)
            for k in range(3):
                values[n, 8 + 3 * i + k] = interface.side_normal(net, refs[n], i, k)
    return values


@kernel
def _states(net: Net, refs: Any) -> Any:
    values = np.empty((len(refs), interface.STATES))
    for n in range(len(refs)):
        for k in range(interface.STATES):
            values[n, k] = interface.state(net, refs[n], k)
    return values


@kernel
def _set_states(net: Net, refs: Any, values: Any) -> None:
    for n in range(len(refs)):
        for k in range(interface.STATES):
            interface.set_state(net, refs[n], k, values[n, k])
