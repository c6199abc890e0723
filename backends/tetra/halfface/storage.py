"""The half-face storage: arrays that kernels take, how they are made and grown, and the small changes all others consist of.

Source, here and in this folder ("the thesis"): David Hromádka, Knihovna pro práci s tetraedrální sítí (A library for
tetrahedral meshes), Brno University of Technology 2013; this is its 5.6. It rests on T. J. Alumbaugh and X. Jiao, Compact
array-based mesh data structures, 14th International Meshing Roundtable 2005.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.backends.tetra.halfface.compound import (
    BORDER,
    DELETED,
    FLAG,
    INNER,
    SPECIAL,
    WORDS,
    base_mask,
    base_of,
    compound,
    extension_of,
    refuse_beyond,
)
from tetrabench.backends.tetra.halfface.permutations import place_of
from tetrabench.jit import kernel
from tetrabench.tetra.points import grown

NONE = np.int64(-1)
"""No element, no record, the end of a chain; words say it with a base that is all ones."""

# places in the counters
TETRAS, FLAGGED = 0, 1  # tetras, those with a delete flag among them
BORDERS, FREE_BORDER, FREE_BORDERS = 2, 3, 4  # entries of bhf2hf in use or free; the chain of free ones; how many
VERTICES, DELETED_VERTEX, DELETED_VERTICES = 5, 6, 7  # likewise of v2hf
RECORDS, FREE_RECORD, FREE_RECORDS = 8, 9, 10  # likewise of v2nhf
LARGEST_FAN = 11  # no vertex has more tetras than this; it may have fewer

# places in the state of a walk
STAMP, VISITED, MASK = 0, 1, 2


class HalfFaces(NamedTuple):
    """The topology of a mesh. All but the last four fields are words: uint32, or int64 (see `compound`).

    Attributes:
        connectivity: (capacity, 4), for each tetra its vertices, ascending, and in their extensions: the delete flag and
            the number of the permutation that restores the original order (words 0 and 1), six user flags (2 and 3).
        adjacency: (capacity, 4), for each half-face of a tetra the opposite one, of a tetra or on the border. Half-face X
            lacks vertex 3 - X.
        bhf2hf: (capacity,), for each border half-face its opposite one; for a free one (DELETED) the next that is free.
        v2hf: (capacity,), for each vertex its access half-face, from which walking around it reaches all its tetras, one on
            the border where there is one; or SPECIAL: isolated, with base 0, or non-manifold, with base 1 + the place
            of its first record in v2nhf; or DELETED, with the next vertex that is.
        vborders: (capacity,), how many half-faces on the border each vertex has.
        v2nhf: (capacity, 2), an access half-face of a non-manifold vertex, and the place of its next record.
        counters: (12,) int64, see TETRAS and so on.
        queue: (capacity,) int64, where a walk around a vertex puts what it finds: see `walks`.
        table: (capacity,) int64, a hash table of what is in the queue.
        walk: (3,) int64, state of the walk.
    """

    connectivity: NDArray[Any]
    adjacency: NDArray[Any]
    bhf2hf: NDArray[Any]
    v2hf: NDArray[Any]
    vborders: NDArray[Any]
    v2nhf: NDArray[Any]
    counters: NDArray[np.int64]
    queue: NDArray[np.int64]
    table: NDArray[np.int64]
    walk: NDArray[np.int64]


def make_halffaces(vertices: int, tetras: int, borders: int, *, bits: int, fan: int = 32) -> HalfFaces:
    """No tetra, `vertices` isolated vertices; room for `tetras` tetras, `borders` border half-faces, fans of `fan` tetras."""
    words = WORDS[bits]
    mesh = HalfFaces(
        np.empty((tetras, 4), words),
        np.empty((tetras, 4), words),
        np.empty(borders, words),
        np.empty(vertices, words),
        np.zeros(vertices, words),
        np.empty((0, 2), words),
        np.zeros(12, np.int64),
        np.empty(fan, np.int64),
        np.zeros(_table_size(fan), np.int64),
        np.array([1, 0, 0], np.int64),
    )
    mesh.counters[[FREE_BORDER, DELETED_VERTEX, FREE_RECORD]] = NONE
    mesh.counters[VERTICES] = vertices
    mesh.v2hf[:] = isolated(mesh)
    return mesh


def reserve(
    mesh: HalfFaces, *, tetras: int = 0, borders: int = 0, vertices: int = 0, records: int = 0, fan: int = 0
) -> HalfFaces:
    """A storage with room for so many more of each, and for walks around so many tetras more: this one, or a grown one.

    Arrays grow by a quarter, and by 1,024 at least. An outgrown storage must not be used any more.

    Raises:
        InputError: more than the words can count.
    """
    counters = mesh.counters
    sizes = {
        "connectivity": int(counters[TETRAS]) + tetras,
        "adjacency": int(counters[TETRAS]) + tetras,
        "bhf2hf": int(counters[BORDERS] - counters[FREE_BORDERS]) + borders,
        "v2hf": int(counters[VERTICES]) + vertices,
        "vborders": int(counters[VERTICES]) + vertices,
        "v2nhf": int(counters[RECORDS] - counters[FREE_RECORDS]) + records,
    }
    wanting = {name: size for name, size in sizes.items() if size > len(getattr(mesh, name))}
    if wanting:
        refuse_beyond(8 * mesh.adjacency.itemsize, **{f"rows of {name}": size for name, size in wanting.items()})
        mesh = mesh._replace(
            **{name: grown(getattr(mesh, name), _enough(mesh, name, wanting[name])) for name in wanting}
        )
    return _with_fans(mesh, fan)


def _with_fans(mesh: HalfFaces, tetras: int) -> HalfFaces:
    """A storage whose walks have room for the largest fan and `tetras` tetras more."""
    if mesh.counters[LARGEST_FAN] + tetras > len(mesh.queue):
        mesh.counters[LARGEST_FAN] = _largest_fan(mesh)  # what is noted is no more than a bound
    wanted = int(mesh.counters[LARGEST_FAN]) + tetras
    if wanted > len(mesh.queue):
        fan = max(wanted, len(mesh.queue) + max(len(mesh.queue) // 4, 1024))
        mesh = mesh._replace(queue=np.empty(fan, np.int64), table=np.zeros(_table_size(fan), np.int64))
        mesh.walk[:] = 1, 0, 0
    return mesh


def _largest_fan(mesh: HalfFaces) -> int:
    """How many tetras the vertex with most of them has."""
    tetras = int(mesh.counters[TETRAS])
    fans = np.zeros(len(mesh.v2hf), np.int64)
    _count_fans(mesh, fans)
    return int(fans.max()) if tetras else 0


@kernel(allocates=False)
def _count_fans(mesh: HalfFaces, fans: Any) -> None:
    for t in range(mesh.counters[TETRAS]):
        for k in range(4):
            fans[vertex_at(mesh, t, k)] += 1


def _enough(mesh: HalfFaces, name: str, wanted: int) -> int:
    have = len(getattr(mesh, name))
    return max(wanted, have + max(have // 4, 1024))


def _table_size(fan: int) -> int:
    return max(64, 1 << (2 * fan - 1).bit_length())


# ------------------------------------------------------------------------------------------------------ reading


@kernel(allocates=False, inline=True)
def vertex_at(mesh: HalfFaces, t: int, place: int) -> Any:
    """The vertex of tetra t at a place of the ascending order."""
    return base_of(mesh.connectivity, mesh.connectivity[np.uint64(t), np.uint64(place)])


@kernel(allocates=False, inline=True)
def permutation_of(mesh: HalfFaces, t: int) -> Any:
    """The number of the permutation that restores the original order of tetra t."""
    words = mesh.connectivity
    high = extension_of(words, words[np.uint64(t), 0]) & 3
    return high << 3 | extension_of(words, words[np.uint64(t), 1])


@kernel(allocates=False, inline=True)
def place_in(mesh: HalfFaces, t: int, vertex: int) -> Any:
    """The place of a vertex in tetra t; 3 where it is none of the first three."""
    place = np.int64(3)
    for k in range(3):
        if vertex_at(mesh, t, k) == vertex:
            place = np.int64(k)
    return place


@kernel(allocates=False, inline=True)
def vertex_as_given(mesh: HalfFaces, t: int, i: int) -> Any:
    """Vertex i of tetra t as it was given."""
    return vertex_at(mesh, t, place_of(permutation_of(mesh, t), i))


@kernel(allocates=False, inline=True)
def is_flagged(mesh: HalfFaces, t: int) -> Any:
    """Whether tetra t has the delete flag."""
    return extension_of(mesh.connectivity, mesh.connectivity[np.uint64(t), 0]) >= FLAG


@kernel(allocates=False, inline=True)
def opposite_of(mesh: HalfFaces, t: int, x: int) -> Any:
    """The half-face opposite half-face x of tetra t."""
    return np.int64(mesh.adjacency[np.uint64(t), np.uint64(x)])


@kernel(allocates=False, inline=True)
def inner(mesh: HalfFaces, t: int, x: int) -> Any:
    """The handle of half-face x of tetra t."""
    return compound(mesh.adjacency, t, INNER + x)


@kernel(allocates=False, inline=True)
def is_border(mesh: HalfFaces, halfface: int) -> Any:
    """Whether a half-face lies on the border; its handle is its index then."""
    return extension_of(mesh.adjacency, halfface) == BORDER


@kernel(allocates=False, inline=True)
def tetra_of(mesh: HalfFaces, halfface: int) -> Any:
    """The tetra of a half-face that is not on the border."""
    return base_of(mesh.adjacency, halfface)


@kernel(allocates=False, inline=True)
def number_of(mesh: HalfFaces, halfface: int) -> Any:
    """Which half-face of its tetra, 0..3, a half-face is that is not on the border."""
    return extension_of(mesh.adjacency, halfface) - INNER


@kernel(allocates=False, inline=True)
def inner_of(mesh: HalfFaces, halfface: int) -> Any:
    """A half-face itself, or the opposite one where it lies on the border: the one that a tetra has."""
    return np.int64(mesh.bhf2hf[np.uint64(halfface)]) if is_border(mesh, halfface) else np.int64(halfface)


# ------------------------------------------------------------------------------------- border half-faces


@kernel(allocates=False)
def take_border(mesh: HalfFaces, t: int, x: int) -> Any:
    """A new border half-face opposite half-face x of tetra t, entered there too. Needs room."""
    counters, words = mesh.counters, mesh.bhf2hf
    border = counters[FREE_BORDER]
    if border == NONE:
        border = counters[BORDERS]
        counters[BORDERS] = border + 1
    else:
        counters[FREE_BORDER] = next_in_chain(words, words[border])
        counters[FREE_BORDERS] -= 1
    words[border] = inner(mesh, t, x)
    mesh.adjacency[t, x] = border
    count_border(mesh, t, x, 1)
    return border


@kernel(allocates=False)
def free_border(mesh: HalfFaces, border: int) -> None:
    """Put a border half-face onto the chain of those that are free."""
    counters = mesh.counters
    halfface = np.int64(mesh.bhf2hf[border])
    count_border(mesh, tetra_of(mesh, halfface), number_of(mesh, halfface), -1)
    mesh.bhf2hf[border] = chained(mesh.bhf2hf, counters[FREE_BORDER])
    counters[FREE_BORDER] = border
    counters[FREE_BORDERS] += 1


@kernel(allocates=False)
def count_border(mesh: HalfFaces, t: int, x: int, more: int) -> None:
    """The vertices of half-face x of tetra t have so many more half-faces on the border."""
    for place in range(4):
        if place != 3 - x:
            v = vertex_at(mesh, t, place)
            mesh.vborders[v] = np.int64(mesh.vborders[v]) + more


@kernel(allocates=False, inline=True)
def next_in_chain(words: Any, word: int) -> Any:
    """The link in a free entry: what comes next in its chain, or NONE."""
    following = base_of(words, word)
    return following if following != base_mask(words) else NONE


@kernel(allocates=False, inline=True)
def chained(words: Any, following: int) -> Any:
    """The word of a free entry."""
    return compound(words, following if following != NONE else base_mask(words), DELETED)


# ----------------------------------------------------------------------------------------- what vertices say


@kernel(allocates=False, inline=True)
def isolated(mesh: HalfFaces) -> Any:
    """What an isolated vertex says."""
    return compound(mesh.v2hf, 0, SPECIAL)


@kernel(allocates=False, inline=True)
def says_deleted(mesh: HalfFaces, v: int) -> Any:
    """Whether vertex v is deleted."""
    return extension_of(mesh.v2hf, mesh.v2hf[np.uint64(v)]) == DELETED


@kernel(allocates=False, inline=True)
def first_record(mesh: HalfFaces, v: int) -> tuple[Any, Any]:
    """The first access half-face of vertex v, NONE if it is isolated, and the place in v2nhf it comes from, or NONE."""
    word = np.int64(mesh.v2hf[np.uint64(v)])
    record, place = word, NONE
    if extension_of(mesh.v2hf, word) == SPECIAL:
        place = base_of(mesh.v2hf, word) - 1
        record = np.int64(mesh.v2nhf[place, 0]) if place >= 0 else NONE
    elif extension_of(mesh.v2hf, word) == DELETED:
        record = NONE
    return record, place


@kernel(allocates=False, inline=True)
def next_record(mesh: HalfFaces, place: int) -> tuple[Any, Any]:
    """The access half-face after the one from this place in v2nhf, and where it comes from; NONE after the last."""
    following, record = NONE, NONE
    if place != NONE:
        following = next_in_chain(mesh.v2nhf, mesh.v2nhf[place, 1])
    if following != NONE:
        record = np.int64(mesh.v2nhf[following, 0])
    return record, following


@kernel(allocates=False)
def add_record(mesh: HalfFaces, v: int, halfface: int) -> None:
    """One more access half-face of vertex v, before the others. Needs room for two records."""
    word = np.int64(mesh.v2hf[v])
    if word == isolated(mesh):
        mesh.v2hf[v] = halfface
    else:
        if extension_of(mesh.v2hf, word) == SPECIAL:
            following = base_of(mesh.v2hf, word) - 1
        else:
            following = _take_record(mesh, word, NONE)
        mesh.v2hf[v] = compound(mesh.v2hf, 1 + _take_record(mesh, halfface, following), SPECIAL)


@kernel(allocates=False)
def _take_record(mesh: HalfFaces, halfface: int, following: int) -> Any:
    counters, words = mesh.counters, mesh.v2nhf
    place = counters[FREE_RECORD]
    if place == NONE:
        place = counters[RECORDS]
        counters[RECORDS] = place + 1
    else:
        counters[FREE_RECORD] = next_in_chain(words, words[place, 1])
        counters[FREE_RECORDS] -= 1
    words[place, 0] = halfface
    words[place, 1] = chained(words, following)
    return place


@kernel(allocates=False)
def free_record(mesh: HalfFaces, place: int) -> None:
    """Put a record onto the chain of those that are free."""
    counters = mesh.counters
    mesh.v2nhf[place, 0] = chained(mesh.v2nhf, NONE)  # a free record says that it is
    mesh.v2nhf[place, 1] = chained(mesh.v2nhf, counters[FREE_RECORD])
    counters[FREE_RECORD] = place
    counters[FREE_RECORDS] += 1


def array_sizes(mesh: HalfFaces) -> dict[str, tuple[int, int]]:
    """Bytes (used, reserved) of each array, by name; what a walk needs is used throughout."""
    counters = mesh.counters
    rows = {
        "connectivity": counters[TETRAS],
        "adjacency": counters[TETRAS],
        "bhf2hf": counters[BORDERS],
        "v2hf": counters[VERTICES],
        "vborders": counters[VERTICES],
        "v2nhf": counters[RECORDS],
    }
    return {
        name: (int(rows.get(name, len(array))) * (array.nbytes // max(len(array), 1)), array.nbytes)
        for name, array in mesh._asdict().items()
    }
