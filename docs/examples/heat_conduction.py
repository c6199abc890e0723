"""Heat conduction in a box, by finite elements on the net, beside the exact solution.

The temperature u obeys du/dt = k (d2u/dx2 + d2u/dy2 + d2u/dz2), with the diffusivity k = 1, in the unit cube. The
surface is held at the temperatures of the exact solution, a steady field and a mode that decays (a = pi):

    u = sin(a x) sin(a y) sinh(sqrt(2) a z) / sinh(sqrt(2) a)  +  sin(a x) sin(a y) sin(a z) exp(-3 a^2 k t)

Linear elements: u is known at the points, and linear in each tetra of volume V. With the areas A_i and the outward unit
normals n_i of its sides, side i opposite vertex i, the gradient of u, and the heat that reaches the quarter of the tetra
around vertex i (the weak form, its integral done), are

    g = -sum of u_i A_i n_i / (3 V)                  q_i = k g . n_i A_i / 3

so that a step of time, with the volume W of the quarters around a point, is u += dt / W * sum of its q_i (Euler, explicit,
lumped masses). No matrix is needed: the net holds all of it. The error at the points falls with the square of their
distance, on jittered meshes too. (Two-point fluxes between centroids, as finite volumes take them, would not converge
here: the line between two centroids is not normal to the side between them.)

    python docs/examples/heat_conduction.py [--backend v3y] [--tets 24576] [--picture heat.png]
"""

import argparse
from math import sqrt

import numpy as np

import tetrabench
from tetrabench.tetra.interface import NONE, first_tetra, next_tetra, set_state, side_area, side_normal, vertex, volume

DIFFUSIVITY = 1.0  # m^2/s
END = 0.02  # s: by then 45 % of the mode has decayed


def exact(points, time):
    """The temperature at points (n, 3) of the unit cube, (n,)."""
    x, y, z = np.pi * points.T
    steady = np.sinh(sqrt(2) * z) / np.sinh(sqrt(2) * np.pi)
    return np.sin(x) * np.sin(y) * (steady + np.sin(z) * np.exp(-3 * np.pi**2 * DIFFUSIVITY * time))


@tetrabench.kernel(allocates=False)
def conduct(net, temperature, heat):
    """Add to `heat` what reaches each point, both (points,) float64; the mean and the gradient become states 0 to 3."""
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        t = cursor.tetra
        mean, gx, gy, gz = 0.0, 0.0, 0.0, 0.0
        for i in range(4):
            u = temperature[vertex(net, t, i)]
            weight = -u * side_area(net, t, i) / (3.0 * volume(net, t))
            mean += 0.25 * u
            gx += weight * side_normal(net, t, i, 0)
            gy += weight * side_normal(net, t, i, 1)
            gz += weight * side_normal(net, t, i, 2)
        for i in range(4):
            slope = gx * side_normal(net, t, i, 0) + gy * side_normal(net, t, i, 1) + gz * side_normal(net, t, i, 2)
            heat[vertex(net, t, i)] += DIFFUSIVITY * slope * side_area(net, t, i) / 3.0
        set_state(net, t, 0, mean)
        set_state(net, t, 1, gx)
        set_state(net, t, 2, gy)
        set_state(net, t, 3, gz)
        cursor = next_tetra(net, cursor)


def surface_points(net):
    """Which points lie on the surface: those of the sides without a neighbour, (points,) bool."""
    on_surface = np.zeros(net.number_of_points, bool)
    vertices, is_open = net.vertices, net.neighbours == NONE
    for i in range(4):
        on_surface[np.delete(vertices, i, axis=1)[is_open[:, i]]] = True
    return on_surface


def longest_step(net):
    """The longest stable step of time: no eigenvalue of all is above the largest trace of an element's matrix."""
    rates = DIFFUSIVITY * (net.side_areas**2).sum(axis=1) / (9 * net.volumes) / (net.volumes / 4)
    return 2 / rates.max()


def simulate(net, end=END):
    """Heat the net until `end`, and return the temperatures at its points and the exact ones, (points,) each."""
    places = net.points
    fixed = surface_points(net)
    share = np.bincount(net.vertices.ravel(), np.repeat(net.volumes / 4, 4))  # W
    steps = int(np.ceil(end / (0.5 * longest_step(net))))
    temperature, heat = exact(places, 0.0), np.zeros(len(places))
    for step in range(steps):
        heat[:] = 0
        conduct(net.storage, temperature, heat)
        temperature += end / steps * heat / share
        temperature[fixed] = exact(places[fixed], end * (step + 1) / steps)
    conduct(net.storage, temperature, heat)  # for the states
    return temperature, exact(places, end)


def error_of(net, end=END):
    """The root of the mean square of the error at the points, weighted by the volume around them."""
    temperature, truth = simulate(net, end)
    share = np.bincount(net.vertices.ravel(), np.repeat(net.volumes / 4, 4))
    return sqrt(np.average((temperature - truth) ** 2, weights=share))


def main(arguments=None):
    """Solve on ever finer boxes, and say how the error falls."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--backend", default="v3y")
    parser.add_argument(
        "--tets", type=int, default=24_576, help="of the finest box, about; each coarser one has an eighth"
    )
    parser.add_argument("--picture", help="a PNG, SVG or PDF of the finest one, cut open")
    options = parser.parse_args(arguments)

    previous = None
    cubes = max(8, round((options.tets / 6) ** (1 / 3)))  # along an edge, each of six tetras
    for along in (cubes // 4, cubes // 2, cubes):
        net = tetrabench.open(tetrabench.generate("box", 6 * along**3), backend=options.backend)
        error = error_of(net)
        spacing = net.volumes.mean() ** (1 / 3)
        order = "" if previous is None else f", order {np.log(previous[0] / error) / np.log(previous[1] / spacing):.2f}"
        print(f"{len(net):>7,} tetras: error {error:.2e}{order}")
        previous = error, spacing
    if options.picture:
        from tetrabench.report.picture import draw_net

        title = f"Temperature after {END} s, {len(net):,} tetras"
        draw_net(net, net.states[:, 0], "y=50%", title=title, label="temperature").savefig(options.picture, dpi=100)


if __name__ == "__main__":
    main()
