"""The verbs; the only module that prints to a person. Tables go to stdout, progress and messages to stderr.

What is heavy is imported inside the verbs, so that help comes at once.
"""

from __future__ import annotations

import contextlib
import re
import sys
import tempfile
import threading
from fractions import Fraction
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any, NoReturn

import click

from tetrabench.errors import InputError, RepairableError, TetrabenchError, find_named

if TYPE_CHECKING:
    from collections.abc import Iterator, Sequence

    from tetrabench.bench import Plan, Results
    from tetrabench.mesh.inspection import Inspection
    from tetrabench.protocols import Scenario

FILE = click.Path(dir_okay=False, path_type=Path)
PATIENCE = 2.0  # seconds until a person wants to know what is going on
WIDTH = 100  # where there is no terminal to fit into
INTERRUPTED = 130


class Verbs(click.Group):
    """All verbs, and what becomes of their errors: one line, and an exit code."""

    def main(self, *args: Any, **extra: Any) -> NoReturn:  # type: ignore[override]
        """Run the command line."""
        extra["standalone_mode"] = False  # click would print its usage too, in four lines
        try:
            code = super().main(*args, **extra)
        except click.exceptions.NoArgsIsHelpError as error:
            error.show()
            sys.exit(error.exit_code)
        except click.UsageError as error:
            command = error.ctx.command_path if error.ctx else "tetrabench"
            say(f"tetrabench: {error.format_message().rstrip('.')}; see {command} --help")
            sys.exit(error.exit_code)
        except click.ClickException as error:
            say(f"tetrabench: {error.format_message()}")
            sys.exit(error.exit_code)
        except click.Abort:
            say("tetrabench: interrupted")
            sys.exit(INTERRUPTED)
        sys.exit(code if isinstance(code, int) else 0)

    def resolve_command(self, ctx: click.Context, args: list[str]) -> Any:
        """Find the verb, or say which one is near."""
        if args and not args[0].startswith("-"):
            try:
                find_named("verb", self.commands, args[0])
            except InputError as error:
                raise click.UsageError(str(error), ctx) from None
        return super().resolve_command(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        """Run a verb."""
        try:
            return super().invoke(ctx)
        except TetrabenchError as error:
            say(f"tetrabench: {error}")
            ctx.exit(error.exit_code)
        except KeyboardInterrupt:
            say("tetrabench: interrupted")
            ctx.exit(INTERRUPTED)


def read_count(ctx: click.Context, param: click.Parameter, text: str | None) -> int | None:
    """A whole number such as 642700, 642,700, 100k or 1.5M."""
    if text is None:
        return None
    match = re.fullmatch(r"([0-9]+(?:\.[0-9]+)?)([kM]?)", text.replace(",", "").replace("_", ""))
    number = Fraction(match[1]) * {"": 1, "k": 1_000, "M": 1_000_000}[match[2]] if match else Fraction(1, 2)
    if number.denominator != 1:
        raise click.BadParameter(f"{text!r} is no count such as 642700, 100k or 1.5M", ctx, param)
    return int(number)


def split_names(ctx: click.Context, param: click.Parameter, values: tuple[str, ...]) -> list[str] | None:
    """Names out of comma lists and repeated options; None where the option was not given."""
    if not values:
        return None
    return [name for value in values for part in value.split(",") if (name := part.strip())]


def check_folder(ctx: click.Context, param: click.Parameter, path: Path | None) -> Path | None:
    """Complain about a folder that is not there, or cannot be written to, before the work, not after it."""
    if path is not None and not path.absolute().parent.is_dir():
        raise click.BadParameter(f"there is no folder {path.parent}", ctx, param)
    if path is not None:
        try:
            with tempfile.TemporaryFile(dir=path.absolute().parent):
                pass
        except OSError as error:
            raise click.BadParameter(f"cannot write into {path.parent}: {error.strerror}", ctx, param) from error
    return path


def check_numbering(ctx: click.Context, param: click.Parameter, name: str) -> str:
    """The name of a numbering, looked up before the work."""
    from tetrabench.mesh.numbering import NUMBERINGS

    find_named("numbering", NUMBERINGS, name)
    return name


seed_option = click.option("--seed", default=0, help="Of all that is random.", show_default=True)
family_option = click.option("--family", default="tetra", show_default=True, help="The kind of thing to store.")
numbering_option = click.option(
    "--numbering",
    metavar="natural|shuffled|hilbert|rcm",  # those of mesh.numbering: help must not wait for numpy
    callback=check_numbering,
    default="natural",
    show_default=True,
    help="Order of points and tetras: as they come, at random, along a Hilbert curve, or by reverse Cuthill-McKee.",
)
repair_option = click.option(
    "--repair",
    type=click.Choice(["refuse", "drop"]),
    default="refuse",
    show_default=True,
    help="What becomes of tetras that repeat a node, are duplicates, or are more than two at a side.",
)
format_option = click.option(
    "--format",
    "form",
    type=click.Choice(["table", "md"]),
    default="table",
    show_default=True,
    help="Of the table.",
)
charts_option = click.option(
    "--charts",
    metavar="DIR",
    type=click.Path(file_okay=False, path_type=Path),
    help="Draw the charts into this folder.",
)
chart_format_option = click.option(
    "--chart-format",
    type=click.Choice(["png", "svg"]),
    default="png",
    show_default=True,
    help="Of the charts.",
)


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="tetrabench", message="%(package)s %(version)s")
def main() -> None:
    """How should a program store a large mesh? The same workloads on interchangeable storage backends.

    Exit codes: 0 all well; 2 wrong usage or bad input; 3 a backend crashed or gave a wrong answer;
    6 not enough memory; 130 interrupted.
    """


