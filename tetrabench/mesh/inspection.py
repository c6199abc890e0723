"""inspect_mesh: what a person wants to know about a mesh before working with it."""

from dataclasses import dataclass
from itertools import combinations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from tetrabench.errors import InputError
from tetrabench.mesh.bandwidth import Bandwidth, Pairs, measure_both
from tetrabench.mesh.quality import dihedral_angles, radius_ratios, signed_volumes
from tetrabench.mesh.sides import side_neighbours
from tetrabench.mesh.tetra_mesh import TetraMesh

Integers = NDArray[np.int64]

SIDES = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])  # side i lies opposite vertex i
EDGES = np.array([[1, 2], [0, 2], [0, 1]])  # edge j of a side lies opposite its vertex j


WORST = 5
"""So many of the worst cells are named."""
QUANTILES = {"worst": 0.0, "1 %": 0.01, "10 %": 0.1, "median": 0.5, "best": 1.0}


@dataclass(frozen=True)
class TetraQuality:
    """How well shaped the tetras are.

    Attributes:
        radius_ratio: 3 times the inscribed radius over the circumscribed one (`quality.radius_ratios`), 1 for a regular tetra,
            0 for a flat one: quantiles over the tetras; "10 %" is what a tenth of them do not exceed.
        smallest_dihedral_angle: between two sides of any one tetra, in degrees; None where all are degenerate.
        largest_dihedral_angle: likewise.
        worst_tetras: ids of those with the lowest radius ratio, the worst first.
    """

    radius_ratio: dict[str, float]
    smallest_dihedral_angle: float | None
    largest_dihedral_angle: float | None
    worst_tetras: tuple[int, ...]


@dataclass(frozen=True)
class Numbering:
    """How far apart neighbours lie in memory.

    Attributes:
        distances: of tetras through sides; of points through edges, an edge counted once for each tetra around it; and of
            both along a Hilbert curve (`mesh.bandwidth`).
        advice: what another order would give, a sentence; "" where that is little.
    """

    distances: dict[str, Bandwidth]
    advice: str


@dataclass(frozen=True)
class Inspection:
    """What there is to say about a mesh. These are also the keys of `tetrabench info --format json`.

    Everything but `points`, and what the reader counted (from `dropped` on), is about the points that tetras use. A
    place is where a point is: coincident points, which have the same coordinates bit by bit (0 and -0 are the same),
    share one.

    Attributes:
        source: path of the file, or the words that describe a generated model.
        format: name of the file's format, "" for a generated model.
        included: paths of other files that were read because the file includes them.
        points: points, those that no tetra uses included.
        tetras: tetras.
        components: parts of tetras that are joined through sides.
        surface_sides: sides with a tetra on one side alone.
        lowest: x, y and z of the bounding box's lowest corner, in the file's unit of length.
        highest: x, y and z of its highest corner.
        volume: sum of the tetras' volumes, each taken as positive, in the cube of that unit.
        inverted: tetras whose vertex order gives a negative volume.
        degenerate: tetras whose volume is zero to rounding.
        nonmanifold_edges: edges where more than two surface sides meet.
        nonmanifold_vertices: points at which the surface is more than one fan of sides, as where two parts touch in
            a point or along an edge.
        coincident_points: points that share their place with another.
        doubled_sides: surface sides in one place with another one: parts that touch there, and are not joined.
        crossing_sides: surface sides that cut the same four places along the other diagonal than two sides across
            from them: they do not match. (Sides of different sizes on each other are not found.)
        unreferenced: points that no tetra uses.
        quadratic: tetras with midside nodes, of which the corners alone are used.
        values: names of the numbers that the file holds for its points and cells; they are no part of the mesh.
        dropped: tetras left out because no net can hold them, reason -> count.
        skipped: cards or cells of the file that are no part of the mesh, name -> count.
        warnings: sentences of the reader.
        quality: how well shaped the tetras are, see `TetraQuality`.
        numbering: how far apart neighbours lie in memory, see `Numbering`.
        refusal: why the file is refused unless its faulty tetras are left out; "" where it is not. All the rest is
            about the mesh without them.
    """

    source: str
    format: str
    included: list[str]
    points: int
    tetras: int
    components: int
    surface_sides: int
    lowest: tuple[float, float, float]
    highest: tuple[float, float, float]
    volume: float
    inverted: int
    degenerate: int
    nonmanifold_edges: int
    nonmanifold_vertices: int
    coincident_points: int
    doubled_sides: int
    crossing_sides: int
    unreferenced: int
    quadratic: int
    values: list[str]
    dropped: dict[str, int]
    skipped: dict[str, int]
    warnings: list[str]
    quality: TetraQuality
    numbering: Numbering
    refusal: str = ""


