"""How fast the formats of polygon meshes are beside plain tables in C, CGAL's Surface_mesh, OpenMesh and xugrid.

    python -m tests.polygon_peers [--model quad] [--cells N] [--turns 21] [--turns xugrid=7] [--only build,by-cell] [-o FILE]

Both in turn in one process, on the same mesh, one thread, CPU time; how a row is measured: tests/contest.py. Each query fills a
list and adds it up, of all elements in order, and of a million at random ("random ..."). "build" is from the cells' nodes to
the format; beside xugrid all four of our tables, of it the neighbours of cells alone. CPU ms: of a million elements, so many
ns an element ("elements" in the file says of how many).
"""

import argparse
import json
import sys
import tempfile
from pathlib import Path
from typing import Any

from tests.contest import HEADING, Progress, contend, prepare, rows_of, turns_by_peer
from tests.polygon_peers.contests import ROWS, Case, bars_of, elements_of, unsteady
from tests.polygon_peers.library import FLAGS, load_peers
from tetrabench.bench.environment import describe_environment
from tetrabench.mesh.polygon.models import MODELS, generate_polygons


def parse(words: list[str] | None) -> argparse.Namespace:
    """The command line; also `rows`, and `turns_of` a peer."""
    parser = argparse.ArgumentParser(
        prog="python -m tests.polygon_peers", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--model", default="quad", choices=MODELS)
    parser.add_argument("--cells", type=int, default=1_000_000)
    parser.add_argument("--turns", action="append", default=[], help="N for all, PEER=N for one; by default 21")
    parser.add_argument("--only", default="", help="operations, formats, peers, comma separated")
    parser.add_argument("-o", "--output", type=Path, help="a JSON file")
    options = parser.parse_args(words)
    try:
        options.turns_of = turns_by_peer(options.turns, {row.peer for row in ROWS}, "xugrid=7")
        options.rows = rows_of(ROWS, set(filter(None, options.only.split(","))))
    except ValueError as error:
        parser.error(str(error))
    if options.output and not options.output.parent.is_dir():
        parser.error(f"there is no folder {options.output.parent}")
    return options


def main(words: list[str] | None = None) -> int:
    """Do what the command line says; 1 where answers differ."""
    options, progress = parse(words), Progress()
    progress.say(f"making {options.model} of {options.cells:,} cells")
    mesh = generate_polygons(options.model, options.cells)
    with tempfile.TemporaryDirectory() as folder:
        peers: dict[str, Any]
        peers, missing = load_peers(Path(folder), mesh, progress)
        weights = {name: peer.bytes / mesh.number_of_cells for name, peer in peers.items()}
        versions = {name: peer.version for name, peer in peers.items()}
        try:
            import xugrid

            peers["xugrid"], versions["xugrid"] = xugrid, xugrid.__version__
        except ImportError:
            missing["xugrid"] = "not installed; pip install xugrid"
        rows = [row for row in options.rows if row.peer in peers]
        cases = {name: Case(mesh, name) for name in dict.fromkeys(row.numbering for row in rows)}
        prepared = prepare(rows, peers, cases, progress)
        progress.clear()
        print(f"{mesh.report.source}; {' '.join(FLAGS)}; CPU ms\n{HEADING.replace('numbering', 'format   ')}")
        results = contend(prepared, options.turns_of, progress)
    for row in results:
        row["elements"] = elements_of(row["operation"], mesh)
    weights |= {name: 4 * case.net.values() / mesh.number_of_cells for name, case in cases.items()}
    print("bytes a cell: " + ", ".join(f"{name} {weight:.1f}" for name, weight in weights.items()))
    bars = bars_of(results)
    print(f"bars reached: {sum(bar['reached'] for bar in bars)} of {len(bars)}")
    for bar in bars:
        over = ", ".join(name for name, under in bar["formats"].items() if not under)
        if over:
            verdict = "reached, but not by" if bar["reached"] else "not reached:"
            print(f"{bar['operation']} beside {bar['peer']}, {bar['bar']:g}: {verdict} {over}")
    doubtful = unsteady(results)
    for row in doubtful:
        times = f"{1e3 * row['low_s']:.3g} to {1e3 * row['high_s']:.3g} ms"
        print(
            f"{row['operation']}: {row['peer']} took {times} for the same; do not believe it, run again when all is quiet"
        )
    for name, reason in missing.items():
        print(f"{name} is missing, its rows are left out: {reason}")
    if options.output:
        document = {
            "command": " ".join(["python", "-m", "tests.polygon_peers", *(sys.argv[1:] if words is None else words)]),
            "environment": describe_environment() | {"flags": " ".join(FLAGS), "versions": versions},
            "missing": missing,
            "mesh": mesh.report.source,
            "bytes_a_cell": weights,
            "bars": bars,
            "unsteady": doubtful,
            "rows": results,
        }
        options.output.write_text(json.dumps(document, indent=1) + "\n")
    return int(any("difference" in row for row in results))


if __name__ == "__main__":
    sys.exit(main())
