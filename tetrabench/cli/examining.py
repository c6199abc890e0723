"""What `check --contestant` does: examine backends by the rules of their family, and say what is wrong in words."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import click
from click.core import ParameterSource

from tetrabench.cli.speech import RunProgress, patience, tabulate
from tetrabench.errors import find_named

if TYPE_CHECKING:
    from collections.abc import Sequence

    from tetrabench.bench.conformance import Verdict

FAULT = 3
_ALONG = ("contestants", "family", "form", "timeout_s")
"""Parameters of the verb that go with --contestant."""


def refuse_others(ctx: click.Context) -> None:
    """Complain about options that have no meaning beside --contestant."""
    for param in ctx.command.params:
        given = param.name and ctx.get_parameter_source(param.name) is ParameterSource.COMMANDLINE
        if given and param.name not in _ALONG and param.expose_value | (param.name in ("tets", "cells", "objects")):
            raise click.UsageError(
                f"--contestant examines backends by the rules of their family: leave out {param.opts[0]}", ctx
            )
    if ctx.params["form"] not in ("table", "json"):
        raise click.UsageError("--contestant has --format table or json", ctx)


def examine_all(ctx: click.Context, names: Sequence[str], family: str, form: str, timeout_s: float) -> None:
    """Examine backends, print what came out, and end with 0 or FAULT."""
    import msgspec

    from tetrabench.bench.catalogue import Inquiry
    from tetrabench.bench.conformance import FAULTY, TIMEOUT_S, examine

    refuse_others(ctx)
    if ctx.get_parameter_source("timeout_s") is not ParameterSource.COMMANDLINE:
        timeout_s = TIMEOUT_S
    verdicts: list[Verdict] = []
    with Inquiry() as guide:
        with patience("looking up backends"):
            known = {one.name: one for one in guide.describe(family).contestants}
        for name in names:  # before the first is examined, which takes minutes
            find_named("backend", known, name, f"in the family {family}")
        with RunProgress() as progress:

            def step(phase: str, detail: str, done: int, total: int) -> None:
                progress.step(phase, detail, done, total, None)

            for name in names:
                verdicts.extend(examine(family, name, guide=guide, timeout_s=timeout_s, step=step))
    if form == "json":
        click.echo(msgspec.json.format(msgspec.json.encode(verdicts)))
    else:
        for name in names:
            show(name, [verdict for verdict in verdicts if verdict.contestant == name])
    ctx.exit(FAULT if any(verdict.status == FAULTY for verdict in verdicts) else 0)


def show(name: str, verdicts: Sequence[Verdict]) -> None:
    """A table of rules by modes, all scenarios in one row, then what is wrong in each, in words."""
    from tetrabench.bench.conformance import FAULTY, MODES, SCENARIO

    scenarios = [verdict for verdict in verdicts if verdict.rule.startswith(SCENARIO)]
    rules = [verdict for verdict in verdicts if verdict not in scenarios]
    rows = []
    for rule in dict.fromkeys(verdict.rule for verdict in rules):
        own = {verdict.mode: verdict for verdict in rules if verdict.rule == rule}
        rows.append((rule, *(_cell([own[mode]]) for mode in MODES), next(iter(own.values())).title))
    if scenarios:
        title = f"the answers to {len(scenarios)} scenarios: {scenarios[0].title}"
        rows.append(("scenarios", *("" for _ in list(MODES)[:-1]), _cell(scenarios), title))
    tabulate([name, *MODES, "what must be so"], rows)
    click.echo()
    faulty = [verdict for verdict in verdicts if verdict.status == FAULTY]
    for verdict in faulty:
        for fault in verdict.faults:
            click.echo(f"{verdict.rule}, {verdict.mode}: {fault}")
    if faulty:
        click.echo(f"{name}: {_count(faulty)}; what comes first in the table is relied upon later, so mend that first")
    else:
        untried = [verdict for verdict in verdicts if verdict.note]
        for verdict in untried:
            click.echo(f"{verdict.rule}, not compared: {verdict.note}")
        seconds = sum(verdict.wall_s for verdict in verdicts)
        limits = f"; {len(untried)} of {len(scenarios)} scenarios were not compared" if untried else ""
        click.echo(f"{name} does what is asked of it ({seconds:.0f} s){limits}")


def _cell(verdicts: Sequence[Verdict]) -> str:
    """The worst of them in a word."""
    statuses = {verdict.status for verdict in verdicts}
    return "FAULTY" if "faulty" in statuses else "sound" if "sound" in statuses else "-"


def _count(faulty: Sequence[Any]) -> str:
    return "a fault in 1 rule" if len(faulty) == 1 else f"faults in {len(faulty)} rules"
