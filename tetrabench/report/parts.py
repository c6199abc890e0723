"""Results cut into parts that are shown together: one model, one reference, and who is compared with it."""

from collections.abc import Iterable
from dataclasses import dataclass

from tetrabench.bench.record import Backend, Model, Results
from tetrabench.bench.statistics import Row, fewest_launches, summary
from tetrabench.report.units import plural, singular


@dataclass(frozen=True)
class Part:
    """What a table shows.

    Attributes:
        backends: the reference and those compared with it, in the order of the run; no controls.
        rows: of these; controls: of the second copies of the reference, by task.
        name: of a chart: what this part has that others of the run have not, "" where it is the only one.
    """

    results: Results
    model: Model
    reference: str
    backends: list[Backend]
    rows: dict[tuple[str, str], Row]
    controls: dict[str, Row]
    name: str

    @property
    def tasks(self) -> list[str]:
        """Those that anybody did, in the order of the run."""
        return list(dict.fromkeys(task for task, _ in self.rows))

    @property
    def item(self) -> str:
        """What the model's size is counted in."""
        return singular(next(iter(self.model.size), "items"))

    @property
    def has_intervals(self) -> bool:
        """Whether there were launches enough for an interval anywhere."""
        fewest = fewest_launches(len(self.backends) - 1)
        return any(row.launches >= fewest for row in self.rows.values() if row.ratio is not None)

    @property
    def title(self) -> str:
        """Model, its size, how often it was measured."""
        facts = [f"{number:,} {things}" for things, number in self.model.size.items()]
        facts += [_effort(self.results, self.model)]
        against = f" against {self.reference}" if self.reference != self.results.reference else ""
        return f"{self.model.name}{against}: {', '.join(facts)}"


def make_parts(results: Results, rows: Iterable[Row] | None = None) -> list[Part]:
    """The parts of a run: model after model, for each reference; `rows` are its summary."""
    rows = list(summary(results) if rows is None else rows)
    references = list(dict.fromkeys(backend.against for backend in results.backends)) or [results.reference]
    return [
        Part(
            results=results,
            model=model,
            reference=reference,
            backends=[one for one in results.backends if one.against == reference and not one.control],
            rows={(row.task, row.backend): row for row in mine if not row.control},
            controls={row.task: row for row in mine if row.control},
            name="-".join([model.name] * (len(results.models) > 1) + [reference] * (len(references) > 1)),
        )
        for model in results.models
        for reference in references
        for mine in [[row for row in rows if row.model == model.name and row.against == reference]]
    ]


def _effort(results: Results, model: Model) -> str:
    if results.profile == "thesis":
        return "the source's counts on one net"
    samples = [sample for sample in results.samples if sample.model == model.name]
    launches = 1 + max((sample.launch for sample in samples), default=0)
    rounds = 1 + max((sample.round for sample in samples), default=0)
    return f"{plural(launches, 'launch')} of {plural(rounds, 'round')}"
