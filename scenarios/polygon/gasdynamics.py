"""gasdynamics: steps of a Lagrangian gas; its two blocks; the queries of each block alone. Source: section 8, table 7.

The source measured which share of a block's time goes into adjacency: time of gas-node-adjacency over that of gas-node, and of
gas-cell-adjacency over that of gas-cell, of the same contestant on the same model. It is no part of a sum: within the block a
processor of today runs arithmetic while it waits for lists, so that the block without its queries would be faster by less
than the share, and one with faster queries may gain nothing.

The answer is the state to the last bit. Sums of floats depend on their order, so lists have to begin where the interface
says that those of all formats do.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.jit.mix import mix_of_arrays, mixed_with
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.polygon.interface import List, Storage, cell_nodes, node_star, number_of_cells, number_of_nodes
from tetrabench.polygon.net import PolygonNet
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.polygon.base import PolygonScenario
from tetrabench.scenarios.polygon.gas import (
    LAST,
    NEXT,
    TIME,
    Gas,
    advance,
    cell_block,
    make_gas,
    node_block,
    total_energy,
)

NODE_BLOCK, CELL_BLOCK = (128, 64), (64, 168)
"""Least traffic of a block for each node and each cell: what it reads and writes of a gas. The format's own is left out."""
LISTED_BYTES = 4
"""Least traffic for an item of a list."""


class Flow(NamedTuple):
    """What a sample works on: a net, the gas on it, how many steps to make, and room for two lists."""

    net: PolygonNet
    gas: Gas
    steps: int
    nodes: NDArray[np.int32]
    cells: NDArray[np.int32]


class Asked(NamedTuple):
    """What the queries alone work on: a net, and room for two lists."""

    net: PolygonNet
    nodes: NDArray[np.int32]
    cells: NDArray[np.int32]


def make_flow(stage: Any, steps: int) -> Flow:
    """Sod's tube on the net of a stage. Raises UnsupportedError: its mesh is none that gas can flow on."""
    net: PolygonNet = stage.net()
    gas = make_gas(net.storage, stage.mesh, *sod_state(stage.mesh), net.room)
    return Flow(net, gas, steps, np.zeros(net.room, np.int32), np.zeros(net.room, np.int32))


