"""Who is right: contestants that give another answer than the others are named, and never ranked."""

from collections import Counter
from collections.abc import Iterable, Mapping

import msgspec

from tetrabench.bench.record import Backend, Sample

Figures = Mapping[str, float | None]


def judge(samples: Iterable[Sample], backends: Iterable[Backend]) -> list[Sample]:
    """The samples, those with a wrong answer marked "wrong-result", those of a contestant that says now this, now that
    "unstable".

    In each task on each model every backend has one vote for each answer that it gave; a control has none, for
    it would be its reference's second, nor has a contestant that is known to be wrong. Right is what more than half of
    the voters say, and more than say anything else; where there is no such answer, all are wrong. Where nobody with a
    vote gave an answer, nobody is judged but those that are known to be wrong.
    """
    backends = list(backends)
    voters = {backend.name for backend in backends if not backend.control and backend.exact}
    inexact = {backend.name for backend in backends if not backend.exact}
    cells: dict[tuple[str, str], list[Sample]] = {}
    samples = list(samples)
    for sample in samples:
        cells.setdefault((sample.model, sample.task), []).append(sample)
    votes = {
        place: [one for one in cell if one.backend in voters and one.status == "ok"] for place, cell in cells.items()
    }
    right = {place: _majority(cell) for place, cell in votes.items()}
    wavering = {place: _wavering(cell) for place, cell in cells.items()}
    return [
        _mark(sample, right[place], cells[place], sample.backend in wavering[place])
        if votes[place] or sample.backend in inexact
        else sample
        for sample in samples
        if (place := (sample.model, sample.task))
    ]


def _majority(samples: Iterable[Sample]) -> Sample | None:
    """A sample with the right answer."""
    said = {(sample.backend, sample.digest): sample for sample in samples}
    votes = Counter(digest for _, digest in said).most_common(2)
    if not votes or (len(votes) == 2 and votes[0][1] == votes[1][1]):
        return None
    digest, count = votes[0]
    if 2 * count <= len({backend for backend, _ in said}):
        return None
    return next(sample for sample in said.values() if sample.digest == digest)


def _wavering(cell: list[Sample]) -> set[str]:
    """Contestants that gave more than one answer."""
    said = {(sample.backend, sample.digest) for sample in cell if sample.status == "ok"}
    return {backend for backend, count in Counter(backend for backend, _ in said).items() if count > 1}


def _mark(sample: Sample, right: Sample | None, cell: list[Sample], wavers: bool) -> Sample:
    if sample.status != "ok" or (right is not None and sample.digest == right.digest):
        return sample
    if right is None:
        digests = {one.backend: one.digest for one in cell if one.digest}
        said = ", ".join(f"{backend} {digest}" for backend, digest in digests.items())
        reason = f"no answer has a majority: {said}"
    else:
        reason = (
            f"{sample.backend} says {sample.digest}, most say {right.digest}: "
            f"{_difference(sample.figures, right.figures)}"
        )
    if wavers:
        return msgspec.structs.replace(sample, status="unstable", reason=f"not always the same answer; {reason}")
    return msgspec.structs.replace(sample, status="wrong-result", reason=reason)


def _difference(found: Figures, right: Figures) -> str:
    different = [
        f"{name} {_show(found.get(name))} instead of {_show(right.get(name))}"
        for name in {**right, **found}
        if found.get(name) != right.get(name)
    ]
    return ", ".join(different) or "the same figures, but other bits"


def _show(figure: float | None) -> str:
    return "none" if figure is None else f"{figure:.17g}"
