"""How fast our bulk operations are beside peers from PyPI: both in turn in one process, one thread, CPU time.

    python tests/peers/bench_peers.py [--tets N] [--queries N] [--turns 21] [--turns meshio=7] [--only sides,gmsh] [-o FILE]

First all answers are compared, which warms everything up; a row whose answers differ is not timed. A turn is one sample
of ours and one of the peer, the order alternating. A row shows the medians, the median of the paired ratios ours / peer,
and an interval that holds it with 95 % (sign test); the bar is met where its upper end is. A peer that is not installed
is said to be missing, and its rows are left out.
"""

import argparse
import json
import math
import sys
import tempfile
import time
from collections.abc import Callable
from functools import partial
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

from contests import ROWS, Case, Contest, Row
from peers import MODULES, MissingPeerError, load_peer, peer_version

from tetrabench.bench.clock import Clocks, read_clocks
from tetrabench.bench.environment import describe_environment
from tetrabench.bench.pairs import FEWEST, in_turn, paired_ratio

ALONE = 1.02
"""CPU time of the process over that of its one thread: what is above had help from other threads."""


class Progress:
    """What happens now, on stderr, and how long the rest will take: on a terminal in one line, else now and then."""

    def __init__(self) -> None:
        self.remaining_s = 0.0
        self._said_at = -math.inf
        self._on_terminal = sys.stderr.isatty()

    def say(self, text: str) -> None:
        """This happens now."""
        if self._on_terminal:
            print(f"\r\x1b[K{text}", end="", file=sys.stderr, flush=True)
        else:
            print(text, file=sys.stderr, flush=True)

    def turn(self, turn_s: float, what: str, turns: int, done: int) -> None:
        """A turn is over that was expected to take `turn_s`."""
        self.remaining_s -= turn_s
        if self._on_terminal or time.monotonic() > self._said_at + 10:
            self._said_at = time.monotonic()
            self.say(f"{what}: turn {done} of {turns}, about {max(self.remaining_s, 0):.0f} s remaining")

    def clear(self) -> None:
        """Make room for a line of the table."""
        if self._on_terminal:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)


class Prepared(NamedTuple):
    """A contest, in what the answers differ ("" where they agree), and how long a turn takes in seconds."""

    contest: Contest
    difference: str
    turn_s: float


def sample(call: Callable[[], Any], tidy: Callable[[], Any] = lambda: None) -> Clocks:
    """The time of one call."""
    begin = read_clocks()
    answer = call()
    spent = read_clocks().since(begin)
    del answer
    tidy()
    return spent


def warm_up(contest: Contest) -> tuple[str, float]:
    """In what the answers differ ("" where they agree), and how long a turn takes when all is warm, in seconds."""
    ours, theirs = contest.ours(), contest.theirs()
    contest.tidy()
    difference = contest.differ(ours, theirs)
    del ours, theirs
    turn = time.monotonic()
    if not difference:
        sample(contest.ours)
        sample(contest.theirs, contest.tidy)
    return difference, time.monotonic() - turn


def measure(contest: Contest, bar: float | None, turns: int, each_turn: Callable[[int], None]) -> dict[str, Any]:
    """The figures of a row; times in seconds."""
    pairs = []
    for pair in in_turn(turns, lambda: sample(contest.ours), lambda: sample(contest.theirs, contest.tidy)):
        pairs.append(pair)
        each_turn(len(pairs))
    ours, theirs = ([clocks.process_cpu_s for clocks in side] for side in zip(*pairs, strict=True))
    of_the_thread = sum(clocks.cpu_s for pair in pairs for clocks in pair)
    ratio, low, high = paired_ratio(ours, theirs)
    return {
        "ours_s": median(ours),
        "peer_s": median(theirs),
        "ratio": ratio,
        "low": low,
        "high": high,
        "turns": turns,
        "met": None if bar is None else high <= bar,
        "one_thread": sum(ours) + sum(theirs) <= ALONE * of_the_thread,
        "pairs_s": list(zip(ours, theirs, strict=True)),
    }


HEADING = "operation     numbering peer             ours     peer   ratio  95 %            turns   bar"


