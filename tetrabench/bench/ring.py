"""The ring: one worker a contestant, all alive, taking turns. While one measures, the others wait.

What a worker's death, exception or refusal means for the run is decided here:

- it ends the contestant's cell, as "crash", "error" or "skipped", and no other cell;
- a worker that died is spawned anew before the next scenario;
- what ends on the small model, while it is warmed, is not measured at all;
- in the thesis profile all scenarios share one net: a crash or an error skips the remaining cells as well.
"""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from threading import Lock
from time import perf_counter
from types import TracebackType
from typing import Any, NamedTuple, Protocol

import msgspec

from tetrabench.bench.agenda import Agenda
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
from tetrabench.bench.plan import Plan, Task
from tetrabench.bench.progress import Progress
from tetrabench.bench.record import Backend, Sample
from tetrabench.bench.spawn import WorkerDied
from tetrabench.errors import InputError, MemoryRefusedError

HOPELESS = 10.0
"""A contestant that takes so many times the reference's CPU time in the first round gets fewer rounds."""


class Worker(Protocol):
    """What the ring asks of a worker: `spawn.WorkerProcess`, or a script in a test."""

    def ask(self, request: Request) -> Reply:
        """Send a request, wait for the reply. Raises WorkerDied."""

    def pin(self, core: int) -> None:
        """Let it run on this core alone."""

    def close(self) -> None:
        """Let it end."""

    def kill(self) -> None:
        """End it."""


class End(NamedTuple):
    """Why a cell has no figures, or no more of them: a status of `record.Sample`, and the reason."""

    status: str
    reason: str


class _Seat:
    """A contestant's place in the ring."""

    def __init__(self, backend: Backend) -> None:
        self.name = backend.name
        self.backend = backend
        self.worker: Worker | None = None
        self.ends: dict[str, End] = {}  # by scenario
        self.ready_s = 0.0  # from the start of the worker until it has its model
        self.compiled = 0  # kernels that its worker had to compile
        self.broken = ""  # why the one net of the thesis profile cannot be used any more

    def learn(self, **facts: Any) -> None:
        """Put down what has become known about the contestant."""
        self.backend = msgspec.structs.replace(self.backend, **facts)


