"""The ratios of a project over its commits: a line of JSON for each run, appended to a file that can be committed.

Advisory: the runs of a history were made at different times, on machines that may differ. What a line says of one of
them does not decide anything; `gate` does.
"""

import hashlib
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import msgspec

from tetrabench.bench.compare import FACTS, revision_of
from tetrabench.bench.record import NO_JSON, Results
from tetrabench.bench.soundness import is_date
from tetrabench.bench.statistics import summary
from tetrabench.errors import InputError
from tetrabench.printable import printable

SCHEMA = "tetrabench-history/1"

SMALLEST, LARGEST = 1e-12, 1e12  # ratios that a chart can hold


class Point(msgspec.Struct, frozen=True, kw_only=True):
    """A cell of a run: its ratio to the reference, with the ends of its interval."""

    model: str
    task: str
    backend: str
    ratio: float
    low: float
    high: float
    verdict: str


class Entry(msgspec.Struct, frozen=True, kw_only=True):
    """A run.

    Attributes:
        run: 16 hexadecimal digits of all that was measured: no two runs have the same.
        date: when it began, ISO date and time.
        environment: key of the facts that ratios depend on; equal ones are comparable. facts: these, for people.
    """

    schema: str = SCHEMA
    run: str
    revision: str
    date: str
    family: str
    profile: str
    reference: str
    environment: str
    facts: dict[str, Any]
    points: list[Point]


def entry_of(results: Results) -> Entry:
    """What a history keeps of a run.

    Raises:
        InputError: a run that measured no ratios, or whose ratios are those of a gate.
    """
    if any(backend.checkout for backend in results.backends):
        raise InputError(
            "a gate's ratios are head / base: they are no point of a history; add a run of `tetrabench run`"
        )
    points = [
        Point(
            model=row.model,
            task=row.task,
            backend=row.backend,
            ratio=row.ratio,
            low=row.low,
            high=row.high,
            verdict=row.verdict,
        )
        for row in summary(results)
        if not row.control and row.ratio is not None and row.low is not None and row.high is not None
    ]
    if results.profile == "check" or not points:
        raise InputError("there are no ratios in this run: nothing to add to a history")
    facts = {fact: results.environment.get(fact) for fact in FACTS}
    return Entry(
        run=_digest(results),
        revision=revision_of(results),
        date=results.started,
        family=results.family,
        profile=results.profile,
        reference=results.reference,
        environment=_digest(facts)[:8],
        facts=facts,
        points=points,
    )


def add(results: Results, path: Path) -> bool:
    """Append a run to a history, which is made if there is none. False: this run is there already; nothing is done.

    Raises:
        InputError: nothing to add, or the file is no history or cannot be written.
    """
    entry = entry_of(results)
    known = read_history(path) if path.exists() else []
    if any(one.run == entry.run for one in known):
        return False
    try:
        with path.open("ab") as file:  # one write: of two that append at once, neither cuts the other's line in two
            is_open = file.tell() > 0 and not path.read_bytes().endswith(b"\n")  # somebody edited it
            file.write(b"\n" * is_open + msgspec.json.encode(entry) + b"\n")
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise InputError(f"{path}: cannot write: {error.strerror}") from error
    return True


def read_history(path: Path) -> list[Entry]:
    """All runs, the earliest first.

    Raises:
        InputError: no such file, or a line that is no run of this version.
    """
    try:
        lines = path.read_bytes().splitlines()
    except OSError as error:
        raise InputError(f"{path}: cannot read the history: {error.strerror}") from error
    entries = []
    for number, line in enumerate(lines, 1):
        if not line.strip():
            continue
        try:
            entry = msgspec.json.decode(line, type=Entry)
        except NO_JSON as error:
            reason = printable(f"{error}")
            raise InputError(f"{path}:{number}: no run of a history, or cut off: {reason}") from error
        if entry.schema != SCHEMA:
            raise InputError(f"{path}:{number}: schema {printable(entry.schema[:80])}, this version reads {SCHEMA}")
        if any(not SMALLEST <= x <= LARGEST for one in entry.points for x in (one.ratio, one.low, one.high)):
            raise InputError(f"{path}:{number}: a ratio that cannot be")
        if not is_date(entry.date):
            raise InputError(f"{path}:{number}: {entry.date!r} is no date")
        entries.append(entry)
    return sorted(entries, key=lambda entry: entry.date)


def _digest(facts: Results | Mapping[str, object]) -> str:
    return hashlib.blake2b(msgspec.json.encode(facts, order="sorted"), digest_size=8).hexdigest()
