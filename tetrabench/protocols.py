"""What the harness asks of a family, a contestant, a scenario: all that `bench`, `report` and the verbs know of them."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Protocol

Options = Mapping[str, int]


@dataclass(frozen=True)
class Option:
    """What can be chosen about a contestant, a whole number; 0 and 1 where it is no or yes.

    Attributes:
        value: chosen; least, most: what may be.
        title: what it decides, in a line.
    """

    value: int
    least: int
    most: int
    title: str


@dataclass(frozen=True)
class Answer:
    """What a scenario found, independent of how its contestant stores things.

    Attributes:
        digest: 16 hexadecimal digits; equal for all contestants, bit for bit, or one of them is wrong.
        figures: counts and sums for people, to see at a glance what a difference is about.
        series: what was counted or timed on the way, a number for each stretch of the run, by name, all of one length:
            for charts, no part of the answer.
    """

    digest: str
    figures: Mapping[str, int | float]
    series: Mapping[str, Sequence[float]] = field(default_factory=dict)


@dataclass(frozen=True)
class Work:
    """How much one sample did.

    Attributes:
        items: how many of `unit` were done.
        unit: what was done, such as "tetra sweeps" or "splits".
        least_bytes: the least traffic with memory that any storage could need for it, None where nobody can say.
    """

    items: int
    unit: str
    least_bytes: int | None = None


@dataclass(frozen=True)
class ModelFacts:
    """What a model holds.

    Attributes:
        size: how many, by what is counted, such as {"tetras": 642700, "points": 120000}.
        notes: what its reader warns of, a sentence each.
    """

    size: Mapping[str, int]
    notes: Sequence[str] = ()


@dataclass(frozen=True)
class Tour:
    """What a run takes where nothing is named: so little that it ends within a minute with nothing compiled yet.

    Attributes:
        model: its name; size: of one that is generated, in elements, None of one that is a file of ours.
        backends, scenarios: by name, few of all.
        file: what a file of a person's own might be called.
    """

    model: str
    size: int | None
    backends: Sequence[str]
    scenarios: Sequence[str]
    file: str


@dataclass(frozen=True)
class Needs:
    """What runs on a model need, from what was measured of others: for an estimate.

    Attributes:
        peak_bytes: the most while a contestant's structure of it is built.
        launch_s: seconds of a launch of three rounds, all scenarios on all contestants, with everything compiled; None where
            nobody can say.
    """

    peak_bytes: float
    launch_s: float | None = None


@dataclass(frozen=True)
class Workload:
    """A usual mix of a family's scenarios, under a name that people type.

    Attributes:
        title: what it stands for, in a line.
        mix: how often, by scenario: see `report.advice.mix`.
    """

    name: str
    title: str
    mix: Mapping[str, float]


@dataclass(frozen=True)
class Rule:
    """What every contestant of a family must do, and how that is found out.

    Attributes:
        title: what must be so, in a line.
        faults: contestant -> sentences, each of which names a function of the interface and the situation; none: sound.
        essential: whether nothing else can be asked of a contestant that breaks it.
    """

    name: str
    title: str
    faults: Callable[[Any], Iterable[str]]
    essential: bool = False


class Contestant(Protocol):
    """A way to store something, a dataclass.

    `name` is what people type; `extension` marks those that are not from the source. `options` may be chosen, by name.
    `is_exact` is False of one that is known to give wrong answers, and takes part to show how that is noticed.
    """

    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def trade_off(self) -> str: ...
    @property
    def family(self) -> str: ...
    @property
    def extension(self) -> bool: ...
    @property
    def options(self) -> Mapping[str, Option]: ...
    @property
    def is_exact(self) -> bool: ...


class Stage(Protocol):
    """One contestant with one model, in one worker: where scenarios get what they work on."""

    def model_size(self) -> Mapping[str, int]:
        """How large the model is, by what is counted, such as {"tetras": 642700, "points": 120000}."""

    def structure_bytes(self) -> Mapping[str, tuple[int, int]]:
        """Bytes (used, reserved) of each buffer of the structure as it stands now, by name; each buffer once."""

    def build(self) -> None:
        """Build the structure of the model now, if none stands."""

    def close(self) -> None:
        """Give everything back."""


class Scenario(Protocol):
    """A workload, written once against the interface of its family.

    `options` are its counts with their defaults, `thesis` the counts of the source (same keys). `parallel`: it works
    with several threads, and is measured by wall time.
    """

    @property
    def name(self) -> str: ...
    @property
    def title(self) -> str: ...
    @property
    def family(self) -> str: ...
    @property
    def options(self) -> Options: ...
    @property
    def thesis(self) -> Options: ...
    @property
    def parallel(self) -> bool: ...

    def skip(self, contestant: Any) -> str | None:
        """Why this contestant cannot run it; None if it can."""

    def prepare(self, stage: Any, options: Options) -> Any:
        """What `run` works on; fresh for every sample, and in the same state: what a first run would find missing and
        leave behind is there. Untimed.

        Raises:
            UnsupportedError: the model is none that it has anything to do with; the cell is reported as unsupported.
        """

    def run(self, subject: Any) -> Any:
        """The workload. The only thing that is timed; returns its outcome."""

    def answer(self, subject: Any, outcome: Any) -> Answer:
        """What was found. Untimed; `subject` may be used up."""

    def work(self, subject: Any, outcome: Any) -> Work:
        """How much was done. Untimed."""


class Family(Protocol):
    """A kind of thing to store: its models, its reference contestant, its stage."""

    @property
    def name(self) -> str: ...
    @property
    def reference(self) -> str:
        """The contestant that ratios refer to."""

    @property
    def default_model(self) -> str:
        """The model that is taken where none is named."""

    @property
    def tour(self) -> Tour | None:
        """What a run takes where nothing at all is named; None: everything, on the default model."""

    @property
    def size_option(self) -> str:
        """What the size of a model counts, and the option that sets it: "tets" for --tets."""

    @property
    def thesis_order(self) -> Sequence[str]:
        """The scenarios of the source, in its order, on one net that changes as it goes."""

    @property
    def models(self) -> Mapping[str, str]:
        """Models that can be generated: name -> one line about it."""

    @property
    def kind(self) -> Any | None:
        """What the verbs about models have to know of them (`io.kinds.Kind`); None of meshes, which they know, and of models
        that only `run` and the like take."""

    @property
    def rules(self) -> Sequence[Rule]:
        """What every contestant must do, in an order in which what comes first is relied upon later."""

    def add_model(self, model: Any) -> None:
        """Take in a model of a plug-in, under its `name`, among those that can be generated.

        Raises:
            InputError: it is none of this family's kind.
        """

    def drop_model(self, name: str) -> None:
        """Forget a model that was added."""

    def find_model(self, model: str, *, size: int | None, numbering: str, seed: int) -> Path:
        """The file of a model: `model` is a path, or the name of one that is generated into the user's cache.

        Raises:
            InputError: there is no such file and no such model; says how to get one.
        """

    def needs(self, model: Any) -> Needs | None:
        """What runs on a model need, as its `io.kinds.Kind` reads it; None where nobody knows."""

    def describe_model(self, path: Path) -> ModelFacts:
        """Read a model, and say what it holds.

        Raises:
            InputError: it cannot be used.
        """

    def small_model(self) -> Path:
        """A model so small that only compiling takes time on it."""

    def stage(self, contestant: Any, model: Path, *, chained: bool) -> Stage:
        """A stage; `chained` gives every scenario the same net, as the source did, else each starts from a fresh one."""
