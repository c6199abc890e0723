"""A plug-in whose truth is known: copies of v3y, some of which burn a known share of CPU time on top.

PYTHONPATH=.:tests/measuring/plugin tetrabench run --model nozzle --tets 30k --family injected
"""

import time
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple

from tetrabench import registry
from tetrabench.protocols import Options, Scenario
from tetrabench.tetra.family import TetraFamily

REFERENCE = "v3y"
SHARES: Mapping[str, float] = {
    REFERENCE: 0.0,
    "same-1": 0.0,
    "same-2": 0.0,
    "slower-10": 0.10,
    "slower-20": 0.20,
    "slower-30": 0.30,
}
"""Contestant -> the share of CPU time that it burns on top."""

NAMES = ("alfa", "flow", "locate", "deform", "explode")
"""The scenarios: two that read, one that searches, one that moves points, one that changes the net."""

FEW = NAMES[:2]
"""Those that pyperf is asked about: each costs it twenty processes a contestant."""


class Subject(NamedTuple):
    """What the scenario works on, and the share to burn."""

    own: Any
    share: float


@dataclass(frozen=True)
class Injected:
    """A tetra scenario that takes longer by a known share; every contestant runs this very code, with 0 or more."""

    scenario: Scenario
    family: ClassVar[str] = "injected"

    def __getattr__(self, name: str) -> Any:
        """All else is as the scenario has it."""
        return getattr(self.scenario, name)

    def prepare(self, stage: Any, options: Options) -> Subject:
        """What the scenario works on."""
        return Subject(self.scenario.prepare(stage, options), SHARES[stage.contestant.name])

    def run(self, subject: Subject) -> Any:
        """The workload, then the rest of its time."""
        begin = time.thread_time()
        outcome = self.scenario.run(subject.own)
        end = time.thread_time()
        burn(end + subject.share * (end - begin))
        return outcome

    def answer(self, subject: Subject, outcome: Any) -> Any:
        """The scenario's."""
        return self.scenario.answer(subject.own, outcome)

    def work(self, subject: Subject, outcome: Any) -> Any:
        """The scenario's."""
        return self.scenario.work(subject.own, outcome)


def burn(until: float) -> None:
    """Spend CPU time until the thread has had so much, seconds."""
    while time.thread_time() < until:
        pass


class InjectedFamily(TetraFamily):
    """Tetrahedral nets, stored in one way under several names."""

    name = "injected"
    reference = REFERENCE
    thesis_order = ()


FAMILY = InjectedFamily()
CONTESTANTS = [
    replace(
        registry.contestant("tetra", REFERENCE),
        name=name,
        title=f"{REFERENCE}, {share:.0%} slower" if share else f"{REFERENCE} once more",
        family="injected",
    )
    for name, share in SHARES.items()
]
SCENARIOS = [Injected(registry.scenario("tetra", name)) for name in NAMES]
