"""The digest of lists: it is what its definition says, the same wherever lists begin, and another for every kind of fault."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numba import config

from tests.polygon.meshes import ALL, polygons, quads
from tests.polygon.twin import Twin, as_lists, circle
from tetrabench.backends.polygon import FORMATS
from tetrabench.jit.mix import SEED, mix_exactly, mixed_with
from tetrabench.mesh.polygon.models import generate_polygons
from tetrabench.polygon.digest import mesh_answer, query_answer, sum_of_lists
from tetrabench.polygon.net import PolygonNet
from tetrabench.polygon.queries import QUERIES

ALL_BITS = 2**64 - 1
WALKS_END = bool(config.DISABLE_JIT or config.BOUNDSCHECK)
"""Whether a walk that goes astray is stopped at the end of an array."""


def defined_sum(lists):
    """The sum of `digest`'s first paragraph, in Python's own integers: every turn of a list hashed from its beginning."""
    total = 0
    for element, items in enumerate(lists):
        turns = 0
        for j in range(len(items)):
            hashed = 0
            for item in items[j:] + items[:j]:
                hashed = (hashed * SEED + mix_exactly(SEED ^ (item & ALL_BITS))) & ALL_BITS
            turns += mix_exactly(hashed)
        total += mix_exactly(mix_exactly(SEED ^ element) ^ (turns & ALL_BITS))
    return total & ALL_BITS


def sum_of(lists, *, drops=False, elements=None):
    elements = range(len(lists)) if elements is None else elements
    items = [item for row in lists for item in row]
    return sum_of_lists(
        np.array(elements, np.int32), np.cumsum([0, *map(len, lists)]), np.array(items, np.int32), drops=drops
    )


def circles(lists, *, drops=False):
    return [circle(item for item in row if item >= 0 or not drops) for row in lists]


@pytest.mark.parametrize(
    "mesh", ["two holes", "every boundary side told apart", "torus", "hexagon, 24 cells, shuffled"]
)
def test_answers_are_what_is_defined(mesh):
    """From the lists of the twin, for every format; with the JIT off as with it."""
    mesh = ALL[mesh]()
    twin = Twin(mesh)
    boundary = sum(condition < 0 for condition in twin.condition.values())
    sides = [
        [x for pair in zip(twin.cell_nodes(c), twin.cell_neighbours(c), strict=True) for x in pair]
        for c in range(len(twin.cells))
    ]
    expected = []
    for query, asked in QUERIES.items():
        kept = [[x for x in row if x >= 0 or not asked.of_nodes] for row in twin.lists(query)]
        figures = {"lists": len(kept), "items": sum(x >= 0 for row in kept for x in row)}
        if not asked.of_nodes:
            figures["boundary_sides"] = boundary if query == "cell-neighbours" else 0
        expected.append((mixed_with(defined_sum(kept), *figures.values()), figures))
    for contestant in FORMATS.values():
        net = PolygonNet(mesh, contestant)
        answers = [
            query_answer(asked, net.storage, asked.elements(net.storage), net.room) for asked in QUERIES.values()
        ]
        assert [(answer.digest, answer.figures) for answer in answers] == expected
        whole = net.answer()
        assert whole.digest == mixed_with(0, *(int(digest, 16) for digest, _ in expected), defined_sum(sides))
        assert whole.figures == {
            "cells": len(twin.cells),
            "nodes": twin.number_of_nodes,
            "sides": len(mesh.nodes),
            "boundary_sides": boundary,
        }


rows = st.lists(st.integers(-3, 6), max_size=7)


@given(st.lists(st.tuples(rows, st.integers(0, 6)), min_size=1, max_size=5))
def test_it_does_not_matter_where_lists_begin(turned):
    lists = [row for row, _ in turned]
    assert sum_of([row[j:] + row[:j] for row, j in turned]) == sum_of(lists)


@given(rows, st.randoms(use_true_random=False))
def test_lists_with_one_digest_are_one_circle(row, random):
    """The same items in another order; few different ones, so that pairs of neighbours come more than once."""
    other = list(row)
    random.shuffle(other)
    assert (sum_of([row]) == sum_of([other])) == (circle(row) == circle(other))


def test_circles_of_the_same_pairs():
    """Neighbours of a cell with conditions in between: pairs of an item and the next are the same in both."""
    assert sum_of([[-1, 5, -1, 6, -1, 7]]) != sum_of([[-1, 6, -1, 5, -1, 7]])


@given(st.lists(rows, min_size=1, max_size=5), st.data())
def test_conditions_around_nodes_do_not_count(lists, data):
    """Wherever they stand, and however many there are."""
    more = [list(row) for row in lists]
    for row in more:
        row.insert(data.draw(st.integers(0, len(row))), data.draw(st.integers(-(2**31), -1)))
    assert sum_of(more, drops=True) == sum_of(lists, drops=True) == sum_of(circles(lists, drops=True))
    assert sum_of(more) != sum_of(lists)


@pytest.mark.parametrize("query", QUERIES)
def test_every_single_fault_is_seen(query):
    """Lists of a real mesh: an item changed, left out, doubled or given away; two swapped; a list turned over, or dropped."""
    asked = QUERIES[query]
    lists = Twin(polygons(quads(3, 3, [4]), {(0, 1): -2})).lists(query)
    drops, true = asked.of_nodes, sum_of(lists, drops=asked.of_nodes)

    def differs(e, row):
        changed = [*lists[:e], row, *lists[e + 1 :]]
        seen = sum_of(changed, drops=drops) != true
        assert seen == (circles(changed, drops=drops) != circles(lists, drops=drops))
        return seen

    found = 0
    for e, row in enumerate(lists):
        for j, item in enumerate(row):
            if item >= 0 or not drops:
                for wrong in {item + 1, item ^ 4, -9, 0, 2**31 - 1} - {item}:
                    assert differs(e, [*row[:j], wrong, *row[j + 1 :]])
                assert differs(e, row[:j] + row[j + 1 :])
                assert differs(e, [*row[: j + 1], *row[j:]])
            for i in range(j):
                swapped = list(row)
                swapped[i], swapped[j] = row[j], row[i]
                found += differs(e, swapped)
        found += differs(e, row[::-1])
        assert differs(e, [])
        rest = [x for x in range(len(lists)) if x != e]
        assert sum_of([lists[x] for x in rest], drops=drops, elements=rest) != true
        other = (e + 1) % len(lists)
        given_away = list(lists)
        given_away[e], given_away[other] = row[1:], [*lists[other], row[0]]
        assert sum_of(given_away, drops=drops) != true
        exchanged = list(lists)
        exchanged[e], exchanged[other] = lists[other], row
        assert (sum_of(exchanged, drops=drops) != true) == (
            circles(exchanged, drops=drops) != circles(lists, drops=drops)
        )
    assert found > len(lists)


# The arrays of a format, one entry changed.


FAULTS = {
    "by-node": lambda storage: ("cells", np.flatnonzero(storage.cells < 0)[0], -9),
    "by-edge": lambda storage: ("edge", (np.flatnonzero(storage.edge[:, 2] >= 0)[0], 3), 0),
    "by-cell": lambda storage: ("neighbours", np.flatnonzero(storage.neighbours < 0)[0], -9),
    "edge-cell": lambda storage: ("edge", (np.flatnonzero(storage.edge[:, 2] < 0)[0], 2), -9),
    "edge-cell-node": lambda storage: ("node_edges", 1, storage.node_edges[0]),
    "half-edge": lambda storage: ("half", (0, 0), storage.half[1, 0]),
    "tables": lambda storage: ("node_cells", 0, 5),
}
"""format -> storage -> array, place, and a wrong entry with which all walks still end."""


def with_fault(storage, array, place, wrong):
    changed = getattr(storage, array).copy()
    assert changed[place] != wrong
    changed[place] = wrong
    return storage._replace(**{array: changed})


@pytest.mark.parametrize("name", sorted(FORMATS))
def test_a_wrong_entry_of_a_format_is_found(name):
    net = PolygonNet(generate_polygons("quad", 12, numbering="shuffled", seed=4), FORMATS[name])
    faulty = with_fault(net.storage, *FAULTS[name](net.storage))
    assert mesh_answer(faulty, net.room).digest != net.answer().digest


def test_neighbours_beside_the_wrong_sides_are_found():
    """As lists, taken as circles, they are the same: but neighbour j lies beyond nodes j and j + 1."""
    net = PolygonNet(polygons(quads(3, 3)), FORMATS["by-cell"])
    start, count = net.storage.lists[4]
    neighbours = net.storage.neighbours.copy()
    neighbours[start : start + count] = np.roll(neighbours[start : start + count], 1)
    faulty, asked = net.storage._replace(neighbours=neighbours), QUERIES["cell-neighbours"]
    digests = {query_answer(asked, s, asked.elements(s), net.room).digest for s in (faulty, net.storage)}
    assert len(digests) == 1
    tables = PolygonNet(polygons(quads(3, 3)), FORMATS["tables"])
    turned = tables.storage._replace(cell_neighbours=neighbours)  # where no walk uses them
    assert mesh_answer(turned, tables.room).digest != tables.answer().digest


def answered(storage, room):
    """All lists, as circles, and the answer; None where a walk goes astray."""
    try:
        lists = {
            name: as_lists(*asked.lists(storage, asked.elements(storage), room)) for name, asked in QUERIES.items()
        }
        sides = [
            circle(zip(cell, beyond, strict=False)) if len(cell) == len(beyond) else None
            for cell, beyond in zip(lists["cell-nodes"], lists["cell-neighbours"], strict=True)
        ]
        seen = {name: circles(rows, drops=QUERIES[name].of_nodes) for name, rows in lists.items()}
        return (seen, sides), mesh_answer(storage, room).digest
    except (IndexError, ValueError, OverflowError):
        return None


@pytest.mark.skipif(not WALKS_END, reason="walks that go astray need bounds checks, or the JIT off")
@pytest.mark.parametrize("name", sorted(FORMATS))
def test_every_wrong_entry_is_found_or_makes_no_difference(name):
    """Each entry of each array in turn: the digest is another exactly where a list is another circle."""
    net = PolygonNet(polygons(quads(2, 2), {(0, 1): -2, (1, 2): -2}), FORMATS[name])
    truth, digest = answered(net.storage, net.room)
    found = 0
    for array, values in net.storage._asdict().items():
        for place in np.ndindex(values.shape):
            for wrong in {int(values[place]) + 1, int(values[place]) - 1}:
                if outcome := answered(with_fault(net.storage, array, place, wrong), net.room):
                    assert (outcome[1] != digest) == (outcome[0] != truth), (array, place, wrong)
                    found += outcome[1] != digest
    assert found > net.values() / 4
