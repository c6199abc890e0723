"""The polygon family, as the harness sees it: its models, its reference contestant, its stage."""

from collections.abc import Mapping
from operator import attrgetter
from pathlib import Path
from typing import Any

import tetrabench.io
import tetrabench.mesh
from tetrabench.io.polygons import check_polygon_source, check_polygon_target, read_polygons, write_polygons
from tetrabench.io.shelf import Shelf
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.models import MODELS, add_model, generate_polygons
from tetrabench.polygon.conformance import RULES
from tetrabench.polygon.contestant import PolygonContestant
from tetrabench.polygon.net import PEAK, PolygonNet
from tetrabench.protocols import ModelFacts, Needs, Tour


class PolygonStage:
    """One contestant with one model: where scenarios get the net they work on. None of them changes it."""

    def __init__(self, contestant: PolygonContestant, model: Path) -> None:
        self.contestant = contestant
        self.model = model
        self._mesh: PolygonMesh | None = None
        self._net: PolygonNet | None = None

    @property
    def mesh(self) -> PolygonMesh:
        """The model, read on first use."""
        if self._mesh is None:
            self._mesh = read_polygons(self.model)
        return self._mesh

    def net(self) -> PolygonNet:
        """The net of the model, the same for all."""
        if self._net is None:
            self._net = PolygonNet(self.mesh, self.contestant)
        return self._net

    def adopt(self, net: PolygonNet) -> None:
        """Take over a net that a scenario has made from the model."""
        self._net = net

    def model_size(self) -> Mapping[str, int]:
        """Cells, edges and nodes of the model."""
        return mesh_size(self.mesh)

    def structure_bytes(self) -> Mapping[str, tuple[int, int]]:
        """Bytes (used, reserved) of each array of the format."""
        return self._net.structure_bytes() if self._net is not None else {}

    def build(self) -> None:
        """Build the net, if none stands."""
        self.net()

    def close(self) -> None:
        """Give everything back."""
        self._net = None


def mesh_size(mesh: PolygonMesh) -> Mapping[str, int]:
    """Cells, edges and nodes."""
    boundary = int((mesh.conditions < 0).sum())
    return {"cells": mesh.number_of_cells, "edges": (len(mesh.nodes) + boundary) // 2, "nodes": len(mesh.points)}


def _make(name: str, size: int | None, numbering: str, seed: int, path: Path) -> None:
    write_polygons(generate_polygons(name, size, numbering=numbering, seed=seed), path)


SHELF = Shelf(
    models=MODELS,
    size_of=attrgetter("cells"),
    maker_of=attrgetter("build"),
    suffix=".npz",
    make=_make,
    made_by=(tetrabench.mesh, tetrabench.io),
    check_source=check_polygon_source,
    check_target=check_polygon_target,
)


class PolygonFamily:
    """Meshes of polygons, in the plane or on surfaces."""

    name = "polygon"
    reference = "by-edge"
    default_model = "voronoi"
    size_option = "cells"
    thesis_order = (
        "cell-nodes",
        "cell-neighbours",
        "node-cells",
        "node-neighbours",
        "random-cell-nodes",
        "random-cell-neighbours",
        "random-node-cells",
        "random-node-neighbours",
        "gas-node",
        "gas-node-adjacency",
        "gas-cell",
        "gas-cell-adjacency",
    )
    tour = Tour("voronoi", 10_000, ("by-edge", "by-node", "tables"), ("cell-nodes", "gasdynamics"), "cells.vtu")
    kind = None
    rules = RULES

    @property
    def models(self) -> Mapping[str, str]:
        """Models that can be generated: name -> one line about it."""
        return {name: model.title for name, model in MODELS.items()}

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

    def needs(self, model: PolygonMesh) -> Needs:
        """What runs on a mesh need."""
        return Needs(len(model.nodes) * PEAK)

    def describe_model(self, path: Path) -> ModelFacts:
        """Cells, edges and nodes of a model, and the warnings of its reader."""
        mesh = read_polygons(path)
        return ModelFacts(mesh_size(mesh), tuple(mesh.report.warnings))

    def small_model(self) -> Path:
        """Some hundred quads."""
        return self.find_model("quad", size=400, numbering="natural", seed=0)

    def stage(self, contestant: PolygonContestant, model: Path, *, chained: bool) -> PolygonStage:
        """A stage for a contestant of this family; that all scenarios share a net makes no difference here."""
        return PolygonStage(contestant, model)


FAMILY = PolygonFamily()
