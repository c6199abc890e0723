"""What a run will do: which contestants do which tasks on which models, how often, and in which order."""

import hashlib
import random
import re
import shlex
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import product
from pathlib import Path
from typing import TypeVar

import msgspec

from tetrabench import plugins
from tetrabench.bench.catalogue import Guide, Registry
from tetrabench.bench.messages import ContestantFacts, Described, Find, ScenarioFacts
from tetrabench.bench.record import Backend, Effort, Model, Task
from tetrabench.bench.statistics import fewest_launches
from tetrabench.errors import InputError, find_named
from tetrabench.protocols import ModelFacts, Options, Tour
from tetrabench.registry import choose_options

EFFORTS = {
    "default": Effort(launches=8, rounds=3, hopeless_rounds=3, narrow=0.03),
    "quick": Effort(launches=3, rounds=3, hopeless_rounds=1),
    "rigorous": Effort(launches=12, rounds=5, hopeless_rounds=3, narrow=0.03),
    "thesis": Effort(launches=1, rounds=1, hopeless_rounds=1),  # one net that changes as it goes: nothing is repeated
    "check": Effort(launches=1, rounds=1, hopeless_rounds=1),
}
"""By profile. Many launches of few rounds rather than the reverse: see `statistics`."""

DEFAULT_SIZE = 30_000
"""Elements of the model where none is named: all contestants and scenarios end in minutes."""
TOUR_LAUNCHES = 2
"""Of a run where nothing is named: what is many times as slow shows in each."""
TIMEOUT_S = 3600.0
"""Longest wait for a worker unless another is asked for: a sweep of the source's slowest takes minutes."""

CONTROL = "control"
"""What the name of a second copy of a reference ends with, after a blank."""


@dataclass(frozen=True, kw_only=True)
class Plan:
    """A run to be made.

    Attributes:
        models: name -> file; facts: name -> what it holds.
        backends: with the controls; in the order of tables and charts.
        checkouts: folder of the packages that a backend's worker imports first, by `Backend.checkout`.
        threads: how many a worker may use; those of serial tasks share one core.
        timeout_s: longest wait for a worker's reply; budget_s: no launch begins that would end later. None: no limit.
        has_memory, has_yardsticks: whether memory and the machine are measured too.
        command: how to repeat the run.
        titles: of all contestants of the family, see `record.Results`.
        left_out: where nothing was named, what a run takes less than all, and how to have it all, a sentence; else "".
    """

    family: str
    models: Mapping[str, Path]
    facts: Mapping[str, ModelFacts] = field(default_factory=dict)
    tasks: tuple[Task, ...]
    backends: tuple[Backend, ...]
    reference: str
    profile: str = "default"
    effort: Effort = EFFORTS["default"]
    seed: int = 0
    threads: int = 1
    timeout_s: float | None = TIMEOUT_S
    budget_s: float | None = None
    has_memory: bool = True
    has_yardsticks: bool = True
    command: str = ""
    titles: tuple[str, ...] = ()
    left_out: str = ""
    checkouts: Mapping[str, Path] = field(default_factory=dict)

    @property
    def chained(self) -> bool:
        """All scenarios on one net that changes as it goes."""
        return self.profile == "thesis"

    def orders(self, model: str, task: Task, launch: int, names: Sequence[str]) -> Iterator[list[str]]:
        """The names of a group's backends in the order of their turns, round after round of a launch.

        One Latin square goes through all launches, so that each has each place equally often.
        """
        for round in range(self.effort.rounds):
            block, row = divmod(launch * self.effort.rounds + round, max(1, len(names)))
            shuffled = list(names)
            random.Random(f"{self.seed} {model} {task.name} {block}").shuffle(shuffled)
            yield williams_row(shuffled, row)


