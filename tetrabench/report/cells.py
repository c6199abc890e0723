"""What a cell says of its row: a ratio in two digits, or its interval, or a word where no figure may stand."""

from tetrabench.bench.statistics import Row
from tetrabench.report.units import span, times, two_digits

WORDS = {
    "reference": "1",
    "no reference": "no ref.",
    "inconclusive": "unclear",
    "out of memory": "no memory",
    "unsupported": "cannot",
}
"""Of verdicts that would be too long for a cell; all others are their own word."""


MISSING = "missing"
"""Of a cell that has no samples."""


def ratio_of(row: Row) -> str:
    """1.4x, >43x where it is only known to be more, ~1 where it is the same, 1.3? where that is only a hint."""
    if row.ratio is None or row.low is None or row.high is None:
        return word_of(row)
    if row.is_bound:
        return f">{times(row.low)}" if row.verdict == "slower" else f"<{times(row.high)}"
    if row.verdict in ("faster", "slower"):
        return times(row.ratio)
    if row.verdict == "same":
        return "~1"
    return f"{two_digits(row.ratio)}?" if row.verdict == "about" else word_of(row)


def interval_of(row: Row) -> str:
    """1.38-1.43, with a question mark where it ranks nothing."""
    if row.ratio is None or row.low is None or row.high is None or row.is_bound:
        return ratio_of(row)
    if row.verdict in ("faster", "slower", "same", "control"):
        return span(row.low, row.high)
    if row.verdict not in ("about", "inconclusive"):
        return word_of(row)
    return f"{span(row.low, row.high)}?" if row.low < row.high else ratio_of(row)


def word_of(row: Row) -> str:
    """The verdict, in a word that fits."""
    return WORDS.get(row.verdict, row.verdict)
