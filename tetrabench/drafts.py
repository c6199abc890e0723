"""A file is written whole, or what was there before stays."""

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from tetrabench.errors import InputError


@contextmanager
def drafted(path: str | os.PathLike[str]) -> Iterator[Path]:
    """Let a file be written somewhere else, and give it its place when it is complete.

    Yields:
        Where to write it: under its own name, in a folder of its own beside its place, for some formats are two files, one
        with the other's name in it. What else is written there moves, too, and before it.

    Raises:
        InputError: it cannot be written: any OSError on the way.
    """
    target = Path(path)
    place = target.absolute().parent
    try:
        with tempfile.TemporaryDirectory(dir=place, prefix=".writing-") as folder:
            yield Path(folder) / target.name
            for file in sorted(Path(folder).iterdir(), key=lambda file: file.name == target.name):
                file.replace(place / file.name)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from error
