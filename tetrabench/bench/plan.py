"""What a run will do: which contestants run which scenarios on which model, how often, and in which order."""

import random
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from tetrabench import registry
from tetrabench.bench.record import Backend
from tetrabench.errors import InputError
from tetrabench.protocols import Family, Scenario


@dataclass(frozen=True)
class Effort:
    """How often. A contestant that the first round shows to be hopeless gets `hopeless_rounds` in all."""

    rounds: int
    hopeless_rounds: int


DEFAULT = Effort(rounds=5, hopeless_rounds=3)
QUICK = Effort(rounds=3, hopeless_rounds=1)
ONCE = Effort(rounds=1, hopeless_rounds=1)  # on one net that changes as it goes, nothing can be repeated


@dataclass(frozen=True)
class Task:
    """A scenario with its counts."""

    scenario: str
    options: dict[str, int]


@dataclass(frozen=True, kw_only=True)
class Plan:
    """A run to be made.

    Attributes:
        model: how it was asked for, without its folder; path: its file.
        chained: all scenarios on one net that changes as it goes (the thesis profile).
        threads: how many a worker may use; all workers share one core where it is 1.
        command: how to repeat the run.
    """

    family: str
    model: str
    path: Path
    tasks: tuple[Task, ...]
    backends: tuple[Backend, ...]
    reference: str
    effort: Effort = DEFAULT
    chained: bool = False
    seed: int = 0
    threads: int = 1
    command: str = ""

    def orders(self, task: Task) -> Iterator[list[str]]:
        """The names of the backends in the order of their turns, round after round."""
        draw = random.Random(f"{self.seed} {task.scenario}")
        names = [backend.name for backend in self.backends]
        for round in range(self.effort.rounds):
            row = round % len(names)
            if row == 0:  # a new square
                draw.shuffle(names)
            yield williams_row(names, row)


def williams_row(names: Sequence[str], row: int) -> list[str]:
    """A row of a Latin square: over len(names) rows, each name comes once in each place.

    Where the number of names is even, each also follows each other name once (Williams 1949), so that nobody
    always finds the caches as the same neighbour leaves them.
    """
    count = len(names)
    steps = [(place + 1) // 2 if place % 2 else -place // 2 for place in range(count)]  # 0, 1, -1, 2, -2, ...
    return [names[(row + step) % count] for step in steps]


def make_plan(
    model: str | Path,
    *,
    family: str = "tetra",
    backends: Sequence[str] | None = None,
    scenarios: Sequence[str] | None = None,
    reference: str | None = None,
    thesis: bool = False,
    quick: bool = False,
    rounds: int | None = None,
    tets: int | None = None,
    numbering: str = "natural",
    seed: int = 0,
) -> Plan:
    """Look up what is asked for by name; generate the model if it is one of the family's.

    Args:
        model: a file, or the name of a model that the family can generate.
        backends: all if None; the first one is the reference where the family's is not among them.
        scenarios: all if None, or with `thesis` those of the source, in its order.
        thesis: the source's counts too, once, on one net that changes as it goes.
        reference: the backend that ratios refer to.
        quick: 3 rounds instead of 5.
        rounds: so many instead.
        tets: size of a generated model, in elements.
        numbering: of a generated model: "natural", "shuffled", "hilbert" or "rcm".
        seed: of a generated model, and of the order of turns.

    Raises:
        InputError: unknown names, a model that is not there, rounds below 1, or more than one with `thesis`.
    """
    kind = registry.family(family)
    chosen = registry.contestants(family)
    if backends is not None:
        chosen = [registry.contestant(family, name) for name in dict.fromkeys(backends)]
    names = [contestant.name for contestant in chosen]
    if reference is None:
        reference = kind.reference if kind.reference in names else next(iter(names), "")
    if reference not in names:
        raise InputError(f"the reference '{reference}' is not among the backends: {', '.join(names) or 'none'}")
    tasks = tuple(
        Task(scenario.name, dict(scenario.thesis if thesis else scenario.options))
        for scenario in _choose_scenarios(kind, scenarios, thesis)
    )
    asked = Path(model).name
    return Plan(
        family=family,
        model=asked,
        path=kind.find_model(str(model), size=tets, numbering=numbering, seed=seed).absolute(),
        tasks=tasks,
        backends=tuple(Backend(name=one.name, title=one.title, extension=one.extension) for one in chosen),
        reference=reference,
        effort=_choose_effort(thesis, quick, rounds),
        chained=thesis,
        seed=seed,
        command=_command(
            asked,
            family=family if family != "tetra" else None,
            backend=backends,
            scenario=scenarios,
            reference=reference if reference != kind.reference else None,
            thesis=thesis,
            quick=quick,
            rounds=rounds,
            tets=tets,
            numbering=numbering if numbering != "natural" else None,
            seed=seed or None,
        ),
    )


def _choose_scenarios(family: Family, names: Sequence[str] | None, thesis: bool) -> list[Scenario]:
    """The scenarios asked for, in the order asked for; with `thesis`, those of the source, in its order."""
    chosen = registry.scenarios(family.name)
    if names is not None:
        chosen = [registry.scenario(family.name, name) for name in dict.fromkeys(names)]
    if thesis:
        others = [scenario.name for scenario in chosen if scenario.name not in family.thesis_order]
        if names is not None and others:
            raise InputError(f"not in the thesis: {', '.join(others)}; it has: {', '.join(family.thesis_order)}")
        wanted = {scenario.name: scenario for scenario in chosen}
        chosen = [wanted[name] for name in family.thesis_order if name in wanted]
    if not chosen:
        raise InputError("no scenario to run")
    return chosen


def _choose_effort(thesis: bool, quick: bool, rounds: int | None) -> Effort:
    if rounds is not None and rounds < 1:
        raise InputError(f"rounds: {rounds}; at least one is needed")
    if thesis:
        if rounds not in (None, 1):
            raise InputError("the thesis profile changes one net as it goes: it has one round")
        return ONCE
    effort = QUICK if quick else DEFAULT
    return effort if rounds is None else Effort(rounds, min(rounds, effort.hopeless_rounds))


def _command(model: str, **flags: object) -> str:
    """The command line that asks for the same; a flag that is None or False is left out."""
    words = ["tetrabench", "run", "--model", model]
    for name, value in flags.items():
        if value is not None and value is not False:
            words.append(f"--{name}")
            if value is not True:
                words.append(",".join(value) if isinstance(value, list | tuple) else str(value))
    return shlex.join(words)
