"""gradient: what a finite volume code of second order does in each step: the gradient of a field that has a value a cell.

In each tetra it is the vector g that fits the values a of the neighbours best, in least squares over the differences d of
their centroids:

    (sum of d d^T) g = sum of d (a_n - a)

Exact for a linear field. A tetra whose neighbours lie in a plane with it, or that has fewer than three, gets 0. Source: T. J.
Barth, D. C. Jespersen, The design and application of upwind schemes on unstructured meshes, AIAA 89-0366, 1989.

It reads what hotcold calls hot (neighbours, states) and what it calls cold (centroids): the price of drawing that line.
"""

from typing import Any, NamedTuple

from tetrabench.jit import kernel
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.tetra.base import TetraScenario
from tetrabench.tetra.interface import NONE, Net, centroid, first_tetra, neighbour, next_tetra, set_state, state
from tetrabench.tetra.net import TetraNet

FLAT = 1e-9
"""Below this part of the cube of its trace a determinant is one of neighbours in a plane."""

SWEEP_BYTES = 4 * 4 + 3 * 8 + 8 + 3 * 8
"""Least traffic for a tetra in one sweep: its neighbours, centroid and value are read, its gradient written."""


class Sweeping(NamedTuple):
    """How often to sweep over which net."""

    net: TetraNet
    sweeps: int


class Gradient(TetraScenario):
    """Sweeps over neighbours, centroids and states; the gradient of state 0 is left in states 1 to 3."""

    name = "gradient"
    title = "sweeps of a gradient by least squares: one state, the neighbours and the centroids are read"
    options = {"sweeps": 20}

    def prepare(self, stage: Any, options: Options) -> Sweeping:
        """A net with its initial states."""
        return Sweeping(stage.net(), options["sweeps"])

    def run(self, sweeping: Sweeping) -> None:
        """Sweep."""
        find_gradients(sweeping.net.storage, sweeping.sweeps)

    def answer(self, sweeping: Sweeping, outcome: None) -> Answer:
        """The states, with all of the net."""
        return sweeping.net.answer()

    def work(self, sweeping: Sweeping, outcome: None) -> Work:
        """Visited tetras."""
        visits = len(sweeping.net) * sweeping.sweeps
        return Work(visits, "tetra visits", visits * SWEEP_BYTES)


@kernel(allocates=False)
def find_gradients(net: Net, sweeps: int) -> None:
    """Sweep `sweeps` times, each with the same outcome: the gradient of state 0 -> states 1 to 3."""
    for _ in range(sweeps):
        cursor = first_tetra(net)
        while cursor.tetra != NONE:
            t = cursor.tetra
            x, y, z = gradient_in(net, t)
            set_state(net, t, 1, x)
            set_state(net, t, 2, y)
            set_state(net, t, 3, z)
            cursor = next_tetra(net, cursor)


@kernel(allocates=False, inline=True)
def gradient_in(net: Net, t: int) -> tuple[Any, Any, Any]:
    """The gradient in one tetra, by Cramer's rule."""
    own = state(net, t, 0)
    xx, xy, xz, yy, yz, zz = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    x, y, z = 0.0, 0.0, 0.0
    for i in range(4):
        other = neighbour(net, t, i)
        if other != NONE:
            dx = centroid(net, other, 0) - centroid(net, t, 0)
            dy = centroid(net, other, 1) - centroid(net, t, 1)
            dz = centroid(net, other, 2) - centroid(net, t, 2)
            rise = state(net, other, 0) - own
            xx, xy, xz = xx + dx * dx, xy + dx * dy, xz + dx * dz
            yy, yz, zz = yy + dy * dy, yz + dy * dz, zz + dz * dz
            x, y, z = x + dx * rise, y + dy * rise, z + dz * rise
    a, b, c = yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy
    determinant = xx * a + xy * b + xz * c
    trace = xx + yy + zz
    if determinant <= FLAT * (trace * trace * trace):
        return 0.0, 0.0, 0.0
    d, e, f = xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy
    return (
        (a * x + b * y + c * z) / determinant,
        (b * x + d * y + e * z) / determinant,
        (c * x + e * y + f * z) / determinant,
    )


SCENARIOS = [Gradient()]
