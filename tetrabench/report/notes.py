"""What stands under the tables, in words: what is to be believed, what the signs mean, what ran where."""

from collections.abc import Iterable, Iterator, Sequence
from statistics import median

from tetrabench.bench.growth import Growth
from tetrabench.bench.record import Launch, Results
from tetrabench.bench.statistics import ALIKE, CLEAR, SHORTEST_S, Row
from tetrabench.report.memory import memories
from tetrabench.report.parts import Part
from tetrabench.report.units import digits, duration, one_of, percent, plural, singular

ENDS = {
    "interrupted": "Interrupted: samples are missing.",
    "budget": "The budget of time was used up: samples are missing.",
}
FOREIGN = "A name with a * is not from the source."
COUNTED = ("samples", "preparing", "compiling")
"""Phases of a launch that a run is for; all others are overhead."""


def about_part(part: Part) -> Iterator[str]:
    """What is to be said of one table: first what spoils it."""
    if part.results.ended:
        yield _about_launches(part)
    yield _about_answers(part)
    yield from _about_reasons(part)
    if part.results.profile == "check":
        yield from _about_model(part)
        return
    yield from _about_controls(part)
    for name, memory in memories(part).items():
        if memory.status != "ok":
            yield f"Memory of {name}: {memory.status}: {' '.join(memory.reason.split())}"
        elif not memory.is_accounted and memory.retained_bytes is not None:
            held, claimed = f"{memory.retained_bytes / 1e6:,.0f}", f"{memory.structure_bytes / 1e6:,.0f}"
            yield f"UNACCOUNTED MEMORY of {name}: its process holds {held} MB, its structure claims {claimed} MB."
    if few := fewer_than_asked(part):
        yield f"Fewer than asked for, the model is too small: {few}."
    yield from _about_model(part)
    yield from _about_intervals(part)
    if items := _items(part):
        yield f"An item is {items}."


def about_run(results: Results, rows: Sequence[Row], grown: Sequence[Growth], intervals: bool) -> Iterator[str]:
    """What is to be said of all tables: what the figures are, then what ran where."""
    if results.ended and not results.models:
        yield about_end(results)
    if results.profile != "check":
        yield from _about_signs(results, rows, intervals)
        yield from _about_memory(results)
        if any(row.share_of_limit for row in rows):
            yield "Bandwidth: the least traffic that a task needs with memory, over its time and triad's; beyond 100 %: caches."
        if grown and all(one.exponent is None for one in grown):
            yield f"Growth with size: {grown[0].reason}."
    told = {one.task for one in results.samples if one.series}
    if scenarios := list(dict.fromkeys(task.scenario for task in results.tasks if task.name in told)):
        charts = (
            "charts of `tetrabench report`, or --charts" if results.profile != "check" else "charts of `tetrabench run`"
        )
        yield f"Along the run of {', '.join(scenarios)}: {charts}."
    if any(backend.extension for backend in results.backends):
        yield FOREIGN
    if results.profile != "check":
        yield from _about_yardsticks(results.launches)
        yield from _about_time(results)
    yield f"{about_machine(results)}: {results.command}"


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


def about_end(results: Results) -> str:
    """Why samples are missing, "" where none are."""
    return results.ended and ENDS.get(results.ended, f"Ended early ({results.ended}): samples are missing.")


def fewer_than_asked(part: Part) -> str:
    """Tasks whose model is too small for their counts: "10,044 of 20,000 deletions in delete"."""
    return "; ".join(
        f"{done:,} of {task.options[unit]:,} {unit} in {task.name}"
        for task in part.results.tasks
        for unit, done in [_work(part, task.name)]
        if done < task.options.get(unit, 0)
    )


def _about_launches(part: Part) -> str:
    """Which tasks miss launches."""
    tasks: dict[int, list[str]] = {}
    for task, launches in part.launches.items():
        tasks.setdefault(launches, []).append(task)
    begun = "; ".join(f"{number or 'none'} in {', '.join(names)}" for number, names in tasks.items())
    return f"{about_end(part.results)} Of {plural(part.results.effort.launches, 'launch')} were begun: {begun}."


def _about_model(part: Part) -> Iterator[str]:
    yield from (f"model: {' '.join(note.split())}" for note in part.model.notes)


