"""Every structure finds what looking at all pairs finds, and is sound, at every step from every kind of start."""

import functools
from itertools import pairwise

import numpy as np
import pytest
from numba import config

from tests.collision.audit import audit
from tests.collision.starts import SIZE, SLOW, STARTS, doubling, scattered, start_of
from tests.collision.variants import CAPACITIES, EXACT, variant
from tetrabench.collision.objects import Start
from tetrabench.collision.simulation import Simulation, _pairs, _query_rect
from tetrabench.collision.twin import Pair, Twin

STEPS = 6 if SLOW else 12
GRAVITY, BOUNCE = 0.1, 0.9

Rectangle = tuple[float, float, float, float]
Moment = tuple[list[Pair], list[tuple[Rectangle, list[int]]], list[list[float]]]


def rectangles(twin: Twin, moment: int) -> list[Rectangle]:
    """One with two centres on its border, where it is not inverted, and one that is a point; other objects at each moment."""
    if not twin.x:
        return [(-1.0, -1.0, 1.0, 1.0)]
    a, b = moment % len(twin.x), (7 * moment + 3) % len(twin.x)
    xs, ys = sorted((twin.x[a], twin.x[b])), sorted((twin.y[a], twin.y[b]))
    return [(xs[0], ys[0], xs[1], ys[1]), (twin.x[a], twin.y[a], twin.x[a], twin.y[a])]


@functools.cache
def run_of_twin(name: str) -> list[Moment]:
    """At each step from a start: pairs, what rectangles hold, and the state after it, in coordinates per unit of velocity."""
    twin, moments = Twin(STARTS[name](), GRAVITY, BOUNCE), []
    for moment in range(STEPS):
        asked = [(one, twin.within(*one)) for one in rectangles(twin, moment)]
        found = twin.step()
        moments.append((found, asked, [twin.x[:], twin.y[:], twin.vx[:], twin.vy[:]]))
    return moments


@pytest.mark.parametrize("start", STARTS)
@pytest.mark.parametrize("name", EXACT)
def test_all_find_what_the_twin_finds(name: str, start: str) -> None:
    simulation = Simulation(STARTS[start](), EXACT[name], gravity=GRAVITY, bounce=BOUNCE)
    for found, asked, state in run_of_twin(start):
        assert simulation.find_pairs().tolist() == [list(pair) for pair in found]
        assert audit(simulation.storage, simulation.objects) == []
        for rectangle, inside in asked:
            assert simulation.query_rect(*rectangle).tolist() == inside
        simulation.step()
        assert simulation.contacts == len(found)
        assert [column.tolist() for column in simulation.objects[:4]] == state


def test_the_starts_are_what_they_are_there_for() -> None:
    """Contacts in all that should have some; at first none where circles but touch."""
    for name in STARTS:
        contacts = sum(len(found) for found, _, _ in run_of_twin(name))
        assert (contacts == 0) == (name in ("none", "one")), name
    assert run_of_twin("touching")[0][0] == []
    assert all((column == column[0]).all() for column in STARTS["one place"]().objects[:2])
    assert np.signbit(STARTS["zeros"]().objects.x[STARTS["zeros"]().objects.x == 0]).any()


SPECIAL = [
    (-np.inf, -np.inf, np.inf, np.inf),
    (-np.inf, 40.0, np.inf, 60.0),
    (40.0, -np.inf, 60.0, np.inf),
    (50.0, -np.inf, np.inf, np.inf),
    (-np.inf, -np.inf, np.inf, 50.0),
    (np.inf, np.inf, np.inf, np.inf),
    (-np.inf, -np.inf, -np.inf, np.inf),
    (60.0, 0.0, 40.0, 100.0),
    (0.0, 60.0, 100.0, 40.0),
    (np.inf, np.inf, -np.inf, -np.inf),
    (np.nan, 0.0, 100.0, 100.0),
    (0.0, np.nan, 100.0, 100.0),
    (0.0, 0.0, np.nan, 100.0),
    (0.0, 0.0, 100.0, np.nan),
    (-0.0, -0.0, 0.0, 0.0),
    (-1e300, -1e300, 1e300, 1e300),
    (3e5, 3e5, 4e5, 4e5),
    (-4e5, -4e5, -3e5, -3e5),
]


