"""What contacts, walls and gravity do: the twin's steps to the bit, and what physics keeps."""

import math

import numpy as np
import pytest

from tests.collision.starts import SLOW, STARTS, scattered, start_of
from tests.collision.variants import variant
from tetrabench.collision.contestant import CollisionContestant
from tetrabench.collision.dynamics import BITS, put_in_order
from tetrabench.collision.objects import Objects, Start, make_objects
from tetrabench.collision.simulation import Simulation
from tetrabench.collision.twin import Twin

HUGE = 2.0**40
"""A box without walls: nothing comes so far; what begins in the middle of it is exact to 2^-12."""

RUNNERS = {
    "kdtree": variant("kdtree"),
    "kdtree without recycling": variant("kdtree", recycle=0),
    "kdtree 3": variant("kdtree", capacity=3, median=1, per_leaf=0),
    "grid": variant("grid"),
    "skin": variant("skin"),
    "ckdtree": variant("ckdtree"),
    "brute": variant("brute"),
}


def simulate(objects: Objects, *, box: float = HUGE, name: str = "brute", **rules: object) -> Simulation:
    return Simulation(Start(objects, box, box), RUNNERS[name], **rules)  # type: ignore[arg-type]


def state(simulation: Simulation) -> list[list[float]]:
    return [column.tolist() for column in simulation.objects]


def dyadic(count: int, seed: int) -> Objects:
    """Equal masses; places in quarters, velocities in halves; in the middle of a huge box."""
    rng = np.random.default_rng(seed)
    x, y = HUGE / 2 + 0.25 * rng.integers(0, 4 * 40, (2, count))
    vx, vy = 0.5 * rng.integers(-5, 5, (2, count))
    return make_objects(x, y, vx, vy, 1.5, 4.0)


# ---- contacts, the source's way


def test_two_objects_turn_about_their_centre_of_mass() -> None:
    simulation = simulate(make_objects([10, 12], [10, 11], [2, -1], [1, 0.5], 2, [1, 3]))
    simulation.step()
    centre = (2 - 3) / 4, (1 + 1.5) / 4
    assert simulation.objects.vx.tolist() == [2 * centre[0] - 2, 2 * centre[0] + 1]
    assert simulation.objects.vy.tolist() == [2 * centre[1] - 1, 2 * centre[1] - 0.5]
    assert simulation.objects.x.tolist() == [10 + simulation.objects.vx[0], 12 + simulation.objects.vx[1]]
    assert simulation.contacts == 1


def test_one_hit_an_object_the_first_in_order() -> None:
    """2 touches 0 and 1: the hit is with 0. 1 is free for 3 then, though (1, 2) comes first; 4 has nobody left."""
    x, y = np.array([0.0, 4, 2, 6, 7]), np.zeros(5)
    vx = np.array([1.0, 2, 3, 4, 5])
    simulation = simulate(make_objects(x, y, vx, 0, 1.5, 1))
    assert simulation.find_pairs().tolist() == [[0, 2], [1, 2], [1, 3], [3, 4]]
    simulation.step()
    assert simulation.objects.vx.tolist() == [3, 4, 1, 2, 5]  # equal masses exchange velocities: 0 with 2, 1 with 3


@pytest.mark.parametrize("name", RUNNERS)
@pytest.mark.parametrize("gravity", [0.0, 0.1])
def test_a_long_run_is_the_twins_to_the_bit(name: str, gravity: float) -> None:
    start = STARTS["random"]()
    simulation, twin = Simulation(start, RUNNERS[name], gravity=gravity, bounce=0.9), Twin(start, gravity, 0.9)
    for _ in range(3 if SLOW else 40):
        twin.step()
    simulation.step(3 if SLOW else 40)
    assert state(simulation) == [twin.x, twin.y, twin.vx, twin.vy, twin.r, twin.m]
    assert simulation.contacts == twin.contacts


