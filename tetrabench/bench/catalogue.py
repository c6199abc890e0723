"""What a family has to offer, as plain facts: a plan needs no more of it, and the parent of a run stays small.

To import a family is to import the compiler, and to generate a model is to hold it: a `Worker` does both for the verbs
(`Inquiry`), and keeps what that takes. A library call asks in its own process (`Registry`).
"""

import warnings
from collections.abc import Callable
from pathlib import Path
from types import TracebackType
from typing import Protocol

import msgspec

from tetrabench import registry
from tetrabench.bench.messages import (
    ContestantFacts,
    Describe,
    Described,
    Failed,
    Find,
    Found,
    Reply,
    Request,
    RuleFacts,
    ScenarioFacts,
)
from tetrabench.bench.spawn import WorkerDied, WorkerProcess
from tetrabench.errors import InputError, MemoryRefusedError, PluginWarning, TetrabenchError


class Guide(Protocol):
    """Knows families, and finds their models."""

    def describe(self, family: str) -> Described:
        """What a family has to offer. Raises InputError."""

    def find_model(self, find: Find) -> Found:
        """A model, which may have to be generated first. Raises InputError, MemoryRefusedError."""


class Registry:
    """A guide in this process."""

    def describe(self, family: str) -> Described:
        """What a family has to offer.

        Raises:
            InputError: there is none of that name.
        """
        kind = registry.family(family)
        found = Described(
            reference=kind.reference,
            thesis_order=list(kind.thesis_order),
            default_model=kind.default_model,
            size_option=kind.size_option,
            tour=kind.tour,
            contestants=[
                ContestantFacts(
                    name=one.name,
                    title=one.title,
                    extension=one.extension,
                    options=dict(one.options),
                    exact=one.is_exact,
                )
                for one in registry.contestants(family)
            ],
            scenarios=[
                ScenarioFacts(name=one.name, options=dict(one.options), thesis=dict(one.thesis), parallel=one.parallel)
                for one in registry.scenarios(family)
            ],
            rules=[RuleFacts(name=one.name, title=one.title, essential=one.essential) for one in kind.rules],
        )
        return msgspec.structs.replace(found, skipped=registry.skipped())

    def find_model(self, find: Find) -> Found:
        """A model: where it lies, and what it holds.

        Raises:
            InputError: there is no such file and no such model, or it cannot be used.
        """
        kind = registry.family(find.family)
        if find.model not in kind.models:
            is_file = Path(find.model).is_file()
            for other in registry.families():
                if not is_file and find.model in other.models:
                    raise InputError(f"{find.model} is a model of another family: add --family {other.name}")
                if is_file and other.name != find.family and other.kind and other.kind.holds(find.model):
                    raise InputError(f"{find.model} is a file of another family: add --family {other.name}")
        path = kind.find_model(find.model, size=find.size, numbering=find.numbering, seed=find.seed).absolute()
        facts = kind.describe_model(path)
        return Found(str(path), {name: int(number) for name, number in facts.size.items()}, list(facts.notes))


class Inquiry:
    """A guide that asks a worker. A context: the worker ends with it."""

    def __init__(self, spawn: Callable[[], WorkerProcess] = WorkerProcess) -> None:
        self._worker = spawn()

    def __enter__(self) -> "Inquiry":
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._worker.kill()

    def describe(self, family: str) -> Described:
        """What a family has to offer.

        Raises:
            InputError: there is none of that name.
        """
        reply = self._ask(Describe(family))
        assert isinstance(reply, Described), reply
        for sentence in reply.skipped:  # the worker itself keeps silent
            warnings.warn(f"skipped {sentence}", PluginWarning, stacklevel=2)
        return reply

    def find_model(self, find: Find) -> Found:
        """A model: where it lies, and what it holds.

        Raises:
            InputError: there is no such file and no such model, or it cannot be used.
            MemoryRefusedError: it is too large for the memory that there is.
        """
        reply = self._ask(find)
        assert isinstance(reply, Found), reply
        return reply

    def _ask(self, request: Request) -> Reply:
        try:
            reply = self._worker.ask(request)
        except WorkerDied as death:
            raise TetrabenchError(f"the process that looks up models and backends ended: {death}") from death
        if isinstance(reply, Failed):
            raise (MemoryRefusedError if reply.oom else InputError)(reply.reason)
        return reply
