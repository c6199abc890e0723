"""free: give everything back. Thesis, 5.2.1."""

import weakref
from typing import Any, NamedTuple

import numpy as np

from tetrabench.jit.mix import mixed_with
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.tetra.base import TetraScenario
from tetrabench.tetra.net import TetraNet


class Release(NamedTuple):
    """A net that is to go, how many tetras it has, and weak references to its arrays, to see that they have gone."""

    net: TetraNet
    tetras: int
    arrays: list[weakref.ref[np.ndarray[Any, Any]]]


class Free(TetraScenario):
    """Release the whole net: arrays at once, linked nodes one by one."""

    name = "free"
    title = "release the whole net"

    def prepare(self, stage: Any, options: Options) -> Release:
        """A net of its own."""
        net = stage.own_net()
        arrays = [weakref.ref(array) for part in net.storage for array in part if isinstance(array, np.ndarray)]
        return Release(net, len(net), arrays)

    def run(self, release: Release) -> None:
        """Give it back."""
        release.net.close()

    def answer(self, release: Release, outcome: None) -> Answer:
        """That nothing is left."""
        left = sum(array() is not None for array in release.arrays)
        return Answer(mixed_with(0, release.tetras, left), {"tetras": release.tetras, "buffers_left": left})

    def work(self, release: Release, outcome: None) -> Work:
        """Released tetras."""
        return Work(release.tetras, "tetras")