def inspect_mesh(mesh: TetraMesh) -> Inspection:
    """Inspect a mesh that has passed `check_mesh` or `settle`, read with unused="keep" for the file's own count of points.

    Raises:
        InputError: no tetra at all, or a side is shared by more than two.
    """
    if not len(mesh.tets):
        raise InputError(f"{mesh.report.source or 'mesh'}: holds no tetras, so that there is nothing to inspect")
    points, tets = np.require(mesh.points, np.float64, ["C", "W"]), np.require(mesh.tets, np.int32, ["C", "W"])
    neighbours = side_neighbours(tets)
    used = np.zeros(len(points), np.bool_)
    used[tets.ravel()] = True
    corners = points[used]
    places = find_places(points, used)
    alone = neighbours < 0
    tetra, opposite = np.nonzero(alone)
    surface = np.sort(tets[tetra[:, None], SIDES[opposite]], axis=1).astype(np.int64)
    isolated = np.sort(places[tets[alone.all(axis=1)]], axis=1)
    doubled, crossing = compare_places(np.sort(places[surface], axis=1), isolated)
    edges, vertices = count_nonmanifold(surface)
    with np.errstate(all="ignore"):  # a volume may be beyond float64
        quality = judge_shapes(points, tets, mesh.tet_ids)
        volume = float(np.abs(signed_volumes(points, tets)).sum())
    low, high = corners.min(axis=0).tolist(), corners.max(axis=0).tolist()
    report = mesh.report
    return Inspection(
        source=report.source,
        format=report.format,
        included=report.included,
        points=len(points),
        tetras=len(tets),
        components=count_components(neighbours),
        surface_sides=len(surface),
        lowest=(low[0], low[1], low[2]),
        highest=(high[0], high[1], high[2]),
        volume=volume,
        inverted=report.inverted,
        degenerate=report.degenerate,
        nonmanifold_edges=edges,
        nonmanifold_vertices=vertices,
        coincident_points=int((np.bincount(places[used])[places[used]] > 1).sum()),
        doubled_sides=doubled,
        crossing_sides=crossing,
        unreferenced=report.unreferenced,
        quadratic=report.quadratic,
        values=report.values,
        dropped=report.dropped,
        skipped=report.skipped,
        warnings=report.warnings,
        quality=quality,
        numbering=judge_numbering(points, tets, neighbours),
    )


def judge_shapes(points: NDArray[np.float64], tets: NDArray[np.int32], ids: Integers) -> TetraQuality:
    """Judge the shapes of tetras, C-contiguous arrays; `ids` (m,)."""
    ratios = radius_ratios(points, tets)
    smallest, largest = dihedral_angles(points, tets)
    return TetraQuality(
        radius_ratio=quantiles(ratios),
        smallest_dihedral_angle=None if np.isnan(smallest) else smallest,
        largest_dihedral_angle=None if np.isnan(largest) else largest,
        worst_tetras=tuple(ids[find_worst(ratios)].tolist()),
    )


def quantiles(values: NDArray[np.float64]) -> dict[str, float]:
    """QUANTILES of values, (n,), n > 0."""
    found = np.quantile(values, [*QUANTILES.values()], method="lower")
    return dict(zip(QUANTILES, found.tolist(), strict=True))


def find_worst(values: NDArray[np.float64]) -> Integers:
    """Rows of the WORST lowest values, ascending; of equal ones the first."""
    if len(values) > WORST:
        bound = np.partition(values, WORST - 1)[WORST - 1]
        rows = np.flatnonzero(values <= bound)
    else:
        rows = np.arange(len(values))
    return rows[np.argsort(values[rows], kind="stable")][:WORST]


def judge_numbering(points: NDArray[np.float64], tets: NDArray[np.int32], neighbours: NDArray[np.int32]) -> Numbering:
    """Judge the numbering of tetras and of their points: `neighbours` as `side_neighbours` gives them."""

    def through_sides() -> Pairs:
        rows = np.arange(len(tets), dtype=np.int32)
        for others in neighbours.T:
            yield rows[others > rows], others[others > rows]

    def through_edges() -> Pairs:
        return ((tets[:, one], tets[:, other]) for one, other in combinations(range(4), 2))

    with np.errstate(all="ignore"):  # as above, and points that no tetra uses
        of_tetras, advice = measure_both("tetras", points[tets].mean(axis=1), through_sides)
        of_points, _ = measure_both("points", points, through_edges)
    return Numbering(of_tetras | of_points, advice)


