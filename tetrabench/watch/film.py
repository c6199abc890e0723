"""A recording without a window: a picture of the last step, or a film with a frame for each, painted by matplotlib."""

from __future__ import annotations

import itertools
import logging
import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import suppress
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import rc_context
from matplotlib.animation import FFMpegWriter
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import EllipseCollection, PolyCollection
from matplotlib.colors import to_rgb
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle
from PIL import Image

from tetrabench.errors import InputError
from tetrabench.watch.scene import (
    BACKGROUND,
    BRIGHT,
    CONTACT,
    FLOOR,
    LEAF,
    LETTERS,
    LINE,
    OBJECT,
    OPACITY,
    QUIET,
    WALL,
    Scene,
)

if TYPE_CHECKING:
    from pathlib import Path

    from tetrabench.watch.player import Player

DOTS = 100  # an inch; the figure is as many inches large as makes its dots the pixels of the scene
POINT = 72 / DOTS  # of a pixel: matplotlib's lines and letters are measured in points
QUALITY = ("-crf", "20", "-preset", "veryfast", "-pix_fmt", "yuv420p")  # small dots survive; every player plays it
SHADES = 15  # of each blend of two colours in a palette


def record(
    player: Player, path: Path, steps: int, *, frames_a_second: int = 30, tell: Callable[[int, int], None]
) -> None:
    """Play so many steps into a file.

    Args:
        player: without keys.
        path: .png, of the last step; .gif or .mp4, a frame a step.
        steps: 1 at least; 0 for a picture of the start.
        frames_a_second: of a film.
        tell: gets how many of how many steps are done.

    Raises:
        InputError: see `check_film`; the file cannot be written.
    """
    check_film(path, steps)
    suffix = path.suffix.lower()
    try:
        if suffix == ".png":
            _write_picture(player, path, steps, tell)
        else:
            write = _write_gif if suffix == ".gif" else _write_mp4
            write(_frames(player, steps, tell), path, frames_a_second)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from error


def check_film(path: Path, steps: int) -> None:
    """Whether a recording of so many steps can be made, before the work.

    Raises:
        InputError: another suffix, a film of no steps, or nothing that makes films.
    """
    suffix = path.suffix.lower()
    if suffix not in (".png", ".gif", ".mp4"):
        raise InputError(f"{path}: recordings are .png, .gif or .mp4, by the suffix")
    if suffix != ".png" and steps < 1:
        raise InputError(f"{path}: a film needs 1 step at least; a .png may show the start")
    if suffix == ".mp4":
        find_ffmpeg()


def find_ffmpeg() -> str:
    """The program that makes films: that of the package imageio-ffmpeg, which surely knows H.264, else the system's.

    Raises:
        InputError: there is neither.
    """
    found = shutil.which("ffmpeg")
    if find_spec("imageio_ffmpeg") is not None:
        import imageio_ffmpeg  # type: ignore[import-untyped]

        with suppress(RuntimeError):  # a package without the program, where there is none for the machine
            found = imageio_ffmpeg.get_ffmpeg_exe()
    if found is None:
        raise InputError('.mp4 needs ffmpeg: pip install "tetrabench[watch]" brings it; .gif needs nothing')
    return found


def _frames(player: Player, steps: int, tell: Callable[[int, int], None]) -> Iterator[Figure]:
    """The same figure, painted anew after each step."""
    figure = make_figure(*_size(player))
    for step in range(steps):
        player.advance()
        paint(figure, player.scene())
        tell(step + 1, steps)
        yield figure


def _size(player: Player) -> tuple[int, int]:
    return player.view.width, player.view.height


def _write_picture(player: Player, path: Path, steps: int, tell: Callable[[int, int], None]) -> None:
    for step in range(steps):
        player.advance()
        tell(step + 1, steps)
    figure = make_figure(*_size(player))
    paint(figure, player.scene())
    figure.savefig(path, format="png")


