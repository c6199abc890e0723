"""What a model is: a division into tets before its points are moved, and the row that names it."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import ClassVar, TypeVar

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]
Tets = NDArray[np.int32]
Choice = TypeVar("Choice")


@dataclass(frozen=True)
class Regular:
    """A model before its points are moved.

    Attributes:
        points: (n, 3) float64, metres.
        tets: (m, 4) int32, all of positive volume.
        reach: (n,) float64, metres: how far each coordinate of a point may be moved; 0 on the surface.
        words: how the model is divided.
    """

    points: Points
    tets: Tets
    reach: NDArray[np.float64]
    words: str


@dataclass(frozen=True)
class Model:
    """A row of MODELS: name, one-line title, default number of tets, and the function that builds about that
    many."""

    family: ClassVar[str] = "tetra"
    name: str
    title: str
    tets: int
    build: Callable[[int], Regular]


def nearest(
    choices: Iterable[Choice],
    *,
    count: Callable[[Choice], int],
    wanted: int,
    distortion: Callable[[Choice], float],
) -> Choice:
    """Choose the least distorted division among those within 1 % of the count wanted; where none is, the
    nearest count."""

    def cost(choice: Choice) -> tuple[int, float]:
        return max(wanted // 100, abs(count(choice) - wanted)), distortion(choice)

    return min(choices, key=cost)