def count_components(neighbours: NDArray[np.int32]) -> int:
    """Count the parts that are joined through sides: `neighbours` as `side_neighbours` gives them."""
    rows, sides = np.nonzero(neighbours > np.arange(len(neighbours))[:, None])
    return _components(len(neighbours), rows, neighbours[rows, sides])[0]


def find_places(points: NDArray[np.float64], used: NDArray[np.bool_]) -> Integers:
    """Number the places of the used points: (n,) int64, equal where their coordinates are, -1 for the others."""
    rows = np.flatnonzero(used)
    coordinates = points[rows] + 0.0  # -0 becomes 0
    order = np.lexsort(coordinates.T)
    places = np.full(len(points), -1)
    places[rows[order]] = np.cumsum(_is_new(coordinates[order])) - 1
    return places


def count_nonmanifold(surface: Integers) -> tuple[int, int]:
    """Count the edges and the vertices where a surface is none.

    Args:
        surface: (k, 3) vertices of its sides.

    Returns:
        Edges at which more than two sides meet; vertices whose sides are more than one fan, a fan being sides
        joined through edges where two meet.
    """
    if not len(surface):
        return 0, 0
    ends = surface[:, EDGES]  # (k, 3, 2)
    order, starts = _groups(ends.reshape(-1, 2))
    sizes = np.diff(starts)
    # In each pair of edges, the corner of one side at either end is joined to the other side's corner there.
    corners = (3 * np.arange(len(surface))[:, None, None] + EDGES).reshape(-1, 2)
    one, other = (corners[order[starts[:-1][sizes == 2] + k]] for k in (0, 1))
    _, fans = _components(surface.size, one.ravel(), other.ravel())
    _, first = np.unique(fans, return_index=True)
    _, counts = np.unique(surface.ravel()[first], return_counts=True)
    return int((sizes > 2).sum()), int((counts > 1).sum())


def compare_places(surface: Integers, isolated: Integers) -> tuple[int, int]:
    """Count the surface sides that lie on others without being joined to them.

    Args:
        surface: (k, 3) places of the corners, ascending in each row.
        isolated: (j, 4) places of the tetras that have no neighbour, ascending in each row.

    Returns:
        Sides in one place with another; sides that cut a quadrilateral of places across the diagonal of two others.
    """
    order, starts = _groups(surface)
    sizes = np.diff(starts)
    doubled = int(sizes[sizes > 1].sum())
    single = surface[order[starts[:-1][sizes == 1]]]

    # Two sides at an edge: (ends of the edge, its two opposite places). Sides across from them, if any, have the same
    # four places with the two pairs exchanged.
    ends, tips = single[:, EDGES].reshape(-1, 2), single.ravel()
    order, starts = _groups(ends)
    pairs = starts[:-1][np.diff(starts) == 2]
    quads = np.column_stack([ends[order[pairs]], np.sort(np.column_stack([tips[order[pairs + k]] for k in (0, 1)]))])
    swap = (quads[:, 0] > quads[:, 2]) | ((quads[:, 0] == quads[:, 2]) & (quads[:, 1] > quads[:, 3]))
    quads[swap] = quads[swap][:, [2, 3, 0, 1]]
    order, starts = _groups(quads)
    crossed = _distinct(np.sort(quads[order[starts[:-1][np.diff(starts) == 2]]], axis=1))
    # A tetra without neighbours has such sides too: its own.
    own = len(crossed) + len(_distinct(isolated)) - len(_distinct(np.concatenate([crossed, isolated])))
    return doubled, 4 * (len(crossed) - own)


def _components(nodes: int, rows: NDArray[np.integer], others: NDArray[np.integer]) -> tuple[int, Integers]:
    """How many components a graph has, and which each node belongs to."""
    graph = coo_array((np.ones(len(rows), np.bool_), (rows, others)), shape=(nodes, nodes))
    count, labels = connected_components(graph, directed=False)
    return int(count), labels


def _groups(rows: Integers) -> tuple[Integers, Integers]:
    """Order that brings equal rows together, and where each group of them starts; at the end, the number of rows."""
    order = np.lexsort(rows.T)
    return order, np.append(np.flatnonzero(_is_new(rows[order])), len(rows))


def _distinct(rows: Integers) -> Integers:
    """The rows without repetitions."""
    order, starts = _groups(rows)
    return rows[order[starts[:-1]]]


def _is_new(rows: NDArray[np.generic]) -> NDArray[np.bool_]:
    """Where a row differs from the one before it."""
    new = np.ones(len(rows), np.bool_)
    new[1:] = (rows[1:] != rows[:-1]).any(axis=1)
    return new
