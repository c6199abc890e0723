"""Usual mixes of work, by family: what `tetrabench recommend` ranks contestants for. Imports no scenario: help must not wait.

A mix says how often: in sweeps where a scenario consists of sweeps, else how many times what the scenario does;
"delete.deletions" counts in that count of the scenario.
"""

from tetrabench.protocols import Workload

TETRA = [
    Workload(
        name="simulation",
        title="steps in time on a net that changes a little on the way",
        mix={"init": 1, "alfa": 500, "flow": 500, "delete.deletions": 1000, "explode.splits": 500},
    ),
    Workload(
        name="refinement",
        title="a net that is refined and coarsened, with a few sweeps in between",
        mix={"init": 1, "explode": 2, "delete": 2, "alfa": 20},
    ),
    Workload(
        name="static",
        title="built once, then swept over and over",
        mix={"init": 1, "alfa": 500, "flow": 500},
    ),
    Workload(
        name="queries",
        title="built once, then asked where points lie and which tetras have a property",
        mix={"init": 1, "locate": 20, "select": 100},
    ),
]