def test_energy_and_momentum_are_exact() -> None:
    """Equal masses and dyadic velocities without walls: only velocities change hands."""
    steps = 20 if SLOW else 500
    hits = 0
    for seed in range(1 if SLOW else 5):
        simulation = simulate(dyadic(60, seed), name="kdtree 3")
        before = simulation.energy(), simulation.momentum(), state(simulation)[2]
        for _ in range(steps):
            simulation.step()
            hits += simulation.contacts
            assert (simulation.energy(), simulation.momentum()) == before[:2]
        assert state(simulation)[2] != before[2]
        assert sorted(state(simulation)[2]) == sorted(before[2])
    assert hits > 100


# ---- contacts of smooth discs


def test_smooth_discs_keep_what_is_tangential() -> None:
    """Masses 1 and 3 meet head on along x: the textbook's velocities; what is along y stays."""
    simulation = simulate(make_objects([0, 3], [0, 0], [4, -2], [1, 7], 2, [1, 3]), mode="full")
    simulation.step()
    assert simulation.objects.vx.tolist() == pytest.approx(
        [(4 * (1 - 3) + 2 * 3 * -2) / 4, (-2 * (3 - 1) + 2 * 1 * 4) / 4]
    )
    assert simulation.objects.vy.tolist() == [1, 7]


def test_those_that_part_and_those_in_one_place_pass() -> None:
    for objects in (
        make_objects([0, 3], [0, 0], [-1, 2], [5, 6], 2, [1, 3]),  # receding
        make_objects([0, 3], [0, 0], [1, 1], [5, 6], 2, [1, 3]),  # side by side
        make_objects([1, 1], [2, 2], [1, -1], [0, 0], 2, [1, 3]),  # no line of centres
    ):
        simulation = simulate(objects, mode="full")
        simulation.step()
        assert simulation.contacts == 1
        assert state(simulation)[2:4] == [objects.vx.tolist(), objects.vy.tolist()]


def test_all_contacts_of_smooth_discs_act_in_order() -> None:
    """A row of three: 0 hits 1, which then hits 2."""
    objects = make_objects([0, 3, 6], [0, 0, 0], [2, 0, 0], 0, 2, 5)
    simulation = simulate(objects, mode="full")
    simulation.step()
    assert simulation.objects.vx.tolist() == [0, 0, 2]


@pytest.mark.parametrize("name", RUNNERS)
def test_impulses_are_the_twins_and_keep_energy_and_momentum(name: str) -> None:
    """To rounding; and what a contact changes is along the line of centres alone."""
    x, y = scattered(400, 440, size=30, seed=8)
    start = start_of(x, y, 4.0, box=HUGE)
    twin, simulation = Twin(start, mode="full"), Simulation(start, RUNNERS[name], mode="full")
    energy, momentum = simulation.energy(), simulation.momentum()
    contacts = 0
    for _ in range(5 if SLOW else 30):
        contacts += len(twin.step())
        simulation.step()
        np.testing.assert_allclose(state(simulation)[:4], [twin.x, twin.y, twin.vx, twin.vy], rtol=1e-9, atol=1e-9)
        assert simulation.energy() == pytest.approx(energy, rel=1e-12)
        assert simulation.momentum() == pytest.approx(momentum, abs=1e-10)
        twin.take(simulation.objects)  # chaos: what is left of a difference of rounding must not grow
    assert contacts > 30


@pytest.mark.parametrize("angle", [0.0, 0.3, 1.0, 2.5, 4.0])
def test_an_impulse_is_along_the_line_of_centres(angle: float) -> None:
    along = np.array([math.cos(angle), math.sin(angle)])
    across = np.array([-along[1], along[0]])
    one, other = 3.0 * along + 0.7 * across, -1.0 * along - 0.2 * across
    objects = make_objects(
        [500, 500 + along[0]], [500, 500 + along[1]], [one[0], other[0]], [one[1], other[1]], 1, [2, 7]
    )
    simulation = simulate(objects, mode="full")
    simulation.step()
    after = np.column_stack([simulation.objects.vx, simulation.objects.vy])
    assert after @ across == pytest.approx([0.7, -0.2])
    assert (after[1] - after[0]) @ along == pytest.approx(4.0)  # they part as fast as they met


# ---- walls and gravity


