"""Options that several verbs share, and what becomes of their values."""

from __future__ import annotations

import re
import tempfile
from collections.abc import Callable
from fractions import Fraction
from pathlib import Path
from typing import Any

import click

from tetrabench.errors import find_named

FILE = click.Path(dir_okay=False, path_type=Path)


def read_count(ctx: click.Context, param: click.Parameter, text: str | None) -> int | None:
    """A whole number such as 642700, 642,700, 100k or 1.5M."""
    if text is None:
        return None
    match = re.fullmatch(r"([0-9]+(?:\.[0-9]+)?)([kM]?)", text.replace(",", "").replace("_", ""))
    number = Fraction(match[1]) * {"": 1, "k": 1_000, "M": 1_000_000}[match[2]] if match else Fraction(1, 2)
    if number.denominator != 1:
        raise click.BadParameter(f"{text!r} is no count such as 642700, 100k or 1.5M", ctx, param)
    return int(number)


def read_counts(ctx: click.Context, param: click.Parameter, text: str | None) -> list[int] | None:
    """One or several of `read_count`, by commas; several make a sweep."""
    if text is None:
        return None
    counts = [read_count(ctx, param, part) for part in re.split(r",(?!\d{3}(?![\dkM.]))", text)]
    return [number for number in counts if number is not None]


def read_sizes(ctx: click.Context, param: click.Parameter, text: str | None) -> None:
    """Sizes of a model under one of several words: as `tets`, and the word itself as `sized_by`."""
    sizes = read_counts(ctx, param, text)
    if sizes is not None and ctx.params.get("tets") is not None:
        raise click.UsageError(f"--{ctx.params['sized_by']} and --{param.name}: choose one", ctx)
    for name, value in (("tets", sizes), ("sized_by", param.name)):
        ctx.params[name] = ctx.params.get(name) if sizes is None else value


def read_seconds(ctx: click.Context, param: click.Parameter, text: str | None) -> float | None:
    """A time such as 90, 90s, 10m or 1.5h, in seconds."""
    if text is None:
        return None
    match = re.fullmatch(r"(\d+(?:\.\d+)?)([smh]?)", text.strip())
    if not match or float(match[1]) == 0:
        raise click.BadParameter(f"{text!r} is no time such as 90s, 10m or 1.5h", ctx, param)
    return float(match[1]) * {"": 1, "s": 1, "m": 60, "h": 3600}[match[2]]


def read_options(ctx: click.Context, param: click.Parameter, values: tuple[str, ...]) -> dict[str, list[int]]:
    """Counts of scenarios and options of backends by name."""
    from tetrabench.bench.plan import parse_option

    return dict(parse_option(value) for value in values)


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


def check_numberings(ctx: click.Context, param: click.Parameter, text: str) -> list[str]:
    """Names of numberings by commas; several make a sweep."""
    return [check_numbering(ctx, param, name.strip()) for name in text.split(",")]


def read_plugins(ctx: click.Context, param: click.Parameter, paths: tuple[Path, ...]) -> None:
    """Name plug-in files for as long as the verb runs."""
    if paths:
        from tetrabench import plugins, registry

        for path in paths:
            if not path.is_file():
                raise click.BadParameter(f"there is no file {path}", ctx, param)
        ctx.with_resource(plugins.using(paths))
        registry.forget()
        ctx.call_on_close(registry.forget)


