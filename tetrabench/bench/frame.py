"""Results as a table for analysis."""

from pathlib import Path
from typing import TYPE_CHECKING

import msgspec

from tetrabench.bench.record import Sample, read_results

if TYPE_CHECKING:
    import pandas


def load_results(path: str | Path) -> "pandas.DataFrame":
    """A row for each sample of a results file, with the columns of `record.Sample`.

    Missing numbers are NaN; `figures` is a dict.

    Raises:
        InputError: no such file, not our JSON, or another version's schema.
    """
    import pandas

    samples = read_results(Path(path)).samples
    return pandas.DataFrame([msgspec.structs.asdict(sample) for sample in samples], columns=Sample.__struct_fields__)
