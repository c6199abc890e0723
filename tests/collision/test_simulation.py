"""The Python face: what it refuses, what it leaves alone, what it counts, and that it does not grow."""

import os
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numba import config

from tests.collision.audit import audit
from tests.collision.starts import SLOW, STARTS, scattered, start_of
from tests.collision.variants import EXACT, variant
from tetrabench.backends.collision import CONTESTANTS, STRUCTURES
from tetrabench.backends.collision.kdtree.storage import BUFFERS, NODES
from tetrabench.collision.contestant import CollisionContestant
from tetrabench.collision.interface import Storage
from tetrabench.collision.objects import Objects, Start, make_objects
from tetrabench.collision.simulation import Simulation
from tetrabench.collision.twin import Twin
from tetrabench.errors import InputError

KDTREE = STRUCTURES["kdtree"]
SQUARES = [STRUCTURES["grid"], STRUCTURES["skin"]]


def columns(**other: object) -> Objects:
    """Four good objects, some columns replaced."""
    good = {name: np.arange(1.0, 5) for name in Objects._fields}
    return Objects(**{**good, **{name: np.array(values, float) for name, values in other.items()}})


# ---- refusals


@pytest.mark.parametrize(
    ("objects", "message"),
    [
        (columns(x=[1, np.nan, 3, 4]), "object 1: the x has to be a finite number, not nan"),
        (columns(y=[1, 2, np.inf, np.nan]), r"object 2: the y has to be a finite number, not inf \(and 1 more\)"),
        (columns(vx=[-np.inf, 2, 3, 4]), "object 0: the velocity in x has to be a finite number, not -inf"),
        (columns(r=[1, 2, 0, 4]), "object 2: the radius has to be above 0, not 0.0"),
        (columns(r=[1, -2, 3, 4]), "object 1: the radius has to be above 0, not -2.0"),
        (columns(m=[1, 2, 3, -0.0]), "object 3: the mass has to be above 0, not -0.0"),
        (columns(y=[1, 2, 3]), "objects: lists of one length are needed, not x 4, y 3, vx 4, vy 4, r 4, m 4"),
        (columns(r=[]), "objects: lists of one length are needed, not x 4, y 4, vx 4, vy 4, r 0, m 4"),
    ],
)
@pytest.mark.parametrize("name", ["kdtree", "brute"])
def test_what_is_no_circle_is_refused(objects: Objects, message: str, name: str) -> None:
    with pytest.raises(InputError, match=f"^{message}$"):
        Simulation(Start(objects, 10.0, 10.0), STRUCTURES[name])


@pytest.mark.parametrize("box", [(0, 1), (1, 0), (-1, 1), (np.nan, 1), (1, np.inf)])
def test_a_box_that_is_none_is_refused(box: tuple[float, float]) -> None:
    with pytest.raises(InputError, match=f"^a box of {box[0]} x {box[1]}: width and height have to be finite numbers"):
        Simulation(Start(columns(), *box), KDTREE)


@pytest.mark.parametrize(
    ("name", "value", "message"),
    [
        ("gravity", np.nan, "gravity: a finite number is needed, not nan"),
        ("gravity", -np.inf, "gravity: a finite number is needed, not -inf"),
        ("bounce", -0.1, "bounce: a number from 0 to 1 is needed, not -0.1"),
        ("bounce", 1.1, "bounce: a number from 0 to 1 is needed, not 1.1"),
        ("bounce", np.nan, "bounce: a number from 0 to 1 is needed, not nan"),
        ("mode", "papr", "no mode 'papr'; did you mean 'paper'"),
    ],
)
def test_rules_out_of_their_range_are_refused(name: str, value: object, message: str) -> None:
    """At the beginning, and between steps, where the rule stays what it was."""
    start = Start(columns(), 10.0, 10.0)
    with pytest.raises(InputError, match=message):
        Simulation(start, KDTREE, **{name: value})  # type: ignore[arg-type]
    simulation = Simulation(start, KDTREE, gravity=0.25, bounce=0.5, mode="full")
    rules = simulation.rules
    with pytest.raises(InputError, match=message):
        setattr(simulation, name, value)
    assert simulation.rules == rules == (0.25, 0.5, 10.0, 10.0, True)


