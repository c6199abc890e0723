"""The commands of a page, run as a reader would run them: in order, in one folder, as they are printed.

A block that is fenced as `console` has commands, which begin with `$ `, and what they print. Comments of Markdown say the rest:

    <!-- not run: why -->       of the block that follows: it takes minutes, needs a screen, or changes the machine
    <!-- before: command -->    a preparation that the reader has done, with $REPOSITORY for the folder of the repository
"""

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import click

ROOT = Path(__file__).parents[1]

_PIECE = re.compile(
    r"<!-- before: (?P<before>.*?) -->|(?:<!-- not run: (?P<why>.*?) -->\n+)?^[ ]*```console\n(?P<block>.*?)^[ ]*```$",
    re.DOTALL | re.MULTILINE,
)


@dataclass(frozen=True)
class Command:
    """A command of a page.

    Attributes:
        text: what is typed, without the `$ `.
        shown: the lines that the page shows of what it prints; empty where it shows none.
        line: of the page, from 1, where its block begins.
        why_not: why it is not run; None where it is.
    """

    text: str
    shown: tuple[str, ...] = ()
    line: int = 0
    why_not: str | None = None


def commands_of(page: str) -> list[Command]:
    """All commands of a page, preparations included, in their order."""
    return [command for piece in _PIECE.finditer(page) for command in _of_piece(piece, page)]


def run(command: Command, folder: Path) -> "subprocess.CompletedProcess[str]":
    """Run a command in a folder, with the programs of this environment; stdout and stderr come together."""
    programs = os.pathsep.join([str(Path(sys.executable).parent), os.environ.get("PATH", "")])
    environment = {**os.environ, "PATH": programs, "REPOSITORY": str(ROOT), "COLUMNS": "120"}
    return subprocess.run(
        ["bash", "-e", "-o", "pipefail", "-c", command.text],
        cwd=folder,
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )


def not_printed(command: Command, printed: str) -> list[str]:
    """The shown lines that were not printed. Lines with figures are another machine's, and `...` is what is left out."""
    there = {_squeezed(line) for line in printed.splitlines()}
    wanted = (_squeezed(line) for line in command.shown if not re.search(r"\d", line))
    return [line for line in wanted if line not in there | {"", "..."}]


def faults_of_usage(command: Command, main: click.Group) -> list[str]:
    """Verbs and options that the command names and `main`, the program tetrabench, does not have."""
    faults = []
    for words in _programs(command.text):
        if not words or Path(words[0]).name != "tetrabench":
            continue
        verb: click.Command | None = main
        while isinstance(verb, click.Group) and len(words) > 1 and not words[1].startswith("-"):
            words = words[1:]
            verb = verb.commands.get(words[0])
        if verb is None:
            faults.append(f"no verb {words[0]}")
            continue
        known = {name for option in verb.params for name in (*option.opts, *option.secondary_opts)} | {"--help", "-h"}
        faults += [
            f"{words[0]} has no {word}" for word in words[1:] if re.match(r"--?[a-z]", word) and word not in known
        ]
    return faults


def _of_piece(piece: "re.Match[str]", page: str) -> Iterator[Command]:
    """The commands of a block, or the one of a preparation."""
    line = page.count("\n", 0, piece.start()) + 1
    if piece["before"]:
        yield Command(piece["before"], line=line)
        return
    for part in re.split(r"^[ ]*\$ ", piece["block"], flags=re.MULTILINE)[1:]:
        text, *shown = re.sub(r"\\\n\s*(?:> )?", "", part).splitlines()
        yield Command(text, tuple(shown), line, piece["why"])


def _programs(text: str) -> Iterable[list[str]]:
    """The words of each program that a command calls."""
    words = shlex.shlex(text, posix=True, punctuation_chars=True)
    words.whitespace_split = True
    words.commenters = "#"
    program: list[str] = []
    for word in words:
        if set(word) <= set("|&;<>()"):
            yield program
            program = []
        else:
            program.append(word)
    yield program


def _squeezed(line: str) -> str:
    """A line without what the width of columns changes."""
    return re.sub(r"\s+", " ", re.sub(r"[─-]{3,}", "---", line)).strip()
