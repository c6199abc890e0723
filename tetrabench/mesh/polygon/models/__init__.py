"""Models of polygons: the unit square divided into about any number of cells, the same bits for the same seed.

Boundary conditions tell its sides apart: -1 at the bottom, -2 on the right, -3 at the top, -4 on the left.
"""

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError, find_named
from tetrabench.memory import refuse_if_too_large
from tetrabench.mesh.numbering import check_seed
from tetrabench.mesh.polygon.models.hexagon import HEXAGON
from tetrabench.mesh.polygon.models.model import SIDES, Division, PolygonModel
from tetrabench.mesh.polygon.models.quad import QUAD
from tetrabench.mesh.polygon.models.triangle import TRIANGLE
from tetrabench.mesh.polygon.models.voronoi import VORONOI
from tetrabench.mesh.polygon.numbering import NUMBERINGS, next_nodes, renumber_polygons
from tetrabench.mesh.polygon.polygon_mesh import PolygonMesh, PolygonReport
from tetrabench.traces import named

MODELS = {model.name: model for model in (TRIANGLE, QUAD, HEXAGON, VORONOI)}

MOST_CELLS = (2**31 - 1) // 6
"""Up to here the places in a cell list, on average less than six a cell, have room in 32 bits."""


def add_model(model: PolygonModel) -> None:
    """Take in a model of others, under its name, in the place of one of that name.

    Raises:
        InputError: it is no PolygonModel.
    """
    if not isinstance(model, PolygonModel):
        raise InputError(f"a {type(model).__name__}, not a {PolygonModel.__module__}.PolygonModel")
    MODELS[model.name] = model


def generate_polygons(
    name: str | PolygonModel, cells: int | None = None, *, numbering: str = "natural", seed: int = 0
) -> PolygonMesh:
    """Make a model: the unit square, its cells counter-clockwise, with no point twice and none between two others.

    Args:
        name: one of MODELS; or a `PolygonModel` of your own.
        cells: the number of cells wanted (the model's default, the source's, where None). The model takes the nearest it
            can divide into; what it holds stands in `report.source`.
        numbering: one of NUMBERINGS; "natural" is row by row, for "voronoi" at random already.
        seed: of the centres of "voronoi", and of the shuffling, 0 or more.

    Raises:
        InputError: an unknown model or numbering, fewer than one cell wanted, more than MOST_CELLS, a seed below 0, or
            one that draws two centres of "voronoi" too near each other.
        MemoryRefusedError: more cells wanted than there is memory for.
    """
    model: PolygonModel = name if isinstance(name, PolygonModel) else find_named("model", MODELS, name)
    find_named("numbering", NUMBERINGS, numbering)  # before the work, not after it
    check_seed(seed)
    wanted = model.cells if cells is None else cells
    if not 1 <= wanted <= MOST_CELLS:
        raise InputError(f"a model of {wanted:,} cells cannot be made; ask for 1 to {MOST_CELLS:,}")
    refuse_if_too_large(f"a model of {wanted:,} cells", wanted * model.bytes)
    with named(f"the model {model.name}"):
        division = model.build(wanted, seed)
        conditions = side_conditions(division)
    counts = len(division.starts) - 1, (len(conditions) + np.count_nonzero(conditions)) // 2, len(division.points)
    source = "{}: {} cells, {} edges, {} nodes, {}".format(model.name, *counts, division.words)
    mesh = PolygonMesh(division.points, division.starts, division.nodes, conditions, PolygonReport(source=source))
    return renumber_polygons(mesh, numbering, seed)


def side_conditions(division: Division) -> NDArray[np.int32]:
    """The boundary condition of each corner's side: (s,) int32, by the side of the square that it lies on, or 0."""
    conditions = np.zeros(len(division.nodes), np.int32)
    following = next_nodes(division.starts, division.nodes)
    for number, (axis, place) in enumerate(SIDES, 1):
        there = division.points[:, axis] == place
        conditions[there[division.nodes] & there[following]] = -number
    return conditions
