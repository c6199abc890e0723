"""Runs made by hand that draw the curves of the collision source: with times by formula, as its text tells or otherwise."""

import math

import msgspec

from tests.report.made import WOBBLE, make_backend, make_launch, make_results, make_sample
from tetrabench.bench.record import Model, Task

TITLES = {
    "kdtree": "a k-d tree with objects in its leaves, mended as they move",
    "grid": "squares of one size, objects sorted into them in each step",
    "leaf-only": "the k-d tree as published: each leaf is searched alone",
}
SIZES = (10_000, 20_000, 50_000, 100_000, 200_000)
CAPACITIES = (1, 2, 4, 8, 10, 16, 32, 63)
AREAS = (100, 1000, 10_000, 100_000, 1_000_000)
ENDS = [float(step) for step in range(50, 1001, 50)]
STEPS = 1000


def backend_of(name, **options):
    """A contestant with options, those that are swept in its name."""
    words = [f"{option}={value}" for option, value in options.items()]
    return make_backend(
        " ".join([name, *words]),
        contestant=name,
        title=TITLES[name],
        against="kdtree",
        exact=name != "leaf-only",
        options={"capacity": 16, "recycle": 1, **options} if name != "grid" else {},
    )


def run_of(models, tasks, backends, seconds, series=None, *, launches=8, wobble=0.01):
    """A run in which `seconds` says how long a cell takes, by model, task and backend; `series` what was counted on the way.

    Each launch is slower than the one before, for all alike, and off by `wobble` for each backend on its own.
    """
    first = backends[0].name
    backends = [msgspec.structs.replace(one, against=first) for one in backends]
    samples = [
        make_sample(
            task.name,
            backend.name,
            launch,
            0,
            (1 + launch / 20) * off * seconds(model, task, backend),
            model=model.name,
            status="ok" if backend.exact else "wrong-result",
            reason="" if backend.exact else "not the answer of most",
            items=model.size["objects"] * STEPS,
            series={
                name: [(1 + launch / 20) * off * one for one in values] if name.endswith("_s") else values
                for name, values in (series(model, task, backend) if series else {}).items()
            },
        )
        for model in models
        for task in tasks
        for launch in range(launches)
        for place, backend in enumerate(backends)
        for off in [math.exp(wobble * WOBBLE[(launch + place) % len(WOBBLE)]) if place else 1.0]
    ]
    facts = make_results({"motion": {"kdtree": 1.0}}, launches=launches)
    return msgspec.structs.replace(
        facts,
        command=f"tetrabench run --family collision --scenario {tasks[0].scenario}",
        family="collision",
        models=list(models),
        tasks=list(tasks),
        backends=backends,
        reference=first,
        titles=list(TITLES.values()),
        launches=[make_launch(launch, model=model.name) for model in models for launch in range(launches)],
        memory=[],
        samples=samples,
    )


def uniform(objects, name=""):
    return Model(name=name or f"uniform-{objects}", size={"objects": objects})


def objects_run(exponent=1.0, **choices):
    """Time as a power of the number of objects; leaf-only has a kink at 50,000."""

    def seconds(model, task, backend):
        objects = model.size["objects"]
        kink = 1.5 if backend.contestant == "leaf-only" and objects > 50_000 else 1.0
        return kink * 1e-4 * objects**exponent * {"kdtree": 1.0, "grid": 0.5, "leaf-only": 0.4}[backend.contestant]

    backends = [backend_of(name) for name in ("kdtree", "grid", "leaf-only")]
    return run_of(map_of(SIZES), [Task(name="motion", scenario="motion", options={"steps": 100})], backends, seconds,
                  **choices)  # fmt: skip


def map_of(sizes):
    return [uniform(size) for size in sizes]


def capacity_run(best=(20, 9), **choices):
    """A parabola over the logarithm of the capacity: least at best[0] for kdtree, at best[1] for leaf-only."""

    def seconds(model, task, backend):
        middle = best[backend.contestant == "leaf-only"]
        return 0.5 + 0.3 * math.log(backend.options["capacity"] / middle) ** 2

    backends = [backend_of(name, capacity=value) for name in ("kdtree", "leaf-only") for value in CAPACITIES]
    task = Task(name="motion", scenario="motion", options={"steps": STEPS})
    return run_of([uniform(10_000, "uniform")], [task], backends, seconds, **choices)


def concentration_run(spread=(2.5, 1.2), **choices):
    """Time falls with the area, so many times from the least to the greatest."""

    def seconds(model, task, backend):
        share = math.log(AREAS[-1] / task.options["area"]) / math.log(AREAS[-1] / AREAS[0])
        return spread[backend.contestant == "leaf-only"] ** share

    tasks = [
        Task(name=f"concentration area={area}", scenario="concentration", options={"area": area, "steps": STEPS})
        for area in AREAS
    ]
    backends = [backend_of(name) for name in ("kdtree", "grid", "leaf-only")]
    return run_of([uniform(10_000, "uniform")], tasks, backends, seconds, **choices)


def recycling_run(slower=3.0, leaves=4.0, flat=1.1, **choices):
    """Under gravity without recycling the time of a step grows so many times, and the leaves; all else is nearly flat."""

    def grows(task, backend, times):
        return times if task.scenario == "gravity" and not backend.options["recycle"] else flat

    def series(model, task, backend):
        shares = [place / (len(ENDS) - 1) for place in range(len(ENDS))]
        spent = [0.05 * grows(task, backend, slower) ** share for share in shares]
        return {
            "step": ENDS,
            "pairs_s": [0.75 * one for one in spent],
            "move_s": [0.25 * one for one in spent],
            "leaves": [round(1000 * grows(task, backend, leaves) ** share) for share in shares],
        }

    def seconds(model, task, backend):
        found = series(model, task, backend)
        return sum(map(sum, (found["pairs_s"], found["move_s"])))

    backends = [backend_of(name, recycle=on) for name in ("kdtree", "leaf-only") for on in (1, 0)]
    tasks = [Task(name=name, scenario=name, options={"steps": STEPS}) for name in ("weightless", "gravity")]
    return run_of([uniform(10_000, "uniform")], tasks, backends, seconds, series, **choices)


def all_runs(**choices):
    """The four runs behind the page."""
    return [run(**choices) for run in (objects_run, capacity_run, concentration_run, recycling_run)]
