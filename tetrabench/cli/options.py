"""Options that several verbs share, and what becomes of their values."""

from __future__ import annotations

import re
import tempfile
from pathlib import Path

import click

from tetrabench.errors import find_named

FILE = click.Path(dir_okay=False, path_type=Path)


def read_count(ctx: click.Context, param: click.Parameter, text: str | None) -> int | None:
    """A whole number such as 642700, 642,700, 100k or 1.5M."""
    if text is None:
        return None
    match = re.fullmatch(r"(\d+(?:\.\d+)?)([kM]?)", text.replace(",", "").replace("_", ""))
    number = float(match[1]) * {"": 1, "k": 1e3, "M": 1e6}[match[2]] if match else 0.5
    if number != int(number):
        raise click.BadParameter(f"{text!r} is no count such as 642700, 100k or 1.5M", ctx, param)
    return int(number)


def split_names(ctx: click.Context, param: click.Parameter, values: tuple[str, ...]) -> list[str] | None:
    """Names out of comma lists and repeated options; None where the option was not given."""
    if not values:
        return None
    return [name for value in values for part in value.split(",") if (name := part.strip())]


def check_folder(ctx: click.Context, param: click.Parameter, path: Path | None) -> Path | None:
    """Complain about a folder that is not there, or cannot be written to, before the work, not after it."""
    if path is not None and not path.absolute().parent.is_dir():
        raise click.BadParameter(f"there is no folder {path.parent}", ctx, param)
    if path is not None:
        try:
            with tempfile.TemporaryFile(dir=path.absolute().parent):
                pass
        except OSError as error:
            raise click.BadParameter(f"cannot write into {path.parent}: {error.strerror}", ctx, param) from error
    return path


def check_numbering(ctx: click.Context, param: click.Parameter, name: str) -> str:
    """The name of a numbering, looked up before the work."""
    from tetrabench.mesh.numbering import NUMBERINGS

    find_named("numbering", NUMBERINGS, name)
    return name


seed_option = click.option("--seed", default=0, help="Of all that is random.", show_default=True)
family_option = click.option("--family", default="tetra", show_default=True, help="The kind of thing to store.")
numbering_option = click.option(
    "--numbering",
    metavar="natural|shuffled|hilbert|rcm",  # those of mesh.numbering: help must not wait for numpy
    callback=check_numbering,
    default="natural",
    show_default=True,
    help="Order of points and tetras: as they come, at random, along a Hilbert curve, or by reverse Cuthill-McKee.",
)
repair_option = click.option(
    "--repair",
    type=click.Choice(["refuse", "drop"]),
    default="refuse",
    show_default=True,
    help="What becomes of tetras that repeat a node, are duplicates, or are more than two at a side.",
)
format_option = click.option(
    "--format",
    "form",
    type=click.Choice(["table", "md", "json", "csv", "github", "pyperf"]),  # those of report.formats
    default="table",
    show_default=True,
    help="For people (github: with annotations of a workflow), or for programs.",
)
intervals_option = click.option("--intervals", is_flag=True, help="Tables of intervals rather than of ratios.")
charts_option = click.option(
    "--charts",
    metavar="DIR",
    type=click.Path(file_okay=False, path_type=Path),
    help="Draw the charts into this folder.",
)
chart_format_option = click.option(
    "--chart-format",
    type=click.Choice(["png", "svg"]),
    default="png",
    show_default=True,
    help="Of the charts.",
)
