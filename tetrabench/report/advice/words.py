"""Recommendations set for a person, as tables with sentences to be read aloud, and for programs, as JSON."""

from collections.abc import Callable, Iterator, Sequence

import msgspec

from tetrabench.bench.statistics import BEYOND, CLEAR
from tetrabench.report.advice.flips import Flip, Outlook
from tetrabench.report.advice.mix import amount_words, mix_words
from tetrabench.report.advice.recommend import Ranked, Recommendation
from tetrabench.report.advice.totals import MATTERS, Multiple
from tetrabench.report.memory import MEMORY_ERROR
from tetrabench.report.sheets import Cell, Pages, Sheet
from tetrabench.report.table import markdown_of, text_of
from tetrabench.report.units import digits, duration, percent, plural, span, times, two_digits

_COLOURS = {"slower": "slower", "cannot tell": "inconclusive", "hint": "about"}
"""A verdict of a total as that of a row, which a terminal has a colour for."""


def advice_as(
    given: Sequence[Recommendation], form: str, *, notes: Sequence[str] = (), brief: bool = False, colour: bool = False
) -> str:
    """Recommendations as text; `form` is "table", "md" or "json".

    Args:
        given: of one or several mixes and models.
        form: one of these; JSON holds everything, unrounded.
        notes: what else is to be said.
        brief: a line for each instead of a table.
        colour: for a terminal.
    """
    if form == "json":
        facts = {
            "recommendations": [
                {"advice": advice_of(one), **msgspec.to_builtins(one), "reasons": dict(_reasons(one))} for one in given
            ],
            "notes": list(notes),
        }
        return msgspec.json.format(msgspec.json.encode(facts), indent=1).decode() + "\n"
    pages = overview_of(given, notes) if brief else Pages([_sheet(one) for one in given], [*_about(given), *notes])
    return text_of(pages, colour=colour) if form == "table" else markdown_of(pages)


def advice_of(one: Recommendation) -> str:
    """What to use, and what it costs not to, in two or three sentences."""
    if not one.ranked:
        return "Nothing can be recommended: nobody is left."
    if not one.is_ranked:
        return f"Nothing can be recommended: nothing may be ranked in {_listed(list(one.doubts))}."
    return " ".join([_choice(one), *_memory(one), *_next(one)])


def title_of(one: Recommendation) -> str:
    """The choice in some words: "use v3y", "perhaps v3y", "v3y or v3x"."""
    if not one.ranked or not one.is_ranked:
        return "nothing can be recommended"
    return f"use {_listed(one.best, 'or')}" if not _hints(one) else f"perhaps {one.best[0]}"


def reason_of(one: Recommendation, ranked: Ranked) -> str:
    """Where the time of a contestant goes, and where it loses most against the first."""
    task = max(ranked.shares, key=lambda task: ranked.shares[task])
    share = f"{task} takes {percent(ranked.shares[task])} of its time"
    loss, first = ranked.loss, one.ranked[0].backend
    if loss is None:
        return share if ranked.beside is None else f"{share}; it loses nothing in any task, by the medians"
    lost = _against(loss.beside, first)
    return f"{share}, {lost}" if loss.task == task else f"{share}; it loses most in {loss.task}, {lost}"


def flip_of(one: Recommendation, outlook: Outlook, flip: Flip) -> str:
    """Where the choice flips, and how much of the time the task is then."""
    amount = one.amounts[outlook.task]
    ends = _ends(amount_words(amount, flip.low), amount_words(amount, flip.high)) if flip.is_whole else ""
    first, perhaps = one.ranked[0].backend, "" if flip.is_whole else "perhaps "
    return (
        f"{perhaps}{flip.backend} instead of {first} {flip.side} {amount_words(amount, flip.weight)}{ends}; "
        f"{outlook.task} then takes {percent(flip.share)} of {first}'s time"
    )


# -- sentences


def _choice(one: Recommendation) -> str:
    first, *others = one.best
    if not others:
        return f"Use {first}." if len(one.ranked) > 1 else f"{first} alone is left: use it."
    if not _hints(one):
        return f"Use {_listed(one.best, 'or')}: they cannot be told apart."
    few = f"{plural(one.launches, 'launch')} {'is' if one.launches == 1 else 'are'} too few"
    return f"Perhaps {first}, but that is a hint: {few} to tell it from {_listed(others, 'or')}."


def _memory(one: Recommendation) -> Iterator[str]:
    """Who of those that cannot be told apart needs least memory."""
    best = [ranked for ranked in one.ranked if ranked.backend in one.best]
    held = {ranked.backend: ranked.held_bytes for ranked in best}
    if len(best) < 2 or not one.size or not all(held.values()):
        return
    known = {name: size for name, size in held.items() if size}
    least = min(known, key=lambda name: known[name])
    exact = {ranked.backend: ranked.structure_bytes or known[ranked.backend] for ranked in best}  # peaks have noise
    if all(
        sizes[name] > (1 + MEMORY_ERROR) * sizes[least] for sizes in (known, exact) for name in known if name != least
    ):
        yield f"Of these {least} needs least memory, {_per_item(one, known[least])}."


