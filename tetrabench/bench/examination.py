"""What a worker finds wrong with a contestant by a rule of its family; where it was when it could not tell any more."""

import ast
import faulthandler
import re
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import islice
from pathlib import Path
from traceback import extract_tb

from tetrabench.errors import InputError
from tetrabench.protocols import Contestant, Family

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
        found.append(spell(error))
    return found


def spell(error: BaseException) -> str:
    """What went wrong, in which function, and where, in a line."""
    if type(error).__module__.startswith("numba."):
        return spell_refusal(str(error))
    frames = extract_tb(error.__traceback__)
    where = f"{frames[-1].name}: " if frames else ""
    place = f" ({Path(frames[-1].filename).name}:{frames[-1].lineno})" if frames else ""
    lines = str(error).strip().splitlines() or ["no reason given"]
    return f"{where}{type(error).__name__}: {lines[0]}{place}"


def spell_refusal(text: str) -> str:
    """What the compiler says, pages of it, in a line: which function, what is wrong, and where."""
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    if missing := next((line for line in lines if " does not implement " in line), ""):
        return missing.removeprefix("TypingError: ")
    places = re.findall(r'File "([^"]+)", line (\d+)', text) or re.findall(r"Raised from (\S+) \((\d+)\)", text)
    told = [line for line in lines if not _WRAPPING.search(line)]
    begins = [n for n, line in enumerate(lines) if "raised a specific error" in line]
    within = [line for line in lines[begins[-1] + 1 :] if line in told] if begins else told
    reason = (within or told or lines or ["no reason given"])[0].removeprefix("TypingError: ")
    reason = reason.partition(" Raised from")[0][:300].rstrip(".")
    if not places:
        return f"it cannot be compiled: {reason}"
    file, line = Path(places[-1][0]), int(places[-1][1])
    return f"{_function_at(file, line)}: it cannot be compiled: {reason} ({file.name}:{line})"


_WRAPPING = re.compile(
    r"^(Failed in|During:|File |There (is|are)|Overload|With argument|Rejected|Enable|- Of which|>>>|\^|<source|Raised from)"
    r"|No implementation of function"
)
"""Lines that the compiler puts around what it has to say."""


def _function_at(file: Path, line: int) -> str:
    """The function that a line of a file is in; "a kernel" where nobody can tell."""
    try:
        tree = ast.parse(file.read_text(encoding="utf-8"))
    except (OSError, ValueError, SyntaxError):
        return "a kernel"
    around = [
        node
        for node in ast.walk(tree)
        if isinstance(node, ast.FunctionDef) and node.lineno <= line <= (node.end_lineno or node.lineno)
    ]
    return max(around, key=lambda node: node.lineno).name if around else "a kernel"


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