def line(row: dict[str, Any]) -> str:
    """The line of a row."""
    head = f"{row['operation']:<14}{row['numbering']:<10}{row['peer']:<12}"
    if "difference" in row:
        return f"{head}NOT TIMED, the answers differ: {row['difference']}"
    verdict = {None: "", True: "met", False: "MISSED"}[row["met"]]
    if not row["one_thread"]:
        verdict = "NOT COMPARABLE: more than one thread ran"
    interval = f"[{row['low']:.3f}, {row['high']:.3f}]"
    bar = "" if row["bar"] is None else f"{row['bar']:.2f}"
    times = f"{1e3 * row['ours_s']:9.1f}{1e3 * row['peer_s']:9.1f}"
    return f"{head}{times}{row['ratio']:8.3f}  {interval:<16}{row['turns']:5}{bar:>6}  {verdict}".rstrip()


def find_peers(rows: list[Row]) -> tuple[dict[str, Any], dict[str, str]]:
    """The modules of the peers that there are, and why the others are missing."""
    modules, missing = {}, {}
    for name in dict.fromkeys(row.peer for row in rows):
        try:
            modules[name] = load_peer(name)
        except MissingPeerError as error:
            missing[name] = str(error)
    return modules, missing


def prepare(
    rows: list[Row], modules: dict[str, Any], cases: dict[str, Case], progress: Progress
) -> dict[Row, Prepared]:
    """The contests of all rows, answers compared."""
    prepared = {}
    for n, row in enumerate(rows):
        progress.say(f"comparing answers: {row.operation}, {row.numbering}, {row.peer} ({n + 1} of {len(rows)})")
        contest = row.contest(cases[row.numbering], modules[row.peer])
        prepared[row] = Prepared(contest, *warm_up(contest))
    return prepared


def run(rows: list[Row], modules: dict[str, Any], options: argparse.Namespace, folder: Path) -> list[dict[str, Any]]:
    """All rows, printed as they come."""
    progress = Progress()
    progress.say(f"making a box of {options.tets:,} tetras")
    numberings = dict.fromkeys(row.numbering for row in rows)
    cases = {numbering: Case(options.tets, options.queries, numbering, folder) for numbering in numberings}
    prepared = prepare(rows, modules, cases, progress)
    progress.remaining_s = sum(p.turn_s * options.turns_of(row.peer) for row, p in prepared.items())
    progress.clear()
    for case in list(cases.values())[:1]:
        mesh = case.mesh
        print(f"{len(mesh.tets):,} tetras, {len(mesh.points):,} points, {options.queries:,} queries; CPU ms")
    print(HEADING)
    results = []
    for row, (contest, difference, turn_s) in prepared.items():
        result: dict[str, Any] = row._asdict()
        del result["contest"]
        if difference:
            result["difference"] = difference
        else:
            turns = options.turns_of(row.peer)
            say = partial(progress.turn, turn_s, f"{row.operation}, {row.peer}", turns)
            result |= measure(contest, row.bar, turns, say)
        progress.clear()
        print(line(result), flush=True)
        results.append(result)
    return results


def turns_by_peer(words: list[str]) -> Callable[[str], int]:
    """Turns of a peer, from words such as "21" and "meshio=7".

    Raises:
        ValueError: a word is neither.
    """
    turns = {"": 21}
    for word in words:
        peer, _, count = word.rpartition("=")
        if not count.isdigit() or int(count) < FEWEST or (peer and peer not in MODULES):
            wanted = f"a number from {FEWEST} (an interval needs so many), or one for a peer, such as meshio=7"
            raise ValueError(f"--turns takes {wanted}; not {word!r}")
        turns[peer] = int(count)
    return lambda peer: turns.get(peer, turns[""])


def rows_of(words: set[str]) -> list[Row]:
    """The rows that have a word in each column for which there are words; all without words.

    Raises:
        ValueError: a word that stands in no column.
    """
    columns = [{row[k] for row in ROWS} for k in range(3)]  # operation, numbering, peer
    strange = words - set().union(*columns)
    if strange:
        there = ", ".join(word for column in columns for word in sorted(column))
        raise ValueError(f"--only takes {there}; not {', '.join(sorted(strange))}")
    return [row for row in ROWS if all(not words & column or row[k] in words for k, column in enumerate(columns))]


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
        options.turns_of = turns_by_peer(options.turns)
        wanted = rows_of(set(filter(None, options.only.split(","))))
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
