"""docs/library.md and docs/examples are true: they run, on all backends, and print what the page says."""

import importlib
import re
import sys
from pathlib import Path

import numba
import numpy as np
import pytest
from numba import config

import tetrabench
from tests.meshes import MESHES
from tetrabench.backends.tetra import CONTESTANTS

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "library.md").read_text()
BACKENDS = ["v3y", "v5y", "v4", "halfface"]
EXAMPLES = sorted(path.stem for path in (ROOT / "docs" / "examples").glob("*.py"))

sys.path[:0] = [str(ROOT / "docs" / "examples"), str(ROOT / "results")]
import adaptive_refinement as adaptive  # noqa: E402
import heat_conduction as heat  # noqa: E402
import library  # noqa: E402
import own_kernel  # noqa: E402

del sys.path[:2]

COMPILED = pytest.mark.skipif(bool(config.DISABLE_JIT), reason="takes minutes without the JIT")


def box(tets, backend):
    return tetrabench.open(tetrabench.generate("box", tets), backend=backend)


def by_place(net, values):
    """Values of tetras, in an order that does not depend on the storage."""
    return values[np.lexsort(net.centroids.T.round(9))]


# ---- heat conduction


@pytest.mark.parametrize("backend", BACKENDS)
def test_heat_that_reaches_points_is_that_of_the_matrix(rng, backend):
    """The kernel beside the matrix of linear elements, made of the gradients of barycentric coordinates."""
    net = box(48, backend)
    temperature, heat_in = rng.uniform(size=net.number_of_points), np.zeros(net.number_of_points)
    heat.conduct(net.storage, temperature, heat_in)
    expected = np.zeros_like(heat_in)
    for row, corners in enumerate(net.vertices):
        frame = np.column_stack([np.ones(4), net.points[corners]])
        slopes = np.linalg.inv(frame)[1:]  # (3, 4): the gradient of each barycentric coordinate
        gradient = slopes @ temperature[corners]
        expected[corners] -= heat.DIFFUSIVITY * abs(np.linalg.det(frame)) / 6 * (slopes.T @ gradient)
        assert np.allclose(net.states[row, :4], [temperature[corners].mean(), *gradient])
    assert np.allclose(heat_in, expected)
    assert abs(heat_in.sum()) < 1e-12  # it only moves


@pytest.mark.parametrize("name", sorted(MESHES))
def test_points_of_the_surface(name):
    mesh = MESHES[name]()
    sides = [tuple(sorted(np.delete(corners, i))) for corners in mesh.tets for i in range(4)]
    expected = {point for side in sides if sides.count(side) == 1 for point in side}
    assert set(np.flatnonzero(heat.surface_points(tetrabench.open(mesh)))) == expected


def test_the_longest_step_is_stable():
    """It is no longer than what the largest eigenvalue of the whole matrix allows, nor shorter by much."""
    net = box(162, "v3y")
    share = np.bincount(net.vertices.ravel(), np.repeat(net.volumes / 4, 4))
    columns = []
    for unit in np.eye(net.number_of_points):
        column = np.zeros_like(unit)
        heat.conduct(net.storage, unit, column)
        columns.append(-column)
    largest = np.linalg.eigvals(np.array(columns).T / share[:, None]).real.max()
    assert 0.1 * 2 / largest < heat.longest_step(net) <= 2 / largest


@COMPILED
def test_the_error_falls_with_the_square_of_the_length():
    errors = [heat.error_of(box(6 * along**3, "v3y")) for along in (8, 16)]
    assert errors[1] < 1e-3
    assert 1.7 < np.log2(errors[0] / errors[1]) < 2.3


