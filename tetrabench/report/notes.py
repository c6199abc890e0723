"""What stands under the tables, in words: what is to be believed, what the signs mean, what ran where."""

from collections.abc import Iterable, Iterator, Sequence
from statistics import median

from tetrabench.bench.growth import Growth
from tetrabench.bench.record import Launch, Results
from tetrabench.bench.statistics import ALIKE, CLEAR, SHORTEST_S, Row
from tetrabench.report.memory import memories
from tetrabench.report.parts import Part
from tetrabench.report.units import digits, duration, percent, plural, singular

ENDS = {
    "interrupted": "Interrupted: samples are missing.",
    "budget": "The budget of time was used up: samples are missing.",
}
COUNTED = ("samples", "preparing", "compiling")
"""Phases of a launch that a run is for; all others are overhead."""


def about_part(part: Part) -> Iterator[str]:
    """What is to be said of one table."""
    yield _about_answers(part)
    yield from _about_reasons(part)
    if part.results.profile == "check":
        return
    yield from _about_controls(part)
    yield from _about_intervals(part)
    for name, memory in memories(part).items():
        if memory.status != "ok":
            yield f"Memory of {name}: {memory.status}: {' '.join(memory.reason.split())}"
        elif not memory.is_accounted and memory.retained_bytes is not None:
            held, claimed = f"{memory.retained_bytes / 1e6:,.0f}", f"{memory.structure_bytes / 1e6:,.0f}"
            yield f"UNACCOUNTED MEMORY of {name}: its process holds {held} MB, its structure claims {claimed} MB."


def about_run(results: Results, rows: Sequence[Row], grown: Sequence[Growth], intervals: bool) -> Iterator[str]:
    """What is to be said of all tables."""
    if results.profile != "check":
        yield from _about_signs(results, rows, intervals)
        if items := _items(results):
            yield f"An item is {items}."
        yield from _about_memory(results)
        yield from _about_yardsticks(results.launches, any(row.share_of_limit for row in rows))
        if grown and all(one.exponent is None for one in grown):
            yield f"Growth with size: {grown[0].reason}."
        yield from _about_time(results)
    if any(backend.extension for backend in results.backends):
        yield "Names with a * are not from the source."
    yield f"{about_machine(results)}: {results.command}"
    if results.ended:
        yield ENDS.get(results.ended, f"Ended early ({results.ended}): samples are missing.")


def about_growth(grown: Iterable[Growth]) -> Iterator[str]:
    """What the exponents mean, and why there is none where there is none."""
    yield "1 is linear in size, 0 the same time whatever the size; a median over launches, its interval holds with 95 %."
    if any(not one.is_whole and one.exponent is not None for one in grown):
        yield "With a question mark: launches are too few for an interval."
    yield from _listed((one.backend, one.task, one.reason) for one in grown if one.exponent is None)


def about_machine(results: Results) -> str:
    """Day, processor, system."""
    known = results.environment
    facts = [known.get("processor"), known.get("system"), f"Python {known.get('python')}"]
    return ", ".join([results.started[:10], *(str(fact) for fact in facts if fact)])


def _about_answers(part: Part) -> str:
    everybody = [*part.rows.values(), *part.controls.values()]
    wrong = list(dict.fromkeys(row.task for row in everybody if row.verdict == "wrong"))
    if wrong:
        return f"WRONG ANSWERS in {', '.join(wrong)}: contestants disagree; see below."
    compared = [task for task in part.tasks if _said(part, task) > 1]
    if not compared:
        return "Answers: none compared, for that at least two contestants have to end well."
    everyone = all(row.status == "ok" for row in part.rows.values())
    who = f"All {len(part.backends)} contestants" if everyone else "All contestants that ended"
    return f"{who} gave the same answers: {plural(len(compared), 'scenario')}, one digest each."


def _said(part: Part, task: str) -> int:
    """How many contestants gave an answer."""
    return sum(row.status == "ok" for (of, _), row in part.rows.items() if of == task)


def _about_reasons(part: Part) -> Iterator[str]:
    everybody = [*part.rows.values(), *part.controls.values()]
    ended = [row for row in everybody if row.reason and row.verdict != "inconclusive"]
    yield from _listed((f"{row.backend}, {row.verdict}", row.task, row.reason) for row in ended)


def _listed(facts: Iterable[tuple[str, str, str]]) -> Iterator[str]:
    """(who, task, why) as "who in task, task: why"."""
    tasks: dict[tuple[str, str], list[str]] = {}
    for who, task, why in facts:
        tasks.setdefault((who, " ".join(why.split())), []).append(task)  # a note is one line
    yield from (f"{who} in {', '.join(names)}: {why}" for (who, why), names in tasks.items())


def _about_controls(part: Part) -> Iterator[str]:
    """What the second copy of the reference says of all others."""
    doubted = {row.task: row.reason for row in part.rows.values() if row.verdict == "inconclusive" and row.reason}
    for task, reason in doubted.items():
        yield f"NOTHING IS RANKED in {task}: {reason}."
    known = [row for row in part.controls.values() if row.verdict == "control"]
    ends = [end for row in known for end in (row.low, row.high) if end is not None]
    if ends:
        yield (
            f"Control: a second copy of {part.reference} took {digits(min(ends))} to {digits(max(ends))} times as long "
            "as it; so much differs where nothing does."
        )


