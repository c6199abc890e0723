"""A step of the gas with none of the kernels' formulas: gradients by differences, fields by lstsq."""

import numpy as np

from tests.polygon.twin import Twin, sides_of
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.scenarios.polygon.gas import DRAG, GAMMA, LINEAR, QUADRATIC, SAFETY


def area_of(points):
    """Area of a polygon (i, 2), as a sum of trapezoids."""
    return sum((b[0] - a[0]) * (a[1] + b[1]) / -2 for a, b in sides_of(list(points)))


def gradient(points, j):
    """How its area depends on node j: differences are exact, for it depends on each coordinate alone linearly."""
    found = np.zeros(2)
    for k in range(2):
        ahead, behind = points.copy(), points.copy()
        ahead[j, k] += 0.5
        behind[j, k] -= 0.5
        found[k] = area_of(ahead) - area_of(behind)
    return found


class GasTwin:
    """Sod's tube, or any other state, on a rectangle: nodes on its sides slide along them."""

    def __init__(self, mesh: PolygonMesh, density, pressure) -> None:
        self.cells = Twin(mesh).cells
        self.x, self.u, self.density = mesh.points.copy(), np.zeros_like(mesh.points), np.array(density)
        self.mass = np.array([area_of(self.x[cell]) for cell in self.cells]) * density
        self.node_mass = np.zeros(len(self.x))
        for cell, mass in zip(self.cells, self.mass, strict=True):
            for v in cell:
                self.node_mass[v] += mass / len(cell)
        self.free = (self.x > self.x.min(axis=0)) & (self.x < self.x.max(axis=0))
        self.energy = pressure / (GAMMA - 1) / density
        self.q = np.zeros(len(self.cells))
        self.pressure, self.last = np.array(pressure), 0.0
        self._choose_step(np.zeros(len(self.cells)))

    def _choose_step(self, squeeze) -> None:
        """Drag and linear fields of the cells, and the next step in time."""
        self.drag, self.field, steps = [], [], []
        for c, cell in enumerate(self.cells):
            x, n = self.x[cell], len(cell)
            area = area_of(x)
            sound = np.sqrt(GAMMA * self.pressure[c] * area / self.mass[c])
            self.field.append(np.linalg.lstsq(np.column_stack([np.ones(n), x]), self.u[cell], rcond=None)[0])
            self.drag.append(DRAG * self.mass[c] / n * (sound + squeeze[c]) / np.sqrt(area))
            g = n * sum((gradient(x, j) ** 2).sum() for j in range(n)) / area**2
            slope = LINEAR * sound + 2 * QUADRATIC * squeeze[c]
            damping = g * slope * np.sqrt(area) + n * self.drag[c] / self.mass[c]
            steps.append(max(np.roots([g * sound**2, 2 * damping, -4]).real))  # t^2 a + 2 t b = 4
        self.step = SAFETY * min(steps)

    def advance(self) -> None:
        """A step."""
        kick, drift, forces = (self.last + self.step) / 2, self.step, []
        sums = np.zeros_like(self.x)
        for c, cell in enumerate(self.cells):
            off = self.u[cell] - np.column_stack([np.ones(len(cell)), self.x[cell]]) @ self.field[c]
            push = self.pressure[c] + self.q[c]
            forces.append([push * gradient(self.x[cell], j) - self.drag[c] * off[j] for j in range(len(cell))])
            sums[cell] += forces[-1]
        before = self.u.copy()
        self.u += kick * sums * self.free / self.node_mass[:, None]
        old = np.array([area_of(self.x[cell]) for cell in self.cells])
        self.x += drift * self.u
        area = np.array([area_of(self.x[cell]) for cell in self.cells])
        work = [(f * (before + self.u)[cell] / 2).sum() for f, cell in zip(forces, self.cells, strict=True)]
        self.energy = self.energy - kick * np.array(work) / self.mass
        half = (self.pressure + self.q) * (area - old) / 2 / self.mass
        self.density = self.mass / area
        self.pressure = (GAMMA - 1) * self.density * (self.energy - half)
        squeeze = np.maximum(old - area, 0) / drift / area * np.sqrt(area)
        sound = np.sqrt(GAMMA * self.pressure / self.density)
        self.q = self.density * squeeze * (LINEAR * sound + QUADRATIC * squeeze)
        self._choose_step(squeeze)
        self.last = drift
