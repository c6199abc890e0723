"""The numbers behind the charts of lines of a page: along the run, and over what was chosen.

`line` is what a legend calls it, `look` the backend that it looks like, `wrong` that it is known to be; see `lines`.
"""

from collections.abc import Sequence
from dataclasses import dataclass

from tetrabench.report.curves import Curve, Curves, curves_over_counts, curves_over_options
from tetrabench.report.page.figures import Datum
from tetrabench.report.page.subjects import Subject
from tetrabench.report.parts import shown_name
from tetrabench.report.series import courses_of
from tetrabench.report.units import duration


@dataclass(frozen=True)
class Along:
    """A chart along a run: times of a step or a stretch, which is on x, or counts; of so many backends not."""

    task: str
    axis: str
    is_time: bool
    left_out: int
    rows: list[Datum]


def along(subject: Subject) -> list[Along]:
    """For each task with series its times, then its counts; `panel` is the quantity."""
    found = []
    for course in courses_of(subject.run.results, subject.rows()):
        for is_time in (True, False):
            rows = [
                {
                    "model": subject.label,
                    "backend": shown_name(track.line.backend),
                    "line": track.line.label,
                    "look": shown_name(track.line.backend),
                    "wrong": track.line.is_wrong,
                    "panel": course.heading(track.quantity),
                    "spot": spot,
                    "place": place,
                    "value": value,
                }
                for track in course.tracks
                if track.is_time == is_time
                for spot, (place, value) in enumerate(zip(track.places, track.values, strict=True))
            ]
            if rows:
                found.append(Along(course.task, course.axis, is_time, course.left_out, rows))
    return found


def over_options(subject: Subject) -> list[tuple[Curves, list[Datum]]]:
    """Of each option that has a curve: see `curves`."""
    found = curves_over_options(subject.run.results, subject.rows(), subject.run.rows)
    return [(curves, _rows(subject, curves)) for curves in found]


def over_counts(subject: Subject) -> list[tuple[Curves, list[Datum]]]:
    """Of each count that has a curve: see `curves`."""
    return [(curves, _rows(subject, curves)) for curves in curves_over_counts(subject.run.results, subject.rows())]


def _rows(subject: Subject, curves: Curves) -> list[Datum]:
    """The points of the curves, then the levels, whose labels stand `at` a place."""
    rows = [row for curve in curves.curves for row in _points(subject, curve)]
    for level, at in zip(curves.levels, curves.label_seconds, strict=True):
        rows += [{**row, "level": True, "at": at} for row in _points(subject, level)]
    return rows


def _points(subject: Subject, curve: Curve) -> Sequence[Datum]:
    return [
        {
            "model": subject.label,
            "backend": shown_name(point.line.backend),
            "line": curve.label,
            "look": shown_name(curve.key.backend),
            "wrong": curve.is_wrong,
            "level": False,
            "at": None,
            "place": point.value,
            "value": point.seconds,
            "low": point.low,
            "high": point.high,
            "sure": not point.is_beaten and not curve.is_wrong,
            "least": point.is_least,
            "text": duration(point.seconds),
        }
        for point in curve.points
    ]
