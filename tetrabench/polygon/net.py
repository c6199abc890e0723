"""PolygonNet: the Python face of any format of polygon meshes."""

import operator
from collections.abc import Callable, Mapping

import numpy as np
from numpy.typing import ArrayLike, NDArray

from tetrabench.errors import InputError, find_named, refuse_name
from tetrabench.memory import refuse_if_too_large
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.connect import connect
from tetrabench.polygon import interface
from tetrabench.polygon.contestant import PolygonContestant
from tetrabench.polygon.convert import mesh_of
from tetrabench.polygon.digest import mesh_answer
from tetrabench.polygon.interface import Storage
from tetrabench.polygon.queries import QUERIES
from tetrabench.protocols import Answer

PEAK = 50.0  # bytes a corner while a format is built, the connections included: measured 36 (half-edges of triangles)

Rows = NDArray[np.int32]


class PolygonNet:
    """A mesh of polygons in the format of a contestant: ask it, or hand `storage` to kernels of your own.

    All lists are complete and counter-clockwise; a negative number is a boundary condition, in place of a cell.

    >>> import tetrabench
    >>> net = tetrabench.PolygonNet(tetrabench.generate_polygons("quad", 9), tetrabench.contestant("polygon", "tables"))
    >>> net.cell_nodes(4).tolist(), net.cell_neighbours(0).tolist()
    ([5, 6, 10, 9], [-1, 1, 3, -4])

    Attributes:
        contestant: its format.
        storage: the format's arrays.
        points: (n, 2) or (n, 3) float64, coordinates of the nodes: no part of a format.
        room: how long an `out` of the interface's queries must be.
    """

    def __init__(self, mesh: PolygonMesh, contestant: PolygonContestant) -> None:
        """Store a mesh; the contestant is an object, as `tetrabench.contestant("polygon", "by-edge")` gives it.

        Raises:
            InputError: no format can hold it: see `mesh.polygon.check.settle`; a name in place of the contestant.
            MemoryRefusedError: there is not enough memory for it.
        """
        refuse_name(contestant, "polygon")
        refuse_if_too_large(f"a net of {mesh.number_of_cells:,} cells", len(mesh.nodes) * PEAK)
        self.contestant = contestant
        self.points = mesh.points
        self.storage: Storage = contestant.build(connect(mesh))
        self.room = list_room(mesh)
        self._source = mesh.report.source

    def __len__(self) -> int:
        return int(interface.number_of_cells(self.storage))

    @property
    def number_of_nodes(self) -> int:
        """How many nodes there are."""
        return int(interface.number_of_nodes(self.storage))

    def cell_nodes(self, c: int) -> Rows:
        """The nodes of a cell, (i,) int32. Raises InputError: there is no such cell."""
        return self._ask(interface.cell_nodes, "cell", len(self), c)

    def cell_neighbours(self, c: int) -> Rows:
        """What lies beyond the sides of a cell, (i,) int32: number j beyond its nodes j and j + 1. Raises InputError."""
        return self._ask(interface.cell_neighbours, "cell", len(self), c)

    def node_cells(self, v: int) -> Rows:
        """The cells around a node, then one or two boundary conditions. Raises InputError: there is no such node."""
        return self._ask(interface.node_cells, "node", self.number_of_nodes, v)

    def node_neighbours(self, v: int) -> Rows:
        """The nodes that edges join with a node, (k,) int32. Raises InputError: there is no such node."""
        return self._ask(interface.node_neighbours, "node", self.number_of_nodes, v)

    def lists(self, query: str, elements: ArrayLike | None = None) -> tuple[NDArray[np.int64], Rows]:
        """The lists of many elements at once: starts (n + 1,) int64 and items (starts[n],) int32.

        Args:
            query: "cell-nodes", "cell-neighbours", "node-cells" or "node-neighbours".
            elements: the cells or nodes to be asked, whole numbers; all of them where it is None.

        Raises:
            InputError: an unknown query, or an element that there is not.
        """
        asked = find_named("query", QUERIES, query)
        known = asked.elements(self.storage)
        if elements is None:
            return asked.lists(self.storage, known, self.room)
        wanted = np.asarray(elements)
        whole = wanted.ndim == 1 and (wanted.dtype.kind in "iu" or not len(wanted))
        if not whole or (len(wanted) and not 0 <= wanted.min() <= wanted.max() < len(known)):
            raise InputError(f"elements: a list of whole numbers from 0 to {len(known) - 1}")
        return asked.lists(self.storage, wanted.astype(np.int32), self.room)

    def to_mesh(self) -> PolygonMesh:
        """The mesh as plain cell lists, from what is stored."""
        return mesh_of(self.storage, self.points, self.room, self._source)

    def answer(self) -> Answer:
        """The digest of all that the four queries say."""
        return mesh_answer(self.storage, self.room)

    def structure_bytes(self) -> Mapping[str, tuple[int, int]]:
        """Bytes (used, reserved) of each array of the format, by name."""
        return {name: (array.nbytes, array.nbytes) for name, array in self.storage._asdict().items()}

    def values(self) -> int:
        """How many numbers the format stores, counted from its arrays."""
        return sum(array.size for array in self.storage)

    def _ask(self, query: Callable[..., int], kind: str, count: int, element: int) -> Rows:
        try:
            wanted = operator.index(element)
        except TypeError:
            wanted = -1
        if not 0 <= wanted < count:
            raise InputError(f"no {kind} {element!r}: there are {kind}s 0 to {count - 1}")
        out = np.empty(self.room, np.int32)
        return out[: query(self.storage, wanted, out)].copy()


def list_room(mesh: PolygonMesh) -> int:
    """How long the longest list of a mesh can be, in any format."""
    return int(max(np.diff(mesh.starts).max(), np.bincount(mesh.nodes).max() + 2))
