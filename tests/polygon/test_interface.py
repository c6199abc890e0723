"""The interface is complete in every format, and what a format leaves out is named when it is first asked."""

import inspect
from typing import NamedTuple

import numpy as np
import pytest
from numba import config
from numba.core.errors import TypingError

from tests.polygon.meshes import polygons, quads
from tetrabench.backends.polygon import FORMATS
from tetrabench.jit import implements
from tetrabench.jit.generic import is_implemented
from tetrabench.mesh.polygon.connect import connect
from tetrabench.polygon import interface
from tetrabench.polygon.queries import QUERIES

FUNCTIONS = [
    interface.number_of_cells,
    interface.number_of_nodes,
    interface.cell_nodes,
    interface.cell_neighbours,
    interface.node_cells,
    interface.node_neighbours,
    interface.node_star,
]


class Half(NamedTuple):
    """A format that knows how many cells and nodes there are, and nothing else."""

    counts: np.ndarray


@implements(interface.number_of_cells, Half)
def number_of_cells(storage):
    return storage.counts[0]


@implements(interface.number_of_nodes, Half)
def number_of_nodes(storage):
    return storage.counts[1]


def test_the_list_of_functions_is_complete():
    declared = [f for f in vars(interface).values() if inspect.isfunction(f) and f.__module__ == interface.__name__]
    assert declared == FUNCTIONS
    assert all(function.__doc__ for function in declared)


@pytest.mark.parametrize("name", sorted(FORMATS))
def test_every_format_implements_all_of_it(name):
    storage = FORMATS[name].build(connect(polygons(quads(2, 2))))
    assert [f.__name__ for f in FUNCTIONS if not is_implemented(f, storage)] == []


def test_every_format_says_what_it_is():
    for name, contestant in FORMATS.items():
        assert contestant.name == name
        assert contestant.family == "polygon"
        assert all(
            (contestant.title, contestant.trade_off, contestant.values, contestant.source or contestant.extension)
        )
    assert [name for name, contestant in FORMATS.items() if contestant.extension] == ["half-edge", "tables"]


@pytest.mark.parametrize("function", FUNCTIONS[2:])
def test_what_is_left_out_is_named(function):
    out = np.zeros(9, np.int32)
    arguments = [Half(np.array([4, 9], np.int32)), 0, *[out] * (len(inspect.signature(function).parameters) - 2)]
    with pytest.raises(TypeError, match=rf"^Half does not implement {function.__name__}\(storage"):
        function(*arguments)


@pytest.mark.parametrize("query", QUERIES)
def test_what_is_left_out_is_named_in_kernels(query):
    asked = QUERIES[query]
    storage, out = Half(np.array([4, 9], np.int32)), np.zeros(9, np.int32)
    assert asked.elements(storage).tolist() == list(range(9 if asked.of_nodes else 4))
    with pytest.raises(
        TypeError if config.DISABLE_JIT else TypingError, match=f"Half does not implement {query.replace('-', '_')}"
    ):
        asked.sweep(storage, out)