# ---- adaptive refinement


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_halved_edge_halves_the_tetras_around_it(backend):
    with box(48, backend) as net:
        net.states = np.arange(5.0 * len(net)).reshape(-1, 5)
        a, b = (int(point) for point in net.vertices[7, :2])
        around = {t for t in net.tetras_around(a) if b in net.vertices_of(t)}
        before, tetras = net.states.T @ net.volumes, len(net)
        adaptive.halve(net, a, b)
        assert len(net) == tetras + len(around)
        assert not any({a, b} <= set(corners) for corners in net.vertices.tolist())
        assert np.allclose(net.points[-1], (net.points[a] + net.points[b]) / 2)
        assert np.allclose(net.states.T @ net.volumes, before, rtol=1e-13)
        assert net.check() == []


def test_edges_are_the_longest_of_the_steepest_tetras():
    net = box(162, "v3y")
    adaptive.fit(net)
    edges = adaptive.steep_edges(net)
    steepness = np.zeros(len(net))
    row_of = {int(t): row for row, t in enumerate(net.refs)}
    for row, others in enumerate(net.neighbours.tolist()):
        jumps = [abs(net.states[row, 0] - net.states[row_of[t], 0]) for t in others if t >= 0]
        steepness[row] = max(jumps) * net.volumes[row] ** 0.5
    assert np.allclose(net.states[:, 1], steepness)

    def length(edge):
        return float(np.linalg.norm(net.points[edge[0]] - net.points[edge[1]]))

    expected = set()
    for row in np.flatnonzero(steepness > np.quantile(steepness, 0.9)):
        corners = sorted(net.vertices[row].tolist())
        expected.add(max(((a, b) for a in corners for b in corners if a < b), key=length))
    assert {tuple(edge) for edge in edges} == expected
    assert np.allclose([length(edge) for edge in edges], sorted(map(length, expected), reverse=True))


@pytest.mark.parametrize("backend", BACKENDS)
def test_all_backends_adapt_alike(backend):
    nets = [box(48 if config.DISABLE_JIT else 384, name) for name in ("v3y", backend)]
    for net in nets:
        adaptive.fit(net)
        for _ in range(2):
            assert abs(adaptive.adapt(net)) < 1e-14
        assert net.check() == []
    first, second = (by_place(net, net.states[:, 0]) for net in nets)
    assert len(first) > 48
    assert np.allclose(first, second, rtol=0, atol=1e-12)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_round_that_fails_leaves_the_net_as_it_was(backend, monkeypatch):
    with box(48, backend) as net:
        adaptive.fit(net)
        adaptive.mark(net.storage)  # a round begins with it, and it is no edit
        before = net.refs, net.vertices, net.states
        halve, calls = adaptive.halve, []

        def fail_later(net, a, b):
            if calls:
                raise RuntimeError("broken on purpose")
            calls.append(len(net))
            halve(net, a, b)

        monkeypatch.setattr(adaptive, "halve", fail_later)
        with pytest.raises(RuntimeError, match="on purpose"):
            adaptive.adapt(net)
        assert calls == [len(before[0])]
        for array, was in zip((net.refs, net.vertices, net.states), before, strict=True):
            assert np.array_equal(array, was)
        assert net.check() == []


@COMPILED
def test_adaptation_beats_a_uniform_net_of_as_many_tetras():
    net = box(750, "v3y")
    adaptive.fit(net)
    for _ in range(4):
        adaptive.adapt(net)
    uniform = box(len(net), "v3y")
    adaptive.fit(uniform)
    assert adaptive.error_of(net) < 0.7 * adaptive.error_of(uniform)


# ---- a kernel of one's own


@pytest.mark.parametrize("backend", [contestant.name for contestant in CONTESTANTS])
def test_own_kernel_gives_the_answer_of_the_scenario(rng, backend):
    with box(48, backend) as net:
        net.states = rng.uniform(size=(len(net), 5))
        twin = net.copy()
        own_kernel.smooth(net.storage, 3)
        from tetrabench.scenarios.tetra.alfa import Alfa, Averaging

        Alfa().run(Averaging(twin, 3))
        assert net.answer().digest == twin.answer().digest