@main.command()
@click.option("--model", required=True, metavar="FILE|NAME", help="A mesh in any format, or a model to generate.")
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
@click.pass_context
def run(
    ctx: click.Context,
    /,
    output: Path | None,
    charts: Path | None,
    chart_format: str,
    form: str,
    **choices: Any,
) -> None:
    """Run scenarios on backends, compare the answers, and say what each cost in time and memory."""
    from tetrabench.bench import exit_code, make_plan, run_benchmark, save_results

    plan = make_plan(choices.pop("model"), **choices)
    with _Progress() as progress:
        results = run_benchmark(plan, progress=progress)
    if output:
        save_results(results, output)
    present(results, form, charts, chart_format)
    if output:
        say(f"wrote {output}")
    if results.interrupted:
        kept = f"results so far are in {output}" if output else "no results are kept without -o"
        say(f"tetrabench: interrupted; {kept}")
    ctx.exit(exit_code(results))


@main.command()
@click.argument("results", type=FILE, metavar="RESULTS.json")
@charts_option
@chart_format_option
@format_option
def show(results: Path, charts: Path | None, chart_format: str, form: str) -> None:
    """Show the table of a run that was saved, and draw its charts."""
    from tetrabench.bench import read_results

    present(read_results(results), form, charts, chart_format)


@main.command("list")
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


@main.command()
@click.argument("file", metavar="FILE", type=FILE)
@repair_option
@click.option("--format", "form", type=click.Choice(["table", "json"]), default="table", show_default=True)
def info(file: Path, repair: str, form: str) -> None:
    """Describe a mesh: what it holds, what is wrong with it, what was left out.

    A file that is refused only for tetras that --repair drop leaves out is described without them.
    """
    from dataclasses import replace

    from tetrabench.io import read_mesh
    from tetrabench.mesh.inspection import inspect_mesh

    refusal = ""
    with patience(f"reading {file}"):
        try:
            mesh = read_mesh(file, unused="keep", repair=repair)
        except RepairableError as error:
            refusal = str(error)
            mesh = read_mesh(file, unused="keep", repair="drop")
    with patience(f"inspecting {len(mesh.tets):,} tetras"):
        inspection = replace(inspect_mesh(mesh), refusal=refusal)
    if form == "json":
        import msgspec

        click.echo(msgspec.json.format(msgspec.json.encode(inspection), indent=2))
    else:
        for name, value in describe(inspection):
            click.echo(f"{name:25}{value}")
        for sentence in inspection.warnings:
            click.echo(f"- {sentence}")
        if refusal:
            click.echo("- the file is refused, unless --repair drop leaves these tetras out")


