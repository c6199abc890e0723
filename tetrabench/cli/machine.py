"""The verb on the machine: doctor."""

from __future__ import annotations

import click

from tetrabench.cli.speech import patience, tabulate


@click.command()
@click.option(
    "--format",
    "form",
    type=click.Choice(["table", "json"]),
    default="table",
    show_default=True,
    help="For people, or for programs.",
)
def doctor(form: str) -> None:
    """What can be trusted on this machine, and what to do about the rest. Takes some seconds."""
    import msgspec

    from tetrabench.bench.doctor import examine

    with patience("measuring the machine"):
        facts = list(examine())
    if form == "json":
        click.echo(msgspec.json.format(msgspec.json.encode(facts), indent=1))
        return
    tabulate(["fact", "value", "", "what it means, what to do"], [(f.name, f.value, f.state, f.advice) for f in facts])