plugin_option = click.option(
    "--plugin",
    multiple=True,
    expose_value=False,
    is_eager=True,
    callback=read_plugins,
    type=FILE,
    metavar="FILE.py",
    help="A file with contestants, scenarios, models or families of your own, in the tables CONTESTANTS, SCENARIOS, MODELS and "
    "FAMILIES; may come several times.",
)
seed_option = click.option(
    "--seed", type=click.IntRange(min=0), default=0, help="Of all that is random.", show_default=True
)
family_option = click.option("--family", default="tetra", show_default=True, help="The kind of thing to store.")
_NUMBERING: dict[str, Any] = {
    "metavar": "natural|shuffled|hilbert|rcm",  # those of mesh.numbering: help must not wait for numpy
    "default": "natural",
    "show_default": True,
}
_ORDERS = "Order of points and of tetras or cells: as they come, at random, along a Hilbert curve, or by reverse Cuthill-McKee"
numbering_option = click.option("--numbering", callback=check_numbering, help=f"{_ORDERS}.", **_NUMBERING)
numberings_option = click.option(
    "--numbering", "numberings", callback=check_numberings, help=f"{_ORDERS}; several make a sweep.", **_NUMBERING
)
repair_option = click.option(
    "--repair",
    type=click.Choice(["refuse", "drop"]),
    default="refuse",
    show_default=True,
    help="What becomes of tetras that repeat a node, are duplicates, or are more than two at a side; and of polygons that "
    "repeat a node or are more than two at a side, of nodes in which parts touch that no sides join, and of nodes alone.",
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


def read_share(ctx: click.Context, param: click.Parameter, text: str) -> float:
    """A share such as 10% or 0.1."""
    match = re.fullmatch(r"(\d+(?:\.\d+)?)\s*(%?)", text.strip())
    share = float(match[1]) / (100 if match[2] else 1) if match else 0.0
    if not 0 < share < 10:
        raise click.BadParameter(f"{text!r} is no share such as 10% or 0.1", ctx, param)
    return share


timeout_option = click.option(
    "--timeout",
    "timeout_s",
    callback=read_seconds,
    default="1h",
    show_default=True,
    metavar="TIME",
    help="Of one sample, or of compiling one scenario.",
)


def what_options(verb: Callable[..., Any]) -> Callable[..., Any]:
    """What `run` and `check` take: models, backends, scenarios."""
    reference = click.option("--reference", metavar="A", help="The backend that ratios refer to.")
    return _take(verb, [*_subject_options(), reference, seed_option])


def gate_options(verb: Callable[..., Any]) -> Callable[..., Any]:
    """What `gate` takes of it: each backend is its own reference."""
    return _take(verb, [*_subject_options(), seed_option])


def _subject_options() -> list[Callable[..., Any]]:
    names: dict[str, Any] = {"multiple": True, "callback": split_names, "metavar": "A,B", "help": "All unless given."}
    backend_help = "All unless given, without those that are known to give wrong answers."
    size_help = "Size of a generated model, such as 100k; several make a sweep."
    option_help = (
        "A count of a scenario, such as alfa.sweeps=10, or an option of a backend; several values (1,2 or 1..9) make a "
        "sweep. The verb `list` shows both."
    )
    model_help = (
        "A mesh file, or a model to generate.  [default: the family's, of 30k elements; of run, where nothing is named, a "
        "small one]"
    )
    return [
        click.option("--model", metavar="FILE|NAME", help=model_help),
        family_option,
        plugin_option,
        click.option("--backend", "backends", **names | {"help": backend_help}),
        click.option("--scenario", "scenarios", **names),
        *(
            click.option(f"--{word}", expose_value=False, callback=read_sizes, metavar="N,N", help=told)
            for word, told in (
                ("tets", size_help),
                ("cells", "The same of polygons."),
                ("objects", "The same of objects."),
            )
        ),
        click.option("--option", "options", multiple=True, callback=read_options, metavar="NAME=N,N", help=option_help),
        numberings_option,
    ]


def _take(verb: Callable[..., Any], options: list[Callable[..., Any]]) -> Callable[..., Any]:
    for option in reversed(options):
        verb = option(verb)
    return verb


threshold_option = click.option(
    "--threshold",
    callback=read_share,
    default="10%",
    show_default=True,
    help="How much slower is allowed, by CPU time; by wall time half as much again.",
)
strict_option = click.option("--strict", is_flag=True, help="Exit code 4 where something is inconclusive.")
verdict_format_option = click.option(
    "--format",
    "form",
    type=click.Choice(["table", "md", "json", "github"]),  # those of report.verdicts
    default="table",
    show_default=True,
    help="For people (github: with annotations of a workflow), or for programs.",
)
