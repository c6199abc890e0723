"""What a page is about: each model of each run, under a label that no other has."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field

from tetrabench.bench.record import Backend, Model, Results
from tetrabench.bench.statistics import Row, summary, summary_against
from tetrabench.errors import InputError
from tetrabench.report.parts import Part, make_parts, shown_name

OWN = " own"
"""The base where each backend is compared with the reference that it has in its run. No backend's name begins so."""
ABSOLUTE = " absolute"
"""The base where nothing is compared: times as they were."""


@dataclass(frozen=True, eq=False)
class Run:
    """A results file: its name without folder and suffix, and what it holds."""

    name: str
    results: Results
    _rows: dict[str, list[Row]] = field(default_factory=dict, repr=False)

    def rows(self, base: str = OWN) -> list[Row]:
        """A row for each cell, compared with `base`; controls too. Empty where there is no such backend."""
        if base not in self._rows:
            names = {one.name for one in self.results.backends if not one.control}
            against = summary_against(self.results, base) if base in names else []
            self._rows[base] = summary(self.results) if base == OWN else against
        return self._rows[base]


@dataclass(frozen=True)
class Subject:
    """A model of a run.

    Attributes:
        label: what it is called on the page; unique.
        parts: see `parts.Part`: one for each reference.
    """

    run: Run
    model: Model
    label: str
    parts: list[Part]

    @property
    def backends(self) -> list[Backend]:
        """Those that took part, no controls."""
        return [one for one in self.run.results.backends if not one.control]

    @property
    def item(self) -> str:
        """What the model's size is counted in."""
        return self.parts[0].item

    def name_of(self, backend: str) -> str:
        """The shown name of a backend."""
        known = {one.name: shown_name(one) for one in self.run.results.backends}
        return known.get(backend, backend)

    def rows(self, base: str = OWN) -> list[Row]:
        """Those of the run on this model."""
        return [row for row in self.run.rows(base) if row.model == self.model.name]


def make_subjects(runs: Sequence[Run]) -> list[Subject]:
    """The models of all runs.

    Raises:
        InputError: there is nothing to show, or it cannot stand on one page.
    """
    for run in runs:
        if run.results.profile == "check":
            raise InputError(f"{run.name}: holds answers only, no times; make a run with `tetrabench run -o FILE.json`")
        if not run.results.samples:
            raise InputError(f"{run.name}: holds no samples; go on with `tetrabench run ... --resume`")
    if len({run.results.family for run in runs}) > 1:
        raise InputError("these runs are of several families: what they stored cannot be compared; a page for each")
    models = [(run, model) for run in runs for model in run.results.models]
    labels = _labels([(run.name, model.name) for run, model in models])
    parts = {id(run): make_parts(run.results, run.rows()) for run in runs}
    return [
        Subject(run, model, label, [part for part in parts[id(run)] if part.model == model])
        for (run, model), label in zip(models, labels, strict=True)
        if any(sample.model == model.name for sample in run.results.samples)
    ]


def make_runs(named: Sequence[tuple[str, Results]]) -> list[Run]:
    """Runs under their names; where several have one, with a number."""
    seen: Counter[str] = Counter()
    runs = []
    for name, results in named:
        seen[name] += 1
        runs.append(Run(f"{name} {seen[name]}" if seen[name] > 1 else name, results))
    return runs


def _labels(names: Sequence[tuple[str, str]]) -> list[str]:
    """The model's name, with that of the run where others have the same."""
    models = Counter(model for _, model in names)
    return [model if models[model] == 1 else f"{model} ({run})" for run, model in names]


def bases_of(subjects: Sequence[Subject]) -> list[str]:
    """What backends can be compared with: the usual base first, then all backends, then nothing."""
    backends = [one for subject in subjects for one in subject.backends]
    references = {one.against for one in backends}
    names = list(dict.fromkeys(one.name for one in backends))
    usual = [*references] if len(references) == 1 else [OWN]
    return list(dict.fromkeys([*usual, *names, ABSOLUTE]))
