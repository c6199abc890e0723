"""A mesh of polygons as dictionaries, made by looking everywhere: what every format must answer."""

from tetrabench.mesh.polygon import PolygonMesh


class Twin:
    """The four queries, each as a list that begins anywhere. Boundary conditions: one in each node's cells, between the
    neighbours left and right; `conditions(v)` has its left and its right boundary edge's."""

    def __init__(self, mesh: PolygonMesh) -> None:
        starts, nodes, conditions = mesh.starts.tolist(), mesh.nodes.tolist(), mesh.conditions.tolist()
        self.cells = [nodes[begin:end] for begin, end in zip(starts, starts[1:], strict=False)]
        self.number_of_nodes = len(mesh.points)
        self._owner, self._condition = {}, {}
        for c, cell in enumerate(self.cells):
            for j, side in enumerate(zip(cell, cell[1:] + cell[:1], strict=True)):
                assert side not in self._owner
                self._owner[side], self._condition[side] = c, conditions[starts[c] + j]
        self._nearby = {}
        for c, cell in enumerate(self.cells):
            for v in cell:
                self._nearby.setdefault(v, []).append(c)

    def cell_nodes(self, c: int) -> list[int]:
        return self.cells[c]

    def cell_neighbours(self, c: int) -> list[int]:
        cell = self.cells[c]
        return [self._owner.get((b, a), self._condition[a, b]) for a, b in zip(cell, cell[1:] + cell[:1], strict=True)]

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
            cells.append(self._condition[previous_of[c], v])
        return neighbours, cells

    def conditions(self, v: int) -> list[int]:
        """What a boundary node's left and right boundary edges have; [] elsewhere."""
        neighbours, cells = self.star(v)
        return [cells[-1], self._condition[v, neighbours[0]]] if cells[-1] < 0 else []
