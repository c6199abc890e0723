"""What the scenarios on tetrahedral nets share."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.protocols import Answer, Options
from tetrabench.scenarios.base import BaseScenario
from tetrabench.tetra.net import TetraNet


class TetraScenario(BaseScenario):
    """A workload on a net. Unless it says otherwise, what it works on is a net, and its answer is all of that net."""

    family = "tetra"

    def prepare(self, stage: Any, options: Options) -> Any:
        """A net for states only; a scenario that changes more asks for `stage.own_net()`."""
        return stage.net()

    def answer(self, subject: Any, outcome: Any) -> Answer:
        """The digest of the net."""
        net: TetraNet = subject
        return net.answer()


def at_most_half(net: TetraNet, wanted: int) -> int:
    """A count that a small model can bear: half of its tetras at most."""
    return min(wanted, len(net) // 2)


def first_refs(stage: Any, net: TetraNet, wanted: int) -> NDArray[np.int64]:
    """Refs (wanted,) int64 of the first tetras of the stage's net, in the order of the file.

    Where refs are stable, iteration keeps to that order until something is inserted; else no order can be relied on.
    """
    return net.refs[:wanted] if net.contestant.stable_refs else refs_in_order(net, stage.mesh.tets)[:wanted]


def refs_in_order(net: TetraNet, tets: NDArray[np.int32]) -> NDArray[np.int64]:
    """Refs (m,) int64 of those tetras `tets` (n, 4) that the net has, in the order of `tets`; found by their vertices."""
    refs, wanted = net.refs, np.sort(tets, axis=1)
    both = np.concatenate([np.sort(net.vertices, axis=1), wanted])
    order = np.lexsort(both.T)  # of two alike, the one of the net comes first
    alike = (both[order[1:]] == both[order[:-1]]).all(axis=1)
    found = np.full(len(tets), -1)
    found[order[1:][alike] - len(refs)] = order[:-1][alike]
    return refs[found[found >= 0]]