@pytest.mark.parametrize(
    ("name", "option", "value"), [("kdtree", "capacity", 0), ("kdtree", "capacity", 64), ("skin", "skin", 0)]
)
def test_an_option_out_of_its_range_is_refused(name: str, option: str, value: int) -> None:
    """Made by hand, too; and the structure that there was stays."""
    bad = STRUCTURES[name]
    bad = replace(bad, options={**bad.options, option: replace(bad.options[option], value=value)})
    with pytest.raises(InputError, match=f"^{name}: {option}={value} cannot be"):
        Simulation(STARTS["random"](), bad)
    simulation = Simulation(STARTS["random"](), KDTREE)
    storage = simulation.storage
    with pytest.raises(InputError, match=f"^{name}: {option}={value} cannot be"):
        simulation.rebuild(bad)
    assert simulation.contestant is KDTREE
    assert simulation.storage is storage


def test_steps_backward_are_refused() -> None:
    simulation = Simulation(STARTS["random"](), KDTREE)
    for count in (-1, 2.5, "a"):
        with pytest.raises(InputError, match=r"^steps: a whole number, 0 or more$"):
            simulation.step(count)
    assert simulation.steps_done == 0


# ---- what it holds


@pytest.mark.parametrize("contestant", CONTESTANTS, ids=lambda contestant: contestant.name)
def test_the_start_is_left_untouched(contestant: object) -> None:
    start = STARTS["random"]()
    before = [column.copy() for column in start.objects]
    simulation = Simulation(start, contestant, gravity=0.1)  # type: ignore[arg-type]
    simulation.step(3)
    assert simulation.start is start
    assert len(simulation) == len(before[0])
    for one, other, live in zip(before, start.objects, simulation.objects, strict=True):
        np.testing.assert_array_equal(one, other)
        assert not np.shares_memory(other, live)


def test_what_is_outside_comes_back_or_flies_on() -> None:
    """Moving outward it is turned round, and comes back; without a velocity it stays; with bounce 0 it stands still."""
    objects = make_objects([-50, 150, 150, 50], [50, 20, 50, -30], [-2, 0, 3, 0], [0, 0, 0, -1], 1)
    simulation = Simulation(Start(objects, 100.0, 100.0), KDTREE)
    simulation.step(20)
    assert simulation.objects.x.tolist() == [-50 + 40, 150, 150 - 60, 50]
    assert simulation.objects.y.tolist() == [50, 20, 50, -30 + 20]
    simulation = Simulation(Start(objects, 100.0, 100.0), KDTREE, bounce=0.0)
    simulation.step(20)
    assert simulation.objects.x.tolist() == [-50, 150, 150, 50]
    assert simulation.objects.y.tolist() == [50, 20, 50, -30]


def test_objects_may_be_written_to_between_steps() -> None:
    start = STARTS["random"]()
    simulations, twin = [Simulation(start, contestant) for contestant in EXACT.values()], Twin(start)
    rng = np.random.default_rng(6)
    for _ in range(2 if SLOW else 6):
        x, vy = rng.uniform(-20, 120, len(start.objects.x)), rng.uniform(-1, 1, len(start.objects.x))
        for simulation in simulations:
            simulation.objects.x[:], simulation.objects.vy[:] = x, vy
        twin.x, twin.vy = x.tolist(), vy.tolist()
        twin.step()
        for simulation in simulations:
            simulation.step()
            assert [column.tolist() for column in simulation.objects[:4]] == [twin.x, twin.y, twin.vx, twin.vy]


