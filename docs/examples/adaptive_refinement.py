"""Adaptive refinement: a field with a steep front, on a net that grows finer where the front is.

The field is f(x) = tanh((|x| - R) / w) in the unit cube: a spherical front around a corner, of the radius R and the
thickness w. State 0 of a tetra of volume V is its mean of f. A round of adaptation

1. asks of each tetra with the state a how much it differs from its neighbours n_i: max |a - n_i| sqrt(V), its state 1, which is
   its share of the error in the mean square, about;
2. takes the tenth where that is most, and halves their longest edges, the longest of all first (after M.-C. Rivara, Int. J.
   Numer. Meth. Eng. 20, 1984): every tetra around such an edge becomes two, so that no point hangs in a side;
3. lets the halves inherit the states, which keeps the sum of a V, and then takes new means of f.

At the end stands the error, the root of the mean of (f - a)^2, and that of a uniform net of as many tetras.

    python docs/examples/adaptive_refinement.py [--backend v3y] [--tets 3072] [--rounds 6] [--picture adaptive.png]
"""

import argparse
from itertools import combinations
from math import sqrt

import numpy as np

import tetrabench
from tetrabench.tetra.interface import NONE, first_tetra, neighbour, next_tetra, set_state, state, volume

RADIUS, THICKNESS = 0.8, 0.03
SHARE = 0.1  # of the tetras whose longest edges are halved in a round
EDGES = np.array(list(combinations(range(4), 2)))  # of a tetra
LATTICE = np.array([n for n in np.ndindex(5, 5, 5, 5) if sum(n) == 4])  # 35 places in a tetra, spread evenly
WEIGHTS = (LATTICE + 0.25) / 5  # of its vertices: they add up to 1


def front(places):
    """The field f at places (..., 3)."""
    return np.tanh((np.linalg.norm(places, axis=-1) - RADIUS) / THICKNESS)


def values_in(net):
    """The field at 35 places of each tetra, (n, 35)."""
    return front(WEIGHTS @ net.points[net.vertices])


def fit(net):
    """State 0 becomes the mean of the field."""
    states = net.states
    states[:, 0] = values_in(net).mean(axis=1)
    net.states = states


def error_of(net):
    """The root of the mean square of what is between the field and the states."""
    squares = (values_in(net) - net.states[:, :1]) ** 2
    return sqrt(np.average(squares.mean(axis=1), weights=net.volumes))


@tetrabench.kernel(allocates=False)
def mark(net):
    """State 1 becomes the largest difference from a neighbour, times the root of the volume."""
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        t, most = cursor.tetra, 0.0
        for i in range(4):
            other = neighbour(net, t, i)
            if other != NONE:
                most = max(most, abs(state(net, t, 0) - state(net, other, 0)))
        set_state(net, t, 1, most * volume(net, t) ** 0.5)
        cursor = next_tetra(net, cursor)


def steep_edges(net):
    """The longest edges of the tetras that are steepest, each once, the longest first: pairs of points (m, 2)."""
    mark(net.storage)
    steepness = net.states[:, 1]
    vertices = net.vertices[steepness > np.quantile(steepness, 1 - SHARE)]
    edges = vertices[:, EDGES]  # (k, 6, 2)
    lengths = np.linalg.norm(np.diff(net.points[edges], axis=2)[:, :, 0], axis=2)
    rows, longest = np.arange(len(edges)), lengths.argmax(axis=1)
    chosen = np.sort(edges[rows, longest], axis=1)[np.argsort(-lengths[rows, longest], kind="stable")]
    _, first = np.unique(chosen, axis=0, return_index=True)
    return chosen[np.sort(first)].tolist()


def halve(net, a, b):
    """Halve the edge from point a to point b, and so every tetra around it; the halves inherit the states."""
    middle = net.insert_point(*(net.point(a) + net.point(b)) / 2)
    around = [(t, net.vertices_of(t)) for t in net.tetras_around(a)]
    parents = [(t, vertices, net.states_of(t)) for t, vertices in around if b in vertices]
    for t, _, _ in parents:
        net.delete(t)
    for _, vertices, states in parents:
        for end in (a, b):
            half = net.insert(*(middle if vertex == end else vertex for vertex in vertices))
            net.set_states_of(half, states)


def adapt(net):
    """A round: refine where the front is, and fit anew. Returns by how much the sum of a V changed in between."""
    before = np.dot(net.states[:, 0], net.volumes)
    edges = steep_edges(net)
    with net.edit():  # all of them or none
        for a, b in edges:
            halve(net, a, b)
    lost = np.dot(net.states[:, 0], net.volumes) - before
    fit(net)
    return float(lost)


def main(arguments=None):
    """Adapt a box, and say what it brings."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--backend", default="v3y")
    parser.add_argument("--tets", type=int, default=3_072, help="at the beginning")
    parser.add_argument("--rounds", type=int, default=6)
    parser.add_argument("--picture", help="a PNG, SVG or PDF of the net at the end, cut open")
    options = parser.parse_args(arguments)

    net = tetrabench.open(tetrabench.generate("box", options.tets), backend=options.backend)
    fit(net)
    print(f"{len(net):>7,} tetras: error {error_of(net):.4f}")
    for _ in range(options.rounds):
        lost = adapt(net)
        print(f"{len(net):>7,} tetras: error {error_of(net):.4f}, sum of a V changed by {lost:+.0e}")
    uniform = tetrabench.open(tetrabench.generate("box", len(net)), backend=options.backend)
    fit(uniform)
    ratio = error_of(net) / error_of(uniform)
    print(f"{len(uniform):>7,} tetras, uniform: error {error_of(uniform):.4f}; adapted, {ratio:.2f} times as much")
    print("sound" if not net.check() else net.check())
    if options.picture:
        from tetrabench.report.picture import draw_net

        title = f"A front on {len(net):,} tetras"
        draw_net(net, net.states[:, 0], "z=5%", title=title, label="f").savefig(options.picture, dpi=100)


if __name__ == "__main__":
    main()
