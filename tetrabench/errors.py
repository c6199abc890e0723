"""What can go wrong for a person, with the exit code the command line gives it."""

import difflib
from collections.abc import Mapping
from typing import TypeVar

_Member = TypeVar("_Member")


class TetrabenchError(Exception):
    """One clear line for a person: what is wrong and what to do next. Never a traceback."""

    exit_code = 2


class InputError(TetrabenchError):
    """A file, mesh or option that cannot be taken. Files are named as `path:line: reason`."""

    exit_code = 2


class RepairableError(InputError):
    """A mesh whose faulty tetras can be left out: `--repair drop` does that."""


class UnsupportedError(TetrabenchError):
    """What a scenario cannot do with a contestant, or with a model: no fault of either."""


class NotComparableError(TetrabenchError):
    """Two runs, or two revisions, that say nothing about each other."""

    exit_code = 5


class PluginWarning(UserWarning):
    """A plug-in, or a part of it, that is broken and has been skipped."""


class MemoryRefusedError(InputError):
    """What needs more memory than there is, refused before the memory is gone."""

    exit_code = 6


def refuse_name(contestant: object, family: str) -> None:
    """Refuse the name of a contestant where the contestant itself is needed.

    Raises:
        InputError: it is one; says how to get the other.
    """
    if isinstance(contestant, str):
        there = f"tetrabench.contestant({family!r}, {contestant!r})"
        raise InputError(f"a contestant is needed, not its name {contestant!r}: take {there}")


def find_named(kind: str, known: Mapping[str, _Member], name: str, among: str = "") -> _Member:
    """Look up a name that a person typed; `kind` says what it is the name of, `among` where it was looked for.

    Raises:
        InputError: there is none of that name; says which there are, and which of them is meant where one is close.
    """
    if name in known:
        return known[name]
    near = difflib.get_close_matches(name.lower(), known, n=1)
    hint = f"did you mean '{near[0]}'? " if near else ""
    where = f" {among}" if among else ""
    raise InputError(f"no {kind} '{name}'{where}; {hint}there are: {', '.join(known) or 'none'}")
