"""Repeat the committed run that README.md shows, and put its table there: `make results`."""

import re
import subprocess
import sys
from pathlib import Path

RESULTS = Path(__file__).parent
README = RESULTS.parent / "README.md"
RUN = RESULTS / "nozzle-120k-quick.json"
BEGIN, END = "<!-- table: begin -->", "<!-- table: end -->"


def tetrabench(*arguments: str) -> str:
    """Run the command line and return what it printed; progress goes where it always goes."""
    command = [sys.executable, "-m", "tetrabench", *arguments]
    return subprocess.run(command, check=True, stdout=subprocess.PIPE, text=True).stdout


def table() -> str:
    """The table of the committed run, as Markdown."""
    return tetrabench("show", str(RUN), "--format", "md").strip()


def shown() -> str:
    """What README.md shows."""
    return README.read_text().partition(BEGIN)[2].partition(END)[0].strip()


def main() -> None:
    """Run, draw, and rewrite the table; with --table the committed run is only shown anew."""
    charts = ["--charts", str(RESULTS / RUN.stem)]
    (RESULTS / RUN.stem).mkdir(exist_ok=True)
    if "--table" in sys.argv[1:]:
        tetrabench("show", str(RUN), *charts)
    else:
        tetrabench("run", "--model", "nozzle", "--tets", "120k", "--quick", "-o", str(RUN), *charts)
    block = f"{BEGIN}\n{table()}\n{END}"
    README.write_text(re.sub(f"{BEGIN}.*{END}", lambda _: block, README.read_text(), flags=re.DOTALL))


if __name__ == "__main__":
    main()
