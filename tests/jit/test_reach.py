"""What functions are made from: modules and constants, the same in every process."""

import subprocess
import sys

CODE = """
from tetrabench.jit.reach import reach
import mine
modules, constants = reach([mine.function])
print(sorted(modules))
print(*sorted(constants), sep="\\n")
"""
MINE = """
import theirs
WHAT = (theirs.first, (2, (0.5, "a")), ())
def function(x):
    return WHAT
"""
THEIRS = """
import numpy as np
SCALE = np.float64(3.0)
def first(x):
    return SCALE * x
"""


def told(folder, **files):
    for name, text in files.items():
        (folder / f"{name}.py").write_text(text)
    done = subprocess.run([sys.executable, "-B", "-c", CODE], cwd=folder, capture_output=True, text=True, check=True)
    modules, *constants = done.stdout.splitlines()
    return modules, constants


def test_tuples_are_looked_into(tmp_path):
    modules, constants = told(tmp_path, mine=MINE, theirs=THEIRS)
    assert modules == "['mine', 'theirs']"
    assert constants == [
        "SCALE float64 np.float64(3.0)",
        "WHAT[1][0] int 2",
        "WHAT[1][1][0] float 0.5",
        "WHAT[1][1][1] str 'a'",
        "WHAT[1][1][2] int 2",
        "WHAT[1][2] int 2",
        "WHAT[2][0] int 0",
        "WHAT[3] int 3",
    ]
    assert told(tmp_path) == (modules, constants)  # no address is among them, which would be another each time


def test_an_order_is_a_difference(tmp_path):
    one, other = (
        told(tmp_path, mine=f"W = {value}\ndef function(x):\n    return W\n") for value in ("(1, 2)", "(2, 1)")
    )
    assert one != other
