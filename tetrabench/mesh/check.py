"""What no net may hold: found before a net is built, refused or left out where a mesh is read."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError, RepairableError
from tetrabench.jit import kernel
from tetrabench.mesh.quality import count_signs
from tetrabench.mesh.sides import crowded_tetras
from tetrabench.mesh.tetra_mesh import TetraMesh

Points = NDArray[np.float64]
Tets = NDArray[np.int32]
Rows = NDArray[np.int64]

# Why a tetra is faulty, in the order in which the reasons are looked for. A tetra that is faulty for one reason is
# no more there when the next is looked for.
REASONS = {
    "repeated node": "repeats a node",
    "duplicate": "has the same four nodes as an earlier one",
    "crowded side": "shares a side with two earlier ones",
}
NAMED = 3  # faulty tetras that a message names

PLACES = 1 << 14  # counters that fit into the processor's first cache
MULTIPLIER = 2654435769  # Knuth's (The Art of Computer Programming 3, 6.4): 2^32 times the golden section


def check_mesh(mesh: TetraMesh) -> None:
    """Refuse a mesh that no net may hold.

    Raises:
        InputError: arrays of the wrong shape or kind, a coordinate that is NaN or infinite, a tetra with a
            vertex out of range, and what REASONS lists.
    """
    name = mesh.report.source or "mesh"
    points, tets = np.asarray(mesh.points), np.asarray(mesh.tets)
    if points.ndim != 2 or points.shape[1] != 3 or points.dtype.kind not in "fiu":
        raise InputError(f"{name}: points must be numbers of shape (n, 3), not {points.dtype} {points.shape}")
    if tets.ndim != 2 or tets.shape[1] != 4 or tets.dtype.kind not in "iu":
        raise InputError(f"{name}: tets must be integers of shape (m, 4), not {tets.dtype} {tets.shape}")
    if np.shape(mesh.point_ids) != (len(points),) or np.shape(mesh.tet_ids) != (len(tets),):
        raise InputError(f"{name}: point_ids and tet_ids must hold one number for each point and each tetra")

    def where(kind: str, row: int) -> str:
        return f"{name}: {kind} {(mesh.point_ids if kind == 'point' else mesh.tet_ids)[row]} (row {row})"

    faults = find_faults(points, tets, where)
    if faults:
        raise InputError(describe_faults(faults, mesh.tet_ids, where))


def settle(
    mesh: TetraMesh, *, where: Callable[[str, int], str], unused: str = "drop", repair: str = "refuse"
) -> TetraMesh:
    """Make a mesh that a net can hold from all that a file holds: the last step of every reader.

    The order of points, tetras and vertices stays. Inverted and degenerate tetras stay too, and are counted.

    Args:
        mesh: all points and tetras of the file: (n, 3) float64, (m, 4) of any integer type, ids int64.
        where: the place in the file and the name of a "point" or "tetra", by its row, for messages:
            `deck.nas:17: CTETRA 7`.
        unused: "drop" leaves out the points that no tetra uses, "keep" keeps them; `report.unreferenced`
            counts them.
        repair: "refuse" raises where REASONS apply; "drop" leaves out those tetras (of duplicates the first stays,
            at a side the first two), and says so in `report.dropped` and `report.warnings`.

    Raises:
        RepairableError: a tetra is faulty for one of REASONS; names the first, and how many more there are.
        InputError: a coordinate is NaN or infinite, a vertex is out of range, no tetra is left.
    """
    if unused not in ("drop", "keep"):
        raise InputError(f"unused points can be 'drop' or 'keep', not {unused!r}")
    if repair not in ("refuse", "drop"):
        raise InputError(f"repair can be 'refuse' or 'drop', not {repair!r}")
    points = np.require(mesh.points, np.float64, ["C", "W"])
    faults = find_faults(points, mesh.tets, where)
    warnings = list(mesh.report.warnings)
    tets, tet_ids = np.require(mesh.tets, np.int32, ["C", "W"]), mesh.tet_ids
    if faults:
        sentence = describe_faults(faults, tet_ids, where)
        one = sum(map(len, faults.values())) == 1
        if repair == "refuse":
            raise RepairableError(f"{sentence}; convert --repair drop leaves {'it' if one else 'them'} out")
        warnings.append(f"{sentence}; left out")
        sound = np.ones(len(tets), np.bool_)
        sound[np.concatenate(list(faults.values()))] = False
        if not sound.any():
            raise InputError(f"{sentence}; no tetra is left without them")
        tets, tet_ids = tets[sound], tet_ids[sound]

    used = np.zeros(len(points), np.bool_)
    mark_used(tets, used)
    unreferenced = int(len(used) - np.count_nonzero(used))
    with np.errstate(all="ignore"):  # volumes beyond float64 are counted; with the JIT off numpy would warn
        inverted, degenerate = count_signs(points, tets)
    point_ids = mesh.point_ids
    if unreferenced and unused == "drop":
        tets = (np.cumsum(used, dtype=np.int32) - np.int32(1))[tets]
        points, point_ids = points[used], point_ids[used]
    report = replace(
        mesh.report,
        unreferenced=unreferenced,
        dropped={reason: len(rows) for reason, rows in faults.items()},
        inverted=int(inverted),
        degenerate=int(degenerate),
        warnings=warnings,
    )
    return TetraMesh(points, tets, point_ids, tet_ids, report)


def find_faults(points: Points, tets: NDArray[np.integer], where: Callable[[str, int], str]) -> dict[str, Rows]:
    """Find the tetras that no net may hold.

    Args:
        points: (n, 3) float64.
        tets: (m, 4) of any integer type.
        where: see `settle`.

    Returns:
        Reason -> rows, ascending, for those of REASONS that apply.

    Raises:
        InputError: a coordinate is NaN or infinite, or a vertex out of range: nobody can mend that.
    """
    finite = np.isfinite(points)
    if not finite.all():
        row = int(np.argmin(finite.all(axis=1)))
        raise InputError(f"{where('point', row)} has a coordinate that is NaN or infinite")
    # Numbers that int32 cannot hold must not wrap around into range.
    small = tets if tets.dtype == np.int32 else np.clip(tets, -1, len(points))
    held = np.require(small, np.int32, ["C", "W"])
    if not is_suspect(held, len(points)):
        return {}
    outside = ((held < 0) | (held >= len(points))).any(axis=1)
    if outside.any():
        row = int(np.argmax(outside))
        vertices = "{} {} {} {}".format(*tets[row])
        last = len(points) - 1
        raise InputError(f"{where('tetra', row)} has the vertices {vertices}, but the indices run from 0 to {last}")
    faults = {}
    rows = np.arange(len(held))
    for reason, find in zip(REASONS, (find_repeating, find_duplicates, crowded_tetras), strict=True):
        found = find(held[rows])
        if len(found):
            faults[reason] = rows[found]
            rows = np.delete(rows, found)
    return faults


def describe_faults(faults: dict[str, Rows], tet_ids: Rows, where: Callable[[str, int], str]) -> str:
    """Say in one line which tetra is the first of its kind, and which are others."""
    first, *others = faults.items()
    reason, rows = first
    sentence = f"{where('tetra', int(rows[0]))} {REASONS[reason]}"
    if len(rows) > 1:
        named = [str(tet_ids[row]) for row in rows[1:NAMED]]
        rest = len(rows) - 1 - len(named)
        if rest:
            named.append(f"{rest:,} other{'s' if rest > 1 else ''}")
        listed = " and ".join([", ".join(named[:-1]), named[-1]] if len(named) > 1 else named)
        sentence += f"; so do{'es' if len(rows) == 2 else ''} {listed}"
    also = ", ".join(f"{len(rows):,} {reason}" for reason, rows in others)
    return f"{sentence}; also: {also}" if also else sentence


def find_repeating(tets: Tets) -> Rows:
    """Rows of the (m, 4) tetras that repeat a vertex."""
    ordered = np.sort(tets, axis=1)
    return np.flatnonzero((ordered[:, 1:] == ordered[:, :-1]).any(axis=1))


def find_duplicates(tets: Tets) -> Rows:
    """Rows, ascending, of the (m, 4) tetras with the vertices of an earlier one."""
    ordered = np.sort(tets, axis=1)
    order = np.lexsort(ordered.T)  # stable: equal tetras keep their order
    ordered = ordered[order]
    return np.sort(order[1:][(ordered[1:] == ordered[:-1]).all(axis=1)])


def is_suspect(tets: Tets, points: int) -> bool:
    """Whether there may be a tetra that is out of range, repeats a vertex, repeats another tetra, or is the
    third at a side. True says that it has to be looked for; False is certain.

    Two equal sides have the same smallest vertex. So each tetra puts a hash of its other vertices into the bucket
    of its smallest one: one for each of its sides there, and one for itself; its fourth side has the second
    smallest. In a bucket a side may occur twice, a tetra once. Half the time of matching the sides.

    Args:
        tets: (m, 4) int32, C-contiguous.
        points: the number of points.
    """
    # allocated here, not in a kernel: numpy asks the system for large pages, numba does not
    starts, hashes = np.zeros(points + 2, np.int64), np.empty(5 * len(tets), np.int32)
    return not distribute_hashes(tets, starts, hashes) or bool(has_crowd(hashes, starts))


@kernel(allocates=False)
def distribute_hashes(tets: Tets, starts: Rows, hashes: NDArray[np.int32]) -> bool:
    """Put hashes of tetras and sides into buckets by their smallest vertex v, hashes[starts[v]:starts[v + 1]].

    Args:
        tets: (m, 4) int32, C-contiguous.
        starts: out, (points + 2,) int64, zeros.
        hashes: out, (5 m,) int32; that of a tetra is odd, that of a side even.

    Returns:
        False where a tetra is out of range or repeats a vertex.
    """
    points = starts.size - 2
    fine = True
    for t in range(tets.shape[0]):
        a, b, c, d = ordered_vertices(tets, t)
        fine = fine and a >= 0 and d < points and a != b and b != c and c != d
        if not fine:
            break
        starts[a + 2] += 4
        starts[b + 2] += 1
    for v in range(points):
        starts[v + 2] += starts[v + 1]
    for t in range(tets.shape[0] if fine else 0):
        a, b, c, d = ordered_vertices(tets, t)
        place = starts[a + 1]
        starts[a + 1] = place + 4
        hashes[place] = hash_of(b, c) & ~1
        hashes[place + 1] = hash_of(b, d) & ~1
        hashes[place + 2] = hash_of(c, d) & ~1
        hashes[place + 3] = hash_of(hash_of(b, c), d) | 1
        place = starts[b + 1]
        starts[b + 1] = place + 1
        hashes[place] = hash_of(c, d) & ~1
    return fine


@kernel
def has_crowd(hashes: NDArray[np.int32], starts: Rows) -> bool:
    """Whether in one of the buckets of `distribute_hashes` equal hashes count more than 2: an even one for 1, an
    odd one for 2."""
    counters = np.zeros(PLACES, np.uint8)
    for v in range(starts.size - 2):
        most = 0
        for j in range(starts[v], starts[v + 1]):
            place = hashes[j] >> 1 & (PLACES - 1)
            counters[place] = min(3, counters[place] + 1 + (hashes[j] & 1))
            most = max(most, int(counters[place]))
        for j in range(starts[v], starts[v + 1]):
            counters[hashes[j] >> 1 & (PLACES - 1)] = 0
        if most > 2:  # once in a hundred buckets: unlike hashes in one place
            bucket = np.sort(hashes[starts[v] : starts[v + 1]])
            count = 0
            for j in range(bucket.size):
                if j > 0 and bucket[j] != bucket[j - 1]:
                    count = 0
                count += 1 + int(bucket[j] & 1)
                if count > 2:
                    return True
    return False


@kernel(allocates=False, inline=True)
def ordered_vertices(tets: Tets, t: int) -> tuple[int, int, int, int]:
    """The vertices of tetra `t` in ascending order."""
    low, high = min(tets[t, 0], tets[t, 1]), max(tets[t, 0], tets[t, 1])
    lower, higher = min(tets[t, 2], tets[t, 3]), max(tets[t, 2], tets[t, 3])
    one, other = max(low, lower), min(high, higher)
    return int(min(low, lower)), int(min(one, other)), int(max(one, other)), int(max(high, higher))


@kernel(allocates=False, inline=True)
def hash_of(one: int, other: int) -> int:
    """Hash two numbers of 31 bits to one (31 bits times 32 bits stay below 2^63)."""
    return ((one * MULTIPLIER >> 16 & 0x7FFFFFFF ^ other) * MULTIPLIER) >> 16 & 0x7FFFFFFF


@kernel(allocates=False)
def mark_used(tets: Tets, used: NDArray[np.bool_]) -> None:
    """Set `used` at each vertex of the (m, 4) tetras."""
    for t in range(tets.shape[0]):
        for i in range(4):
            used[tets[t, i]] = True
