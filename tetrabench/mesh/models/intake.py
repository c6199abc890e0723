"""The intake pipe: bent through 90 degrees, from a round inlet to a flat rounded outlet. The smaller model of the source
(Győr 2011), whose file is lost: its size is kept, its shape is ours."""

import numpy as np
from numpy.typing import NDArray

from tetrabench.mesh.models.model import Model, Points
from tetrabench.mesh.models.pipe import Pipe, build_pipe

Reals = NDArray[np.float64]

STRAIGHT, BEND = 0.05, 0.10  # metres: length before and after the bend, radius of its centre line
LENGTH = STRAIGHT + np.pi / 2 * BEND + STRAIGHT
WIDTH = 0.032  # half of it, across the plane of the bend, metres
INLET_HEIGHT, OUTLET_HEIGHT = 0.032, 0.020  # half of it, in the plane of the bend
INLET_EXPONENT, OUTLET_EXPONENT = 2.0, 4.0


def change(places: Reals) -> Reals:
    """How far the inlet's section has become the outlet's, 0 to 1: half a cosine wave."""
    return 0.5 - 0.5 * np.cos(np.pi * places / LENGTH)


def height(places: Reals) -> Reals:
    """Half the height of the sections, (k,), metres."""
    return INLET_HEIGHT + (OUTLET_HEIGHT - INLET_HEIGHT) * change(places)


def centre_line(places: Reals) -> tuple[Points, Points]:
    """Points of the centre line, from the origin along z and at last along x, and the directions from there towards
    the centre of the bend: two (k, 3)."""
    angle = np.clip((places - STRAIGHT) / BEND, 0.0, np.pi / 2)
    before, after = np.minimum(places, STRAIGHT), np.maximum(places - (LENGTH - STRAIGHT), 0.0)
    zero = np.zeros_like(places)
    points = np.stack([BEND * (1 - np.cos(angle)) + after, zero, before + BEND * np.sin(angle)], axis=1)
    return points, np.stack([np.cos(angle), zero, -np.sin(angle)], axis=1)


def place(disc: Points, places: Reals) -> Points:
    """The disc (n, 2) as section at each of the places (k,) of the centre line: (k, n, 3).

    A section is a superellipse (Lamé 1818), |u / height|^p + |v / width|^p = 1, with u towards the centre of the
    bend and v along y. The exponent 2 makes an ellipse, 4 a rectangle with round corners. Each point of the disc
    stays on its ray from the middle.
    """
    p = (INLET_EXPONENT + (OUTLET_EXPONENT - INLET_EXPONENT) * change(places))[:, None]
    norm = (np.abs(disc[:, 0]) ** p + np.abs(disc[:, 1]) ** p) ** (1 / p)
    stretch = np.divide(np.hypot(disc[:, 0], disc[:, 1]), norm, out=np.ones_like(norm), where=norm > 0)
    u, v = disc[:, 0] * stretch * height(places)[:, None], disc[:, 1] * stretch * WIDTH
    centre, inwards = centre_line(places)
    points = centre[:, None, :] + u[:, :, None] * inwards[:, None, :]
    points[:, :, 1] += v
    return points


PIPE = Pipe(length=LENGTH, radius=height, place=place, fewest_layers=8)

INTAKE = Model(
    "intake",
    "intake pipe, bent through 90 degrees, round inlet, flat rounded outlet",
    155_325,
    lambda wanted: build_pipe(PIPE, wanted),
)
