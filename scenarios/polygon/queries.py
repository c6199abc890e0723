"""The four queries, of all elements in order, and of elements at random. Source: section 8, tables 3 and 4.

Each fills a list and adds up what it holds, so that no part of the work can be left out.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit.mix import mixed_with
from tetrabench.polygon.digest import query_answer
from tetrabench.polygon.net import PolygonNet
from tetrabench.polygon.queries import QUERIES, Query
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.polygon.base import PolygonScenario

SEED = 2008
"""Of the elements at random: the same for all contestants, models and machines."""
ITEM_BYTES = 4
"""Least traffic for an item of a list: to read it. (The list that is filled stays in the cache.)"""


@dataclass
class Asked:
    """What a sample works on: the query, the net, the elements to ask in this order, how often to ask them all, and room for
    a list."""

    query: Query
    net: PolygonNet
    elements: NDArray[np.int32]
    sweeps: int

    def __post_init__(self) -> None:
        self.out = np.zeros(self.net.room, np.int32)

    @cached_property
    def lists(self) -> Answer:
        """The lists themselves: to make them takes longer than the workload."""
        return query_answer(self.query, self.net.storage, self.elements, self.net.room)


class InOrder(PolygonScenario):
    """A query of all elements, in the order of their numbers."""

    options = {"sweeps": 1}
    thesis = {"sweeps": 1}

    def __init__(self, query: Query) -> None:
        self.query = query
        self.name = query.name
        self.title = f"{query.title}: of all, in order"

    def prepare(self, stage: Any, options: Options) -> Asked:
        """The net, and all of its cells or nodes."""
        net = stage.net()
        return Asked(self.query, net, self.query.elements(net.storage), options["sweeps"])

    def run(self, asked: Asked) -> int:
        """Ask; the sum of what the lists hold."""
        total = 0
        for _ in range(asked.sweeps):
            total += self.query.sweep(asked.net.storage, asked.out)
        return total

    def answer(self, asked: Asked, total: int) -> Answer:
        """The lists themselves, and the sum that the timed loop has found."""
        return Answer(mixed_with(int(asked.lists.digest, 16), total), {**asked.lists.figures, "sum": int(total)})

    def work(self, asked: Asked, total: int) -> Work:
        """Lists, and the items that had to be read for them; conditions left out, for formats keep one or two of them."""
        items = int(asked.lists.figures["items"])
        return Work(len(asked.elements) * asked.sweeps, "lists", items * asked.sweeps * ITEM_BYTES)


class AtRandom(InOrder):
    """A query of elements drawn at random, each as often as it comes."""

    options = {"queries": 1_000_000}
    thesis = {"queries": 1_000_000}

    def __init__(self, query: Query) -> None:
        super().__init__(query)
        self.name = f"random-{query.name}"
        self.title = f"{query.title}: of some at random"

    def prepare(self, stage: Any, options: Options) -> Asked:
        """The net, and so many of its cells or nodes, each as often as it is drawn."""
        net = stage.net()
        elements = self.query.elements(net.storage)
        drawn = np.random.default_rng(SEED).choice(elements, options["queries"])
        return Asked(self.query, net, drawn, 1)

    def run(self, asked: Asked) -> int:
        """Ask; the sum of what the lists hold."""
        return self.query.sample(asked.net.storage, asked.elements, asked.out)


QUERY_SCENARIOS = [kind(query) for kind in (InOrder, AtRandom) for query in QUERIES.values()]
