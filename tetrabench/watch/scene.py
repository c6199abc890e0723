"""What is drawn of a simulation, as plain arrays in pixels; the window and the film only paint it.

In the plane y points up, in a picture down: a View knows the way between the two.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from tetrabench.collision.objects import Start
    from tetrabench.collision.simulation import Simulation

Floats = NDArray[np.float64]

BACKGROUND, FLOOR, WALL = "#0e1217", "#151b23", "#4a5766"  # around the box, in it, its border
LEAF = "#2c3a48"
OBJECT, CONTACT = "#6fb1dc", "#f0a330"  # blue and orange: apart for all eyes
OPACITY = 0.88  # of an object: so overlaps are seen
BRIGHT, QUIET = "#d5dce4", "#8793a0"  # words

MARGIN = 14  # pixels around the box
LINE = 18  # pixels, a line of words
LETTERS = 13  # pixels, their height
LEAST_LEAF = 3.0  # pixels: borders that lie nearer to each other would only be a blur
LEAST_RADIUS = 1.25  # pixels: what is smaller would not be seen
LONGEST_SIDE = 860  # pixels, of a box that is seen whole in a picture of the usual size
NARROWEST = 960  # pixels: the words need that


@dataclass(frozen=True)
class View:
    """Which part of the plane is seen.

    Attributes:
        x, y: the place in the middle of the picture.
        scale: pixels a unit.
        width, height: of the picture, in pixels.
    """

    x: float
    y: float
    scale: float
    width: int
    height: int

    def across(self, x: Floats) -> Floats:
        """Pixels from the left."""
        return self.width / 2 + (x - self.x) * self.scale

    def down(self, y: Floats) -> Floats:
        """Pixels from the top."""
        return self.height / 2 - (y - self.y) * self.scale

    def zoomed(self, factor: float, across: float, down: float) -> View:
        """Nearer by a factor; what lies at a pixel stays there."""
        right, up = across - self.width / 2, self.height / 2 - down
        change = (1 - 1 / factor) / self.scale
        return replace(self, x=self.x + right * change, y=self.y + up * change, scale=self.scale * factor)

    def shifted(self, across: float, down: float) -> View:
        """With everything moved by so many pixels."""
        return replace(self, x=self.x - across / self.scale, y=self.y + down / self.scale)


@dataclass(frozen=True)
class Scene:
    """What is drawn; places in pixels from the upper left corner of the picture.

    Attributes:
        width, height: of the picture.
        box: (4,) float64: left, top, right, bottom.
        leaves: (l, 4) float64, likewise, whole numbers: those that can be seen, clipped to the picture and to the box.
        places: (k, 2) float64, across and down, of the objects that are seen; those in contact last, so that none hides them.
        radii: (k,) float64, at least LEAST_RADIUS.
        in_contact: (k,) bool.
        lines: words at the top, the first one bright.
    """

    width: int
    height: int
    box: Floats
    leaves: Floats
    places: Floats
    radii: Floats
    in_contact: NDArray[np.bool_]
    lines: tuple[str, ...]

    @property
    def bar(self) -> int:
        """Pixels at the top that the words take."""
        return bar_height(len(self.lines))


def bar_height(lines: int) -> int:
    """Pixels that so many lines of words take."""
    return LINE * lines + 10 if lines else 0


def picture_size(start: Start, lines: int) -> tuple[int, int]:
    """Width and height in pixels, even numbers, of a picture of the box beneath so many lines."""
    scale = LONGEST_SIDE / max(start.width, start.height)
    width = max(NARROWEST, round(start.width * scale) + 2 * MARGIN)
    height = max(240, round(start.height * scale)) + 2 * MARGIN + bar_height(lines)
    return width + width % 2, height + height % 2


def whole_view(start: Start, width: int, height: int, lines: int) -> View:
    """The view of the whole box beneath so many lines of words."""
    bar = bar_height(lines)
    room = max(width - 2 * MARGIN, 1), max(height - bar - 2 * MARGIN, 1)
    scale = min(room[0] / start.width, room[1] / start.height)
    return View(start.width / 2, start.height / 2 + bar / 2 / scale, scale, width, height)


def make_scene(
    simulation: Simulation,
    view: View,
    pairs: NDArray[np.int32],
    lines: tuple[str, ...] = (),
    *,
    has_leaves: bool = True,
) -> Scene:
    """What a view shows of a simulation as it is now.

    Args:
        simulation: its objects, its box, its leaves.
        view: of the plane.
        pairs: (k, 2) int32, objects in contact.
        lines: words at the top.
        has_leaves: whether their borders are shown.
    """
    x, y, _, _, r, _ = simulation.objects
    in_contact = np.zeros(len(x), np.bool_)
    in_contact[pairs.ravel()] = True
    across, down, radii = view.across(x), view.down(y), np.maximum(r * view.scale, LEAST_RADIUS)
    # Not a number is never seen.
    seen = np.flatnonzero(
        (across > -radii) & (across < view.width + radii) & (down > -radii) & (down < view.height + radii)
    )
    seen = seen[np.argsort(in_contact[seen], kind="stable")]
    box = to_pixels(np.array([[0.0, 0.0, simulation.start.width, simulation.start.height]]), view)[0]
    leaves = to_pixels(simulation.leaf_rectangles(), view) if has_leaves else np.empty((0, 4))
    return Scene(
        view.width,
        view.height,
        box,
        clipped(leaves, box, view),
        np.column_stack([across[seen], down[seen]]),
        radii[seen],
        in_contact[seen],
        lines,
    )


def to_pixels(rectangles: Floats, view: View) -> Floats:
    """Rectangles (n, 4) of the plane (x_low, y_low, x_high, y_high) as they lie in the picture (left, top, right, bottom)."""
    x_low, y_low, x_high, y_high = rectangles.T
    return np.column_stack([view.across(x_low), view.down(y_high), view.across(x_high), view.down(y_low)])


def clipped(leaves: Floats, box: Floats, view: View) -> Floats:
    """Leaves (n, 4) in whole pixels, without what lies outside of the box or of the picture, and without the smallest."""
    low = np.maximum(box[:2], -2.0)  # a border that lies outside stays outside
    high = np.minimum(box[2:], [view.width + 1.0, view.height + 1.0])
    corners = np.column_stack([np.maximum(leaves[:, :2], low), np.minimum(leaves[:, 2:], high)])
    is_seen = (corners[:, :2] < corners[:, 2:]).all(axis=1)
    is_large = (leaves[:, 2:] - leaves[:, :2] >= LEAST_LEAF).all(axis=1)
    whole: Floats = np.rint(corners[is_seen & is_large])
    return whole
