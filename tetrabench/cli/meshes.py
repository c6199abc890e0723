"""The verbs on models and their files: info, convert, generate."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tetrabench.cli.options import (
    FILE,
    check_folder,
    numbering_option,
    plugin_option,
    read_count,
    repair_option,
    seed_option,
)
from tetrabench.cli.speech import patience, say
from tetrabench.errors import InputError, RepairableError, find_named

if TYPE_CHECKING:
    from tetrabench.bench.needs import Forecast
    from tetrabench.io.kinds import Kind

field_option = click.option(
    "--field",
    type=click.Choice(["small", "large", "free"]),
    help="Of a Nastran file: 5 to 7 digits, 13 to 15, or every bit.  [default: small]",
)


@click.command()
@click.argument("file", metavar="FILE", type=FILE)
@repair_option
@plugin_option
@click.option(
    "--format",
    "form",
    type=click.Choice(["table", "json"]),
    default="table",
    show_default=True,
    help="For people, or for programs.",
)
def info(file: Path, repair: str, form: str) -> None:
    """Describe a mesh, or a file of objects: what it holds, what is wrong with it, what was left out, how well shaped its
    cells are, how far apart neighbours are numbered, and about what a run on it needs.

    A file that is refused only for tetras that --repair drop leaves out is described without them, and the exit code is
    0: "refusal" in the JSON, or the last line of the table, says that other verbs refuse it. What cannot be described
    at all is refused with exit code 2. A file without tetras is described by its polygons.
    """
    from dataclasses import replace

    from tetrabench.io.kinds import kind_of, read_any

    refusal, kinds = "", all_kinds()
    with patience(f"reading {file}"):
        try:
            model = read_any(file, unused="keep", repair=repair, kinds=kinds)
        except RepairableError as error:
            refusal = str(error)
            model = read_any(file, unused="keep", repair="drop", kinds=kinds)
    kind = kind_of(model, kinds)
    with patience(f"inspecting {kind.count(model)}"):
        inspection = replace(kind.inspect(model), refusal=refusal)
    needs = foresee(kind.family, model)
    if form == "json":
        import msgspec

        told = msgspec.to_builtins(inspection) | {"needs": msgspec.to_builtins(needs)}
        click.echo(msgspec.json.format(msgspec.json.encode(told), indent=2))
    else:
        table = describe(inspection) + ([("", ""), *describe_needs(needs)] if needs else [])
        width = max(len(name) for name, _ in table) + 2
        for name, value in table:
            click.echo(f"{name:{width}}{value}".rstrip())
        for sentence in inspection.warnings:
            click.echo(f"- {sentence}")
        if refusal:
            click.echo(f"- the file is refused, unless --repair drop {kind.repairs}")


@click.command()
@click.argument("source", metavar="IN", type=FILE)
@click.argument("target", metavar="OUT", type=FILE, callback=check_folder)
@numbering_option
@seed_option
@repair_option
@plugin_option
@click.option(
    "--unused",
    type=click.Choice(["drop", "keep"]),
    default="drop",
    show_default=True,
    help="What becomes of points that no tetra uses.",
)
@field_option
def convert(source: Path, target: Path, numbering: str, seed: int, repair: str, unused: str, field: str | None) -> None:
    """Write a mesh, or objects, in another format, or in another order. OUT may not be IN.

    Of a file with tetras these are taken, else its polygons: in .npz with their boundary conditions. Objects are in .npz
    and .csv.
    """
    from tetrabench.io import is_file
    from tetrabench.io.formats import partners
    from tetrabench.io.kinds import check_any_target, kind_of, read_any

    kinds = all_kinds()
    check_any_target(source, target, field, kinds)

    def refuse_if_read(files: Iterable[Path]) -> None:
        if is_file(target) and any(is_file(file) and file.samefile(target) for file in files):
            raise InputError(f"{target}: is what is read, and would be lost; write to another file")

    refuse_if_read((source, *partners(source)))
    with patience(f"reading {source}"):
        model = read_any(source, unused=unused, repair=repair, kinds=kinds)
    kind = kind_of(model, kinds)
    refuse_if_read(map(Path, kind.included(model)))
    with patience(f"renumbering {kind.count(model)}"):
        model = kind.renumber(model, numbering, seed)
    with patience(f"writing {target}"):
        lost = kind.write(model, target, field)
    for sentence in (*kind.tell(model, unused), *filter(None, [lost])):
        say(sentence)
    say(f"wrote {target}: {kind.describe(model)}")


@click.command()
@click.argument("name", metavar="MODEL")
@click.option(
    "--tets",
    "--cells",
    "--objects",
    "size",
    callback=read_count,
    metavar="N",
    help="Wanted number of them, such as 100k.",
)
@numbering_option
@seed_option
@plugin_option
@field_option
@click.option(
    "-o",
    "--output",
    metavar="FILE",
    type=FILE,
    callback=check_folder,
    required=True,
    help="In the format of its suffix.",
)
def generate(name: str, size: int | None, numbering: str, seed: int, field: str | None, output: Path) -> None:
    """Make a model without a mesher and write it: the same file for the same seed.

    MODEL is nozzle, intake or box, of tetras; triangle, quad, hexagon or voronoi, of polygons; uniform, clustered, halo, mixed
    or separated, of objects that move.
    """
    from tetrabench.io.kinds import MESHES

    kind: Kind = find_named("model", {model: kind for kind in (*MESHES, *all_kinds()) for model in kind.models}, name)
    kind.check_target(output, field)
    with patience(f"making {name}"):
        model = kind.make(name, size, numbering, seed)
    with patience(f"writing {output}"):
        lost = kind.write(model, output, field)
    click.echo(kind.source(model))
    for sentence in filter(None, [lost, f"wrote {output}"]):
        say(sentence)


def all_kinds() -> list[Kind]:
    """The kinds of models that families bring along, then those of meshes: see `io.kinds.MESHES`."""
    from tetrabench import registry
    from tetrabench.io.kinds import MESHES

    return [*(family.kind for family in registry.families() if family.kind), *MESHES]


def foresee(family: str, model: Any) -> Forecast | None:
    """What runs on a model would need; None where nobody can say."""
    from tetrabench import registry
    from tetrabench.bench.needs import forecast

    needs = registry.family(family).needs(model) if family else None
    return forecast(family, needs) if needs else None


def describe(inspection: Any) -> list[tuple[str, str]]:
    """The table of `info`: names and values, a group for each part that is a dataclass, after an empty row."""
    rows, groups = [], []
    for name, value in vars(inspection).items():
        if is_dataclass(value):
            groups += [("", ""), *describe(value)]
        elif isinstance(value, dict) and any(map(is_dataclass, value.values())):
            groups += [(f"{name.replace('_', ' ')} of {key}", _spell(vars(part))) for key, part in value.items()]
        elif name == "advice":
            groups += [(name, value)] if value else []
        elif name not in ("warnings", "refusal"):
            rows.append((name.replace("_", " "), _spell(value, is_angle="angle" in name)))
    return rows + groups


def describe_needs(needs: Forecast) -> list[tuple[str, str]]:
    """The rows of `info` about what a run would need."""
    from tetrabench.memory import spell_bytes

    memory = (
        f"{spell_bytes(needs.run_bytes)} with all backends at once, in groups {spell_bytes(needs.least_bytes)} at least; "
        f"{spell_bytes(needs.net_bytes)} a net"
    )
    rows = [("memory of a run, about", memory)]
    if needs.quick_s is not None and needs.run_s is not None:
        rows.append(("time of a run, about", f"{_about(needs.run_s)}, with --quick {_about(needs.quick_s)}"))
    return rows


def _about(seconds: float) -> str:
    """A time to one digit or two, which is as much as an estimate has."""
    minutes = seconds / 60
    return f"{max(1, round(minutes))} min" if minutes < 60 else f"{minutes / 60:.1f} h"


def _spell_short(number: float) -> str:
    """One of several numbers, to three digits or more."""
    return f"{number:,.0f}" if isinstance(number, int) or number >= 100 else f"{number:.3g}"


def _spell(value: Any, *, is_angle: bool = False) -> str:
    """A value of `info` in words."""
    if isinstance(value, dict):
        return ", ".join(f"{key} {_spell_short(part)}" for key, part in value.items()) or "none"
    if isinstance(value, tuple):
        return ", ".join(str(part) if isinstance(part, int) else f"{part:.9g}" for part in value) or "none"
    if isinstance(value, list):
        return ", ".join(value) or "none"
    if isinstance(value, float):
        return f"{value:.1f} degrees" if is_angle else f"{value:.9g}"
    return f"{value:,}" if isinstance(value, int) else str(value or "none")