def test_a_rebuild_keeps_all_but_the_structure() -> None:
    """One simulation through all structures, beside one that stays with its own; new radii are found then, too."""
    start = STARTS["clustered"]()
    wanderer, stayer = (
        Simulation(start, KDTREE, gravity=0.1, bounce=0.9),
        Simulation(start, KDTREE, gravity=0.1, bounce=0.9),
    )
    for contestant in EXACT.values():
        before = [column.tolist() for column in wanderer.objects]
        wanderer.rebuild(contestant)
        assert wanderer.contestant is contestant
        assert [column.tolist() for column in wanderer.objects] == before
        wanderer.step(2)
        stayer.step(2)
        assert [column.tolist() for column in wanderer.objects] == [column.tolist() for column in stayer.objects]
        assert (wanderer.steps_done, wanderer.contacts) == (stayer.steps_done, stayer.contacts)
        assert wanderer.gravity == 0.1
    twin = Twin(start)
    for contestant in EXACT.values():
        wanderer.objects.r[:] = np.linspace(0.5, 9, len(start.objects.r))
        wanderer.rebuild(contestant)
        twin.take(wanderer.objects)
        assert wanderer.find_pairs().tolist() == [list(pair) for pair in twin.pairs()]


def test_to_ask_changes_nothing() -> None:
    """Whoever asks between steps comes to the same places as who does not."""
    for contestant in EXACT.values():
        asking, silent = (Simulation(STARTS["clustered"](), contestant, gravity=0.1) for _ in range(2))
        for _ in range(2):
            asking.find_pairs()
            asking.query_rect(0, 0, 50, 50)
            asking.step(2)
            contacts = asking.contacts
            asking.find_pairs()
            assert asking.contacts == contacts
        silent.step(4)
        assert [column.tolist() for column in asking.objects] == [column.tolist() for column in silent.objects]


def test_pairs_and_numbers_are_arrays_of_their_own() -> None:
    simulation = Simulation(STARTS["clustered"](), KDTREE)
    pairs, numbers = simulation.find_pairs(), simulation.query_rect(0, 0, 100, 100)
    kept = pairs.copy(), numbers.copy()
    assert pairs.dtype == numbers.dtype == np.int32
    simulation.step(5)
    simulation.find_pairs()
    np.testing.assert_array_equal(pairs, kept[0])
    np.testing.assert_array_equal(numbers, kept[1])


def test_energy_and_momentum() -> None:
    objects = make_objects([1, 2], [10, 20], [3, -4], [1, 2], 1, [2, 5])
    simulation = Simulation(Start(objects, 100.0, 100.0), KDTREE, gravity=0.5)
    assert simulation.energy() == 0.5 * 2 * 10 + 0.5 * 5 * 20 + 0.5 * (2 * 10 + 5 * 20)
    assert simulation.momentum() == (6 - 20, 2 + 10)


# ---- what it counts


NAMES = {
    "kdtree": {"leaves", "depth", "fill", "relocations", "splits", "merges"},
    "leaf-only": {"leaves", "depth", "fill", "relocations", "splits", "merges"},
    "grid": {"leaves", "fill", "rebuilds"},
    "skin": {"listed", "rebuilds"},
    "ckdtree": {"rebuilds"},
    "brute": set(),
}


@pytest.mark.parametrize("contestant", CONTESTANTS, ids=lambda contestant: contestant.name)
def test_stats(contestant) -> None:  # type: ignore[no-untyped-def]
    simulation = Simulation(STARTS["random"](), contestant)
    stats = simulation.stats()
    assert stats.keys() == NAMES[contestant.name]
    assert all(type(number) is float for number in stats.values())
    assert stats.get("rebuilds", 0) == stats.get("relocations", 0) == stats.get("merges", 0) == 0
    simulation.step(3)
    assert simulation.stats().keys() == stats.keys()


