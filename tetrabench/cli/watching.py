"""The verb that shows a simulation: watch."""

from __future__ import annotations

import math
from pathlib import Path

import click

from tetrabench.cli.options import FILE, check_folder, numbering_option, plugin_option, read_count, seed_option
from tetrabench.cli.speech import patience, say
from tetrabench.errors import InputError

STEPS = 300  # of a recording, unless said
FILM, WINDOW = 30, 60  # frames a second, unless said


def read_gravity(ctx: click.Context, param: click.Parameter, number: float) -> float:
    """A finite number."""
    if not math.isfinite(number):
        raise click.BadParameter(f"a finite number is needed, not {number}", ctx, param)
    return number


def read_bounce(ctx: click.Context, param: click.Parameter, number: float) -> float:
    """A number from 0 to 1."""
    if not 0 <= number <= 1:
        raise click.BadParameter(f"a number from 0 to 1 is needed, not {number}", ctx, param)
    return number


@click.command()
@click.option("--model", default="uniform", show_default=True, metavar="FILE|NAME", help="What it starts from.")
@click.option("--objects", callback=read_count, metavar="N", help="Of a generated model.  [default: 2k]")
@numbering_option
@seed_option
@plugin_option
@click.option("--backend", default="kdtree", show_default=True, metavar="A", help="The structure to begin with.")
@click.option("--option", "options", multiple=True, metavar="NAME=N", help="Of a backend, such as kdtree.capacity=8.")
@click.option("--gravity", type=float, default=0.0, show_default=True, callback=read_gravity, help="Downward, a step.")
@click.option(
    "--bounce",
    type=float,
    default=1.0,
    show_default=True,
    callback=read_bounce,
    help="What a wall leaves of a velocity.",
)
@click.option(
    "--mode",
    type=click.Choice(["paper", "full"]),  # those of collision.simulation
    default="paper",
    show_default=True,
    help="Of an object's contacts in a step, one counts as in the source, or all do.",
)
@click.option(
    "--steps", type=click.IntRange(min=0), metavar="N", help="So many.  [default: 300 if recorded, else no end]"
)
@click.option("--record", metavar="FILE.mp4|gif|png", type=FILE, callback=check_folder, help="Instead of a window.")
@click.option("--fps", type=click.IntRange(1, 100), help="Frames a second: 30 in a film, at most 60 in the window.")
def watch(
    model: str,
    objects: int | None,
    numbering: str,
    seed: int,
    backend: str,
    options: tuple[str, ...],
    gravity: float,
    bounce: float,
    mode: str,
    steps: int | None,
    record: Path | None,
    fps: int | None,
) -> None:
    """Watch objects collide, with the leaves of the structure that finds their contacts.

    Objects in contact are orange. The window needs pip install "tetrabench[watch]"; its keys are in the line above the
    box: space pauses, b goes on in the next backend, + and - change the capacity of leaves, r their recycling.

    A recording needs no window: .png shows the last step, .gif and .mp4 all of them, a frame each.
    """
    frames = STEPS if steps is None else steps
    with patience("looking up backends"):
        from tetrabench.watch.opening import find_contestants, find_file

        if record is None:
            from tetrabench.watch.window import check_window

            check_window()
        else:
            from tetrabench.watch.film import check_film

            check_film(record, frames)
        contestants = find_contestants(backend, options)
    with patience(f"looking up {model}"):
        path = find_file(model, objects, numbering=numbering, seed=seed)
    if record is not None and record.exists() and record.samefile(path):
        raise InputError(f"{record}: is what is read, and would be lost; record to another file")
    with patience(f"compiling {backend}"):
        from tetrabench.watch.player import open_player

        rules = {"gravity": gravity, "bounce": bounce, "mode": mode}
        player = open_player(path, contestants, backend, limit=steps, has_keys=record is None, **rules)
    if record is None:
        from tetrabench.watch.window import open_window

        open_window(player, frames_a_second=fps or WINDOW, title=f"tetrabench watch: {Path(model).name}")
        return
    from tetrabench.watch import film

    with patience(f"recording {frames:,} steps") as tell:
        film.record(player, record, frames, frames_a_second=fps or FILM, tell=tell)
    played = f"{frames:,} {'step' if frames == 1 else 'steps'}"
    say(f"wrote {record}: {played} of {len(player.simulation):,} objects in {backend}")
