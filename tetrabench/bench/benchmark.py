"""A run from plan to results: the memory pass, then launch after launch."""

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path
from time import perf_counter

import msgspec

from tetrabench.bench.agenda import Agenda, Cell, Round
from tetrabench.bench.answers import judge
from tetrabench.bench.environment import cpu_ticks, describe_environment, load, steal_share, usable_cores
from tetrabench.bench.groups import make_groups
from tetrabench.bench.journal import Journal, finish, open_journal
from tetrabench.bench.memory import WEIGHING
from tetrabench.bench.memory_pass import weigh
from tetrabench.bench.messages import Gauge, Gauged
from tetrabench.bench.plan import Plan, make_plan, model_of
from tetrabench.bench.progress import Progress, Silence
from tetrabench.bench.record import Backend, Launch, Memory, Results, Yardsticks, save_results
from tetrabench.bench.ring import Ring, Spawn, Worker
from tetrabench.bench.spawn import WorkerDied, WorkerProcess
from tetrabench.bench.statistics import BAD, summary
from tetrabench.memory import available_bytes

GAUGED = 2
"""Launches that begin with measuring the machine: cores alternate, so that two may be seen."""


def run(
    model: str | Path | None = None,
    *,
    family: str = "tetra",
    backends: Sequence[str] | None = None,
    scenarios: Sequence[str] | None = None,
    profile: str = "default",
    tets: Sequence[int] | int | None = None,
    numbering: Sequence[str] | str = "natural",
    seed: int = 0,
    output: Path | None = None,
    progress: Progress | None = None,
) -> Results:
    """Run scenarios on contestants, check that all give the same answers, and measure what they cost.

    Args: see `plan.make_plan` and `run_benchmark`.

    Raises:
        InputError: unknown names, or a model that cannot be used.
        MemoryRefusedError: the model is too large for the memory that there is.
    """
    plan = make_plan(
        model,
        family=family,
        backends=backends,
        scenarios=scenarios,
        profile=profile,
        tets=[tets] if isinstance(tets, int) else tets,
        numberings=[numbering] if isinstance(numbering, str) else numbering,
        seed=seed,
    )
    return run_benchmark(plan, progress=progress, output=output)


@dataclass(frozen=True)
class Means:
    """What a run needs beside its plan; a test brings its own.

    Attributes:
        spawn: makes a worker for a backend.
        weigh: makes one whose memory will be looked at.
        clock: seconds, for the budget.
    """

    spawn: Spawn
    weigh: Spawn
    clock: Callable[[], float] = perf_counter


def real_means(plan: Plan) -> Means:
    """Workers in processes of their own."""

    def spawn(backend: Backend) -> Worker:
        return WorkerProcess(plan.threads, checkout=plan.checkouts.get(backend.checkout), timeout_s=plan.timeout_s)

    def weigh(backend: Backend) -> Worker:
        checkout = plan.checkouts.get(backend.checkout)
        return WorkerProcess(1, checkout=checkout, timeout_s=plan.timeout_s, environment=WEIGHING)

    return Means(spawn, weigh)


def run_benchmark(
    plan: Plan,
    *,
    progress: Progress | None = None,
    output: Path | None = None,
    resume: bool = False,
    means: Means | None = None,
) -> Results:
    """Carry out a plan. On Ctrl-C the results so far. The parent loads no mesh.

    Args:
        plan: what to do.
        progress: is told what happens.
        output: where to save the results; meanwhile a journal lies there, see `journal`.
        resume: go on with the run whose journal lies there.
        means: how.

    Raises:
        InputError: the model cannot be used; the results cannot be written; there is nothing to resume.
        MemoryRefusedError: the model is too large for the memory that there is.
    """
    blank = Results(
        command=plan.command,
        profile=plan.profile,
        family=plan.family,
        models=[model_of(name, path, plan.facts.get(name)) for name, path in plan.models.items()],
        tasks=list(plan.tasks),
        backends=list(plan.backends),
        reference=plan.reference,
        effort=plan.effort,
        seed=plan.seed,
        titles=list(plan.titles),
        started=_now(),
        environment={**describe_environment(), "worker_threads": plan.threads},
    )
    with open_journal(blank, output, resume=resume) as journal:
        run = _Run(plan, journal, progress or Silence(), means or real_means(plan))
        results = run.carry_out()
        if output is not None:
            save_results(results, output)
            if not results.ended:
                finish(output)
    return results


