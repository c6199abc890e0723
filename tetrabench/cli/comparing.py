"""The verbs on two versions: gate, compare, history."""

from __future__ import annotations

import contextlib
import signal
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tetrabench.cli.options import (
    FILE,
    check_folder,
    gate_options,
    read_seconds,
    split_names,
    strict_option,
    threshold_option,
    timeout_option,
    verdict_format_option,
)
from tetrabench.cli.speech import RunProgress, say

if TYPE_CHECKING:
    from collections.abc import Iterator

    from tetrabench.bench import Plan
    from tetrabench.bench.catalogue import Guide

HISTORY = "history.jsonl"


@click.command()
@click.option("--base", required=True, metavar="REV", help="The git revision to compare with.")
@click.option("--head", metavar="REV", help="The one in question; unless given, the working tree as it is.")
@gate_options
@threshold_option
@click.option("--launches", type=int, help="How often all backends get fresh processes, at most.  [default: 12]")
@click.option("--rounds", type=int, help="How often each has its turn in a launch.  [default: 5]")
@click.option("--budget", "budget_s", callback=read_seconds, metavar="TIME", help="Of each run, such as 90s or 10m.")
@timeout_option
@click.option("-o", "--output", metavar="FILE.json", type=FILE, callback=check_folder, help="Save the samples.")
@verdict_format_option
@strict_option
@click.pass_context
def gate(
    ctx: click.Context,
    /,
    base: str,
    head: str | None,
    threshold: float,
    output: Path | None,
    form: str,
    strict: bool,
    **choices: Any,
) -> None:
    """Is the code in this git checkout slower than BASE, or larger, or are its answers other ones?

    Both versions run in turns, in one ring. Exit codes: 0 no; 1 a regression, which a second run confirmed;
    3 a backend crashed or gave another answer; 4 inconclusive (--strict); 5 BASE is too old to be compared.
    """
    from tetrabench.bench import make_plan
    from tetrabench.bench.gate import run_gate
    from tetrabench.bench.limits import limits_of
    from tetrabench.report.verdicts import gate_as

    def make(guide: Guide) -> Plan:
        return make_plan(profile="rigorous", guide=guide, **choices)

    with _ended_as_by_ctrl_c(), RunProgress() as progress:
        found = run_gate(Path.cwd(), base, head, make, limits_of(threshold), progress=progress, output=output)
    colour = sys.stdout.isatty()
    click.echo(gate_as(found, form, colour=colour, strict=strict), nl=False, color=colour)
    ctx.exit(found.exit_code(strict=strict))


@click.command()
@click.argument("old", type=FILE, metavar="OLD.json")
@click.argument("new", type=FILE, metavar="NEW.json")
@threshold_option
@verdict_format_option
@strict_option
@click.pass_context
def compare(ctx: click.Context, /, old: Path, new: Path, threshold: float, form: str, strict: bool) -> None:
    """What became slower, faster or larger between two runs that were saved. Weaker than `gate`.

    Compares ratios to the reference, never times. Exit codes: 0 nothing; 1 a regression; 3 a cell went wrong in the
    new run; 4 inconclusive (--strict); 5 the runs differ in more than the code.
    """
    from tetrabench.bench import read_results
    from tetrabench.bench.compare import compare as compare_results
    from tetrabench.bench.limits import limits_of
    from tetrabench.report.verdicts import comparison_as

    found = compare_results(read_results(old), read_results(new), limits_of(threshold))
    colour = sys.stdout.isatty()
    click.echo(comparison_as(found, form, colour=colour, strict=strict), nl=False, color=colour)
    ctx.exit(found.exit_code(strict=strict))


@click.group()
def history() -> None:
    """Ratios over commits: a file that grows by a line a run. Advisory, decides nothing."""


@history.command()
@click.argument("results", type=FILE, metavar="RESULTS.json")
@click.option("--file", type=FILE, default=HISTORY, show_default=True, callback=check_folder, help="The history.")
def add(results: Path, file: Path) -> None:
    """Add a run that was saved. Adding it again does nothing."""
    from tetrabench.bench import read_results
    from tetrabench.bench.history import add as add_run

    is_new = add_run(read_results(results), file)
    say(f"added to {file}" if is_new else f"{file} has this run already: nothing added")


@history.command()
@click.option("--file", type=FILE, default=HISTORY, show_default=True, help="The history.")
@click.option(
    "-o", "--output", required=True, metavar="FILE.png|svg", type=FILE, callback=check_folder, help="The chart."
)
@click.option("--scenario", "scenarios", multiple=True, callback=split_names, metavar="A,B", help="All unless given.")
@click.option("--backend", "backends", multiple=True, callback=split_names, metavar="A,B", help="All unless given.")
def plot(file: Path, output: Path, scenarios: list[str] | None, backends: list[str] | None) -> None:
    """Draw the ratios of each backend over the commits."""
    from tetrabench.bench.history import read_history
    from tetrabench.report.history import draw_history

    draw_history(read_history(file), output, scenarios=scenarios, backends=backends)
    say(f"wrote {output}")


@contextlib.contextmanager
def _ended_as_by_ctrl_c() -> Iterator[None]:
    """Whoever ends the process, its workers and temporary folders end with it: CI cancels a job by SIGTERM."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)
