"""Objects: circles in a box with places, velocities, radii and masses; what every simulation starts from."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetrabench.errors import InputError

Floats = NDArray[np.float64]

WORDS = {"x": "x", "y": "y", "vx": "velocity in x", "vy": "velocity in y", "r": "radius", "m": "mass"}


class Objects(NamedTuple):
    """Circles, number i at place i of each array: all (n,) float64, contiguous. Units are the user's; a step is one of time."""

    x: Floats
    y: Floats
    vx: Floats
    vy: Floats
    r: Floats
    m: Floats


@dataclass(frozen=True)
class Start:
    """What a simulation starts from.

    Attributes:
        objects: they may lie outside of the box.
        width, height: the box is [0, width] x [0, height].
        source: where they come from, in words.
    """

    objects: Objects
    width: float
    height: float
    source: str = "objects"


def make_objects(
    x: ArrayLike, y: ArrayLike, vx: ArrayLike = 0.0, vy: ArrayLike = 0.0, r: ArrayLike = 10.0, m: ArrayLike = 5.0
) -> Objects:
    """Objects from lists of numbers, copied; one number stands for all, but for x.

    Raises:
        InputError: see `check_objects`.
    """
    count = np.size(x)
    columns = []
    for name, values in zip(Objects._fields, (x, y, vx, vy, r, m), strict=True):
        try:
            column = np.array(values, np.float64)
        except (TypeError, ValueError) as error:
            raise InputError(f"{WORDS[name]}: a list of numbers is needed, one for each object") from error
        columns.append(np.full(count, column) if column.ndim == 0 else np.ascontiguousarray(column))
    objects = Objects(*columns)
    check_objects(objects)
    return objects


def check_objects(objects: Objects) -> None:
    """Refuse what is no circle.

    Raises:
        InputError: lists of unequal lengths, a number that is not finite, a radius or a mass that is not above 0; names the
            first object that is at fault.
    """
    lengths = {name: column.shape for name, column in objects._asdict().items()}
    if any(len(shape) != 1 or shape != lengths["x"] for shape in lengths.values()):
        told = ", ".join(f"{name} {'x'.join(map(str, shape))}" for name, shape in lengths.items())
        raise InputError(f"objects: lists of one length are needed, not {told}")
    for name, column in objects._asdict().items():
        _refuse(column, ~np.isfinite(column), f"the {WORDS[name]} has to be a finite number")
    for name in ("r", "m"):
        column = getattr(objects, name)
        _refuse(column, column <= 0, f"the {WORDS[name]} has to be above 0")


def check_box(width: float, height: float) -> None:
    """Refuse, with InputError, what is no box."""
    if not (0 < width < np.inf and 0 < height < np.inf):
        raise InputError(f"a box of {width} x {height}: width and height have to be finite numbers above 0")


def copy_objects(objects: Objects) -> Objects:
    """The same objects, in arrays of their own."""
    return Objects(*(column.copy() for column in objects))


def _refuse(column: Floats, is_bad: NDArray[np.bool_], demand: str) -> None:
    if is_bad.any():
        first = int(np.argmax(is_bad))
        more = int(is_bad.sum()) - 1
        raise InputError(f"object {first}: {demand}, not {column[first]}" + (f" (and {more:,} more)" if more else ""))
