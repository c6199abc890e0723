"""The tables of docs/measuring.md, from the committed parts: between marks, as results/regenerate.py does for README.md."""

import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from statistics import mean

from tests.measuring.cost import OUTSIDE, overhead
from tests.measuring.record import FOLDER, Comparison, Part, read

PAGE = FOLDER.parents[1] / "docs" / "measuring.md"
OFF = 0.10
"""A ratio of equal codes that is farther from 1 than this is off."""
NAMED = ("tetrabench", "pyperf", "pytest-benchmark", "hyperfine")


def verdicts(parts: Iterable[Part]) -> Iterator[tuple[str, Part, list[Comparison]]]:
    """Each tool, with pytest-benchmark each of its rules: how the tables call it, one of its parts, its comparisons."""
    parts = list(parts)
    for tool in NAMED:
        mine = [part for part in parts if part.tool == tool and part.comparisons]
        found = [one for part in mine for one in part.comparisons]
        for rule in dict.fromkeys(one.by for one in found):
            yield f"{tool} {rule}".strip(), mine[0], [one for one in found if one.by == rule]


def equal_codes(parts: list[Part]) -> Iterator[list[str]]:
    """Comparisons of identical code: what each tool made of them."""
    yield ["tool", "comparisons", "false slower", "false faster", "neither", f"ratio off by > {OFF:.0%}", "worst ratio"]
    for name, _, found in verdicts(parts):
        same = [one for one in found if not one.injected]
        slower, faster = (sum(one.verdict == verdict for one in same) for verdict in ("slower", "faster"))
        off = sum(not 1 / (1 + OFF) <= one.ratio <= 1 + OFF for one in same)
        worst = max((one.ratio for one in same), key=lambda ratio: max(ratio, 1 / ratio))
        neither = len(same) - slower - faster
        yield [name, f"{len(same)}", f"{slower}", f"{faster}", f"{neither}", f"{off}", f"{worst:.2f}"]


def neither_words(parts: list[Part]) -> Iterator[list[str]]:
    """What tetrabench said where it said neither faster nor slower."""
    yield ["verdict of tetrabench", "identical code", "+10 %", "+20 %", "+30 %"]
    found = [one for name, _, mine in verdicts(parts) if name == "tetrabench" for one in mine]
    shares = (0.0, 0.1, 0.2, 0.3)
    for verdict in sorted({one.verdict for one in found}):
        counts = [sum((one.verdict, one.injected) == (verdict, share) for one in found) for share in shares]
        yield [verdict, *map(str, counts)]


def power(parts: list[Part]) -> Iterator[list[str]]:
    """How often each slowdown was caught."""
    yield ["tool", "+10 % caught", "+20 %", "+30 %", "called faster"]
    for name, _, found in verdicts(parts):
        cells = []
        for share in (0.1, 0.2, 0.3):
            slowed = [one for one in found if one.injected == share]
            cells.append(f"{sum(one.verdict == 'slower' for one in slowed)} of {len(slowed)}")
        wrong = sum(one.verdict == "faster" for one in found if one.injected)
        yield [name, *cells, f"{wrong}"]


def times(parts: list[Part]) -> Iterator[list[str]]:
    """What a comparison cost."""
    yield ["tool", "version", "sessions", "a session took", "one contestant, one scenario", "load", "steal", "begun"]
    for tool in (*NAMED, "pair"):
        mine = [part for part in parts if part.tool == tool and part.comparisons]
        if mine:
            name = "tetrabench, two contestants alone" if tool == "pair" else tool
            session = f"{mean(part.seconds for part in mine) / 60:.1f} min"
            side = f"{mean(part.side_s for part in mine):.1f} s"
            load = f"{mean(part.load_1_minute or 0.0 for part in mine):.1f}"
            steal = f"{mean(part.steal_share or 0.0 for part in mine):.1%}"
            begun = min(part.begun for part in mine)[:16].replace("T", " ")
            yield [name, mine[0].version, f"{len(mine)}", session, side, load, steal, begun]


def costs(parts: list[Part]) -> Iterator[list[str]]:
    """Where the time of a run went, and what its parent took."""
    mine = [part for part in parts if "spent_s" in part.facts]
    inside = list(dict.fromkeys(what for part in mine for what in part.facts["spent_s"] if what not in OUTSIDE))
    yield ["run", "tetras", "samples", "took", *inside, "all else", "parent, MB"]
    for part in mine:
        shares = [f"{part.facts['spent_s'].get(what, 0.0) / part.seconds:.1%}" for what in inside]
        size, samples = part.facts["model_size"]["tetras"], part.facts["samples"]
        took, peak = f"{part.seconds:.0f} s", f"{part.facts['parent_peak_bytes'] / 1e6:.0f}"
        yield [part.part, f"{size:,}", f"{samples}", took, *shares, f"{overhead(part):.1%}", peak]


def rules(parts: list[Part]) -> Iterator[list[str]]:
    """How each tool says that there is a difference, and what was run."""
    yield ["tool", "its rule"]
    for tool in NAMED:
        if mine := [part for part in parts if part.tool == tool and part.comparisons]:
            yield [f"{tool} {mine[0].version}", mine[0].rule]


TABLES: dict[str, Callable[[list[Part]], Iterator[list[str]]]] = {
    "rules": rules,
    "equal codes": equal_codes,
    "verdicts": neither_words,
    "power": power,
    "times": times,
    "costs": costs,
}


def table(name: str, parts: list[Part]) -> str:
    """A table as Markdown; the first column is words, the others figures."""
    rows = list(TABLES[name](parts))
    rows.insert(1, ["---"] + ["---" if name == "rules" else "---:"] * (len(rows[0]) - 1))
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def tables(folder: Path = FOLDER) -> str:
    """All tables, one after the other."""
    parts = read(folder)
    return "\n\n".join(table(name, parts) for name in TABLES)


def marks(name: str) -> tuple[str, str]:
    """What stands around a table on the page."""
    return f"<!-- table {name}: begin -->", f"<!-- table {name}: end -->"


def shown(name: str, text: str) -> str:
    """What a page shows."""
    begin, end = marks(name)
    return text.partition(begin)[2].partition(end)[0].strip()


def rewrite(folder: Path = FOLDER) -> None:
    """Put the tables into the page."""
    parts, text = read(folder), PAGE.read_text()
    for name in TABLES:
        begin, end = marks(name)
        block = f"{begin}\n{table(name, parts)}\n{end}"
        text = re.sub(f"{begin}.*{end}", lambda _, block=block: block, text, flags=re.DOTALL)
    PAGE.write_text(text)
