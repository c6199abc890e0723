"""The example of a plug-in, docs/examples/hotcold, and what `tetrabench new` writes, installed as a person installs them.

The environment is one of its own: tetrabench is in it as a wheel, without the checkout; what tetrabench needs is linked from
the environment of the tests, which saves the time and the network that installing it again would take.
"""

import json
import re
import sys
from collections.abc import Callable
from importlib.metadata import distribution
from pathlib import Path
from subprocess import CompletedProcess

import numpy as np
import pytest
from numba import config

from tests.packaging.environments import ROOT, copy_sources, link, make_environment, needed
from tests.packaging.environments import run as run_program
from tests.test_cli_new import PLAIN_RULES
from tetrabench import registry
from tetrabench.mesh.models import generate
from tetrabench.mesh.quality import signed_volumes
from tetrabench.tetra.net import TetraNet

EXAMPLE = ROOT / "docs" / "examples" / "hotcold"
COMPILED = pytest.mark.skipif(bool(config.DISABLE_JIT), reason="runs workers, which take minutes without the JIT")
pytestmark = pytest.mark.xdist_group("contributing")

Say = Callable[..., CompletedProcess[str]]


# ---- in an environment of its own


@pytest.fixture(scope="module")
def programs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An environment with the wheel of tetrabench and, for the report, its extra; and with the example."""
    folder = tmp_path_factory.mktemp("contributing")
    programs = make_environment(folder / "venv", Path(sys.executable), "--without-pip")
    link(programs, needed("tetrabench") | {"setuptools": distribution("setuptools")})
    for extra in ("jinja2", "vl-convert-python"):
        link(programs, {extra: distribution(extra)} | needed(extra))
    add(programs, copy_sources(folder / "tetrabench"))
    add(programs, folder / "tetrabench" / EXAMPLE.relative_to(ROOT))
    return programs


def add(programs: Path, source: Path) -> None:
    """Install a folder."""
    words = ("install", "--quiet", "--no-deps", "--no-build-isolation", source)
    done = run_program([sys.executable, "-m", "pip", "--python", programs / "python", *words], programs)
    assert done.returncode == 0, done.stderr


@pytest.fixture
def say(programs: Path, tmp_path: Path) -> Say:
    """say(words..., beside=FOLDER): what its tetrabench answers; beside: a folder with more distributions."""

    def ask(*words: object, beside: Path | None = None, code: int = 0) -> CompletedProcess[str]:
        more = {"PYTHONPATH": str(beside)} if beside else {}
        done = run_program([programs / "tetrabench", *map(str, words)], tmp_path, {"COLUMNS": "200"} | more)
        assert done.returncode == code, done.stdout + done.stderr
        return done

    return ask


def test_it_is_not_the_checkout(programs: Path, tmp_path: Path) -> None:
    code = "import hotcold, tetrabench; print(hotcold.__file__, tetrabench.__file__)"
    files = run_program([programs / "python", "-c", code], tmp_path).stdout.split()
    assert len(files) == 2
    assert all(Path(file).is_relative_to(programs.parent) for file in files)


@pytest.mark.parametrize(("what", "name"), [("backends", "hotcold*"), ("scenarios", "gradient"), ("models", "column")])
def test_it_is_listed(say: Say, what: str, name: str) -> None:
    done = say("list", what)
    assert name in [line.split()[0] for line in done.stdout.splitlines() if line]
    assert done.stderr == ""


def test_its_contestant_keeps_to_the_rules_in_plain_python(programs: Path, tmp_path: Path) -> None:
    command = [programs / "python", "-c", PLAIN_RULES, "hotcold", "tetra"]
    done = run_program(command, tmp_path, {"NUMBA_DISABLE_JIT": "1"})
    assert done.returncode == 0, done.stderr
    faults = json.loads(done.stdout)
    assert len(faults) > 5
    assert not any(faults.values()), faults


@COMPILED
def test_it_takes_part_in_run_report_and_recommend(say: Say, tmp_path: Path) -> None:
    what = ("--model", "column", "--tets", 2000, "--backend", "v3y,hotcold", "--scenario", "init,flow,gradient")
    say("run", *what, "--launches", 1, "--rounds", 1, "-o", "out.json")
    samples = json.loads((tmp_path / "out.json").read_text())["samples"]
    for scenario in ("init", "flow", "gradient"):
        answers = {(s["backend"], s["status"], s["digest"]) for s in samples if s["task"] == scenario}
        assert len(answers) == 3  # the control too
        assert {status for _, status, _ in answers} == {"ok"}
        assert len({digest for _, _, digest in answers}) == 1
    say("report", "out.json", "-o", "out.html")
    page = (tmp_path / "out.html").read_text()
    assert all(name in page for name in ("hotcold*", "gradient", "column"))
    assert "hotcold" in say("recommend", "out.json", "--workload", "reconstruction").stdout
    assert "reconstruction" in say("recommend", "out.json").stdout


def test_the_beginning_that_the_wheel_writes_is_installed(programs: Path, say: Say, tmp_path: Path) -> None:
    say("new", "contestant", "zebra", "--family", "collision")
    add(programs, tmp_path / "zebra")
    try:
        done = say("list", "backends", "--family", "collision")
        assert "zebra*" in [line.split()[0] for line in done.stdout.splitlines() if line]
        assert "'zebra' already" in say("new", "contestant", "zebra", "-o", "other", code=2).stderr
    finally:
        words = ("uninstall", "--quiet", "--yes", "zebra")
        run_program([sys.executable, "-m", "pip", "--python", programs / "python", *words], programs)


BROKEN = {
    "broken": ("import no_such_thing", "cannot import broken_table:CONTESTANTS: ModuleNotFoundError: No module named"),
    "rubbish": ("CONTESTANTS = [None, 7]", "one of its contestants, a NoneType, is none"),
    "usurper": (
        "from hotcold.records import CONTESTANTS",
        "the contestant 'hotcold' is defined twice; that of hotcold is taken",
    ),
}


@pytest.fixture
def beside(tmp_path: Path) -> Path:
    """Distributions as they lie there once they are installed, each broken in its way."""
    folder = tmp_path / "beside"
    for name, (text, _) in BROKEN.items():
        facts = folder / f"{name}-1.dist-info"
        facts.mkdir(parents=True)
        (facts / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1\n")
        (facts / "entry_points.txt").write_text(f"[tetrabench.contestants]\ntetra = {name}_table:CONTESTANTS\n")
        (folder / f"{name}_table.py").write_text(text)
    return folder


def test_broken_plug_ins_beside_it_are_named_and_skipped(say: Say, beside: Path) -> None:
    done = say("list", "backends", beside=beside)
    assert "hotcold*" in done.stdout
    assert "v3y" in done.stdout
    for name, (_, reason) in BROKEN.items():
        assert re.search(rf"^tetrabench: skipped plug-in {name}: {re.escape(reason)}", done.stderr, re.MULTILINE), name
    assert "Traceback" not in done.stderr


@COMPILED
def test_a_run_goes_on_without_broken_plug_ins(say: Say, beside: Path) -> None:
    words = ("--model", "column", "--tets", 2000, "--backend", "v3y,hotcold", "--scenario", "flow")
    done = say("check", *words, beside=beside)
    assert "hotcold" in done.stdout
    assert all(f"skipped plug-in {name}: " in done.stderr for name in BROKEN)


# ---- what is in it


@pytest.fixture
def example(monkeypatch: pytest.MonkeyPatch) -> None:
    """The example's modules can be imported."""
    monkeypatch.syspath_prepend(EXAMPLE)


