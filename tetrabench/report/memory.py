"""Memory of each contestant in a run, in the two ways that can be compared."""

from tetrabench.bench.record import Results
from tetrabench.bench.statistics import Row


def bytes_per_item(results: Results) -> dict[str, float]:
    """Used bytes of the fresh structure for each item of the model (what it counts first), by contestant."""
    number = next(iter(results.model_size.values()), 0)
    used = {one.name: sum(used for used, _ in one.structure.values()) for one in results.backends}
    return {name: size / number for name, size in used.items() if size and number}


def peak_bytes(rows: list[Row]) -> dict[str, float]:
    """High-water mark of the process over the scenarios that all contestants ended well, by contestant.

    A contestant that broke off in the scenario that needs most would look the smallest otherwise.
    """
    complete = {row.scenario for row in rows} - {row.scenario for row in rows if row.peak_bytes is None}
    peaks: dict[str, float] = {}
    for row in rows:
        if row.scenario in complete and row.peak_bytes is not None:
            peaks[row.backend] = max(peaks.get(row.backend, 0.0), row.peak_bytes)
    return peaks
