"""A kernel of your own: each tetra's state moves towards the mean of its neighbours.

One sweep, for all tetras at once, with the state a of a tetra and the states n_i of its neighbours:

    a_new = a / 2 + (mean over the four sides of n_i, or a where there is no neighbour) / 2

What goes from one tetra to another comes back in equal measure, so the sum over the net stays the same, and the states
approach each other. It is the stencil of the scenario alfa, so results/library.py can say what an own kernel costs.

    python docs/examples/own_kernel.py [--backend v3y] [--tets 20000] [--sweeps 50]
"""

import argparse

import numpy as np

import tetrabench
from tetrabench.tetra.interface import NONE, first_tetra, neighbour, next_tetra, set_state, state


@tetrabench.kernel(allocates=False)  # it makes no arrays: then nothing needs to count who holds them
def smooth(net, sweeps):
    """Sweep so many times over `net.storage`: state 0 -> state 1, and back."""
    for _ in range(sweeps):
        cursor = first_tetra(net)
        while cursor.tetra != NONE:
            t = cursor.tetra
            own = state(net, t, 0)
            around = 0.0
            for i in range(4):
                other = neighbour(net, t, i)
                around += state(net, other, 0) if other != NONE else own
            set_state(net, t, 1, 0.5 * own + 0.5 * (around * 0.25))
            cursor = next_tetra(net, cursor)
        copy_back(net)


@tetrabench.kernel(allocates=False)
def copy_back(net):
    """State 1 -> state 0, everywhere."""
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        set_state(net, cursor.tetra, 0, state(net, cursor.tetra, 1))
        cursor = next_tetra(net, cursor)


def main(arguments=None):
    """Smooth random states, and say what became of them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--backend", default="v3y")
    parser.add_argument("--tets", type=int, default=20_000)
    parser.add_argument("--sweeps", type=int, default=50)
    options = parser.parse_args(arguments)

    net = tetrabench.open(tetrabench.generate("box", options.tets), backend=options.backend)
    net.states = np.random.default_rng(1).uniform(0, 1, (len(net), 5))
    for moment in ("before", "after"):
        states = net.states[:, 0]
        print(f"{moment}: sum {states.sum():.6f}, from {states.min():.4f} to {states.max():.4f}")
        smooth(net.storage, options.sweeps)


if __name__ == "__main__":
    main()
