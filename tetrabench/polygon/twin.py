"""A mesh of polygons as dictionaries, made by looking everywhere: what every format must answer."""

from collections.abc import Callable, Iterable
from itertools import pairwise
from typing import TypeVar

from tetrabench.mesh.polygon import PolygonMesh

_Item = TypeVar("_Item", int, tuple[int, int])


class Twin:
    """The four queries as lists, which begin where the interface says that those of all formats do.

    Boundary conditions: the left boundary edge's alone is in a node's cells, last; `conditions(v)` has the right one's too.

    Attributes:
        cells: the nodes of each cell.
        owner: the cell that a side belongs to, by its two nodes in the cell's order.
        condition: the condition of each side, 0 where a cell lies beyond it.
    """

    def __init__(self, mesh: PolygonMesh) -> None:
        starts, nodes, conditions = mesh.starts.tolist(), mesh.nodes.tolist(), mesh.conditions.tolist()
        self.cells = [nodes[begin:end] for begin, end in pairwise(starts)]
        self.number_of_nodes = len(mesh.points)
        self.owner: dict[tuple[int, int], int] = {}
        self.condition: dict[tuple[int, int], int] = {}
        for c, cell in enumerate(self.cells):
            for j, side in enumerate(sides_of(cell)):
                assert side not in self.owner
                self.owner[side], self.condition[side] = c, conditions[starts[c] + j]
        self._nearby: dict[int, list[int]] = {}
        for c, cell in enumerate(self.cells):
            for v in cell:
                self._nearby.setdefault(v, []).append(c)

    def cell_nodes(self, c: int) -> list[int]:
        """The nodes of a cell."""
        return self.cells[c]

    def cell_neighbours(self, c: int) -> list[int]:
        """What lies beyond its sides."""
        return [self.beyond(side) for side in sides_of(self.cells[c])]

    def node_neighbours(self, v: int) -> list[int]:
        """As `star` has them."""
        return self.star(v)[0]

    def node_cells(self, v: int) -> list[int]:
        """As `star` has them."""
        return self.star(v)[1]

    def beyond(self, side: tuple[int, int]) -> int:
        """The cell beyond a side, or the side's condition."""
        return self.owner.get(side[::-1], self.condition[side])

    def star(self, v: int) -> tuple[list[int], list[int]]:
        """Neighbours and cells of a node, each cell between its neighbour and the next; a condition last at the boundary."""
        next_of, previous_of = {}, {}
        for c in self._nearby[v]:
            cell = self.cells[c]
            place = cell.index(v)
            next_of[c], previous_of[c] = cell[(place + 1) % len(cell)], cell[place - 1]
        begins = [c for c in next_of if next_of[c] not in previous_of.values()]
        c = begins[0] if begins else min(next_of)
        neighbours, cells = [next_of[c]], [c]
        for _ in range(len(next_of) - 1):
            neighbours.append(previous_of[c])
            c = next(other for other in next_of if next_of[other] == previous_of[c])
            cells.append(c)
        if begins:
            neighbours.append(previous_of[c])
            cells.append(self.condition[previous_of[c], v])
        return neighbours, cells

    def conditions(self, v: int) -> list[int]:
        """What a boundary node's left and right boundary edges have, seen from outside; [] elsewhere."""
        neighbours, cells = self.star(v)
        return [cells[-1], self.condition[v, neighbours[0]]] if cells[-1] < 0 else []

    def lists(self, query: str) -> list[list[int]]:
        """All lists of a query, by its name."""
        ask: Callable[[int], list[int]] = getattr(self, query.replace("-", "_"))
        return [ask(x) for x in range(self.number_of_nodes if query.startswith("node") else len(self.cells))]

    @property
    def edges(self) -> set[frozenset[int]]:
        """All edges, by their two nodes."""
        return {frozenset(side) for side in self.owner}

    @property
    def corners(self) -> list[int]:
        """The corners of the domain: nodes whose two boundary edges have different conditions."""
        return [v for v in range(self.number_of_nodes) if len(set(self.conditions(v))) == 2]


def sides_of(cell: list[int]) -> list[tuple[int, int]]:
    """The sides of a cell, each as its two nodes, in its order."""
    return list(zip(cell, cell[1:] + cell[:1], strict=True))


def circle(items: Iterable[_Item]) -> tuple[_Item, ...]:
    """A list as a circle: turned so that it is the least of all its turns."""
    listed = list(items)
    return min((tuple(listed[j:] + listed[:j]) for j in range(len(listed))), default=())
