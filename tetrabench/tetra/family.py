"""The tetra family, as the harness sees it: its models, its reference contestant, its stage."""

from collections.abc import Mapping
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

import tetrabench.io
import tetrabench.mesh
from tetrabench.errors import InputError
from tetrabench.io import check_target, known_suffix, read_mesh, write_mesh
from tetrabench.io.formats import NoCellsError
from tetrabench.io.shelf import Shelf
from tetrabench.jit import kernel
from tetrabench.mesh import TetraMesh
from tetrabench.mesh.models import MODELS, SMALL_NOZZLE, add_model, generate
from tetrabench.protocols import ModelFacts, Needs, Tour
from tetrabench.tetra.conformance import RULES
from tetrabench.tetra.contestant import TetraContestant
from tetrabench.tetra.interface import (
    NONE,
    STATES,
    Net,
    centroid,
    first_tetra,
    next_tetra,
    set_state,
)
from tetrabench.tetra.net import PEAK, TetraNet


class TetraStage:
    """One contestant with one model: where scenarios get the net they work on.

    Every net that it gives out has its initial state: state 0 a smooth function of the place, the others 0.
    """

    def __init__(self, contestant: TetraContestant, model: Path, *, chained: bool) -> None:
        """`chained`: all scenarios get one and the same net, as in the source's runs; else each starts from a fresh one."""
        self.contestant = contestant
        self.model = model
        self.chained = chained
        self._mesh: TetraMesh | None = None
        self._net: TetraNet | None = None  # fresh, or in a chain the one net
        self._own: TetraNet | None = None  # the net that a sample may use up

    @property
    def mesh(self) -> TetraMesh:
        """The model, read on first use."""
        if self._mesh is None:
            self._mesh = read_mesh(self.model)
        return self._mesh

    def net(self) -> TetraNet:
        """A net for scenarios that change nothing but states. In a chain it keeps the states that it has."""
        self._drop_own()
        if self._net is None:
            self._net = self._build()
        elif not self.chained:
            set_initial_states(self._net)
        return self._net

    def own_net(self) -> TetraNet:
        """A net for scenarios that change it: a fresh one, or in a chain the one net."""
        if self.chained:
            return self.net()
        self._drop_own()
        self._own = self._build()
        return self._own

    def adopt(self, net: TetraNet) -> None:
        """Take over a net that a scenario has made from the model: the own one, and in a chain the one net."""
        set_initial_states(net)
        if self.chained:
            self._net = net
        else:
            self._drop_own()
            self._own = net

    def model_size(self) -> Mapping[str, int]:
        """Tetras and points of the model."""
        return mesh_size(self.mesh)

    def structure_bytes(self) -> Mapping[str, tuple[int, int]]:
        """Bytes (used, reserved) of each buffer of the net that was given out last."""
        net = self._net if self._own is None else self._own
        return net.structure_bytes() if net is not None and net.is_open else {}

    def build(self) -> None:
        """Build the fresh net, if none stands."""
        self.net()

    def close(self) -> None:
        """Give back all nets."""
        self._drop_own()
        if self._net is not None:
            self._net.close()
            self._net = None

    def _build(self) -> TetraNet:
        net = TetraNet(self.mesh, self.contestant)
        set_initial_states(net)
        return net

    def _drop_own(self) -> None:
        if self._own is not None:
            self._own.close()
            self._own = None


def mesh_size(mesh: TetraMesh) -> Mapping[str, int]:
    """Tetras and points."""
    return {"tetras": len(mesh.tets), "points": len(mesh.points)}


def set_initial_states(net: TetraNet) -> None:
    """State 0 = 0.5 + 0.5 sin(3x) cos(2y) sin(1.7z + 0.3), centroids over the diagonal of the bounding box; others 0.

    Independent of the numbering of the mesh.
    """
    _set_initial_states(net.storage)


@kernel(allocates=False)
def _set_initial_states(net: Net) -> None:
    diagonal = net.points.diagonal
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        t = cursor.tetra
        x, y, z = (
            centroid(net, t, 0) / diagonal,
            centroid(net, t, 1) / diagonal,
            centroid(net, t, 2) / diagonal,
        )
        set_state(net, t, 0, 0.5 + 0.5 * np.sin(3.0 * x) * np.cos(2.0 * y) * np.sin(1.7 * z + 0.3))
        for k in range(1, STATES):
            set_state(net, t, k, 0.0)
        cursor = next_tetra(net, cursor)


def _make(name: str, size: int | None, numbering: str, seed: int, path: Path) -> None:
    write_mesh(generate(name, size, numbering=numbering, seed=seed), path)


SHELF = Shelf(
    models=MODELS,
    size_of=attrgetter("tets"),
    maker_of=attrgetter("build"),
    suffix=".nas",
    make=_make,
    made_by=(tetrabench.mesh, tetrabench.io),
    check_source=known_suffix,
    check_target=check_target,
    files={SMALL_NOZZLE.stem: SMALL_NOZZLE},
)

LAUNCH_S = 36.0, 6.4e-4
"""Seconds of a launch, and for each tetra: measured in results/nozzle-120k-quick.json."""


class TetraFamily:
    """Tetrahedral nets."""

    name = "tetra"
    reference = "v3y"
    default_model = "nozzle"
    size_option = "tets"
    thesis_order = ("init", "delete", "explode", "alfa", "flow", "free")
    tour = Tour(SMALL_NOZZLE.stem, None, ("v3y", "v4"), ("alfa", "delete"), "part.nas")
    kind = None
    rules = RULES

    @property
    def models(self) -> Mapping[str, str]:
        """Models that can be generated, and the one that is a file of ours: name -> one line about it."""
        titles = {name: model.title for name, model in MODELS.items()}
        return titles | {
            SMALL_NOZZLE.stem: "a nozzle of 12,096 tetras in a Nastran file: what a run takes where nothing is named"
        }

    def add_model(self, model: Any) -> None:
        """Take in a model of a plug-in.

        Raises:
            InputError: it is no `Model` of this family.
        """
        add_model(model)

    def drop_model(self, name: str) -> None:
        """Forget a model that was added."""
        del MODELS[name]

    def find_model(self, model: str, *, size: int | None, numbering: str, seed: int) -> Path:
        """The file of a model: `model` is a path, or the name of one that is generated into the user's cache."""
        return SHELF.find(model, size=size, numbering=numbering, seed=seed)

    def needs(self, model: TetraMesh) -> Needs:
        """What runs on a mesh need."""
        tets = len(model.tets)
        return Needs(tets * PEAK, LAUNCH_S[0] + tets * LAUNCH_S[1])

    def describe_model(self, path: Path) -> ModelFacts:
        """Tetras and points of a model, and the warnings of its reader."""
        try:
            mesh = read_mesh(path)
        except NoCellsError as error:
            raise InputError(f"{error}; a mesh of polygons goes with --family polygon") from error
        return ModelFacts(mesh_size(mesh), tuple(mesh.report.warnings))

    def small_model(self) -> Path:
        """A box of a few hundred tetras."""
        return self.find_model("box", size=400, numbering="natural", seed=0)

    def stage(self, contestant: TetraContestant, model: Path, *, chained: bool) -> TetraStage:
        """A stage for a contestant of this family."""
        return TetraStage(contestant, model, chained=chained)


FAMILY = TetraFamily()
