"""A contest: ours and somebody else's way to one answer, compared, then timed in turn in one process; the rows of a table.

First all answers are compared, which warms everything up; a row whose answers differ is not timed. A turn is one sample
of ours and one of the other's, the order alternating. A row shows the medians of CPU time, the median of the paired ratios
ours / theirs, and an interval that holds it with 95 % (sign test); the bar is met where its upper end is.
"""

import math
import sys
import time
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from statistics import median
from typing import Any, NamedTuple

from tetrabench.bench.clock import Clocks, read_clocks
from tetrabench.bench.pairs import FEWEST, in_turn, paired_ratio

ALONE = 1.02
"""CPU time of the process over that of its one thread: what is above had help from other threads."""

TURNS = 21


class Contest(NamedTuple):
    """Two ways to the same answer, and a judge.

    Attributes:
        ours, theirs: the timed calls.
        differ: says in what the answers differ, "" where they agree.
        tidy: called after each of theirs, untimed.
        fresh: called before each of ours, untimed.
    """

    ours: Callable[[], Any]
    theirs: Callable[[], Any]
    differ: Callable[[Any, Any], str]
    tidy: Callable[[], Any] = lambda: None
    fresh: Callable[[], Any] = lambda: None


class Row(NamedTuple):
    """A line of the table.

    Attributes:
        bar: what the ratio ours / peer must not exceed; None for a peer that is there for orientation.
        contest: made from the case and the peer's module or library.
    """

    operation: str
    numbering: str
    peer: str
    bar: float | None
    contest: Callable[[Any, Any], Contest]


class Prepared(NamedTuple):
    """A contest, in what the answers differ ("" where they agree), and how long a turn takes in seconds."""

    contest: Contest
    difference: str
    turn_s: float


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


# ---- measuring


def sample(
    call: Callable[[], Any], *, before: Callable[[], Any] = lambda: None, after: Callable[[], Any] = lambda: None
) -> Clocks:
    """The time of one call, without what goes before it, and without that of dropping its answer."""
    before()
    begin = read_clocks()
    answer = call()
    spent = read_clocks().since(begin)
    del answer
    after()
    return spent


def warm_up(contest: Contest) -> tuple[str, float]:
    """In what the answers differ ("" where they agree), and how long a turn takes when all is warm, in seconds."""
    contest.fresh()
    ours, theirs = contest.ours(), contest.theirs()
    contest.tidy()
    difference = contest.differ(ours, theirs)
    del ours, theirs
    turn = time.monotonic()
    if not difference:
        sample(contest.ours, before=contest.fresh)
        sample(contest.theirs, after=contest.tidy)
    return difference, time.monotonic() - turn


def measure(contest: Contest, bar: float | None, turns: int, each_turn: Callable[[int], None]) -> dict[str, Any]:
    """The figures of a row; times in seconds."""
    pairs = []
    one, other = (
        partial(sample, contest.ours, before=contest.fresh),
        partial(sample, contest.theirs, after=contest.tidy),
    )
    for pair in in_turn(turns, one, other):
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


def prepare(
    rows: list[Row], peers: Mapping[str, Any], cases: Mapping[str, Any], progress: Progress
) -> dict[Row, Prepared]:
    """The contests of all rows, answers compared: `peers` by name, `cases` by numbering."""
    prepared = {}
    for n, row in enumerate(rows):
        progress.say(f"comparing answers: {row.operation}, {row.numbering}, {row.peer} ({n + 1} of {len(rows)})")
        contest = row.contest(cases[row.numbering], peers[row.peer])
        prepared[row] = Prepared(contest, *warm_up(contest))
    return prepared


def contend(prepared: dict[Row, Prepared], turns_of: Callable[[str], int], progress: Progress) -> list[dict[str, Any]]:
    """The figures of all rows, printed as they come; `turns_of` a peer."""
    progress.remaining_s = sum(p.turn_s * turns_of(row.peer) for row, p in prepared.items())
    results = []
    for row, (contest, difference, turn_s) in prepared.items():
        result: dict[str, Any] = row._asdict()
        del result["contest"]
        if difference:
            result["difference"] = difference
        else:
            turns = turns_of(row.peer)
            say = partial(progress.turn, turn_s, f"{row.operation}, {row.peer}", turns)
            result |= measure(contest, row.bar, turns, say)
        progress.clear()
        print(line(result), flush=True)
        results.append(result)
    return results


# ---- the table

HEADING = "operation               numbering       peer             ours     peer   ratio  95 %            turns   bar"


def line(row: dict[str, Any]) -> str:
    """The line of a row; times in milliseconds."""
    head = f"{row['operation']:<24}{row['numbering']:<16}{row['peer']:<12}"
    if "difference" in row:
        return f"{head}NOT TIMED, the answers differ: {row['difference']}"
    verdict = {None: "", True: "met", False: "MISSED"}[row["met"]]
    if not row["one_thread"]:
        verdict = "NOT COMPARABLE: more than one thread ran"
    interval = f"[{row['low']:.3f}, {row['high']:.3f}]"
    bar = "" if row["bar"] is None else f"{row['bar']:.2f}"
    times = f"{_milliseconds(row['ours_s'])}{_milliseconds(row['peer_s'])}"
    return f"{head}{times}{row['ratio']:8.3f}  {interval:<16}{row['turns']:5}{bar:>6}  {verdict}".rstrip()


def _milliseconds(seconds: float) -> str:
    return f"{1e3 * seconds:9.{1 if seconds >= 0.01 else 3}f}"


# ---- the command line


def turns_by_peer(words: list[str], peers: Iterable[str], example: str) -> Callable[[str], int]:
    """Turns of a peer, from words such as "21" and `example`.

    Raises:
        ValueError: a word is neither.
    """
    turns = {"": TURNS}
    for word in words:
        peer, _, count = word.rpartition("=")
        if not count.isdigit() or int(count) < FEWEST or (peer and peer not in peers):
            wanted = f"a number from {FEWEST} (an interval needs so many), or one for a peer, such as {example}"
            raise ValueError(f"--turns takes {wanted}; not {word!r}")
        turns[peer] = int(count)
    return lambda peer: turns.get(peer, turns[""])


def rows_of(rows: list[Row], words: set[str]) -> list[Row]:
    """The rows that have a word in each column for which there are words; all without words.

    Raises:
        ValueError: a word that stands in no column.
    """
    columns: list[set[str]] = [
        set(column) for column in list(zip(*rows, strict=True))[:3]
    ]  # operation, numbering, peer
    strange = words - set().union(*columns)
    if strange:
        there = ", ".join(word for column in columns for word in sorted(column))
        raise ValueError(f"--only takes {there}; not {', '.join(sorted(strange))}")
    return [row for row in rows if all(not words & column or row[k] in words for k, column in enumerate(columns))]
