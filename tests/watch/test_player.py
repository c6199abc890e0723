"""What keys do to a simulation; and that watching one changes nothing about it."""

import numpy as np
import pytest

from tests.watch.made import make_player, make_start, naive_contacts
from tetrabench.backends.collision import STRUCTURES
from tetrabench.collision.simulation import Simulation
from tetrabench.watch import player as module
from tetrabench.watch.player import KEYS, LARGEST, MOST_STEPS, Player


def options(player: Player) -> dict[str, int]:
    """Of the structure that it is in."""
    return {name: option.value for name, option in player.simulation.contestant.options.items()}


def same_bits(player: Player, other: Simulation) -> bool:
    return all(np.array_equal(a, b) for a, b in zip(player.simulation.objects, other.objects, strict=True))


def test_watching_changes_nothing(rng: np.random.Generator) -> None:
    start = make_start(rng, 60)
    plain = Simulation(start, STRUCTURES["brute"])
    contestants = {name: STRUCTURES[name] for name in ("kdtree", "grid", "skin", "ckdtree")}
    player = Player(Simulation(start, contestants["kdtree"]), contestants)
    for key in ("", "+", "b", "", "b", "b", "l", "b", "-", "r", "", "h"):
        player.press(key)
        player.advance()
        player.scene(60.0)
        plain.step()
        assert same_bits(player, plain)
    player.press("g")
    plain.gravity = 0.1
    player.advance()
    plain.step()
    assert same_bits(player, plain)
    assert player.simulation.contestant.name == "kdtree"  # round all of them


def test_pause_and_single_steps(rng: np.random.Generator) -> None:
    player = make_player(rng)
    done = []
    for keys in ("", "", ["space"], "", ["s"], "", ["right", "s"], "", ["space"], ""):
        for key in keys:
            player.press(key)
        player.advance()
        done.append(player.simulation.steps_done)
    assert done == [1, 2, 2, 2, 3, 3, 5, 5, 6, 7]
    player.press("s")  # stops
    assert player.is_paused


def test_steps_a_frame_double_and_halve(rng: np.random.Generator) -> None:
    player = make_player(rng)
    for key, steps in (("down", 1), ("up", 2), ("up", 4), ("down", 2)):
        player.press(key)
        assert player.steps_a_frame == steps
        before = player.simulation.steps_done
        player.advance()
        assert player.simulation.steps_done == before + steps
    for _ in range(30):
        player.press("up")
    assert player.steps_a_frame == MOST_STEPS
    assert f"{MOST_STEPS:,} steps a frame" in player.scene().lines[2]


def test_it_ends_after_so_many_steps_and_when_it_is_quit(rng: np.random.Generator) -> None:
    player = make_player(rng)
    player.limit = 5
    player.press("up")
    player.press("up")
    done = []
    while not player.is_over:
        player.advance()
        done.append(player.simulation.steps_done)
    assert done == [4, 5]
    for key in ("q", "escape"):
        player = make_player(rng)
        assert not player.is_over
        player.press(key)
        assert player.is_over


def test_options_change_within_their_limits(rng: np.random.Generator) -> None:
    player = make_player(rng)
    first = options(player)
    least, most = (getattr(STRUCTURES["kdtree"].options["capacity"], end) for end in ("least", "most"))
    player.press("+")
    player.press("+")  # both count, before a frame
    player.press("r")
    assert f"capacity {first['capacity'] + 2}" in player.scene().lines[2]
    player.advance()
    assert options(player) == first | {"capacity": first["capacity"] + 2, "recycle": 1 - first["recycle"]}
    for key, end in (("+", most), ("-", least)):
        for _ in range(most + 1):
            player.press(key)
        player.advance()
        assert options(player)["capacity"] == end
        player.press(key)
        assert player.note == f"capacity {least} to {most}"
        assert player.note in player.scene().lines[1]
        player.advance()
        assert options(player)["capacity"] == end


def test_more_capacity_means_fewer_leaves(rng: np.random.Generator) -> None:
    player = make_player(rng)
    player.press("space")
    leaves = []
    for keys in ("-" * 63, "+" * 7, "+" * 55):
        for key in keys:
            player.press(key)
        player.advance()
        leaves.append(player.simulation.stats()["leaves"])
    assert leaves[0] > leaves[1] > leaves[2]


def test_what_a_structure_has_not_is_said(rng: np.random.Generator) -> None:
    player = make_player(rng, "ckdtree", among=("ckdtree", "brute"))
    player.press("r")
    assert player.note == "ckdtree does not recycle leaves"
    player.press("b")
    player.advance()
    for key, note in (
        ("+", "brute has no capacity"),
        ("-", "brute has no capacity"),
        ("l", ""),
        ("l", "brute has no leaves"),
    ):
        player.press(key)
        assert player.note == note
        assert note in player.scene().lines[1]
    player.press("x")  # no key of ours: nothing happens
    assert player.note == "brute has no leaves"
    player.press("h")
    assert player.note == ""