class _Run:
    """A run while it goes on."""

    def __init__(self, plan: Plan, journal: Journal, progress: Progress, means: Means) -> None:
        self.plan, self.journal, self.progress, self.means = plan, journal, progress, means
        self.agenda = Agenda(plan)
        self.agenda.resume(journal.run.samples)
        self.began = means.clock()
        self.launches: list[float] = []  # how long each took
        self.weighers: list[Worker] = []
        self.is_weighing = True

    def carry_out(self) -> Results:
        """All of it, or as much as there is time for."""
        self.progress.started(self.plan)
        ended = ""
        try:
            if self.plan.has_memory:
                self._weigh_all()
            for launch in range(self.plan.effort.launches):
                if not all(self._is_done(model, launch) for model in self.plan.models):
                    if not self._has_time():
                        ended = "budget"
                        break
                    begin = self.means.clock()
                    for model in self._turns(launch):
                        self._launch(model, launch)
                    self.launches.append(self.means.clock() - begin)
                self._close_narrow_cells(launch)
        except KeyboardInterrupt:
            ended = "interrupted"
        run = self.journal.run
        return msgspec.structs.replace(
            run,
            samples=judge(run.samples, run.backends),
            elapsed_s=self.means.clock() - self.began,
            ended=ended,
        )

    def _turns(self, launch: int) -> list[str]:
        """The models in the order of a launch: each begins as often as any other."""
        models = list(self.plan.models)
        first = launch % len(models)
        return models[first:] + models[:first]

    def _has_time(self) -> bool:
        """Whether another launch fits into the budget; the first one always does."""
        if self.plan.budget_s is None or not self.launches:
            return True
        expected = self.launches[-1]  # the first may have compiled
        return self.means.clock() - self.began + expected <= self.plan.budget_s

    # -- memory

    def _weigh_all(self) -> None:
        """The memory pass: each contestant in a process of its own, as many at once as there are cores."""
        known = {(one.model, one.backend) for one in self.journal.run.memory}
        left = [
            (model, backend)
            for model in self.plan.models
            for backend in self.plan.backends
            if not backend.control and (model, backend.name) not in known
        ]
        with ThreadPoolExecutor(len(usable_cores())) as pool:
            try:
                passes = pool.map(self._weigh, left)
                for done, ((model, backend), memory) in enumerate(zip(left, passes, strict=True), 1):
                    self.progress.step("weighing", f"{backend.name} with {model}", done, len(left), None)
                    self.journal.write(memory)
            except BaseException:
                self.is_weighing = False
                pool.shutdown(wait=False, cancel_futures=True)
                for worker in self.weighers:  # the threads find them dead, and end
                    worker.kill()
                raise

    def _weigh(self, place: tuple[str, Backend]) -> Memory:
        model, backend = place

        def spawn() -> Worker:
            worker = self.means.weigh(backend)
            self.weighers.append(worker)
            if not self.is_weighing:
                worker.kill()
            return worker

        return weigh(spawn, self.plan.family, backend, model, self.plan.models[model])

    # -- launches

    def _launch(self, model: str, launch: int) -> None:
        """All tasks on one model with a fresh set of workers, group by group."""
        for number, group in enumerate(self._groups(model)):
            if not self._is_wanted(model, launch, number, group):
                continue
            begun, begin, ticks = _now(), self.means.clock(), cpu_ticks()
            ring = Ring(
                self.plan,
                self.agenda,
                self.progress,
                self.means.spawn,
                model=model,
                backends=group,
                launch=launch,
                group=number,
            )
            with ring:
                yardsticks = self._gauge(ring, launch)
                ready = self.means.clock()
                ring.warm()
                self.agenda.launched(self.means.clock() - ready)
                self._learn(ring, model, launch)
                for task in self.plan.tasks:
                    for sample in ring.measure(task):
                        self.journal.write(sample)
                self._learn(ring, model, launch)
                gauging = ready - begin
            elapsed = self.means.clock() - begin
            seconds = {**ring.seconds, "yardsticks": gauging}
            seconds["waiting"] = max(0.0, elapsed - sum(seconds.values()))
            self.journal.write(
                Launch(
                    model=model,
                    launch=launch,
                    group=number,
                    core=ring.core,
                    begun=begun,
                    load_1_minute=load(),
                    steal_share=steal_share(ticks, cpu_ticks()),
                    yardsticks=yardsticks,
                    seconds=seconds,
                )
            )

    def _groups(self, model: str) -> list[list[Backend]]:
        weighed = [one for one in self.journal.run.memory if one.model == model]
        return make_groups(self.journal.run.backends, weighed, available_bytes())

    def _is_done(self, model: str, launch: int) -> bool:
        """Whether a launch has nothing to do: all is over, or was done by an earlier run, which this one resumes."""
        return not any(
            self._is_wanted(model, launch, number, group) for number, group in enumerate(self._groups(model))
        )

    def _is_wanted(self, model: str, launch: int, number: int, group: Sequence[Backend]) -> bool:
        """Whether somebody of a group has a turn to come in a launch."""
        names = [backend.name for backend in group]
        return any(
            self.agenda.to_come(Round(model, task.name, launch, number, round), names)
            for task in self.plan.tasks
            for round in range(self.plan.effort.rounds)
        )

    def _learn(self, ring: Ring, model: str, launch: int) -> None:
        """Write down what has become known about the contestants."""
        run = self.journal.run
        if launch == 0 and model == next(iter(self.plan.models)):
            for backend in ring.backends:
                if backend not in run.backends:
                    self.journal.write(backend)

    def _gauge(self, ring: Ring, launch: int) -> Yardsticks | None:
        """What the launch's core can do, in one of the first launches; None where its worker fails."""
        if not self.plan.has_yardsticks or launch >= GAUGED:
            return None
        worker = self.means.spawn(self.plan.backends[0])
        try:
            worker.pin({ring.core})
            reply = worker.ask(Gauge())
            worker.close()
        except WorkerDied:
            return None
        finally:
            worker.kill()
        return reply.yardsticks if isinstance(reply, Gauged) else None

    def _close_narrow_cells(self, launch: int) -> None:
        """End the cells whose interval is narrow enough after this launch."""
        if not self.plan.effort.narrow:
            return
        samples = [one for one in self.journal.run.samples if one.launch <= launch]
        for row in summary(msgspec.structs.replace(self.journal.run, samples=samples)):
            has_interval = row.verdict in ("faster", "slower", "same", "inconclusive") and not row.is_bound
            if has_interval and row.low and row.high and row.high / row.low - 1 < self.plan.effort.narrow:
                self.agenda.close(Cell(row.model, row.task, row.backend))


def exit_code(results: Results) -> int:
    """0 all well, 3 a cell crashed, failed or was wrong, 130 interrupted."""
    if results.ended == "interrupted":
        return 130
    has_bad_memory = any(one.status != "ok" or not one.is_accounted for one in results.memory)
    return 3 if has_bad_memory or any(row.verdict in BAD for row in summary(results)) else 0


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