def _about_answers(part: Part) -> str:
    everybody = [*part.rows.values(), *part.controls.values()]
    wrong = list(dict.fromkeys(row.task for row in everybody if row.verdict == "wrong"))
    if wrong:
        return f"WRONG ANSWERS in {', '.join(wrong)}: contestants disagree; see below."
    compared = [task for task in part.tasks if _said(part, task) > 1]
    if not compared:
        return "Answers: none compared, for that at least two contestants have to end well."
    whole = len(part.rows) == len(part.tasks) * len(part.backends)
    everyone = "Both" if len(part.backends) == 2 else f"All {len(part.backends)}"
    who = (
        f"{everyone} contestants"
        if whole and all(row.status == "ok" for row in part.rows.values())
        else "All that ended"
    )
    each = ", one digest each" if len(compared) > 1 else ""
    return f"{who} gave the same answers: {plural(len(compared), 'scenario')}{each}."


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
    for task, reason in part.doubts.items():
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
    bounds = {row.verdict for row in rows if row.is_bound}
    once = max((row.launches for row in rows), default=1) == 1
    middle = "" if max((row.samples for row in rows), default=1) == 1 else ", median"
    yield (
        f"Figures: {about_clock(rows)} as a multiple of the reference's in the same round{middle}; less is better."
        + (" Here the ends of the interval." if intervals and not once else "")
    )
    bound = f"one launch, beyond {CLEAR:g}x" if once else "in every launch"
    signs = [
        (
            "1.02-1.06" if intervals else "1.4x",
            "ranked, its interval excludes 1 (sign test over launches, 95 % for all of a scenario together)",
            any(row.verdict in ("faster", "slower") and not row.is_bound for row in rows),
        ),
        ("~1", f"all of the interval is within {percent(ALIKE - 1)} of 1", "same" in verdicts and not intervals),
        (">43x", f"slower, at least so many times ({bound})", "slower" in bounds),
        ("<0.2x", f"faster, so many times at most ({bound})", "faster" in bounds),
        (
            "0.97-1.12?" if intervals else "unclear",
            "the interval does not say which is faster",
            "inconclusive" in verdicts,
        ),
        (
            "1.2-1.4?" if intervals and not once else "1.3?",
            f"a hint, not ranked: {'one launch' if once else 'too few launches for an interval'}, not beyond {CLEAR:g}x",
            "about" in verdicts,
        ),
        ("too short", f"under {1e3 * SHORTEST_S:g} ms, says nothing", "too short" in verdicts),
        ("cannot", "the contestant cannot do that", "unsupported" in verdicts),
    ]
    if said := [f"{sign}: {meaning}" for sign, meaning, occurs in signs if occurs]:
        yield "Signs: " + ". ".join(said) + "."
    if intervals and any(row.control for row in rows):
        yield "In the column of the reference: a second copy of it."


def about_clock(rows: Iterable[Row]) -> str:
    """Which time the figures are."""
    wall = list(dict.fromkeys(row.task for row in rows if row.clock == "wall"))
    return f"CPU time, in {', '.join(wall)} wall time" if wall else "CPU time"


def _about_memory(results: Results) -> Iterator[str]:
    if results.memory or any(backend.structure for backend in results.backends):
        yield "Structure: used bytes of all buffers of the fresh structure, exact."
    if any(one.retained_bytes or one.peak_bytes for one in results.memory):
        yield (
            "Retained: private memory that its process has more once it stands. Peak: at most meanwhile. "
            "~: to about 1 %, so much differs between equal runs."
        )
    if any(backend.compile_s for backend in results.backends):
        yield "Compiling: whoever comes first compiles what all share; in later runs it is loading."


def _about_yardsticks(launches: Sequence[Launch]) -> Iterator[str]:
    known = [launch.yardsticks for launch in launches if launch.yardsticks]
    if not known:
        return
    copy = median(one.copy_gb_s for one in known)
    triad = median(one.triad_gb_s for one in known)
    latency = median(one.latency_ns for one in known)
    middle = f", median over {len(known)} launches" if len(known) > 1 else ""
    yield (
        f"The machine: copy {digits(copy)} GB/s, triad {digits(triad)} GB/s, a random access {digits(latency)} ns "
        f"(one core{middle})."
    )


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
        yield f"Time: {took}{duration(total)} in launches: {', '.join(shares)}; {percent(overhead)} is overhead."


def _items(part: Part) -> str:
    """What the work of the tasks is counted in, and how much they did: "a split (50,000 in explode)"."""
    units: dict[str, dict[int, list[str]]] = {}
    for task in part.tasks:
        unit, done = _work(part, task)
        if unit:
            units.setdefault(unit, {}).setdefault(done, []).append(task)
    done_in = {
        unit: "; ".join(f"{done:,} in {', '.join(tasks)}" for done, tasks in counts.items())
        for unit, counts in units.items()
    }
    return ", ".join(f"{one_of(singular(unit))} ({counts})" for unit, counts in done_in.items())


def _work(part: Part, task: str) -> tuple[str, int]:
    """What a task counts its work in, and how much it did: ("", 0) where nobody did it."""
    done = (
        (one.unit, one.items // one.repeats)
        for one in part.results.samples
        if (one.model, one.task) == (part.model.name, task) and one.items and one.unit
    )
    return next(done, ("", 0))
