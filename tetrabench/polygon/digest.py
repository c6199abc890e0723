"""The answer to a query about many elements: one number that does not depend on where a format's lists begin.

The digest is the sum, modulo 2^64, over the elements of a mix of: the element; and the sum over its list, taken as a circle,
of a mix of each item with the next. Boundary conditions count among the neighbours of a cell, where formats cannot differ;
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
    total = np.zeros(1, np.uint64)
    with np.errstate(over="ignore"):  # 64 bits that wrap around are meant to, also with the JIT off
        add_lists(elements, starts, items, query.of_nodes, total)
    return Answer(mixed_with(int(total[0]), *figures.values()), figures)


def mesh_answer(storage: Storage, room: int) -> Answer:
    """Digest of all that the four queries say of a mesh; how many cells and nodes it has, and sides of cells."""
    answers = {name: query_answer(query, storage, query.elements(storage), room) for name, query in QUERIES.items()}
    figures = {
        "cells": answers["cell-nodes"].figures["lists"],
        "nodes": answers["node-cells"].figures["lists"],
        "sides": answers["cell-nodes"].figures["items"],
        "boundary_sides": answers["cell-neighbours"].figures["boundary_sides"],
    }
    digests = [int(answer.digest, 16) for answer in answers.values()]
    return Answer(mixed_with(0, *digests), figures)


@kernel(allocates=False)
def add_lists(elements: Elements, starts: Starts, items: Elements, drops: bool, total: NDArray[np.uint64]) -> None:
    """Add the mixes of all lists to total[0]; `drops`: boundary conditions, which are negative, are left out."""
    for i in range(len(elements)):
        begin, end = starts[i], starts[i + 1]
        last = end - 1
        while drops and last > begin and items[last] < 0:
            last -= 1
        circle = np.uint64(0)
        for place in range(begin, end):
            if drops and items[place] < 0:
                continue
            circle += mix(mix(np.uint64(SEED) ^ np.uint64(items[last])) ^ np.uint64(items[place]))
            last = place
        total[0] += mix(mix(np.uint64(SEED) ^ np.uint64(elements[i])) ^ circle)
