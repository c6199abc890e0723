"""The kernel cache's three traps, each sprung on purpose, in processes of their own."""

import json
import os
import subprocess
import sys
import textwrap
from concurrent.futures import ThreadPoolExecutor

import pytest
from numba import config

pytestmark = pytest.mark.skipif(bool(config.DISABLE_JIT), reason="there is no cache without the JIT")

OUTER = """
import sys
from tetrabench.jit import kernel
from plugin.storage import Box, value

@kernel
def outer(net):
    return value(net) + 1.0
"""

STORAGE = """
from typing import NamedTuple
import numpy as np
from tetrabench.jit import generic, implements

class Box(NamedTuple):
    numbers: np.ndarray

class Net(NamedTuple):
    part: Box

@generic(on="part")
def value(net):
    "A number."

@implements(value, Box)
def _(net):
    return net.part.numbers[{index}] * {factor}
"""

MAIN = """
import json, numpy as np
from plugin.outer import outer
from plugin.storage import Box, Net
answer = outer(Net(Box(np.arange(3.0))))
print(json.dumps([answer, sum(outer.stats.cache_hits.values()), sum(outer.stats.cache_misses.values())]))
"""


@pytest.fixture
def plugin(tmp_path):
    """A package with a storage of its own, and a way to run it in a fresh process: (answer, hits, misses)."""
    package = tmp_path / "plugin"
    package.mkdir()
    (package / "__init__.py").write_text("")
    (package / "outer.py").write_text(OUTER)

    def write(factor=10.0, index=1):
        (package / "storage.py").write_text(STORAGE.format(factor=factor, index=index))

    def run(**environment):
        environment = {
            **os.environ, "PYTHONPATH": str(tmp_path), "TETRABENCH_CACHE": str(tmp_path / "cache"),
            "PYTHONDONTWRITEBYTECODE": "1", **environment,
        }  # fmt: skip
        done = subprocess.run([sys.executable, "-c", MAIN], env=environment, capture_output=True, text=True)
        return json.loads(done.stdout) if done.returncode == 0 else done.stderr

    write()
    return write, run


def test_a_change_in_another_file_recompiles(plugin):
    write, run = plugin
    assert run() == [11.0, 0, 1]
    assert run() == [11.0, 1, 0]
    write(factor=20.0)
    assert run() == [21.0, 0, 1]


SHARED = """
from typing import Any, NamedTuple
from tetrabench.jit import generic, kernel

class Net(NamedTuple):
    part: Any

@generic(on="part")
def value(net):
    "A number."

@kernel
def outer(net):
    return value(net)
"""

OWN = """
from typing import NamedTuple
import numpy as np
from tetrabench.jit import implements
from shared import value

class Box(NamedTuple):
    numbers: np.ndarray

@implements(value, Box)
def _(net):
    return net.part.numbers[1]
"""

LOADED_AS = """
import importlib.util, sys
import numpy as np
from shared import Net, outer
name, file = sys.argv[1:]
spec = importlib.util.spec_from_file_location(name, file)
own = sys.modules[name] = importlib.util.module_from_spec(spec)
spec.loader.exec_module(own)
print(outer(Net(own.Box(np.arange(3.0)))))
"""


def test_one_file_under_two_names(tmp_path):
    """As a plug-in file that `--plugin` names, and as a module: entries know classes by the names of their modules."""
    (tmp_path / "shared.py").write_text(SHARED)
    (tmp_path / "own.py").write_text(OWN)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "TETRABENCH_CACHE": str(tmp_path / "cache")}
    for name in ("own", "own_by_another_name", "own"):
        words = [sys.executable, "-c", LOADED_AS, name, str(tmp_path / "own.py")]
        done = subprocess.run(words, env=environment, capture_output=True, text=True)
        assert done.stdout == "1.0\n", done.stderr


HELPERS = "from numba import njit\nimport deeper\n\nFACTOR = {factor}\n\n@njit\ndef scaled(x):\n    return deeper.shifted(x)\n"

DEEPER = "from numba import njit\n\n@njit\ndef shifted(x):\n    return x + {shift}\n"

OWN_KERNEL = """
import helpers
from helpers import FACTOR, scaled
from tetrabench.jit import kernel
OFFSET = {offset}

@kernel
def own(x):
    return scaled(x) * FACTOR + helpers.FACTOR + OFFSET

if __name__ == "__main__":
    print(own(1.0), sum(own.stats.cache_misses.values()))
"""


