"""Mixes: how much of what a person's program does, in terms of the tasks of a run."""

import math
from collections.abc import Iterable, Mapping, Sequence

import msgspec

from tetrabench.bench.record import Task
from tetrabench.errors import InputError, find_named
from tetrabench.report.parts import Part
from tetrabench.report.units import singular

SWEEPS = "sweeps"
"""A task that has this among its options is counted in it: nobody knows how many sweeps a run measured at once."""


LEAST, MOST = 1e-12, 1e12
"""An amount is 0 or between these: none that anybody means is not, and seconds stay finite."""


class Amount(msgspec.Struct, frozen=True, kw_only=True):
    """How much of a task.

    Attributes:
        task: its name.
        number: how much, in `count`.
        count: "" for what the run did each time; or what the run did `once` of each time: an option of the task, such as
            "sweeps", or the unit of its work.
        items: the work of each time, None where it is not known; unit: what that is counted in.
    """

    task: str
    number: float
    count: str = ""
    once: float = 1.0
    items: float | None = None
    unit: str = ""

    @property
    def weight(self) -> float:
        """How often what the run did."""
        return self.number / self.once


def read_mix(text: str) -> dict[str, float]:
    """What a person typed, such as "alfa=200,delete=1": number by name of a scenario, or by name.count.

    Raises:
        InputError: it is nothing of the kind, a number is negative, not finite or beyond all sense, or all are 0.
    """
    wanted: dict[str, float] = {}
    for word in filter(None, (part.strip() for part in text.split(","))):
        name, sign, number = (part.strip() for part in word.rpartition("="))  # a task may be called "alfa sweeps=10"
        if not sign or not name:
            raise InputError(f"'{word}' in the mix says not how much: write NAME=N, such as alfa=200,delete=1")
        if name in wanted:
            raise InputError(f"'{name}' is twice in the mix: add the two")
        wanted[name] = _number(name, number)
    if not any(wanted.values()):
        raise InputError("the mix is empty: write NAME=N, such as alfa=200,delete=1, with one N above 0 at least")
    return wanted


def make_mix(wanted: Mapping[str, float], part: Part) -> list[Amount]:
    """The tasks that are meant by the names of scenarios, of tasks, or name.count; without those of which there is 0.

    Raises:
        InputError: the run has no such task or the task no such count, or several tasks are or one is meant twice.
    """
    amounts = [_amount(name, number, part) for name, number in wanted.items()]
    for place, amount in enumerate(amounts):
        if amount.task in (other.task for other in amounts[:place]):
            raise InputError(f"the task '{amount.task}' is twice in the mix: name it once")
    return [amount for amount in amounts if amount.number]


def usual_amount(task: Task, part: Part) -> Amount:
    """One sweep of a task that has some, or once what the run did."""
    return _counted(task, SWEEPS if task.options.get(SWEEPS) else "", 1.0, part)


def mix_words(mix: Iterable[Amount]) -> str:
    """All of it: 200 sweeps of alfa, delete once (20,000 deletions)."""
    return ", ".join(amount_words(amount) for amount in mix)


def amount_words(amount: Amount, weight: float | None = None) -> str:
    """200 sweeps of alfa; delete 0.1 times (2,000 deletions); with `weight` so often what the run did."""
    times = amount.weight if weight is None else weight
    if amount.count:
        number = _figure(times * amount.once)
        return f"{number} {singular(amount.count) if number == '1' else amount.count} of {amount.task}"
    often = "once" if times == 1 else f"{_figure(times)} times"
    done = round(times * amount.items) if amount.items else 0
    work = f" ({done:,} {singular(amount.unit) if done == 1 else amount.unit})" if done and amount.unit else ""
    return f"{amount.task} {often}{work}"


def _number(name: str, text: str) -> float:
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if number != 0 and not LEAST <= number <= MOST:
        raise InputError(
            f"'{text}' of '{name}' in the mix is no amount: write 0 or a number from {LEAST:g} to {MOST:g}, such as 200 or 0.1"
        )
    return number


def _amount(name: str, number: float, part: Part) -> Amount:
    known = _known(part.results.tasks)
    scenario, _, count = name.rpartition(".")
    if name not in known and scenario in known:
        return _counted(known[scenario], count, number, part)
    alike = [f"'{task.name}'" for task in part.results.tasks if task.scenario in (name, scenario)]
    if name not in known and alike:
        raise InputError(f"'{name}' was measured with several counts: name one of {', '.join(alike)} in the mix")
    return msgspec.structs.replace(usual_amount(find_named("scenario in this run", known, name), part), number=number)


def _known(tasks: Sequence[Task]) -> dict[str, Task]:
    """Tasks by name, and by their scenario where it has no other."""
    scenarios = [task.scenario for task in tasks]
    alone = {task.scenario: task for task in tasks if scenarios.count(task.scenario) == 1}
    return alone | {task.name: task for task in tasks}


def _counted(task: Task, count: str, number: float, part: Part) -> Amount:
    items, unit = _work(task, part)
    counts: dict[str, float] = {option: done for option, done in task.options.items() if done > 0}
    if items and unit:
        counts[unit] = items  # a model too small for an option did fewer
    once = find_named(f"count of {task.name}", counts, count) if count else 1.0
    return Amount(task=task.name, number=number, count=count, once=once, items=items, unit=unit)


def _work(task: Task, part: Part) -> tuple[float | None, str]:
    """Items of one run of a task, and their unit; (None, "") where nobody did any."""
    done = (
        (one.items / one.repeats, one.unit)
        for one in part.results.samples
        if (one.model, one.task, one.status) == (part.model.name, task.name, "ok") and one.items
    )
    return next(done, (None, ""))


def _figure(number: float) -> str:
    """Three digits, or all before the point: 0.0214, 1.5, 200, 20,000."""
    return f"{number:,.0f}" if number >= 100 else f"{number:.3g}"
