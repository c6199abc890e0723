"""Records with words that can be drawn: no sign without a shape, at which vl-convert ends, and no formula for matplotlib."""

from collections.abc import Callable
from typing import Any, TypeVar

import msgspec

from tetrabench.printable import printable

Record = TypeVar("Record")


def plain(record: Record, spell: Callable[[str], str] = printable) -> Record:
    """The same record, or list of them, with every word spelled by `spell`."""
    text = msgspec.json.encode(record)
    if text.isascii() and b"$" not in text and b"\\" not in text:  # nearly all: nothing to do
        return record
    kind: Any = list[type(record[0])] if isinstance(record, list) and record else type(record)  # type: ignore[misc]
    converted: Record = msgspec.convert(_spelled(msgspec.to_builtins(record), spell), kind)
    return converted


def no_formula(text: str) -> str:
    """For matplotlib, which takes what stands between two dollars for a formula, perhaps a wrong one."""
    return printable(text).replace("$", r"\$")


def _spelled(value: Any, spell: Callable[[str], str]) -> Any:
    if isinstance(value, str):
        return spell(value)
    if isinstance(value, dict):
        return {spell(name): _spelled(one, spell) for name, one in value.items()}
    return [_spelled(one, spell) for one in value] if isinstance(value, list | tuple) else value
