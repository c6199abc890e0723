"""How fast our half-face kernel is beside CGAL: both in turn in one process, on the same arrays, one thread, CPU time.

    python -m tests.cgal [--tets N] [--turns 21] [--turns cgal-call=7] [--only construct,shuffled] [-o FILE]

How a row is measured: tests/contest.py. The peers: CGAL's structure filled by hand ("cgal"), by its own call
("cgal-call"), its Delaunay triangulation of the same points ("delaunay"); plain loops in C++ ("c"), a table of the tetras
around each vertex in C++ ("table"; made each time: "table-made"). Then the cost of a query over the size of the mesh
("curve"), and what the structures take in memory ("memory").

"collect" flags and collects 20,000 tetras, "add" adds them again, each beside 20,000 pairs of CGAL's raw delete_cell and
create_cell. "around" visits the tetras around all vertices and looks at each, "around-ids" only takes their numbers;
"list-around" is one_to_all_many of all vertices.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path
from typing import Any

from tests.cgal import curve, weigh
from tests.cgal.contests import CUBES, NUMBERINGS, ROWS, Case, Cube, peers_of
from tests.cgal.library import COMPILER, FLAGS, build, compiler_version, load
from tests.contest import HEADING, Progress, Row, contend, prepare, rows_of, turns_by_peer
from tetrabench.bench.environment import describe_environment
from tetrabench.errors import InputError

PARTS = ("curve", "memory")
"""What is no row, and can be asked for like one."""


def run_rows(rows: list[Row], functions: Any, options: argparse.Namespace, progress: Progress) -> list[dict[str, Any]]:
    """The figures of all rows, printed as they come."""
    progress.say(f"making a box of {options.tets:,} tetras")
    cases: dict[str, Case | Cube] = {}
    for numbering in dict.fromkeys(row.numbering for row in rows):
        is_cube = numbering in CUBES
        cases[numbering] = Cube(functions, CUBES[numbering]) if is_cube else Case(functions, options.tets, numbering)
    prepared = prepare(rows, peers_of(functions)[0], cases, progress)
    progress.clear()
    print(HEADING)
    return contend(prepared, options.turns_of, progress)


def run_curve(functions: Any, options: argparse.Namespace, progress: Progress) -> list[dict[str, Any]]:
    """The points of the curve, and its picture where one is wanted."""
    points = curve.measure(functions, options.sizes, options.turns_of(""), progress)
    progress.clear()
    print(f"\n{curve.HEADING}")
    for point in points:
        print(curve.line(point))
    if options.picture:
        curve.draw(points, options.picture)
    return points


def run_memory(library: Path, options: argparse.Namespace, progress: Progress) -> list[dict[str, Any]]:
    """What both structures take."""
    rows = []
    for way in weigh.WAYS:
        for numbering in NUMBERINGS:
            progress.say(f"memory: {way}, {numbering}")
            rows.append(weigh.weigh(way, library, options.tets, numbering))
    progress.clear()
    print(f"\n{weigh.HEADING}")
    for row in rows:
        print(weigh.line(row))
    return rows


def parse(words: list[str] | None) -> argparse.Namespace:
    """The command line; also `rows`, `parts`, and `turns_of` a peer."""
    parser = argparse.ArgumentParser(
        prog="python -m tests.cgal", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--tets", type=int, default=623_000)
    parser.add_argument("--sizes", default=",".join(map(str, curve.SIZES)), help="tetras of the meshes of the curve")
    parser.add_argument("--turns", action="append", default=[], help="N for all, PEER=N for one; by default 21")
    parser.add_argument("--only", default="", help="operations, numberings, peers, curve, memory, comma separated")
    parser.add_argument("--picture", type=Path, help="a file for the picture of the curve, .svg or .png")
    parser.add_argument("-o", "--output", type=Path, help="a JSON file")
    options = parser.parse_args(words)
    only = set(filter(None, options.only.split(",")))
    try:
        options.turns_of = turns_by_peer(options.turns, {row.peer for row in ROWS}, "cgal-call=7")
        options.rows = rows_of(ROWS, only - set(PARTS)) if only - set(PARTS) or not only else []
        options.sizes = [int(size) for size in options.sizes.split(",")]
    except ValueError as error:
        parser.error(str(error))
    options.parts = [part for part in PARTS if part in only or not only]
    if min(options.tets, *options.sizes) < 100:
        parser.error("--tets and --sizes take numbers from 100")
    for path in (options.output, options.picture):
        if path and not path.parent.is_dir():
            parser.error(f"there is no folder {path.parent}")
    return options


def main(words: list[str] | None = None) -> int:
    """Do what the command line says; 1 where answers differ, 2 where something is missing."""
    options, progress = parse(words), Progress()
    with tempfile.TemporaryDirectory() as folder:
        try:
            library = build(Path(folder), progress)
        except InputError as error:
            print(f"bench-cgal: {error}", file=sys.stderr)
            return error.exit_code
        functions = load(library)
        peers, missing = peers_of(functions)
        version = functions.cgal_version()
        cgal = f"{version // 10_000_000 - 100}.{version // 100_000 % 100}.{version // 10_000 % 10}"
        progress.clear()
        print(f"CGAL {cgal}, {compiler_version()}, {' '.join(FLAGS)}; {options.tets:,} tetras; CPU ms")
        rows = [row for row in options.rows if row.peer in peers]
        document: dict[str, Any] = {
            "command": " ".join(["python", "-m", "tests.cgal", *(sys.argv[1:] if words is None else words)]),
            "environment": describe_environment()
            | {"cgal": cgal, "compiler": compiler_version(), "flags": " ".join([COMPILER, *FLAGS])},
            "missing": missing,
            "tets": options.tets,
            "rows": run_rows(rows, functions, options, progress) if rows else [],
        }
        if "curve" in options.parts:
            document["curve"] = run_curve(functions, options, progress)
        if "memory" in options.parts:
            document["memory"] = run_memory(library, options, progress)
    for name, reason in missing.items():
        print(f"{name} is missing, its rows are left out: {reason}")
    if options.output:
        options.output.write_text(json.dumps(document, indent=1) + "\n")
    return int(any("difference" in row for row in document["rows"]))


if __name__ == "__main__":
    sys.exit(main())
