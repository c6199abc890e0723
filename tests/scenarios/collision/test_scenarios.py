"""Scenarios on moving objects: one answer for all structures, the twin's; and what is told along the way."""

from typing import Any

import numpy as np
import pytest
from numba import config

from tests.collision.starts import SLOW, STARTS
from tests.collision.variants import variant
from tetrabench import registry
from tetrabench.backends.collision import STRUCTURES
from tetrabench.bench.messages import Load, Loaded, Measure, Measured, Open
from tetrabench.bench.spawn import WorkerProcess
from tetrabench.collision.contestant import CollisionContestant
from tetrabench.collision.digest import pairs_answer, state_answer
from tetrabench.collision.objects import Start
from tetrabench.collision.simulation import Simulation
from tetrabench.collision.start.files import write_objects
from tetrabench.collision.twin import Twin
from tetrabench.errors import UnsupportedError
from tetrabench.protocols import Answer, Work
from tetrabench.scenarios.collision import SCENARIOS as ALL
from tetrabench.scenarios.collision.windows import EXPECTED, SEED

SCENARIOS = {scenario.name: scenario for scenario in ALL}
STEPPING = {
    "motion": {},
    "concentration": {},
    "weightless": {},
    "gravity": {"gravity": 0.1, "bounce": 0.9},
    "impulses": {"mode": "full"},
}
EXACT = [name for name, contestant in STRUCTURES.items() if contestant.is_exact]
STEPS = 4 if SLOW else 30
CLOCKS = ("update_s", "pairs_s", "respond_s", "move_s")


class Stage:
    """One contestant with a start that is in memory already."""

    def __init__(self, start: Start, contestant: CollisionContestant) -> None:
        self.start = start
        self.contestant = contestant
        self.adopted: Simulation | None = None

    def simulation(self, **rules: object) -> Simulation:
        return Simulation(self.start, self.contestant, **rules)  # type: ignore[arg-type]

    def adopt(self, simulation: Simulation) -> None:
        self.adopted = simulation


def stage_of(start: str, name: str, **options: int) -> Stage:
    return Stage(STARTS[start](), variant(name, **options))


def sample(name: str, stage: Stage, **options: int) -> tuple[Answer, Work, Any]:
    scenario = SCENARIOS[name]
    subject = scenario.prepare(stage, {**scenario.options, **options})
    outcome = scenario.run(subject)
    return scenario.answer(subject, outcome), scenario.work(subject, outcome), subject


def test_the_names_of_the_scenarios() -> None:
    assert list(SCENARIOS) == ["build", "motion", "concentration", "weightless", "gravity", "impulses", "windows"]
    for name, scenario in SCENARIOS.items():
        assert registry.scenario("collision", name).name == name
        assert scenario.family == "collision"
        assert scenario.options.keys() == scenario.thesis.keys()
        assert not any(map(scenario.skip, STRUCTURES.values()))


@pytest.mark.parametrize("name", ["motion", "concentration", "weightless", "gravity", "impulses"])
def test_all_pairs_are_not_tested_for_hours(name: str) -> None:
    few = SCENARIOS[name].prepare(stage_of("random", "brute"), {**SCENARIOS[name].options, "steps": 1000})
    assert sum(few.stretches) == 1000
    endless = {**SCENARIOS[name].options, "steps": 10**9}
    SCENARIOS[name].prepare(stage_of("random", "kdtree"), endless)
    with pytest.raises(UnsupportedError, match=r"^tests all pairs: \de\+\d\d in 1,000,000,000 steps of"):
        SCENARIOS[name].prepare(stage_of("random", "brute"), endless)


@pytest.mark.parametrize("start", ["random", "clustered", "five bursts", "radii 10:1", "three", "none"])
@pytest.mark.parametrize("name", STEPPING)
def test_all_structures_take_the_twins_steps(name: str, start: str) -> None:
    rules = STEPPING[name]
    began = STARTS[start]()
    area = int(began.width * began.height / max(1, len(began.objects.x)))
    options = {"area": area} if name == "concentration" else {}
    answers = {}
    for contestant in EXACT:
        answers[contestant], work, run = sample(name, stage_of(start, contestant), steps=STEPS, **options)
        assert run.simulation.steps_done == STEPS
        assert (work.items, work.unit, work.least_bytes) == (
            STEPS * len(run.simulation),
            "object steps",
            40 * work.items,
        )
    assert {(a.digest, *a.figures.items()) for a in answers.values()} == {
        (answers["brute"].digest, *answers["brute"].figures.items())
    }
    twin = Twin(run.simulation.start, **rules)
    for _ in range(STEPS):
        twin.step()
        if name == "impulses":
            break
    if name == "impulses":  # the first step alone, to rounding: see tests of dynamics
        simulation = Simulation(run.simulation.start, STRUCTURES["kdtree"], mode="full")
        simulation.step()
        np.testing.assert_allclose(simulation.objects[:4], [twin.x, twin.y, twin.vx, twin.vy], rtol=1e-9, atol=1e-9)
    else:
        assert [column.tolist() for column in run.simulation.objects[:4]] == [twin.x, twin.y, twin.vx, twin.vy]
        assert answers["brute"].figures["contacts"] == twin.contacts
    assert answers["brute"].figures["energy"] == run.simulation.energy()


