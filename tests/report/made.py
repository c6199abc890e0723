"""Results made by hand, from the source's own times: tables and charts then show what it says."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import msgspec

from tetrabench.bench.record import Backend, Effort, Launch, Memory, Model, Results, Sample, Task, Yardsticks

LAYOUTS = {"v3": "property arrays", "v4": "linked nodes", "v5": "array of records"}
SLOTS = {"": "sorted list of holes", "x": "flag + scan", "y": "flag + list"}
SECONDS = {  # Thesis (Győr 2011), figure 10; v5y's init is missing there
    "init": {"v3": 4.68, "v3x": 4.68, "v3y": 4.62, "v4": 4.68, "v5": 4.70, "v5x": 4.76, "v5y": 4.70},
    "delete": {"v3": 64.03, "v3x": 0.09, "v3y": 0.09, "v4": 0.11, "v5": 63.82, "v5x": 0.09, "v5y": 0.10},
    "explode": {"v3": 2.06, "v3x": 58.5, "v3y": 2.12, "v4": 2.22, "v5": 2.19, "v5x": 421.0, "v5y": 2.26},
    "alfa": {"v3": 39.71, "v3x": 34.88, "v3y": 35.69, "v4": 67.5, "v5": 63.08, "v5x": 63.3, "v5y": 64.36},
    "flow": {"v3": 66.46, "v3x": 59.26, "v3y": 61.33, "v4": 93.65, "v5": 90.94, "v5x": 88.74, "v5y": 91.01},
    "free": {"v3": 0.35, "v3x": 0.35, "v3y": 0.35, "v4": 1.21, "v5": 0.35, "v5x": 0.35, "v5y": 0.36},
}
TETRAS, POINTS = 642_720, 112_339
REFERENCE = "v3y"
WOBBLE = (-1.0, 1.0, -0.5, 0.5, 0.0, 0.0, -0.25, 0.25)
"""How far each launch is off, as a share of `wobble`: symmetric, so that medians are as given."""

Seconds = Mapping[str, Mapping[str, float]]


def make_results(
    seconds: Seconds = SECONDS,
    *,
    launches: int = 8,
    rounds: int = 3,
    wobble: float = 0.02,
    model: str = "nozzle",
    tetras: int = TETRAS,
    **changes: Any,
) -> Results:
    """A run in which all went well: `seconds` by task and contestant, each launch off by `wobble` at most.

    The machine is as slow again in the last launch as in the first, for all alike; a control runs along.
    """
    names = list(dict.fromkeys(name for times in seconds.values() for name in times))
    facts: dict[str, Any] = {
        "command": "tetrabench run --model nozzle",
        "profile": "default",
        "family": "tetra",
        "models": [Model(name=model, size={"tetras": tetras, "points": POINTS}, digest=f"{tetras:016x}")],
        "tasks": [Task(name=task, scenario=task.split(" ")[0], options=_options(task)) for task in seconds],
        "backends": [*map(make_backend, names), make_control()],
        "reference": REFERENCE,
        "effort": Effort(launches=launches, rounds=rounds, hopeless_rounds=3),
        "seed": 0,
        "titles": [make_backend(name).title for name in SECONDS["init"]],
        "started": "2011-05-01T12:00:00+00:00",
        "elapsed_s": 1000.0,
        "environment": {"processor": "Intel Core2 T6400", "cores": 2, "system": "Linux", "python": "3.11.7"},
        "launches": [make_launch(launch, model=model) for launch in range(launches)],
        "memory": [make_memory(name, model=model) for name in names],
        "samples": [
            make_sample(task, name, launch, round, slow * times[of], model=model, items=tetras)
            for task, times in seconds.items()
            for launch in range(launches)
            for round in range(rounds)
            for name, of, slow in _turns(times, launch, round, launches, wobble)
        ],
    }
    return Results(**{**facts, **changes})


def make_sweep(seconds: Seconds, exponents: Mapping[str, float], sizes: Sequence[int], **choices: Any) -> Results:
    """A run over several sizes: `seconds` are those of the first, and grow as the contestant's exponent says."""
    runs = [
        make_results(
            {
                task: {name: time * (size / sizes[0]) ** exponents[name] for name, time in times.items()}
                for task, times in seconds.items()
            },
            model=f"nozzle-{size}",
            tetras=size,
            **choices,
        )
        for size in sizes
    ]
    joined = {
        part: [one for run in runs for one in getattr(run, part)]
        for part in ("models", "launches", "memory", "samples")
    }
    return msgspec.structs.replace(runs[0], **joined, elapsed_s=sum(run.elapsed_s for run in runs))