@main.command()
@click.argument("source", metavar="IN", type=FILE)
@click.argument("target", metavar="OUT", type=FILE, callback=check_folder)
@numbering_option
@seed_option
@repair_option
@click.option(
    "--unused",
    type=click.Choice(["drop", "keep"]),
    default="drop",
    show_default=True,
    help="What becomes of points that no tetra uses.",
)
@click.option("--field", type=click.Choice(["small", "large", "free"]), help="Of a Nastran file; free is exact.")
def convert(source: Path, target: Path, numbering: str, seed: int, repair: str, unused: str, field: str | None) -> None:
    """Write a mesh in another format, or in another order."""
    from tetrabench.io import check_target, read_mesh, write_mesh
    from tetrabench.mesh.numbering import renumber

    check_target(target, field)
    with patience(f"reading {source}"):
        mesh = read_mesh(source, unused=unused, repair=repair)
    with patience(f"renumbering {len(mesh.tets):,} tetras"):
        mesh = renumber(mesh, numbering, seed)
    with patience(f"writing {target}"):
        write_mesh(mesh, target, field=field)
    for sentence in mesh.report.warnings:
        say(sentence)
    if unused == "drop" and mesh.report.unreferenced:
        say(f"left out {mesh.report.unreferenced:,} points that no tetra uses")
    if mesh.report.quadratic:
        say(f"took the corners of {mesh.report.quadratic:,} tetras with midside nodes")
    if mesh.report.skipped:
        say("left out " + ", ".join(f"{name} {count:,}" for name, count in mesh.report.skipped.items()))
    say(f"wrote {target}: {len(mesh.tets):,} tetras, {len(mesh.points):,} points")


@main.command()
@click.argument("model", metavar="nozzle|intake|box")
@click.option("--tets", callback=read_count, metavar="N", help="Wanted number of tetras, such as 100k.")
@numbering_option
@seed_option
@click.option("-o", "--output", metavar="FILE.nas", type=FILE, callback=check_folder, required=True)
def generate(model: str, tets: int | None, numbering: str, seed: int, output: Path) -> None:
    """Make a model without a mesher and write it: the same file for the same seed."""
    from tetrabench.io import check_target, write_mesh
    from tetrabench.mesh import models

    check_target(output)
    with patience(f"making {model}"):
        mesh = models.generate(model, tets, numbering=numbering, seed=seed)
    with patience(f"writing {output}"):
        write_mesh(mesh, output)
    click.echo(mesh.report.source)
    say(f"wrote {output}")


def present(results: Results, form: str, charts: Path | None, chart_format: str) -> None:
    """Print the table; draw the charts if they are wanted, and name their files."""
    from tetrabench.report.table import as_markdown, as_text

    colour = sys.stdout.isatty()
    click.echo(as_markdown(results) if form == "md" else as_text(results, colour=colour), nl=False, color=colour)
    if charts:
        from tetrabench.report.chart import draw_charts

        for path in draw_charts(results, charts, f".{chart_format}"):
            say(f"wrote {path}")


def describe(inspection: Inspection) -> list[tuple[str, str]]:
    """The table of `info`: names and values."""
    rows = []
    for name, value in vars(inspection).items():
        if isinstance(value, dict):
            text = ", ".join(f"{key} {count:,}" for key, count in value.items())
        elif isinstance(value, tuple):
            text = ", ".join(f"{x:.9g}" for x in value)
        elif isinstance(value, float):
            text = f"{value:.1f} degrees" if "angle" in name else f"{value:.9g}"
        else:
            text = f"{value:,}" if isinstance(value, int) else str(value or "")
        if name not in ("warnings", "refusal"):
            rows.append((name.replace("_", " "), text or "none"))
    return rows


