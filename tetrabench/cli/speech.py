"""How the verbs speak to a person: messages, tables of words, patience, progress of a run."""

from __future__ import annotations

import contextlib
import sys
import threading
import warnings
from time import monotonic
from typing import TYPE_CHECKING, Any

import click

from tetrabench.errors import PluginWarning
from tetrabench.printable import printable

if TYPE_CHECKING:
    from collections.abc import Callable, Iterator, Sequence

    from rich.progress import Progress

    from tetrabench.bench import Plan

PATIENCE = 2.0  # seconds until a person wants to know what is going on
PATIENCE_WITH_A_PHASE = 30.0  # seconds between lines of a log
WIDTH = 100  # where there is no terminal to fit into


def say(message: str) -> None:
    """A message to the person, apart from what was asked for; a file's words in it move no cursor."""
    click.echo("\n".join(map(printable, message.split("\n"))), err=True)


@contextlib.contextmanager
def told_of_skipped() -> Iterator[None]:
    """Say what plug-ins are skipped when that happens, each once."""
    said = set()
    show = warnings.showwarning

    def tell(message: Warning | str, category: type[Warning], *rest: Any, **more: Any) -> None:
        if not issubclass(category, PluginWarning):
            show(message, category, *rest, **more)
        elif str(message) not in said:
            said.add(str(message))
            say(f"tetrabench: {message}")

    with warnings.catch_warnings():
        warnings.simplefilter("always", PluginWarning)
        warnings.showwarning = tell
        yield


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


@contextlib.contextmanager
def patience(doing: str) -> Iterator[Callable[[int, int], None]]:
    """Say on stderr what is going on, once that takes long: with a clock on a terminal, else in one line.

    Whoever knows how far it is, calls what this yields with how many of how many are done: the clock tells what is left.
    """
    stream = sys.stderr  # that of now: what meshio prints is taken away from it meanwhile
    shown = contextlib.ExitStack()
    far: list[tuple[int, int]] = []  # the last one counts
    bars: list[Progress] = []

    def step(done: int, total: int) -> None:
        far.append((done, total))
        for bar in bars:
            bar.update(bar.task_ids[0], completed=done, total=total)

    def tell() -> None:
        from rich.console import Console
        from rich.progress import Progress, SpinnerColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn

        console = Console(file=stream)
        if console.is_terminal:
            words = SpinnerColumn(), TextColumn("{task.description}", markup=False), TimeElapsedColumn()
            left = (TextColumn("left:"), TimeRemainingColumn()) if far else ()
            bar = Progress(*words, *left, console=console, transient=True, redirect_stdout=False, redirect_stderr=False)
            done, total = far[-1] if far else (0, None)
            shown.enter_context(bar).add_task(doing, total=total, completed=done)
            bars.append(bar)
        else:
            console.print(f"{doing} ...", markup=False, highlight=False, soft_wrap=True)

    timer = threading.Timer(PATIENCE, tell)
    timer.daemon = True
    timer.start()
    try:
        yield step
    finally:
        timer.cancel()
        timer.join()
        shown.close()


class RunProgress:
    """Progress of a run on stderr: a bar on a terminal, else a plain line a phase, or after PATIENCE_WITH_A_PHASE."""

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
        self._said, self._spoke = "", 0.0

    def __enter__(self) -> RunProgress:
        self._bar.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._bar.stop()

    def started(self, plan: Plan) -> None:
        """What is going to happen."""
        from tetrabench.report.units import plural

        backends = ", ".join(backend.name for backend in plan.backends if not backend.control)
        models, effort = ", ".join(plan.models), plan.effort
        self._say(
            f"{models}: {plural(len(plan.tasks), 'task')} on {backends}; "
            f"{plural(effort.launches, 'launch')} of {plural(effort.rounds, 'round')} at most"
        )

    def step(self, phase: str, detail: str, done: int, total: int, seconds_remaining: float | None) -> None:
        """What happens now."""
        self._began, self._remaining = monotonic(), seconds_remaining
        left = self._left(self._began)
        self._bar.update(self._task, description=f"{phase}: {detail}", completed=done, total=total)
        if not self._live and (phase != self._said or self._began - self._spoke > PATIENCE_WITH_A_PHASE):
            self._say(f"{phase}: {detail} {f'({done} of {total} done, {left})' if left else ''}".rstrip())
            self._said, self._spoke = phase, self._began

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
