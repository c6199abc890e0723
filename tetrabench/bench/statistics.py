"""What samples say: medians, ratios to the reference from the same round, and a word for each cell.

Provisional: without intervals, and therefore without a verdict on differences under 25 %.
"""

from statistics import median

import msgspec

from tetrabench.bench.record import Results, Sample

ALIKE = 1.25
"""Ratios up to this, either way, are no difference."""
FEW = 3
CLEAR = 3.0
"""In fewer than FEW rounds only ratios from CLEAR on are a difference: one sample may be off twofold."""
SHORTEST_S = 0.005
"""CPU time below which a sample says nothing: it counts as at most this much."""

_ENDS = {"wrong-result": "wrong", "crash": "crashed", "error": "failed", "skipped": "skipped"}  # worst first


class Row(msgspec.Struct, frozen=True, kw_only=True):
    """One contestant in one scenario. Figures are None where the cell did not end well.

    Attributes:
        status: the worst of its samples' (see record.Sample); reason: of that one.
        n: samples; cpu_s, wall_s: their medians, seconds.
        ratio: median over rounds of CPU time over the reference's of the same round.
        ratio_low, ratio_high: the range of those ratios.
        ns_per_item: median CPU time for one item of the work, nanoseconds.
        structure_bytes, peak_bytes: medians.
        verdict: "reference", "faster", "slower", "about the same", "inconclusive" (rounds that are few, or
            contradict each other), "too short to rank", "no reference" (which did not end well itself),
            "wrong", "crashed", "failed", "skipped". Only faster and slower rank.
    """

    scenario: str
    backend: str
    extension: bool
    status: str
    n: int
    verdict: str
    cpu_s: float | None = None
    wall_s: float | None = None
    ratio: float | None = None
    ratio_low: float | None = None
    ratio_high: float | None = None
    ns_per_item: float | None = None
    structure_bytes: float | None = None
    peak_bytes: float | None = None
    reason: str = ""


def summary(results: Results) -> list[Row]:
    """A row for each cell, scenarios in the order of the run, contestants in that of the plan."""
    cells: dict[tuple[str, str], list[Sample]] = {}
    for sample in results.samples:
        cells.setdefault((sample.scenario, sample.backend), []).append(sample)
    scenarios = dict.fromkeys(sample.scenario for sample in results.samples)
    return [
        _row(cell, cells.get((scenario, results.reference), []), results.reference, backend.extension)
        for scenario in scenarios
        for backend in results.backends
        if (cell := cells.get((scenario, backend.name)))
    ]


def _row(cell: list[Sample], reference: list[Sample], reference_name: str, extension: bool) -> Row:
    first = cell[0]
    for status, verdict in _ENDS.items():
        bad = [sample for sample in cell if sample.status == status]
        if bad:
            return Row(
                scenario=first.scenario,
                backend=first.backend,
                extension=extension,
                status=status,
                n=sum(sample.status == "ok" for sample in cell),
                verdict=verdict,
                reason=bad[0].reason,
            )
    cpu_s = _median([sample.cpu_s for sample in cell])
    ratios = _paired_ratios(cell, reference)
    return Row(
        scenario=first.scenario,
        backend=first.backend,
        extension=extension,
        status="ok",
        n=len(cell),
        verdict=_verdict(cell, reference, first.backend == reference_name),
        cpu_s=cpu_s,
        wall_s=_median([sample.wall_s for sample in cell]),
        ratio=_median(ratios),
        ratio_low=min(ratios, default=None),
        ratio_high=max(ratios, default=None),
        ns_per_item=cpu_s / first.items * 1e9 if cpu_s is not None and first.items else None,
        structure_bytes=_median([sample.structure_bytes for sample in cell]),
        peak_bytes=_median([sample.peak_bytes for sample in cell]),
    )


def _paired_ratios(cell: list[Sample], reference: list[Sample], shortest_s: float = 0.0) -> list[float]:
    """CPU time over the reference's, round by round; each counts as `shortest_s` at least."""
    if any(sample.status != "ok" for sample in reference):
        return []
    by_round = {sample.round: sample.cpu_s for sample in reference}
    pairs = [(sample.cpu_s, by_round.get(sample.round)) for sample in cell]
    return [max(own, shortest_s) / max(other, shortest_s) for own, other in pairs if own is not None and other]


def _verdict(cell: list[Sample], reference: list[Sample], is_reference: bool) -> str:
    if is_reference:
        return "reference"
    ratios = _paired_ratios(cell, reference)
    ratio = _median(ratios)
    # so much is certain, however short the samples are
    at_least = _median(_paired_ratios(cell, reference, SHORTEST_S))
    if ratio is None or at_least is None:
        return "no reference"
    if 1 / ALIKE < at_least < ALIKE and not all(_is_long(samples) for samples in (cell, reference)):
        return "too short to rank"
    if 1 / ALIKE < ratio < ALIKE:
        return "about the same"
    is_clear = len(ratios) >= FEW or not 1 / CLEAR < ratio < CLEAR
    if min(ratios) <= 1 <= max(ratios) or not is_clear:
        return "inconclusive"
    return "slower" if ratio > 1 else "faster"


def _is_long(samples: list[Sample]) -> bool:
    return (_median([sample.cpu_s for sample in samples]) or 0.0) >= SHORTEST_S


def _median(values: list[float | None] | list[int | None] | list[float]) -> float | None:
    known = [value for value in values if value is not None]
    return median(known) if known else None
