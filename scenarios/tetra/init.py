"""init: read the file and build everything: geometry, side neighbours, incidence, search tree. Thesis, 5.2.1."""

from typing import Any

from tetrabench.io import read_mesh
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.tetra.base import TetraScenario
from tetrabench.tetra.net import TetraNet


class Init(TetraScenario):
    """From the file to a net that can be asked and changed."""

    name = "init"
    title = "read the file, build the net and all that belongs to it"

    def prepare(self, stage: Any, options: Options) -> Any:
        """The stage: it knows file and contestant."""
        return stage

    def run(self, stage: Any) -> TetraNet:
        """Read and build."""
        return TetraNet(read_mesh(stage.model), stage.contestant)

    def answer(self, stage: Any, net: TetraNet) -> Answer:
        """All of the net, with its initial states."""
        stage.adopt(net)
        return net.answer()

    def work(self, stage: Any, net: TetraNet) -> Work:
        """Tetras read and built."""
        return Work(len(net), "tetras")