def test_what_an_own_kernel_names_in_other_files_recompiles(tmp_path):
    """Functions, functions that these call, and constants; whether imported by name or through their module."""
    environment = {**os.environ, "TETRABENCH_CACHE": str(tmp_path / "cache"), "PYTHONDONTWRITEBYTECODE": "1"}

    def run(factor, shift, offset):
        (tmp_path / "helpers.py").write_text(HELPERS.format(factor=factor))
        (tmp_path / "deeper.py").write_text(DEEPER.format(shift=shift))
        (tmp_path / "own.py").write_text(OWN_KERNEL.format(offset=offset))
        words = [sys.executable, str(tmp_path / "own.py")]
        done = subprocess.run(words, env=environment, capture_output=True, text=True)
        assert done.returncode == 0, done.stderr
        answer, compiled = done.stdout.split()
        assert float(answer) == (1.0 + shift) * factor + factor + offset
        return int(compiled)

    assert [run(2.0, 3.0, 5.0), run(2.0, 3.0, 5.0)] == [1, 0]
    assert [run(7.0, 3.0, 5.0), run(7.0, 4.0, 5.0), run(7.0, 4.0, 6.0), run(7.0, 4.0, 6.0)] == [1, 1, 1, 0]


def test_a_helper_beside_a_storage_recompiles(tmp_path):
    """An implementation calls what lies in another file than its class."""
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "TETRABENCH_CACHE": str(tmp_path / "cache")}
    environment["PYTHONDONTWRITEBYTECODE"] = "1"
    (tmp_path / "shared.py").write_text(SHARED)
    (tmp_path / "own.py").write_text(OWN.replace("numbers[1]", "numbers[deeper.shifted(0)]") + "\nimport deeper\n")
    for shift in (0, 2):
        (tmp_path / "deeper.py").write_text(DEEPER.format(shift=shift))
        words = [sys.executable, "-c", LOADED_AS, "own", str(tmp_path / "own.py")]
        done = subprocess.run(words, env=environment, capture_output=True, text=True)
        assert done.stdout == f"{shift}.0\n", done.stderr


def test_flags_have_caches_of_their_own(plugin):
    write, run = plugin
    write(index=3)  # one beyond the end
    run()  # warm, without bounds checks
    assert "IndexError" in run(NUMBA_BOUNDSCHECK="1")
    write(index=1)
    assert run(NUMBA_OPT="1") == [11.0, 0, 1]
    assert run(NUMBA_OPT="3") == [11.0, 0, 1]
    assert run(NUMBA_OPT="3") == [11.0, 1, 0]


def test_a_cache_that_cannot_be_written_is_no_reason_to_stop(plugin, tmp_path):
    _, run = plugin
    (tmp_path / "no-folder").write_text("a file where the folder should be")
    assert run(TETRABENCH_CACHE=str(tmp_path / "no-folder" / "cache")) == [11.0, 0, 1]


def test_what_is_typed_in_is_compiled_and_not_kept(plugin, tmp_path):
    """As in a notebook: no file tells that the kernel has changed, and numba's key knows no constants."""
    code = OUTER.replace("+ 1.0", "+ {number}") + MAIN.replace("from plugin.outer import outer\n", "")
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "TETRABENCH_CACHE": str(tmp_path / "cache")}
    for number in (1.0, 2.0):
        command = [sys.executable, "-c", code.format(number=number)]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, cwd=tmp_path)
        assert done.stderr == ""
        assert json.loads(done.stdout)[0] == 10.0 + number
    assert not list((tmp_path / "cache").rglob("*.nbc"))


def test_users_own_kernels_stay_where_they_are(plugin):
    """No process-wide setting of numba is touched."""
    code = "import tetrabench.jit, numba; print(numba.config.CACHE_DIR, numba.config.CACHE_LOCATOR_CLASSES)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    plain = code.replace("tetrabench.jit, ", "")
    assert (
        done.stdout == subprocess.run([sys.executable, "-c", plain], capture_output=True, text=True, check=True).stdout
    )


MANY = """
import json, sys, numpy as np
from tetrabench.jit import count_compiled, kernels
from tetrabench import registry
from tetrabench.tetra.net import TetraNet
from tests.meshes import pair
net = TetraNet(pair(), registry.contestant("tetra", sys.argv[1]))
answer = net.answer().digest
used = [k for k in kernels() if k.signatures]
hits = sum(sum(k.stats.cache_hits.values()) for k in used)
print(json.dumps([answer, hits, count_compiled()]))
"""


def test_workers_that_all_start_cold_lose_nothing(tmp_path):
    """Two processes for each of three contestants compile at once; afterwards everything is found, and right."""
    names = ["v3y", "v5", "v4"] * 2

    def run(name):
        environment = {**os.environ, "TETRABENCH_CACHE": str(tmp_path)}
        command = [sys.executable, "-c", textwrap.dedent(MANY), name]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
        return json.loads(done.stdout)

    with ThreadPoolExecutor(len(names)) as pool:
        cold = list(pool.map(run, names))
        warm = list(pool.map(run, names))
    assert len({answer for answer, _, _ in cold + warm}) == 1
    assert all(misses == 0 and hits > 0 for _, hits, misses in warm)
    # each kernel was compiled once, by one of the two: the other waited for it and found it
    compiled = sum(misses for _, _, misses in cold)
    assert compiled <= sum(hits + misses for _, hits, misses in cold) / 2 + len(names)
