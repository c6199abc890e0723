"""Nothing that is read is run: no call that executes, unpickles or evaluates, but those in a table, each with its reason."""

import ast
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from tetrabench.collision.start.files import read_objects
from tetrabench.errors import InputError
from tetrabench.mesh.polygon.store import load_polygons

ROOT = Path(__file__).parents[1]
SOURCES = [path for folder in ("tetrabench", "backends", "scenarios") for path in sorted((ROOT / folder).rglob("*.py"))]

FORBIDDEN_CALLS = {"eval", "exec", "compile", "__import__"}
FORBIDDEN_MODULES = {
    *("pickle", "_pickle", "cPickle", "marshal", "shelve", "dill", "cloudpickle", "joblib", "dbm", "yaml", "code"),
    *("xml", "lxml", "imp", "runpy", "pty", "commands"),
}
FORBIDDEN_ATTRIBUTES = {
    *("os.system", "os.popen", "tempfile.mktemp", "np.fromregex", "pandas.eval", "pandas.read_pickle"),
    *("subprocess.getoutput", "subprocess.getstatusoutput", "pd.read_pickle", "shutil.unpack_archive"),
}
LOADERS = {"import_module", "exec_module", "spec_from_file_location", "module_from_spec"}

ALLOWED = {
    ("tetrabench/plugins.py", "exec_module"): "a plug-in is code, and that it runs is what it is named for",
    ("tetrabench/plugins.py", "spec_from_file_location"): "as above",
    ("tetrabench/plugins.py", "module_from_spec"): "as above",
    ("tetrabench/__init__.py", "import_module"): "the public face; names from a table in that file",
    (
        "tetrabench/jit/cache.py",
        "import_module",
    ): "packages of kernels, which have been imported already: to find their files",
}
"""(file, what) -> why it may be there."""


def faults(tree: ast.AST) -> Iterator[tuple[int, str]]:
    """The line of each thing that might execute what was read, and what it is."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, one.name) for one in node.names if one.name.split(".")[0] in FORBIDDEN_MODULES)
        elif isinstance(node, ast.ImportFrom):
            if not node.level and (node.module or "").split(".")[0] in FORBIDDEN_MODULES:
                yield node.lineno, node.module or ""
            for one in node.names:
                if one.name in FORBIDDEN_CALLS or f"{node.module}.{one.name}" in FORBIDDEN_ATTRIBUTES:
                    yield node.lineno, one.name
        elif isinstance(node, ast.Call):
            called = ast.unparse(node.func)
            last = called.rpartition(".")[2]
            if called in FORBIDDEN_CALLS | FORBIDDEN_ATTRIBUTES or called == "builtins.eval":
                yield node.lineno, called
            if last in LOADERS:
                yield node.lineno, last
            for keyword in node.keywords:
                is_false = isinstance(keyword.value, ast.Constant) and keyword.value.value is False
                if keyword.arg in ("shell", "allow_pickle") and not is_false:
                    yield node.lineno, keyword.arg
            if called in ("np.load", "numpy.load") and "allow_pickle" not in [one.arg for one in node.keywords]:
                yield node.lineno, "np.load that does not say allow_pickle=False"


def test_nothing_that_is_read_is_run():
    assert len(SOURCES) > 150
    used = set()
    for path in SOURCES:
        name = path.relative_to(ROOT).as_posix()
        for line, what in faults(ast.parse(path.read_text())):
            assert (name, what) in ALLOWED, f"{name}:{line}: {what}"
            used.add((name, what))
    assert used == set(ALLOWED), "the table has a row that nothing needs"


@pytest.mark.parametrize(
    "text",
    [
        *("eval('1')", "import pickle", "from marshal import loads", "np.load(f)", "np.load(f, allow_pickle=True)"),
        *("np.load(f, allow_pickle=x)", "subprocess.run('a', shell=True)", "os.system('a')", "tempfile.mktemp()"),
        *("from os import system", "import xml.etree", "builtins.eval('1')", "importlib.import_module(name)"),
    ],
)
def test_what_would_run_it_is_seen(text: str):
    assert list(faults(ast.parse(text)))


# ---------------------------------------------------------------------- archives of arrays


class Trap:
    """Says so when it is unpickled."""

    sprung: bool = False

    def __reduce__(self) -> tuple:
        return setattr, (Trap, "sprung", True)


@pytest.mark.parametrize("reader", [load_polygons, read_objects])
def test_no_object_in_an_archive_is_made(reader, tmp_path: Path):
    names = ("points", "starts", "nodes", "conditions", "report", "x", "y", "vx", "vy", "r", "m", "box", "source")
    trap = np.array([Trap()], dtype=object)
    np.savez(tmp_path / "trap.npz", allow_pickle=True, **dict.fromkeys(names, trap))
    with pytest.raises(InputError, match=r"trap\.npz: .*damaged"):
        reader(tmp_path / "trap.npz")
    assert not Trap.sprung
