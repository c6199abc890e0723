"""What all scenarios share, of whatever family."""

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import Any, ClassVar

from tetrabench.protocols import Answer, Options, Work


class BaseScenario(ABC):
    """A workload: prepare (untimed), run (the only timed line), answer and work (untimed). See protocols.Scenario."""

    name: str
    title: str
    family: ClassVar[str]
    options: ClassVar[Mapping[str, int]] = {}
    thesis: ClassVar[Mapping[str, int]] = {}
    parallel: ClassVar[bool] = False

    def skip(self, contestant: Any) -> str | None:
        """Most ask for no more than the interface gives."""
        return None

    @abstractmethod
    def prepare(self, stage: Any, options: Options) -> Any:
        """What `run` works on."""

    @abstractmethod
    def run(self, subject: Any) -> Any:
        """The workload."""

    @abstractmethod
    def answer(self, subject: Any, outcome: Any) -> Answer:
        """What was found."""

    @abstractmethod
    def work(self, subject: Any, outcome: Any) -> Work:
        """How much was done."""
