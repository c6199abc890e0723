"""Small named meshes, by what is special about them."""

import numpy as np

from tetrabench.mesh import TetraMesh
from tetrabench.mesh.models import generate


def mesh_of(points: object, tets: object) -> TetraMesh:
    """A mesh from nested lists."""
    points, tets = np.array(points, np.float64).reshape(-1, 3), np.array(tets, np.int32).reshape(-1, 4)
    return TetraMesh(points, tets, np.arange(1, len(points) + 1), np.arange(1, len(tets) + 1))


def single() -> TetraMesh:
    """One tetra."""
    return mesh_of([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]])


def pair() -> TetraMesh:
    """Two tetras with a common side, the second one inside out."""
    return mesh_of([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]], [[0, 1, 2, 3], [1, 2, 3, 4][::-1]])


def flat() -> TetraMesh:
    """A tetra without volume beside a sound one."""
    return mesh_of([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0]], [[0, 1, 2, 3], [0, 1, 2, 4]])


def touching() -> TetraMesh:
    """Two tetras that share an edge only, and one that shares a vertex with them: not a manifold."""
    points = [
        [0, 0, 0],
        [0, 0, 1],
        [1, 0, 0],
        [1, 1, 0],
        [-1, 0, 0],
        [-1, -1, 0],
        [1, -1, -1],
        [0, -1, -1],
        [0, 1, -1],
    ]
    return mesh_of(points, [[0, 1, 2, 3], [0, 1, 4, 5], [0, 6, 7, 8]])


def apart() -> TetraMesh:
    """Two components, and a point that no tetra uses."""
    corner = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    return mesh_of(np.concatenate([corner, [[9, 9, 9]], corner + 5]), [[0, 1, 2, 3], [5, 6, 7, 8]])


def box() -> TetraMesh:
    """A jittered box."""
    return generate("box", 48, seed=1)


def nozzle() -> TetraMesh:
    """A coarse nozzle, numbered at random."""
    return generate("nozzle", 150, numbering="shuffled", seed=2)


MESHES = {mesh.__name__: mesh for mesh in (single, pair, flat, touching, apart, box, nozzle)}
