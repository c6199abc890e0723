"""Whether a contestant does what its family asks of it: each rule in plain Python, with bounds checks, and compiled.

Whatever it does there, it does in a worker: a crash and an endless loop are sentences like any other. Plain Python comes first,
for its words are the clearest, and what it finds wrong is not tried compiled, where it might only crash. In the end the
scenarios run on the family's small model, compiled, and their answers are compared with those of the reference.
"""

import tempfile
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any

import msgspec

from tetrabench.bench.catalogue import Guide, Inquiry
from tetrabench.bench.examination import place_of
from tetrabench.bench.messages import (
    Described,
    Done,
    Examine,
    Examined,
    Failed,
    Measure,
    Measured,
    Open,
    Reply,
    Request,
    RuleFacts,
    ScenarioFacts,
    Skipped,
    Warm,
)
from tetrabench.bench.spawn import WorkerDied, WorkerProcess
from tetrabench.errors import find_named

PLAIN, CHECKED, COMPILED = "plain Python", "with bounds checks", "compiled"
MODES: Mapping[str, Mapping[str, str]] = {
    PLAIN: {"NUMBA_DISABLE_JIT": "1"},
    CHECKED: {"NUMBA_DISABLE_JIT": "0", "NUMBA_BOUNDSCHECK": "1"},
    COMPILED: {"NUMBA_DISABLE_JIT": "0", "NUMBA_BOUNDSCHECK": "0"},
}
"""In this order: what is set in the environment of a worker."""

SCENARIO = "scenario "
"""With a name behind it: what a verdict on its answer has for a rule."""

SOUND, FAULTY, NOT_TRIED = "sound", "faulty", "not tried"
TIMEOUT_S = 300.0

Step = Callable[[str, str, int, int], None]
"""Is told what happens: phase, detail, how many are done of how many."""


class Verdict(msgspec.Struct, frozen=True, kw_only=True):
    """What came out of one rule in one mode, or of one scenario.

    Attributes:
        rule: its name; "scenario NAME" for an answer that is compared with the reference's.
        title: what must be so.
        mode: one of MODES.
        status: SOUND, FAULTY, or NOT_TRIED, because of what was found before.
        faults: what is wrong, a sentence each.
        note: why it was not tried, where that is not because of what was found before.
        wall_s: how long that took, compiling included, in seconds.
    """

    contestant: str
    rule: str
    title: str
    mode: str
    status: str
    faults: list[str] = []
    note: str = ""
    wall_s: float = 0.0


def check_contestant(name: str, family: str = "tetra", *, timeout_s: float = TIMEOUT_S) -> list[Verdict]:
    """Examine a contestant by all rules of its family, in workers; one to three minutes where all has to be compiled.

    Args:
        timeout_s: of one rule in one mode.

    Raises:
        InputError: there is no such family, or none of that name in it.
    """
    with Inquiry() as guide:
        return list(examine(family, name, guide=guide, timeout_s=timeout_s))


def examine(
    family: str, contestant: str, *, guide: Guide, timeout_s: float = TIMEOUT_S, step: Step = lambda *_: None
) -> Iterator[Verdict]:
    """All verdicts on a contestant, as they come.

    Raises:
        InputError: there is no such family, or none of that name in it.
    """
    known = guide.describe(family)
    find_named("backend", {one.name: one for one in known.contestants}, contestant, f"in the family {family}")
    with tempfile.TemporaryDirectory() as folder:
        examiner = _Examiner(family, contestant, known, Path(folder) / "notes", timeout_s, step)
        is_sound = True
        for mode in MODES:
            for verdict in examiner.rules(mode, is_tried=is_sound):
                is_sound &= verdict.status != FAULTY
                yield verdict
        yield from examiner.scenarios(is_tried=is_sound)


