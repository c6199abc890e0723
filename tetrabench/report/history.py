"""A history as a chart: the ratios of each backend over the commits, a panel for each task."""

from collections.abc import Sequence
from itertools import groupby, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tetrabench.bench.history import Entry, Point
from tetrabench.errors import InputError, find_named
from tetrabench.report.plain import no_formula, plain

if TYPE_CHECKING:
    from matplotlib.axes import Axes

ADVISORY = "Advisory: runs at different times. Only a gate, which runs both versions in turns, decides."
MARKS = "osD^vP*X<>"
HEIGHT, WIDTH, LABELS = 2.4, 9.0, 24
TICKS = (1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 7.0)


def draw_history(
    entries: Sequence[Entry],
    path: Path,
    *,
    scenarios: Sequence[str] | None = None,
    backends: Sequence[str] | None = None,
) -> None:
    """Draw a chart; its format is that of the file's name.

    A line breaks, and a broken vertical line stands, where the environment changed: what is left and right of it
    cannot be compared.

    Raises:
        InputError: nothing to draw, unknown names, or the file cannot be written.
    """
    import matplotlib
    from matplotlib.figure import Figure
    from matplotlib.ticker import LogLocator, NullLocator

    entries = plain([*entries], no_formula)
    panels = _panels(entries, scenarios, backends)
    names = list(dict.fromkeys(one.backend for entry in entries for one in entry.points))
    names = [name for name in names if backends is None or name in backends]
    with matplotlib.rc_context({"font.size": 9, "svg.hashsalt": "tetrabench"}):
        figure = Figure(figsize=(WIDTH, HEIGHT * len(panels) + 1.2), layout="constrained")
        grid = figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0].tolist()
        for axes, (model, task) in zip(grid, panels, strict=True):
            for place, name in enumerate(names):
                _draw_line(axes, entries, (model, task, name), MARKS[place % len(MARKS)], f"C{place % 10}")
            _mark_changes(axes, entries)
            axes.axhline(1.0, color="0.4", linewidth=0.8)
            axes.set_yscale("log")
            axes.yaxis.set_major_locator(LogLocator(subs=TICKS, numticks=99))
            axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}x")
            axes.yaxis.set_minor_locator(NullLocator())
            axes.set_title(f"{task}, {model}", loc="left", fontsize=9)
            axes.grid(axis="y", color="0.9")
            axes.margins(x=0.03)
        _label_commits(grid[-1], entries)
        handles, labels = _legend_of(grid)
        figure.legend(handles, labels, loc="outside right upper", frameon=False)
        reference = ", ".join(dict.fromkeys(entry.reference for entry in entries))
        figure.suptitle(f"Times that of {reference}, with intervals: less is better", fontsize=11)
        figure.supxlabel(f"commit, and day of the run. {ADVISORY}", fontsize=8)
        try:
            figure.savefig(path, dpi=150)
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: cannot write the chart: {error}") from error


def _panels(
    entries: Sequence[Entry], scenarios: Sequence[str] | None, backends: Sequence[str] | None
) -> list[tuple[str, str]]:
    """The models and tasks that are asked for."""
    points = [one for entry in entries for one in entry.points]
    for kind, wanted, known in (
        ("scenario", scenarios, {one.task: None for one in points} | {one.task.split()[0]: None for one in points}),
        ("backend", backends, {one.backend: None for one in points}),
    ):
        for name in wanted or []:
            find_named(kind, known, name)
    panels = [
        (one.model, one.task)
        for one in points
        if (scenarios is None or one.task in scenarios or one.task.split()[0] in scenarios)
        and (backends is None or one.backend in backends)
    ]
    if not panels:
        raise InputError("nothing to draw: the history has no run of these")
    return list(dict.fromkeys(panels))


def _draw_line(axes: "Axes", entries: Sequence[Entry], cell: tuple[str, str, str], mark: str, colour: str) -> None:
    """One backend; the line breaks where the environment or the reference changed, or a run lacks the cell."""
    runs = [(place, entry, _point(entry, cell)) for place, entry in enumerate(entries)]
    for _, group in groupby(runs, lambda run: (_kind(run[1]), run[2] is None)):
        found = [(place, point) for place, _, point in group if point is not None]
        if not found:
            continue
        places = [place for place, _ in found]
        ratios = [point.ratio for _, point in found]
        ends = [[point.ratio - point.low for _, point in found], [point.high - point.ratio for _, point in found]]
        axes.errorbar(
            places, ratios, yerr=ends, label=cell[2], marker=mark, markersize=4, linewidth=1, capsize=2, color=colour
        )


def _mark_changes(axes: "Axes", entries: Sequence[Entry]) -> None:
    """A broken line between runs that cannot be compared."""
    for place, (one, other) in enumerate(pairwise(entries)):
        if _kind(one) != _kind(other):
            axes.axvline(place + 0.5, color="0.3", linestyle="--", linewidth=1)
            axes.annotate(
                _change_of(one, other), (place + 0.5, 1.0), xycoords=("data", "axes fraction"), xytext=(3, -9),
                textcoords="offset points", fontsize=7, color="0.3", annotation_clip=False,
            )  # fmt: skip


def _change_of(one: Entry, other: Entry) -> str:
    """What changed, in a word or two."""
    facts = [fact for fact in other.facts if one.facts.get(fact) != other.facts.get(fact)]
    facts += [name for name in ("profile", "reference") if getattr(one, name) != getattr(other, name)]
    return f"other {', '.join(facts[:2])}{' ...' if len(facts) > 2 else ''}"


def _label_commits(axes: "Axes", entries: Sequence[Entry]) -> None:
    """The commits under the last panel: as many as there is room for."""
    step = -(-len(entries) // LABELS)
    places = range(0, len(entries), step)
    axes.set_xticks(list(places), [f"{_short(entries[k].revision)}\n{entries[k].date[:10]}" for k in places])
    axes.tick_params(axis="x", labelrotation=90 if len(entries) > 8 else 0, labelsize=7)


def _legend_of(grid: Sequence["Axes"]) -> tuple[list[Any], list[str]]:
    """Each backend once, wherever it is drawn."""
    shown = {label: handle for axes in grid for handle, label in zip(*axes.get_legend_handles_labels(), strict=True)}
    return list(shown.values()), list(shown)


def _point(entry: Entry, cell: tuple[str, str, str]) -> Point | None:
    return next((one for one in entry.points if (one.model, one.task, one.backend) == cell), None)


def _kind(entry: Entry) -> tuple[str, str, str]:
    """Runs of one kind can be compared."""
    return entry.environment, entry.reference, entry.profile


def _short(revision: str) -> str:
    return revision[:7] + "+" * revision.endswith("+") if len(revision) >= 40 else revision