def sod_state(mesh: PolygonMesh) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Density and pressure (m,) float64 of Sod's tube: 1 and 1 where the mean x of a cell's nodes is in the left half of the
    bounding box, 0.125 and 0.1 elsewhere (G. A. Sod, A survey of several finite difference methods for systems of
    nonlinear hyperbolic conservation laws, 1978)."""
    x = mesh.points[:, 0]
    mean = np.add.reduceat(x[mesh.nodes], mesh.starts[:-1]) / np.diff(mesh.starts)
    left = mean < (x.min() + x.max()) / 2
    return np.where(left, 1.0, 0.125), np.where(left, 1.0, 0.1)


def state_answer(gas: Gas) -> Answer:
    """Digest of all bits of what changes in a gas, and its mass, energy and time."""
    digest = mix_of_arrays(gas.place, gas.velocity, gas.area, gas.energy, gas.push, gas.clock)
    figures = {"mass": float(gas.cell_mass.sum()), "energy": total_energy(gas), "time": float(gas.clock[TIME])}
    return Answer(f"{digest:016x}", figures)


class GasDynamics(PolygonScenario):
    """Whole steps, one after the other."""

    name = "gasdynamics"
    title = "Sod's shock tube: steps of a Lagrangian gas, a sum around each node, and one around each cell"
    options = {"steps": 3}
    thesis = {"steps": 1}

    def prepare(self, stage: Any, options: Options) -> Flow:
        """The gas at rest."""
        return make_flow(stage, options["steps"])

    def run(self, flow: Flow) -> int:
        """Step; how many steps were made."""
        return advance(flow.net.storage, flow.gas, flow.steps, np.inf, flow.nodes, flow.cells)

    def answer(self, flow: Flow, steps: int) -> Answer:
        """The state of the gas."""
        return state_answer(flow.gas)

    def work(self, flow: Flow, steps: int) -> Work:
        """Cells, each as often as there are steps."""
        least = least_bytes(flow.net, NODE_BLOCK) + least_bytes(flow.net, CELL_BLOCK)
        return Work(len(flow.net) * steps, "cell steps", steps * least)


class GasNode(PolygonScenario):
    """The node block of the first step."""

    name = "gas-node"
    title = "momentum: forces of the cells around each node, its velocity and place"

    def prepare(self, stage: Any, options: Options) -> Flow:
        """The gas at rest."""
        return make_flow(stage, 1)

    def run(self, flow: Flow) -> None:
        """Momentum."""
        step = flow.gas.clock[NEXT]
        node_block(flow.net.storage, flow.gas, 0.5 * step, step, flow.nodes, flow.cells)

    def answer(self, flow: Flow, outcome: None) -> Answer:
        """The state of the gas."""
        return state_answer(flow.gas)

    def work(self, flow: Flow, outcome: None) -> Work:
        """Nodes."""
        return Work(flow.net.number_of_nodes, "nodes", least_bytes(flow.net, NODE_BLOCK))


class GasCell(PolygonScenario):
    """The cell block of the second step, when the gas is moving."""

    name = "gas-cell"
    title = "energy: work, area, energy, pressure and longest step of each cell, from its nodes"

    def prepare(self, stage: Any, options: Options) -> Flow:
        """The gas after a step and the momentum of the next."""
        flow = make_flow(stage, 1)
        advance(flow.net.storage, flow.gas, 1, np.inf, flow.nodes, flow.cells)
        node_block(flow.net.storage, flow.gas, *next_times(flow.gas), flow.nodes, flow.cells)
        return flow

    def run(self, flow: Flow) -> float:
        """Energy; the step that may follow."""
        return cell_block(flow.net.storage, flow.gas, *next_times(flow.gas), flow.nodes)

    def answer(self, flow: Flow, step: float) -> Answer:
        """The state of the gas."""
        flow.gas.clock[NEXT] = step
        return state_answer(flow.gas)

    def work(self, flow: Flow, step: float) -> Work:
        """Cells."""
        return Work(len(flow.net), "cells", least_bytes(flow.net, CELL_BLOCK))


def least_bytes(net: PolygonNet, block: tuple[int, int]) -> int:
    """Least traffic of a block on a net."""
    return net.number_of_nodes * block[0] + len(net) * block[1]


def next_times(gas: Gas) -> tuple[float, float]:
    """How long forces act and nodes move in the next step."""
    return 0.5 * (gas.clock[LAST] + gas.clock[NEXT]), gas.clock[NEXT]


class Adjacency(PolygonScenario):
    """The queries of a block alone: lists filled and added up, nothing else."""

    def prepare(self, stage: Any, options: Options) -> Asked:
        """The net."""
        net: PolygonNet = stage.net()
        return Asked(net, np.zeros(net.room, np.int32), np.zeros(net.room, np.int32))

    def answer(self, asked: Asked, total: int) -> Answer:
        """The sum of what the lists hold. (What they hold, and in which order, the state after the block tells.)"""
        return Answer(mixed_with(int(total)), {"sum": int(total)})


class GasNodeAdjacency(Adjacency):
    """The query of the node block."""

    name = "gas-node-adjacency"
    title = "the query of gas-node alone: neighbours and cells of each node, in one call"

    def run(self, asked: Asked) -> int:
        """Ask; the sum."""
        return sum_of_stars(asked.net.storage, asked.nodes, asked.cells)

    def work(self, asked: Asked, total: int) -> Work:
        """Nodes; of each at least one neighbour and one cell is read for every edge."""
        starts, _ = asked.net.lists("node-neighbours")
        return Work(asked.net.number_of_nodes, "nodes", 2 * LISTED_BYTES * int(starts[-1]))


class GasCellAdjacency(Adjacency):
    """The query of the cell block."""

    name = "gas-cell-adjacency"
    title = "the query of gas-cell alone: the nodes of each cell"

    def run(self, asked: Asked) -> int:
        """Ask; the sum."""
        return sum_of_cells(asked.net.storage, asked.nodes)

    def work(self, asked: Asked, total: int) -> Work:
        """Cells, and the nodes that had to be read for them."""
        starts, _ = asked.net.lists("cell-nodes")
        return Work(len(asked.net), "cells", LISTED_BYTES * int(starts[-1]))


@kernel(allocates=False)
def sum_of_stars(storage: Storage, nodes: List, cells: List) -> Any:
    """The sum of all neighbours and cells of all nodes, boundary conditions included."""
    total: Any = 0
    for v in range(number_of_nodes(storage)):
        for j in range(node_star(storage, v, nodes, cells)):
            total += np.int64(nodes[j]) + np.int64(cells[j])  # an int32 would run over
    return total


@kernel(allocates=False)
def sum_of_cells(storage: Storage, nodes: List) -> Any:
    """The sum of all nodes of all cells."""
    total: Any = 0
    for c in range(number_of_cells(storage)):
        for j in range(cell_nodes(storage, c, nodes)):
            total += np.int64(nodes[j])
    return total


GAS_SCENARIOS = [GasDynamics(), GasNode(), GasNodeAdjacency(), GasCell(), GasCellAdjacency()]
