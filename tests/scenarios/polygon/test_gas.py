"""The physics of the gas: what is conserved, what is symmetric, Sod's tube; beside a naive twin, and on every format."""

from types import SimpleNamespace

import numpy as np
import pytest
from numba import config

from tests.polygon.meshes import polygons, ring
from tests.scenarios.polygon import riemann, sod
from tests.scenarios.polygon.twin import GasTwin, area_of, gradient
from tetrabench import registry
from tetrabench.backends.polygon import CONTESTANTS as OURS
from tetrabench.errors import UnsupportedError
from tetrabench.mesh.polygon import PolygonMesh
from tetrabench.mesh.polygon.models import MODELS, generate_polygons
from tetrabench.polygon.net import PolygonNet
from tetrabench.scenarios.polygon import gas as scheme
from tetrabench.scenarios.polygon.gasdynamics import GAS_SCENARIOS, sod_state, state_answer

CONTESTANTS = {contestant.name: contestant for contestant in OURS}
SLOW = bool(config.DISABLE_JIT)
CELLS, STEPS = (12, 6) if SLOW else (200, 60)


class Tube:
    """A gas on a mesh, in a format, with what steps need."""

    def __init__(self, mesh, density=None, pressure=None, contestant="by-cell"):
        self.mesh, self.net = mesh, PolygonNet(mesh, CONTESTANTS[contestant])
        state = sod_state(mesh) if density is None else (density, pressure)
        self.gas = scheme.make_gas(self.net.storage, mesh, *state, self.net.room)
        self.nodes, self.cells = np.zeros((2, self.net.room), np.int32)

    def advance(self, steps=STEPS, until=np.inf):
        return scheme.advance(self.net.storage, self.gas, steps, until, self.nodes, self.cells)

    def free(self):
        """Take the walls away."""
        self.gas.slide[:] = 1, 0, 1

    def move(self, velocity):
        """Set the velocities, and fit the fields of the cells to them."""
        self.gas.velocity[:] = self.gas.last_velocity[:] = velocity
        scheme.cell_block(self.net.storage, self.gas, 0.0, 0.0, self.nodes)


@pytest.fixture(params=sorted(MODELS))
def mesh(request):
    return generate_polygons(request.param, CELLS, seed=3)


def uniform(mesh, **changes):
    cells = mesh.number_of_cells
    return Tube(mesh, np.full(cells, 1.3), np.full(cells, 0.7), **changes)


def turned(mesh, angle):
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return PolygonMesh(mesh.points @ turn.T, mesh.starts, mesh.nodes, mesh.conditions), turn


def test_mass_stays_in_its_cell_to_the_bit(mesh):
    tube = Tube(mesh)
    cells, nodes = tube.gas.cell_mass.tobytes(), tube.gas.node_mass.tobytes()
    assert tube.gas.cell_mass.sum() == pytest.approx(tube.gas.node_mass.sum(), rel=1e-14)
    assert tube.advance() == STEPS
    assert (tube.gas.cell_mass.tobytes(), tube.gas.node_mass.tobytes()) == (cells, nodes)
    areas = [area_of(tube.gas.place[cell]) for cell in np.split(mesh.nodes, mesh.starts[1:-1])]
    np.testing.assert_allclose(tube.gas.area, areas, rtol=1e-11)
    assert tube.gas.area.sum() == pytest.approx(1.0, rel=1e-13)  # the walls hold
    assert abs(tube.gas.place - mesh.points).max() > 0.01


def test_energy_is_conserved_to_rounding(mesh):
    tube = Tube(mesh)
    before, internal = scheme.total_energy(tube.gas), (tube.gas.cell_mass * tube.gas.energy).sum()
    tube.advance()
    assert scheme.total_energy(tube.gas) == pytest.approx(before, rel=1e-14)
    assert (tube.gas.cell_mass * tube.gas.energy).sum() < 0.999 * internal  # some has become kinetic


