"""Scenarios on every contestant: equal answers, the oracle's answers, and what physics says."""

import numpy as np
import pytest
from numba import config

from tests.oracle import OracleNet
from tetrabench import registry
from tetrabench.backends.tetra import CONTESTANTS as OURS
from tetrabench.io import read_mesh, write_mesh
from tetrabench.mesh.models import generate
from tetrabench.scenarios.tetra.alfa import average
from tetrabench.scenarios.tetra.delete import delete_from_end
from tetrabench.scenarios.tetra.flow import diffuse, largest_exchange
from tetrabench.tetra.family import FAMILY, set_initial_states
from tetrabench.tetra.net import TetraNet

CONTESTANTS = [c.name for c in OURS]
SCENARIOS = [s.name for s in registry.scenarios("tetra")]
ROUNDING = 8 * 2.0**-53
TETS = 150 if config.DISABLE_JIT else 3000
CUBES = 2 if config.DISABLE_JIT else 12


@pytest.fixture(scope="module")
def model(tmp_path_factory):
    path = tmp_path_factory.mktemp("model") / "nozzle.nas"
    write_mesh(generate("nozzle", TETS, numbering="shuffled", seed=5), path)
    return path


def net_of(name, model):
    net = TetraNet(read_mesh(model), registry.contestant("tetra", name))
    set_initial_states(net)
    return net


def sample(scenario, stage, **options):
    subject = scenario.prepare(stage, {**scenario.options, **options})
    outcome = scenario.run(subject)
    return scenario.answer(subject, outcome), scenario.work(subject, outcome)


def exact(answer):
    """What does not depend on the order in which a contestant visits its tetras: sums of floats do, in the last bits."""
    return answer.digest, {name: value for name, value in answer.figures.items() if isinstance(value, int)}


@pytest.mark.parametrize("scenario", SCENARIOS)
def test_all_contestants_give_one_answer(scenario, model):
    scenario = registry.scenario("tetra", scenario)
    answers, works = [], []
    for name in CONTESTANTS:
        stage = FAMILY.stage(registry.contestant("tetra", name), model, chained=False)
        answer, work = sample(scenario, stage, cubes=CUBES)
        again, _ = sample(scenario, stage, cubes=CUBES)  # a second sample starts from where the first one started
        assert exact(again) == exact(answer)
        answers.append(exact(answer))
        works.append(work)
        stage.close()
    assert answers == answers[:1] * len(CONTESTANTS)
    assert works == works[:1] * len(CONTESTANTS)
    assert works[0].items > 0