def test_relocations_are_objects_that_have_left_their_leaf() -> None:
    """Counted with the rectangles of before; those beyond the capacity of a leaf are counted like all others."""
    for start in ("random", "five bursts", "lattice of duplicates"):
        simulation = Simulation(STARTS[start](), variant("kdtree", capacity=2, recycle=0), gravity=0.1)
        expected = 0
        for _ in range(3 if SLOW else 8):
            before = leaves_of(simulation)
            rectangles = simulation.leaf_rectangles()
            simulation.step()
            x, y = simulation.objects.x, simulation.objects.y
            left, bottom, right, top = rectangles[before].T
            expected += int(np.sum((x < left) | (x >= right) | (y < bottom) | (y >= top)))
            simulation.find_pairs()
            assert simulation.stats()["relocations"] == expected, start
        assert expected > 0


def leaves_of(simulation: Simulation) -> np.ndarray:
    """The leaf of each object, as the place of its rectangle."""
    simulation.find_pairs()
    x, y = simulation.objects.x[:, None], simulation.objects.y[:, None]
    low_x, low_y, high_x, high_y = simulation.leaf_rectangles().T
    inside = (low_x <= x) & (x < high_x) & (low_y <= y) & (y < high_y)
    assert (inside.sum(axis=1) == 1).all()
    return np.argmax(inside, axis=1)


def test_stats_of_a_tree_are_what_it_holds() -> None:
    simulation = Simulation(STARTS["random"](), variant("kdtree", capacity=3), gravity=0.1)
    relocations = 0.0
    for _ in range(3 if SLOW else 15):
        simulation.find_pairs()
        rectangles, stats = simulation.leaf_rectangles(), simulation.stats()
        assert stats["leaves"] == len(rectangles) == 1 + stats["splits"] - stats["merges"]
        assert stats["fill"] == len(simulation) / (3 * len(rectangles))
        levels = simulation.storage.level[: simulation.storage.state[NODES]]
        assert stats["depth"] <= levels.max()
        assert stats["relocations"] >= relocations
        relocations = stats["relocations"]
        simulation.step()
    assert relocations > 0


def test_who_stays_in_a_leaf_is_no_relocation() -> None:
    """Nor are those that lie in one place, more than a leaf has room for."""
    for start in ("one place", "two places", "touching"):
        simulation = Simulation(STARTS[start](), variant("kdtree", capacity=2))
        simulation.step(3)
        assert simulation.stats()["relocations"] == 0, start


def arrays_of(storage: Storage) -> list[np.ndarray]:
    """All arrays of a storage and of what it is made of, but for the radii, which are the simulation's."""
    if isinstance(storage, np.ndarray):
        return [storage]
    parts = storage._asdict() if hasattr(storage, "_asdict") else {}
    return [array for name, part in parts.items() if name != "radius" for array in arrays_of(part)]


@pytest.mark.parametrize("name", EXACT)
def test_structure_bytes_are_what_the_arrays_hold(name: str) -> None:
    simulation = Simulation(STARTS["random"](), EXACT[name], gravity=0.1)
    for _ in range(3):
        sizes = simulation.structure_bytes()
        for part, (used, reserved) in sizes.items():
            assert 0 <= used <= reserved, part
        if not name.startswith("ckdtree"):
            assert sum(reserved for _, reserved in sizes.values()) == sum(
                a.nbytes for a in arrays_of(simulation.storage)
            )
        simulation.step(4)
    sizes = simulation.structure_bytes()
    if name.startswith("kdtree"):
        tree = simulation.storage
        nodes, buffers = int(tree.state[NODES]), int(tree.state[BUFFERS])
        assert sizes["rect"] == (32 * nodes, tree.rect.nbytes)
        assert sizes["x"] == (8 * buffers * tree.number.shape[1], tree.x.nbytes)
        assert sizes["held"][0] == 4 * buffers


