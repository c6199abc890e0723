"""The answer to a query about many elements: one number that does not depend on where a format's lists begin.

The digest is the sum, modulo 2^64, over the elements of a mix of: the element; and the sum, over all items that its list could
begin with, of a mix of the hash of the list from there on (a rolling hash: R. M. Karp, M. O. Rabin, Efficient randomized
pattern-matching algorithms, 1987). Pairs of an item and the next would not do: where items come more than once, as conditions
do, other circles have the same ones. Boundary conditions count among the neighbours of a cell, where formats cannot differ;
around a node they are left out, for formats keep one or both.
"""

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.jit.mix import SEED, mix, mixed_with
from tetrabench.polygon.interface import Storage
from tetrabench.polygon.queries import QUERIES, Elements, Query
from tetrabench.protocols import Answer

Starts = NDArray[np.int64]


def query_answer(query: Query, storage: Storage, elements: Elements, room: int) -> Answer:
    """Digest of the lists of these elements, and figures: how many lists and items, and how many conditions beside them."""
    starts, items = query.lists(storage, elements, room)
    conditions = int(np.count_nonzero(items < 0))
    figures = {"lists": len(elements), "items": len(items) - conditions}
    if not query.of_nodes:
        figures["boundary_sides"] = conditions
    return Answer(mixed_with(sum_of_lists(elements, starts, items, drops=query.of_nodes), *figures.values()), figures)


def mesh_answer(storage: Storage, room: int) -> Answer:
    """Digest of all that the four queries say of a mesh, and of what lies beyond which side of a cell.

    Figures: how many cells and nodes it has, and sides of cells.
    """
    answers = {name: query_answer(query, storage, query.elements(storage), room) for name, query in QUERIES.items()}
    figures = {
        "cells": answers["cell-nodes"].figures["lists"],
        "nodes": answers["node-cells"].figures["lists"],
        "sides": answers["cell-nodes"].figures["items"],
        "boundary_sides": answers["cell-neighbours"].figures["boundary_sides"],
    }
    digests = [int(answer.digest, 16) for answer in answers.values()]
    return Answer(mixed_with(0, *digests, sides_digest(storage, room)), figures)


def sides_digest(storage: Storage, room: int) -> int:
    """Digest of the nodes and the neighbours of each cell in turn, as one list: number j lies beyond nodes j and j + 1."""
    cells = QUERIES["cell-nodes"].elements(storage)
    starts, nodes = QUERIES["cell-nodes"].lists(storage, cells, room)
    other_starts, beyond = QUERIES["cell-neighbours"].lists(storage, cells, room)
    if not np.array_equal(starts, other_starts):
        return 0  # the lists themselves are wrong
    return sum_of_lists(cells, 2 * starts, np.column_stack([nodes, beyond]).ravel(), drops=False)


def sum_of_lists(elements: Elements, starts: Starts, items: Elements, *, drops: bool) -> int:
    """The sum of the mixes of lists; `drops`: boundary conditions, which are negative, are left out."""
    total = np.zeros(1, np.uint64)
    with np.errstate(over="ignore"):  # 64 bits that wrap around are meant to, also with the JIT off
        add_lists(elements, starts, items, drops, total)
    return int(total[0])


@kernel(allocates=False)
def add_lists(elements: Elements, starts: Starts, items: Elements, drops: bool, total: NDArray[np.uint64]) -> None:
    """Add the mixes of all lists to total[0]."""
    base = np.uint64(SEED)  # odd, so that no power of it is 0
    for i in range(len(elements)):
        hashed, power = np.uint64(0), np.uint64(1)
        for place in range(starts[i], starts[i + 1]):
            if not (drops and items[place] < 0):
                hashed = hashed * base + mix(base ^ np.uint64(items[place]))
                power *= base
        circle = np.uint64(0)
        for place in range(starts[i], starts[i + 1]):
            if not (drops and items[place] < 0):
                circle += mix(hashed)
                hashed = hashed * base - (power - np.uint64(1)) * mix(base ^ np.uint64(items[place]))  # turned by one
        total[0] += mix(mix(base ^ np.uint64(elements[i])) ^ circle)