def _write_gif(frames: Iterator[Figure], path: Path, frames_a_second: int) -> None:
    """All frames with the palette of the scene's colours: else each would be dithered in its own way, and flicker."""
    palette = _palette()
    images = (Image.fromarray(_pixels(figure)).quantize(palette=palette, dither=Image.Dither.NONE) for figure in frames)
    first = next(images)
    # Frames are asked for while it is written: so they are never all in memory as the colours that they were painted in.
    first.save(path, format="GIF", save_all=True, append_images=images, duration=round(1000 / frames_a_second), loop=0)


def _write_mp4(frames: Iterator[Figure], path: Path, frames_a_second: int) -> None:
    logging.getLogger("matplotlib.animation").setLevel(logging.ERROR)  # what ffmpeg has said is said below
    with rc_context({"animation.ffmpeg_path": find_ffmpeg()}):
        writer = FFMpegWriter(fps=frames_a_second, codec="h264", extra_args=list(QUALITY))
        try:
            figure = next(frames)
            with writer.saving(figure, str(path), DOTS):
                for _ in itertools.chain([figure], frames):
                    writer.grab_frame(facecolor=BACKGROUND)
        except subprocess.CalledProcessError as error:
            told = str(error.stderr or "").strip().splitlines() or [f"exit code {error.returncode}"]
            raise InputError(f"{path}: ffmpeg has failed: {told[-1]}") from error


def make_figure(width: int, height: int) -> Figure:
    """A figure of so many pixels, all of it one pair of axes that count them from the upper left corner."""
    figure = Figure(figsize=(width / DOTS, height / DOTS), dpi=DOTS, facecolor=BACKGROUND)
    FigureCanvasAgg(figure)
    figure.add_axes((0.0, 0.0, 1.0, 1.0))
    return figure


def paint(figure: Figure, scene: Scene) -> None:
    """Paint a scene onto a figure of its size, instead of what was there."""
    axes: Any = figure.axes[0]
    axes.clear()
    axes.set_axis_off()
    axes.set(xlim=(0, scene.width), ylim=(scene.height, 0))
    left, top, right, bottom = scene.box
    axes.add_patch(Rectangle((left, top), right - left, bottom - top, facecolor=FLOOR, edgecolor=WALL, linewidth=POINT))
    corners = scene.leaves[:, [[0, 1], [2, 1], [2, 3], [0, 3]]]
    axes.add_collection(
        PolyCollection(list(corners), facecolors="none", edgecolors=LEAF, linewidths=POINT, antialiased=False)
    )
    axes.add_collection(
        EllipseCollection(
            2 * scene.radii,
            2 * scene.radii,
            np.zeros(len(scene.radii)),
            units="xy",
            offsets=scene.places,
            offset_transform=axes.transData,
            facecolors=np.where(scene.in_contact, CONTACT, OBJECT),
            linewidths=0,
            alpha=OPACITY,
        )
    )
    axes.add_patch(Rectangle((0, 0), scene.width, scene.bar, facecolor=BACKGROUND, linewidth=0, zorder=3))
    for number, line in enumerate(scene.lines):
        look = {"color": QUIET if number else BRIGHT, "fontsize": LETTERS * POINT, "parse_math": False, "zorder": 4}
        axes.text(LETTERS, 6 + LINE * (number + 0.5), line, va="center", **look)


def _pixels(figure: Figure) -> Any:
    """(height, width, 3) uint8."""
    canvas: Any = figure.canvas
    canvas.draw()
    return np.asarray(canvas.buffer_rgba())[..., :3].copy()


def _palette() -> Image.Image:
    """An image with the colours of the scene and what lies between those that touch each other, 256 at most."""
    grounds = [(BACKGROUND, FLOOR, SHADES), (FLOOR, WALL, SHADES), (FLOOR, LEAF, SHADES), (OBJECT, CONTACT, SHADES)]
    things = [(ground, thing, 2 * SHADES) for ground in (FLOOR, LEAF) for thing in (OBJECT, CONTACT)]
    words = [(BACKGROUND, word, SHADES) for word in (BRIGHT, QUIET)]
    blends = [np.linspace(to_rgb(first), to_rgb(last), shades) for first, last, shades in (*grounds, *things, *words)]
    colours = np.unique(np.rint(255 * np.concatenate(blends)).astype(np.uint8), axis=0)[:256]
    image = Image.new("P", (1, 1))
    image.putpalette(colours.ravel().tolist())
    return image
