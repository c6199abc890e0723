"""Scenarios on polygons: one answer for all formats on all models, the twin's; and a wrong entry of a format is found."""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
import pytest

from tests.polygon.meshes import SMALL_MODELS, polygons, quads
from tests.polygon.twin import Twin
from tetrabench import registry
from tetrabench.backends.polygon import FORMATS
from tetrabench.mesh.polygon.models import generate_polygons
from tetrabench.polygon.net import PolygonNet
from tetrabench.polygon.queries import QUERIES
from tetrabench.scenarios.polygon.build import Build
from tetrabench.scenarios.polygon.queries import QUERY_SCENARIOS, SEED

NAMES = sorted(FORMATS)
SCENARIOS = {scenario.name: scenario for scenario in [Build(), *QUERY_SCENARIOS]}


class Stage:
    """One contestant with a mesh that is in memory already."""

    def __init__(self, mesh, name, spoil=lambda storage: storage):
        contestant = FORMATS[name]
        self.mesh = mesh
        self.contestant = replace(contestant, build=lambda links: spoil(contestant.build(links)))
        self.adopted = None

    def model_size(self) -> Mapping[str, int]:
        return {"cells": self.mesh.number_of_cells}

    def net(self):
        return PolygonNet(self.mesh, self.contestant)

    def adopt(self, net):
        self.adopted = net


def sample(name, stage, **options):
    scenario = SCENARIOS[name]
    subject = scenario.prepare(stage, {**scenario.options, **options})
    outcome = scenario.run(subject)
    return scenario.answer(subject, outcome), scenario.work(subject, outcome)


def total_of(lists):
    return sum(x for row in lists for x in row if x >= 0)


def test_the_names_of_the_scenarios():
    """`run` finds them by name: the four queries in order and at random, and build."""
    assert list(SCENARIOS) == ["build", *QUERIES, *(f"random-{query}" for query in QUERIES)]
    for name, scenario in SCENARIOS.items():
        assert registry.scenario("polygon", name).name == name
        assert scenario.family == "polygon"
        assert scenario.options.keys() == scenario.thesis.keys()
        assert scenario.skip(FORMATS["by-edge"]) is None


@pytest.mark.parametrize("name", SCENARIOS)
@pytest.mark.parametrize("mesh", SMALL_MODELS)
def test_all_formats_give_one_answer(mesh, name):
    mesh = SMALL_MODELS[mesh]()
    outcomes = [
        sample(name, Stage(mesh, contestant), **({"queries": 7} if "random" in name else {})) for contestant in NAMES
    ]
    answers, works = zip(*outcomes, strict=True)
    assert [(a.digest, a.figures) for a in answers] == [(answers[0].digest, answers[0].figures)] * len(NAMES)
    assert list(works) == [works[0]] * len(NAMES)
    assert works[0].items > 0


@pytest.mark.parametrize("query", QUERIES)
@pytest.mark.parametrize("contestant", NAMES)
def test_in_order(contestant, query):
    """The sum is that of the twin's lists, conditions left out, once for each sweep; the items take 4 bytes each."""
    mesh = polygons(quads(4, 3, [5]), {(0, 1): -5})
    lists = Twin(mesh).lists(query)
    answer, work = sample(query, Stage(mesh, contestant))
    assert answer.figures["sum"] == total_of(lists)
    assert answer.figures["lists"] == len(lists)
    assert answer.figures["items"] == sum(x >= 0 for row in lists for x in row)
    assert (work.items, work.unit) == (len(lists), "lists")
    assert work.least_bytes == 4 * answer.figures["items"]
    thrice, thrice_work = sample(query, Stage(mesh, contestant), sweeps=3)
    assert thrice.figures == {**answer.figures, "sum": 3 * total_of(lists)}
    assert (thrice_work.items, thrice_work.least_bytes) == (3 * work.items, 3 * work.least_bytes)


