"""The verb that shows a simulation."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tests.test_cli import refusal, say
from tetrabench.collision import simulation
from tetrabench.collision.objects import Start, make_objects
from tetrabench.collision.start.files import write_objects
from tetrabench.watch import film, opening, window
from tetrabench.watch.player import Player


@pytest.fixture(autouse=True)
def few(monkeypatch: pytest.MonkeyPatch) -> None:
    """Objects of a model, where nobody says how many."""
    monkeypatch.setattr(opening, "USUAL_OBJECTS", 20)


@pytest.fixture
def shown(monkeypatch: pytest.MonkeyPatch) -> list[tuple[Player, dict[str, object]]]:
    """What comes into the window, which is not opened."""
    calls: list[tuple[Player, dict[str, object]]] = []
    monkeypatch.setattr(window, "open_window", lambda player, **words: calls.append((player, words)))
    monkeypatch.setattr(window, "check_window", lambda: None)
    return calls


@pytest.fixture
def no_work(monkeypatch: pytest.MonkeyPatch) -> None:
    """What is refused is refused before anything is simulated."""

    def work(*_: object, **__: object) -> None:
        raise AssertionError("it has begun to work")

    monkeypatch.setattr(simulation.Simulation, "__init__", work)


def test_a_window_with_all_that_was_asked_for(shown: list[tuple[Player, dict[str, object]]]) -> None:
    words = [
        "--objects",
        30,
        "--seed",
        5,
        "--gravity",
        0.1,
        "--bounce",
        0.9,
        "--mode",
        "full",
        "--steps",
        7,
        "--fps",
        50,
    ]
    words += [
        "--backend",
        "kdtree",
        "--option",
        "kdtree.capacity=4",
        "--option",
        "recycle=0",
        "--option",
        "grid.per_ten=50",
    ]
    result = say("watch", *words)
    assert (result.exit_code, result.stdout, result.stderr) == (0, "", "")
    ((player, said),) = shown
    assert said == {"frames_a_second": 50, "title": "tetrabench watch: uniform"}
    watched = player.simulation
    assert (len(watched), watched.gravity, watched.bounce, watched.mode) == (30, 0.1, 0.9, "full")
    assert player.limit == 7
    values = {name: option.value for name, option in watched.contestant.options.items()}
    assert (watched.contestant.name, values["capacity"], values["recycle"]) == ("kdtree", 4, 0)
    assert player.contestants["grid"].options["per_ten"].value == 50
    assert player.contestants["leaf-only"].options["capacity"].value != 4
    from tetrabench.collision.start.models import generate_objects

    np.testing.assert_array_equal(watched.objects.x, generate_objects("uniform", 30, seed=5).objects.x)


def test_usual_choices(shown: list[tuple[Player, dict[str, object]]]) -> None:
    assert say("watch").exit_code == 0
    ((player, said),) = shown
    watched = player.simulation
    assert (len(watched), watched.gravity, watched.bounce, watched.mode) == (20, 0.0, 1.0, "paper")
    assert (watched.contestant.name, player.limit, said["frames_a_second"]) == ("kdtree", None, 60)


def test_an_option_without_a_backend_is_that_of_the_one_asked_for(
    shown: list[tuple[Player, dict[str, object]]],
) -> None:
    assert say("watch", "--backend", "grid", "--option", "per_ten=50").exit_code == 0
    assert shown[0][0].simulation.contestant.options["per_ten"].value == 50


def test_objects_of_a_file(shown: list[tuple[Player, dict[str, object]]], tmp_path: Path) -> None:
    start = Start(make_objects([10.0, 20.0, 30.0], [5.0, 5.0, 9.0]), 64.0, 32.0)
    write_objects(start, tmp_path / "three.csv")
    assert say("watch", "--model", tmp_path / "three.csv", "--backend", "leaf-only").exit_code == 0
    ((player, said),) = shown
    assert said["title"] == "tetrabench watch: three.csv"
    np.testing.assert_array_equal(player.simulation.objects.x, start.objects.x)
    assert (player.simulation.start.width, player.simulation.start.height) == (64.0, 32.0)
    assert "misses contacts" in player.scene().lines[0]


def test_recordings(tmp_path: Path) -> None:
    pytest.importorskip("imageio_ffmpeg")
    for name, head in (("a.png", b"\x89PNG"), ("a.gif", b"GIF89a"), ("a.mp4", b"\x00\x00\x00")):
        result = say("watch", "--record", tmp_path / name, "--steps", 2, "--backend", "grid", "--model", "mixed")
        assert (result.exit_code, result.stdout) == (0, "")
        assert result.stderr == f"wrote {tmp_path / name}: 2 steps of 20 objects in grid\n"
        assert (tmp_path / name).read_bytes().startswith(head)
    result = say("watch", "--record", tmp_path / "a.gif", "--steps", 1, "--fps", 10)
    assert result.stderr == f"wrote {tmp_path / 'a.gif'}: 1 step of 20 objects in kdtree\n"
    with Image.open(tmp_path / "a.gif") as image:
        assert image.n_frames == 1


def test_a_recording_is_of_300_steps_and_needs_no_pygame(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    recorded: list[tuple[Player, Path, int, int]] = []

    def record(player: Player, path: Path, steps: int, *, frames_a_second: int, tell: object) -> None:
        recorded.append((player, path, steps, frames_a_second))

    monkeypatch.setattr(film, "record", record)
    monkeypatch.setattr(window, "find_spec", lambda name: None)
    assert say("watch", "--record", tmp_path / "a.gif").exit_code == 0
    ((player, path, steps, frames_a_second),) = recorded
    assert (path, steps, frames_a_second, player.has_keys) == (tmp_path / "a.gif", 300, 30, False)
    assert "tetrabench[watch]" in refusal("watch")


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["--backend", "kdtre"], "no backend 'kdtre' in the family collision; did you mean 'kdtree'?"),
        (["--option", "kdtree.capacity=64"], "kdtree: capacity=64 cannot be; it takes 1 to 63"),
        (["--option", "capacity=0"], "kdtree: capacity=0 cannot be; it takes 1 to 63"),
        (["--option", "grid.capacity=4"], "no option of grid 'capacity'"),
        (["--option", "gird.per_ten=4"], "no backend 'gird' in the family collision; did you mean 'grid'?"),
        (["--option", "capacity=4,8"], "option 'capacity=4,8': write NAME=N or BACKEND.NAME=N, in a whole number"),
        (["--option", "capacity"], "option 'capacity': write NAME=N"),
        (["--gravity", "nan"], "a finite number is needed, not nan"),
        (["--gravity", "-inf"], "a finite number is needed, not -inf"),
        (["--bounce", "1.01"], "a number from 0 to 1 is needed, not 1.01"),
        (["--bounce", "nan"], "a number from 0 to 1 is needed, not nan"),
        (["--mode", "half"], "'half' is not one of 'paper', 'full'"),
        (["--record", "a.avi"], "recordings are .png, .gif or .mp4"),
        (["--record", "nowhere/a.gif"], "there is no folder nowhere"),
        (["--steps", "-1"], "-1 is not in the range x>=0"),
        (["--fps", "0"], "0 is not in the range 1<=x<=100"),
        (["--numbering", "rcm"], "rcm"),
        (["--numbering", "random"], "no numbering 'random'"),
        (["--model", "unifrom"], "uniform"),
        (["--model", "none.csv"], "none.csv"),
        (["--objects", "many"], "'many' is no count"),
        (["--record", "a.gif", "--steps", "0"], "a film needs 1 step at least"),
    ],
)
@pytest.mark.usefixtures("shown", "no_work")
def test_bad_input_is_refused_before_any_work(
    words: list[str], line: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert line in refusal("watch", *words)
    assert not list(tmp_path.iterdir())


@pytest.mark.usefixtures("no_work")
def test_what_is_read_is_not_written_over(tmp_path: Path) -> None:
    write_objects(Start(make_objects([10.0], [5.0]), 64.0, 32.0), tmp_path / "one.csv")
    (tmp_path / "one.png").symlink_to(tmp_path / "one.csv")
    before = (tmp_path / "one.csv").read_bytes()
    assert "is what is read" in refusal("watch", "--model", tmp_path / "one.csv", "--record", tmp_path / "one.png")
    assert (tmp_path / "one.csv").read_bytes() == before
