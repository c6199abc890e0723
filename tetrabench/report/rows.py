"""Rows for other programs: JSON and CSV."""

import csv
import io
from typing import Any

import msgspec

from tetrabench.bench.growth import growth
from tetrabench.bench.record import Results
from tetrabench.bench.statistics import Row, summary


def as_json(results: Results) -> str:
    """An object with the facts of the run, and in lists: `rows` (see statistics.Row), `memory` (record.Memory, with
    `structure_bytes` and `is_accounted`), `growth` (growth.Growth).

    Numbers are not rounded; what is unknown is null.
    """
    rows = summary(results)
    facts: dict[str, Any] = {
        name: getattr(results, name)
        for name in ("command", "profile", "reference", "started", "ended", "environment", "models", "tasks")
    }
    memory = [
        msgspec.structs.asdict(one) | {"structure_bytes": one.structure_bytes, "is_accounted": one.is_accounted}
        for one in results.memory
    ]
    facts |= {"rows": rows, "memory": memory, "growth": growth(results, rows)}
    return msgspec.json.format(msgspec.json.encode(facts), indent=1).decode() + "\n"


def as_csv(results: Results) -> str:
    """A line for each row (see statistics.Row), the names of its fields in the first; what is unknown is empty.

    A name that a spreadsheet would take for a formula gets an apostrophe before it.
    """
    page = io.StringIO()
    writer = csv.writer(page, lineterminator="\n")
    writer.writerow(Row.__struct_fields__)
    writer.writerows([_no_formula(field) for field in msgspec.structs.astuple(row)] for row in summary(results))
    return page.getvalue()


def _no_formula(field: Any) -> Any:
    return f"'{field}" if isinstance(field, str) and field.startswith(("=", "+", "-", "@", "\t", "\r")) else field
