"""The verbs on meshes: info, convert, generate."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from tetrabench.cli.options import FILE, check_folder, numbering_option, read_count, repair_option, seed_option
from tetrabench.cli.speech import patience, say
from tetrabench.errors import InputError, RepairableError

if TYPE_CHECKING:
    from tetrabench.mesh.inspection import Inspection


field_option = click.option(
    "--field",
    type=click.Choice(["small", "large", "free"]),
    help="Of a Nastran file: 5 to 7 digits, 13 to 15, or every bit.  [default: small]",
)


@click.command()
@click.argument("file", metavar="FILE", type=FILE)
@repair_option
@click.option("--format", "form", type=click.Choice(["table", "json"]), default="table", show_default=True)
def info(file: Path, repair: str, form: str) -> None:
    """Describe a mesh: what it holds, what is wrong with it, what was left out.

    A file that is refused only for tetras that --repair drop leaves out is described without them, and the exit code is
    0: "refusal" in the JSON, or the last line of the table, says that other verbs refuse it. What cannot be described
    at all is refused with exit code 2.
    """
    from dataclasses import replace

    from tetrabench.io import read_mesh
    from tetrabench.mesh.inspection import inspect_mesh

    refusal = ""
    with patience(f"reading {file}"):
        try:
            mesh = read_mesh(file, unused="keep", repair=repair)
        except RepairableError as error:
            refusal = str(error)
            mesh = read_mesh(file, unused="keep", repair="drop")
    with patience(f"inspecting {len(mesh.tets):,} tetras"):
        inspection = replace(inspect_mesh(mesh), refusal=refusal)
    if form == "json":
        import msgspec

        click.echo(msgspec.json.format(msgspec.json.encode(inspection), indent=2))
    else:
        for name, value in describe(inspection):
            click.echo(f"{name:25}{value}")
        for sentence in inspection.warnings:
            click.echo(f"- {sentence}")
        if refusal:
            click.echo("- the file is refused, unless --repair drop leaves these tetras out")


@click.command()
@click.argument("source", metavar="IN", type=FILE)
@click.argument("target", metavar="OUT", type=FILE, callback=check_folder)
@numbering_option
@seed_option
@repair_option
@click.option(
    "--unused",
    type=click.Choice(["drop", "keep"]),
    default="drop",
    show_default=True,
    help="What becomes of points that no tetra uses.",
)
@field_option
def convert(source: Path, target: Path, numbering: str, seed: int, repair: str, unused: str, field: str | None) -> None:
    """Write a mesh in another format, or in another order. OUT may not be IN."""
    from tetrabench.io import check_target, is_file, read_mesh, write_mesh
    from tetrabench.io.formats import partners
    from tetrabench.mesh.numbering import renumber

    check_target(target, field)
    if is_file(target) and any(is_file(file) and file.samefile(target) for file in (source, *partners(source))):
        raise InputError(f"{target}: is what is read, and would be lost; write to another file")
    with patience(f"reading {source}"):
        mesh = read_mesh(source, unused=unused, repair=repair)
    with patience(f"renumbering {len(mesh.tets):,} tetras"):
        mesh = renumber(mesh, numbering, seed)
    with patience(f"writing {target}"):
        write_mesh(mesh, target, field=field)
    for sentence in mesh.report.warnings:
        say(sentence)
    if unused == "drop" and mesh.report.unreferenced:
        say(f"left out {mesh.report.unreferenced:,} points that no tetra uses")
    if mesh.report.quadratic:
        say(f"took the corners of {mesh.report.quadratic:,} tetras with midside nodes")
    if mesh.report.skipped:
        say("left out " + ", ".join(f"{name} {count:,}" for name, count in mesh.report.skipped.items()))
    say(f"wrote {target}: {len(mesh.tets):,} tetras, {len(mesh.points):,} points")


@click.command()
@click.argument("model", metavar="nozzle|intake|box")
@click.option("--tets", callback=read_count, metavar="N", help="Wanted number of tetras, such as 100k.")
@numbering_option
@seed_option
@field_option
@click.option("-o", "--output", metavar="FILE.nas", type=FILE, callback=check_folder, required=True)
def generate(model: str, tets: int | None, numbering: str, seed: int, field: str | None, output: Path) -> None:
    """Make a model without a mesher and write it: the same file for the same seed."""
    from tetrabench.io import check_target, write_mesh
    from tetrabench.mesh import models

    check_target(output, field)
    with patience(f"making {model}"):
        mesh = models.generate(model, tets, numbering=numbering, seed=seed)
    with patience(f"writing {output}"):
        write_mesh(mesh, output, field=field)
    click.echo(mesh.report.source)
    say(f"wrote {output}")


def describe(inspection: Inspection) -> list[tuple[str, str]]:
    """The table of `info`: names and values."""
    rows = []
    for name, value in vars(inspection).items():
        if isinstance(value, dict):
            text = ", ".join(f"{key} {count:,}" for key, count in value.items())
        elif isinstance(value, tuple):
            text = ", ".join(f"{x:.9g}" for x in value)
        elif isinstance(value, float):
            text = f"{value:.1f} degrees" if "angle" in name else f"{value:.9g}"
        else:
            text = f"{value:,}" if isinstance(value, int) else str(value or "")
        if name not in ("warnings", "refusal"):
            rows.append((name.replace("_", " "), text or "none"))
    return rows
