"""Results cut into parts that are shown together: one model, one reference, and who is compared with it."""

from collections.abc import Iterable
from dataclasses import dataclass

from tetrabench.bench.record import Backend, Model, Results
from tetrabench.bench.statistics import Row, contestants_of, doubt_of, fewest_launches, summary
from tetrabench.report.units import counted, plural, singular

ENDED = {"interrupted": "INTERRUPTED", "budget": "OUT OF BUDGET"}
"""`Results.ended` as a title says it."""


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
        """All of the run, whether anybody did them or not."""
        return [task.name for task in self.results.tasks]

    @property
    def launches(self) -> dict[str, int]:
        """How many launches each task was done in, as far as they went."""
        done = {(one.task, one.launch) for one in self.results.samples if one.model == self.model.name}
        return {task: sum(of == task for of, _ in done) for task in self.tasks}

    @property
    def doubts(self) -> dict[str, str]:
        """Tasks in which nothing may be ranked, for a second copy of the reference differed from it: the reason of each."""
        number = len(contestants_of(self.results.backends))
        found = {task: doubt_of(row, number) for task, row in self.controls.items()}
        return {task: doubt for task, doubt in found.items() if doubt}

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
        facts = [counted(number, things) for things, number in self.model.size.items()]
        facts += filter(None, [_effort(self), ENDED.get(self.results.ended, self.results.ended)])
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


def shown_name(backend: Backend) -> str:
    """With an asterisk where it is not from the source."""
    return backend.name + ("*" if backend.extension else "")


def _effort(part: Part) -> str:
    results = part.results
    if results.profile == "thesis":
        return "the source's counts on one net"
    made, planned = max(part.launches.values(), default=0), results.effort.launches
    rounds = 1 + max((one.round for one in results.samples if one.model == part.model.name), default=-1)
    launches = f"{made} of {plural(planned, 'launch')}" if results.ended else plural(made, "launch")
    return f"{launches} of {plural(rounds, 'round')}" if made else launches