def test_the_thesis_chain_gives_one_answer(model):
    """Delete, explode, alfa, flow on one net that changes as it goes, each state compared."""
    chains = []
    for name in CONTESTANTS:
        stage = FAMILY.stage(registry.contestant("tetra", name), model, chained=True)
        chain = [sample(registry.scenario("tetra", step), stage)[0] for step in FAMILY.thesis_order]
        chains.append(chain)
        stage.close()
    assert [list(map(exact, chain)) for chain in chains] == [list(map(exact, chains[0]))] * len(CONTESTANTS)
    figures = dict(zip(FAMILY.thesis_order, (answer.figures for answer in chains[0]), strict=True))
    assert figures["explode"]["tetras"] == figures["delete"]["tetras"] + 3 * (figures["delete"]["tetras"] // 2)
    assert figures["free"]["buffers_left"] == 0


@pytest.mark.parametrize("name", CONTESTANTS)
def test_chain_against_the_oracle(name, tmp_path):
    mesh = generate("nozzle", 100, seed=6)
    net, oracle = TetraNet(mesh, registry.contestant("tetra", name)), OracleNet(mesh.points, mesh.tets)
    set_initial_states(net)
    oracle.set_initial_states()
    np.testing.assert_allclose(net.states[:, 0], [oracle.states[t][0] for t in oracle.tetras], rtol=1e-15)
    oracle.states = dict(zip(oracle.tetras, net.states.tolist(), strict=True))  # sines may differ in the last bit

    delete_from_end(net.storage, 30)
    t = None
    for _ in range(30):
        t = max(oracle.tetras) if t is None else t
        behind = [n for i in range(4) if (n := oracle.neighbour(t, i)) is not None]
        oracle.delete(t)
        t = behind[0] if behind else None
    assert net.answer().digest == oracle.digest()

    first = list(oracle.tetras)[:20]
    assert net.split(net.refs[:20]) == 0
    assert all(oracle.split(t) for t in first)
    assert net.answer().digest == oracle.digest()

    average(net.storage, 3)
    oracle.alfa(3)
    assert net.answer().digest == oracle.digest()

    step = oracle.flow_step()
    np.testing.assert_allclose(0.9 / largest_exchange(net.storage), step, rtol=1e-14)
    diffuse(net.storage, 3, step)
    oracle.flow(3, step)
    assert net.answer().digest == oracle.digest()
    assert net.check() == []


@pytest.mark.parametrize("name", CONTESTANTS)
@pytest.mark.parametrize("sweep", ["alfa", "flow"])
def test_sum_is_conserved_and_range_never_widens(name, sweep, model, rng):
    net = net_of(name, model)
    states = net.states
    states[:, 0] = rng.random(len(net)) * 2 - 1
    net.states = states
    step = 0.9 / largest_exchange(net.storage)
    before = net.states[:, 0]
    for _ in range(5):
        if sweep == "alfa":
            average(net.storage, 1)
        else:
            diffuse(net.storage, 1, step)
        after = net.states[:, 0]
        slack = ROUNDING * np.abs(before).max()
        assert abs(after.sum() - before.sum()) <= slack * len(net)
        assert after.min() >= before.min() - slack
        assert after.max() <= before.max() + slack
        assert after.var() < before.var()
        before = after


@pytest.mark.parametrize("name", CONTESTANTS)
def test_a_constant_stays_constant(name, model):
    net = net_of(name, model)
    net.states = np.ones((len(net), 5))
    average(net.storage, 2)
    np.testing.assert_array_equal(net.states[:, 0], 1.0)
    diffuse(net.storage, 2, 0.9 / largest_exchange(net.storage))
    np.testing.assert_array_equal(net.states[:, 0], 1.0)


@pytest.mark.parametrize("name", CONTESTANTS)
def test_explode_keeps_volume_surface_and_states(name, model):
    net = net_of(name, model)
    before = net.answer().figures
    chosen = net.refs[:: 3 if len(net) > 500 else 2]
    split = {
        net.vertices_of(t): net.states[n] for n, t in enumerate(net.refs.tolist()) if t in set(chosen[:5].tolist())
    }
    assert net.split(chosen) == 0
    after = net.answer().figures
    assert after["tetras"] == before["tetras"] + 3 * len(chosen)
    assert after["points"] == before["points"] + len(chosen)
    assert after["surface_sides"] == before["surface_sides"]
    assert after["volume"] == pytest.approx(before["volume"], rel=1e-12)
    assert (after["state_min"], after["state_max"]) == (before["state_min"], before["state_max"])
    states = {net.vertices_of(t): net.states[n] for n, t in enumerate(net.refs.tolist())}
    for n, (vertices, parent) in enumerate(split.items()):
        centre = before["points"] + n  # children carry the first new points
        children = [v for v in states if centre in v]
        assert len(children) == 4
        assert all(sum(a != b for a, b in zip(child, vertices, strict=True)) == 1 for child in children)
        assert all((states[child] == parent).all() for child in children)
    assert net.check() == []


@pytest.mark.parametrize("name", CONTESTANTS)
def test_delete_leaves_a_sound_net_and_small_models_a_smaller_count(name, model):
    scenario = registry.scenario("tetra", "delete")
    stage = FAMILY.stage(registry.contestant("tetra", name), model, chained=False)
    deletion = scenario.prepare(stage, scenario.options)
    whole = len(deletion.net)
    scenario.run(deletion)
    assert scenario.work(deletion, None).items == whole // 2 == whole - len(deletion.net)
    assert deletion.net.check() == []
    assert not deletion.net.collect()  # what deletions leave is finished inside what is timed


@pytest.mark.parametrize("name", CONTESTANTS)
def test_what_delete_left_for_later_is_there_when_explode_begins(name, model):
    scenario = registry.scenario("tetra", "explode")
    contestant = registry.contestant("tetra", name)
    stage = FAMILY.stage(contestant, model, chained=False)
    explosion = scenario.prepare(stage, scenario.options)
    assert explosion.net.collect() == (not contestant.stable_refs)
    explosion = scenario.prepare(stage, scenario.options)
    assert scenario.run(explosion) == 0
    assert not explosion.net.collect()


def test_locate_finds_the_tetra_it_was_made_in(model):
    for scenario in ("locate", "locate-source", "locate-brute"):
        stage = FAMILY.stage(registry.contestant("tetra", "v3y"), model, chained=False)
        answer, work = sample(registry.scenario("tetra", scenario), stage)
        assert answer.figures == {"found": work.items, "missed": 0}


@pytest.mark.parametrize("name", CONTESTANTS)
def test_a_first_search_finds_what_later_ones_find(name, tmp_path, monkeypatch):
    """The grid of those who get stuck is made before, and is no part of what is timed in some samples alone."""
    path = tmp_path / "nozzle.nas"
    write_mesh(generate("nozzle", 150, numbering="shuffled", seed=5), path)  # so coarse that walks get stuck
    stage = FAMILY.stage(registry.contestant("tetra", name), path, chained=False)
    scenario = registry.scenario("tetra", "locate")
    search = scenario.prepare(stage, scenario.options)
    assert search.net._grid is not None

    def refuse(net):
        raise AssertionError("a grid was made in a run")

    monkeypatch.setattr("tetrabench.tetra.locate.build_grid", refuse)
    scenario.run(search)


def test_shuffled_points_are_the_same_points(model):
    scenario = registry.scenario("tetra", "locate")
    stage = FAMILY.stage(registry.contestant("tetra", "v3y"), model, chained=False)
    search, shuffled = (scenario.prepare(stage, {**scenario.options, "shuffled": flag}) for flag in (0, 1))
    order = np.argsort(shuffled.refs)
    assert (order != np.arange(len(order))).any()
    np.testing.assert_array_equal(shuffled.refs[order], search.refs)
    np.testing.assert_array_equal(shuffled.points[order], search.points)
    np.testing.assert_array_equal(scenario.run(shuffled), shuffled.refs)


def test_write_keeps_the_tetras(model, tmp_path):
    stage = FAMILY.stage(registry.contestant("tetra", "v4"), model, chained=False)
    answer, _ = sample(registry.scenario("tetra", "write"), stage)
    assert answer.figures["tetras"] == len(read_mesh(model).tets)


def test_a_wrong_formula_would_be_noticed(model, monkeypatch):
    """The digest sees a change in the last bit of one state of one tetra."""
    net = net_of("v3y", model)
    digest = net.answer().digest
    states = net.states
    states[7, 0] = np.nextafter(states[7, 0], 2.0)
    net.states = states
    assert net.answer().digest != digest
