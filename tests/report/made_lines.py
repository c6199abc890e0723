"""Runs made by hand whose backends differ in an option, whose tasks differ in a count, and whose samples tell series."""

import math
from collections.abc import Iterable, Mapping, Sequence

import msgspec

from tests.report.made import make_backend, make_launch, make_results, make_sample
from tetrabench.bench.record import Backend, Model, Results

CAPACITIES = (1, 2, 4, 8, 16, 32, 63)
OBJECTS = 10_000
STRETCHES, STEPS = 40, 25
"""Stretches of a run, and steps of each."""
TITLES = {
    "kdtree": "bucketed k-d tree",
    "grid": "grid, counting sort",
    "skin": "grid, skin list",
    "brute": "no structure, all pairs",
    "ckdtree": "k-d tree of scipy",
    "leaf-only": "bucketed k-d tree, own leaf alone",
}
SECONDS = {"kdtree": 6.0, "grid": 4.0, "skin": 1.3, "brute": 900.0, "ckdtree": 38.0, "leaf-only": 5.0}
"""Of a task with the best options."""


def make_contestants(capacities: Sequence[int] = (), *, names: Iterable[str] = TITLES) -> list[Backend]:
    """Backends of a family with options: the tree and its wrong double with each of the capacities."""
    found = []
    for name in names:
        facts = {"contestant": name, "title": TITLES[name], "structure": {}, "exact": name != "leaf-only"}
        facts["extension"] = name in ("grid", "skin")
        swept = capacities if name in ("kdtree", "leaf-only") else ()
        if not swept:
            default = {"capacity": 8, "recycle": 1} if name in ("kdtree", "leaf-only") else {}
            found.append(make_backend(name, options=default, **facts))
        for capacity in swept:
            options = {"capacity": capacity, "recycle": 1}
            found.append(make_backend(f"{name} capacity={capacity}", options=options, **facts))
    first = found[0].name
    return [msgspec.structs.replace(one, against=first) for one in found]


def seconds_of(backend: Backend) -> float:
    """A flat valley over the capacity, its floor at 16; at 8 for the wrong one."""
    best = 16 if backend.exact else 8
    capacity = backend.options.get("capacity", best)
    return SECONDS[backend.contestant] * (1 + 0.15 * abs(math.log2(capacity / best)) ** 1.5)


def make_series(backend: Backend, seconds: float, *, stretches: int = STRETCHES) -> dict[str, list[float]]:
    """Four phases, in all as long as the sample and ever slower, and some counts."""
    shares = [2 * (place + stretches) / (3 * stretches - 1) / stretches for place in range(stretches)]
    phases = {"update_s": 0.3, "pairs_s": 0.4, "respond_s": 0.2, "move_s": 0.1}
    series = {"step": [STEPS * (place + 1.0) for place in range(stretches)]}
    series |= {name: [part * seconds * share for share in shares] for name, part in phases.items()}
    series["contacts"] = [420.0 + 5 * place for place in range(stretches)]
    if "capacity" in backend.options:
        leaves = OBJECTS / backend.options["capacity"]
        series["leaves"] = [leaves * (1 + place / 100) for place in range(stretches)]
        series["fill"] = [0.7 - 0.1 * place / stretches for place in range(stretches)]
        series["merges"] = [float(place * place) for place in range(stretches)]
    return series


def make_run(
    tasks: Mapping[str, float],
    backends: Sequence[Backend],
    *,
    launches: int = 8,
    rounds: int = 1,
    stretches: int = STRETCHES,
    model: str = "uniform",
) -> Results:
    """A run of tasks, each so many times as long as SECONDS; `tasks` are named "motion", or "concentration area=100".

    Who is not exact is wrong. Launches are off by up to 2 %, in turns.
    """
    samples = []
    for task, factor in tasks.items():
        for launch in range(launches):
            for round in range(rounds):
                for place, backend in enumerate(backends):
                    off = math.exp(0.02 * math.cos(launch + place)) if backend.against != backend.name else 1.0
                    seconds = factor * off * seconds_of(backend)
                    series = make_series(backend, seconds, stretches=stretches) if stretches else {}
                    facts = {"model": model, "items": OBJECTS * 1000, "unit": "object steps", "least_bytes": None}
                    facts["status"] = "ok" if backend.exact else "wrong-result"
                    facts["reason"] = "" if backend.exact else "most find other pairs"
                    samples.append(make_sample(task, backend.name, launch, round, seconds, series=series, **facts))
    made = make_results(
        {task: {"v3y": 1.0} for task in tasks},
        launches=launches,
        rounds=rounds,
        backends=list(backends),
        models=[Model(name=model, size={"objects": OBJECTS}, digest="0" * 16)],
        reference=backends[0].name,
        titles=list(TITLES.values()),
        memory=[],
        samples=samples,
    )
    return msgspec.structs.replace(made, launches=[make_launch(launch, model=model) for launch in range(launches)])
