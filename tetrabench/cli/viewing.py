"""The verb that shows a net: view."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tetrabench.cli.meshes import all_kinds
from tetrabench.cli.options import (
    FILE,
    check_folder,
    family_option,
    numbering_option,
    plugin_option,
    read_count,
    seed_option,
)
from tetrabench.cli.speech import patience, say
from tetrabench.errors import InputError, find_named

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from tetrabench.mesh import TetraMesh

    Values = dict[str, NDArray[np.float64]]

PICTURES = (".png", ".svg", ".pdf")


def check_cut(ctx: click.Context, param: click.Parameter, text: str | None) -> str | None:
    """A plane, as far as it can be checked before there is a net."""
    if text is not None:
        from tetrabench.mesh.cut import check_plane

        check_plane(text)
    return text


def check_picture(ctx: click.Context, param: click.Parameter, path: Path | None) -> Path | None:
    """A file that a picture can be written to."""
    if path is not None and path.suffix.lower() not in PICTURES:
        raise click.BadParameter(f"{path}: pictures are {' '.join(PICTURES)}, by the suffix", ctx, param)
    return check_folder(ctx, param, path)


def check_values(ctx: click.Context, param: click.Parameter, path: Path | None) -> Path | None:
    """A file that a mesh can be written to, with values of its tetras."""
    if path is not None:
        from tetrabench.io import check_target

        check_target(path, has_values=True)
    return check_folder(ctx, param, path)


@click.command()
@click.argument("model", metavar="FILE|NAME")
@family_option
@plugin_option
@click.option(
    "--tets",
    "--cells",
    "--objects",
    "size",
    callback=read_count,
    metavar="N",
    help="Of a generated model, such as 100k.",
)
@numbering_option
@seed_option
@click.option(
    "--state",
    default="0",
    show_default=True,
    metavar="0..4|NAME",
    help="What is shown in colour: a place in the state vector, volume, or a value that the file holds for each tetra.",
)
@click.option("--cut", callback=check_cut, metavar="x=0.3|y=50%", help="Cut there; else the surface is drawn.")
@click.option("-o", "--output", metavar="FILE.png|svg|pdf", type=FILE, callback=check_picture, help="The picture.")
@click.option("--vtu", metavar="FILE.vtu", type=FILE, callback=check_values, help="The net with states, for ParaView.")
def view(
    model: str,
    family: str,
    size: int | None,
    numbering: str,
    seed: int,
    state: str,
    cut: str | None,
    output: Path | None,
    vtu: Path | None,
) -> None:
    """Draw a net, or a cut through it, in the colours of a state.

    The states are those that a file written by --vtu holds; else those that every scenario starts from. A cut is at a
    coordinate (x=0.3), or at a share of the model's extent (x=30%).

    A mesh of polygons is drawn whole, in the colours of its cells' numbers of nodes. Objects that move are for watch.
    """
    if output is None and vtu is None:
        raise click.UsageError("nothing to do: -o FILE.png draws a picture, --vtu FILE.vtu writes the net for ParaView")
    from tetrabench.io.formats import NoCellsError

    for kind in all_kinds():
        if kind.drawn_by and (model in kind.models or kind.holds(model)):
            raise InputError(f"{model}: {kind.drawn_by.format(model)}")
    with patience(f"looking up {model}"):
        path = find_file(model, family, size, numbering, seed)
    if vtu is not None and vtu.exists() and vtu.samefile(path):
        raise InputError(f"{vtu}: is what is read, and would be lost; write to another file")
    try:
        mesh, held, are_initial = read_net(path, family)
    except NoCellsError as no_tetras:
        if output is None or vtu is not None or cut is not None or state != "0":
            reason = "polygons have no states and no cuts: -o FILE.png alone draws them"
            raise InputError(f"{no_tetras}; {reason}") from None
        return view_polygons(model, path, output, no_tetras)
    values = {"volume": volumes(mesh)} | held
    name = f"state_{state}" if state.isdecimal() else state
    shown = find_named("state", values, name)
    title = f"{Path(model).name}: {len(mesh.tets):,} tetras"
    if output is not None:
        from tetrabench.report.picture import draw_net, save_picture

        with patience(f"drawing {len(mesh.tets):,} tetras"):
            figure = draw_net(mesh, shown, cut, title=title, label=name.replace("_", " "))
            save_picture(figure, output)
        first = ", in the states that every scenario starts from: it holds none itself"
        say(f"wrote {output}{first if are_initial and name.startswith('state_') else ''}")
    if vtu is not None:
        from tetrabench.io import write_mesh

        with patience(f"writing {vtu}"):
            write_mesh(mesh, vtu, values=held)
        say(f"wrote {vtu}: {len(mesh.tets):,} tetras with {', '.join(held)}")


def find_file(model: str, family_name: str, size: int | None, numbering: str, seed: int) -> Path:
    """The file of a model: of whichever family has one of that name, or one that holds what the family stores, or polygons."""
    from tetrabench import registry
    from tetrabench.io import is_file
    from tetrabench.io.kinds import is_surface

    family = registry.family(family_name)
    if model not in family.models:
        if is_surface(model) and is_file(Path(model)):
            if size is not None or numbering != "natural":
                raise InputError(
                    f"{model} is a file: a size or numbering can only be given for a model that is generated"
                )
            return Path(model)
        family = next((other for other in registry.families() if model in other.models), family)
    return family.find_model(model, size=size, numbering=numbering, seed=seed)


def view_polygons(model: str, path: Path, output: Path, no_tetras: InputError) -> None:
    """Draw a mesh of polygons, or say why there is none."""
    from tetrabench.io.formats import NoCellsError
    from tetrabench.io.polygons import read_polygons
    from tetrabench.report.picture import save_picture
    from tetrabench.report.polygon_picture import draw_polygons

    try:
        with patience(f"reading {path}"):
            mesh = read_polygons(path)
    except NoCellsError:
        raise no_tetras from None
    with patience(f"drawing {mesh.number_of_cells:,} cells"):
        save_picture(draw_polygons(mesh, title=f"{Path(model).name}: {mesh.number_of_cells:,} cells"), output)
    say(f"wrote {output}")


def read_net(path: Path, family_name: str) -> tuple[TetraMesh, Values, bool]:
    """The tetras of a file and their values by name; whether the states among these are those that scenarios start from.

    Raises:
        NoCellsError: it holds no tetras.
    """
    from tetrabench import registry
    from tetrabench.io import read_mesh
    from tetrabench.io.formats import NoCellsError
    from tetrabench.io.kinds import is_surface
    from tetrabench.io.values import read_values

    if is_surface(path):
        raise NoCellsError(f"{path}: holds no tetras")
    with patience(f"reading {path}"):
        values = read_values(path)
        if "state_0" in values:
            return read_mesh(path), values, False
    with patience(f"building the net of {path}"):
        family = registry.family(family_name)
        # Where scenarios start from is known to the stage, and the same for every contestant.
        stage: Any = family.stage(registry.contestant(family_name, family.reference), path, chained=False)
        net = stage.net()
        states = {f"state_{place}": numbers for place, numbers in enumerate(net.states.T)}
        mesh = net.to_mesh()
        stage.close()
    return mesh, values | states, True


def volumes(mesh: TetraMesh) -> NDArray[np.float64]:
    """Of the tetras, (m,) float64, absolute."""
    import numpy as np

    from tetrabench.mesh.quality import signed_volumes

    absolute: NDArray[np.float64] = np.abs(signed_volumes(mesh.points, mesh.tets))
    return absolute
