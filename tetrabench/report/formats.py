"""The forms in which results can be shown: each is one function, results in, text out."""

from collections.abc import Callable

from tetrabench.bench.record import Results
from tetrabench.report.github import as_github
from tetrabench.report.pyperf import as_pyperf
from tetrabench.report.rows import as_csv, as_json
from tetrabench.report.table import as_markdown, as_text

FORMATS: dict[str, Callable[[Results], str]] = {
    "table": as_text,
    "md": as_markdown,
    "json": as_json,
    "csv": as_csv,
    "github": as_github,
    "pyperf": as_pyperf,
}