@pytest.mark.filterwarnings("ignore:invalid value")  # of numpy's, where the JIT is off
@pytest.mark.parametrize("capacity", [1, 2, 3, 16])
@pytest.mark.parametrize("median", [0, 1])
def test_places_that_are_no_numbers_do_no_harm_to_the_tree(capacity: int, median: int) -> None:
    """As after an overflow: it neither hangs nor loses an object, and finds all others."""
    simulation = Simulation(STARTS["random"](), variant("kdtree", capacity=capacity, median=median))
    objects, twin = simulation.objects, Twin(STARTS["random"]())
    for value in (np.nan, np.inf, -np.inf, np.nan):
        objects.x[2::9] = value
        objects.y[5::9] = value
        twin.take(objects)
        assert simulation.find_pairs().tolist() == [list(pair) for pair in twin.pairs()]
        simulation.rebuild(simulation.contestant)
        assert simulation.find_pairs().tolist() == [list(pair) for pair in twin.pairs()]
        held = simulation.storage.held
        assert held[: simulation.storage.state[BUFFERS]].sum() == len(simulation)


# ---- it does not grow


@pytest.mark.skipif(bool(config.DISABLE_JIT or config.BOUNDSCHECK), reason="hundred thousand steps")
@pytest.mark.parametrize("contestant", [variant("kdtree", capacity=4), *SQUARES], ids=lambda one: one.name)
def test_memory_is_flat_over_a_hundred_thousand_steps(contestant: CollisionContestant) -> None:
    """Under gravity, where objects gather: nothing is reserved, and nothing leaks, after the first ten thousand."""
    x, y = scattered(0, 300, size=100)
    simulation = Simulation(start_of(x, y, box=300.0), contestant, gravity=0.1, bounce=0.9)
    simulation.step(10_000)
    reserved, resident, contacts = total(simulation.structure_bytes()), resident_bytes(), 0
    for _ in range(9):
        simulation.step(10_000)
        contacts += simulation.contacts
    assert contacts > 0
    assert total(simulation.structure_bytes()) <= reserved
    assert resident_bytes() - resident < 4 << 20
    simulation.find_pairs()
    assert audit(simulation.storage, simulation.objects) == []


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="some thousand steps")
def test_without_recycling_a_tree_grows_by_what_is_split() -> None:
    """Two nodes and a buffer a split, and nothing ever comes back; with it there are as many as at once in use."""
    x, y = scattered(0, 300, size=100)
    grown = {}
    for recycle in (0, 1):
        contestant = variant("kdtree", capacity=4, recycle=recycle)
        simulation = Simulation(start_of(x, y, box=300.0), contestant, gravity=0.1, bounce=0.9)
        simulation.step(3000)
        stats, state = simulation.stats(), simulation.storage.state
        grown[recycle] = stats["leaves"], total(simulation.structure_bytes())
        if recycle:
            assert state[NODES] < 2 * 100 < stats["splits"]
        else:
            assert state[NODES] == 1 + 2 * stats["splits"] == 2 * stats["leaves"] - 1
            assert state[BUFFERS] == stats["leaves"]
    assert grown[0][0] > 4 * grown[1][0]
    assert grown[0][1] > 2 * grown[1][1]


def total(sizes: object) -> int:
    return sum(reserved for _, reserved in sizes.values())  # type: ignore[attr-defined]


def resident_bytes() -> int:
    """Of this process; 0 where the system does not tell."""
    statm = Path("/proc/self/statm")
    return int(statm.read_text().split()[1]) * os.sysconf("SC_PAGE_SIZE") if statm.exists() else 0


@pytest.mark.parametrize("capacity", [1, 4, 8])
def test_what_is_merged_away_is_taken_again(capacity: int) -> None:
    """Objects gather and spread, again and again elsewhere: no node or buffer is made that was not needed the first time."""
    simulation = Simulation(STARTS["random"](), variant("kdtree", capacity=capacity))
    rng = np.random.default_rng(1)
    sizes = []
    for spread in [100, 1, 100, 3, 50, 100] * 3:
        simulation.objects.x[:] = rng.uniform(0, spread, len(simulation))
        simulation.find_pairs()
        sizes.append(int(simulation.storage.state[BUFFERS]))
        assert audit(simulation.storage, simulation.objects) == []
    assert sizes[-1] == max(sizes) < simulation.stats()["splits"] / 2
    assert simulation.storage.state[NODES] < simulation.stats()["splits"]
