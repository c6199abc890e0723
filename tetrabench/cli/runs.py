"""The verbs on runs: run, check, show, list."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tetrabench.cli.options import (
    FILE,
    chart_format_option,
    charts_option,
    check_folder,
    family_option,
    format_option,
    intervals_option,
    numbering_option,
    read_count,
    seed_option,
    split_names,
)
from tetrabench.cli.speech import say, tabulate

if TYPE_CHECKING:
    from tetrabench.bench import Results
    from tetrabench.protocols import Scenario


@click.command()
@click.option("--model", required=True, metavar="FILE|NAME", help="A Nastran file, or a model to generate.")
@family_option
@click.option("--backend", "backends", multiple=True, callback=split_names, metavar="A,B", help="All unless given.")
@click.option("--scenario", "scenarios", multiple=True, callback=split_names, metavar="A,B", help="All unless given.")
@click.option("--reference", metavar="A", help="The backend that ratios refer to.")
@click.option("--tets", callback=read_count, metavar="N", help="Size of a generated model, such as 100k.")
@numbering_option
@seed_option
@click.option("--thesis", is_flag=True, help="As the source did it: its counts, its order, one net for all.")
@click.option("--quick", is_flag=True, help="Fewer rounds.")
@click.option("--rounds", type=int, help="How often each backend has its turn.")
@click.option("-o", "--output", metavar="FILE.json", type=FILE, callback=check_folder, help="Save the results.")
@charts_option
@chart_format_option
@format_option
@intervals_option
@click.pass_context
def run(
    ctx: click.Context,
    /,
    output: Path | None,
    charts: Path | None,
    chart_format: str,
    form: str,
    intervals: bool,
    **choices: Any,
) -> None:
    """Run scenarios on backends, compare the answers, and say what each cost in time and memory."""
    from tetrabench.bench import exit_code, make_plan, run_benchmark, save_results

    plan = make_plan(choices.pop("model"), **choices)
    with RunProgress() as progress:
        results = run_benchmark(plan, progress=progress)
    if output:
        save_results(results, output)
    present(results, form, charts, chart_format, intervals=intervals)
    if output:
        say(f"wrote {output}")
    if results.interrupted:
        kept = f"results so far are in {output}" if output else "no results are kept without -o"
        say(f"tetrabench: interrupted; {kept}")
    ctx.exit(exit_code(results))


@click.command()
@click.argument("results", type=FILE, metavar="RESULTS.json")
@charts_option
@chart_format_option
@format_option
@intervals_option
def show(results: Path, charts: Path | None, chart_format: str, form: str, intervals: bool) -> None:
    """Show the tables of a run that was saved, or their figures for other programs, and draw its charts."""
    from tetrabench.bench import read_results

    present(read_results(results), form, charts, chart_format, intervals=intervals)


@click.command("list")
@click.argument("what", type=click.Choice(["backends", "scenarios", "models"]))
@family_option
def list_(what: str, family: str) -> None:
    """List the backends, scenarios or models that there are."""
    from tetrabench import registry

    if what == "backends":
        marked = [(one.name + "*" * one.extension, one) for one in registry.contestants(family)]
        tabulate(
            ["backend", "layout, slots", "trade-off"],
            [(name, one.title, one.trade_off) for name, one in marked],
        )
        if any(one.extension for _, one in marked):
            click.echo("* not from the source")
    elif what == "scenarios":
        rows = [(one.name, one.title, _counts(one)) for one in registry.scenarios(family)]
        tabulate(["scenario", "what it does", "counts"], rows)
    else:
        tabulate(["model", "what it is"], list(registry.family(family).models.items()))


def present(results: Results, form: str, charts: Path | None, chart_format: str, *, intervals: bool = False) -> None:
    """Print the tables, or what another form says; draw the charts if they are wanted, and name their files."""
    from tetrabench.report.formats import FORMATS
    from tetrabench.report.table import as_markdown, as_text

    colour = form == "table" and sys.stdout.isatty()
    forms = FORMATS | {
        "table": partial(as_text, colour=colour, intervals=intervals),
        "md": partial(as_markdown, intervals=intervals),
    }
    click.echo(forms[form](results), nl=False, color=colour)
    if charts:
        from tetrabench.report.chart import draw_charts

        for path in draw_charts(results, charts, f".{chart_format}"):
            say(f"wrote {path}")


def _counts(scenario: Scenario) -> str:
    """Its options, and those of the source where they are others."""
    thesis = scenario.thesis
    return ", ".join(
        f"{name} {count:,}" + (f" (thesis {thesis[name]:,})" if thesis[name] != count else "")
        for name, count in scenario.options.items()
    )
