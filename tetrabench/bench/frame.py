"""Results as tables for analysis in pandas."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_type_hints

import msgspec

from tetrabench.bench.record import Results, Sample, read_results
from tetrabench.bench.statistics import Row, summary

if TYPE_CHECKING:
    import pandas

_TYPES = {bool: "boolean", int: "Int64", float: "float64", str: "string", dict: "object"}
"""Of columns: whole numbers and truths may be missing too (<NA>), other numbers then are NaN."""


def load_results(path: str | Path) -> "pandas.DataFrame":
    """A row for each sample of a results file.

    Columns are those of `record.Sample`, and what the file says elsewhere: `scenario` and `parallel` of the task,
    `contestant`, `against` and `control` of the backend, its options as `backend_capacity`, ..., the sizes of the model as
    `model_tetras`, `model_points`, ..., the counts of the task as `option_sweeps`, ... (each missing where there is none).
    Times are in seconds, for all `repeats` of a sample together. Words are strings, counts Int64, times float64 (NaN
    where missing), `figures` and `series` are dicts.

    Raises:
        InputError: no such file, not our JSON, or another version's schema.
    """
    results = read_results(Path(path))
    return _frame(results, Sample, results.samples)


def load_summary(path: str | Path) -> "pandas.DataFrame":
    """A row for each cell of a results file: what its samples say.

    Columns are those of `statistics.Row` (seconds of one run, ratio, low, high, verdict, ...), and the same columns
    of the model, the task and the backend as in `load_results`.

    Raises:
        InputError: no such file, not our JSON, or another version's schema.
    """
    results = read_results(Path(path))
    return _frame(results, Row, summary(results))


def _frame(results: Results, kind: type[msgspec.Struct], records: Iterable[Any]) -> "pandas.DataFrame":
    import pandas

    models = {model.name: {f"model_{thing}": n for thing, n in model.size.items()} for model in results.models}
    tasks = {
        task.name: {"scenario": task.scenario, "parallel": task.parallel}
        | {f"option_{name}": count for name, count in task.options.items()}
        for task in results.tasks
    }
    backends = {
        one.name: {"contestant": one.contestant, "against": one.against, "control": one.control}
        | {f"backend_{name}": value for name, value in one.options.items()}
        for one in results.backends
    }
    rows = [
        msgspec.structs.asdict(one)
        | backends.get(one.backend, {})
        | tasks.get(one.task, {})
        | models.get(one.model, {})
        for one in records
    ]
    columns = {
        name: _TYPES[_plain(hint)] for name, hint in get_type_hints(kind).items() if name in kind.__struct_fields__
    }
    columns |= {"scenario": "string", "parallel": "boolean"}
    columns |= {"contestant": "string", "against": "string", "control": "boolean"}
    columns |= {
        name: "Int64"
        for part in (*models.values(), *_named(tasks, "option_"), *_named(backends, "backend_"))
        for name in part
    }
    return pandas.DataFrame(rows, columns=list(columns)).astype(columns)


def _named(facts: Mapping[str, Mapping[str, Any]], prefix: str) -> list[list[str]]:
    return [[name for name in one if name.startswith(prefix)] for one in facts.values()]


def _plain(hint: Any) -> type:
    """int of int | None, dict of dict[str, float]."""
    inner = next((one for one in getattr(hint, "__args__", ()) if one is not type(None)), hint)
    plain: type = hint.__origin__ if hasattr(hint, "__origin__") else inner
    return plain
