"""Results made by hand: for each cell the ratio to its reference in each launch, and nothing left to chance."""

from collections.abc import Mapping, Sequence
from typing import Any

import msgspec

from tetrabench.bench.record import Backend, Effort, Memory, Model, Results, Sample, Task

ENVIRONMENT = {
    "processor": "Some CPU @ 2 GHz",
    "architecture": "x86_64",
    "cores": 2,
    "system": "Linux",
    "python": "3.11.7",
    "numpy": "2.1.0",
    "numba": "0.61.0",
    "llvmlite": "0.44.0",
    "revision": "a" * 40,
}
SPREAD = (0.99, 1.0, 1.01, 0.995, 1.005, 1.015, 0.985, 1.0)  # of eight launches of identical code


def spread(ratio: float = 1.0, launches: int = 8) -> list[float]:
    """A ratio as so many launches show it."""
    return [ratio * SPREAD[k % len(SPREAD)] for k in range(launches)]


def make_run(cells: Mapping[str, Mapping[str, Sequence[float]]], *, seconds: float = 0.1, **changes: Any) -> Results:
    """A run of v3y and others on a box.

    Args:
        cells: task -> backend -> ratio to v3y of each launch.
        seconds: that v3y takes; it drifts from launch to launch.
        changes: other fields of the results.
    """
    names = list(dict.fromkeys(name for ratios in cells.values() for name in ratios))
    facts: dict[str, Any] = {
        "command": "tetrabench run --model box",
        "profile": "default",
        "family": "tetra",
        "models": [Model(name="box", size={"tetras": 3000}, digest="0123456789abcdef")],
        "tasks": [Task(name=task, scenario=task, options={"sweeps": 10}) for task in cells],
        "backends": [make_backend("v3y"), *(make_backend(name) for name in names)],
        "reference": "v3y",
        "effort": Effort(launches=8, rounds=1, hopeless_rounds=3),
        "seed": 0,
        "started": "2024-01-01T00:00:00+00:00",
        "environment": ENVIRONMENT,
        "samples": [sample for task, ratios in cells.items() for sample in make_samples(task, ratios, seconds)],
    }
    return Results(**{**facts, **changes})


def make_backend(name: str, against: str = "v3y", **changes: Any) -> Backend:
    """v3y, v3y control, v4, ...; of a gate v3y@base, v3y@head, ..."""
    contestant = name.split()[0].split("@")[0]
    checkout = name.split()[0].partition("@")[2]
    return Backend(
        **{
            "name": name,
            "contestant": contestant,
            "title": contestant,
            "against": against,
            "control": name.endswith(" control"),
            "checkout": checkout,
            **changes,
        }
    )


def make_samples(
    task: str, ratios: Mapping[str, Sequence[float]], seconds: float, reference: str = "v3y"
) -> list[Sample]:
    """One round a launch; the noise of a launch is in all its samples."""
    launches = range(max(map(len, ratios.values()), default=0))
    drift = [seconds * (1 + 0.3 * (k % 3)) for k in launches]
    every = {reference: [1.0] * len(launches), **ratios}
    return [
        make_sample(task, name, launch, drift[launch] * ratio)
        for name, them in every.items()
        for launch, ratio in enumerate(them)
    ]


def make_sample(task: str, backend: str, launch: int, seconds: float, **changes: Any) -> Sample:
    """One that ended well."""
    facts: dict[str, Any] = {"cpu_s": seconds, "process_cpu_s": seconds, "wall_s": 1.5 * seconds, "digest": task}
    return Sample(
        **{"model": "box", "task": task, "backend": backend, "status": "ok", "launch": launch, "round": 0}
        | facts
        | changes
    )


def change_samples(results: Results, task: str, backend: str, **changes: Any) -> Results:
    """The same with other facts in all samples of one cell."""
    return msgspec.structs.replace(
        results,
        samples=[
            msgspec.structs.replace(one, **changes) if (one.task, one.backend) == (task, backend) else one
            for one in results.samples
        ],
    )


def make_memory(backend: str, structure: int, peak: int | None = None, **changes: Any) -> Memory:
    """What a contestant takes, in bytes."""
    facts: dict[str, Any] = {"structure": {"tetras": (structure, structure)}, "peak_bytes": peak}
    return Memory(**{"model": "box", "backend": backend} | facts | changes)


def make_gate_run(
    cells: Mapping[str, Mapping[str, Sequence[float]]], *, seconds: float = 0.1, **changes: Any
) -> Results:
    """A run of base and head, as `gate` makes it, with controls that show nothing.

    Args:
        cells: task -> contestant -> ratio head / base of each launch; "v3y control" for another control of v3y.
        seconds: that each base takes.
        changes: other fields of the results.
    """
    contestants = list(dict.fromkeys(name for ratios in cells.values() for name in ratios if " " not in name))
    backends = []
    for name in contestants:
        backends += [
            make_backend(other, f"{name}@base") for other in (f"{name}@base", f"{name}@head", f"{name}@base control")
        ]
    samples = []
    for task, ratios in cells.items():
        for name, them in ratios.items():
            if " " in name:
                continue
            control = ratios.get(f"{name} control", spread(1.0, len(them)))
            both = {f"{name}@head": them, f"{name}@base control": control}
            samples += make_samples(task, both, seconds, f"{name}@base")
    facts = {"backends": backends, "reference": backends[0].name, "samples": samples, "profile": "rigorous"}
    return make_run({task: {} for task in cells}, **facts | changes)
