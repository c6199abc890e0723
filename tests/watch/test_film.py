"""What is recorded: pixels, frames, and what stands in the way."""

import stat
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_rgb
from PIL import Image

from tests.watch.made import make_player
from tetrabench.backends.collision import STRUCTURES
from tetrabench.collision.objects import Start, make_objects
from tetrabench.collision.simulation import Simulation
from tetrabench.errors import InputError
from tetrabench.watch import film
from tetrabench.watch.player import Player
from tetrabench.watch.scene import BACKGROUND, CONTACT, FLOOR, LEAF, OBJECT, OPACITY


def three() -> Player:
    """Two in contact, and one alone in another leaf; nothing moves."""
    objects = make_objects([30.0, 45.0, 150.0], [20.0, 20.0, 70.0])
    simulation = Simulation(Start(objects, 200.0, 100.0), STRUCTURES["kdtree"])
    simulation.rebuild(STRUCTURES["kdtree"])
    return Player(simulation, {"kdtree": STRUCTURES["kdtree"]}, has_keys=False)


def colour(name: str, ground: str = FLOOR, opacity: float = 1.0) -> np.ndarray:
    return 255 * (opacity * np.array(to_rgb(name)) + (1 - opacity) * np.array(to_rgb(ground)))


def untold(done: int, total: int) -> None:
    """Nobody is told."""


@pytest.mark.parametrize("suffix", [".png", ".PNG", ".gif"])
def test_pixels_are_of_the_colour_of_what_is_there(tmp_path: Path, suffix: str) -> None:
    player = three()
    film.record(player, tmp_path / f"a{suffix}", 2, tell=untold)
    with Image.open(tmp_path / f"a{suffix}") as image:
        assert image.size == (player.view.width, player.view.height)
        image.seek(image.n_frames - 1 if suffix == ".gif" else 0)
        pixels = np.asarray(image.convert("RGB")).astype(float)
    view = player.view

    def at(x: float, y: float) -> np.ndarray:
        return pixels[int(view.down(y)), int(view.across(x))]

    tolerance = 6 if suffix == ".gif" else 2  # of 256 colours
    np.testing.assert_allclose(at(26, 20), colour(CONTACT, opacity=OPACITY), atol=tolerance)
    np.testing.assert_allclose(at(50, 20), colour(CONTACT, opacity=OPACITY), atol=tolerance)
    np.testing.assert_allclose(at(150, 70), colour(OBJECT, opacity=OPACITY), atol=tolerance)
    np.testing.assert_allclose(at(150, 78), colour(OBJECT, opacity=OPACITY), atol=tolerance)
    np.testing.assert_allclose(at(150, 82), colour(FLOOR), atol=tolerance)
    np.testing.assert_allclose(at(26, 80), colour(FLOOR), atol=tolerance)
    np.testing.assert_allclose(pixels[-3, 3], colour(BACKGROUND), atol=tolerance)


