"""The verb that says which backend to use: recommend."""

from __future__ import annotations

import re
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tetrabench.cli.options import FILE
from tetrabench.errors import InputError, find_named

if TYPE_CHECKING:
    from tetrabench.bench import Results
    from tetrabench.protocols import Workload

BYTES = {"": 1, "k": 10**3, "M": 10**6, "G": 10**9, "T": 10**12, "Ki": 2**10, "Mi": 2**20, "Gi": 2**30, "Ti": 2**40}


def read_bytes(ctx: click.Context, param: click.Parameter, text: str | None) -> int | None:
    """An amount of memory such as 500M, 2G or 1.5GiB, in bytes."""
    if text is None:
        return None
    match = re.fullmatch(r"(\d+(?:\.\d+)?)\s*([kMGT]?|[KMGT]i)B?", text.strip())
    size = float(match[1]) * BYTES[match[2]] if match else 0.0
    if size < 1:
        raise click.BadParameter(f"{text!r} is no amount of memory such as 500M, 2G or 1.5GiB", ctx, param)
    return int(size)


@click.command()
@click.argument("results", type=FILE, metavar="RESULTS.json")
@click.option("--mix", metavar="NAME=N,...", help="Your work, such as alfa=200,delete=1,explode=0.1.")
@click.option("--workload", metavar="NAME", help="A usual mix instead: an unknown name, such as ?, lists them.")
@click.option(
    "--memory-limit", metavar="SIZE", callback=read_bytes, help="Such as 2G or 1.5GiB: nobody who needs more."
)
@click.option(
    "--format",
    "form",
    type=click.Choice(["table", "md", "json"]),  # those of report.advice.words
    default="table",
    show_default=True,
    help="For people, or for programs.",
)
def recommend(results: Path, mix: str | None, workload: str | None, memory_limit: int | None, form: str) -> None:
    """Which backend for which work, by a run that was saved: who takes least, why, and what would change it.

    A mix says how much of which scenarios: alfa=200 are 200 sweeps, delete=1 is once what the run did,
    delete.deletions=5000 counts in that. Without --mix and --workload, all usual mixes in short.
    """
    from tetrabench.bench import read_results
    from tetrabench.report.advice.mix import read_mix
    from tetrabench.report.advice.recommend import recommend as recommend_for
    from tetrabench.report.advice.recommend import recommend_usual
    from tetrabench.report.advice.words import advice_as

    if mix is not None and workload is not None:
        raise click.UsageError("--mix and --workload are two ways to say the same: give one")
    run = read_results(results)
    notes: list[str] = []
    if mix is not None:
        given = recommend_for(run, read_mix(mix), memory_limit=memory_limit)
    else:
        wanted, notes = _usual(run, workload)
        given = recommend_usual(run, wanted, memory_limit=memory_limit)
    is_brief = mix is None and workload is None
    if is_brief:
        notes.append(
            "More on each, with reasons and what would change it: --workload NAME, or --mix with your own work."
        )
    colour = sys.stdout.isatty()
    click.echo(advice_as(given, form, notes=notes, brief=is_brief, colour=colour), nl=False, color=colour)


def _usual(run: Results, name: str | None) -> tuple[list[Workload], list[str]]:
    """The workload of that name, or all that the run can answer, with a note on each that it cannot.

    Raises:
        InputError: there is none, or not one whose scenarios are in the run.
    """
    from tetrabench import registry
    from tetrabench.report.advice.recommend import unmeasured

    known = registry.workloads(run.family)
    if name is not None:
        try:
            wanted = [find_named("workload", known, name)]
        except InputError as error:
            raise InputError(f"{str(error).partition('there are: ')[0]}there are: {_spelled(known)}") from None
    else:
        wanted = list(known.values())
    missing = {one.name: lacking for one in wanted if (lacking := unmeasured(one, run))}
    notes = [f"{one} is left out: the run is without {', '.join(lacking)}." for one, lacking in missing.items()]
    if len(missing) == len(wanted):
        named = sorted({scenario for lacking in missing.values() for scenario in lacking})
        lacks = f"this run is without {', '.join(named)}" if named else f"no workloads are known of {run.family}"
        raise InputError(f"{lacks}: say with --mix NAME=N what you do, of {', '.join(task.name for task in run.tasks)}")
    return [one for one in wanted if one.name not in missing], notes


def _spelled(known: Mapping[str, Workload]) -> str:
    """Each with its mix, as one would type it."""
    mixes = {one.name: ",".join(f"{name}={number:g}" for name, number in one.mix.items()) for one in known.values()}
    return "; ".join(f"{name} ({mix})" for name, mix in mixes.items()) or "none"