def tabulate(head: Sequence[str], rows: Sequence[Sequence[str]]) -> None:
    """Print a table of words."""
    from rich.box import SIMPLE_HEAD
    from rich.console import Console
    from rich.table import Table
    from rich.text import Text

    console = Console()
    if not console.is_terminal:
        console.width = WIDTH
    table = Table(box=SIMPLE_HEAD, show_edge=False, pad_edge=False)
    for name in head:
        table.add_column(name, no_wrap=name == head[0])
    for row in rows:
        table.add_row(*map(Text, row))
    console.print(table)


def say(message: str) -> None:
    """A message to the person, apart from what was asked for."""
    click.echo(message, err=True)


@contextlib.contextmanager
def patience(doing: str) -> Iterator[None]:
    """Say on stderr what is going on, once that takes long: with a clock on a terminal, else in one line."""
    stream = sys.stderr  # that of now: what meshio prints is taken away from it meanwhile
    shown = contextlib.ExitStack()

    def tell() -> None:
        from rich.console import Console
        from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn

        console = Console(file=stream)
        if console.is_terminal:
            columns = SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn()
            bar = Progress(*columns, console=console, transient=True, redirect_stdout=False, redirect_stderr=False)
            shown.enter_context(bar).add_task(doing)
        else:
            console.print(f"{doing} ...", markup=False, highlight=False, soft_wrap=True)

    timer = threading.Timer(PATIENCE, tell)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        shown.close()


def _counts(scenario: Scenario) -> str:
    """Its options, and those of the source where they are others."""
    thesis = scenario.thesis
    return ", ".join(
        f"{name} {count:,}" + (f" (thesis {thesis[name]:,})" if thesis[name] != count else "")
        for name, count in scenario.options.items()
    )


class _Progress:
    """Progress of a run on stderr: a bar on a terminal, else a plain line a scenario."""

    def __init__(self) -> None:
        from rich.console import Console
        from rich.progress import BarColumn, Progress, ProgressColumn, Task, TextColumn
        from rich.text import Text

        class Clock(ProgressColumn):
            """What is left, counted down while a turn lasts; and how long one has lasted that takes longer than that."""

            def render(_, task: Task) -> Text:  # noqa: N805 - the progress is `self` here
                return Text(self._left(monotonic()))

        console = Console(stderr=True)
        self._live = console.is_terminal
        columns = TextColumn("{task.description}"), BarColumn(), Clock()
        self._bar = Progress(*columns, console=console, transient=True, disable=not self._live)
        self._task = self._bar.add_task("starting the workers", total=None)
        self._began = monotonic()  # of what happens now
        self._remaining: float | None = None
        self._scenarios: set[str] = set()
        self._said = ""

    def __enter__(self) -> _Progress:
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

    def started(self, plan: Plan) -> None:
        """What is going to happen."""
        self._scenarios = {task.scenario for task in plan.tasks}
        backends = ", ".join(backend.name for backend in plan.backends)
        self._say(f"{plan.model}: {len(plan.tasks)} scenarios on {backends}, {plan.effort.rounds} rounds at most")

    def step(self, text: str, done: int, total: int, seconds_remaining: float | None) -> None:
        """What happens now."""
        self._began, self._remaining = monotonic(), seconds_remaining
        left = self._left(self._began)
        self._bar.update(self._task, description=text, completed=done, total=total)
        phase = text.partition(":")[0]
        phase = phase if phase in self._scenarios else "compiling, or loading what was compiled"
        if phase != self._said and not self._live:
            self._say(f"{phase} {f'({done} of {total} turns done, {left})' if left else ''}".rstrip())
        self._said = phase

    def _left(self, now: float) -> str:
        lasted = now - self._began
        if self._remaining is None:
            return f"for {_clock(lasted)}" if lasted > 2 else ""
        if lasted > self._remaining:
            return f"for {_clock(lasted)}, longer than expected"
        return f"{_clock(self._remaining - lasted)} left"

    def _say(self, message: str) -> None:
        self._bar.console.print(message, markup=False, highlight=False, soft_wrap=True)


def _clock(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    return f"{minutes}:{rest:02}"