def williams_row(names: Sequence[str], row: int) -> list[str]:
    """A row of a Latin square: over len(names) rows, each name comes once in each place.

    Where the number of names is even, each also follows each other name once (Williams 1949), so that nobody
    always finds the caches as the same neighbour leaves them.
    """
    count = len(names)
    steps = [(place + 1) // 2 if place % 2 else -place // 2 for place in range(count)]  # 0, 1, -1, 2, -2, ...
    return [names[(row + step) % count] for step in steps]


def make_plan(
    model: str | Path | None = None,
    *,
    family: str = "tetra",
    backends: Sequence[str] | None = None,
    scenarios: Sequence[str] | None = None,
    reference: str | None = None,
    profile: str = "default",
    launches: int | None = None,
    rounds: int | None = None,
    tets: Sequence[int] | None = None,
    sized_by: str | None = None,
    options: Mapping[str, Sequence[int]] | None = None,
    numberings: Sequence[str] = ("natural",),
    seed: int = 0,
    budget_s: float | None = None,
    timeout_s: float = TIMEOUT_S,
    guide: Guide | None = None,
) -> Plan:
    """Look up what is asked for by name; find the model, or have it generated.

    Args:
        model: a file, or the name of a model that the family can generate; None: the family's default, and a small one. Where
            nothing else is named either, neither backends nor scenarios, sizes, options, numberings, a reference or plug-ins,
            and the profile is "default" or "quick", the family's tour, with the effort of "quick" in TOUR_LAUNCHES.
        backends: contestants; all that are exact if None. The first one that is exact is the reference where the
            family's is not among them.
        scenarios: all if None, or with the thesis profile those of the source, in its order.
        reference: the backend that ratios refer to; or a contestant, which stands for its backend with the usual options,
            or else its first one.
        profile: of EFFORTS; "thesis" takes the source's counts, once, on one net that changes as it goes.
        launches, rounds: so many instead of the profile's.
        tets: sizes of a generated model, in elements; several make a sweep.
        sized_by: what they count, where that was said: "tets", "cells" or "objects".
        options: counts of scenarios and options of contestants by name, "sweeps" or "alfa.sweeps", which concerns all
            that have it, or the one; several values make a sweep.
        numberings: of a generated model: "natural", "shuffled", "hilbert" or "rcm"; several make a sweep.
        seed: of a generated model, and of the order of turns.
        budget_s, timeout_s: see `Plan`.
        guide: who knows families and finds models; this process unless it shall stay small.

    Raises:
        InputError: unknown names, a size in what the family does not count, a model that is not there, a count below 1, an
            option beyond its limits, a reference that is known to be wrong, more than one round with the thesis, a sweep
            over sizes and numberings at once, or over numberings without the natural one.
    """
    numberings = list(dict.fromkeys(numberings))
    if len(tets or ()) > 1 and len(numberings) > 1:
        raise InputError("several sizes and several numberings: sweep over one of them at a time")
    if len(numberings) > 1 and "natural" not in numberings:
        raise InputError("several numberings are compared with the natural one: add it, --numbering natural,...")
    guide = guide or Registry()
    kind = guide.describe(family)
    if sized_by not in (None, kind.size_option):
        raise InputError(
            f"--{sized_by}: models of the family {family} are counted in --{kind.size_option}; "
            "say that, or name another --family"
        )
    left_out = ""
    is_named = any(one is not None for one in (model, backends, scenarios, reference, tets)) or bool(options)
    has_tour = profile in ("default", "quick") and numberings == ["natural"] and not plugins.files()
    if kind.tour and has_tour and not is_named:
        model, tets = kind.tour.model, [kind.tour.size] if kind.tour.size else None
        backends, scenarios = list(kind.tour.backends), list(kind.tour.scenarios)
        profile, launches = "quick", launches or TOUR_LAUNCHES
        left_out = _left_out(kind, kind.tour, family)
    elif model is None:
        model, tets = kind.default_model, tets or [DEFAULT_SIZE]
    thesis = profile == "thesis"
    options = options or {}
    contestants = _choose("backend", family, kind.contestants, backends)
    if backends is None:
        contestants = [one for one in contestants if one.exact]
    chosen_scenarios = _choose_scenarios(family, kind, scenarios, thesis)
    _refuse_unknown(options, [*contestants, *chosen_scenarios])
    seats = list(make_backends(contestants, options))
    stands_for = _stand_ins(seats, contestants)
    base = _find_reference(seats, stands_for, reference, kind.reference)
    called = base.contestant if base == stands_for[base.contestant] else base.name
    asked = Path(model).name
    command = _command(
        asked,
        "check" if profile == "check" else "run",
        family=family if family != "tetra" else None,
        plugin=[_from_here(path) for path in plugins.files()],
        backend=backends,
        scenario=scenarios,
        reference=called if called != kind.reference else None,
        thesis=thesis,
        quick=profile == "quick",
        rigorous=profile == "rigorous",
        launches=launches,
        rounds=rounds,
        **{kind.size_option: tets},
        option=[f"{name}={','.join(map(str, values))}" for name, values in options.items()],
        numbering=numberings if numberings != ["natural"] else None,
        seed=seed or None,
        budget=f"{budget_s:g}" if budget_s is not None else None,
        timeout=f"{timeout_s:g}" if timeout_s != TIMEOUT_S else None,
    )
    models = {
        model_name(asked, size if len(tets or ()) > 1 else None, numbering): guide.find_model(
            Find(family, str(model), size, numbering, seed)
        )
        for size in (dict.fromkeys(tets) if tets else [None])
        for numbering in numberings
    }
    return Plan(
        family=family,
        models={name: Path(found.path) for name, found in models.items()},
        facts={name: ModelFacts(found.size, tuple(found.notes)) for name, found in models.items()},
        tasks=tuple(make_tasks(chosen_scenarios, options, thesis=thesis)),
        backends=seat(seats, base, has_control=profile in ("default", "quick", "rigorous")),
        reference=base.name,
        profile=profile,
        effort=_choose_effort(profile, launches, rounds, len(seats) - 1),
        seed=seed,
        budget_s=budget_s,
        timeout_s=timeout_s,
        has_memory=not thesis and profile != "check",
        has_yardsticks=profile != "check",
        command=command,
        titles=tuple(one.title for one in kind.contestants),
        left_out=left_out,
    )


def _left_out(kind: Described, tour: Tour, family: str) -> str:
    """What a tour is less than all, and what to type next."""
    exact = sum(one.exact for one in kind.contestants)
    whose = "" if family == "tetra" else f"--family {family} "
    return (
        f"a first look: {len(tour.backends)} of {exact} backends in {len(tour.scenarios)} of {len(kind.scenarios)} scenarios, "
        f"on a small model; all of them on one of yours: tetrabench run {whose}--model {tour.file}"
    )


def seat(backends: Iterable[Backend], reference: Backend, *, has_control: bool) -> tuple[Backend, ...]:
    """All backends against one of them, whose control comes last."""
    seated = [msgspec.structs.replace(one, against=reference.name) for one in backends]
    if has_control:
        seated += [control_of(one) for one in seated if one.name == reference.name]
    return tuple(seated)


def make_backends(contestants: Iterable[ContestantFacts], options: Mapping[str, Sequence[int]]) -> Iterator[Backend]:
    """The contestants with their options, each against itself; with several values of an option, a backend for each.

    Raises:
        InputError: a value beyond the limits of its option.
    """
    for one in contestants:
        values = {name: option.value for name, option in one.options.items()}
        for name, chosen in combinations(one.name, values, options):
            choose_options(one.name, one.options, chosen)
            yield Backend(
                name=name,
                contestant=one.name,
                title=one.title,
                against=name,
                extension=one.extension,
                options=chosen,
                exact=one.exact,
            )


def control_of(backend: Backend) -> Backend:
    """A second copy of a reference, which runs along."""
    return msgspec.structs.replace(backend, name=f"{backend.name} {CONTROL}", against=backend.name, control=True)


def make_tasks(
    scenarios: Sequence[ScenarioFacts], options: Mapping[str, Sequence[int]], *, thesis: bool = False
) -> Iterator[Task]:
    """The scenarios with their counts; with several values of an option, one task for each.

    Raises:
        InputError: a count below 1.
    """
    for scenario in scenarios:
        counts = scenario.thesis if thesis else scenario.options
        for name, chosen in combinations(scenario.name, counts, options):
            if any(chosen[option] < 1 for option in chosen if chosen[option] != counts[option]):
                raise InputError(f"{scenario.name}: counts are 1 at least")
            yield Task(name=name, scenario=scenario.name, options=chosen, parallel=scenario.parallel)


def combinations(
    owner: str, values: Options, options: Mapping[str, Sequence[int]]
) -> Iterator[tuple[str, dict[str, int]]]:
    """Every combination of what is asked of a scenario or a contestant, with its name: what is swept follows the owner.

    Args:
        owner: its name; values: its own, by option.
        options: what is asked for, "sweeps" of all or "alfa.sweeps" of one; what is said last holds.
    """
    asked = {
        option: said[-1]
        for option in values
        if (said := [options[name] for name in options if name in (option, f"{owner}.{option}")])
    }
    several = [option for option, choices in asked.items() if len(choices) > 1]
    for choice in product(*asked.values()):
        chosen = dict(values) | dict(zip(asked, choice, strict=True))
        yield " ".join([owner, *(f"{option}={chosen[option]}" for option in several)]), chosen


def _refuse_unknown(options: Iterable[str], owners: Sequence[ContestantFacts | ScenarioFacts]) -> None:
    """Refuse an option that nobody has who takes part."""
    known = {f"{one.name}.{name}": name for one in owners for name in one.options}
    for name in options:
        if name not in known.values():
            find_named("option", known, name)


def _stand_ins(backends: Sequence[Backend], contestants: Iterable[ContestantFacts]) -> dict[str, Backend]:
    """The backend that stands for each contestant: that with the usual options, or else its first one."""
    usual = {one.name: {name: option.value for name, option in one.options.items()} for one in contestants}
    by_habit = sorted(backends, key=lambda one: one.options != usual[one.contestant])
    return {one.contestant: one for one in reversed(by_habit)}


def _find_reference(
    backends: Sequence[Backend], stands_for: Mapping[str, Backend], asked: str | None, usual: str
) -> Backend:
    """The backend that ratios refer to: the one asked for, that of the contestant of that name, or the usual one.

    Raises:
        InputError: it does not take part, or it is known to be wrong.
    """
    if asked is None:
        exact = [one.contestant for one in backends if one.exact] or [one.contestant for one in backends]
        found = stands_for.get(usual if usual in exact or not exact else exact[0])
    else:
        found = next((one for one in backends if one.name == asked), stands_for.get(asked))
    if found is None:
        names = ", ".join(one.name for one in backends) or "none"
        raise InputError(f"the reference '{asked or usual}' is not among the backends: {names}")
    if not found.exact:
        raise InputError(f"{found.name} is known to give wrong answers, and is no reference: add another --backend")
    return found


def parse_option(text: str) -> tuple[str, list[int]]:
    """ "alfa.sweeps=10,50" as a name and its values; a range 1..4 stands for 1,2,3,4.

    Raises:
        InputError: it is something else.
    """
    name, _, values = text.partition("=")
    numbers: list[int] = []
    for part in values.split(","):
        match = re.fullmatch(r"(\d+)(?:\.\.(\d+))?", part.strip())
        if not name.strip() or match is None:
            raise InputError(f"option '{text}': write NAME=1,2,3 or NAME=1..3, in whole numbers")
        first, last = int(match[1]), int(match[2] or match[1])
        if first > last:
            raise InputError(f"option '{text}': nothing goes from {first} up to {last}; did you mean {last}..{first}?")
        numbers += range(first, last + 1)
    return name.strip(), list(dict.fromkeys(numbers))


Facts = TypeVar("Facts", ContestantFacts, ScenarioFacts)


def _choose(kind: str, family: str, known: Sequence[Facts], names: Sequence[str] | None) -> list[Facts]:
    """Those of a family that are asked for, in the order asked for; all if that is None."""
    if names is None:
        return list(known)
    by_name, among = {one.name: one for one in known}, f"in the family {family}"
    return [find_named(kind, by_name, name, among) for name in dict.fromkeys(names)]


def _choose_scenarios(family: str, kind: Described, names: Sequence[str] | None, thesis: bool) -> list[ScenarioFacts]:
    """The scenarios asked for, in the order asked for; with `thesis`, those of the source, in its order."""
    chosen = _choose("scenario", family, kind.scenarios, names)
    if thesis:
        others = [scenario.name for scenario in chosen if scenario.name not in kind.thesis_order]
        if names is not None and others:
            raise InputError(f"not in the thesis: {', '.join(others)}; it has: {', '.join(kind.thesis_order)}")
        wanted = {scenario.name: scenario for scenario in chosen}
        chosen = [wanted[name] for name in kind.thesis_order if name in wanted]
    if not chosen:
        raise InputError("no scenario to run")
    return chosen


def _choose_effort(profile: str, launches: int | None, rounds: int | None, contestants: int) -> Effort:
    """The profile's effort, or another; the default has launches enough for an interval, whoever takes part."""
    effort = EFFORTS[profile]
    for name, count in (("launches", launches), ("rounds", rounds)):
        if count is not None and count < 1:
            raise InputError(f"{name}: {count}; at least one is needed")
        if count not in (None, 1) and profile in ("thesis", "check"):
            raise InputError(f"{name}: the {profile} profile has one")
    if profile in ("default", "rigorous") and launches is None:
        launches = max(effort.launches, fewest_launches(contestants))
    return msgspec.structs.replace(effort, launches=launches or effort.launches, rounds=rounds or effort.rounds)


def _from_here(path: Path) -> str:
    """A file as it is named from the current folder, if it lies below; else its name alone: runs tell nothing of a machine."""
    try:
        return path.relative_to(Path.cwd()).as_posix()
    except ValueError:
        return path.name


def _command(model: str, verb: str, **flags: object) -> str:
    """The command line that asks for the same; a flag that is None, False or empty is left out."""
    words = ["tetrabench", verb, "--model", model]
    for name, value in flags.items():
        if value is None or value is False or value == []:
            continue
        if name in ("option", "plugin"):  # their values are never joined
            words += [word for one in value for word in (f"--{name}", one)]  # type: ignore[attr-defined]
        else:
            words.append(f"--{name}")
            if value is not True:
                words.append(",".join(map(str, value)) if isinstance(value, list | tuple) else str(value))
    return shlex.join(words)


def model_name(asked: str, size: int | None = None, numbering: str = "natural") -> str:
    """What a model is called in a run: by what tells it from others."""
    words = [asked if size is None else f"{asked}-{size}", *([] if numbering == "natural" else [numbering])]
    return " ".join(words)


def model_of(name: str, path: Path, facts: ModelFacts | None = None) -> Model:
    """The record of a model; its digest is that of the file."""
    digest = hashlib.blake2b(digest_size=8)
    with path.open("rb") as file:
        while part := file.read(1 << 20):
            digest.update(part)
    facts = facts or ModelFacts({})
    return Model(name=name, size=dict(facts.size), digest=digest.hexdigest(), notes=list(facts.notes))