class Ring:
    """All contestants of a plan, each with its worker. A context: the workers end with it.

    Attributes:
        model_size: how large the model is, once a worker has seen it.
    """

    def __init__(self, plan: Plan, progress: Progress, spawn: Callable[[], Worker]) -> None:
        self.model_size: dict[str, int] = {}
        self._plan = plan
        self._progress = progress
        self._spawn = spawn
        self._seats = {backend.name: _Seat(backend) for backend in plan.backends}
        self._agenda = Agenda(plan)
        self._cores = usable_cores()
        self._lock = Lock()  # of what the warming threads share: progress, and spawning against closing
        self._warmed = 0
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

    # -- before the first sample

    def warm(self) -> None:
        """Spawn all workers, compile all kernels, read the model: as many at once as there are cores.

        Raises:
            InputError: the model cannot be used.
        """
        with ThreadPoolExecutor(len(self._cores)) as pool:
            starts = [pool.submit(self._start, seat, self._plan.tasks) for seat in self._seats.values()]
            try:
                for start in starts:
                    start.result()
            except BaseException:
                self._kill()  # the threads find their workers dead, and end
                raise

    def _start(self, seat: _Seat, tasks: Sequence[Task]) -> None:
        """Give a contestant a worker, warm for these tasks and with the model, or note why it has none."""
        start = perf_counter()
        reply = self._open_and_warm(seat, tasks)
        if seat.compiled:  # what the compiler left in memory would count as the contestant's: a new worker
            compile_s, start = seat.backend.compile_s, perf_counter()
            reply = self._open_and_warm(seat, tasks)
            seat.learn(compile_s=compile_s)
        if isinstance(reply, Done):
            reply = self._ask(seat, Load(str(self._plan.path)))
        if isinstance(reply, Loaded):
            self.model_size = reply.model_size
            seat.ready_s = perf_counter() - start
            seat.learn(structure=reply.structure)
        elif isinstance(reply, End):
            for task in tasks:
                seat.ends.setdefault(task.scenario, End(reply.status, f"before its first sample: {reply.reason}"))

    def _open_and_warm(self, seat: _Seat, tasks: Sequence[Task]) -> Reply | End:
        reply = self._open(seat)
        while isinstance(reply, Done) and not all(self._warm(seat, task) for task in tasks):
            reply = self._open(seat)  # one of them killed the worker: again, without that one
        return reply

    def _open(self, seat: _Seat) -> Reply | End:
        with self._lock:
            if self._closed:
                return End("skipped", "the run is over")
            if seat.worker is not None:
                seat.worker.kill()
            seat.worker = self._spawn()
        seat.learn(compile_s=0.0)
        seat.compiled = 0
        return self._ask(seat, Open(self._plan.family, seat.name, self._plan.chained))

    def _warm(self, seat: _Seat, task: Task) -> bool:
        """Compile what a scenario needs. False: the worker did not survive it."""
        if task.scenario in seat.ends:
            return True
        reply = self._ask(seat, Warm(task.scenario, task.options))
        if isinstance(reply, End):
            reason = reply.reason if reply.status == "skipped" else f"on the small model: {reply.reason}"
            seat.ends[task.scenario] = End(reply.status, reason)
        elif isinstance(reply, Done):
            seat.learn(compile_s=seat.backend.compile_s + reply.wall_s)
            seat.compiled += reply.compiled
        with self._lock:
            self._warmed += 1
            cells = len(self._seats) * len(self._plan.tasks)
            self._progress.step(f"compiled {task.scenario} for {seat.name}", min(self._warmed, cells), cells, None)
        return seat.worker is not None

    # -- samples

    def measure(self, task: Task) -> Iterator[Sample]:
        """All turns of a scenario, round after round."""
        for seat in self._seats.values():
            self._make_ready(seat, task)
            if task.scenario in seat.ends:
                self._close_cell(task, seat, seat.ends[task.scenario])
                yield self._sample(task, seat, 0, 0, seat.ends[task.scenario])
        for round, order in enumerate(self._plan.orders(task)):
            samples = []
            for turn, name in enumerate(name for name in order if self._agenda.left(task.scenario, name)):
                samples.append(self._take_turn(task, self._seats[name], round, turn))
                yield samples[-1]
            if round == 0:
                self._spare_the_hopeless(task, samples)

    def _make_ready(self, seat: _Seat, task: Task) -> None:
        """A new worker for a contestant that has lost its own; and the one core that all share."""
        if seat.broken:
            seat.ends.setdefault(task.scenario, End("skipped", seat.broken))
        elif seat.worker is None and task.scenario not in seat.ends:
            tasks = self._plan.tasks
            self._start(seat, tasks[tasks.index(task) :])
        if seat.worker is not None and self._plan.threads == 1:
            seat.worker.pin(self._cores[-1])

    def _take_turn(self, task: Task, seat: _Seat, round: int, turn: int) -> Sample:
        agenda = self._agenda
        text = f"{task.scenario}: {seat.name}, round {round + 1}"
        self._progress.step(text, agenda.done, agenda.total, agenda.seconds_remaining())
        start = perf_counter()
        reply = self._ask(seat, Measure(task.scenario, task.options))
        agenda.took(task.scenario, seat.name, perf_counter() - start)
        if isinstance(reply, Measured):
            self._learn_from(seat, reply)
        elif isinstance(reply, End):
            self._close_cell(task, seat, reply)
        return self._sample(task, seat, round, turn, reply)

    def _learn_from(self, seat: _Seat, reply: Measured) -> None:
        if not seat.backend.first_sample_s:
            seat.learn(first_sample_s=seat.ready_s + reply.prepare_s)
        if not seat.backend.structure:  # a stage may build its net when a scenario first asks for one
            seat.learn(structure=reply.structure)

    def _close_cell(self, task: Task, seat: _Seat, end: End) -> None:
        self._agenda.limit(task.scenario, seat.name, 0)
        if self._plan.chained and end.status != "skipped":
            seat.broken = f"worker {'crashed' if end.status == 'crash' else 'failed'} in {task.scenario}"

    def _spare_the_hopeless(self, task: Task, samples: list[Sample]) -> None:
        cpu_s = {sample.backend: sample.cpu_s for sample in samples if sample.cpu_s is not None}
        for name, seconds in cpu_s.items():
            if seconds > HOPELESS * cpu_s.get(self._plan.reference, seconds):
                self._agenda.limit(task.scenario, name, self._plan.effort.hopeless_rounds - 1)

    def _sample(self, task: Task, seat: _Seat, round: int, turn: int, reply: Reply | End) -> Sample:
        """The record of a turn, or of a cell that has none."""
        figures: dict[str, Any]
        if isinstance(reply, Measured):
            figures = {"status": "ok", **msgspec.structs.asdict(reply)}
            structure = figures.pop("structure")
            figures["structure_bytes"] = sum(used for used, _ in structure.values())
            figures["reserved_bytes"] = sum(reserved for _, reserved in structure.values())
            del figures["prepare_s"]
        else:
            assert isinstance(reply, End), reply
            figures = {"status": reply.status, "reason": reply.reason}
        plan = self._plan
        return Sample(
            family=plan.family,
            model=plan.model,
            scenario=task.scenario,
            backend=seat.name,
            round=round,
            turn=turn,
            **figures,
        )

    # -- workers

    def _ask(self, seat: _Seat, request: Request) -> Reply | End:
        """What the worker replies, or why that is no figure."""
        assert seat.worker is not None
        try:
            reply = seat.worker.ask(request)
        except WorkerDied as death:
            seat.worker = None
            return End("crash", str(death))
        match reply:
            case Skipped(reason):
                return End("skipped", reason)
            case Failed(reason, exit_code):
                if exit_code and isinstance(request, Open | Load):
                    kind = MemoryRefusedError if exit_code == MemoryRefusedError.exit_code else InputError
                    raise kind(reason)
                return End("error", reason)
        return reply

    def _workers(self) -> list[Worker]:
        return [seat.worker for seat in self._seats.values() if seat.worker is not None]

    def _kill(self) -> None:
        """End all workers, and let nobody spawn another."""
        with self._lock:
            self._closed = True
            for worker in self._workers():
                worker.kill()
