"""What a worker finds wrong with a contestant by a rule of its family; where it was when it could not tell any more."""

import faulthandler
import re
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path

from tetrabench.errors import InputError
from tetrabench.protocols import Contestant, Family
from tetrabench.traces import spell_error

MOST = 5
"""Sentences of one rule: whoever mends the first ones sees the others next time."""


def faults_of(family: Family, contestant: Contestant, rule: str) -> list[str]:
    """What is wrong with a contestant by a rule, MOST sentences at most; an exception is one of them.

    Raises:
        InputError: the family has no such rule.
    """
    for one in family.rules:
        if one.name == rule:
            break
    else:
        raise InputError(f"the family {family.name} has no rule '{rule}'")
    found: list[str] = []
    try:
        found.extend(islice(one.faults(contestant), MOST))
    except (MemoryError, KeyboardInterrupt):
        raise
    except BaseException as error:  # what a contestant raises, SystemExit too
        found.append(spell_error(error))
    return found


@contextmanager
def noted(notes: Path, patience_s: float) -> Iterator[None]:
    """Write into the file `notes` where this process is if it crashes, or is not done after `patience_s` seconds."""
    with notes.open("w") as file:
        faulthandler.enable(file)
        faulthandler.dump_traceback_later(patience_s, file=file)
        try:
            yield
        finally:
            faulthandler.cancel_dump_traceback_later()
            faulthandler.disable()


def place_of(notes: Path) -> str:
    """Where a process was by its notes: " in next_tetra (mine.py:71)"; "" where it left none."""
    try:
        text = notes.read_text(errors="replace")
    except OSError:
        return ""
    stacks = re.split(r"^(?:Current thread|Thread) .*$", text, flags=re.MULTILINE)[1:]
    marked = re.search(r"^Current thread", text, flags=re.MULTILINE)
    frames = re.findall(r'File "(.*)", line (\d+) in (.+)', stacks[0 if marked else -1]) if stacks else []
    if not frames:
        return ""
    file, line, function = frames[0]
    return f" in {function} ({Path(file).name}:{line})"