@pytest.mark.parametrize("name", STEPPING)
def test_one_that_misses_contacts_has_another_answer(name: str) -> None:
    right, wrong = (
        sample(name, stage_of("clustered", who, capacity=2), steps=STEPS)[0] for who in ("kdtree", "leaf-only")
    )
    assert (right.digest != wrong.digest) or name == "concentration"
    assert (
        sample("build", stage_of("clustered", "leaf-only", capacity=2))[0].digest
        != sample("build", stage_of("clustered", "kdtree", capacity=2))[0].digest
    )


@pytest.mark.parametrize("name", STEPPING)
@pytest.mark.parametrize("contestant", ["kdtree", "grid", "skin", "ckdtree", "brute"])
@pytest.mark.parametrize("steps", [1, 7, 120])
def test_series(name: str, contestant: str, steps: int) -> None:
    """Lists of one length, a value for each stretch; the stretches are all steps, none empty; the counts are the last ones'."""
    steps = min(steps, 60) if SLOW else steps
    answer, _, run = sample(name, stage_of("random", contestant), steps=steps)
    series, stretches = answer.series, min(steps, 50 if name in ("weightless", "gravity") else 1)
    assert {len(values) for values in series.values()} == {stretches}
    assert series["step"][-1] == steps
    assert all(step > before for before, step in zip([0, *series["step"]], series["step"], strict=False))
    widths = {int(step - before) for before, step in zip([0, *series["step"]], series["step"], strict=False)}
    assert max(widths) - min(widths) <= 1
    stats = run.simulation.stats()
    assert series.keys() == {"step", "contacts", "structure_bytes", *CLOCKS, *stats}
    for clock, seconds in zip(CLOCKS, run.simulation.phase_seconds.values(), strict=True):
        assert min(series[clock]) >= 0
        assert sum(series[clock]) == pytest.approx(seconds, abs=1e-9)
    assert {count: values[-1] for count, values in series.items() if count in stats} == stats
    assert series["contacts"][-1] == run.simulation.contacts
    assert series["structure_bytes"][-1] == sum(used for used, _ in run.simulation.structure_bytes().values())
    assert all(type(value) in (int, float) for values in series.values() for value in values)


def test_contacts_along_the_way_are_the_twins() -> None:
    answer, _, _ = sample("gravity", stage_of("clustered", "kdtree"), steps=STEPS)
    twin = Twin(STARTS["clustered"](), 0.1, 0.9)
    expected = [len(twin.step()) for _ in range(STEPS)]
    assert answer.series["contacts"] == [expected[int(step) - 1] for step in answer.series["step"]]
    again, _, _ = sample("gravity", stage_of("clustered", "kdtree", capacity=1, recycle=0), steps=STEPS)
    assert again.digest == answer.digest  # series are no part of the answer
    assert again.series["leaves"] != answer.series["leaves"]


@pytest.mark.parametrize("area", [100, 15_000, 1_000_000])
@pytest.mark.parametrize("start", ["random", "three", "none"])
def test_concentration_draws_the_start_out(start: str, area: int) -> None:
    stage = stage_of(start, "kdtree")
    run = SCENARIOS["concentration"].prepare(stage, {"steps": 3, "area": area})
    began, drawn = stage.start, run.simulation.start
    count = len(began.objects.x)
    assert stage.adopted is run.simulation
    assert drawn.width == drawn.height
    if count:
        assert drawn.width * drawn.height == pytest.approx(area * count)
        scale = drawn.width / began.width
        np.testing.assert_allclose(drawn.objects.x, scale * began.objects.x, rtol=1e-15)
        np.testing.assert_allclose(drawn.objects.y, scale * began.objects.y, rtol=1e-15)
    else:
        assert (drawn.width, drawn.height) == (began.width, began.height)
    for one, other in zip(drawn.objects[2:], began.objects[2:], strict=True):
        np.testing.assert_array_equal(one, other)
    assert f"{area:,} units^2 an object" in drawn.source
    assert began.objects.x.tolist() == STARTS[start]().objects.x.tolist()


