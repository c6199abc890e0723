"""What a GitHub workflow shows: the tables in Markdown, and an annotation for whatever went wrong.

The runner reads annotations, "workflow commands", from the lines of a step's output; they stand in a comment, so that
the same text can be appended to $GITHUB_STEP_SUMMARY. See "Workflow commands for GitHub Actions" in GitHub's manual.
"""

import re
from collections.abc import Iterator

from tetrabench.bench.record import Results
from tetrabench.bench.statistics import BAD, summary
from tetrabench.printable import printable
from tetrabench.report.notes import about_end
from tetrabench.report.table import as_markdown


def as_github(results: Results) -> str:
    """The tables, and the annotations: an error for a cell that went wrong, a warning for one that cannot be believed."""
    annotations = list(_annotations(results))
    comment = ["", "<!--", *annotations, "-->"] if annotations else []
    return as_markdown(results) + "".join(f"{line}\n" for line in comment)


def _annotations(results: Results) -> Iterator[str]:
    doubted = set()
    for row in summary(results):
        cell = f"{row.backend}, {row.task}, {row.model}"
        if row.verdict in BAD:
            yield annotation("error", f"tetrabench: {row.verdict}", f"{cell}: {row.reason or row.verdict}")
        elif row.verdict == "inconclusive" and row.reason and (row.model, row.task, row.against) not in doubted:
            doubted.add((row.model, row.task, row.against))
            yield annotation("warning", "tetrabench: nothing is ranked", f"{row.task}, {row.model}: {row.reason}")
    for memory in results.memory:
        cell = f"{memory.backend}, memory, {memory.model}"
        if memory.status not in ("ok", "skipped", "unsupported"):
            yield annotation("error", f"tetrabench: {memory.status}", f"{cell}: {memory.reason or memory.status}")
        elif not memory.is_accounted:
            claim = (
                f"the structure claims {memory.structure_bytes:,} bytes, its process holds {memory.retained_bytes:,}"
            )
            yield annotation("warning", "tetrabench: unaccounted memory", f"{cell}: {claim}")
    if results.ended:
        yield annotation("warning", "tetrabench: ended early", about_end(results))


def annotation(level: str, title: str, message: str) -> str:
    """A workflow command; `level` is "error", "warning" or "notice"."""
    return f"::{level} title={_escape(title, ':,')}::{_escape(message)}"


def _escape(text: str, more: str = "") -> str:
    """What would end the command, or the comment that it stands in, as its code in percent."""
    escaped = re.sub("(--!?)>", r"\1%3E", text.replace("%", "%25"))
    for sign in f"\r\n{more}":
        escaped = escaped.replace(sign, f"%{ord(sign):02X}")
    return printable(escaped)