def _next(one: Recommendation) -> Iterator[str]:
    """What it costs to use none of the best."""
    slower = [ranked for ranked in one.ranked if ranked.beside and ranked.beside.verdict == "slower"]
    if slower and (beside := slower[0].beside):
        whom = one.ranked[0].backend if len(one.best) > 1 else "it"
        yield f"The next one, {slower[0].backend}, takes {_long(beside)} as long as {whom}."


def _long(beside: Multiple) -> str:
    if beside.is_bound:
        return f"at least {two_digits(beside.low)} times"
    return f"{digits(beside.ratio)} times ({digits(beside.low)} to {digits(beside.high)})"


def _against(beside: Multiple, first: str) -> str:
    """What a contestant takes in a task; no more than a guess where its interval does not exclude that it loses nothing."""
    guess = "at least " if beside.is_bound else "" if beside.verdict == "slower" else "perhaps "
    return f"{guess}{two_digits(beside.low if beside.is_bound else beside.ratio)} times that of {first}"


def _reasons(one: Recommendation) -> Iterator[tuple[str, str]]:
    yield from ((ranked.backend, reason_of(one, ranked)) for ranked in one.ranked)


def _outlooks(one: Recommendation) -> Iterator[str]:
    """Flips, then the tasks without any."""
    if len(one.ranked) < 2 or not one.is_ranked:
        return
    yield from (f"Flips: {flip_of(one, outlook, flip)}." for outlook in one.outlooks for flip in outlook.flips)
    holds = [outlook.task for outlook in one.outlooks if outlook.holds == (0.0, None)]
    unclear = [outlook.task for outlook in one.outlooks if not outlook.holds and not outlook.flips]
    bounded = [outlook for outlook in one.outlooks if outlook.holds not in (None, (0.0, None)) and not outlook.flips]
    sure = "The" if one.has_intervals else "As far as so few launches tell, the"
    if bounded:
        yield f"{sure} choice holds at least {'; '.join(_between(one, outlook) for outlook in bounded)}."
    if holds:
        yield f"{sure} choice holds for any amount of {_listed(holds, 'or')}."
    if unclear:
        yield f"Cannot tell whether another amount of {_listed(unclear, 'or')} would change it."


def _between(one: Recommendation, outlook: Outlook) -> str:
    """Weights between which a choice holds, in words."""
    low, high = outlook.holds or (0.0, None)
    amount = one.amounts[outlook.task]
    least, most = amount_words(amount, low), amount_words(amount, high)  # of None: what the mix has, not shown
    if not low:
        return f"up to {most}"
    return f"from {least} on" if high is None else f"from {least} to {most.removeprefix(f'{outlook.task} ')}"


def _ends(low: str, high: str) -> str:
    return f" ({low} to {high})" if low != high else ""


def _listed(names: Sequence[str], word: str = "and") -> str:
    """v3, v3x and v3y."""
    return f" {word} ".join(filter(None, [", ".join(names[:-1]), *names[-1:]]))


def _hints(one: Recommendation) -> list[str]:
    return [ranked.backend for ranked in one.ranked if ranked.beside and ranked.beside.verdict == "hint"]


def _per_item(one: Recommendation, size: int) -> str:
    items = next(iter(one.size.values()), 0)
    return f"{size / items:,.0f} bytes a {one.item}" if items else f"{size:,} bytes"


# -- tables


def _sheet(one: Recommendation) -> Sheet:
    """Who takes how long, and what memory."""
    items = next(iter(one.size.values()), 0)
    columns: list[tuple[str, Callable[[Ranked], str]]] = []
    if items and any(ranked.structure_bytes for ranked in one.ranked):
        columns.append((f"B/{one.item}", lambda ranked: _each(ranked.structure_bytes, items)))
    if items and one.has_peaks:
        columns.append(("~at peak", lambda ranked: _each(ranked.peak_bytes, items)))
    if one.memory_limit is not None:
        columns.append((f"~{one.item}s fit", lambda ranked: _rounded(ranked.fits)))
    return Sheet(
        title=f"{', '.join(filter(None, [one.model, one.workload]))}: {title_of(one)}",
        head=["backend", "takes", "interval", *(head for head, _ in columns)],
        rows=[
            [
                Cell(ranked.backend),
                _takes(ranked.beside),
                Cell(_interval(one, ranked.beside)),
                *(Cell(figure(ranked)) for _, figure in columns),
            ]
            for ranked in one.ranked
        ],
        notes=list(_said(one)),
    )