def test_walls_turn_round_what_is_outside_and_moves_outward() -> None:
    """Times `bounce`; not what is inside or on the border, nor what comes back; and nothing is put back."""
    outside, border, inside = 100.5, 100.0, 99.5
    x = [outside, outside, border, inside, -0.5, -0.5, 0.0, 0.5]
    v = [2.0, -2, 2, 2, -2, 2, -2, -2]
    expected = [-1.0, -2, 2, 2, 1, 2, -2, -2]
    y = 10.0 * np.arange(8) + 5
    for columns in ((x, y, v, 0.0), (y, x, 0.0, v)):
        simulation = simulate(make_objects(*columns, 0.25), box=100.0, bounce=0.5)
        simulation.step()
        moved = simulation.objects.vx if columns[2] is v else simulation.objects.vy
        place = simulation.objects.x if columns[2] is v else simulation.objects.y
        assert moved.tolist() == expected
        assert place.tolist() == [a + b for a, b in zip(x, expected, strict=True)]


def test_a_box_has_a_width_and_a_height() -> None:
    simulation = Simulation(Start(make_objects([55, 40], [15, 35], [1, 1], [1, 1], 1), 50.0, 30.0), RUNNERS["brute"])
    simulation.step()
    assert simulation.objects.vx.tolist() == [-1, 1]
    assert simulation.objects.vy.tolist() == [1, -1]


def test_gravity_comes_before_walls() -> None:
    """Below the floor and rising slower than gravity pulls: it is falling when the floor meets it."""
    simulation = simulate(make_objects([5], [-1], [0], [0.25]), box=100.0, gravity=0.5, bounce=0.5)
    simulation.step()
    assert (simulation.objects.vy[0], simulation.objects.y[0]) == (0.125, -0.875)


def energy_of_steps(simulation: Simulation) -> list[float]:
    """v^2/2 + g y - g v/2 of each object: what v' = v - g, y' = y + v' keep."""
    v, y, g = simulation.objects.vy, simulation.objects.y, simulation.gravity
    energy: list[float] = (0.5 * v * v + g * y - 0.5 * g * v).tolist()
    return energy


def test_free_flight_keeps_the_energy_of_steps() -> None:
    simulation = simulate(make_objects([0, 500], [1e4, 2e4], [1, -1], [30, -4], 1, 2), gravity=0.1)
    before = energy_of_steps(simulation)
    for _ in range(200):
        simulation.step()
        assert energy_of_steps(simulation) == pytest.approx(before, rel=1e-12)
    assert simulation.objects.vy.tolist() == pytest.approx([30 - 20, -4 - 20])
    assert simulation.objects.vx.tolist() == [1, -1]


def test_a_floor_that_takes_nothing_changes_the_energy_of_steps_by_little() -> None:
    """By g |v|, for it is met late by up to a step; and by nothing between two bounces."""
    g = 0.1
    simulation = simulate(make_objects([50], [40], [0], [0], 1, 5), gravity=g, box=100.0)
    bounces = 0
    for _ in range(300):
        (before,), v = energy_of_steps(simulation), simulation.objects.vy[0]
        simulation.step()
        (after,), has_bounced = energy_of_steps(simulation), v < 0 < simulation.objects.vy[0]
        bounces += has_bounced
        assert abs(after - before) <= (g * simulation.objects.vy[0] if has_bounced else 0.0) + 1e-12
    assert bounces >= 5


# ---- pairs in order


