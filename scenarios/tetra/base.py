"""What the scenarios on tetrahedral nets share."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

from tetrabench.protocols import Answer, Options, Work
from tetrabench.tetra.net import TetraNet


class TetraScenario(ABC):
    """A workload on a net: prepare (untimed), run (the only timed line), answer and work (untimed).

    Unless it says otherwise, what it works on is a net, and its answer is all of that net.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    family = "tetra"
    options: ClassVar[Mapping[str, int]] = {}
    thesis: ClassVar[Mapping[str, int]] = {}
    parallel: ClassVar[bool] = False

    def skip(self, contestant: Any) -> str | None:
        """Nothing here asks for more than the interface gives."""
        return None

    def prepare(self, stage: Any, options: Options) -> Any:
        """A net for states only; a scenario that changes more asks for `stage.own_net()`."""
        return stage.net()

    @abstractmethod
    def run(self, subject: Any) -> Any:
        """The workload."""

    def answer(self, subject: Any, outcome: Any) -> Answer:
        """The digest of the net."""
        net: TetraNet = subject
        return net.answer()

    @abstractmethod
    def work(self, subject: Any, outcome: Any) -> Work:
        """How much was done."""


def at_most_half(net: TetraNet, wanted: int) -> int:
    """A count that a small model can bear: half of its tetras at most."""
    return min(wanted, len(net) // 2)
