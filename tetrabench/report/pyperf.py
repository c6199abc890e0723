"""Results in the format of pyperf, version 1.0, for its tools: `python -m pyperf show`, `stats`, `hist`, `compare_to`.

A benchmark is a cell, named "task/backend/model"; a run of it is a launch; its values are seconds of one run of the
scenario, on the clock that the task is measured by. pyperf knows no pairs: its comparison of two files compares
absolute times, and says nothing about the machine that changed in between. See pyperf's manual, "JSON format".
"""

import json
from collections.abc import Sequence
from datetime import datetime
from statistics import median
from typing import Any

from tetrabench.bench.record import Launch, Results, Sample
from tetrabench.bench.statistics import summary
from tetrabench.errors import InputError

VERSION = "1.0"

_METADATA = {  # ours -> pyperf's
    "processor": "cpu_model_name",
    "architecture": "cpu_arch",
    "cores": "cpu_count",
    "system": "platform",
    "python": "python_version",
}


def as_pyperf(results: Results) -> str:
    """All cells that ended well.

    Raises:
        InputError: there are none; pyperf has no files without benchmarks.
    """
    samples: dict[tuple[str, str, str], list[Sample]] = {}
    for sample in results.samples:
        samples.setdefault((sample.model, sample.task, sample.backend), []).append(sample)
    launches = {(one.model, one.launch, one.group): one for one in results.launches}
    benchmarks = [
        benchmark
        for row in summary(results)
        if row.status == "ok"
        for benchmark in [_benchmark(samples[row.model, row.task, row.backend], row.clock, launches)]
        if benchmark["runs"]
    ]
    if not benchmarks:
        raise InputError("no cell ended well: pyperf's format has no place for that; show the table instead")
    known = results.environment
    metadata = {theirs: known[ours] for ours, theirs in _METADATA.items() if known.get(ours) is not None}
    metadata |= {"unit": "second", "command": results.command}
    metadata |= {"tetrabench_schema": results.schema, "tetrabench_reference": results.reference}
    return json.dumps({"version": VERSION, "metadata": metadata, "benchmarks": benchmarks}, indent=1) + "\n"


def _benchmark(samples: Sequence[Sample], clock: str, launches: dict[tuple[str, int, int], Launch]) -> dict[str, Any]:
    """A cell; samples in which no time passed are left out, as pyperf's values are positive."""
    values: dict[tuple[str, int, int], list[float]] = {}
    for sample in samples:
        total = sample.wall_s if clock == "wall" else sample.cpu_s
        if total:
            values.setdefault((sample.model, sample.launch, sample.group), []).append(total / sample.repeats)
    first = samples[0]
    metadata = {
        "name": f"{first.task}/{first.backend}/{first.model}",
        "loops": round(median(sample.repeats for sample in samples)),
        "timer": f"{clock} time",
    }
    runs = [{"metadata": _about(launches.get(key)), "values": seconds} for key, seconds in sorted(values.items())]
    return {"metadata": metadata, "runs": runs}


def _about(launch: Launch | None) -> dict[str, Any]:
    if launch is None:
        return {}
    begun = datetime.fromisoformat(launch.begun).replace(tzinfo=None) if launch.begun else None  # it knows no zones
    date = {"date": begun.isoformat(sep=" ")} if begun else {}
    load = {"load_avg_1min": launch.load_1_minute} if launch.load_1_minute is not None else {}
    return {**date, "cpu_affinity": str(launch.core), **load}
