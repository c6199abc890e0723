"""What a structure takes in memory, in a process of its own: `python -m tests.cgal.weigh WAY LIBRARY TETS NUMBERING`.

What it holds is what the process has more of its own when the structure is there and nothing else is. Prints JSON.
"""

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np

from tests.cgal.contests import Case
from tests.cgal.library import Held, at, load
from tetrabench.bench.memory import WEIGHING, private_bytes

WAYS = ("half-face", "cgal")
BAR = 36.0
"""Bytes a tetra of the half-face kernel, of 623,000: retained, and by its own count."""

HEADING = "structure     numbering     tetras   retained    by its own count   bar   (bytes a tetra)"


def weigh(way: str, library: Path, tets: int, numbering: str) -> dict[str, Any]:
    """Build in a fresh process, without coordinates and attributes; sizes in bytes."""
    command = [sys.executable, "-m", __name__, way, str(library), str(tets), numbering]
    top = str(Path(__file__).parents[2])
    done = subprocess.run(command, env=os.environ | WEIGHING, cwd=top, capture_output=True, text=True, check=True)
    row: dict[str, Any] = json.loads(done.stdout)
    bar = BAR if way == "half-face" else None
    per_tetra = None if row["retained"] is None else row["retained"] / row["tetras"]
    most = max(row["retained"] or 0, row["counted"]) / row["tetras"]
    met = None if bar is None or per_tetra is None else most <= bar
    return {"structure": way, "numbering": numbering, **row, "per_tetra": per_tetra, "bar": bar, "met": met}


def line(row: dict[str, Any]) -> str:
    """The line of a structure."""
    verdict = {None: "", True: "met", False: "MISSED"}[row["met"]]
    retained = "unknown" if row["per_tetra"] is None else f"{row['per_tetra']:.2f}"
    bar = "" if row["bar"] is None else f"{row['bar']:.0f}"
    counted = f"{row['counted'] / row['tetras']:.2f}"
    return (
        f"{row['structure']:<14}{row['numbering']:<10}{row['tetras']:10,}{retained:>11}{counted:>20}{bar:>6}  {verdict}"
    ).rstrip()


def main() -> None:
    """Weigh one in this process."""
    way, library, tets, numbering = sys.argv[1:]
    functions = load(Path(library))
    small, case = Case(functions, 600, numbering), Case(functions, int(tets), numbering)
    build = {"half-face": Case.construct, "cgal": _build_cgal}[way]
    build(small)  # compiles, and loads what is compiled
    before = private_bytes()
    held = build(case)
    after = private_bytes()
    if way == "half-face":
        counted = sum(reserved for _, reserved in held.structure_bytes().values())
    else:
        counts = np.empty(4, np.int64)
        functions.bare_counts(held.pointer, at(counts))
        counted = int(counts[0] * counts[2] + counts[1] * counts[3])
    retained = None if before is None or after is None else after - before
    print(json.dumps({"tetras": len(case.tets), "retained": retained, "counted": counted}))


def _build_cgal(case: Case) -> Held:
    functions = case.functions
    return Held(functions.bare_build(at(case.tets), len(case.tets), case.vertices), functions.bare_free)


if __name__ == "__main__":
    main()