@pytest.mark.usefixtures("example")
@pytest.mark.parametrize("wanted", [1, 60, 500, 7000])
def test_the_column_is_a_column(wanted: int) -> None:
    from hotcold.column import MODELS

    (model,) = MODELS
    mesh = generate(model, wanted)
    low, high = mesh.points.min(axis=0), mesh.points.max(axis=0)
    assert signed_volumes(mesh.points, mesh.tets).min() > 0
    np.testing.assert_allclose(low, 0, atol=1e-12)
    np.testing.assert_allclose(high[:2], 1)
    np.testing.assert_allclose(signed_volumes(mesh.points, mesh.tets).sum(), high[2])
    if wanted >= 500:
        assert abs(len(mesh.tets) - wanted) <= 0.02 * wanted
        assert 8 < high[2] < 12


@pytest.mark.usefixtures("example")
@pytest.mark.parametrize("backend", ["v3y", "hotcold"])
def test_the_gradient_is_that_of_numpy_and_exact_where_the_field_is_linear(
    backend: str, rng: np.random.Generator
) -> None:
    from hotcold.gradient import find_gradients
    from hotcold.records import CONTESTANTS

    contestant = CONTESTANTS[0] if backend == "hotcold" else registry.contestant("tetra", backend)
    net = TetraNet(generate("box", 162, seed=1), contestant)
    place = {t: row for row, t in enumerate(net)}
    slope = np.array([2.0, -3.0, 0.5])
    inner = np.array([sum(t >= 0 for t in around) >= 3 for around in net.neighbours])
    assert 0 < inner.sum() < len(net)
    for field, atol in ((net.centroids @ slope + 7.0, 1e-9), (rng.uniform(size=len(net)), np.inf)):
        states = np.zeros((len(net), 5))
        states[:, 0], states[:, 4] = field, 11.0
        net.states = states
        find_gradients(net.storage, 2)
        found = net.states
        np.testing.assert_array_equal(found[:, [0, 4]], states[:, [0, 4]])
        assert np.abs(found[inner, 1:4] - slope).max() <= atol
        for row, around in enumerate(net.neighbours):
            others = [place[t] for t in around if t >= 0]
            wanted = np.zeros(3)
            if len(others) >= 3:
                differences = net.centroids[others] - net.centroids[row]
                wanted = np.linalg.lstsq(differences, field[others] - field[row], rcond=None)[0]
            np.testing.assert_allclose(found[row, 1:4], wanted, rtol=1e-6, atol=1e-7)
    net.close()


def test_contributing_points_to_it() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text()
    for target in re.findall(r"\]\((docs/examples/[^)]*)\)", text):
        assert (ROOT / target).is_file(), target
    assert "(docs/examples/hotcold/README.md)" in text
    named = re.findall(r"`(hotcold/[\w.]+)`", (EXAMPLE / "README.md").read_text())
    assert {f"hotcold/{path.name}" for path in (EXAMPLE / "hotcold").glob("[a-z]*.py")} == set(named)
