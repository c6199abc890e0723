"""Pictures of meshes of polygons: the cells in the plane, or the surface in space, in the colours of their node counts."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from matplotlib import colormaps
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import BoundaryNorm, ListedColormap
from matplotlib.figure import Figure
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection  # type: ignore[import-untyped]

from tetrabench.mesh.polygon.numbering import next_nodes
from tetrabench.mesh.polygon.quality import cell_normals
from tetrabench.report.picture import DARKEST, EDGE, HEIGHT, LIGHT, RIM, TINY, WIDTH, add_space, add_title, eye, paint

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from tetrabench.mesh.polygon import PolygonMesh

FEWEST, MOST = 3, 10
"""Nodes of a cell: the first and the last number with a colour of its own, in all pictures the same; more look like MOST."""
COLOURS = ListedColormap(colormaps["viridis"](np.linspace(0.12, 1, MOST - FEWEST + 1)))
NORM = BoundaryNorm(np.arange(FEWEST, MOST + 2) - 0.5, MOST - FEWEST + 1)
BAR = 0.13  # of the width


def draw_polygons(mesh: PolygonMesh, *, title: str = "") -> Figure:
    """Draw a mesh: its cells in the colours of their numbers of nodes, and its boundary.

    Args:
        mesh: sound.
        title: taken as it is, without formulas.
    """
    sizes = np.diff(mesh.starts)
    cells = np.split(mesh.points[mesh.nodes], mesh.starts[1:-1])
    outer = mesh.conditions < 0
    rim = mesh.points[np.column_stack([mesh.nodes[outer], next_nodes(mesh.starts, mesh.nodes)[outer]])]
    colours = np.asarray(COLOURS(NORM(np.clip(sizes, FEWEST, MOST))))
    if mesh.points.shape[1] == 2:
        extent = np.ptp(mesh.points, axis=0)
        width = WIDTH * (1 - BAR) - 1.1  # inches, of the axes
        height = float(np.clip(width * extent[1] / max(extent[0], TINY), 2.6, 6.6))
        figure = Figure(figsize=(WIDTH, height + 1.2))
        axes: Any = figure.add_axes((0.8 / WIDTH, 0.6 / (height + 1.2), width / WIDTH, height / (height + 1.2)))
        axes.add_collection(PolyCollection(cells, **paint(colours, EDGE)))
        axes.add_collection(LineCollection(list(rim), colors=RIM, linewidths=0.9, capstyle="round"))
        axes.set_aspect("equal")
        axes.margins(0.03)
        axes.set(xlabel="x", ylabel="y")
        axes.spines[["top", "right"]].set_visible(False)
    else:
        figure = Figure(figsize=(WIDTH, HEIGHT))
        axes = add_space(figure, (0.01, 0.03, 0.97 - BAR, 0.91), mesh.points, zoom=1.04)
        # A surface has no inside: it is as light from behind.
        normals = cell_normals(mesh) @ eye().T
        normals /= np.maximum(np.linalg.norm(normals, axis=1), TINY)[:, None]
        normals *= np.where(normals[:, 2] < 0, -1.0, 1.0)[:, None]
        light = np.clip(normals @ (LIGHT / np.linalg.norm(LIGHT)), 0, 1)
        colours[:, :3] *= DARKEST + (1 - DARKEST) * light[:, None]
        axes.add_collection3d(Poly3DCollection(cells, **paint(colours, EDGE)))
        if len(rim):
            axes.add_collection3d(Line3DCollection(rim, colors=RIM, linewidths=0.9))
    add_title(figure, title)
    _add_bar(figure, figure.add_axes((0.9, 0.25, 0.022, 0.5)), int(sizes.max()))
    return figure


def _add_bar(figure: Figure, place: Axes, most: int) -> None:
    bar = figure.colorbar(ScalarMappable(NORM, COLOURS), cax=place, ticks=np.arange(FEWEST, MOST + 1))
    bar.ax.set_yticklabels([*map(str, range(FEWEST, MOST)), f"{MOST}+" if most > MOST else str(MOST)])
    bar.ax.minorticks_off()
    bar.set_label("nodes of a cell")
    bar.outline.set_visible(False)  # type: ignore[operator]
