"""Whether results hang together: what the types of records cannot say, asked of every file before anybody trusts it.

Names are there once, and who refers to one finds it; numbers are such that tables, charts, pandas and JSON can hold what
follows from them; what was counted or timed is not below 0; a date is one. A run that was broken off is sound, too.
"""

from collections import Counter
from collections.abc import Iterator
from datetime import datetime
from typing import TYPE_CHECKING, Any

import msgspec

if TYPE_CHECKING:
    from tetrabench.bench.record import Results

LARGEST = 10**18
"""Of a count, and of bytes: so many times some bytes still fit into 64 bits."""
LONGEST = 1e12
"""Of a time or a rate, in whatever unit: their products and ratios stay far from infinity."""
DEEPEST = 6
"""How far values lie within values; the environment is flat, samples hold series, which are lists."""
SIGNED = frozenset({"figures", "series", "environment", "options", "seed", "retained_bytes"})
"""Fields whose numbers may be below 0: a process may well have given back more than a small structure took."""


def find_fault(results: "Results") -> str:
    """What is wrong with a run, as "place: reason"; "" where nothing is."""
    return next(_faults(results), "")


def _faults(results: "Results") -> Iterator[str]:
    for name in results.__struct_fields__:
        yield from _wrong_numbers(getattr(results, name), name, name in SIGNED, 0)
    yield from _wrong_names(results)
    for place, date in [
        ("started", results.started),
        *((f"launches[{n}].begun", one.begun) for n, one in enumerate(results.launches)),
    ]:
        if date and not is_date(date):
            yield f"{place}: {date!r} is no date"


def _wrong_numbers(value: Any, place: str, is_signed: bool, depth: int) -> Iterator[str]:
    """Numbers that are out of all proportion, wherever they are in a value."""
    kind = type(value)
    if kind is str or value is None or kind is bool:
        return
    if kind is int or kind is float:
        most = LARGEST if kind is int else 1e300 if is_signed else LONGEST
        if not (-most if is_signed else 0) <= value <= most:
            yield f"{place}: {value:.3g} is no number that it can be"
    elif depth > DEEPEST:
        yield f"{place}: holds values within values without end"
    elif isinstance(value, msgspec.Struct):
        for name in value.__struct_fields__:
            yield from _wrong_numbers(getattr(value, name), f"{place}.{name}", is_signed or name in SIGNED, depth + 1)
        if getattr(value, "repeats", 1) < 1:
            yield f"{place}.repeats: a sample is of one run at least"
    else:
        inner = value.items() if isinstance(value, dict) else enumerate(value)
        for key, one in inner:
            yield from _wrong_numbers(one, f"{place}[{key!r}]", is_signed, depth + 1)


def _wrong_names(results: "Results") -> Iterator[str]:
    """Names that are there twice, or that nothing bears."""
    models, tasks, backends = ([one.name for one in part] for part in (results.models, results.tasks, results.backends))
    for what, listed in (("models", models), ("tasks", tasks), ("backends", backends)):
        yield from (f"{what}: {name!r} is there twice" for name, count in Counter(listed).items() if count > 1)
    known = {"model": {*models}, "task": {*tasks}, "backend": {*backends}}
    for number, sample in enumerate(results.samples):
        for what, names in known.items():
            if (name := getattr(sample, what)) not in names:
                yield f"samples[{number}].{what}: there is no {what} {name!r}"
    for number, backend in enumerate(results.backends):
        if backend.against not in known["backend"]:
            yield f"backends[{number}].against: there is no backend {backend.against!r}"


def is_date(text: str) -> bool:
    """Whether a text is a date, or date and time, in ISO's format."""
    try:
        datetime.fromisoformat(text)
    except ValueError:
        return False
    return True