@pytest.mark.parametrize("count", [0, 1, 2, 3, 50] if SLOW else [0, 1, 2, 3, 100, 5000])
@pytest.mark.parametrize("objects", [1, 2, 7, 2**BITS - 1, 2**BITS, 2**BITS + 1, 2**22, 2**22 + 1, 2**31 - 1])
def test_pairs_are_put_in_order(count: int, objects: int, rng: np.random.Generator) -> None:
    """Of numbers below `objects`, the largest among them, duplicates too; what lies behind them stays."""
    found = np.full((count + 3, 2), -7, np.int32)
    found[:count] = rng.integers(0, objects, (count, 2))
    found[: count // 3] = found[count - count // 3 : count]
    found[: min(count, 1)] = objects - 1
    expected = found[:count][np.lexsort((found[:count, 1], found[:count, 0]))]
    put_in_order(found, np.empty_like(found), np.empty(1 << BITS, np.int64), count, objects)
    np.testing.assert_array_equal(found[:count], expected)
    assert (found[count:] == -7).all()
    put_in_order(found, np.empty_like(found), np.empty(1 << BITS, np.int64), count, objects)  # in order already
    np.testing.assert_array_equal(found[:count], expected)


def test_pairs_alike_in_their_first_number_alone_are_put_in_order() -> None:
    found = np.array([[1, 9], [1, 3], [1, 5]], np.int32)
    put_in_order(found, np.empty_like(found), np.empty(1 << BITS, np.int64), 3, 10)
    assert found.tolist() == [[1, 3], [1, 5], [1, 9]]


# ---- all alike


LONG = {
    "random": lambda size: start_of(*scattered(0, 400, size=size), 6.0, box=400.0),
    "clustered": lambda size: start_of(*scattered(190, 210, size=size), 3.0, box=400.0),
    "mixed": lambda size: start_of(
        *scattered(0, 400, size=size), np.where(np.arange(size) % 10 == 0, 20.0, 2.0), box=400.0
    ),
}


@pytest.mark.parametrize("mode", ["paper", "full"])
@pytest.mark.parametrize("gravity", [0.0, 0.1])
@pytest.mark.parametrize("start", LONG)
def test_all_come_to_the_same_places(start: str, gravity: float, mode: str) -> None:
    """To the last bit, over 1,000 steps, with recycling and without."""
    began = LONG[start](20 if SLOW else 200)
    ends = {}
    for name, contestant in RUNNERS.items():
        simulation = Simulation(began, contestant, gravity=gravity, bounce=0.9 if gravity else 1.0, mode=mode)
        simulation.step(3 if SLOW else 1000)
        ends[name] = state(simulation), simulation.contacts, simulation.steps_done
    assert {name for name, end in ends.items() if end != ends["brute"]} == set()


@pytest.mark.parametrize("name", RUNNERS)
def test_a_run_repeated_and_a_run_in_parts(name: str) -> None:
    def end_of(*parts: int) -> object:
        simulation = Simulation(STARTS["clustered"](), RUNNERS[name], gravity=0.1)
        for part in parts:
            simulation.step(part)
        return state(simulation), simulation.contacts, simulation.steps_done, simulation.stats()

    assert end_of(5) == end_of(5) == end_of(1, 1, 1, 1, 1) == end_of(2, 0, 3, 0)


def test_no_step_is_nothing() -> None:
    simulation = Simulation(STARTS["random"](), RUNNERS["kdtree"])
    simulation.step(2)
    before = state(simulation), simulation.contacts, simulation.stats(), dict(simulation.phase_seconds)
    simulation.step(0)
    assert (state(simulation), simulation.contacts, simulation.stats(), dict(simulation.phase_seconds)) == before


@pytest.mark.parametrize("start", ["random", "clustered", "means"])
def test_who_searches_its_own_leaf_alone_goes_astray(start: str) -> None:
    def end_of(contestant: CollisionContestant) -> list[list[float]]:
        simulation = Simulation(STARTS[start](), contestant)
        simulation.step(4 if SLOW else 30)
        return state(simulation)

    assert end_of(variant("leaf-only", capacity=2)) != end_of(RUNNERS["brute"])
    assert end_of(variant("leaf-only", capacity=63)) == end_of(RUNNERS["brute"])  # one leaf


def test_seconds_are_counted_by_phase() -> None:
    simulation = Simulation(STARTS["random"](), RUNNERS["kdtree"])
    assert simulation.phase_seconds == {"update": 0, "pairs": 0, "respond": 0, "move": 0}
    simulation.step(20)
    once = simulation.phase_seconds
    assert all(seconds > 0 for seconds in once.values())
    simulation.step(20)
    assert all(simulation.phase_seconds[phase] > seconds for phase, seconds in once.items())
