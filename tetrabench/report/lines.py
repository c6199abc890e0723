"""Who may have a line in a chart: who ended well; and, said to be wrong, who is known to be.

A line ranks nothing. So a contestant that takes part as an example of a wrong answer may be drawn, dashed and labelled;
any other wrong one is not.
"""

from collections.abc import Iterable
from dataclasses import dataclass

from tetrabench.bench.record import Backend, Results, Sample
from tetrabench.bench.statistics import INEXACT, Row, samples_of
from tetrabench.report.parts import shown_name

WRONG = "(wrong answers)"
MOST_ALIKE = 7
"""Lines of a contestant where its backends are a line each: of more some are drawn, from the first to the last."""


@dataclass(frozen=True)
class Line:
    """A backend in a task on a model, with its samples that ended."""

    row: Row
    backend: Backend
    samples: list[Sample]

    @property
    def is_wrong(self) -> bool:
        """Whether it is an example of a wrong answer."""
        return self.row.verdict == INEXACT

    @property
    def label(self) -> str:
        """Its shown name, and that it is wrong where it is."""
        return label_of(shown_name(self.backend), is_wrong=self.is_wrong)


def label_of(name: str, *, is_wrong: bool) -> str:
    """What stands in a legend."""
    return f"{name} {WRONG}" if is_wrong else name


def lines_of(results: Results, rows: Iterable[Row]) -> list[Line]:
    """The lines of a run, in the order of its summary `rows`; controls have none."""
    backends = {one.name: one for one in results.backends if not one.control}
    cells = samples_of(results)
    return [
        Line(row, backend, [one for one in cells[row.model, row.task, row.backend] if one.status == row.status])
        for row in rows
        if (backend := backends.get(row.backend)) and (row.status == "ok" or row.verdict == INEXACT)
    ]


def few_of_each(backends: Iterable[Backend]) -> list[Backend]:
    """MOST_ALIKE of each contestant at most, as far apart in the order of the run as can be."""
    kin: dict[str, list[Backend]] = {}
    for backend in backends:
        kin.setdefault(backend.contestant, []).append(backend)
    return [
        own[round(place * (len(own) - 1) / max(1, count - 1))]
        for own in kin.values()
        for count in [min(MOST_ALIKE, len(own))]
        for place in range(count)
    ]
