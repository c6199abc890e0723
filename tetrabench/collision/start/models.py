"""Models of objects: a square box with about as much room for each object as the source gave it, the same bits for the
same seed.

Radii, masses, velocities and room are those of the source's published code, since its text gives none.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from tetrabench.collision.objects import Floats, Start, make_objects
from tetrabench.collision.start.numbering import check_numbering, renumber_objects
from tetrabench.collision.start.sweep import sweep
from tetrabench.errors import InputError, find_named
from tetrabench.memory import refuse_if_too_large
from tetrabench.mesh.numbering import check_seed
from tetrabench.traces import named

ROOM = 15_000.0
"""Area of the box for each object, in units^2: the circles of "uniform" cover 2 % of it."""

RADIUS, MASS = 10.0, 5.0
SLOWEST, PACE, PACES = -2.5, 0.5, 10
"""Each component of a velocity is one of -2.5, -2, ..., 2, all as likely. Halves and their sums are exact in binary."""

SMALL, LARGE, ONE_IN = 7.0, 70.0, 100
"""Radii of "mixed": one in a hundred objects, rounded up, has ten times the radius of the others. Circles then have 98 % of
the area that they have in "uniform", so that what differs between the two is the mixture and not how full the box is."""

CLUSTER = 0.1
"""The side of the square in the middle that all of "clustered" are in, in that of the box: 1 % of its area."""

ASTRAY = 100
"""One in so many of "halo", rounded up, is not in the cluster but anywhere in the box."""

MOST_OBJECTS = 2**31 - 1
"""Up to here numbers of objects have room in 32 bits."""

BYTES = 160
"""Memory taken at the peak for each object, measured on all models in all numberings, rounded up."""


@dataclass(frozen=True)
class Model:
    """A row of MODELS.

    Attributes:
        name: as a person types it.
        title: one line.
        place: (count, side of the box, random numbers) -> centres x and y, radii r: (count,) float64 each.
        objects: default number of objects.
    """

    family: ClassVar[str] = "collision"
    name: str
    title: str
    place: Callable[[int, float, np.random.Generator], tuple[Floats, Floats, Floats]]
    objects: int = 100_000


def generate_objects(
    name: str | Model, count: int | None = None, *, numbering: str = "natural", seed: int = 0
) -> Start:
    """Make a model.

    Args:
        name: one of MODELS; or a `Model` of your own.
        count: the number of objects, from 0 (the model's default where None).
        numbering: one of NUMBERINGS; "natural" is at random already.
        seed: of all that is drawn, 0 or more.

    Raises:
        InputError: an unknown model or numbering, one that objects cannot have, fewer objects than none, more than
            MOST_OBJECTS, or a seed below 0.
        MemoryRefusedError: more objects than there is memory for.
    """
    model = name if isinstance(name, Model) else find_named("model", MODELS, name)
    check_numbering(numbering)  # before the work, not after it
    check_seed(seed)
    wanted = model.objects if count is None else count
    if not 0 <= wanted <= MOST_OBJECTS:
        raise InputError(f"a model of {wanted:,} objects cannot be made; ask for 0 to {MOST_OBJECTS:,}")
    refuse_if_too_large(f"a model of {wanted:,} objects", wanted * BYTES)
    random = np.random.default_rng([seed])
    side = math.sqrt(ROOM * max(wanted, 1))
    with named(f"the model {model.name}"):
        x, y, r = model.place(wanted, side, random)
    vx, vy = SLOWEST + PACE * random.integers(PACES, size=(2, wanted))
    objects = make_objects(x, y, vx, vy, r, MASS * r * r / RADIUS**2)  # all of one matter
    source = f"{model.name}: {wanted:,} objects, {model.title}, in a box of {side:,.0f} x {side:,.0f}"
    return renumber_objects(Start(objects, side, side, source), numbering, seed)


def place_uniform(count: int, side: float, random: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """Anywhere in the box."""
    x, y = side * random.random((2, count))
    return x, y, np.full(count, RADIUS)


def place_clustered(count: int, side: float, random: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """As in "uniform", drawn together around the middle of the box."""
    x, y, r = place_uniform(count, side, random)
    return _drawn_together(x, side), _drawn_together(y, side), r


def place_halo(count: int, side: float, random: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """As "clustered", with some of "uniform" around."""
    x, y, r = place_uniform(count, side, random)
    inner = random.permutation(count)[math.ceil(count / ASTRAY) :]
    x[inner], y[inner] = _drawn_together(x[inner], side), _drawn_together(y[inner], side)
    return x, y, r


def _drawn_together(places: Floats, side: float) -> Floats:
    """Places along a side of the box, drawn together around its middle."""
    return (1 - CLUSTER) / 2 * side + CLUSTER * places


def place_mixed(count: int, side: float, random: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """As in "uniform", but for the radii."""
    x, y, r = place_uniform(count, side, random)
    r[:] = SMALL
    r[random.permutation(count)[: math.ceil(count / ONE_IN)]] = LARGE
    return x, y, r


def place_separated(count: int, side: float, random: np.random.Generator) -> tuple[Floats, Floats, Floats]:
    """As in "uniform"; then those in contact with one of a lower number are placed anew, until there are none.

    With so much room one in 25 is in contact, and each round leaves as small a part of those that it places.
    """
    x, y, r = place_uniform(count, side, random)
    while (again := sweep(x, y, r)[1]).any():
        x[again], y[again] = side * random.random((2, np.count_nonzero(again)))
    return x, y, r


MODELS = {
    model.name: model
    for model in (
        Model("uniform", "all of radius 10, anywhere", place_uniform),
        Model("clustered", "all of radius 10, within 1 % of the area", place_clustered),
        Model("halo", "all of radius 10, within 1 % of the area, but for one in a hundred, anywhere", place_halo),
        Model("mixed", "radii 7 and, of one in a hundred, 70, anywhere", place_mixed),
        Model("separated", "all of radius 10, none in contact", place_separated),
    )
}


def add_model(model: Model) -> None:
    """Take in a model of others, under its name, in the place of one of that name.

    Raises:
        InputError: it is no Model.
    """
    if not isinstance(model, Model):
        raise InputError(f"a {type(model).__name__}, not a {Model.__module__}.Model")
    MODELS[model.name] = model
