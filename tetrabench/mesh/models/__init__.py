"""Models: meshes of any size made without a mesher, the same bits for the same seed. Lengths in metres.

Every point off the surface is moved at random by a fraction of the spacing around it, so that no two tetras
are alike.
"""

from dataclasses import replace
from pathlib import Path

import numpy as np

from tetrabench.errors import InputError, find_named
from tetrabench.memory import refuse_if_too_large
from tetrabench.mesh.models.box import BOX
from tetrabench.mesh.models.intake import INTAKE
from tetrabench.mesh.models.model import Model
from tetrabench.mesh.models.nozzle import NOZZLE
from tetrabench.mesh.numbering import NUMBERINGS, check_seed, renumber
from tetrabench.mesh.quality import signed_volumes, smallest_dihedral_angle
from tetrabench.mesh.tetra_mesh import MeshReport, TetraMesh
from tetrabench.traces import named

# What is taken at the peak for each tetra, measured with the nozzle of 642,816, rounded up.
MOST_BYTES = {"natural": 70, "shuffled": 100, "hilbert": 220, "rcm": 260}

SMALL_NOZZLE = Path(__file__).with_name("small-nozzle.nas")
"""A mesh for a first look, which comes along as a mesher would write it: the file that
`tetrabench generate nozzle --tets 12k -o small-nozzle.nas` makes."""

MODELS = {model.name: model for model in (NOZZLE, INTAKE, BOX)}


def add_model(model: Model) -> None:
    """Take in a model of others, under its name, in the place of one of that name.

    Raises:
        InputError: it is no Model.
    """
    if not isinstance(model, Model):
        raise InputError(f"a {type(model).__name__}, not a {Model.__module__}.Model")
    MODELS[model.name] = model


def generate(name: str | Model, tets: int | None = None, *, numbering: str = "natural", seed: int = 0) -> TetraMesh:
    """Make a model: conforming, every volume positive, lengths in metres, ids from 1 in the order of the rows.

    Args:
        name: one of MODELS; or a `Model` of your own.
        tets: the number of tets wanted (the model's default where None). The model takes the nearest it can
            divide into; what it holds, and its smallest dihedral angle in degrees, stand in `report.source`.
        numbering: one of NUMBERINGS; "natural" is layer by layer.
        seed: of the moved points, and of the shuffling, 0 or more.

    Raises:
        InputError: an unknown model or numbering, fewer than one tetra wanted, or a seed below 0; what `build` raises, or
            tets of no positive volume.
        MemoryRefusedError: more tets wanted than there is memory for.
    """
    model: Model = name if isinstance(name, Model) else find_named("model", MODELS, name)
    find_named("numbering", NUMBERINGS, numbering)  # before the work, not after it
    check_seed(seed)
    wanted = model.tets if tets is None else tets
    if wanted < 1:
        raise InputError(f"a model of {wanted} tets cannot be made; ask for at least 1")
    refuse_if_too_large(f"a model of {wanted:,} tets", wanted * MOST_BYTES[numbering])
    with named(f"the model {model.name}"):
        regular = model.build(wanted)
        shift = np.random.default_rng([seed]).uniform(-1, 1, regular.points.shape) * regular.reach[:, None]
        points = regular.points + shift
        flat = int(np.count_nonzero(signed_volumes(points, regular.tets) <= 0))
    if flat:
        raise InputError(
            f"the model {model.name}: {flat} tets have no positive volume, once its points are moved by `reach`"
        )
    angle = smallest_dihedral_angle(points, regular.tets)
    source = (
        f"{model.name}: {len(regular.tets)} tets, {len(points)} points, {regular.words}, lengths in metres, "
        f"smallest dihedral angle {angle:.1f} degrees, seed {seed}"
    )
    ids = np.arange(1, len(points) + 1, dtype=np.int64), np.arange(1, len(regular.tets) + 1, dtype=np.int64)
    mesh = TetraMesh(points, regular.tets, *ids, MeshReport(source=source))
    # A mesh that is new has no ids to keep: they follow the rows, whatever their order.
    return replace(renumber(mesh, numbering, seed), point_ids=ids[0], tet_ids=ids[1])
