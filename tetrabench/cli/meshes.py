"""The verbs on meshes: info, convert, generate."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tetrabench.cli.options import FILE, check_folder, numbering_option, read_count, repair_option, seed_option
from tetrabench.cli.speech import patience, say
from tetrabench.errors import InputError, RepairableError, find_named

if TYPE_CHECKING:
    from tetrabench.mesh import TetraMesh
    from tetrabench.mesh.inspection import Inspection
    from tetrabench.mesh.polygon import PolygonMesh
    from tetrabench.mesh.polygon.inspection import PolygonInspection


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
    at all is refused with exit code 2. A file without tetras is described by its polygons.
    """
    from dataclasses import replace

    from tetrabench.io.kinds import read_any
    from tetrabench.mesh import TetraMesh

    refusal = ""
    with patience(f"reading {file}"):
        try:
            mesh = read_any(file, unused="keep", repair=repair)
        except RepairableError as error:
            refusal = str(error)
            mesh = read_any(file, unused="keep", repair="drop")
    with patience(f"inspecting {count(mesh)}"):
        inspection: Any = replace(inspect(mesh), refusal=refusal)
    if form == "json":
        import msgspec

        click.echo(msgspec.json.format(msgspec.json.encode(inspection), indent=2))
    else:
        for name, value in describe(inspection):
            click.echo(f"{name:25}{value}")
        for sentence in inspection.warnings:
            click.echo(f"- {sentence}")
        if refusal:
            mends = "leaves these tetras out" if isinstance(mesh, TetraMesh) else "mends it"
            click.echo(f"- the file is refused, unless --repair drop {mends}")


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
    """Write a mesh in another format, or in another order. OUT may not be IN.

    Of a file with tetras these are taken, else its polygons: in .npz with their boundary conditions.
    """
    from tetrabench.io import is_file
    from tetrabench.io.formats import partners
    from tetrabench.io.kinds import check_any_target, read_any, write_any

    check_any_target(source, target, field)
    if is_file(target) and any(is_file(file) and file.samefile(target) for file in (source, *partners(source))):
        raise InputError(f"{target}: is what is read, and would be lost; write to another file")
    with patience(f"reading {source}"):
        mesh = read_any(source, unused=unused, repair=repair)
    with patience(f"renumbering {count(mesh)}"):
        mesh = reorder(mesh, numbering, seed)
    with patience(f"writing {target}"):
        lost = write_any(mesh, target, field=field)
    for sentence in (*mesh.report.warnings, *told(mesh, unused), *filter(None, [lost])):
        say(sentence)
    if mesh.report.skipped:
        say("left out " + ", ".join(f"{name} {number:,}" for name, number in mesh.report.skipped.items()))
    say(f"wrote {target}: {count(mesh)}, {len(mesh.points):,} points")


@click.command()
@click.argument("model", metavar="nozzle|intake|box|triangle|quad|hexagon|voronoi")
@click.option(
    "--tets", "--cells", "size", callback=read_count, metavar="N", help="Wanted number of them, such as 100k."
)
@numbering_option
@seed_option
@field_option
@click.option("-o", "--output", metavar="FILE.nas|FILE.npz", type=FILE, callback=check_folder, required=True)
def generate(model: str, size: int | None, numbering: str, seed: int, field: str | None, output: Path) -> None:
    """Make a model without a mesher and write it: the same file for the same seed.

    The first three are of tetras, the others of polygons.
    """
    from tetrabench.io import check_field, check_target
    from tetrabench.io.kinds import write_any
    from tetrabench.io.polygons import check_polygon_target
    from tetrabench.mesh import models
    from tetrabench.mesh.polygon import models as polygon_models

    find_named("model", {**models.MODELS, **polygon_models.MODELS}, model)
    mesh: TetraMesh | PolygonMesh
    if model in polygon_models.MODELS:
        check_polygon_target(output)
        check_field(output, field)
        with patience(f"making {model}"):
            mesh = polygon_models.generate_polygons(model, size, numbering=numbering, seed=seed)
    else:
        check_target(output, field)
        with patience(f"making {model}"):
            mesh = models.generate(model, size, numbering=numbering, seed=seed)
    with patience(f"writing {output}"):
        lost = write_any(mesh, output, field=field)
    click.echo(mesh.report.source)
    for sentence in filter(None, [lost, f"wrote {output}"]):
        say(sentence)


def count(mesh: TetraMesh | PolygonMesh) -> str:
    """How many tetras or cells a mesh has."""
    from tetrabench.mesh import TetraMesh

    return f"{len(mesh.tets):,} tetras" if isinstance(mesh, TetraMesh) else f"{mesh.number_of_cells:,} cells"


def inspect(mesh: TetraMesh | PolygonMesh) -> Inspection | PolygonInspection:
    """What `info` tells."""
    from tetrabench.mesh import TetraMesh

    if isinstance(mesh, TetraMesh):
        from tetrabench.mesh.inspection import inspect_mesh

        return inspect_mesh(mesh)
    from tetrabench.mesh.polygon.inspection import inspect_polygons

    return inspect_polygons(mesh)


def reorder(mesh: TetraMesh | PolygonMesh, numbering: str, seed: int) -> TetraMesh | PolygonMesh:
    """The mesh in another order."""
    from tetrabench.mesh import TetraMesh

    if isinstance(mesh, TetraMesh):
        from tetrabench.mesh.numbering import renumber

        return renumber(mesh, numbering, seed)
    from tetrabench.mesh.polygon.numbering import renumber_polygons

    return renumber_polygons(mesh, numbering, seed)


def told(mesh: TetraMesh | PolygonMesh, unused: str) -> list[str]:
    """What `convert` says of what became of a file's mesh."""
    from tetrabench.mesh import TetraMesh

    report, sentences = mesh.report, []
    if isinstance(mesh, TetraMesh):
        if unused == "drop" and report.unreferenced:
            sentences.append(f"left out {report.unreferenced:,} points that no tetra uses")
    elif mesh.report.turned:
        sentences.append(f"turned over {mesh.report.turned:,} of {mesh.number_of_cells:,} cells")
    if report.quadratic:
        word = "tetras" if isinstance(mesh, TetraMesh) else "cells"
        sentences.append(f"took the corners of {report.quadratic:,} {word} with midside nodes")
    return sentences


def describe(inspection: Inspection | PolygonInspection) -> list[tuple[str, str]]:
    """The table of `info`: names and values."""
    rows = []
    for name, value in vars(inspection).items():
        if isinstance(value, dict):
            text = ", ".join(f"{key} {number:,}" for key, number in value.items())
        elif isinstance(value, tuple):
            text = ", ".join(f"{x:.9g}" for x in value)
        elif isinstance(value, float):
            text = f"{value:.1f} degrees" if "angle" in name else f"{value:.9g}"
        else:
            text = f"{value:,}" if isinstance(value, int) else str(value or "")
        if name not in ("warnings", "refusal"):
            rows.append((name.replace("_", " "), text or "none"))
    return rows
