"""All tables of a run: ratios, bandwidth and growth, and those of its numberings where it swept over some."""

from tetrabench.bench.numbering import numberings_of
from tetrabench.bench.record import Results
from tetrabench.report.numbering import make_numbering_pages
from tetrabench.report.sheets import Pages, make_pages


def pages_of(results: Results, *, intervals: bool = False) -> list[Pages]:
    """One after the other; with `intervals` the ends of each rather than its middle."""
    pages = [make_pages(results, intervals=intervals)]
    if numberings_of(results) and results.profile != "check":
        pages.append(make_numbering_pages(results, intervals=intervals))
    return pages
