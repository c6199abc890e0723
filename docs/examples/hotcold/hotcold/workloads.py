"""reconstruction: what a finite volume code of second order is busy with. Imports no scenario: help must not wait."""

from tetrabench.protocols import Workload

WORKLOADS = [
    Workload(
        name="reconstruction",
        title="built once, then in every step a gradient in each tetra and a flow through its sides",
        mix={"init": 1, "gradient": 500, "flow": 500},
    )
]