def test_momentum_and_its_moment_are_conserved_without_walls(mesh, rng):
    tube = Tube(mesh)
    tube.free()
    tube.move(0.1 * rng.standard_normal(tube.gas.place.shape))

    def momenta():
        x, u, mass = tube.gas.place, tube.gas.velocity, tube.gas.node_mass
        return [*(mass @ u), mass @ (x[:, 0] * u[:, 1] - x[:, 1] * u[:, 0])]

    before = momenta()
    tube.advance(STEPS // 3)
    np.testing.assert_allclose(momenta(), before, atol=1e-13)


def test_uniform_gas_stays_at_rest(mesh):
    tube = uniform(mesh)
    energy = tube.gas.energy.copy()
    tube.advance()
    assert abs(tube.gas.velocity).max() < 1e-12
    np.testing.assert_allclose(tube.gas.place, mesh.points, atol=1e-13)
    np.testing.assert_allclose(tube.gas.energy, energy, rtol=1e-12)


def test_a_moving_observer_sees_the_same(mesh):
    rest, moving = Tube(mesh), Tube(mesh)
    for tube in (rest, moving):
        tube.free()
    speed = np.array([3.0, -2.0])
    moving.move(speed)
    for tube in (rest, moving):
        tube.advance(STEPS // 3)
    np.testing.assert_allclose(moving.gas.clock, rest.gas.clock, rtol=1e-10)
    np.testing.assert_allclose(moving.gas.velocity - speed, rest.gas.velocity, atol=1e-10)
    np.testing.assert_allclose(moving.gas.place - speed * moving.gas.clock[scheme.TIME], rest.gas.place, atol=1e-10)
    np.testing.assert_allclose(moving.gas.energy, rest.gas.energy, rtol=1e-10)


@pytest.mark.parametrize("angle", [np.pi / 2, 0.4])
def test_a_turned_tube_with_its_walls_does_the_same_turned(mesh, angle):
    other, turn = turned(mesh, angle)
    tubes = [Tube(mesh), Tube(other, *sod_state(mesh))]
    for tube in tubes:
        tube.advance(STEPS // 2)
    np.testing.assert_allclose(tubes[1].gas.place, tubes[0].gas.place @ turn.T, atol=1e-11)
    np.testing.assert_allclose(tubes[1].gas.velocity, tubes[0].gas.velocity @ turn.T, atol=1e-9)
    np.testing.assert_allclose(tubes[1].gas.energy, tubes[0].gas.energy, rtol=1e-9)


def test_drag_spares_linear_fields_and_takes_energy_from_all_others(mesh, rng):
    tube = uniform(mesh)
    points, pieces = mesh.points, list(enumerate(np.split(mesh.nodes, mesh.starts[1:-1])))

    def forces(c, cell):
        """Those of a cell, without its push."""
        found = []
        for j, v in enumerate(cell):
            a, b = cell[j - 1], cell[(j + 1) % len(cell)]
            force = scheme.corner_force(tube.gas, points, tube.gas.velocity, c, a, v, b)
            found.append(force - tube.gas.push[c] * gradient(points[cell], j))
        return np.array(found)

    tube.move(points @ rng.standard_normal((2, 2)) + rng.standard_normal(2))
    assert max(abs(forces(c, cell)).max() for c, cell in pieces) < 1e-12
    tube.move(rng.standard_normal(points.shape))
    powers = [(forces(c, cell) * tube.gas.velocity[cell]).sum() for c, cell in pieces if len(cell) > 3]
    assert all(power < 0 for power in powers)


def test_the_step_is_stable_for_small_waves(mesh):
    """Dense matrices of sound and of damping: no eigenvalue of t^2 K + 2 t D above 4, and some not far below it."""
    tube = uniform(mesh)
    gas, size = tube.gas, 2 * len(mesh.points)
    sound, damping = np.zeros((2, size, size))
    for c, cell in enumerate(np.split(mesh.nodes, mesh.starts[1:-1])):
        at = np.concatenate([2 * cell, 2 * cell + 1])
        slope = np.array([gradient(mesh.points[cell], j) for j in range(len(cell))]).T.ravel()
        stiffness = scheme.GAMMA * gas.push[c]  # rho s^2
        viscosity = scheme.LINEAR * np.sqrt(stiffness * gas.cell_mass[c])  # rho sqrt(A) LINEAR s
        sound[np.ix_(at, at)] += stiffness / gas.area[c] * np.outer(slope, slope)
        damping[np.ix_(at, at)] += viscosity / gas.area[c] * np.outer(slope, slope)
        basis, _ = np.linalg.qr(np.column_stack([np.ones(len(cell)), mesh.points[cell]]))
        damping[np.ix_(at, at)] += gas.drag[c] * np.kron(np.eye(2), np.eye(len(cell)) - basis @ basis.T)
    scale = 1 / np.sqrt(np.repeat(gas.node_mass, 2))
    step = gas.clock[scheme.NEXT] / scheme.SAFETY
    largest = np.linalg.eigvalsh(scale[:, None] * (step**2 * sound + 2 * step * damping) * scale).max()
    assert 0.5 < largest <= 4.0


def test_walls_are_slid_along_and_corners_are_fixed(mesh):
    slide = Tube(mesh).gas.slide
    on_side = (mesh.points == 0) | (mesh.points == 1)
    expected = np.where(on_side.any(axis=1)[:, None], [0.0, 0.0, 0.0], [1.0, 0.0, 1.0])
    expected[:, [0, 2]] = ~on_side
    np.testing.assert_array_equal(slide, expected)


def test_walls_in_any_direction():
    """Between two circles nodes slide around; in a wall that turns by more than 30 degrees they stand still."""
    for count, stands in ((24, False), (8, True)):
        mesh = polygons(ring(count))
        angle = 2 * np.pi * np.arange(count) / count
        rim = np.column_stack([np.cos(angle), np.sin(angle)])
        mesh.points = np.concatenate([2 * rim, rim])[:, :2] * [1, -1]  # `ring` runs clockwise around the outer one
        mesh.points[:, 1] *= np.sign(area_of(mesh.points[mesh.nodes[:4]]))
        tube = uniform(mesh)
        around = np.concatenate([rim, rim]) * [1, np.sign(mesh.points[1, 1])]
        x, y = around.T
        expected = np.zeros((2 * count, 3)) if stands else np.column_stack([y * y, -x * y, x * x])
        np.testing.assert_allclose(tube.gas.slide, expected, atol=1e-14)


def test_the_exact_solution_is_that_of_the_books():
    """E. F. Toro, table 4.3."""
    x = 0.5 + 0.2 * np.array([-2.0, 0.2, 1.2, 2.0])
    density, velocity, pressure = riemann.sod(x, 0.2)
    np.testing.assert_allclose(density, [1, 0.42632, 0.26557, 0.125], atol=5e-6)
    np.testing.assert_allclose(velocity, [0, 0.92745, 0.92745, 0], atol=5e-6)
    np.testing.assert_allclose(pressure, [1, 0.30313, 0.30313, 0.1], atol=5e-6)
    x = np.linspace(0.2, 0.9, 4001)
    for before, after in zip(riemann.sod(x, 0.2)[:, :-1], riemann.sod(x, 0.2)[:, 1:], strict=True):
        assert np.count_nonzero(abs(after - before) > 0.01) <= 2  # contact and shock; the rarefaction has no jump


@pytest.mark.skipif(SLOW, reason="some hundred thousand cell steps")
@pytest.mark.parametrize("model", sorted(MODELS))
def test_sods_tube_nears_the_exact_solution(model):
    errors = []
    for cells in (400, 1600):
        mesh = generate_polygons(model, cells)
        gas = sod.flow_to(mesh, sod.TIME)
        assert gas.clock[scheme.TIME] == sod.TIME
        assert gas.area.min() > 0
        errors.append(sod.error(mesh, gas, sod.TIME))
    assert errors[1] < 0.02
    assert errors[1] < 0.65 * errors[0]


@pytest.mark.parametrize("model", sorted(MODELS))
def test_the_naive_twin_gets_the_same(model):
    mesh = generate_polygons(model, 9, seed=2)
    tube, twin = Tube(mesh), GasTwin(mesh, *sod_state(mesh))
    for _ in range(6):
        tube.advance(1)
        twin.advance()
        assert tube.gas.clock[scheme.NEXT] == pytest.approx(twin.step, rel=1e-11)
    assert tube.gas.clock[scheme.TIME] > 0.01
    np.testing.assert_allclose(tube.gas.place, twin.x, atol=1e-12)
    np.testing.assert_allclose(tube.gas.velocity, twin.u, atol=1e-11)
    np.testing.assert_allclose(tube.gas.energy, twin.energy, rtol=1e-11)
    np.testing.assert_allclose(tube.gas.push, twin.pressure + twin.q, rtol=1e-11)


def test_the_last_step_ends_on_time():
    tube = Tube(generate_polygons("quad", 9))
    until = 2.5 * tube.gas.clock[scheme.NEXT]
    steps = tube.advance(1000, until)
    assert 2 < steps < 5
    assert tube.gas.clock[scheme.TIME] == until
    assert tube.advance(5, until) == 0


def staged(mesh, name):
    contestant = CONTESTANTS[name]
    return SimpleNamespace(mesh=mesh, contestant=contestant, net=lambda: PolygonNet(mesh, contestant))


def sample(scenario, stage, **options):
    subject = scenario.prepare(stage, {**scenario.options, **options})
    outcome = scenario.run(subject)
    return scenario.answer(subject, outcome), scenario.work(subject, outcome)


@pytest.mark.parametrize("scenario", GAS_SCENARIOS, ids=lambda scenario: scenario.name)
def test_all_formats_give_one_answer_to_the_bit(scenario):
    assert registry.scenario("polygon", scenario.name) is scenario
    mesh = generate_polygons("voronoi", 20 if SLOW else 300, numbering="shuffled", seed=4)
    options = {"steps": 3} if "steps" in scenario.options else {}
    samples = [sample(scenario, staged(mesh, name), **options) for name in CONTESTANTS for _ in range(2)]
    assert samples == samples[:1] * 2 * len(CONTESTANTS)
    assert samples[0][1].items > 0


def test_the_blocks_are_those_of_the_step():
    """gas-node is the first half of a step, gas-cell the second half of a second one."""
    mesh = generate_polygons("voronoi", 20, seed=5)
    stage = staged(mesh, "by-edge")
    whole, node, _, cell, _ = GAS_SCENARIOS
    flows = {n: whole.prepare(stage, {"steps": n}) for n in (1, 2)}
    assert {n: whole.run(flow) for n, flow in flows.items()} == {1: 1, 2: 2}
    first, last = node.prepare(stage, {}), cell.prepare(stage, {})
    node.run(first)
    step = cell.run(last)
    np.testing.assert_array_equal(first.gas.place, flows[1].gas.place)
    np.testing.assert_array_equal(last.gas.energy, flows[2].gas.energy)
    np.testing.assert_array_equal(last.gas.push, flows[2].gas.push)
    assert step == flows[2].gas.clock[scheme.NEXT]
    assert (first.gas.energy != flows[1].gas.energy).any()


@pytest.mark.parametrize("part", ["place", "velocity", "area", "energy", "push", "clock"])
def test_a_state_that_differs_in_one_bit_is_another(part):
    tube = Tube(generate_polygons("quad", 9))
    digest = state_answer(tube.gas).digest
    values = getattr(tube.gas, part).reshape(-1)
    values[2] = np.nextafter(values[2], np.inf)
    assert state_answer(tube.gas).digest != digest


def test_adjacency_is_the_sum_of_all_lists():
    mesh = generate_polygons("hexagon", 12)
    for name in CONTESTANTS:
        net = PolygonNet(mesh, CONTESTANTS[name])
        sums = {s.name: sample(s, staged(mesh, name))[0].figures["sum"] for s in GAS_SCENARIOS[2::2]}
        star = 0
        for v in range(len(mesh.points)):
            cells = net.node_cells(v)[: len(net.node_neighbours(v))]
            star += int(net.node_neighbours(v).sum() + cells.sum())
        assert sums == {"gas-node-adjacency": star, "gas-cell-adjacency": int(mesh.nodes.sum())}


@pytest.mark.parametrize("points", [[[0, 0, 0], [1, 0, 1], [0, 1, 0]], [[0, 0], [1, 1], [2, 2]]], ids=["space", "flat"])
def test_gas_refuses_what_it_cannot_flow_on(points):
    mesh = polygons([[0, 1, 2]])
    mesh.points = np.array(points, np.float64)
    for scenario in GAS_SCENARIOS[:2] + GAS_SCENARIOS[3:4]:
        with pytest.raises(UnsupportedError, match=r"lie in space|needs room; cell 0"):
            scenario.prepare(staged(mesh, "by-cell"), {**scenario.options})


def test_the_picture_is_drawn(tmp_path, monkeypatch):
    monkeypatch.setattr(sod, "CELLS", 9)
    monkeypatch.setattr(sod, "TIME", 0.02)
    sod.draw_sod(tmp_path / "sod.png")
    assert (tmp_path / "sod.png").stat().st_size > 10_000
