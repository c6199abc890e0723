"""Sod's shock tube as the theory of one dimension has it: exact, for what the scenarios compute.

Source: E. F. Toro, Riemann Solvers and Numerical Methods for Fluid Dynamics, chapter 4: a rarefaction to the left, a shock
to the right (G. A. Sod, A survey of several finite difference methods for systems of nonlinear hyperbolic conservation
laws, 1978).
"""

import numpy as np
from scipy.optimize import brentq

GAMMA = 1.4
LEFT, RIGHT = (1.0, 1.0), (0.125, 0.1)  # density, pressure; at rest


def sound(density, pressure):
    return np.sqrt(GAMMA * pressure / density)


def behind_rarefaction(pressure):
    """Velocity of the gas of the left, expanded to this pressure."""
    return 2 * sound(*LEFT) / (GAMMA - 1) * (1 - (pressure / LEFT[1]) ** ((GAMMA - 1) / (2 * GAMMA)))


def behind_shock(pressure):
    """Velocity of the gas of the right, behind a shock with this pressure."""
    density, before = RIGHT
    return (pressure - before) * np.sqrt(2 / density / ((GAMMA + 1) * pressure + (GAMMA - 1) * before))


def sod(x, time):
    """Density, velocity and pressure at the places x (n,) at a time, the diaphragm having been at 0.5: (3, n) float64."""
    middle = brentq(lambda p: behind_rarefaction(p) - behind_shock(p), RIGHT[1], LEFT[1], xtol=1e-15)
    u = behind_shock(middle)
    speed = (np.asarray(x) - 0.5) / time
    ratio = (GAMMA - 1) / (GAMMA + 1)
    left = LEFT[0] * (middle / LEFT[1]) ** (1 / GAMMA)
    right = RIGHT[0] * (middle / RIGHT[1] + ratio) / (ratio * middle / RIGHT[1] + 1)
    shock = u * right / (right - RIGHT[0])  # mass is conserved
    head, tail = -sound(*LEFT), u - sound(left, middle)
    inside = 2 / (GAMMA + 1) - ratio * speed / sound(*LEFT)  # of the rarefaction: sound speed over that of the left
    places = [speed < head, speed < tail, speed < u, speed < shock]
    return np.array(
        [
            np.select(places, [LEFT[0], LEFT[0] * abs(inside) ** (2 / (GAMMA - 1)), left, right], RIGHT[0]),
            np.select(places, [0.0, 2 / (GAMMA + 1) * (sound(*LEFT) + speed), u, u], 0.0),
            np.select(places, [LEFT[1], LEFT[1] * abs(inside) ** (2 * GAMMA / (GAMMA - 1)), middle, middle], RIGHT[1]),
        ]
    )
