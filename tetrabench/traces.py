"""An exception in a line, for whoever wrote what raised it: in which function, what, and at which line of which file."""

import ast
import re
from collections.abc import Collection, Iterator
from contextlib import contextmanager
from pathlib import Path
from traceback import extract_tb

from tetrabench.errors import InputError, TetrabenchError


def spell_error(error: BaseException, entered_from: Collection[str] = ()) -> str:
    """What went wrong, and where: where it was raised.

    Args:
        error: as it was caught. Of what the compiler says, pages of it, the line that matters is found.
        entered_from: files that called what failed. Given these, the place is the first one behind them, not the last:
            which line of a plug-in fails is of more use than which line of a library that it calls. No place if none is.
    """
    if type(error).__module__.startswith("numba."):
        return spell_refusal(str(error))
    lines = [line.strip() for line in str(error).splitlines() if line.strip()] or ["no reason given"]
    what = f"{type(error).__name__}: {lines[0]}"
    frames = [frame for frame in extract_tb(error.__traceback__) if not frame.filename.startswith("<frozen ")]
    if entered_from:
        frames = [frame for frame in frames if frame.filename not in entered_from][:1]
    if isinstance(error, SyntaxError) or not frames:  # that names its own place
        return what
    frame = frames[-1]
    function = "" if frame.name.startswith("<") else f"{frame.name}: "
    return f"{function}{what} ({Path(frame.filename).name}:{frame.lineno})"


@contextmanager
def named(what: str) -> Iterator[None]:
    """Run what others have written: an exception of theirs becomes one sentence about `what`, with its place.

    Raises:
        InputError: whatever was raised, but for our own errors, and those of the machine.
    """
    try:
        yield
    except (TetrabenchError, MemoryError):
        raise
    except Exception as error:
        raise InputError(f"{what}: {spell_error(error)}") from error


def spell_refusal(text: str) -> str:
    """What the compiler says in a line: which function, what is wrong, and where.

    A call that cannot be compiled tells what its caller and all above it were about first; the innermost comes last, and in
    that the reason, then its place, then those that led there.
    """
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    if missing := next((line for line in lines if " does not implement " in line), ""):
        return missing.removeprefix("TypingError: ")
    begins = [n for n, line in enumerate(lines) if "raised a specific error" in line]
    innermost = lines[begins[-1] + 1 :] if begins else lines
    told = [line.removeprefix("TypingError: ") for line in innermost]
    told = [line for line in told if not _WRAPPING.search(line)] or told or ["no reason given"]
    inner = "\n".join(innermost)
    if told[0].startswith("No match") and (call := re.search(r"(?m)^>>> (.+)$", inner)):
        told[0] = f"there is no {call[1]}"
    reason = told[0].partition(" Raised from")[0][:300].rstrip(".")
    places = re.findall(r'File "([^"]+)", line (\d+)', inner) or re.findall(r"Raised from (\S+) \((\d+)\)", inner)
    callee = re.search(r"resolving callee type: Function\(<function (\w+)", inner.partition('\nFile "')[0])
    if callee:  # the compiler names the line of the caller alone
        return f"{callee[1]}: it cannot be compiled: {reason}"
    if not places:
        return f"it cannot be compiled: {reason}"
    file, line = Path(places[0][0]), int(places[0][1])
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
