"""The verbs; the only package that prints to a person. Tables go to stdout, progress and messages to stderr.

What is heavy is imported inside the verbs, so that help comes at once.
"""

from __future__ import annotations

import sys
from typing import Any, NoReturn

import click

from tetrabench.cli.advising import recommend
from tetrabench.cli.comparing import compare, gate, history
from tetrabench.cli.machine import doctor
from tetrabench.cli.meshes import convert, generate, info
from tetrabench.cli.new import new
from tetrabench.cli.reporting import report
from tetrabench.cli.runs import check, list_, run, show
from tetrabench.cli.speech import say, told_of_skipped
from tetrabench.cli.viewing import view
from tetrabench.cli.watching import watch
from tetrabench.errors import InputError, TetrabenchError, find_named

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
            with told_of_skipped():
                return super().invoke(ctx)
        except TetrabenchError as error:
            say(f"tetrabench: {error}")
            ctx.exit(error.exit_code)
        except KeyboardInterrupt:
            say("tetrabench: interrupted")
            ctx.exit(INTERRUPTED)


@click.group(cls=Verbs, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 100})
@click.version_option(package_name="tetrabench", message="%(package)s %(version)s")
def main() -> None:
    """How should a program store a large mesh? The same workloads on interchangeable storage backends.

    Exit codes: 0 all well; 1 a regression; 2 wrong usage or bad input; 3 a backend crashed or gave a wrong answer;
    4 inconclusive (if asked); 5 not comparable; 6 not enough memory; 130 interrupted.
    """


_OF_RUNS = (run, check, show, report, recommend, gate, compare, history)
_OF_MODELS = (doctor, list_, info, view, watch, convert, generate, new)
for verb in (*_OF_RUNS, *_OF_MODELS):
    main.add_command(verb)
