"""The ring: one worker a contestant, all alive, taking turns. While one measures, the others wait.

A ring lasts for one launch, on one model. What a worker's death, silence, exception or refusal means for the run is
decided here:

- it ends the contestant's cell, as "crash", "timeout", "oom", "error" or "unsupported", and no other cell;
- a worker that died is spawned anew before the next task;
- what ends on the small model, while it is warmed, is not measured at all;
- in the thesis profile all scenarios share one net: a bad end skips the remaining cells as well.
"""

import math
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from threading import Lock
from time import perf_counter
from types import TracebackType
from typing import Any, Protocol

import msgspec

from tetrabench.bench.agenda import Agenda, Cell, End, Round
from tetrabench.bench.environment import usable_cores
from tetrabench.bench.messages import (
    Done,
    Failed,
    Load,
    Loaded,
    Measure,
    Measured,
    Open,
    Reply,
    Request,
    Skipped,
    Warm,
)
from tetrabench.bench.plan import Plan
from tetrabench.bench.progress import Progress
from tetrabench.bench.record import Backend, Sample, Task
from tetrabench.bench.spawn import WorkerDied
from tetrabench.errors import InputError, MemoryRefusedError

LONG_S = 0.02
"""A sample repeats its scenario until it is so long, as far as it may."""
MOST_REPEATS = 100
PREPARED_S = 1.0
"""Preparing the repeats of a sample takes no longer than this, if one preparation takes no longer."""


class Worker(Protocol):
    """What the ring asks of a worker: `spawn.WorkerProcess`, or a script in a test."""

    def ask(self, request: Request) -> Reply:
        """Send a request, wait for the reply. Raises WorkerDied."""

    def pin(self, cores: set[int]) -> None:
        """Let it run on these cores alone."""

    def close(self) -> None:
        """Let it end."""

    def kill(self) -> None:
        """End it."""


Spawn = Callable[[Backend], Worker]


class _Seat:
    """A contestant's place in the ring."""

    def __init__(self, backend: Backend) -> None:
        self.name = backend.name
        self.backend = backend
        self.worker: Worker | None = None
        self.compiled = 0  # kernels that its worker had to compile
        self.broken = ""  # why the one net of the thesis profile cannot be used any more

    def learn(self, **facts: Any) -> None:
        """Put down what has become known about the contestant."""
        self.backend = msgspec.structs.replace(self.backend, **facts)