@pytest.mark.parametrize("query", QUERIES)
@pytest.mark.parametrize("contestant", NAMES)
def test_at_random(contestant, query):
    """The same elements for all, so many, each as often as it is drawn; more than there are if so many are asked for."""
    mesh = generate_polygons("quad", 30, numbering="shuffled", seed=2)
    lists = Twin(mesh).lists(query)
    stage = Stage(mesh, contestant)
    drawn = np.random.default_rng(SEED).choice(np.arange(len(lists), dtype=np.int32), 20)
    answer, work = sample(f"random-{query}", stage, queries=20)
    assert answer.figures["sum"] == total_of(lists[x] for x in drawn)
    assert answer.figures["lists"] == work.items == 20
    assert work.unit == "lists"
    assert len(set(drawn.tolist())) < 20  # some come twice
    most, most_work = sample(f"random-{query}", stage, queries=100)
    assert most_work.items == most.figures["lists"] == 100 > len(lists)
    assert most.digest != answer.digest


@pytest.mark.parametrize("name", [scenario.name for scenario in QUERY_SCENARIOS])
def test_the_sum_that_was_timed_is_part_of_the_answer(name):
    """A loop that leaves something out has another digest, though the lists that are collected afterwards are right."""
    scenario, stage = SCENARIOS[name], Stage(polygons(quads(3, 3)), "by-edge")
    asked = scenario.prepare(stage, {option: min(count, 20) for option, count in scenario.options.items()})
    total = scenario.run(asked)
    assert scenario.answer(asked, total).digest != scenario.answer(asked, total - 1).digest
    assert scenario.run(asked) == total  # and nothing is changed by asking


@pytest.mark.parametrize("contestant", NAMES)
def test_build_hands_its_net_on(contestant):
    stage = Stage(polygons(quads(3, 3)), contestant)
    answer, work = sample("build", stage)
    assert (work.items, work.unit, work.least_bytes) == (9, "cells", None)
    assert answer.figures == {"cells": 9, "nodes": 16, "sides": 36, "boundary_sides": 12}
    assert stage.adopted.answer() == answer


def spoilt(array, place, wrong):
    """What changes one entry of a storage."""

    def spoil(storage):
        changed = getattr(storage, array)
        assert changed[place] != wrong
        changed[place] = wrong
        return storage

    return spoil


FAULTS = [  # on quads(3, 3); each leaves all walks an end
    ("by-node", ("cells", 1, -9), {"node-cells": False, "cell-neighbours": True}),
    ("by-edge", ("edge", (1, 3), 0), {"node-cells": True, "cell-neighbours": True, "cell-nodes": False}),
    ("by-cell", ("neighbours", 0, -9), {"node-cells": False, "cell-neighbours": True, "cell-nodes": False}),
    ("edge-cell", ("edge", (0, 2), -9), {"cell-neighbours": True, "node-cells": False, "node-neighbours": False}),
    ("edge-cell-node", ("node_edges", 1, 0), {"node-neighbours": True, "node-cells": True, "cell-nodes": False}),
    ("half-edge", ("half", (0, 0), 5), {"cell-nodes": True, "node-neighbours": True, "node-cells": False}),
    ("tables", ("node_neighbours", 7, 11), {"node-neighbours": True, "cell-nodes": False, "node-cells": False}),
]


@pytest.mark.parametrize(("contestant", "fault", "found"), FAULTS, ids=[name for name, _, _ in FAULTS])
def test_one_wrong_entry_is_found(contestant, fault, found):
    """By the queries that come upon it, in order and at random, and by build; the others go on giving the one answer."""
    mesh = polygons(quads(3, 3))
    right, wrong = Stage(mesh, contestant), Stage(mesh, contestant, spoilt(*fault))
    assert sample("build", right)[0].digest != sample("build", wrong)[0].digest
    for query, seen in found.items():
        assert (sample(query, right)[0].digest != sample(query, wrong)[0].digest) == seen, query
    assert True in found.values()
