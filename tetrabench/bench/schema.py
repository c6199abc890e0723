"""The published JSON schema of results files, made from their records: `python -m tetrabench.bench.schema` prints it."""

import inspect
import json
from typing import Any

import msgspec

from tetrabench.bench.record import SCHEMA, Results


def results_schema() -> dict[str, Any]:
    """The schema (JSON Schema 2020-12) that docs/results-1.schema.json holds."""
    schema = msgspec.json.schema(Results)
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": SCHEMA, "title": "Results of tetrabench"}
    for record in schema["$defs"].values():
        record["description"] = inspect.cleandoc(record["description"])
    schema["$defs"]["Results"]["properties"]["schema"] |= {"const": SCHEMA}
    schema["$defs"]["Results"]["required"] = ["schema", *schema["$defs"]["Results"]["required"]]
    return head | schema


def spell_schema() -> str:
    """The same as text."""
    return json.dumps(results_schema(), indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    print(spell_schema(), end="")
