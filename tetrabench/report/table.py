"""The tables of a run set in type: for a terminal, or in Markdown."""

import io
import re
import textwrap

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from tetrabench.bench.record import Results
from tetrabench.printable import printable
from tetrabench.report.pages import pages_of
from tetrabench.report.sheets import Pages, Sheet

WIDTH = 100
FIRST = 18
"""The first column is as wide at most; the tasks of a sweep have long names."""

_STYLES = {  # a second way to see what the words and signs say already
    "faster": "green",
    "slower": "bold",
    "same": "dim",
    "about": "dim",
    "too short": "dim",
    "inconclusive": "dim",
    "skipped": "dim",
    "unsupported": "dim",
    "missing": "dim",
    "wrong": "bold red",
    "unstable": "bold red",
    "crashed": "bold red",
    "out of memory": "bold red",
    "timed out": "bold red",
    "failed": "bold red",
}


def as_text(results: Results, *, colour: bool = False, intervals: bool = False) -> str:
    """The tables for a terminal; with `colour` in its colours, unless NO_COLOR is set.

    Args:
        results: a run.
        colour: whether signs and words are coloured too.
        intervals: the ends of each interval rather than the ratio.
    """
    return "\n".join(text_of(one, colour=colour) for one in pages_of(results, intervals=intervals))


def as_markdown(results: Results, *, intervals: bool = False) -> str:
    """The same in Markdown."""
    return "\n".join(map(markdown_of, pages_of(results, intervals=intervals)))


def text_of(pages: Pages, *, colour: bool = False) -> str:
    """Any tables for a terminal."""
    console = Console(file=io.StringIO(), width=1000, force_terminal=colour, highlight=False)
    with console.capture() as capture:
        for sheet in pages.sheets:
            console.print(Text(printable(sheet.title), "bold"), "", _set(sheet), "", sep="\n")
            if sheet.notes:
                console.print(*map(_wrap, sheet.notes), "", sep="\n")
        console.print(*map(_wrap, pages.notes), sep="\n")
    return "\n".join(line.rstrip() for line in capture.get().splitlines()) + "\n"


def markdown_of(pages: Pages) -> str:
    """Any tables in Markdown."""
    blocks = []
    for sheet in pages.sheets:
        rows = [[cell.text for cell in row] for row in (*sheet.rows, *sheet.costs)]
        lines = [_line(list(map(_harmless, sheet.head))), _line(["---", *["---:"] * (len(sheet.head) - 1)])] + [
            _line(_escape(row)) for row in rows
        ]
        blocks += [f"**{_harmless(sheet.title)}**", "\n".join(lines)]
        blocks += ["\n".join(f"- {note}" for note in _escape(sheet.notes))] if sheet.notes else []
    return "\n\n".join([*blocks, "\n".join(f"- {note}" for note in _escape(pages.notes))]) + "\n"


def _set(sheet: Sheet) -> Table:
    table = Table(box=SIMPLE_HEAD, show_edge=False, padding=0, header_style="bold")
    for place, name in enumerate(sheet.head):
        if place:
            table.add_column(Text(printable(name)), justify="right", no_wrap=True, min_width=6)
        else:
            table.add_column(Text(printable(name)), max_width=FIRST)
    for row in (*sheet.rows, *([[], *sheet.costs] if sheet.costs else [])):
        table.add_row(*(Text(printable(cell.text), _STYLES.get(cell.verdict, "")) for cell in row))
    return table


def _wrap(note: str) -> Text:
    kept = printable(note).replace(" %", "\N{NO-BREAK SPACE}%")
    lines = textwrap.fill(kept, WIDTH, subsequent_indent="  ", break_long_words=False, break_on_hyphens=False)
    return Text(lines.replace("\N{NO-BREAK SPACE}", " "))


def _line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _escape(texts: list[str]) -> list[str]:
    """What Markdown would take for its own."""
    return [re.sub(r"([~*])", r"\\\1", _harmless(text)) for text in texts]


def _harmless(text: str) -> str:
    """A text that begins no tag, link, picture or cell of its own. (Backticks stay: notes quote commands.)"""
    return re.sub(r"([<|\[])", r"\\\1", printable(text))
