"""What no format of polygon meshes may hold: found, refused or mended where a mesh is read, and the cells turned alike."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetrabench.errors import InputError, RepairableError
from tetrabench.jit import kernel
from tetrabench.mesh.polygon.connect import NOBODY, Connections, after, sort_corners, turn
from tetrabench.mesh.polygon.numbering import next_nodes
from tetrabench.mesh.polygon.polygon_mesh import CONDITION, PolygonMesh, PolygonReport

Points = NDArray[np.float64]
Rows = NDArray[np.int32]
Places = NDArray[np.int64]
Marks = NDArray[np.bool_]

MOST = 2**31 - 1  # corners, and nodes
NAMED = 3  # faulty cells or nodes that a message names
SHOWN = 8  # nodes of a cell that a message lists
NOT_YET = -1  # the part of a cell, or the fan of a corner, that has not been looked at


class Cells(NamedTuple):
    """Cells while they are mended.

    Attributes:
        starts, nodes, conditions: as in PolygonMesh, but with conditions on all sides or none.
        numbers: (m,) int64, which cells of the input they are.
    """

    starts: Rows
    nodes: Rows
    conditions: Rows
    numbers: Places

    def without(self, faulty: Places) -> "Cells":
        """The others."""
        sound = np.ones(len(self.numbers), np.bool_)
        sound[faulty] = False
        sizes = np.diff(self.starts)
        held = np.repeat(sound, sizes)
        starts = np.append(0, np.cumsum(sizes[sound])).astype(np.int32)
        return Cells(starts, self.nodes[held], self.conditions[held], self.numbers[sound])

    def name(self, c: int) -> str:
        """A cell, as messages call it."""
        nodes = self.nodes[self.starts[c] : self.starts[c + 1]]
        listed = " ".join(map(str, nodes[:SHOWN])) + (" ..." if len(nodes) > SHOWN else "")
        return f"cell {self.numbers[c]} ({listed})"


class Faults:
    """Raises where there are faults, or keeps what there is to say about them.

    Attributes:
        name: of the mesh.
        repair: see `settle`.
        sentences: about the faults that are mended.
    """

    def __init__(self, name: str, repair: str) -> None:
        self.name, self.repair = name, repair
        self.sentences: list[str] = []

    def add(self, first: str, others: NDArray[np.integer], mended: str, mends: str) -> None:
        """Say what is wrong with the first of some cells or nodes, and the numbers of the others."""
        named = [str(number) for number in others[: NAMED - 1]]
        if len(others) > len(named):
            named.append(f"{len(others) - len(named):,} more")
        sentence = f"{self.name}: {first}"
        if named:
            sentence += "; likewise " + " and ".join(filter(None, [", ".join(named[:-1]), named[-1]]))
        sentence += " (counted from 0)"
        if self.repair == "refuse":
            raise RepairableError(
                f"{sentence}; tetrabench convert --repair drop {mends.format('them' if named else 'it')}"
            )
        self.sentences.append(f"{sentence}; {mended}")


def settle(
    points: ArrayLike,
    starts: ArrayLike,
    nodes: ArrayLike,
    conditions: ArrayLike | None = None,
    report: PolygonReport | None = None,
    repair: str = "refuse",
) -> PolygonMesh:
    """Make a mesh that every format can hold from all that a file holds: the last step of every reader.

    The order of points and cells stays, and so does the node that each cell begins with. Cells that share a side are
    turned to pass it in opposite directions, whatever `repair` says. A part of the mesh that is joined through sides is
    then turned as a whole: in the plane (two coordinates, or the same z everywhere) so that its area is positive; on a
    surface so that most of its cells stay as they are, the first one where that is half of them.

    Args:
        points: (n, 2) or (n, 3) numbers; two coordinates are kept where z is 0 everywhere.
        starts: (m + 1,) integers: cell c has the nodes from starts[c] up to, not with, starts[c + 1], in either direction.
        nodes: (starts[m],) integers, indices into `points`.
        conditions: (starts[m],) integers, of the side from each node of a cell to the next: a negative number is kept
            where the boundary is, and CONDITION is taken where there is none; None gives CONDITION to all.
        report: what the reader knows already.
        repair: "refuse" raises where there are faults; "drop" mends them: cells with fewer than three nodes, or with a
            node twice, are left out, then at each side all but its first two cells; a node in which parts of the mesh
            touch that no sides around it join is split, and the part of the earliest cell keeps it; nodes of no cell are
            left out.

    Raises:
        RepairableError: there are faults that repair="drop" mends; names the first ones of a kind, by their indices.
        InputError: arrays that do not belong together, a coordinate that is NaN or infinite, no cell (left), and a part
            of the mesh whose cells cannot be turned alike, such as a Moebius strip: no format can hold one, and where to
            cut it is for its author to say.
    """
    if repair not in ("refuse", "drop"):
        raise InputError(f"repair can be 'refuse' or 'drop', not {repair!r}")
    report = replace(report or PolygonReport())
    faults = Faults(report.source or "mesh", repair)
    place, cells = check_arrays(faults.name, points, starts, nodes, conditions)
    cells, links, mates, report.dropped = leave_out_cells(cells, len(place), faults)
    turned, areas = choose_turned(faults.name, place, links, mates, cells)
    report.turned = int(turned.sum())
    cells, twin = turn_over(cells, mates, turned)
    place, cells, report.split = split_nodes(place, cells, twin, faults)
    place, cells, report.unreferenced = leave_out_nodes(place, cells, report.unreferenced, faults)
    folded = np.flatnonzero(~(areas > 0))
    if len(folded):
        words = f"{len(folded):,} cell{'s' * (len(folded) > 1)} without a positive area, though turned as the neighbours are"
        means = "the mesh is folded there, or a cell lies over others or is there twice"
        faults.sentences.append(f"{faults.name}: {words}; the first is cell {cells.numbers[folded[0]]}: {means}")
    report.warnings = [*report.warnings, *faults.sentences]
    given = np.where(cells.conditions < 0, cells.conditions, CONDITION)
    return PolygonMesh(
        points=np.ascontiguousarray(place[:, :2] if place.shape[1] == 3 and not place[:, 2].any() else place),
        starts=cells.starts,
        nodes=cells.nodes,
        conditions=np.where(twin == NOBODY, given, 0).astype(np.int32),
        report=report,
    )


def check_arrays(
    name: str, points: ArrayLike, starts: ArrayLike, nodes: ArrayLike, conditions: ArrayLike | None
) -> tuple[Points, Cells]:
    """The arrays as `settle` works on them: (n, 2 or 3) float64, and int32, contiguous and writable.

    Raises:
        InputError: what nobody can mend.
    """
    place = np.asarray(points)
    if place.ndim != 2 or place.shape[1] not in (2, 3) or place.dtype.kind not in "fiu":
        raise InputError(f"{name}: points must be numbers of shape (n, 2) or (n, 3), not {place.dtype} {place.shape}")
    bounds, corners = np.asarray(starts), np.asarray(nodes)
    given = np.zeros(len(corners), np.int32) if conditions is None else np.asarray(conditions)
    for word, array in (("starts", bounds), ("nodes", corners), ("conditions", given)):
        if array.ndim != 1 or (array.dtype.kind not in "iu" and len(array)):
            raise InputError(f"{name}: {word} must be integers in one row, not {array.dtype} {array.shape}")
    if len(bounds) < 2 or not len(corners):
        raise InputError(f"{name}: holds no cells")
    if max(len(corners), len(place)) > MOST:
        raise InputError(f"{name}: has more than {MOST:,} nodes of cells; there is room for no more")
    if bounds[0] != 0 or bounds[-1] != len(corners) or (np.diff(bounds.astype(np.int64)) < 0).any():
        raise InputError(f"{name}: starts must begin with 0, never fall and end with the number of nodes of all cells")
    if len(given) != len(corners):
        raise InputError(f"{name}: there are {len(given):,} conditions for {len(corners):,} nodes of cells")
    finite = np.isfinite(place).all(axis=1)
    if not finite.all():
        raise InputError(f"{name}: node {np.argmin(finite)} has a coordinate that is NaN or infinite")
    outside = (corners < 0) | (corners >= len(place))
    if outside.any():
        corner = int(np.argmax(outside))
        c = int(np.searchsorted(bounds, corner, "right")) - 1
        raise InputError(f"{name}: cell {c} names node {corners[corner]}, but nodes run from 0 to {len(place) - 1}")
    bounds, corners, given = (np.require(array, np.int32, ["C", "W"]) for array in (bounds, corners, given))
    return np.require(place, np.float64, ["C", "W"]), Cells(bounds, corners, given, np.arange(len(bounds) - 1))


def leave_out_cells(cells: Cells, points: int, faults: Faults) -> tuple[Cells, Connections, Rows, dict[str, int]]:
    """The cells that are sound each by itself, and at most two at a side.

    Returns:
        The cells; their corners as `sorted_corners` and the mates as `find_mates` give them; how many cells were left out,
        by the reason.
    """
    dropped = {}

    def leave_out(reason: str, faulty: Places, words: str) -> Cells:
        if not len(faulty):
            return cells
        first = f"{cells.name(int(faulty[0]))} {words}"
        faults.add(first, cells.numbers[faulty[1:]], "left out", "leaves {} out")
        dropped[reason] = len(faulty)
        if len(faulty) == len(cells.numbers):
            raise InputError(f"{faults.sentences[-1]}; no cell is left")
        return cells.without(faulty)

    cells = leave_out("fewer than three nodes", np.flatnonzero(np.diff(cells.starts) < 3), "has fewer than three nodes")
    repeating = np.zeros(len(cells.numbers), np.bool_)
    mark_repeating(cells.starts, cells.nodes, np.full(points, NOBODY, np.int32), repeating)
    cells = leave_out("repeated node", np.flatnonzero(repeating), "names a node twice")
    links, mates, crowded = find_mates(cells, points)
    if crowded.any():
        x = int(np.argmax(crowded))
        sides = np.sort(np.column_stack([links.nodes, next_nodes(links.starts, links.nodes)]), axis=1)
        first, second = cells.numbers[links.cell[(sides == sides[x]).all(axis=1)][:2]]
        words = "is one too many at its side {}-{}, ".format(*sides[x]) + f"which cells {first} and {second} share"
        cells = leave_out("crowded side", np.unique(links.cell[crowded]).astype(np.int64), words)
        links, mates, _ = find_mates(cells, points)
    return cells, links, mates, dropped


def sorted_corners(cells: Cells, points: int) -> tuple[Connections, Rows, Rows]:
    """The corners with their cells, and by their nodes: see `connect.sort_corners`. No twins yet, and no first corners."""
    corners = len(cells.nodes)
    alone = np.full(corners, NOBODY, np.int32)
    links = Connections(*cells[:3], alone, np.empty(corners, np.int32), np.empty(0, np.int32))
    begins, around = np.zeros(points + 2, np.int32), np.empty(corners, np.int32)
    sort_corners(links, begins, around)
    return links, begins, around


def find_mates(cells: Cells, points: int) -> tuple[Connections, Rows, Marks]:
    """The corners of `sorted_corners`; for each another one with its side, in either direction, or NOBODY; and whether two
    cells before have that side."""
    links, begins, around = sorted_corners(cells, points)
    mates, crowded = np.full(len(links.nodes), NOBODY, np.int32), np.zeros(len(links.nodes), np.bool_)
    pair_corners(links.nodes, next_nodes(links.starts, links.nodes), begins, around, mates, crowded)
    return links, mates, crowded


def choose_turned(name: str, points: Points, links: Connections, mates: Rows, cells: Cells) -> tuple[Marks, Points]:
    """Which cells are to be turned over, (m,) bool, and in the plane the areas that they have then, (m,) float64; else none.

    Raises:
        InputError: a part of the mesh cannot be turned alike.
    """
    count = len(cells.numbers)
    part, turned = np.full(count, NOT_YET, np.int32), np.zeros(count, np.bool_)
    x = turn_alike(links, mates, part, turned, np.empty(count, np.int32))
    if x != NOBODY:
        ends = f"{links.nodes[x]}-{links.nodes[after(links, x)]}"
        one, other = (cells.name(int(links.cell[y])) for y in (x, mates[x]))
        raise InputError(
            f"{name}: {one} and {other} cannot be turned alike at their side {ends}: a way round through their neighbours "
            "ends with one of them turned over, as on a Moebius strip, which no format can hold; cut the mesh there"
        )
    # Negative where most is the wrong way round: cells by their number, and in the plane by their area.
    votes = np.bincount(part, np.where(turned, -1.0, 1.0))
    first = np.unique(part, return_index=True)[1]
    votes = np.where((votes < 0) | ((votes == 0) & turned[first]), -1.0, 1.0)
    used = np.zeros(len(points), np.bool_)
    used[cells.nodes] = True
    if points.shape[1] == 3 and np.ptp(points[used, 2]) > 0:
        return turned ^ (votes < 0)[part], np.empty(0)
    areas = np.empty(count)
    with np.errstate(all="ignore"):  # with the JIT off numpy would warn of areas beyond float64
        sum_areas(points, links.starts, links.nodes, areas)
        sums = np.bincount(part, np.where(turned, -areas, areas))
    turned ^= (np.where(sums == 0, votes, sums) < 0)[part]
    return turned, np.where(turned, -areas, areas)


def turn_over(cells: Cells, mates: Rows, turned: Marks) -> tuple[Cells, Rows]:
    """The cells, some of them in the other direction from the same first node; and the twin of each corner."""
    sizes = np.diff(cells.starts)
    start, size = np.repeat(cells.starts[:-1], sizes), np.repeat(sizes, sizes)
    over = np.repeat(turned, sizes)
    corner = np.arange(len(cells.nodes), dtype=np.int32)
    # Node j takes the place of node -j, and side j, from node j to the next, that of side -j - 1.
    node = np.where(over, start + (start - corner) % size, corner)
    side = np.where(over, 2 * start + size - 1 - corner, corner).astype(np.int32)
    twin = mates[side]
    twin = np.where(twin == NOBODY, NOBODY, side[twin]).astype(np.int32)
    return cells._replace(nodes=cells.nodes[node], conditions=cells.conditions[side]), twin


def split_nodes(points: Points, cells: Cells, twin: Rows, faults: Faults) -> tuple[Points, Cells, int]:
    """Points and cells with a node for each fan of cells; and how many had several."""
    links, begins, around = sorted_corners(cells, len(points))
    fan = np.full(len(cells.nodes), NOT_YET, np.int32)
    number_fans(links._replace(twin=twin), begins, around, fan)
    corners = np.flatnonzero(fan > 0)
    if not len(corners):
        return points, cells, 0
    old, place = np.unique(np.column_stack([cells.nodes[corners], fan[corners]]), axis=0, return_inverse=True)
    split = np.unique(old[:, 0])
    first = f"node {split[0]} is where parts of the mesh touch that no sides around it join"
    faults.add(first, split[1:], "split", "splits {}")
    nodes = cells.nodes.copy()
    nodes[corners] = len(points) + place.ravel()
    return np.concatenate([points, points[old[:, 0]]]), cells._replace(nodes=nodes), len(split)


def leave_out_nodes(points: Points, cells: Cells, before: int, faults: Faults) -> tuple[Points, Cells, int]:
    """Points and cells without the nodes that are in no cell; and how many these are, with those left out before."""
    used = np.zeros(len(points), np.bool_)
    used[cells.nodes] = True
    unused = np.flatnonzero(~used)
    if not len(unused):
        return points, cells, before
    faults.add(f"node {unused[0]} is in no cell", unused[1:], "left out", "leaves {} out")
    new = np.cumsum(used, dtype=np.int32) - np.int32(1)
    return points[used], cells._replace(nodes=new[cells.nodes]), before + len(unused)


@kernel(allocates=False)
def mark_repeating(starts: Rows, nodes: Rows, seen: Rows, repeating: Marks) -> None:
    """Mark the cells that have a node twice. `seen`: (n,) int32, NOBODY, of the cell that had each node last."""
    for c in range(len(starts) - 1):
        for x in range(starts[c], starts[c + 1]):
            v = nodes[x]
            if seen[v] == c:
                repeating[c] = True
            seen[v] = c


@kernel(allocates=False)
def sum_areas(points: Points, starts: Rows, nodes: Rows, areas: Points) -> None:
    """The area of each cell, from x and y alone, into `areas`: positive where these run counter-clockwise. Triangles are
    added up that its first node has with its other sides."""
    for c in range(len(areas)):
        begin, end = np.int64(starts[np.uint64(c)]), np.int64(starts[np.uint64(c + 1)])
        v = np.uint64(nodes[np.uint64(begin)])
        x, y, area = points[v, 0], points[v, 1], 0.0
        v = np.uint64(nodes[np.uint64(begin + 1)])
        u, w = points[v, 0] - x, points[v, 1] - y
        for corner in range(begin + 2, end):
            v = np.uint64(nodes[np.uint64(corner)])
            p, q = points[v, 0] - x, points[v, 1] - y
            area += (u * q - w * p) / 2
            u, w = p, q
        areas[np.uint64(c)] = area


@kernel(allocates=False)
def pair_corners(nodes: Rows, ahead: Rows, begins: Rows, around: Rows, mates: Rows, crowded: Marks) -> None:
    """See `find_mates`; `ahead` has the next node of each corner. A side has its other corners at its one end where they
    pass it in the same direction, else at the other."""
    for x in range(len(nodes)):
        a, b, earlier = nodes[np.uint64(x)], ahead[np.uint64(x)], 0
        for place in range(begins[np.uint64(a)], begins[np.uint64(a + 1)]):
            y = np.int64(around[np.uint64(place)])
            if y != x and ahead[np.uint64(y)] == b:
                mates[np.uint64(x)] = y
                if y < x:
                    earlier += 1
        for place in range(begins[np.uint64(b)], begins[np.uint64(b + 1)]):
            y = np.int64(around[np.uint64(place)])
            if ahead[np.uint64(y)] == a:
                mates[np.uint64(x)] = y
                if y < x:
                    earlier += 1
        crowded[np.uint64(x)] = earlier > 1


@kernel(allocates=False)
def turn_alike(links: Connections, mates: Rows, part: Rows, turned: Marks, queue: Rows) -> int:
    """Number the parts of the mesh that are joined through sides, and mark cells so that turning them over makes those
    of a part pass each side in opposite directions: breadth first from the first cell of each.

    Args:
        links, mates: at most two cells at a side.
        part: out, (m,) int32, NOT_YET.
        turned: out, (m,) bool, False.
        queue: (m,) int32.

    Returns:
        A corner at whose side that cannot be; NOBODY where it can.
    """
    parts = 0
    for first in range(len(part)):
        if part[first] != NOT_YET:
            continue
        part[first], queue[0], begin, end = parts, first, 0, 1
        while begin < end:
            c = np.int64(queue[begin])
            begin += 1
            for x in range(links.starts[c], links.starts[c + 1]):
                y = np.int64(mates[x])
                if y == NOBODY:
                    continue
                other = np.int64(links.cell[y])
                over = turned[c] != (links.nodes[x] == links.nodes[y])
                if part[other] == NOT_YET:
                    part[other], turned[other], queue[end] = parts, over, other
                    end += 1
                elif turned[other] != over:
                    return x
        parts += 1
    return NOBODY


@kernel(allocates=False)
def number_fans(links: Connections, begins: Rows, around: Rows, fan: Rows) -> None:
    """Number the fans of corners around each node from 0, in the order of their earliest cells, into `fan` (s,) int32,
    NOT_YET."""
    for v in range(len(begins) - 2):
        fans = 0
        for place in range(begins[v], begins[v + 1]):
            first = np.int64(around[place])
            if fan[first] != NOT_YET:
                continue
            x = first
            while x != NOBODY and fan[x] == NOT_YET:
                fan[x] = fans
                x = turn(links, x)
            x = np.int64(links.twin[first])
            while x != NOBODY and fan[after(links, x)] == NOT_YET:  # the other way round: `turn` backwards
                x = np.int64(after(links, x))
                fan[x] = fans
                x = np.int64(links.twin[x])
            fans += 1