class Ring:
    """Contestants with their workers, for one launch. A context: the workers end with it.

    Attributes:
        seconds: wall time by what it was spent on, see `record.Launch`.
        core: that the workers share in serial tasks.
    """

    def __init__(
        self,
        plan: Plan,
        agenda: Agenda,
        progress: Progress,
        spawn: Spawn,
        *,
        model: str,
        backends: Sequence[Backend],
        launch: int = 0,
        group: int = 0,
    ) -> None:
        self.seconds = dict.fromkeys(("starting", "compiling", "reading", "preparing", "samples", "answers"), 0.0)
        self._plan, self._agenda, self._progress, self._spawn = plan, agenda, progress, spawn
        self._model, self._launch, self._group = model, launch, group
        self._seats = {backend.name: _Seat(backend) for backend in backends}
        self._cores = usable_cores()
        self.core = self._cores[-1 - launch % len(self._cores)]
        self._lock = Lock()  # of what the warming threads share: progress, seconds, and spawning against closing
        self._warmed = self._cells = 0
        self._closed = False

    @property
    def backends(self) -> list[Backend]:
        """The contestants, with what is known of them by now."""
        return [seat.backend for seat in self._seats.values()]

    def __enter__(self) -> "Ring":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is None:
            for worker in self._workers():
                worker.close()
        self._kill()

    def cell(self, task: Task, seat: _Seat) -> Cell:
        """The cell of a contestant."""
        return Cell(self._model, task.name, seat.name)

    # -- before the first sample

    def warm(self) -> None:
        """Spawn all workers, compile or load all kernels, read the model: as many at once as there are cores.

        Raises:
            InputError: the model cannot be used.
            MemoryRefusedError: by nobody, for want of memory.
        """
        begin = perf_counter()
        wanted = {name: tasks for name, seat in self._seats.items() if (tasks := self._tasks_of(seat))}
        self._cells = sum(map(len, wanted.values()))
        with ThreadPoolExecutor(len(self._cores)) as pool:
            starts = [pool.submit(self._start, self._seats[name], wanted[name]) for name in self._in_order(wanted)]
            try:
                for start in starts:
                    start.result()
            except BaseException:
                self._kill()  # the threads find their workers dead, and end
                raise
        passed, worked = perf_counter() - begin, sum(self.seconds.values())
        for kind in self.seconds:  # it went on side by side
            self.seconds[kind] *= passed / worked if worked else 1.0
        self._refuse_if_there_is_no_memory()

    def _in_order(self, names: Iterable[str]) -> list[str]:
        """The first backend of each contestant comes first: it compiles what all others of that contestant load."""
        firsts: dict[tuple[str, str], str] = {}
        for name in names:
            backend = self._seats[name].backend
            firsts.setdefault((backend.contestant, backend.checkout), name)
        return list(dict.fromkeys([*firsts.values(), *names]))

    def _tasks_of(self, seat: _Seat) -> list[Task]:
        """The tasks in which a contestant has turns to come in this launch."""
        return [task for task in self._plan.tasks if any(seat.name in names for names in self._to_come(task))]

    def _to_come(self, task: Task) -> Iterator[list[str]]:
        """Round after round, who has yet to have a turn."""
        names = list(self._seats)
        return (self._agenda.to_come(self._round(task, round), names) for round in range(self._plan.effort.rounds))

    def _round(self, task: Task, round: int) -> Round:
        return Round(self._model, task.name, self._launch, self._group, round)

    def _refuse_if_there_is_no_memory(self) -> None:
        cells = [self.cell(task, seat) for task in self._plan.tasks for seat in self._seats.values()]
        ends = [self._agenda.ends.get(cell) for cell in cells]
        reasons = [end.reason for end in ends if end is not None and end.status == "oom"]
        if not self._agenda.done and len(reasons) == len(cells):  # else what there is shall not be lost
            raise MemoryRefusedError(reasons[0])

    def _start(self, seat: _Seat, tasks: Sequence[Task]) -> None:
        """Give a contestant a worker, warm for these tasks and with the model, or note why it has none."""
        reply = self._open_and_warm(seat, tasks)
        if seat.compiled:  # what the compiler left in memory would count as the contestant's: a new worker
            compile_s = seat.backend.compile_s
            reply = self._open_and_warm(seat, tasks)
            seat.learn(compile_s=compile_s)
        if isinstance(reply, Done):
            reply = self._ask(seat, Load(str(self._plan.models[self._model])), "reading")
        if isinstance(reply, Loaded):
            if reply.structure:
                seat.learn(structure=reply.structure)
        elif isinstance(reply, End):
            for task in tasks:
                if self.cell(task, seat) not in self._agenda.ends:
                    self._agenda.end(
                        self.cell(task, seat), End(reply.status, f"before its first sample: {reply.reason}")
                    )

    def _open_and_warm(self, seat: _Seat, tasks: Sequence[Task]) -> Reply | End:
        reply = self._open(seat)
        while isinstance(reply, Done) and not all(self._warm(seat, task) for task in tasks):
            reply = self._open(seat)  # one of them killed the worker: again, without that one
        return reply

    def _open(self, seat: _Seat) -> Reply | End:
        begin = perf_counter()
        with self._lock:
            if self._closed:
                return End("skipped", "the run is over")
            if seat.worker is not None:
                seat.worker.kill()
            seat.worker = self._spawn(seat.backend)
        self._book("starting", perf_counter() - begin)
        seat.learn(compile_s=0.0)
        seat.compiled = 0
        backend = seat.backend
        request = Open(self._plan.family, backend.contestant, self._plan.chained, options=backend.options)
        return self._ask(seat, request, "starting")

    def _warm(self, seat: _Seat, task: Task) -> bool:
        """Compile what a scenario needs. False: the worker did not survive it."""
        cell = self.cell(task, seat)
        if cell in self._agenda.ends:
            return True
        reply = self._ask(seat, Warm(task.scenario, task.options), "compiling")
        if isinstance(reply, End):
            reason = reply.reason if reply.status == "unsupported" else f"on the small model: {reply.reason}"
            self._agenda.end(cell, End(reply.status, reason))
        elif isinstance(reply, Done):
            seat.learn(compile_s=seat.backend.compile_s + reply.wall_s)
            seat.compiled += reply.compiled
        with self._lock:
            self._warmed += 1
            phase = "compiling" if seat.compiled else "loading what was compiled"
            left = self._agenda.seconds_remaining()
            self._progress.step(
                phase, f"{task.name} for {seat.name}", min(self._warmed, self._cells), self._cells, left
            )
        return seat.worker is not None

    # -- samples

    def measure(self, task: Task) -> Iterator[Sample]:
        """All turns of a task in this launch that are to come, round after round, and what ended before its first."""
        for seat in self._seats.values():
            self._make_ready(seat, task)
        if any(self._to_come(task)) and not self._plan.chained and self._plan.profile != "check":
            self._calibrate(task)
        for seat in self._seats.values():
            if (cell := self.cell(task, seat)) in self._agenda.ends and cell not in self._agenda.told:
                yield self._tell(task, seat, self._agenda.ends[cell])
        names = list(self._seats)
        for round, order in enumerate(self._plan.orders(self._model, task, self._launch, names)):
            place = self._round(task, round)
            for turn, name in enumerate(self._agenda.takers(place, order)):
                if not self._agenda.has_had(place, name):
                    yield self._take_turn(task, self._seats[name], round, turn)
            if round == 0 and self._launch == 0:
                self._agenda.spare_the_hopeless(place)

    def _make_ready(self, seat: _Seat, task: Task) -> None:
        """A new worker for a contestant that has lost its own; and the cores that all share."""
        if seat.broken:
            self._agenda.end(self.cell(task, seat), End("skipped", seat.broken))
        elif seat.worker is None and task in (tasks := self._tasks_of(seat)):
            self._start(seat, tasks[tasks.index(task) :])
        if seat.worker is not None:
            seat.worker.pin(set(self._cores) if task.parallel else {self.core})

    def _calibrate(self, task: Task) -> None:
        """Find out how often a scenario must run in one sample, the same for all: from one run by the reference."""
        place = (self._model, task.name)
        seats = sorted(self._seats.values(), key=lambda seat: seat.name != self._plan.reference)
        for seat in seats:
            cell = self.cell(task, seat)
            if place in self._agenda.repeats or cell in self._agenda.ends or seat.worker is None:
                continue
            self._step(task, seat, 0)
            reply = self._ask(seat, Measure(task.scenario, task.options), "preparing")
            if isinstance(reply, Measured):
                seconds = reply.wall_s if task.parallel else reply.cpu_s
                self._agenda.repeats[place] = find_repeats(seconds, reply.prepare_s)
            elif isinstance(reply, End):
                self._agenda.end(cell, reply)

    def _take_turn(self, task: Task, seat: _Seat, round: int, turn: int) -> Sample:
        self._step(task, seat, round)
        begin = perf_counter()
        repeats = self._agenda.repeats.get((self._model, task.name), 1)
        reply = self._ask(seat, Measure(task.scenario, task.options, repeats))
        seconds = perf_counter() - begin
        if isinstance(reply, Measured):
            for kind, spent in (
                ("preparing", reply.prepare_s),
                ("samples", reply.wall_s),
                ("answers", reply.answer_s),
            ):
                self._book(kind, spent)
            if not seat.backend.structure:  # a stage may build its net when a scenario first asks for one
                seat.learn(structure=reply.structure)
        elif isinstance(reply, End) and self._plan.chained and reply.status != "unsupported":
            seat.broken = f"worker {'failed' if reply.status == 'error' else 'was lost'} in {task.name}"
        sample = self._sample(task, seat, round, turn, reply)
        self._agenda.took(sample, seconds)
        return sample

    def _tell(self, task: Task, seat: _Seat, end: End) -> Sample:
        """The record of a cell that ended otherwise than in its turn."""
        self._agenda.told.add(self.cell(task, seat))
        place = self._round(task, 0)
        rounds = range(self._plan.effort.rounds)
        free = (round for round in rounds if not self._agenda.has_had(place._replace(round=round), seat.name))
        return self._sample(task, seat, next(free, 0), 0, end)

    def _step(self, task: Task, seat: _Seat, round: int) -> None:
        phase = f"launch {self._launch + 1} of {self._plan.effort.launches}"
        left = self._agenda.seconds_remaining()
        detail = f"{task.name}, {seat.name}, round {round + 1}"
        self._progress.step(phase, detail, self._agenda.done, self._agenda.total, left)

    def _sample(self, task: Task, seat: _Seat, round: int, turn: int, reply: Reply | End) -> Sample:
        """The record of a turn, or of a cell that has none."""
        figures: dict[str, Any]
        if isinstance(reply, Measured):
            figures = {"status": "ok", **msgspec.structs.asdict(reply)}
            structure = figures.pop("structure")
            figures["structure_bytes"] = sum(used for used, _ in structure.values())
            figures["reserved_bytes"] = sum(reserved for _, reserved in structure.values())
        else:
            assert isinstance(reply, End), reply
            figures = {"status": reply.status, "reason": reply.reason}
        return Sample(
            model=self._model,
            task=task.name,
            backend=seat.name,
            launch=self._launch,
            group=self._group,
            round=round,
            turn=turn,
            **figures,
        )

    # -- workers

    def _ask(self, seat: _Seat, request: Request, spent_on: str = "") -> Reply | End:
        """What the worker replies, or why that is no figure."""
        assert seat.worker is not None
        begin = perf_counter()
        try:
            reply = seat.worker.ask(request)
        except WorkerDied as death:
            seat.worker = None
            return End(death.status, str(death))
        finally:
            if spent_on:
                self._book(spent_on, perf_counter() - begin)
        match reply:
            case Skipped(reason):
                return End("unsupported", reason)
            case Failed(reason, _, True):
                return End("oom", reason)
            case Failed(reason, exit_code):
                if exit_code and isinstance(request, Open | Load):
                    raise InputError(reason)
                return End("error", reason)
        return reply

    def _book(self, kind: str, seconds: float) -> None:
        with self._lock:
            self.seconds[kind] += seconds

    def _workers(self) -> list[Worker]:
        return [seat.worker for seat in self._seats.values() if seat.worker is not None]

    def _kill(self) -> None:
        """End all workers, and let nobody spawn another."""
        with self._lock:
            self._closed = True
            for worker in self._workers():
                worker.kill()


def find_repeats(run_s: float, prepare_s: float) -> int:
    """How often a sample runs its scenario, where one run and its preparation take so long."""
    wanted = math.ceil(LONG_S / max(run_s, 1e-9))
    affordable = int(PREPARED_S / prepare_s) if prepare_s > 0 else MOST_REPEATS
    return max(1, min(wanted, affordable, MOST_REPEATS))