def test_backends_go_round_with_the_options_that_they_had(rng: np.random.Generator) -> None:
    player = make_player(rng, among=("kdtree", "grid", "leaf-only"))
    player.press("+")
    names = []
    for _ in range(4):
        player.press("b")
        assert player.note == f"building {player.contestant.name} ..."
        assert player.note in player.scene().lines[1]
        assert player.simulation.contestant is not player.contestant  # the frame that says so comes first
        player.advance()
        assert player.note == ""
        names.append(player.simulation.contestant.name)
    assert names == ["grid", "leaf-only", "kdtree", "grid"]
    player.press("b")
    player.press("b")
    player.advance()
    assert options(player)["capacity"] == STRUCTURES["kdtree"].options["capacity"].value + 1


def test_what_tests_all_pairs_is_not_offered_for_many(
    rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch
) -> None:
    player = make_player(rng, among=("kdtree", "brute", "grid"))
    monkeypatch.setattr(module, "MANY", 59)
    player.press("b")
    assert player.contestant.name == "grid"
    monkeypatch.setattr(module, "MANY", 60)
    player.press("b")
    player.press("b")
    assert player.contestant.name == "brute"
    monkeypatch.setattr(module, "MANY", 59)
    player.advance()
    player.press("b")  # out of it, too
    assert player.contestant.name == "grid"


def test_gravity_comes_back_as_it_was(rng: np.random.Generator) -> None:
    player = make_player(rng)
    assert "gravity off" in player.scene().lines[2]
    player.press("g")
    assert player.simulation.gravity == 0.1
    player.simulation.gravity = 0.25
    for expected in (0.0, 0.25):
        player.press("g")
        assert player.simulation.gravity == expected
    assert "gravity 0.25" in player.scene().lines[0]


def test_the_words_are_those_of_the_simulation(rng: np.random.Generator) -> None:
    player = make_player(rng, "leaf-only", count=2)
    player.simulation.objects.x[:] = player.simulation.objects.y[:] = 50.0
    for _ in range(3):
        player.advance()
        facts, times, _ = player.scene(59.7).lines
        contacts = len(naive_contacts(player.simulation.objects))
        stats = player.simulation.stats()
        assert f"step {player.simulation.steps_done}  " in facts
        assert f"2 objects     {contacts} contact" in facts
        assert "leaf-only (misses contacts)" in facts
        assert f"1 leaf     depth {stats['depth']:.0f}" in facts
        assert "60 frames a second" in times
        assert all(phase in times for phase in ("update", "pairs", "respond", "move"))
    player = make_player(rng)
    facts = player.scene().lines[0]
    assert f"{player.simulation.stats()['leaves']:.0f} leaves" in facts
    assert "misses" not in facts
    assert "frames" not in player.scene().lines[1]


def test_times_are_those_of_the_last_frames(rng: np.random.Generator, monkeypatch: pytest.MonkeyPatch) -> None:
    player = make_player(rng)
    clock = {"update": 0.0, "pairs": 0.0, "respond": 0.0, "move": 0.0}

    def step(count: int) -> None:
        clock["pairs"] += 0.003 * count
        player.simulation.steps_done += count

    monkeypatch.setattr(type(player.simulation), "phase_seconds", clock)
    monkeypatch.setattr(player.simulation, "step", step)
    player._marks.clear()
    player._mark()
    player.press("up")
    assert "pairs 0.00" in player.scene().lines[1]  # no step yet
    for _ in range(3):
        player.advance()
    assert "pairs 3.00" in player.scene().lines[1]
    clock["pairs"] += 1e3
    for _ in range(module.FRAMES + 2):
        player.advance()
    assert "pairs 3.00" in player.scene().lines[1]  # forgotten
    clock["pairs"] += 1e3
    player.press("b")
    player.advance()
    assert "pairs 3.00" in player.scene().lines[1]  # of the structure that it is in, alone


def test_help_names_all_keys_and_all_keys_do_something(rng: np.random.Generator) -> None:
    player = make_player(rng)
    assert all(callable(getattr(player, method)) for _, method in KEYS.values())
    player.press("h")
    lines = player.scene().lines
    assert [line.partition(":")[0] for line in lines[3:]] == list(KEYS)
    player.press("h")
    assert len(player.scene().lines) == 3
    assert len(Player(player.simulation, player.contestants, has_keys=False).scene().lines) == 2


def test_zoom_stays_within_reason_and_the_whole_comes_back(rng: np.random.Generator) -> None:
    player = make_player(rng)
    whole = player.view
    player.zoom(2.0, 100.0, 200.0)
    assert player.view.scale == 2 * whole.scale
    for _ in range(50):
        player.zoom(2.0, 100.0, 200.0)
    assert player.simulation.objects.r.max() * player.view.scale == pytest.approx(LARGEST)
    player.shift(10.0, 10.0)
    for _ in range(50):
        player.zoom(0.5, 100.0, 200.0)
    assert player.view.scale == pytest.approx(0.5 * whole.scale)
    player.press("f")
    assert player.view == whole


def test_a_window_of_another_size_shows_the_whole_box_or_the_same_place(rng: np.random.Generator) -> None:
    player = make_player(rng)
    player.resize(700, 900)
    assert (player.view.width, player.view.height) == (700, 900)
    assert player.view == player._whole
    player.zoom(2.0, 300.0, 300.0)
    before = player.view
    player.resize(800, 600)
    assert (player.view.x, player.view.y, player.view.scale) == (before.x, before.y, before.scale)
    assert (player.view.width, player.view.height) == (800, 600)
    player.press("f")
    assert player.view == player._whole
