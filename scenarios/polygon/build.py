"""build: store a mesh in the format, from plain cell lists: find what lies beyond each side, and write the format's arrays."""

from typing import Any

from tetrabench.polygon.net import PolygonNet
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.polygon.base import PolygonScenario


class Build(PolygonScenario):
    """From the cells' nodes, which lie in memory, to a net that can be asked."""

    name = "build"
    title = "store the mesh, from the lists of its cells' nodes"

    def prepare(self, stage: Any, options: Options) -> Any:
        """The stage, with the mesh read."""
        stage.model_size()
        return stage

    def run(self, stage: Any) -> PolygonNet:
        """Build."""
        return PolygonNet(stage.mesh, stage.contestant)

    def answer(self, stage: Any, net: PolygonNet) -> Answer:
        """All that the queries say of the net."""
        stage.adopt(net)
        return net.answer()

    def work(self, stage: Any, net: PolygonNet) -> Work:
        """Cells stored."""
        return Work(len(net), "cells")
