"""The public face: what it holds is on a page that is frozen, typed, and imported on first use."""

import subprocess
import sys

import pytest
from numba import config

import tetrabench
from tests import public_api
from tetrabench.errors import InputError


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="a kernel is a plain function then, and looks like one")
def test_the_page_is_that_of_the_code():
    page = public_api.page()
    assert page == public_api.PAGE.read_text(), "the public API changed: python -m tests.public_api, and CHANGELOG.md"
    rows = [row for row in page.split("## Plug-ins")[0].splitlines() if row.lstrip().startswith("- ")]
    assert [row for row in rows if "`: " not in row] == []


def test_it_says_that_it_is_typed():
    assert (public_api.PAGE.parents[2] / "tetrabench" / "py.typed").is_file()  # of a wheel, see test_packaging


def test_every_name_is_there_and_nothing_else_is():
    for name in tetrabench.__all__:
        assert getattr(tetrabench, name) is not None
        assert name in dir(tetrabench)
    assert set(tetrabench._HOMES) | {"open", "__version__"} == set(tetrabench.__all__)
    with pytest.raises(AttributeError, match="has no attribute 'opne'"):
        _ = tetrabench.opne


def test_importing_it_costs_next_to_nothing():
    code = "import sys, tetrabench; print(sorted({'numpy', 'numba', 'scipy', 'pandas'} & set(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


SCRIPT = """
import numpy as np
import tetrabench

net: tetrabench.TetraNet = tetrabench.open("nozzle.nas", backend="v3y")
with net.edit() as same:
    same.split(net.refs[:3])
volume: float = float(net.volumes.sum())
names: list[str] = net.check()
other: tetrabench.TetraNet = net.convert("v5")
refs: np.ndarray = net.locate([[0.0, 0.0, 0.0]])
wrong: str = net.last
"""


def test_a_script_of_a_user_is_type_checked(tmp_path):
    """The one wrong line is found, and no other."""
    (tmp_path / "script.py").write_text(SCRIPT)
    command = [sys.executable, "-m", "mypy", "--follow-imports=silent", "--cache-dir", tmp_path / "cache", "script.py"]
    root = public_api.PAGE.parents[2]
    done = subprocess.run(
        [str(word) for word in command],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        env={**__import__("os").environ, "MYPYPATH": str(root)},
    )
    assert done.stdout.splitlines()[0].startswith("script.py:12: error: Incompatible types in assignment"), done.stdout
    assert "Found 1 error" in done.stdout


@pytest.mark.parametrize(
    "make",
    [
        lambda: tetrabench.TetraNet(tetrabench.generate("box", 6), "v3y"),
        lambda: tetrabench.PolygonNet(tetrabench.generate_polygons("quad", 9), "by-edge"),
        lambda: tetrabench.Simulation(tetrabench.generate_objects("uniform", 9), "grid"),
    ],
)
def test_a_name_is_no_contestant(make):
    with pytest.raises(InputError, match=r"a contestant is needed, not its name '.*': take tetrabench.contestant\('"):
        make()
