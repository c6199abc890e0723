"""Self-audit of a half-face mesh: everything it stores, checked against everything else it stores.

Written with numpy and scipy and without the kernels it looks after. O(n log n), and safe on damaged meshes.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tetrabench.backends.tetra.halfface import storage
from tetrabench.backends.tetra.halfface.compound import BORDER, DELETED, INNER, SPECIAL
from tetrabench.backends.tetra.halfface.storage import HalfFaces

Ints = NDArray[np.int64]

CHECKS = {
    "counters": "a counter is beyond what there is room for, or counts wrongly",
    "chains": "a chain of free entries does not hold each of them once",
    "vertices": "a tetra has a vertex that is none, or not in ascending order, or no permutation",
    "twins": "two tetras have the same four vertices",
    "adjacency": "opposite half-faces are not mutual, or have other vertices, or one face has several, or more than two tetras",
    "access": "a vertex does not have one access half-face for each component of its tetras",
    "border": "an access half-face is not on the border though there is one there",
}
"""What is checked, by name, with the sentence for a person."""

_FACES = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])  # places of the vertices of half-face X


def audit(mesh: HalfFaces) -> list[str]:
    """What is wrong with a mesh: names of CHECKS, empty if it is sound."""
    if not _counters_are_sound(mesh):
        return ["counters"]  # nothing else can be trusted, not even to end
    faults = []
    if not _chains_are_sound(mesh):
        faults.append("chains")
    vertices = _bases(mesh.connectivity, mesh)[: mesh.counters[storage.TETRAS]]
    if not _vertices_are_sound(mesh, vertices):
        return [*faults, "vertices"]
    if np.bincount(vertices.ravel()).max(initial=0) > mesh.counters[storage.LARGEST_FAN]:
        faults.append("counters")
    if _most_alike(vertices) > 1:
        faults.append("twins")
    if not _adjacency_is_sound(mesh, vertices):
        return [*faults, "adjacency"]
    return faults + ([] if "chains" in faults else _access_faults(mesh, vertices))


def _most_alike(rows: Ints) -> int:
    """How often the row comes that comes most often. (numpy's own way with rows takes ten times as long.)"""
    keys = np.zeros(len(rows), np.int64)
    for column in rows.T:  # a number for each beginning of a row
        keys = np.unique(keys * (column.max(initial=0) + 1) + column, return_inverse=True)[1]
    return int(np.bincount(keys).max(initial=0))


def _bits(mesh: HalfFaces) -> int:
    return 29 if mesh.adjacency.itemsize == 4 else 60


def _bases(words: NDArray[np.generic], mesh: HalfFaces) -> Ints:
    return np.asarray(words).astype(np.int64) & ((1 << _bits(mesh)) - 1)


def _extensions(words: NDArray[np.generic], mesh: HalfFaces) -> Ints:
    return np.asarray(words).astype(np.int64) >> _bits(mesh)


def _counters_are_sound(mesh: HalfFaces) -> bool:
    counters = mesh.counters
    within = [
        (storage.TETRAS, len(mesh.connectivity)),
        (storage.TETRAS, len(mesh.adjacency)),
        (storage.FLAGGED, counters[storage.TETRAS]),
        (storage.BORDERS, len(mesh.bhf2hf)),
        (storage.FREE_BORDERS, counters[storage.BORDERS]),
        (storage.VERTICES, len(mesh.v2hf)),
        (storage.DELETED_VERTICES, counters[storage.VERTICES]),
        (storage.RECORDS, len(mesh.v2nhf)),
        (storage.FREE_RECORDS, counters[storage.RECORDS]),
        (storage.LARGEST_FAN, len(mesh.queue)),
    ]
    if not all(0 <= counters[place] <= limit for place, limit in within) or len(mesh.table) < 2 * len(mesh.queue):
        return False
    live = mesh.connectivity[: counters[storage.TETRAS]]
    flagged = int((_extensions(live[:, 0], mesh) >= 4).sum())
    return bool(flagged == counters[storage.FLAGGED])


def _chains_are_sound(mesh: HalfFaces) -> bool:
    counters = mesh.counters
    borders, vertices = mesh.bhf2hf[: counters[storage.BORDERS]], mesh.v2hf[: counters[storage.VERTICES]]
    records = mesh.v2nhf[: counters[storage.RECORDS]]
    return (
        _is_chain(borders, borders, counters[storage.FREE_BORDER], counters[storage.FREE_BORDERS], mesh)
        and _is_chain(vertices, vertices, counters[storage.DELETED_VERTEX], counters[storage.DELETED_VERTICES], mesh)
        and _is_chain(records[:, 0], records[:, 1], counters[storage.FREE_RECORD], counters[storage.FREE_RECORDS], mesh)
    )


def _is_chain(marks: NDArray[np.generic], links: NDArray[np.generic], place: int, count: int, mesh: HalfFaces) -> bool:
    """Whether a chain holds, once each, just those `count` entries that are marked as free."""
    free = _extensions(marks, mesh) == DELETED
    following, seen = _bases(links, mesh), set()
    none = (1 << _bits(mesh)) - 1
    linked = bool((_extensions(links, mesh)[free] == DELETED).all())
    place = none if place == storage.NONE else int(place)
    while place != none:
        if not 0 <= place < len(free) or not free[place] or place in seen:
            return False
        seen.add(place)
        place = int(following[place])
    return linked and len(seen) == count == int(free.sum())


def _vertices_are_sound(mesh: HalfFaces, vertices: Ints) -> bool:
    count = mesh.counters[storage.VERTICES]
    if not ((vertices < count).all() and (vertices[:, 1:] > vertices[:, :-1]).all()):
        return False
    extensions = _extensions(mesh.connectivity[: len(vertices)], mesh)
    numbers = (extensions[:, 0] & 3) << 3 | extensions[:, 1]
    deleted = _extensions(mesh.v2hf[:count], mesh) == DELETED
    return bool((numbers < 24).all() and not deleted[vertices].any())


def _adjacency_is_sound(mesh: HalfFaces, vertices: Ints) -> bool:
    tetras, borders = len(vertices), mesh.counters[storage.BORDERS]
    opposite = mesh.adjacency[:tetras].astype(np.int64)
    base, extension = _bases(opposite, mesh), _extensions(opposite, mesh)
    own = (np.arange(tetras)[:, None]) | (np.arange(4) + INNER) << _bits(mesh)
    faces = vertices[:, _FACES]
    on_border = extension == BORDER
    within = (extension >= INNER) & (extension < INNER + 4) & (base < tetras) & (base != np.arange(tetras)[:, None])
    if not (within | (on_border & (base < borders))).all():
        return False
    t, x = np.nonzero(~on_border)
    u, y = base[t, x], extension[t, x] - INNER
    if not ((opposite[u, y] == own[t, x]).all() and (faces[u, y] == faces[t, x]).all()):
        return False
    there = mesh.bhf2hf[:borders].astype(np.int64)
    live = np.flatnonzero(_extensions(there, mesh) != DELETED)
    t, x = np.nonzero(on_border)
    alone = faces[t, x]
    counted = np.bincount(alone.ravel(), minlength=mesh.counters[storage.VERTICES])
    return bool(
        np.array_equal(np.sort(base[t, x]), live)
        and (there[base[t, x]] == own[t, x]).all()
        and _most_alike(alone) <= 1
        and _most_alike(faces.reshape(-1, 3)) <= 2
        and np.array_equal(mesh.vborders[: mesh.counters[storage.VERTICES]], counted)
    )


def _access_faults(mesh: HalfFaces, vertices: Ints) -> list[str]:
    """Names of what is wrong with what the vertices say."""
    tetras, count = len(vertices), mesh.counters[storage.VERTICES]
    components, has_border = _components(mesh, vertices)
    # of each component: who its vertex is
    owner = np.full(components.max(initial=-1) + 1, -1)
    owner[components.ravel()] = vertices.ravel()
    said = np.zeros(len(owner), np.int64)
    used = 0
    for v in range(count):
        records = _records_of(mesh, v)
        if records is None:
            return ["access"]
        used += len(records) if len(records) > 1 else 0
        for record in records:
            corner = _corner_of(mesh, vertices, record, v, tetras)
            if corner is None:
                return ["access"]
            said[components[corner]] += 1
            if has_border[components[corner]] and record >> _bits(mesh) != BORDER:
                return ["border"]
    held = mesh.counters[storage.RECORDS] - mesh.counters[storage.FREE_RECORDS]
    return [] if (said == 1).all() and used == held else ["access"]


def _components(mesh: HalfFaces, vertices: Ints) -> tuple[Ints, NDArray[np.bool_]]:
    """For each corner (n, 4) which component of its vertex's tetras it is in; for each component whether it has border."""
    tetras = len(vertices)
    opposite = mesh.adjacency[:tetras].astype(np.int64)
    extension, base = _extensions(opposite, mesh), _bases(opposite, mesh)
    t, x = np.nonzero(extension != BORDER)
    here = 4 * t[:, None] + _FACES[x]
    there = 4 * base[t, x][:, None] + _FACES[extension[t, x] - INNER]
    pairs = (np.ones(here.size, np.bool_), (here.ravel(), there.ravel()))
    found, labels = connected_components(coo_array(pairs, shape=(4 * tetras, 4 * tetras)), directed=False)
    t, x = np.nonzero(extension == BORDER)
    has_border = np.zeros(found, np.bool_)
    has_border[labels[(4 * t[:, None] + _FACES[x]).ravel()]] = True
    return labels.astype(np.int64).reshape(tetras, 4), has_border


def _records_of(mesh: HalfFaces, v: int) -> list[int] | None:
    """The access half-faces of a vertex; None where what it says makes no sense."""
    bits = _bits(mesh)
    word = int(mesh.v2hf[v])
    extension, base = word >> bits, word & ((1 << bits) - 1)
    if extension == DELETED or (extension == SPECIAL and base == 0):
        return []
    if extension != SPECIAL:
        return [word] if extension < INNER + 4 else None
    records: list[int] = []
    place, limit = base - 1, int(mesh.counters[storage.RECORDS])
    while place != (1 << bits) - 1:
        if not 0 <= place < limit or len(records) > limit or int(mesh.v2nhf[place, 1]) >> bits != DELETED:
            return None
        records.append(int(mesh.v2nhf[place, 0]))
        place = int(mesh.v2nhf[place, 1]) & ((1 << bits) - 1)
    return records if len(records) > 1 else None


def _corner_of(mesh: HalfFaces, vertices: Ints, record: int, v: int, tetras: int) -> tuple[int, int] | None:
    """Tetra and place of vertex v in an access half-face; None where that has no such vertex."""
    bits = _bits(mesh)
    if record >> bits == BORDER:
        if record >= mesh.counters[storage.BORDERS]:
            return None
        record = int(mesh.bhf2hf[record])
    t, x = record & ((1 << bits) - 1), (record >> bits) - INNER
    if not 0 <= x < 4 or t >= tetras:
        return None
    places = [int(place) for place in _FACES[x] if vertices[t, place] == v]
    return (t, places[0]) if places else None