def make_backend(name: str, **changes: Any) -> Backend:
    """A contestant as it took part."""
    slots = "no holes" if name == "v4" else SLOTS.get(name[2:], "other slots")
    facts: dict[str, Any] = {
        "contestant": name,
        "title": f"{LAYOUTS.get(name[:2], 'another layout')}, {slots}",
        "against": REFERENCE,
        "compile_s": 1.5,
        "structure": _structure(name),
    }
    return Backend(name=name, **{**facts, **changes})


def make_control(of: str = REFERENCE) -> Backend:
    """The second copy of the reference."""
    return make_backend(f"{of} control", contestant=of, title=make_backend(of).title, control=True)


def make_launch(launch: int = 0, *, model: str = "nozzle", **changes: Any) -> Launch:
    """A launch of 100 seconds, of which 8 were neither samples, preparation nor compilation."""
    facts: dict[str, Any] = {
        "core": launch % 2,
        "begun": "2011-05-01T12:00:00+00:00",
        "yardsticks": Yardsticks(copy_gb_s=8.0, triad_gb_s=10.0, latency_ns=90.0),
        "seconds": {"starting": 3.0, "compiling": 12.0, "preparing": 20.0, "samples": 60.0, "answers": 5.0},
    }
    return Launch(model=model, launch=launch, **{**facts, **changes})


def make_memory(backend: str, *, model: str = "nozzle", **changes: Any) -> Memory:
    """A structure that its process holds, and a tenth more while it was built."""
    structure = _structure(backend)
    used = sum(used for used, _ in structure.values())
    facts: dict[str, Any] = {"structure": structure, "retained_bytes": used, "peak_bytes": used * 11 // 10}
    return Memory(model=model, backend=backend, **{**facts, **changes})


def make_sample(task: str, backend: str, launch: int = 0, round: int = 0, cpu_s: float = 1.0, **changes: Any) -> Sample:
    """A sample of a task whose answer is right; alfa and flow had to move 400 GB at least."""
    facts: dict[str, Any] = {
        "model": "nozzle",
        "status": "ok",
        "launch": launch,
        "round": round,
        "cpu_s": cpu_s,
        "process_cpu_s": cpu_s,
        "wall_s": cpu_s * 1.01,
        "prepare_s": 0.1,
        "items": TETRAS,
        "unit": "splits" if task == "explode" else "tetras",
        "least_bytes": 400 * 10**9 if task in ("alfa", "flow") else None,
        "digest": f"{sum(map(ord, task)):016x}",
        "structure_bytes": 150_000_000,
        "peak_bytes": 420_000_000 if backend == "v4" else 400_000_000,
    }
    return Sample(task=task, backend=backend, **{**facts, **changes})


def change(results: Results, task: str, backend: str, **changes: Any) -> Results:
    """The same with other facts in the samples of one cell (of each model)."""
    cell = task, backend
    samples = [
        msgspec.structs.replace(sample, **changes) if (sample.task, sample.backend) == cell else sample
        for sample in results.samples
    ]
    return msgspec.structs.replace(results, samples=samples)


def slow(results: Results, task: str, backend: str, factor: float) -> Results:
    """The same with one cell so many times as slow."""
    samples = [
        msgspec.structs.replace(sample, cpu_s=factor * sample.cpu_s, process_cpu_s=factor * sample.cpu_s)
        if (sample.task, sample.backend) == (task, backend)
        else sample
        for sample in results.samples
    ]
    return msgspec.structs.replace(results, samples=samples)


def _turns(
    times: Mapping[str, float], launch: int, round: int, launches: int, wobble: float
) -> Iterator[tuple[str, str, float]]:
    """(name, whose times it takes, how many times as long): the reference's control last."""
    drift = (1 + launch / launches) * (1 + round / 100)
    for place, name in enumerate(times):
        off = 0.0 if name == REFERENCE else wobble * WOBBLE[(launch + place) % len(WOBBLE)]
        yield name, name, drift * math.exp(off)
    if REFERENCE in times:
        yield f"{REFERENCE} control", REFERENCE, drift * math.exp(wobble * WOBBLE[launch % len(WOBBLE)] / 2)


def _structure(name: str) -> dict[str, tuple[int, int]]:
    node = 248 if name == "v4" else 232
    return {"tetras": (node * TETRAS, node * TETRAS), "points": (24 * POINTS, 24 * POINTS)}


def _options(task: str) -> dict[str, int]:
    """Those in the name of a task of a sweep: "alfa sweeps=10"."""
    return {name: int(value) for word in task.split(" ")[1:] for name, value in [word.split("=")]}