@pytest.mark.parametrize("name", EXACT)
@pytest.mark.parametrize("start", ["random", "zeros", "far", "outlier", "one place", "none", "one"])
def test_rectangles_without_ends_inverted_or_of_no_numbers(name: str, start: str) -> None:
    simulation, twin = Simulation(STARTS[start](), EXACT[name]), Twin(STARTS[start]())
    for rectangle in SPECIAL:
        assert simulation.query_rect(*rectangle).tolist() == twin.within(*rectangle), rectangle
    for a, b in pairwise(range(min(len(simulation), 12))):
        rectangle = (twin.x[a], twin.y[a], twin.x[b], twin.y[b])  # many are inverted
        assert simulation.query_rect(*rectangle).tolist() == twin.within(*rectangle)


@pytest.mark.parametrize("name", EXACT)
def test_a_rectangle_of_neighbouring_numbers(name: str) -> None:
    """The border belongs to it, and the next number beyond does not."""
    simulation = Simulation(STARTS["random"](), EXACT[name])
    x, y = simulation.objects.x[5], simulation.objects.y[5]
    for low, high in ((x, np.nextafter(x, np.inf)), (np.nextafter(x, -np.inf), x)):
        assert simulation.query_rect(low, y, high, y).tolist() == [5]
        assert simulation.query_rect(x, np.nextafter(y, -np.inf), x, y).tolist() == [5]
    assert simulation.query_rect(np.nextafter(x, np.inf), y, x + 1e-9, y).tolist() == []
    assert simulation.query_rect(x, y - 1e-9, x, np.nextafter(y, -np.inf)).tolist() == []