def _about_intervals(part: Part) -> Iterator[str]:
    if not part.has_intervals:
        return
    whole = [row for row in part.rows.values() if row.verdict in ("faster", "slower", "same", "inconclusive")]
    spreads = {row.spread: row for row in whole if row.spread is not None and not row.is_bound}
    if spreads:
        widest = spreads[max(spreads)]
        where = f"{widest.backend} in {widest.task}"
        yield f"Intervals: half of them within ±{percent(median(spreads))}, the widest ±{percent(max(spreads))} ({where})."


def _about_signs(results: Results, rows: Sequence[Row], intervals: bool) -> Iterator[str]:
    """What the figures are, and each sign that occurs."""
    verdicts = {row.verdict for row in rows}
    wall = list(dict.fromkeys(row.task for row in rows if row.clock == "wall"))
    clock = f"CPU time, in {', '.join(wall)} wall time" if wall else "CPU time"
    yield (
        f"Figures: {clock} as a multiple of the reference's in the same round, median over launches (less is better)"
        + ("; here the ends of the interval." if intervals else ".")
    )
    signs = {
        "ranked, its interval excludes 1 (sign test over launches, 95 % for all of a scenario together)": (
            "1.02-1.06" if intervals else "1.4x",
            any(row.verdict in ("faster", "slower") and not row.is_bound for row in rows),
        ),
        f"all of the interval is within {percent(ALIKE - 1)} of 1": ("~1", "same" in verdicts and not intervals),
        "in every launch more than so many times": (
            ">43x",
            any(row.is_bound for row in rows if row.verdict == "slower"),
        ),
        "in every launch less than so many times": (
            "<0.2x",
            any(row.is_bound for row in rows if row.verdict == "faster"),
        ),
        "the interval does not say which is faster": (
            "0.97-1.12?" if intervals else "unclear",
            "inconclusive" in verdicts,
        ),
        f"a hint, not ranked: launches are too few for an interval, and not all beyond {CLEAR:g}x": (
            "1.2-1.4?" if intervals else "1.3?",
            "about" in verdicts,
        ),
        f"under {duration(SHORTEST_S)}, says nothing": ("too short", "too short" in verdicts),
        "the contestant cannot do that": ("cannot", "unsupported" in verdicts),
    }
    if said := [f"{sign}: {meaning}" for meaning, (sign, occurs) in signs.items() if occurs]:
        yield "Signs: " + ". ".join(said) + "."
    if intervals and any(row.control for row in rows):
        yield "In the column of the reference: a second copy of it."


def _about_memory(results: Results) -> Iterator[str]:
    if results.memory:
        yield (
            "Structure: used bytes of all buffers of the fresh structure, exact. Retained: private memory that its "
            "process has more once it stands. Peak: at most while it is built."
        )
    elif any(backend.structure for backend in results.backends):
        yield "Structure: used bytes of all buffers of the fresh structure, exact."
    if any(backend.compile_s for backend in results.backends):
        yield (
            "Compiling: in a first run, where whoever comes first also compiles what all share; later, loading what was "
            "compiled."
        )


def _about_yardsticks(launches: Sequence[Launch], has_shares: bool) -> Iterator[str]:
    known = [launch.yardsticks for launch in launches if launch.yardsticks]
    if not known:
        return
    copy = median(one.copy_gb_s for one in known)
    triad = median(one.triad_gb_s for one in known)
    latency = median(one.latency_ns for one in known)
    yield (
        f"The machine: copy {digits(copy)} GB/s, triad {digits(triad)} GB/s, a random access {digits(latency)} ns "
        f"(one core, median over {plural(len(known), 'launch')})."
    )
    if has_shares:
        yield "Bandwidth: the least traffic that a task needs with memory, over its time and triad's; beyond 100 %: caches."


def _about_time(results: Results) -> Iterator[str]:
    """Where the time went."""
    phases: dict[str, float] = {}
    for launch in results.launches:
        for phase, seconds in launch.seconds.items():
            phases[phase] = phases.get(phase, 0.0) + seconds
    total = sum(phases.values())
    if total > 0:
        shares = [
            f"{phase} {percent(seconds / total)}" for phase, seconds in sorted(phases.items(), key=lambda one: -one[1])
        ]
        overhead = sum(seconds for phase, seconds in phases.items() if phase not in COUNTED) / total
        took = f"{duration(results.elapsed_s)} in all, " if results.elapsed_s else ""
        yield (
            f"Time: {took}{duration(total)} in launches: {', '.join(shares)}. {percent(overhead)} is overhead: neither samples "
            "nor their preparation nor compiling."
        )


def _items(results: Results) -> str:
    """What the work of the scenarios is counted in: "a tetra (init, free), a split (explode)"."""
    scenarios = {task.name: task.scenario for task in results.tasks}
    users: dict[str, dict[str, None]] = {}
    for task, unit in dict.fromkeys((one.task, one.unit) for one in results.samples if one.unit):
        if task in scenarios:
            users.setdefault(unit, {})[scenarios[task]] = None
    return ", ".join(f"a {singular(unit)} ({', '.join(names)})" for unit, names in users.items())
