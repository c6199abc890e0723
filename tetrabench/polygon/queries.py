"""The four queries, by name, each with kernels that ask it of many elements: to time it, and to have the lists."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.polygon import interface
from tetrabench.polygon.interface import List, Storage

Elements = NDArray[np.int32]


@dataclass(frozen=True)
class Query:
    """A query, and its loops. All take a storage, and `out`, (room,) int32, as the query itself does.

    Attributes:
        name: as people type it.
        title: what it lists.
        of_nodes: whether nodes are asked; else cells.
        sweep: (storage, out) -> the sum of what all lists hold, boundary conditions left out; elements in order.
        sample: (storage, elements, out) -> the same over these elements, (n,) int32.
        measure: (storage, elements, out, starts): where the lists of these elements start, starts (n + 1,) int64.
        collect: (storage, elements, out, starts, items): the lists, items (starts[n],) int32.
    """

    name: str
    title: str
    of_nodes: bool
    sweep: Callable[..., int]
    sample: Callable[..., int]
    measure: Callable[..., None]
    collect: Callable[..., None]

    def elements(self, storage: Storage) -> Elements:
        """All that can be asked: (n,) int32, in order."""
        count = interface.number_of_nodes(storage) if self.of_nodes else interface.number_of_cells(storage)
        return np.arange(count, dtype=np.int32)

    def lists(self, storage: Storage, elements: Elements, room: int) -> tuple[NDArray[np.int64], Elements]:
        """The lists of these elements: starts (n + 1,) int64 and items (starts[n],) int32; room as `list_room` has it."""
        out, starts = np.empty(room, np.int32), np.zeros(len(elements) + 1, np.int64)
        self.measure(storage, elements, out, starts)
        items = np.empty(starts[-1], np.int32)
        self.collect(storage, elements, out, starts, items)
        return starts, items


@kernel(allocates=False, inline=True)
def sum_of(out: List, count: int) -> Any:
    """The sum of the first `count` items, boundary conditions left out.

    Four at a time by hand: the compiler's own vector loop is for long lists, and costs short ones a quarter of the time.
    """
    total, j = np.int64(0), np.int64(0)
    while j + 4 <= count:
        a, b, c, d = out[np.uint64(j)], out[np.uint64(j + 1)], out[np.uint64(j + 2)], out[np.uint64(j + 3)]
        total += np.int64(max(a, 0)) + max(b, 0) + (np.int64(max(c, 0)) + max(d, 0))
        j += 4
    while j < count:
        total += max(out[np.uint64(j)], 0)
        j += 1
    return total


def _make_query(name: str, title: str, query: Callable[..., int], *, of_nodes: bool) -> Query:
    number = interface.number_of_nodes if of_nodes else interface.number_of_cells

    @kernel(allocates=False)
    def sweep(storage: Storage, out: List) -> Any:
        total = 0
        for element in range(number(storage)):
            total += sum_of(out, query(storage, element, out))
        return total

    @kernel(allocates=False)
    def sample(storage: Storage, elements: Elements, out: List) -> Any:
        total = 0
        for element in elements:
            total += sum_of(out, query(storage, element, out))
        return total

    @kernel(allocates=False)
    def measure(storage: Storage, elements: Elements, out: List, starts: NDArray[np.int64]) -> None:
        for i in range(len(elements)):
            starts[i + 1] = starts[i] + query(storage, elements[i], out)

    @kernel(allocates=False)
    def collect(storage: Storage, elements: Elements, out: List, starts: NDArray[np.int64], items: Elements) -> None:
        for i in range(len(elements)):
            for j in range(query(storage, elements[i], out)):
                items[starts[i] + j] = out[j]

    return Query(name, title, of_nodes, sweep, sample, measure, collect)


QUERIES = {
    query.name: query
    for query in (
        _make_query("cell-nodes", "the nodes of a cell", interface.cell_nodes, of_nodes=False),
        _make_query("cell-neighbours", "the neighbours of a cell", interface.cell_neighbours, of_nodes=False),
        _make_query("node-cells", "the cells around a node", interface.node_cells, of_nodes=True),
        _make_query("node-neighbours", "the neighbours of a node", interface.node_neighbours, of_nodes=True),
    )
}
