"""inspect_objects: what a person wants to know about a start before working with it."""

import math
from dataclasses import dataclass, field

import numpy as np

from tetrabench.collision.objects import Floats, Start
from tetrabench.collision.start.sweep import sweep


@dataclass(frozen=True)
class ObjectsInspection:
    """What there is to say about a start. These are also the keys of `tetrabench info --format json`.

    Attributes:
        source: path of the file, or the words that describe a generated model.
        objects: objects.
        width: of the box, which begins at 0, in the file's unit of length.
        height: of the box.
        lowest: the least x and y of a centre; like all pairs of numbers here, none where there are no objects.
        highest: the greatest x and y of a centre.
        outside: centres that are not in the box.
        radii: the least and the greatest one.
        masses: the least and the greatest one.
        speeds: the least and the greatest one, in units of length a step.
        covered: area of all circles over that of the box, those that overlap or are outside counted in full.
        contacts: pairs of objects in contact.
        stride: mean distance of an object from the next one in the file, over the mean spacing sqrt(width height / objects):
            about 1 where neighbours in space are neighbours in memory (`convert --numbering hilbert`), as many times that as
            the box is wide where they are not; None below two objects.
        warnings: sentences of the reader: none so far.
        refusal: "": what is refused cannot be described.
    """

    source: str
    objects: int
    width: float
    height: float
    lowest: tuple[float, ...]
    highest: tuple[float, ...]
    outside: int
    radii: tuple[float, ...]
    masses: tuple[float, ...]
    speeds: tuple[float, ...]
    covered: float
    contacts: int
    stride: float | None
    warnings: list[str] = field(default_factory=list)
    refusal: str = ""


@np.errstate(over="ignore")  # numbers may be beyond float64: infinite, then
def inspect_objects(start: Start) -> ObjectsInspection:
    """Inspect a start."""
    x, y, vx, vy, r, m = start.objects
    corners = [_range(axis) for axis in (x, y)]
    return ObjectsInspection(
        source=start.source,
        objects=len(x),
        width=start.width,
        height=start.height,
        lowest=tuple(low for low, _ in filter(None, corners)),
        highest=tuple(high for _, high in filter(None, corners)),
        outside=count_outside(start),
        radii=_range(r),
        masses=_range(m),
        speeds=_range(np.hypot(vx, vy)),
        covered=math.pi * float(np.sum((r / start.width) * (r / start.height))),
        contacts=sweep(x, y, r)[0],
        stride=_stride(start),
    )


def _stride(start: Start) -> float | None:
    x, y = start.objects.x, start.objects.y
    if len(x) < 2:
        return None
    spacing = math.sqrt(start.width / len(x)) * math.sqrt(start.height)
    return float(np.mean(np.hypot(np.diff(x), np.diff(y))) / spacing)


def count_outside(start: Start) -> int:
    """How many centres are not in the box."""
    x, y = start.objects.x, start.objects.y
    is_inside = (x >= 0) & (x <= start.width) & (y >= 0) & (y <= start.height)
    return int(np.count_nonzero(~is_inside))


def _range(column: Floats) -> tuple[float, ...]:
    return (float(column.min()), float(column.max())) if len(column) else ()
