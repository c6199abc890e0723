"""Pictures of nets: the surface in space, or the plane through one, in the colours of a value of each tetra.

Surfaces are drawn as their triangles that face the eye, the far ones first; a cut as the polygons it is made of. Where
there are many, formats of lines carry them as an image, and edges are left out.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from matplotlib import colormaps, rc_context
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection  # type: ignore[import-untyped]
from numpy.typing import ArrayLike, NDArray

from tetrabench.errors import InputError
from tetrabench.mesh.cut import AXES, Cut, Plane, cut_mesh, cut_triangles, find_plane
from tetrabench.mesh.tetra_mesh import TetraMesh, as_vertices

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.axes import Axes

    from tetrabench.mesh.surface import Surface

Reals: TypeAlias = NDArray[np.float64]
Place: TypeAlias = tuple[float, float, float, float]  # of axes: left, bottom, width, height, as shares of the figure

COLOURS = colormaps["viridis"].with_extremes(bad="#bbbbbb")  # perceptually uniform, and for all eyes
PLAIN = (0.62, 0.72, 0.83, 1.0)  # where there are no values
GLASS = (0.93, 0.94, 0.95, 1.0)
EDGE, RIM = "#22222299", "#222222"
FEW = 4_000  # shapes that are drawn with their edges, and that formats of lines carry as shapes
WIDTH, HEIGHT = 9.0, 6.4  # inches
BESIDE = 2.1  # inches, of what is beside a cut
ELEVATION, AZIMUTH = 24.0, -58.0  # degrees: where the eye is
LIGHT = np.array([0.2, 0.45, 0.87])  # where it comes from: to the right, upwards, to the eye
DARKEST = 0.55  # what is left of a colour on what is turned away from the light
DARKEST_GLASS = 0.85
TINY = 1e-300  # instead of 0 as a divisor
DOTS = 150  # an inch of an image, also of one in a format of lines


@dataclass(frozen=True)
class Colours:
    """The colour of each value.

    Attributes:
        values: (n,) float64, one a tetra; None where all look alike.
        norm: their limits; beyond them the colour is that of the limit.
        label: what they are.
    """

    values: Reals | None
    norm: Normalize
    label: str

    def of(self, tetras: NDArray[np.int64]) -> Reals:
        """Red, green, blue and opacity of some tetras, (k, 4)."""
        if self.values is None:
            return np.tile(np.array(PLAIN), (len(tetras), 1))
        return np.asarray(self.mappable.to_rgba(self.values[tetras]))

    @property
    def mappable(self) -> ScalarMappable:
        """What colour bars are made from."""
        return ScalarMappable(self.norm, COLOURS)

    @property
    def beyond(self) -> str:
        """Which ends of the colour bar are pointed."""
        low, high = False, False
        if self.values is not None:
            finite = self.values[np.isfinite(self.values)]
            low, high = bool((finite < (self.norm.vmin or 0)).any()), bool((finite > (self.norm.vmax or 0)).any())
        return {(True, True): "both", (True, False): "min", (False, True): "max"}.get((low, high), "neither")


def draw_net(
    net: Any,
    values: ArrayLike | None = None,
    cut: str | None = None,
    *,
    title: str = "",
    label: str = "",
    limits: tuple[float, float] | None = None,
) -> Figure:
    """Draw a net or a mesh: its surface, or a cut through it.

    Args:
        net: a TetraNet, a TetraMesh, or a pair of points (n, 3) and tets (m, 4).
        values: (m,), one a tetra, in the order of the tets: of a net, its iteration order. NaN is drawn grey.
        cut: a plane, `x=0.3` or `x=50%`; the surface unless given.
        title: taken as it is, without formulas; where the cut lies is added.
        label: of the colour bar.
        limits: the values of the first and the last colour, those of all tetras unless given: so two pictures of one
            net can be compared. Values beyond get the colour of the limit.

    Raises:
        InputError: values or limits of another kind, no plane, a plane outside the net or where no tetra is, no tetras.
    """
    from tetrabench.mesh.surface import find_surface  # compiles, so not before it is needed

    points, tets = _arrays(net)
    colours = _choose_colours(values, len(tets), limits, label)
    plane = None if cut is None else find_plane(cut, points[np.unique(tets)])
    surface = find_surface(points, tets)
    if plane is None:
        return _draw_surface(points, surface, colours, title)
    polygons = cut_mesh(points, tets, plane.normal, plane.value)
    if not len(polygons.tetras):
        raise InputError(f"the plane {plane} meets no tetra, or only touches some; choose another")
    return _draw_cut(points, surface, plane, polygons, colours, ", ".join(filter(None, (title, f"cut at {plane}"))))


def _arrays(net: Any) -> tuple[Reals, NDArray[np.int32]]:
    """Points (n, 3) and tets (m, 4), checked, of what can be drawn."""
    if isinstance(net, TetraMesh):
        points, tets = net.points, net.tets
    elif isinstance(net, tuple | list):
        points, tets = net
    else:
        points, tets = net.points, net.vertices
    points = np.asarray(points, np.float64)
    if points.ndim != 2 or points.shape[1] != 3:
        raise InputError(f"points are numbers of the shape (n, 3), not {points.shape}")
    tets = as_vertices(tets, len(points))
    if not len(tets):
        raise InputError("there is no tetra to draw")
    return points, tets


def _choose_colours(values: ArrayLike | None, tetras: int, limits: tuple[float, float] | None, label: str) -> Colours:
    if values is None:
        return Colours(None, Normalize(0, 1), label)
    reals = np.asarray(values, np.float64)
    if reals.shape != (tetras,):
        raise InputError(f"one value for each of {tetras:,} tetras is needed, not {reals.shape}")
    finite = reals[np.isfinite(reals)]
    low, high = limits or ((finite.min(), finite.max()) if len(finite) else (0.0, 1.0))
    if not low <= high:
        raise InputError(f"limits are a lower and a higher value, not {low} and {high}")
    return Colours(reals, Normalize(low, high), label)


def _draw_surface(points: Reals, surface: Surface, colours: Colours, title: str) -> Figure:
    figure = Figure(figsize=(WIDTH, HEIGHT))
    add_title(figure, title)
    bar = 0.0 if colours.values is None else 0.12
    axes = add_space(figure, (0.01, 0.03, 0.97 - bar, 0.91), points[np.unique(surface.triangles)], zoom=1.04)
    _add_surface(axes, points, surface, colours.of(surface.tetras), EDGE, DARKEST)
    if colours.values is not None:
        _add_bar(figure, figure.add_axes((0.86, 0.2, 0.022, 0.5)), colours, "vertical")
    return figure


def _draw_cut(points: Reals, surface: Surface, plane: Plane, polygons: Cut, colours: Colours, title: str) -> Figure:
    """The cut in its plane, and beside it where that lies, above the colour bar."""
    across, up = (axis for axis in range(3) if axis != plane.axis)
    corners = polygons.corners[..., (across, up)]
    rim = cut_triangles(points, surface.triangles, plane.normal, plane.value)
    extent = np.ptp(corners.reshape(-1, 2), axis=0)
    width = WIDTH - BESIDE - 1.1  # inches, of the cut with its margins
    height = float(np.clip(width * extent[1] / max(extent[0], TINY), 2.6, 6.6))
    figure = Figure(figsize=(WIDTH, height + 1.2))
    add_title(figure, title)

    def place(left: float, bottom: float, width: float, height: float) -> Place:
        """Of axes, from inches."""
        w, h = figure.get_size_inches()
        return left / w, bottom / h, width / w, height / h

    axes = figure.add_axes(place(0.8, 0.6, width, height))
    look = paint(colours.of(polygons.tetras), EDGE)
    look["antialiased"] = len(corners) <= FEW  # there is the rim to smooth the outline
    axes.add_collection(PolyCollection(list(corners), **look))
    axes.add_collection(LineCollection(list(rim[..., (across, up)]), colors=RIM, linewidths=0.9, capstyle="round"))
    axes.set_aspect("equal")
    axes.margins(0.03)
    axes.set(xlabel=AXES[across], ylabel=AXES[up])
    axes.spines[["top", "right"]].set_visible(False)

    left, top = WIDTH - BESIDE - 0.15, figure.get_figheight()
    inset = add_space(figure, place(left, top - 2.6, BESIDE, 2.2), points[np.unique(surface.triangles)], zoom=1.1)
    inset.set_axis_off()
    inset.computed_zorder = False  # the cut shines through what is before it
    _add_surface(inset, points, surface, np.tile(GLASS, (len(surface.tetras), 1)), None, DARKEST_GLASS)
    inset.add_collection3d(Poly3DCollection(polygons.corners, **paint(colours.of(polygons.tetras), None)))
    inset.add_collection3d(Line3DCollection(rim, colors=RIM, linewidths=0.7))
    if colours.values is not None:
        bar = figure.add_axes(place(left + 0.15, top - 2.85, BESIDE - 0.3, 0.14))
        _add_bar(figure, bar, colours, "horizontal")
    return figure


def add_space(figure: Figure, place: Place, points: Reals, zoom: float) -> Any:
    """Add axes that hold the points (n, 3), one unit as long on each, seen from the eye without perspective."""
    with rc_context({"grid.color": "#dddddd", "grid.linewidth": 0.6}):
        axes: Any = figure.add_axes(place, projection="3d")
    low, high = points.min(axis=0), points.max(axis=0)
    extent = np.maximum(high - low, 1e-3 * ((high - low).max() or 1.0))  # a net may be flat
    axes.set(**{f"{name}lim": (low[n], low[n] + extent[n]) for n, name in enumerate(AXES)})
    axes.set_box_aspect(extent, zoom=zoom)
    axes.set_proj_type("ortho")
    axes.view_init(ELEVATION, AZIMUTH)
    for axis, name, length in zip((axes.xaxis, axes.yaxis, axes.zaxis), AXES, extent / extent.max(), strict=True):
        axis.set_major_locator(MaxNLocator(max(1, round(5 * length)), min_n_ticks=1))
        axis.set_label_text(name)
        axis.set_pane_color((0.97, 0.97, 0.97, 1.0))
    return axes


def _add_surface(axes: Any, points: Reals, surface: Surface, colours: Reals, edge: str | None, darkest: float) -> None:
    """Add the triangles that face the eye, darker the more they turn away from the light, down to a share."""
    corners = points[surface.triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1), TINY)[:, None]
    turned = normals @ eye().T
    seen = turned[:, 2] > 0
    light = np.clip(turned[seen] @ (LIGHT / np.linalg.norm(LIGHT)), 0, 1)
    shaded = colours[seen]
    shaded[:, :3] *= darkest + (1 - darkest) * light[:, None]
    axes.add_collection3d(Poly3DCollection(corners[seen], **paint(shaded, edge)))


def eye() -> Reals:
    """The directions to the right, upwards and to the eye, (3, 3): a row each."""
    elevation, azimuth = np.radians(ELEVATION), np.radians(AZIMUTH)
    right = np.array([-np.sin(azimuth), np.cos(azimuth), 0.0])
    level = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
    eye = np.cos(elevation) * level + np.sin(elevation) * np.array([0.0, 0.0, 1.0])
    return np.array([right, np.cross(eye, right), eye])


def paint(colours: Reals, edge: str | None) -> dict[str, Any]:
    """What draws shapes of these colours (k, 4): edges where they are few, of their own colour else, to close the seams."""
    if len(colours) > FEW or edge is None:
        return {"facecolors": colours, "edgecolors": colours, "linewidths": 0.25, "rasterized": True}
    return {"facecolors": colours, "edgecolors": edge, "linewidths": 0.3}


def add_title(figure: Figure, title: str) -> None:
    """Write a title, without formulas, above all axes."""
    top = 1 - 0.12 / figure.get_figheight()
    figure.text(0.02, top, title, fontsize=12, fontweight="bold", va="top", parse_math=False)


def _add_bar(figure: Figure, place: Axes, colours: Colours, orientation: str) -> None:
    bar = figure.colorbar(colours.mappable, cax=place, orientation=orientation, extend=colours.beyond)
    bar.set_label(colours.label, parse_math=False)
    bar.outline.set_visible(False)  # type: ignore[operator]


def save_picture(figure: Figure, path: Path) -> None:
    """Write a picture in the format of the suffix.

    Raises:
        InputError: the file cannot be written.
    """
    try:
        figure.savefig(path, dpi=DOTS)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from error
