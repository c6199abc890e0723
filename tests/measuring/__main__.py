"""Make the evidence that docs/measuring.md shows: `make measuring`, or `python -m tests.measuring [PART ...]`.

Each part is a session of one tool on a busy machine, or a run whose cost is looked at, and leaves a file in
results/measuring/. A part that has its file is not made again: what was broken off goes on where it was. The tools take
turns, so that all are asked within the same hour. In the end the tables and the picture of the page are made anew.
"""

import argparse
import shutil
import sys
import tempfile
import time
from pathlib import Path

from tests.measuring import cost, page, picture, tools
from tests.measuring.record import FOLDER, save

ORDER = (
    "tetrabench tetrabench tetrabench pytest-benchmark tetrabench hyperfine tetrabench tetrabench pytest-benchmark "
    "tetrabench tetrabench pyperf tetrabench tetrabench pair"
)
"""The sessions in turns, so that all tools are asked within the same hour."""

SESSIONS = {f"{tool}-{ORDER.split()[:place].count(tool)}": tool for place, tool in enumerate(ORDER.split())}
PARTS = SESSIONS | dict.fromkeys(cost.RUNS, "cost")
"""Part -> the tool whose session it is, in the order in which they are made; a part's place is its seed."""


def make(part: str, folder: Path, kept: Path, *, tiny: bool) -> None:
    """Make a part."""
    start = time.monotonic()
    print(f"{part} ...", file=sys.stderr, flush=True)
    if PARTS[part] == "cost":
        made = cost.measure(part, folder, tiny=tiny)
    else:
        made = tools.measure(part, PARTS[part], list(PARTS).index(part) + 1, folder, tiny=tiny)
    save(made, kept)
    print(f"{part}: {time.monotonic() - start:.0f} s", file=sys.stderr, flush=True)


def main() -> int:
    """The parts named, or all that are missing."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("parts", nargs="*", metavar="PART", help=f"made again if need be: {', '.join(PARTS)}")
    parser.add_argument("--page", action="store_true", help="measure nothing, only make the page anew")
    parser.add_argument("--tiny", action="store_true", help="as little as can be, kept nowhere: does all of it work?")
    options = parser.parse_args()
    strange = [part for part in options.parts if part not in PARTS]
    if strange:
        parser.error(f"no part is called {', '.join(strange)}")
    if shutil.which("hyperfine") is None and not options.page:
        parser.error("hyperfine is missing: apt install hyperfine")
    with tempfile.TemporaryDirectory() as scratch:
        kept = Path(scratch) / "kept" if options.tiny else FOLDER
        kept.mkdir(parents=True, exist_ok=True)
        missing = [part for part in PARTS if not (kept / f"{part}.json").exists()]
        for part in [] if options.page else options.parts or missing:
            make(part, Path(scratch) / part, kept, tiny=options.tiny)
        if options.tiny:
            print(page.tables(kept))
        else:
            picture.draw(kept)
            page.rewrite(kept)
    return 0


if __name__ == "__main__":
    sys.exit(main())
