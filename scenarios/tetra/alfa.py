"""alfa: each tetra's state moves towards the mean of its neighbours. Thesis, 4.6.3, its formula corrected.

The source prints a_new = k a + (1 - k) * sum of n_i, which is no mean and grows without bound. Here

    a_new = k a + (1 - k) / 4 * sum over the four sides of (n_i, or a where there is no neighbour),    k = 0.5

The weights are symmetric, so the sum over the net stays the same, and min and max never widen (to rounding).
"""

from typing import Any, NamedTuple

from tetrabench.jit import kernel
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.tetra.base import TetraScenario
from tetrabench.tetra.interface import (
    NONE,
    Net,
    first_tetra,
    neighbour,
    next_tetra,
    set_state,
    state,
)
from tetrabench.tetra.net import TetraNet

K = 0.5
SWEEP_BYTES = 4 * 4 + 4 * 8 + 8 + 8 + 8
"""Least traffic for a tetra in one sweep: neighbour refs; own state read, new one written, and both in copying back."""


class Averaging(NamedTuple):
    """How often to sweep over which net."""

    net: TetraNet
    sweeps: int


class Alfa(TetraScenario):
    """Sweeps of a weighted mean: own state, neighbours' states, nothing else."""

    name = "alfa"
    title = "sweeps of a weighted mean over the neighbours: one state and the neighbours are read"
    options = {"sweeps": 50}
    thesis = {"sweeps": 200}

    def prepare(self, stage: Any, options: Options) -> Averaging:
        """A net with its initial states."""
        return Averaging(stage.net(), options["sweeps"])

    def run(self, averaging: Averaging) -> None:
        """Sweep."""
        average(averaging.net.storage, averaging.sweeps)

    def answer(self, averaging: Averaging, outcome: None) -> Answer:
        """The states, with all of the net."""
        return averaging.net.answer()

    def work(self, averaging: Averaging, outcome: None) -> Work:
        """Visited tetras."""
        visits = len(averaging.net) * averaging.sweeps
        return Work(visits, "tetra visits", visits * SWEEP_BYTES)


@kernel(allocates=False)
def average(net: Net, sweeps: int) -> None:
    """Sweep `sweeps` times: state 0 -> state 1, then copied back."""
    for _ in range(sweeps):
        cursor = first_tetra(net)
        while cursor.tetra != NONE:
            t = cursor.tetra
            own = state(net, t, 0)
            around = 0.0
            for i in range(4):
                other = neighbour(net, t, i)
                around += state(net, other, 0) if other != NONE else own
            set_state(net, t, 1, K * own + (1.0 - K) * (around * 0.25))
            cursor = next_tetra(net, cursor)
        copy_back(net)


@kernel(allocates=False)
def copy_back(net: Net) -> None:
    """State 1 -> state 0, everywhere."""
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        set_state(net, cursor.tetra, 0, state(net, cursor.tetra, 1))
        cursor = next_tetra(net, cursor)