class _Examiner:
    """Examines one contestant."""

    def __init__(
        self, family: str, contestant: str, known: Described, notes: Path, timeout_s: float, step: Step
    ) -> None:
        self._family, self._contestant, self._known = family, contestant, known
        self._notes, self._timeout_s, self._step = notes, timeout_s, step
        self._done, self._total = 0, len(MODES) * len(known.rules) + len(known.scenarios)

    def rules(self, mode: str, *, is_tried: bool) -> Iterator[Verdict]:
        """The verdicts of all rules in a mode."""
        with self._worker(self._contestant, MODES[mode]) as worker:
            for rule in self._known.rules:
                self._tell(mode, rule.name)
                if not is_tried:
                    yield self._verdict(rule.name, rule.title, mode, NOT_TRIED)
                    continue
                begin = perf_counter()
                faults = self._faults(worker, rule)
                status = FAULTY if faults else SOUND
                is_tried = not (faults and rule.essential)
                yield self._verdict(rule.name, rule.title, mode, status, faults, perf_counter() - begin)

    def scenarios(self, *, is_tried: bool) -> Iterator[Verdict]:
        """Whether the answers to all scenarios are the reference's."""
        reference = self._known.reference
        title = f"those of {reference}, bit by bit"
        with (
            self._worker(self._contestant, MODES[COMPILED]) as ours,
            self._worker(reference, MODES[COMPILED]) as theirs,
        ):
            for scenario in self._known.scenarios:
                self._tell("scenarios", scenario.name)
                name = f"{SCENARIO}{scenario.name}"
                if not is_tried:
                    yield self._verdict(name, title, COMPILED, NOT_TRIED)
                    continue
                begin, fault, note = perf_counter(), "", ""
                own = _answer(ours, scenario)
                if isinstance(own, Failure):
                    fault = f"{name}: {own.reason}"
                elif isinstance(own, Skipped):
                    note = own.reason
                elif isinstance(wanted := _answer(theirs, scenario), Failure | Skipped):
                    note = f"{reference}, which tells what is right, has no answer: {wanted.reason}"
                elif own != wanted:
                    fault = f"digest of {name} on the small model is {own}, that of {reference} {wanted}"
                status = FAULTY if fault else NOT_TRIED if note else SOUND
                faults = [fault] if fault else []
                yield self._verdict(name, title, COMPILED, status, faults, perf_counter() - begin, note)

    def _faults(self, worker: "_Immortal", rule: RuleFacts) -> list[str]:
        self._notes.unlink(missing_ok=True)
        reply = worker.ask(Examine(rule.name, str(self._notes), 0.9 * self._timeout_s))
        if isinstance(reply, Examined):
            return reply.faults
        if isinstance(reply, WorkerDied):
            ended = "it does not come to an end" if reply.status == "timeout" else f"the process ended with {reply}"
            return [f"rule {rule.name}: {ended}{place_of(self._notes)}"]
        return [f"rule {rule.name}: {_reason(reply)}"]

    def _worker(self, contestant: str, environment: Mapping[str, str]) -> "_Immortal":
        def spawn() -> WorkerProcess:
            return WorkerProcess(environment=environment, timeout_s=self._timeout_s)

        return _Immortal(spawn, Open(self._family, contestant))

    def _tell(self, phase: str, detail: str) -> None:
        self._step(f"{self._contestant}, {phase}", detail, self._done, self._total)
        self._done += 1

    def _verdict(
        self,
        rule: str,
        title: str,
        mode: str,
        status: str,
        faults: list[str] | None = None,
        wall_s: float = 0.0,
        note: str = "",
    ) -> Verdict:
        return Verdict(
            contestant=self._contestant,
            rule=rule,
            title=title,
            mode=mode,
            status=status,
            faults=faults or [],
            note=note,
            wall_s=wall_s,
        )


class _Immortal:
    """A worker with a contestant, spawned when it is first asked, and anew after it died. A context: it ends with it."""

    def __init__(self, spawn: Callable[[], WorkerProcess], first: Open) -> None:
        self._spawn, self._first = spawn, first
        self._worker: WorkerProcess | None = None

    def __enter__(self) -> "_Immortal":
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: Any) -> None:
        if self._worker is not None and kind is None:
            self._worker.close()
        elif self._worker is not None:  # somebody gave up: it may be in the midst of what does not end
            self._worker.kill()

    def ask(self, request: Request) -> Reply | WorkerDied:
        """The reply, or how the worker died over it."""
        try:
            if self._worker is None:
                self._worker = self._spawn()
                opened = self._worker.ask(self._first)
                if not isinstance(opened, Done):
                    return opened
            return self._worker.ask(request)
        except WorkerDied as death:
            if self._worker is not None:
                self._worker.kill()
            self._worker = None
            return death


@dataclass(frozen=True)
class Failure:
    """How a scenario ended badly."""

    reason: str


def _answer(worker: _Immortal, scenario: ScenarioFacts) -> str | Skipped | Failure:
    """The digest on the small model, or why there is none."""
    reply = worker.ask(Warm(scenario.name, scenario.options))
    if isinstance(reply, Done):
        reply = worker.ask(Measure(scenario.name, scenario.options))
    if isinstance(reply, Measured):
        return reply.digest
    return reply if isinstance(reply, Skipped) else Failure(_reason(reply))


def _reason(reply: Reply | WorkerDied) -> str:
    if isinstance(reply, WorkerDied):
        return f"the process ended with {reply}"
    return reply.reason if isinstance(reply, Failed) else f"a strange reply, {type(reply).__name__}"
