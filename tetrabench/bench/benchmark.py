"""A run from plan to results."""

from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from pathlib import Path

from tetrabench.bench.answers import judge
from tetrabench.bench.environment import cpu_ticks, describe_environment
from tetrabench.bench.plan import Plan, make_plan
from tetrabench.bench.progress import Progress, Silence
from tetrabench.bench.record import Results, Sample
from tetrabench.bench.ring import Ring, Worker
from tetrabench.bench.spawn import WorkerProcess


def run(
    model: str | Path,
    *,
    backends: Sequence[str] | None = None,
    scenarios: Sequence[str] | None = None,
    thesis: bool = False,
    quick: bool = False,
    rounds: int | None = None,
    tets: int | None = None,
    numbering: str = "natural",
    seed: int = 0,
    progress: Progress | None = None,
) -> Results:
    """Run scenarios on contestants, check that all give the same answers, and measure what they cost.

    Args: see `plan.make_plan`; `progress` is told what happens.

    Raises:
        InputError: unknown names, or a model that cannot be used.
    """
    plan = make_plan(
        model,
        backends=backends,
        scenarios=scenarios,
        thesis=thesis,
        quick=quick,
        rounds=rounds,
        tets=tets,
        numbering=numbering,
        seed=seed,
    )
    return run_benchmark(plan, progress=progress)


def run_benchmark(
    plan: Plan, *, progress: Progress | None = None, spawn: Callable[[], Worker] | None = None
) -> Results:
    """Carry out a plan. On Ctrl-C the results so far, marked as interrupted. The parent loads no mesh.

    Args:
        plan: what to do.
        progress: is told what happens.
        spawn: makes a worker; a process unless a test says otherwise.

    Raises:
        InputError: the model cannot be used.
    """
    progress = progress or Silence()
    started = datetime.now(UTC).isoformat(timespec="seconds")
    environment = {**describe_environment(), "worker_threads": plan.threads}
    ticks = cpu_ticks()
    samples: list[Sample] = []
    interrupted = False
    ring = Ring(plan, progress, spawn or (lambda: WorkerProcess(plan.threads)))
    progress.started(plan)
    try:
        with ring:
            ring.warm()
            for task in plan.tasks:
                for sample in ring.measure(task):
                    samples.append(sample)
    except KeyboardInterrupt:
        interrupted = True
    return Results(
        command=plan.command,
        profile="thesis" if plan.chained else "default",
        family=plan.family,
        model=plan.model,
        model_size=ring.model_size,
        options={task.scenario: task.options for task in plan.tasks},
        reference=plan.reference,
        seed=plan.seed,
        started=started,
        environment={**environment, "steal_share": _steal_share(ticks, cpu_ticks())},
        backends=ring.backends,
        samples=judge(samples),
        interrupted=interrupted,
    )


def exit_code(results: Results) -> int:
    """0 all well, 3 a cell crashed, failed or was wrong, 130 interrupted."""
    if results.interrupted:
        return 130
    return 0 if all(sample.status in ("ok", "skipped") for sample in results.samples) else 3


def _steal_share(before: tuple[int, int] | None, after: tuple[int, int] | None) -> float | None:
    """Share of the machine's time that other guests of the host took during the run."""
    if before is None or after is None or before[1] == after[1]:
        return None
    return (after[0] - before[0]) / (after[1] - before[1])