@pytest.mark.parametrize("name", EXACT)
@pytest.mark.parametrize("start", ["clustered", "one place"])
def test_no_more_is_written_than_there_is_room_for(name: str, start: str) -> None:
    simulation, twin = Simulation(STARTS[start](), EXACT[name]), Twin(STARTS[start]())
    objects, storage, there = simulation.objects, simulation.storage, twin.pairs()
    find, ask = simulation.contestant.callable(_pairs), simulation.contestant.callable(_query_rect)
    for room in (0, 1, len(there) // 2, len(there) - 1, len(there)):
        out = np.full((len(there) + 5, 2), -7, np.int32)
        assert find(storage, objects.x, objects.y, objects.r, out[:room]) == len(there)
        assert (out[room:] == -7).all()
        written = list(map(tuple, out[:room].tolist()))
        assert len(set(written)) == room
        assert set(written) <= set(there)
    inside = twin.within(0.0, 0.0, 50.0, 50.0)
    for room in (0, 1, len(inside) - 1, len(inside)):
        numbers = np.full(len(inside) + 5, -7, np.int32)
        assert ask(storage, objects.x, objects.y, 0.0, 0.0, 50.0, 50.0, numbers[:room]) == len(inside)
        assert (numbers[room:] == -7).all()
        assert len(set(numbers[:room].tolist())) == room
        assert set(numbers[:room].tolist()) <= set(inside)


@pytest.mark.parametrize("capacity", CAPACITIES)
@pytest.mark.parametrize("per_leaf", [0, 1])
def test_powers_of_two(capacity: int, per_leaf: int) -> None:
    """From the smallest to the largest: each is nearly twice the mean of all below it."""
    span = 40 if SLOW else 500
    start = doubling(-span, span)
    simulation, twin = Simulation(start, variant("kdtree", capacity=capacity, per_leaf=per_leaf)), Twin(start)
    for _ in range(2):
        assert simulation.find_pairs().tolist() == [list(pair) for pair in twin.step()]
        assert audit(simulation.storage, simulation.objects) == []
        simulation.step()
    assert simulation.query_rect(0.0, 0.0, np.inf, np.inf).tolist() == twin.within(0.0, 0.0, np.inf, np.inf)


@pytest.mark.parametrize("recycle", [0, 1])
@pytest.mark.parametrize("per_leaf", [0, 1])
def test_a_tree_that_is_a_chain(per_leaf: int, recycle: int) -> None:
    """Deeper than the first stack of nodes to come back to: each object leaves for a quarter of the last one's way."""
    start = start_of(np.zeros(170), np.zeros(170), 1e-9, speed=0)
    simulation = Simulation(start, variant("kdtree", capacity=1, per_leaf=per_leaf, recycle=recycle))
    objects = simulation.objects
    for i in range(160):
        objects.x[i] = 0.25**i
        assert simulation.query_rect(0.0, 0.0, 0.0, 0.0).tolist() == list(range(i + 1, 170))
    twin = Twin(start)
    twin.take(objects)
    assert simulation.find_pairs().tolist() == [list(pair) for pair in twin.pairs()]
    assert simulation.query_rect(0.0, 0.0, 1.0, 1.0).tolist() == list(range(170))
    assert simulation.stats()["depth"] > 150
    assert audit(simulation.storage, objects) == []
    objects.x[:] = 0.0  # all come back
    assert len(simulation.find_pairs()) == 170 * 169 // 2
    assert audit(simulation.storage, objects) == []


@pytest.mark.parametrize("recycle", [0, 1])
@pytest.mark.parametrize("median", [0, 1])
@pytest.mark.parametrize("capacity", CAPACITIES)
def test_trees_that_are_emptied_and_filled_again(capacity: int, median: int, recycle: int) -> None:
    """All gather in one place, spread, gather elsewhere: leaves overflow, split, are emptied, merged, and split anew."""
    x, y = scattered(0, 100, size=SIZE, seed=9)
    start = start_of(x, y, 1.0)
    simulation = Simulation(start, variant("kdtree", capacity=capacity, recycle=recycle, median=median))
    objects, twin = simulation.objects, Twin(start)
    gathered = np.full(SIZE, 50.0)
    for xs, ys in [
        (gathered, gathered),
        (x, y),
        (x, gathered),
        (gathered - 49, y),
        (y, x),
        (x / 64, y / 64),
        (x, x),
    ] * 2:
        objects.x[:], objects.y[:] = xs, ys
        twin.take(objects)
        assert simulation.find_pairs().tolist() == [list(pair) for pair in twin.pairs()]
        assert audit(simulation.storage, objects) == []
    stats = simulation.stats()
    assert (stats["merges"] > 0) == (recycle == 1) or capacity == 63
    assert stats["leaves"] == 1 + stats["splits"] - stats["merges"]


def test_a_merge_that_makes_its_neighbour_ready_is_followed() -> None:
    """A sparse leaf whose sibling becomes a leaf only in the same update is merged with it, even if that one is fuller."""
    for seed in range(2 if SLOW else 20):
        x, y = scattered(0, 100, size=SIZE, seed=seed)
        simulation = Simulation(start_of(x, y, 1.0), variant("kdtree", capacity=12))
        rng = np.random.default_rng(seed)
        for _ in range(8):
            some = rng.random(SIZE) < 0.6
            simulation.objects.x[some] = rng.uniform(0, 100, some.sum()) ** 2 / 100
            simulation.find_pairs()
            assert audit(simulation.storage, simulation.objects) == []


@pytest.mark.parametrize("name", ["random", "clustered", "means", "diagonal"])
def test_leaf_only_misses_contacts_and_invents_none(name: str) -> None:
    right = set(Twin(STARTS[name]()).pairs())
    found = Simulation(STARTS[name](), variant("leaf-only", capacity=2)).find_pairs().tolist()
    assert set(map(tuple, found)) < right
    assert len(set(map(tuple, found))) == len(found)
    whole = Simulation(STARTS[name](), variant("leaf-only", capacity=63)).find_pairs().tolist()
    assert set(map(tuple, whole)) == right  # one leaf holds all


@pytest.mark.parametrize("name", EXACT)
def test_leaf_rectangles_hold_their_objects(name: str) -> None:
    """They tile what they cover: each object lies in one of them, or on a border between some."""
    simulation = Simulation(STARTS["random"](), EXACT[name])
    rectangles = simulation.leaf_rectangles()
    assert rectangles.shape == (len(rectangles), 4)
    assert (len(rectangles) == 0) == (name == "brute")
    if len(rectangles):
        x, y = simulation.objects.x[:, None], simulation.objects.y[:, None]
        inside = (rectangles[:, 0] <= x) & (x < rectangles[:, 2]) & (rectangles[:, 1] <= y) & (y < rectangles[:, 3])
        touched = (rectangles[:, 0] <= x) & (x <= rectangles[:, 2]) & (rectangles[:, 1] <= y) & (y <= rectangles[:, 3])
        assert (inside.sum(axis=1) <= 1).all()
        assert (touched.sum(axis=1) >= 1).all()
    stats = simulation.stats()
    assert stats.get("leaves", len(rectangles)) == len(rectangles) or name.startswith("skin")


def test_the_options_are_heeded() -> None:
    """Fewer, larger leaves; no merges; other splits; more or fewer squares; lists made more or less often."""
    x, y = scattered(0, 100, seed=1)
    start = start_of(x, y, 0.5)

    def stats_of(name: str, **options: int) -> dict[str, float]:
        simulation = Simulation(start, variant(name, **options), gravity=GRAVITY)
        simulation.step(20)
        return simulation.stats()

    assert stats_of("kdtree", capacity=2)["leaves"] > 2 * stats_of("kdtree", capacity=8)["leaves"]
    assert stats_of("kdtree", capacity=8, recycle=0)["merges"] == 0 < stats_of("kdtree", capacity=8)["merges"]
    assert stats_of("kdtree", capacity=2, median=1) != stats_of("kdtree", capacity=2, median=0)
    assert stats_of("kdtree", capacity=2, per_leaf=1) == stats_of("kdtree", capacity=2, per_leaf=0)
    assert stats_of("grid", per_ten=1)["leaves"] > stats_of("grid", per_ten=100)["leaves"]
    assert stats_of("skin", skin=20)["rebuilds"] > stats_of("skin", skin=2000)["rebuilds"]
    assert stats_of("ckdtree")["rebuilds"] == stats_of("grid")["rebuilds"] == 20


def test_medians_halve_a_leaf() -> None:
    """At most one more on one side than on the other, where no two coordinates are alike; a mean does not."""
    x, y = scattered(0, 1, size=17, seed=3)
    tree = Simulation(start_of(x**4, y**4, 1e-6), variant("kdtree", capacity=16, median=1)).storage
    assert sorted(tree.held[tree.buffer[1:3]].tolist()) == [8, 9]
    mean = Simulation(start_of(x**4, y**4, 1e-6), variant("kdtree", capacity=16)).storage
    assert mean.split[0] == pytest.approx(np.mean(x**4))
    assert sorted(mean.held[mean.buffer[1:3]].tolist()) != [8, 9]


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="some thousand objects, too many for plain Python")
@pytest.mark.parametrize("name", ["kdtree", "kdtree per object", "grid", "skin", "ckdtree"])
@pytest.mark.parametrize("start", ["uniform", "clustered", "mixed"])
def test_models_of_some_thousand_objects(name: str, start: str) -> None:
    """Arrays grow, pairs need more room: against brute, with gravity."""
    from tetrabench.collision.start.models import generate_objects

    contestant = variant("kdtree", per_leaf=0) if name == "kdtree per object" else variant(name)
    objects = generate_objects(start, 2000)
    simulation, brute = (
        Simulation(objects, one, gravity=GRAVITY, bounce=BOUNCE) for one in (contestant, variant("brute"))
    )
    for _ in range(3):
        np.testing.assert_array_equal(simulation.find_pairs(), brute.find_pairs())
        assert audit(simulation.storage, simulation.objects) == []
        simulation.step(7)
        brute.step(7)
    assert simulation.contacts == brute.contacts > 0
    for one, other in zip(simulation.objects, brute.objects, strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_start_of_one_object_has_no_pairs_wherever_it_goes() -> None:
    start = Start(start_of([1e300], [-1e300]).objects, 1.0, 1.0)
    for name in EXACT:
        simulation = Simulation(start, EXACT[name])
        simulation.step(3)
        assert simulation.find_pairs().shape == (0, 2)
        assert simulation.query_rect(0.0, -np.inf, np.inf, 0.0).tolist() == [0]
