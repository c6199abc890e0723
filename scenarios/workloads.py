"""Usual mixes of work, by family: what `tetrabench recommend` ranks contestants for. Imports no scenario: help must not wait.

A mix says how often: in sweeps where a scenario consists of sweeps, else how many times what the scenario does;
"delete.deletions" counts in that count of the scenario.
"""

from tetrabench.protocols import Workload

COLLISION = [
    Workload(
        name="gas",
        title="built once, then many steps of objects that stay spread",
        mix={"build": 1, "motion.steps": 10_000},
    ),
    Workload(
        name="granular",
        title="built once, then many steps under gravity, until all lies at the bottom",
        mix={"build": 1, "gravity.steps": 10_000},
    ),
    Workload(
        name="game",
        title="built once, then steps with all contacts, and a hundred rectangles asked for in each",
        mix={"build": 1, "impulses.steps": 1_000, "windows.queries": 100_000},
    ),
    Workload(
        name="once",
        title="built for one question: which objects touch",
        mix={"build": 1, "motion.steps": 1},
    ),
]

POLYGON = [
    Workload(
        name="lagrangian",
        title="built once, then steps of a Lagrangian gas: a sum around each node, and one around each cell",
        mix={"build": 1, "gasdynamics": 500},
    ),
    Workload(
        name="finite-volume",
        title="built once, then sweeps over cells: their nodes and what lies beyond their sides",
        mix={"build": 1, "cell-nodes": 500, "cell-neighbours": 500},
    ),
    Workload(
        name="smoothing",
        title="built once, then sweeps over nodes: their neighbours and the cells around them",
        mix={"build": 1, "node-neighbours": 500, "node-cells": 500},
    ),
    Workload(
        name="queries",
        title="built once, then asked here and there, each query as often",
        mix={
            "build": 1,
            "random-cell-nodes": 100,
            "random-cell-neighbours": 100,
            "random-node-cells": 100,
            "random-node-neighbours": 100,
        },
    ),
]

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
