"""The nozzle: converging and diverging, solid and round, with a curved wall. The larger model of the source (Győr 2011)."""

import numpy as np
from numpy.typing import NDArray

from tetrabench.mesh.models.model import Model, Points
from tetrabench.mesh.models.pipe import Pipe, build_pipe

Reals = NDArray[np.float64]

THROAT, LENGTH = 0.08, 0.18  # heights of the throat and the outlet, metres


def radius(z: Reals) -> Reals:
    """Radii at the heights z, (k,), metres: 0.10 in the inlet, 0.05 in the throat, 0.09 in the outlet.

    Two half cosine waves meet in the throat, so radius and slope are continuous.
    """
    converging = 0.075 + 0.025 * np.cos(np.pi * z / THROAT)
    diverging = 0.07 - 0.02 * np.cos(np.pi * (z - THROAT) / (LENGTH - THROAT))
    return np.where(z < THROAT, converging, diverging)


def place(disc: Points, z: Reals) -> Points:
    """The disc (n, 2) as section at each of the heights z (k,): (k, n, 3)."""
    points = np.empty((len(z), len(disc), 3))
    points[:, :, :2] = disc * radius(z)[:, None, None]
    points[:, :, 2] = z[:, None]
    return points


PIPE = Pipe(length=LENGTH, radius=radius, place=place)

NOZZLE = Model(
    "nozzle",
    "converging-diverging nozzle, curved wall, round cross-section",
    642_700,
    lambda wanted: build_pipe(PIPE, wanted),
)