def test_borders_of_leaves_are_drawn_where_they_are(rng: np.random.Generator) -> None:
    scene = make_player(rng, count=200).scene()
    scene = replace(scene, places=np.empty((0, 2)), radii=np.empty(0), in_contact=np.empty(0, np.bool_))
    figure = film.make_figure(scene.width, scene.height)
    film.paint(figure, scene)
    pixels = film._pixels(figure).astype(float)
    inner = [leaf for leaf in scene.leaves.astype(int) if leaf[0] > np.rint(scene.box[0])]
    assert len(inner) > 3
    for left, top, _, bottom in inner:
        near = pixels[(top + bottom) // 2, left - 1 : left + 1]
        np.testing.assert_allclose(near[np.argmax(near.sum(axis=1))], colour(LEAF), atol=3)


def test_a_frame_a_step(rng: np.random.Generator, tmp_path: Path) -> None:
    imageio_ffmpeg = pytest.importorskip("imageio_ffmpeg")
    told: list[tuple[int, int]] = []
    for suffix in (".gif", ".mp4"):
        player = make_player(rng, count=8)
        film.record(player, tmp_path / f"a{suffix}", 4, frames_a_second=20, tell=lambda *far: told.append(far))
        assert player.simulation.steps_done == 4
    assert told == 2 * [(1, 4), (2, 4), (3, 4), (4, 4)]
    with Image.open(tmp_path / "a.gif") as image:
        assert image.n_frames == 4
        assert image.info["duration"] == 50
        assert image.info["loop"] == 0
        frames = []
        for frame in range(4):
            image.seek(frame)
            frames.append(image.convert("RGB").tobytes())
        ours = np.array(film._palette().getpalette()).reshape(-1, 3)
        used = {colour for _, colour in image.convert("RGB").getcolors(1 << 16)}
        assert used <= {tuple(colour) for colour in ours.tolist()}  # the same in all frames: nothing flickers
    assert len(set(frames)) == 4
    assert (tmp_path / "a.mp4").read_bytes()[4:8] == b"ftyp"
    frames, seconds = imageio_ffmpeg.count_frames_and_secs(str(tmp_path / "a.mp4"))
    assert frames == 4
    assert seconds == pytest.approx(0.2, abs=0.06)
    reader = imageio_ffmpeg.read_frames(str(tmp_path / "a.mp4"))
    assert next(reader)["size"] == (player.view.width, player.view.height)
    reader.close()


def test_a_picture_is_of_the_last_step(rng: np.random.Generator, tmp_path: Path) -> None:
    player = make_player(rng)
    film.record(player, tmp_path / "a.png", 3, tell=untold)
    film.record(player, tmp_path / "b.png", 0, tell=untold)
    assert player.simulation.steps_done == 3
    np.testing.assert_array_equal(Image.open(tmp_path / "a.png"), Image.open(tmp_path / "b.png"))
    film.record(player, tmp_path / "b.png", 1, tell=untold)
    assert (np.asarray(Image.open(tmp_path / "a.png")) != np.asarray(Image.open(tmp_path / "b.png"))).any()


def test_a_film_of_nothing_and_unknown_suffixes_are_refused(rng: np.random.Generator, tmp_path: Path) -> None:
    for suffix in (".gif", ".mp4"):
        with pytest.raises(InputError, match=r"1 step at least; a \.png may show the start"):
            film.record(make_player(rng), tmp_path / f"a{suffix}", 0, tell=untold)
    for name in ("a.avi", "a", "a.png.txt"):
        with pytest.raises(InputError, match=r"recordings are \.png, \.gif or \.mp4"):
            film.record(make_player(rng), tmp_path / name, 1, tell=untold)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["a.png", "a.gif", "a.mp4"])
def test_what_cannot_be_written_is_one_line(rng: np.random.Generator, tmp_path: Path, name: str) -> None:
    pytest.importorskip("imageio_ffmpeg")
    with pytest.raises(InputError, match=r"cannot be written|ffmpeg has failed"):
        film.record(make_player(rng, count=3), tmp_path / "none" / name, 2, tell=untold)
    (tmp_path / name).mkdir()
    with pytest.raises(InputError, match=r"cannot be written|ffmpeg has failed"):
        film.record(make_player(rng, count=3), tmp_path / name, 2, tell=untold)


def test_without_ffmpeg_one_line_says_what_to_install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(film, "find_spec", lambda name: None)
    monkeypatch.setattr("shutil.which", lambda name: None)
    with pytest.raises(InputError, match=r'pip install "tetrabench\[watch\]"'):
        film.check_film(tmp_path / "a.mp4", 1)
    film.check_film(tmp_path / "a.gif", 1)
    monkeypatch.setattr("shutil.which", lambda name: "/bin/ffmpeg")
    assert film.find_ffmpeg() == "/bin/ffmpeg"


@pytest.mark.parametrize(
    ("script", "line"),
    [
        ("exit 3", "a.mp4: ffmpeg has failed: exit code 3"),
        ("echo hello >&2; echo no codec >&2; exit 1", "a.mp4: ffmpeg has failed: no codec"),
        ("cat > /dev/null; echo full >&2; exit 1", "a.mp4: ffmpeg has failed: full"),
    ],
)
def test_an_ffmpeg_that_fails_is_one_line(
    rng: np.random.Generator, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, script: str, line: str
) -> None:
    broken = tmp_path / "ffmpeg"
    broken.write_text(f"#!/bin/sh\n{script}\n")
    broken.chmod(broken.stat().st_mode | stat.S_IEXEC)
    monkeypatch.setattr(film, "find_ffmpeg", lambda: str(broken))
    with pytest.raises(InputError, match=line):
        film.record(make_player(rng, count=3), tmp_path / "a.mp4", 3, tell=untold)


def test_a_palette_holds_all_colours_of_a_scene() -> None:
    colours = np.array(film._palette().getpalette()).reshape(-1, 3)
    assert len(colours) <= 256
    for name in (BACKGROUND, FLOOR, LEAF, OBJECT, CONTACT):
        assert np.abs(colours - colour(name)).sum(axis=1).min() <= 3
