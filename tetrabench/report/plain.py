"""Records as matplotlib can set them: two dollars in a name are no formula, and no sign is without a shape."""

from typing import Any, TypeVar

import msgspec

from tetrabench.printable import printable

Record = TypeVar("Record")


def plain(record: Record) -> Record:
    """The same record, or list of them, with every word as it stands once it is drawn."""
    text = msgspec.json.encode(record)
    if text.isascii() and b"$" not in text and b"\\" not in text:  # nearly all: nothing to do
        return record
    kind: Any = list[type(record[0])] if isinstance(record, list) and record else type(record)  # type: ignore[misc]
    converted: Record = msgspec.convert(_plain(msgspec.to_builtins(record)), kind)
    return converted


def _plain(value: Any) -> Any:
    if isinstance(value, str):
        return printable(value).replace("$", r"\$")
    if isinstance(value, dict):
        return {_plain(name): _plain(one) for name, one in value.items()}
    return [_plain(one) for one in value] if isinstance(value, list | tuple) else value
