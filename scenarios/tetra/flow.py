"""flow: simple diffusion between neighbours through their common sides. Thesis, 4.6.4, its formula corrected.

The source prints V_a - V_n in the denominator; from its own derivation (the distances of the centroids to the common side,
added) it must be the sum. Here

    a_new = a + t * sum over the sides with a neighbour of  -k (a - n_i) S_i^2 / (V_a + V_n),    k = 1

Each side's term is antisymmetric, so the sum of a over the net stays the same; with t = 0.9 / max over the tetras of
(sum of k S_i^2 / (V_a + V_n)) min and max never widen (to rounding). t is found before, untimed.
"""

from typing import Any, NamedTuple

from tetrabench.jit import kernel
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.tetra.alfa import copy_back
from tetrabench.scenarios.tetra.base import TetraScenario
from tetrabench.tetra.interface import (
    NONE,
    Net,
    first_tetra,
    neighbour,
    next_tetra,
    set_state,
    side_area,
    state,
    volume,
)
from tetrabench.tetra.net import TetraNet

K = 1.0
SAFETY = 0.9
SWEEP_BYTES = 4 * 4 + 4 * 8 + 8 + 4 * 8 + 8 + 8
"""Least traffic for a tetra in one sweep: that of alfa, its volume and its four side areas, counted once."""


class Diffusion(NamedTuple):
    """How often to sweep over which net, with which step of time."""

    net: TetraNet
    sweeps: int
    step: float


class Flow(TetraScenario):
    """Sweeps of diffusion: states, volumes, side areas and neighbours."""

    name = "flow"
    title = "sweeps of diffusion through the sides: states, volumes, side areas and neighbours are read"
    options = {"sweeps": 50}
    thesis = {"sweeps": 200}

    def prepare(self, stage: Any, options: Options) -> Diffusion:
        """A net with its initial states, and the largest stable step of time for it."""
        net = stage.net()
        largest = largest_exchange(net.storage)
        return Diffusion(net, options["sweeps"], SAFETY / largest if largest > 0.0 else 0.0)

    def run(self, diffusion: Diffusion) -> None:
        """Sweep."""
        diffuse(diffusion.net.storage, diffusion.sweeps, diffusion.step)

    def answer(self, diffusion: Diffusion, outcome: None) -> Answer:
        """The states, with all of the net."""
        whole = diffusion.net.answer()
        return Answer(whole.digest, {**whole.figures, "step": diffusion.step})

    def work(self, diffusion: Diffusion, outcome: None) -> Work:
        """Visited tetras."""
        visits = len(diffusion.net) * diffusion.sweeps
        return Work(visits, "tetra visits", visits * SWEEP_BYTES)


@kernel(allocates=False)
def diffuse(net: Net, sweeps: int, step: float) -> None:
    """Sweep `sweeps` times: state 0 -> state 1, then copied back."""
    for _ in range(sweeps):
        cursor = first_tetra(net)
        while cursor.tetra != NONE:
            t = cursor.tetra
            own, own_volume = state(net, t, 0), volume(net, t)
            gain = 0.0
            for i in range(4):
                other = neighbour(net, t, i)
                if other != NONE:
                    both = own_volume + volume(net, other)
                    if both > 0.0:
                        area = side_area(net, t, i)
                        gain += -K * (own - state(net, other, 0)) * (area * area) / both
            set_state(net, t, 1, own + step * gain)
            cursor = next_tetra(net, cursor)
        copy_back(net)


@kernel(allocates=False)
def largest_exchange(net: Net) -> float:
    """Max over the tetras of the sum of k S_i^2 / (V_a + V_n); its inverse bounds the step of time."""
    largest = 0.0
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        t = cursor.tetra
        exchange = 0.0
        for i in range(4):
            other = neighbour(net, t, i)
            if other != NONE:
                both = volume(net, t) + volume(net, other)
                if both > 0.0:
                    exchange += K * side_area(net, t, i) ** 2 / both
        largest = max(largest, exchange)
        cursor = next_tetra(net, cursor)
    return largest
