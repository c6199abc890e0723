"""Results made by hand, from the source's own times: tables and charts then show what it says."""

from typing import Any

import msgspec

from tetrabench.bench.record import Backend, Results, Sample

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
TETRAS = 642_720


def make_results(seconds: dict[str, dict[str, float]] = SECONDS, rounds: int = 3, **changes: Any) -> Results:
    """A run in which all went well."""
    names = list(dict.fromkeys(name for times in seconds.values() for name in times))
    facts: dict[str, Any] = {
        "command": "tetrabench run --model nozzle",
        "profile": "default",
        "family": "tetra",
        "model": "nozzle",
        "model_size": {"tetras": TETRAS, "points": 112_339},
        "options": {scenario: {} for scenario in seconds},
        "reference": "v3y",
        "seed": 0,
        "started": "2011-05-01T12:00:00+00:00",
        "environment": {"processor": "Intel Core2 T6400", "cores": 2, "system": "Linux", "python": "3.11.7"},
        "backends": [make_backend(name) for name in names],
        "samples": [
            make_sample(scenario, name, round, times[name])
            for scenario, times in seconds.items()
            for round in range(rounds)
            for name in times
        ],
    }
    return Results(**{**facts, **changes})


def make_backend(name: str, **changes: Any) -> Backend:
    """A contestant as it took part."""
    node = 248 if name == "v4" else 232
    slots = "no holes" if name == "v4" else SLOTS.get(name[2:], "other slots")
    title = f"{LAYOUTS.get(name[:2], 'another layout')}, {slots}"
    facts = {
        "title": title,
        "compile_s": 1.5,
        "first_sample_s": 2.5,
        "structure": {"tetras": (node * TETRAS, node * TETRAS), "points": (24 * 112_339, 24 * 112_339)},
    }
    return Backend(name=name, **{**facts, **changes})


def make_sample(scenario: str, backend: str, round: int = 0, cpu_s: float = 1.0, **changes: Any) -> Sample:
    """A sample of a scenario whose answer is right."""
    facts: dict[str, Any] = {
        "status": "ok",
        "cpu_s": cpu_s * (1 + round / 100),
        "process_cpu_s": cpu_s * (1 + round / 100),
        "wall_s": cpu_s * 1.01,
        "items": TETRAS,
        "unit": "splits" if scenario == "explode" else "tetras",
        "digest": f"{sum(map(ord, scenario)):016x}",
        "structure_bytes": 150_000_000,
        "peak_bytes": 420_000_000 if backend == "v4" else 400_000_000,
    }
    facts |= {"family": "tetra", "model": "nozzle", **changes}
    return Sample(scenario=scenario, backend=backend, round=round, **facts)


def change(results: Results, scenario: str, backend: str, **changes: Any) -> Results:
    """The same with other facts in the samples of one cell."""
    cell = scenario, backend
    samples = [
        msgspec.structs.replace(sample, **changes) if (sample.scenario, sample.backend) == cell else sample
        for sample in results.samples
    ]
    return msgspec.structs.replace(results, samples=samples)
