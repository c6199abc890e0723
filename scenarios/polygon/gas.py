"""A Lagrangian gas on a plane mesh: what its nodes and cells carry, and the step in time, as two blocks.

Density, energy and pressure live in the cells, velocities in the nodes, which move with the gas and take the mesh along:
no mass ever leaves its cell. Staggered in space and time (J. von Neumann, R. D. Richtmyer, A method for the numerical
calculation of hydrodynamic shocks, 1950): places at whole steps, velocities and energies in between.

    node block    u_v += kick / m_v * sum over the cells c around v of f_cv,    x_v += drift u_v
    cell block    e_c -= kick / m_c * sum over the nodes v of c of f_cv . (u_v before + u_v after) / 2
                  p_c = (GAMMA - 1) rho_c (e_c on to the time of the places)
    both          f_cv = (p_c + q_c) dA_c/dx_v - d_c (u_v - the linear field nearest to the velocities of c, at x_v)

Both blocks have the same forces, so kinetic and internal energy together stay as they are to rounding (E. J. Caramana,
D. E. Burton, M. J. Shashkov, P. P. Whalen, The construction of compatible hydrodynamics algorithms utilizing conservation
of total energy, 1998). dA_c/dx_v is half the line from the next to the previous node of v in c, turned by a right angle. The
viscosity q, quadratic and linear in the compression, is one number a cell (R. Landshoff, 1955), its length sqrt(A).

A pressure alone leaves the nodes of a cell with more than three much freedom to move at no cost, and they would tangle. The
drag d acts on what is no linear field, and on nothing else (D. P. Flanagan, T. Belytschko, A uniform strain hexahedron and
quadrilateral with orthogonal hourglass control, 1981); as the field is that of least squares, a cell's drags have neither a
sum nor a moment.

Walls lie around the mesh, where its boundary is. A node there slides along its two boundary sides, or stands still where
they turn a corner: a force across the wall is left out, and does no work.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import UnsupportedError
from tetrabench.jit import kernel
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.numbering import next_nodes
from tetrabench.polygon.interface import List, Storage, cell_nodes, node_star, number_of_cells, number_of_nodes

GAMMA = 1.4
LINEAR, QUADRATIC = 0.5, 1.2
"""Coefficients of the viscosity; (GAMMA + 1) / 2 is the quadratic one of a strong shock (V. F. Kuropatenko, 1967)."""
DRAG = 4.0
"""Of the drag: the deceleration of what is off the linear field, in velocities per time that sound takes to cross a cell."""
SAFETY = 0.5
"""The step in time over the longest one that is stable where nothing but small waves runs through the mesh."""
CORNER = np.cos(np.pi / 6)
"""Boundary sides that turn by more than this angle, 30 degrees, make a corner."""
TIME, LAST, NEXT = 0, 1, 2
"""Places in Gas.clock."""

Values = NDArray[np.float64]


class Gas(NamedTuple):
    """The state of a gas; `n` nodes, `m` cells. Any consistent units.

    Attributes:
        place, last_place: (n, 2) float64, where the nodes are, and were before the last drift.
        velocity, last_velocity: (n, 2) float64, half a step earlier than `place`, and before the last kick.
        node_mass: (n,) float64, equal shares of the masses of the cells around; never changes.
        slide: (n, 3) float64, xx, xy and yy of the projection on what a node is free to do: all, along a wall, nothing.
        cell_mass: (m,) float64; never changes.
        area: (m,) float64, of the cells at `place`.
        energy: (m,) float64, internal, of a unit of mass, at the time of `velocity`.
        push: (m,) float64, pressure and viscosity together, at the time of `place`.
        drag: (m,) float64, force for a velocity of one off the linear field.
        field: (m, 2, 3) float64: the linear field's x and y at (x, y) are each the first, plus x times the second, plus y
            times the third.
        clock: (3,) float64, the time of `place`, the step that led there, the step that may follow.
    """

    place: Values
    last_place: Values
    velocity: Values
    last_velocity: Values
    node_mass: Values
    slide: Values
    cell_mass: Values
    area: Values
    energy: Values
    push: Values
    drag: Values
    field: Values
    clock: Values


def make_gas(storage: Storage, mesh: PolygonMesh, density: Values, pressure: Values, room: int) -> Gas:
    """A gas at rest, from the density (m,) float64 and the pressure (m,) float64 of its cells. `room`: of a list.

    Raises:
        UnsupportedError: the mesh is none in the plane, or a cell of it has no area.
    """
    if mesh.points.shape[1] != 2:
        raise UnsupportedError("gas flows in the plane; the points of this mesh lie in space")
    counts, corners = np.diff(mesh.starts), next_nodes(mesh.starts, mesh.nodes)
    origin = np.repeat(mesh.points[mesh.nodes[mesh.starts[:-1]]], counts, axis=0)
    (ax, ay), (bx, by) = (mesh.points[mesh.nodes] - origin).T, (mesh.points[corners] - origin).T
    area = np.add.reduceat(ax * by - bx * ay, mesh.starts[:-1]) / 2
    if area.min() <= 0.0:
        raise UnsupportedError(f"gas needs room; cell {area.argmin()} of this mesh has an area of {area.min():g}")
    mass = density * area
    gas = Gas(
        place=np.array(mesh.points, np.float64, order="C"),
        last_place=np.array(mesh.points, np.float64, order="C"),
        velocity=np.zeros_like(mesh.points),
        last_velocity=np.zeros_like(mesh.points),
        node_mass=np.asarray(np.bincount(mesh.nodes, np.repeat(mass / counts, counts)), np.float64),
        slide=freedoms(mesh, corners),
        cell_mass=mass,
        area=area,
        energy=pressure / ((GAMMA - 1.0) * density),
        push=np.zeros(len(mass)),
        drag=np.zeros(len(mass)),
        field=np.zeros((len(mass), 2, 3)),
        clock=np.zeros(3),
    )
    gas.clock[NEXT] = cell_block(storage, gas, 0.0, 0.0, np.zeros(room, np.int32))
    return gas


def freedoms(mesh: PolygonMesh, following: NDArray[np.int32]) -> Values:
    """How each node may move, (n, 3) float64: see Gas.slide; `following`: the next node of each corner, (s,) int32.

    Along a wall is the direction from the boundary node before to the one behind.
    """
    side = mesh.conditions < 0
    here, there = mesh.nodes[side], following[side]
    arriving, leaving = np.zeros_like(mesh.points), np.zeros_like(mesh.points)
    arriving[there] = leaving[here] = mesh.points[there] - mesh.points[here]
    lengths = np.hypot(*arriving.T) * np.hypot(*leaving.T)
    straight = (arriving * leaving).sum(axis=1)[here] >= CORNER * lengths[here]
    wall = here[straight]
    x, y = ((arriving + leaving)[wall] / np.hypot(*(arriving + leaving)[wall].T)[:, None]).T
    slide = np.tile([1.0, 0.0, 1.0], (len(mesh.points), 1))
    slide[here] = 0.0
    slide[wall] = np.column_stack([x * x, x * y, y * y])
    return slide


def total_energy(gas: Gas) -> float:
    """Kinetic and internal energy."""
    kinetic = (gas.node_mass * (gas.velocity**2).sum(axis=1)).sum() / 2
    return float(kinetic + (gas.cell_mass * gas.energy).sum())


@kernel(allocates=False)
def advance(storage: Storage, gas: Gas, steps: int, until: float, nodes: List, cells: List) -> int:
    """Make `steps` steps, fewer where the time `until` is reached; the last one is cut to end there. Returns how many."""
    for done in range(steps):
        left = until - gas.clock[TIME]
        if left <= 0.0:
            return done
        drift = min(gas.clock[NEXT], left)
        kick = 0.5 * (gas.clock[LAST] + drift)
        node_block(storage, gas, kick, drift, nodes, cells)
        gas.clock[NEXT] = cell_block(storage, gas, kick, drift, nodes)
        gas.clock[TIME] = gas.clock[TIME] + drift if drift < left else until
        gas.clock[LAST] = drift
    return steps


@kernel(allocates=False, inline=True)
def corner_force(gas: Gas, place: Values, velocity: Values, c: int, a: int, v: int, b: int) -> Any:
    """The force (x, y) of cell c on its node v, which follows node a and comes before node b."""
    x, y = place[v, 0], place[v, 1]
    off_x = velocity[v, 0] - (gas.field[c, 0, 0] + gas.field[c, 0, 1] * x + gas.field[c, 0, 2] * y)
    off_y = velocity[v, 1] - (gas.field[c, 1, 0] + gas.field[c, 1, 1] * x + gas.field[c, 1, 2] * y)
    force_x = 0.5 * gas.push[c] * (place[b, 1] - place[a, 1]) - gas.drag[c] * off_x
    force_y = 0.5 * gas.push[c] * (place[a, 0] - place[b, 0]) - gas.drag[c] * off_y
    return force_x, force_y


@kernel(allocates=False)
def node_block(storage: Storage, gas: Gas, kick: float, drift: float, nodes: List, cells: List) -> None:
    """Momentum: new velocities and places of all nodes.

    Args:
        storage: of any format.
        gas: places and velocities are written.
        kick: how long the forces act.
        drift: how long the nodes move.
        nodes, cells: (room,) int32.
    """
    for v in range(number_of_nodes(storage)):
        count = node_star(storage, v, nodes, cells)
        force_x = force_y = 0.0
        for j in range(count):
            c = np.int64(cells[j])
            if c >= 0:
                a, b = np.int64(nodes[j + 1 if j + 1 < count else 0]), np.int64(nodes[j])
                x, y = corner_force(gas, gas.place, gas.velocity, c, a, v, b)
                force_x, force_y = force_x + x, force_y + y
        gain = kick / gas.node_mass[v]
        gas.last_velocity[v, 0], gas.last_velocity[v, 1] = gas.velocity[v, 0], gas.velocity[v, 1]
        gas.velocity[v, 0] += gain * (gas.slide[v, 0] * force_x + gas.slide[v, 1] * force_y)
        gas.velocity[v, 1] += gain * (gas.slide[v, 1] * force_x + gas.slide[v, 2] * force_y)
    for v in range(number_of_nodes(storage)):  # none moves while others still ask where it is
        for k in range(2):
            gas.last_place[v, k] = gas.place[v, k]
            gas.place[v, k] += drift * gas.velocity[v, k]


@kernel(allocates=False)
def cell_block(storage: Storage, gas: Gas, kick: float, drift: float, nodes: List) -> float:
    """Energy: work, new areas, energies and pressures of all cells; returns the step in time that may follow.

    That is SAFETY times the longest stable one, from the largest eigenvalue that any cell alone could have (B. M. Irons,
    S. Ahmad, Techniques of finite elements, 1980): with g = i / A^2 * sum of |dA/dx_v|^2 over its i nodes, the squared
    frequency of its sound is at most a = g s^2, its damping at most b = g nu + i d / m, and t^2 a + 2 t b <= 4.

    Args:
        storage: of any format.
        gas: what cells have is written.
        kick: how long the forces have acted.
        drift: how long the nodes have moved; 0 at the very beginning.
        nodes: (room,) int32.
    """
    longest = np.inf
    for c in range(number_of_cells(storage)):
        count = cell_nodes(storage, c, nodes)
        origin = np.int64(nodes[0])  # of this cell: far from the origin of all, digits would cancel
        x0, y0 = gas.place[origin, 0], gas.place[origin, 1]
        a, v = np.int64(nodes[count - 1]), origin
        work = area = squares = 0.0
        for j in range(count):
            b = np.int64(nodes[j + 1 if j + 1 < count else 0])
            force_x, force_y = corner_force(gas, gas.last_place, gas.last_velocity, c, a, v, b)
            work += 0.5 * force_x * (gas.last_velocity[v, 0] + gas.velocity[v, 0])
            work += 0.5 * force_y * (gas.last_velocity[v, 1] + gas.velocity[v, 1])
            area += 0.5 * (gas.place[v, 0] - x0) * (gas.place[b, 1] - y0)
            area -= 0.5 * (gas.place[b, 0] - x0) * (gas.place[v, 1] - y0)
            squares += 0.25 * ((gas.place[b, 0] - gas.place[a, 0]) ** 2 + (gas.place[b, 1] - gas.place[a, 1]) ** 2)
            a, v = v, b
        fit_field(gas, c, nodes, count)

        mass, growth, length = gas.cell_mass[c], area - gas.area[c], np.sqrt(area)
        gas.area[c] = area
        gas.energy[c] -= kick * work / mass
        density = mass / area
        pressure = (GAMMA - 1.0) * density * (gas.energy[c] - 0.5 * gas.push[c] * growth / mass)
        sound = np.sqrt(GAMMA * pressure / density)
        squeeze = max(-growth, 0.0) / (drift * area) * length if drift > 0.0 else 0.0
        gas.push[c] = pressure + density * squeeze * (LINEAR * sound + QUADRATIC * squeeze)
        gas.drag[c] = DRAG * mass / count * (sound + squeeze) / length
        g = count * squares / (area * area)
        viscosity = length * (
            LINEAR * sound + 2.0 * QUADRATIC * squeeze
        )  # counted even where the gas expands: it may turn
        damping = g * viscosity + count * gas.drag[c] / mass
        longest = min(longest, 4.0 / (damping + np.sqrt(damping * damping + 4.0 * g * sound * sound)))
    return SAFETY * longest


@kernel(allocates=False, inline=True)
def fit_field(gas: Gas, c: int, nodes: List, count: int) -> None:
    """Fit the linear field of cell c to the velocities of its `count` nodes: that of least squares."""
    x = y = 0.0
    for j in range(count):
        v = np.int64(nodes[j])
        x, y = x + gas.place[v, 0], y + gas.place[v, 1]
    x, y = x / count, y / count
    xx = xy = yy = 0.0
    for j in range(count):
        v = np.int64(nodes[j])
        dx, dy = gas.place[v, 0] - x, gas.place[v, 1] - y
        xx, xy, yy = xx + dx * dx, xy + dx * dy, yy + dy * dy
    for k in range(2):
        mean = along_x = along_y = 0.0
        for j in range(count):
            v = np.int64(nodes[j])
            mean += gas.velocity[v, k]
            along_x += (gas.place[v, 0] - x) * gas.velocity[v, k]
            along_y += (gas.place[v, 1] - y) * gas.velocity[v, k]
        gas.field[c, k, 1] = (yy * along_x - xy * along_y) / (xx * yy - xy * xy)
        gas.field[c, k, 2] = (xx * along_y - xy * along_x) / (xx * yy - xy * xy)
        gas.field[c, k, 0] = mean / count - gas.field[c, k, 1] * x - gas.field[c, k, 2] * y
