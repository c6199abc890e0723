"""The verbs on runs: run, check, show, list."""

from __future__ import annotations

import sys
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from tetrabench.cli.examining import examine_all
from tetrabench.cli.options import (
    FILE,
    chart_format_option,
    charts_option,
    check_folder,
    family_option,
    format_option,
    intervals_option,
    plugin_option,
    read_seconds,
    split_names,
    timeout_option,
    what_options,
)
from tetrabench.cli.speech import RunProgress, patience, say, tabulate

if TYPE_CHECKING:
    from tetrabench.bench import Plan, Results
    from tetrabench.protocols import Option, Scenario


@click.command()
@what_options
@click.option("--thesis", is_flag=True, help="As the source did it: its counts, its order, one net for all.")
@click.option("--quick", is_flag=True, help="3 launches: shows what is many times as slow, ranks nothing else.")
@click.option("--rigorous", is_flag=True, help="12 launches of 5 rounds, fewer where an interval is narrow sooner.")
@click.option("--launches", type=int, help="How often all backends get fresh processes.")
@click.option("--rounds", type=int, help="How often each backend has its turn in a launch.")
@click.option("--budget", "budget_s", callback=read_seconds, metavar="TIME", help="Of the run, such as 90s or 10m.")
@timeout_option
@click.option("-o", "--output", metavar="FILE.json", type=FILE, callback=check_folder, help="Save the results.")
@click.option("--resume", is_flag=True, help="Go on with a run to -o that was broken off.")
@click.option("--dry-run", is_flag=True, help="Say what would be done, and do nothing.")
@charts_option
@chart_format_option
@format_option
@intervals_option
@click.pass_context
def run(
    ctx: click.Context,
    /,
    output: Path | None,
    resume: bool,
    dry_run: bool,
    charts: Path | None,
    chart_format: str,
    form: str,
    intervals: bool,
    thesis: bool,
    quick: bool,
    rigorous: bool,
    **choices: Any,
) -> None:
    """Run scenarios on backends, compare the answers, and say what each cost in time and memory.

    Where nothing is named that is a first look: a few of them on a small model, within a minute.
    """
    from tetrabench.bench import exit_code, run_benchmark

    profiles = {"thesis": thesis, "quick": quick, "rigorous": rigorous}
    asked = [name for name, is_asked in profiles.items() if is_asked]
    if len(asked) > 1:
        raise click.UsageError(f"--{asked[0]} and --{asked[1]}: choose one", ctx)
    if resume and output is None:
        raise click.UsageError("--resume goes on with the run to -o FILE.json: say which", ctx)
    plan = look_up(choices, asked[0] if asked else "default")
    if dry_run:
        click.echo(describe_plan(plan))
        if plan.left_out:
            say(plan.left_out)
        return
    with RunProgress() as progress:
        results = run_benchmark(plan, progress=progress, output=output, resume=resume)
    present(results, form, charts, chart_format, intervals=intervals)
    if output:
        say(f"wrote {output}")
    if plan.left_out:
        say(plan.left_out)
    if results.ended:
        why = "interrupted" if results.ended == "interrupted" else "out of budget"
        kept = f"go on with --resume -o {output}" if output else "no results are kept without -o"
        say(f"tetrabench: {why} after {count(len(results.launches), 'launch', 'launches')}; {kept}")
    ctx.exit(exit_code(results))


@click.command()
@what_options
@click.option(
    "--contestant",
    "contestants",
    multiple=True,
    callback=split_names,
    metavar="A,B",
    help="Examine backends by the rules of their family instead: in plain Python, with bounds checks, and compiled; "
    "5 minutes a rule and mode, unless --timeout says otherwise.",
)
@timeout_option
@format_option
@click.pass_context
def check(ctx: click.Context, /, form: str, contestants: list[str] | None, **choices: Any) -> None:
    """Run scenarios on backends once, and compare their answers. No times.

    Exit code 3 if a backend gives a wrong answer, or ends badly; with --contestant, if it breaks a rule.
    """
    from tetrabench.bench import exit_code, run_benchmark

    if contestants is not None:
        examine_all(ctx, contestants, choices["family"], form, choices["timeout_s"])
    plan = look_up(choices, "check")
    with RunProgress() as progress:
        results = run_benchmark(plan, progress=progress)
    present(results, form, None, "")
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
@plugin_option
def list_(what: str, family: str) -> None:
    """List the backends, scenarios or models that there are."""
    from tetrabench import registry

    if what == "backends":
        known = registry.contestants(family)
        tabulate(
            ["backend", "how it stores", "trade-off"],
            [(one.name + "*" * one.extension, one.title, one.trade_off) for one in known],
        )
        if any(one.extension for one in known):
            click.echo("* not from the source")
        for one in known:
            if not one.is_exact:
                click.echo(f"{one.name} is known to give wrong answers: it takes part where --backend names it")
        if options := [_option(one.name, name, option) for one in known for name, option in one.options.items()]:
            click.echo()
            tabulate(["--option", "unless given", "may be", "what it decides"], options)
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


def _option(owner: str, name: str, option: Option) -> tuple[str, str, str, str]:
    """An option of a backend, as it is typed, with its value and its limits."""
    return f"{owner}.{name}", f"{option.value}", f"{option.least} to {option.most}", option.title


def _counts(scenario: Scenario) -> str:
    """Its options, and those of the source where they are others."""
    thesis = scenario.thesis
    return ", ".join(
        f"{name} {count:,}" + (f" (thesis {thesis[name]:,})" if thesis.get(name, count) != count else "")
        for name, count in scenario.options.items()
    )


def look_up(choices: dict[str, Any], profile: str) -> Plan:
    """The plan that is asked for; its model is generated if need be."""
    from tetrabench.bench import make_plan
    from tetrabench.bench.catalogue import Inquiry

    with patience("looking up backends, scenarios and the model"), Inquiry() as guide:
        return make_plan(profile=profile, guide=guide, **choices)


def describe_plan(plan: Plan) -> str:
    """What a run would do, in lines."""
    effort = plan.effort
    cells = len(plan.models) * len(plan.tasks) * len(plan.backends)
    lines = {
        "models": ", ".join(plan.models),
        "tasks": ", ".join(task.name for task in plan.tasks),
        "backends": ", ".join(backend.name for backend in plan.backends),
        "reference": plan.reference,
        "effort": f"{count(effort.launches, 'launch', 'launches')} of {count(effort.rounds, 'round', 'rounds')}, "
        f"at most {cells * effort.launches * effort.rounds:,} samples",
        "command": plan.command,
    }
    return "\n".join(f"{name:10} {text}" for name, text in lines.items())


def count(number: int, one: str, more: str) -> str:
    """A number with its noun."""
    return f"{number} {one if number == 1 else more}"
