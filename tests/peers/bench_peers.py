"""How fast our bulk operations are beside peers from PyPI: both in turn in one process, one thread, CPU time.

    python tests/peers/bench_peers.py [--tets N] [--queries N] [--turns 21] [--turns meshio=7] [--only sides,gmsh] [-o FILE]

First all answers are compared, which warms everything up; a row whose answers differ is not timed. A turn is one sample
of ours and one of the peer, the order alternating. A row shows the medians, the median of the paired ratios ours / peer,
and an interval that holds it with 95 % (sign test); the bar is met where its upper end is. A peer that is not installed
is said to be missing, and its rows are left out.
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parents[2]))  # this is a script: where the package tests is

from contests import ROWS, Case
from examples import EXAMPLES
from peers import MODULES, MissingPeerError, load_peer, peer_version

from tests.contest import HEADING, Progress, Row, contend, prepare, rows_of, turns_by_peer
from tetrabench.bench.environment import describe_environment


def find_peers(rows: list[Row]) -> tuple[dict[str, Any], dict[str, str]]:
    """The modules of the peers that there are, and why the others are missing."""
    modules, missing = {}, {}
    for name in dict.fromkeys(row.peer for row in rows):
        try:
            modules[name] = load_peer(name)
        except MissingPeerError as error:
            missing[name] = str(error)
    return modules, missing


def run(rows: list[Row], modules: dict[str, Any], options: argparse.Namespace, folder: Path) -> list[dict[str, Any]]:
    """All rows, printed as they come."""
    progress = Progress()
    progress.say(f"making a box of {options.tets:,} tetras")
    numberings = dict.fromkeys(row.numbering for row in rows)
    cases = {numbering: Case(options.tets, options.queries, numbering, folder) for numbering in numberings}
    prepared = prepare(rows, modules, cases, progress)
    progress.clear()
    for case in list(cases.values())[:1]:
        mesh = case.mesh
        print(f"{len(mesh.tets):,} tetras, {len(mesh.points):,} points, {options.queries:,} queries; CPU ms")
    print(HEADING)
    return contend(prepared, options.turns_of, progress)


def main() -> int:
    """Do what the command line says; 1 where answers differ."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tets", type=int, default=623_000)
    parser.add_argument("--queries", type=int, default=155_000, help="points to find (nearest, locate)")
    parser.add_argument("--turns", action="append", default=[], help="N for all, PEER=N for one; by default 21")
    parser.add_argument("--only", default="", help="operations, numberings and peers, comma separated")
    parser.add_argument("-o", "--output", type=Path, help="a JSON file")
    options = parser.parse_args()
    try:
        options.turns_of = turns_by_peer(options.turns, MODULES, "meshio=7")
        wanted = rows_of(ROWS + EXAMPLES, set(filter(None, options.only.split(","))))
    except ValueError as error:
        parser.error(str(error))
    if min(options.tets, options.queries) < 100:
        parser.error("--tets and --queries take numbers from 100")
    if options.output and not options.output.parent.is_dir():
        parser.error(f"there is no folder {options.output.parent}")

    modules, missing = find_peers(wanted)
    with tempfile.TemporaryDirectory() as folder:
        results = run([row for row in wanted if row.peer in modules], modules, options, Path(folder))
    for name, reason in missing.items():
        print(f"{name} is missing, its rows are left out: {reason}")
    if options.output:
        document = {
            "command": " ".join(["python", "tests/peers/bench_peers.py", *sys.argv[1:]]),
            "environment": describe_environment() | {name: peer_version(name) for name in modules},
            "missing": missing,
            "tets": options.tets,
            "queries": options.queries,
            "rows": results,
        }
        options.output.write_text(json.dumps(document, indent=1) + "\n")
    return int(any("difference" in result for result in results))


if __name__ == "__main__":
    sys.exit(main())