def _takes(beside: Multiple | None) -> Cell:
    if beside is None:
        return Cell("1")
    if beside.is_bound:
        return Cell(f">{times(beside.low)}", "slower")
    text = {"slower": f"{digits(beside.ratio)}x", "hint": f"{digits(beside.ratio)}?"}.get(beside.verdict, "unclear")
    return Cell(text, _COLOURS[beside.verdict])


def _interval(one: Recommendation, beside: Multiple | None) -> str:
    if beside is None or beside.is_bound or not one.is_ranked:
        return ""
    if beside.low == beside.high:  # one launch
        return ""
    return span(beside.low, beside.high) + ("" if beside.is_whole else "?")


def _each(size: int | None, items: int) -> str:
    """Bytes an item."""
    return "unknown" if size is None else f"{size / items:,.0f}"


def _rounded(items: float | None) -> str:
    """To two digits, for memory grows only nearly as the model does: 7.1M, 130k."""
    if items is None:
        return "unknown"
    for unit, size in (("M", 1e6), ("k", 1e3)):
        if items >= size:
            return f"{float(f'{items / size:.2g}'):g}{unit}"
    return f"{items:.0f}"


def _said(one: Recommendation) -> Iterator[str]:
    """What stands under a table: the choice, the reasons, what would change it, what spoils it."""
    yield advice_of(one)
    first = f", {duration(one.ranked[0].seconds)} with {one.ranked[0].backend}" if one.ranked else ""
    yield f"The work{f', {one.about}' if one.about else ''}: {mix_words(one.mix)}{first}."
    yield from (f"{name}: {reason}." for name, reason in _reasons(one))
    yield from _outlooks(one)
    yield from _spoilt(one)


def _spoilt(one: Recommendation) -> Iterator[str]:
    reasons: dict[str, list[str]] = {}
    for left in one.left_out:
        reasons.setdefault(left.reason, []).append(left.backend)
    yield from (f"Not ranked: {_listed(names)}: {reason}." for reason, names in reasons.items())
    yield from (f"NOTHING IS RANKED in {task}: {reason}." for task, reason in one.doubts.items())
    short: dict[str, list[str]] = {}
    for ranked in one.ranked:
        for task in ranked.too_short:
            if ranked.shares[task] > MATTERS:
                short.setdefault(task, []).append(ranked.backend)
    for task, names in short.items():
        yield f"{task} is too short to be known for {_listed(names)}: it counts as long as {one.reference}'s."
    if not one.has_peaks:
        known = any(ranked.structure_bytes for ranked in one.ranked)
        yield (
            "The run weighed nobody: the structure alone counts as memory."
            if known
            else "Nothing is known of memory: the run weighed nobody."
        )


def _about(given: Sequence[Recommendation]) -> Iterator[str]:
    """What the figures are, and each sign that occurs."""
    multiples = [ranked.beside for one in given for ranked in one.ranked if ranked.beside]
    if not multiples:
        return
    yield (
        "takes: time of all the work as a multiple of the first's, launch by launch, median. interval: sign test over "
        "launches, 95 % for all of a table together."
    )
    signs = [
        ("unclear", f"the interval does not exclude that both take as long (to {percent(BEYOND - 1)})", "cannot tell"),
        ("1.3?", f"a hint, launches are too few for an interval and not all beyond {CLEAR:g}x", "hint"),
    ]
    said = [f"{sign}: {meaning}" for sign, meaning, verdict in signs if verdict in {one.verdict for one in multiples}]
    bounds = [">43x: at least so many times"] * any(one.is_bound for one in multiples)
    if said or bounds:
        yield f"Signs: {'. '.join([*said, *bounds])}."
    yield "It holds for this machine and this model, and for work like that of the scenarios."


def overview_of(given: Sequence[Recommendation], notes: Sequence[str] = ()) -> Pages:
    """A line for each mix on each model, a table for each model."""
    sheets = []
    for model in dict.fromkeys(one.model for one in given):
        mine = [one for one in given if one.model == model]
        rows = [[Cell(one.workload), Cell(title_of(one)), Cell(_cost(one))] for one in mine]
        said = [
            line for one in mine for line in (f"{one.workload}: {one.about}: {mix_words(one.mix)}.", advice_of(one))
        ]
        said += dict.fromkeys(line for one in mine for line in _spoilt(one))
        sheets.append(Sheet(title=model, head=["workload", "advice", "next"], rows=rows, notes=said))
    return Pages(sheets, list(notes))


def _cost(one: Recommendation) -> str:
    slower = [ranked for ranked in one.ranked if ranked.beside and ranked.beside.verdict == "slower"]
    if not slower or not one.is_ranked:
        return ""
    return f"{slower[0].backend} {_takes(slower[0].beside).text}"
