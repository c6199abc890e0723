"""The verb that makes the beginning of a plug-in: new.

What it writes are the files of `tetrabench/templates`, which are a plug-in themselves, of the contestant `mine`: a file of
each family, and what is the same for all.
"""

from __future__ import annotations

import importlib.util
import keyword
import re
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

import click

from tetrabench.cli.options import family_option
from tetrabench.cli.speech import patience, say
from tetrabench.errors import InputError, find_named

if TYPE_CHECKING:
    from collections.abc import Mapping

TEMPLATES = resources.files("tetrabench") / "templates"
MINE = "mine"
"""The name of the contestant in the templates; in its file also that of its class, with a capital."""
TAKEN = ("setup", "conftest")
"""Names of modules that mean something to pip and pytest."""


@click.group()
def new() -> None:
    """Write the beginning of a plug-in: a contestant that works, and its test."""


@new.command()
@click.argument("name", metavar="NAME")
@family_option
@click.option(
    "-o",
    "--output",
    type=click.Path(path_type=Path),
    metavar="FOLDER",
    help="The folder to make.  [default: NAME]",
)
def contestant(name: str, family: str, output: Path | None) -> None:
    """Write a folder with a contestant (a "backend") of your own, NAME, that works and says what to change.

    NAME.py works as --plugin NAME/NAME.py at once, and for good after pip install ./NAME.
    """
    folder = output or Path(name)
    check_name(name)
    files = fill_templates(name, family)
    write_folder(folder, files)
    say(f"wrote {folder}: {', '.join(files)}")
    say(f"next: tetrabench check --contestant {name} --family {family} --plugin {folder / name}.py")


def check_name(name: str) -> None:
    """Complain about what can be no name of a contestant, a module and a distribution at once.

    Raises:
        InputError: says why not.
    """
    if not re.fullmatch(r"[A-Za-z](\w*[A-Za-z0-9])?", name, re.ASCII) or keyword.iskeyword(name) or name in TAKEN:
        raise InputError(f"'{name}' can be no name of a Python module: take letters, digits and _, such as hot_cold")
    if importlib.util.find_spec(name) is not None:
        raise InputError(
            f"there is a Python module '{name}' already, which a contestant of that name would hide: take another"
        )


def fill_templates(name: str, family: str) -> Mapping[str, str]:
    """The text of each file of the plug-in, by its name.

    Raises:
        InputError: the family is unknown, or has no template, or has a contestant of that name.
    """
    from tetrabench.bench.catalogue import Inquiry

    with patience("looking up backends"), Inquiry() as guide:
        known = guide.describe(family)
    if name in [one.name for one in known.contestants]:
        raise InputError(f"there is a backend '{name}' already: take another name")
    of_family = {path.name: path for path in TEMPLATES.iterdir() if (path / f"{MINE}.py").is_file()}
    own = find_named("template for contestants of the family", of_family, family)
    words = {"FAMILY": family, "REFERENCE": known.reference, "MODEL": known.default_model, "SIZE": known.size_option}
    words |= {MINE: name, MINE.title(): "".join(part.title() for part in name.split("_"))}
    found = {}
    for path in sorted([*TEMPLATES.iterdir(), *own.iterdir()], key=lambda path: path.name):
        if path.is_file():
            text = re.sub("|".join(words), lambda match: words[match[0]], path.read_text())
            found[path.name.replace(MINE, name)] = text
    return found


def write_folder(folder: Path, files: Mapping[str, str]) -> None:
    """Write files, by name, into a folder that is made.

    Raises:
        InputError: it is there already, or cannot be made.
    """
    try:
        folder.mkdir()
        for file, text in files.items():
            (folder / file).write_text(text)
    except FileExistsError:
        raise InputError(f"{folder} is there already: take another name, or another folder with -o") from None
    except OSError as error:
        raise InputError(f"{folder} cannot be written: {error.strerror}") from None
