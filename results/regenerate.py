"""Repeat the committed runs, and put their tables into the pages that show them: `make results`, `make thesis`."""

import argparse
import re
import subprocess
import sys
from pathlib import Path

RESULTS = Path(__file__).parent
RUNS = {
    "nozzle-120k-quick": "--model nozzle --tets 120k --quick",
    "thesis-nozzle": "--model nozzle --thesis",
    "thesis-nozzle-shuffled": "--model nozzle --numbering shuffled --thesis",
    "thesis-intake": "--model intake --thesis",
    "thesis-intake-shuffled": "--model intake --numbering shuffled --thesis",
}
"""File in this folder -> what `tetrabench run` is told."""

PAGES = {name: (RESULTS if name.startswith("thesis") else RESULTS.parent) / "README.md" for name in RUNS}


def tetrabench(*arguments: str) -> str:
    """Run the command line and return what it printed; progress goes where it always goes."""
    command = [sys.executable, "-m", "tetrabench", *arguments]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def table(name: str) -> str:
    """The table of a committed run, as Markdown."""
    return tetrabench("show", str(RESULTS / f"{name}.json"), "--format", "md").strip()


def marks(name: str) -> tuple[str, str]:
    """What stands around the table on its page."""
    return f"<!-- table {name}: begin -->", f"<!-- table {name}: end -->"


def shown(name: str) -> str:
    """What the page shows."""
    begin, end = marks(name)
    return PAGES[name].read_text().partition(begin)[2].partition(end)[0].strip()


def regenerate(name: str, *, run: bool) -> None:
    """Run, draw, and rewrite the table; or show the committed run anew."""
    file, folder = RESULTS / f"{name}.json", RESULTS / name
    folder.mkdir(exist_ok=True)
    if run:
        tetrabench("run", *RUNS[name].split(), "-o", str(file), "--charts", str(folder))
    else:
        tetrabench("show", str(file), "--charts", str(folder))
    begin, end = marks(name)
    block = f"{begin}\n{table(name)}\n{end}"
    page = PAGES[name].read_text()
    PAGES[name].write_text(re.sub(f"{begin}.*{end}", lambda _: block, page, flags=re.DOTALL))


def main() -> None:
    """The runs named, or all."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("runs", nargs="*", metavar="RUN", help=", ".join(RUNS))
    parser.add_argument("--table", action="store_true", help="run nothing, show what is committed")
    options = parser.parse_args()
    strange = ", ".join(name for name in options.runs if name not in RUNS)
    if strange:
        parser.error(f"no run {strange}; there are: {', '.join(RUNS)}")
    for name in options.runs or RUNS:
        regenerate(name, run=not options.table)


if __name__ == "__main__":
    main()
