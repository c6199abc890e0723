"""What was counted and timed along the run: of each backend a number for each stretch, over the steps.

Counts do not depend on the sample, so that the first one tells them. Times are medians over samples.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby, pairwise
from statistics import median

from tetrabench.bench.record import Results
from tetrabench.bench.statistics import Row
from tetrabench.report.lines import Line, few_of_each, lines_of

MOST = 100
"""Stretches of a line: in a longer run neighbours are joined, so that a page stays small."""
STEP, SECONDS = "step", "_s"
"""The series of the number of the last step of each stretch, 1 the first; and what a series of seconds ends with."""
WHOLE = "all phases"
"""The sum of all series of seconds."""


@dataclass(frozen=True)
class Track:
    """A quantity of a backend along the run.

    Attributes:
        quantity: WHOLE or a phase, of times; else what was counted.
        is_time: whether the values are seconds of one step (of one stretch, where steps are not known).
        places: the last step of each stretch, or its number.
    """

    line: Line
    quantity: str
    is_time: bool
    places: list[float]
    values: list[float]


@dataclass(frozen=True)
class Course:
    """What is known along the run of a task on a model.

    Attributes:
        axis: "step" or "stretch".
        left_out: how many lines are not drawn, see lines.MOST_ALIKE.
    """

    model: str
    task: str
    axis: str
    tracks: list[Track]
    left_out: int = 0

    @property
    def quantities(self) -> dict[str, bool]:
        """Times first, in the order of the run: quantity -> whether it is a time."""
        ordered = sorted(self.tracks, key=lambda track: not track.is_time)
        return {track.quantity: track.is_time for track in ordered}

    def heading(self, quantity: str) -> str:
        """What a panel is called."""
        if not self.quantities[quantity]:
            return quantity.replace("_", " ")
        return f"time of a {self.axis}" + (f": {quantity}" if quantity != WHOLE else "")

    @property
    def lines(self) -> list[Line]:
        """Whoever has a track."""
        return list({id(track.line): track.line for track in self.tracks}.values())


def courses_of(results: Results, rows: Iterable[Row]) -> list[Course]:
    """For each model and task with series of several stretches, in the order of the run's summary `rows`."""
    cells = groupby(lines_of(results, rows), lambda line: (line.row.model, line.row.task))
    courses = []
    for (model, task), lines in cells:
        shown = [line for line in lines if _series(line)]
        axis = STEP if all(STEP in series for line in shown for series in _series(line)) else "stretch"
        few = few_of_each(line.backend for line in shown)
        chosen = [line for line in shown if line.backend in few]
        tracks = [track for line in chosen for track in _tracks(line, axis)]
        if tracks:
            courses.append(Course(model, task, axis, tracks, len(shown) - len(chosen)))
    return courses


def _series(line: Line) -> list[Mapping[str, Sequence[float]]]:
    """Those of its samples that are of several stretches, all as long as the first."""
    known = [one.series for one in line.samples if any(len(values) > 1 for values in one.series.values())]
    return [one for one in known if {*map(len, one.values())} == {len(next(iter(known[0].values())))}]


def _tracks(line: Line, axis: str) -> list[Track]:
    """One quantity after the other."""
    several = _series(line)
    count = len(next(iter(several[0].values())))
    ends = _ends(count)
    steps = list(several[0][STEP]) if axis == STEP else [stretch + 1.0 for stretch in range(count)]
    places = [steps[end] for end in ends]
    lengths = [max(1.0, after - before) for before, after in pairwise([0.0, *places])]
    phases = [name for name in several[0] if name.endswith(SECONDS)]
    shown = {WHOLE: phases} | ({name.removesuffix(SECONDS): [name] for name in phases} if len(phases) > 1 else {})
    times = {quantity: _per_step(several, names, ends, lengths) for quantity, names in shown.items() if names}
    counts = {name: values for name, values in several[0].items() if name != STEP and name not in phases}
    return [Track(line, quantity, True, places, values) for quantity, values in times.items()] + [
        Track(line, name, False, places, [values[end] for end in ends]) for name, values in counts.items()
    ]


def _ends(count: int) -> list[int]:
    """The last of the stretches that are joined, for each that is drawn."""
    joined = -(-count // MOST)
    return [*range(joined - 1, count - 1, joined), count - 1]


def _per_step(
    several: Sequence[Mapping[str, Sequence[float]]],
    phases: Sequence[str],
    ends: Sequence[int],
    lengths: Sequence[float],
) -> list[float]:
    """Seconds of a step in each stretch that is drawn, all `phases` together: the median over samples."""
    begins = [0, *(end + 1 for end in ends[:-1])]
    return [
        median(sum(sum(series[phase][begin : end + 1]) for phase in phases) / length for series in several)
        for begin, end, length in zip(begins, ends, lengths, strict=True)
    ]
