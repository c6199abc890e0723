"""Sod's tube on four models beside the exact one: `python -m tests.scenarios.polygon.sod docs/pictures/polygon-sod.png`."""

import sys
from pathlib import Path

import numpy as np
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure

from tests.scenarios.polygon import riemann
from tetrabench import registry
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.models import MODELS, generate_polygons
from tetrabench.polygon.net import PolygonNet
from tetrabench.scenarios.polygon.gas import Gas, advance, make_gas
from tetrabench.scenarios.polygon.gasdynamics import sod_state

TIME = 0.2
CELLS = 1600


def flow_to(mesh: PolygonMesh, time: float, contestant: str = "by-cell") -> Gas:
    """The gas of Sod's tube on a mesh, at that time."""
    net = PolygonNet(mesh, registry.contestant("polygon", contestant))
    gas = make_gas(net.storage, mesh, *sod_state(mesh), net.room)
    advance(net.storage, gas, 1_000_000, time, np.zeros(net.room, np.int32), np.zeros(net.room, np.int32))
    return gas


def middles(mesh: PolygonMesh, gas: Gas) -> np.ndarray:
    """The mean x of each cell's nodes, (m,) float64."""
    return np.add.reduceat(gas.place[mesh.nodes, 0], mesh.starts[:-1]) / np.diff(mesh.starts)


def error(mesh: PolygonMesh, gas: Gas, time: float) -> float:
    """The L1 error of the density."""
    exact, _, _ = riemann.sod(middles(mesh, gas), time)
    return float((gas.area * abs(gas.cell_mass / gas.area - exact)).sum())


def draw_sod(path: Path) -> None:
    """Four meshes at the end, coloured by density, above the density and the velocity along x."""
    figure = Figure(figsize=(13, 8.5), layout="constrained")
    rows = figure.subplots(3, len(MODELS), height_ratios=[2, 1, 1])
    x = np.linspace(0, 1, 2001)
    exact_density, exact_velocity, _ = riemann.sod(x, TIME)
    for name, (view, density, velocity) in zip(MODELS, rows.T, strict=True):
        mesh = generate_polygons(name, CELLS)
        gas = flow_to(mesh, TIME)
        values = gas.cell_mass / gas.area
        cells = PolyCollection(
            np.split(gas.place[mesh.nodes], mesh.starts[1:-1]),
            array=values,
            cmap="viridis",
            clim=(0, 1),
            edgecolor="white",
            linewidth=0.15,
        )
        view.add_collection(cells)
        view.set(title=f"{name}, {mesh.number_of_cells:,} cells", aspect="equal", xlim=(0, 1), ylim=(0, 1), xlabel="x")
        dots = {"linestyle": "none", "marker": ".", "markersize": 2, "color": "#0072B2"}
        density.plot(middles(mesh, gas), values, label="each cell", **dots)
        density.plot(x, exact_density, color="black", linewidth=0.9, label="exact")
        density.set(title=f"L1 error of the density: {error(mesh, gas, TIME):.4f}", ylim=(0, 1.1), xlabel="x")
        velocity.plot(gas.place[:, 0], gas.velocity[:, 0], label="each node", **dots)
        velocity.plot(x, exact_velocity, color="black", linewidth=0.9, label="exact")
        velocity.set(ylim=(-0.15, 1.3), xlabel="x")
    rows[1, 0].set_ylabel("density")
    rows[2, 0].set_ylabel("velocity")
    rows[1, 0].legend(frameon=False, markerscale=4, loc="upper right")
    rows[2, 0].legend(frameon=False, markerscale=4, loc="upper left")
    figure.colorbar(cells, ax=rows[0].tolist(), label="density", shrink=0.8)
    figure.suptitle(f"Sod's shock tube at t = {TIME}: each mesh where the gas has carried it")
    figure.savefig(path, dpi=110)


if __name__ == "__main__":
    draw_sod(Path(sys.argv[1]))
