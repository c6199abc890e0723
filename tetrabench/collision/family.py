"""The collision family, as the harness sees it: its models, its reference contestant, its stage."""

from collections.abc import Mapping
from operator import attrgetter
from pathlib import Path
from typing import Any

import tetrabench.collision.start
import tetrabench.mesh
from tetrabench.collision.conformance import RULES
from tetrabench.collision.contestant import CollisionContestant
from tetrabench.collision.objects import Start
from tetrabench.collision.simulation import PEAK, Simulation
from tetrabench.collision.start.files import check_objects_source, check_objects_target, read_objects, write_objects
from tetrabench.collision.start.inspection import count_outside
from tetrabench.collision.start.kind import OBJECTS
from tetrabench.collision.start.models import MODELS, add_model, generate_objects
from tetrabench.io.shelf import Shelf
from tetrabench.protocols import ModelFacts, Needs, Tour


class CollisionStage:
    """One contestant with one model: where scenarios get the simulations that they run, each from the start."""

    def __init__(self, contestant: CollisionContestant, model: Path) -> None:
        self.contestant = contestant
        self.model = model
        self._start: Start | None = None
        self._simulation: Simulation | None = None

    @property
    def start(self) -> Start:
        """The model, read on first use. Simulations copy its objects."""
        if self._start is None:
            self._start = read_objects(self.model)
        return self._start

    def simulation(self, **rules: Any) -> Simulation:
        """A fresh simulation, by the rules that `Simulation` takes. The one that was given out before is dropped."""
        self._simulation = None  # before the next one stands, so that there is room for one alone
        self._simulation = Simulation(self.start, self.contestant, **rules)
        return self._simulation

    def adopt(self, simulation: Simulation) -> None:
        """Take over a simulation that a scenario has made."""
        self._simulation = simulation

    def model_size(self) -> Mapping[str, int]:
        """Objects of the model."""
        return start_size(self.start)

    def structure_bytes(self) -> Mapping[str, tuple[int, int]]:
        """Bytes (used, reserved) of each array of the structure of the simulation that was given out last."""
        return self._simulation.structure_bytes() if self._simulation is not None else {}

    def build(self) -> None:
        """Build the structure at the start, if none stands."""
        if self._simulation is None:
            self.simulation()

    def close(self) -> None:
        """Give everything back."""
        self._simulation = None


def start_size(start: Start) -> Mapping[str, int]:
    """Objects."""
    return {"objects": len(start.objects.x)}


def _make(name: str, size: int | None, numbering: str, seed: int, path: Path) -> None:
    write_objects(generate_objects(name, size, numbering=numbering, seed=seed), path)


SHELF = Shelf(
    models=MODELS,
    size_of=attrgetter("objects"),
    maker_of=attrgetter("place"),
    suffix=".npz",
    make=_make,
    made_by=(tetrabench.collision.start, tetrabench.mesh),
    check_source=check_objects_source,
    check_target=check_objects_target,
)


class CollisionFamily:
    """Moving circles, and which of them touch."""

    name = "collision"
    reference = "kdtree"
    default_model = "uniform"
    size_option = "objects"
    thesis_order = ("motion", "concentration", "weightless", "gravity")
    tour = Tour("uniform", 10_000, ("kdtree", "grid", "ckdtree"), ("motion",), "start.csv")
    kind = OBJECTS
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

    def needs(self, model: Start) -> Needs:
        """What runs on a start need. How long they take depends on how its objects lie and move."""
        return Needs(len(model.objects.x) * PEAK)

    def describe_model(self, path: Path) -> ModelFacts:
        """How many objects a model has, and how many of them begin outside of its box."""
        start = read_objects(path)
        outside = count_outside(start)
        notes = (f"{outside:,} of {len(start.objects.x):,} objects begin outside of the box",) if outside else ()
        if not len(start.objects.x):
            notes = ("there are no objects: times are of nothing",)
        return ModelFacts(start_size(start), notes)

    def small_model(self) -> Path:
        """Some hundred objects."""
        return self.find_model("uniform", size=300, numbering="natural", seed=0)

    def stage(self, contestant: CollisionContestant, model: Path, *, chained: bool) -> CollisionStage:
        """A stage for a contestant of this family; every simulation begins at the start, in a chain too."""
        return CollisionStage(contestant, model)


FAMILY = CollisionFamily()