@pytest.mark.parametrize("contestant", EXACT)
@pytest.mark.parametrize("start", ["random", "clustered", "one place", "one", "none"])
def test_windows(contestant: str, start: str) -> None:
    """The same windows for all, each of the size that holds so many; what lies in them is what a look at all says."""
    stage, twin = stage_of(start, contestant), Twin(STARTS[start]())
    answer, work, asked = sample("windows", stage, queries=20)
    share = min(1.0, EXPECTED / max(1, len(twin.x))) ** 0.5
    assert (asked.width, asked.height) == (share * stage.start.width, share * stage.start.height)
    corners = np.random.default_rng(SEED).random((20, 2)) * [
        stage.start.width - asked.width,
        stage.start.height - asked.height,
    ]
    inside = [twin.within(x, y, x + asked.width, y + asked.height) for x, y in corners.tolist()]
    assert [one.tolist() for one in asked.lists] == inside
    assert answer.figures == {"found": sum(map(len, inside))}
    assert (work.items, work.unit, work.least_bytes) == (20, "windows", 16 * sum(map(len, inside)))


@pytest.mark.parametrize("contestant", EXACT)
def test_the_windows_that_were_timed_are_part_of_the_answer(contestant: str) -> None:
    """Smaller ones, of which each holds some; a loop that counts or adds another number has another digest."""
    scenario = SCENARIOS["windows"]
    asked = scenario.prepare(stage_of("random", contestant), {"queries": 30})
    asked.width, asked.height = 20.0, 10.0
    twin = Twin(STARTS["random"]())
    inside = [
        twin.within(x, y, x + 20.0, y + 10.0) for x, y in (50 * np.random.default_rng(1).random((30, 2))).tolist()
    ]
    asked.corners = 50 * np.random.default_rng(1).random((30, 2))
    count, total = scenario.run(asked)
    assert (count, total) == (sum(map(len, inside)), sum(map(sum, inside)))
    answer = scenario.answer(asked, (count, total))
    assert answer.digest != scenario.answer(asked, (count, total + 1)).digest
    assert answer.digest != scenario.answer(asked, (count + 1, total)).digest


@pytest.mark.parametrize("contestant", EXACT)
def test_build(contestant: str) -> None:
    stage = stage_of("clustered", contestant)
    answer, work, simulation = sample("build", stage)
    found = Twin(stage.start).pairs()
    assert answer == pairs_answer(np.array(found, np.int32))
    assert answer.figures == {"contacts": len(found)}
    assert (work.items, work.unit, work.least_bytes) == (len(simulation), "objects", 24 * len(simulation))


def test_the_digest_is_of_places_velocities_contacts_and_steps() -> None:
    simulation = Simulation(STARTS["random"](), STRUCTURES["kdtree"])
    simulation.step(2)
    right = state_answer(simulation).digest
    for column in simulation.objects[:4]:
        kept = column[5]
        column[5] = np.nextafter(kept, np.inf)
        assert state_answer(simulation).digest != right
        column[5] = kept
    assert state_answer(simulation).digest == right
    for name in ("contacts", "steps_done"):
        kept = getattr(simulation, name)
        setattr(simulation, name, kept + 1)
        assert state_answer(simulation).digest != right
        setattr(simulation, name, kept)


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="runs workers, which take minutes without the JIT")
@pytest.mark.parametrize("contestant", ["kdtree", "ckdtree"])
def test_a_worker_measures_them(contestant: str, tmp_path) -> None:  # type: ignore[no-untyped-def]
    """With an option of the contestant, from a file: the answers that we have here."""
    start = STARTS["random"]()
    write_objects(start, tmp_path / "start.npz")
    worker = WorkerProcess()
    try:
        worker.ask(Open("collision", contestant, options={"capacity": 3}))
        assert isinstance(worker.ask(Load(str(tmp_path / "start.npz"))), Loaded)
        for name, scenario in SCENARIOS.items():
            options = {
                **scenario.options,
                **({"steps": 12} if "steps" in scenario.options else {"queries": 12} if name == "windows" else {}),
            }
            measured = worker.ask(Measure(name, options))
            assert isinstance(measured, Measured), measured
            expected, work, _ = sample(name, Stage(start, variant(contestant, capacity=3)), **options)
            assert measured.digest == expected.digest
            assert (measured.items, measured.unit) == (work.items, work.unit)
            assert measured.series.keys() == expected.series.keys()
            assert measured.series.get("contacts", []) == list(expected.series.get("contacts", []))
            assert measured.structure
            assert min(measured.cpu_s, measured.wall_s) >= 0
    finally:
        worker.kill()
