"""select: the tetras with a given property. From the thesis' assignment page."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.jit import kernel
from tetrabench.protocols import Answer, Work
from tetrabench.scenarios.tetra.base import TetraScenario
from tetrabench.tetra.digest import found_answer
from tetrabench.tetra.interface import (
    NONE,
    Net,
    first_tetra,
    next_tetra,
    number_of_tetras,
    side_area,
    state,
    volume,
)
from tetrabench.tetra.net import TetraNet

THRESHOLD = 0.5


class Select(TetraScenario):
    """Warm and slender: state 0 above a threshold, and a volume that is small for the largest side."""

    name = "select"
    title = "list the tetras with a given property: state above a threshold, and slender"

    def run(self, net: TetraNet) -> NDArray[np.int64]:
        """List them."""
        return select_warm_and_slender(net.storage, THRESHOLD)  # type: ignore[no-any-return]

    def answer(self, net: TetraNet, refs: NDArray[np.int64]) -> Answer:
        """Which tetras, in iteration order."""
        return found_answer(net.storage, refs)

    def work(self, net: TetraNet, refs: NDArray[np.int64]) -> Work:
        """Looked-at tetras."""
        return Work(len(net), "tetras")


@kernel
def select_warm_and_slender(net: Net, threshold: float) -> Any:
    """Refs (m,) int64 of the tetras with state 0 above `threshold` and 3.5 V < S^(3/2), S the largest side's area."""
    refs = np.empty(number_of_tetras(net), np.int64)
    n = 0
    cursor = first_tetra(net)
    while cursor.tetra != NONE:
        t = cursor.tetra
        if state(net, t, 0) > threshold:
            largest = 0.0
            for i in range(4):
                largest = max(largest, side_area(net, t, i))
            if 3.5 * volume(net, t) < largest * np.sqrt(largest):
                refs[n] = t
                n += 1
        cursor = next_tetra(net, cursor)
    return refs[:n].copy()