@pytest.mark.parametrize("backend", BACKENDS)
def test_njit_takes_generic_functions_too(rng, backend):
    """The same kernel under numba's decorator alone."""
    plain = getattr(own_kernel.copy_back, "py_func", own_kernel.copy_back)
    with box(48, backend) as net:
        net.states = states = rng.uniform(size=(len(net), 5))
        numba.njit(cache=False)(plain)(net.storage)
        assert np.array_equal(net.states[:, 0], states[:, 1])
        assert np.array_equal(net.states[:, 1:], states[:, 1:])


@pytest.mark.parametrize(
    ("interval", "said"),
    [((0.97, 1.03), "met"), ((1.0, 1.06), "cannot tell"), ((0.9, 1.0), "cannot tell"), ((1.06, 1.2), "**missed**")],
)
def test_verdicts_on_speed(interval, said):
    low, high = interval
    assert library.verdict({"low": low, "high": high, "met": library.is_met(low, high)}) == said


@COMPILED
def test_comparing_speeds(monkeypatch):
    monkeypatch.setattr(library, "SAMPLE_S", 1e-4)
    with box(48, "v3y") as net:
        net.states = np.ones((len(net), 5))
        row = library.compare(net, 6)
        assert row["low"] <= row["ratio"] <= row["high"]
        assert len(row["pairs_s"]) == 6
        monkeypatch.setattr(own_kernel, "smooth", lambda storage, sweeps: own_kernel.copy_back(storage))
        net.states = np.arange(5.0 * len(net)).reshape(-1, 5)
        with pytest.raises(ValueError, match="different answers"):
            library.compare(net, 6)


# ---- the page


def numbers(line):
    """The figures of a line; what rounding leaves of a sum is none of them."""
    return [float(number.replace(",", "")) for number in re.findall(r"(?<![\w.])\d[\d,]*\.?\d*(?:e-\d+)?", line)]


@COMPILED
@pytest.mark.parametrize("name", ["heat_conduction", "adaptive_refinement"])
def test_examples_print_what_the_page_says(name, capsys):
    shown = PAGE.split(f"docs/examples/{name}.py\n")[1].split("```")[0].splitlines()
    importlib.import_module(name).main([])
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) == len(shown)
    for line, said in zip(printed, shown, strict=True):
        one, other = (text.partition(", sum of")[0] for text in (line, said))
        assert re.sub(r"[\d.,e-]+", "", one) == re.sub(r"[\d.,e-]+", "", other)
        assert np.allclose(numbers(one), numbers(other), rtol=0.02)
        assert "sum of" not in line or abs(float(line.rpartition("changed by ")[2])) < 1e-12


@pytest.mark.parametrize("name", EXAMPLES)
def test_examples_take_any_backend(name, capsys, tmp_path):
    picture = [] if name == "own_kernel" else ["--picture", str(tmp_path / "picture.png")]
    size = ["--tets", "48"] + ["--rounds", "1"] * (name == "adaptive_refinement") + ["--sweeps", "1"] * (not picture)
    if name == "heat_conduction" and config.DISABLE_JIT:
        pytest.skip("takes minutes without the JIT")
    importlib.import_module(name).main(["--backend", "v5", *size, *picture])
    assert capsys.readouterr().out
    assert not picture or (tmp_path / "picture.png").stat().st_size > 10_000


def test_examples_are_short():
    for name in EXAMPLES:
        assert len((ROOT / "docs" / "examples" / f"{name}.py").read_text().splitlines()) <= 150


def test_the_page_runs(capsys, tmp_path, monkeypatch):
    # a kernel is cached by its file, so the parts become one
    parts = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    source = "\n".join(parts).replace("3072", "162" if config.DISABLE_JIT else "3072")
    (tmp_path / "library_page.py").write_text(source)
    monkeypatch.syspath_prepend(tmp_path)
    page = importlib.import_module("library_page")
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].endswith("volume 1.000")
    assert float(lines[2]) == 1.0
    assert float(lines[3]) == len(page.inlet) > 0
    assert lines[4].endswith("[]")
    assert abs(float(lines[4].split()[2])) < 1e-12
