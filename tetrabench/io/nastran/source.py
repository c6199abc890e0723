"""The files of a deck, each read through a window that moves on: no more of it is in memory than is looked at."""

import codecs
from bisect import bisect_right
from collections.abc import Iterator
from functools import cached_property
from pathlib import Path
from typing import Self

import numpy as np

from tetrabench.errors import InputError
from tetrabench.io.nastran.cards import NEWLINE, Bytes

WINDOW = 2**20  # bytes: what fits into the processor's cache


class Source:
    """A file of the deck.

    Attributes:
        path: the file.
        base: the place of its first byte: see `Sources`.
        size: its bytes, without a byte order mark.
    """

    def __init__(self, path: Path, base: int) -> None:
        """Raises InputError for a file that cannot be read, or is empty."""
        self.path = path
        self.base = base
        try:
            with path.open("rb") as file:
                self.start = len(codecs.BOM_UTF8) if file.read(3) == codecs.BOM_UTF8 else 0
            self.size = path.stat().st_size - self.start
        except OSError as error:
            raise self.unreadable(error) from error
        if not self.size:
            raise InputError(f"{path}: is empty")

    @cached_property
    def text(self) -> Bytes:
        """The whole file, for what is rare: messages, includes, scattered continuations."""
        try:
            return np.fromfile(self.path, np.uint8)[self.start :]
        except OSError as error:
            raise self.unreadable(error) from error

    def window(self) -> "Window":
        """The file from its first byte on."""
        return Window(self, WINDOW)

    def line_of(self, byte: int) -> int:
        """The number of the line that a byte lies in, from 1."""
        return count_newlines(self.text[:byte]) + 1

    def unreadable(self, error: OSError) -> InputError:
        """The error of the system as one for a person."""
        return InputError(f"{self.path}: cannot be read: {error.strerror or error}")


class Window:
    """A part of a file, in a buffer that is used again and again.

    Attributes:
        text: the bytes, (n,) uint8.
        base: the place of the first one in the deck.
        whole: whether the file ends with the last one.
    """

    def __init__(self, source: Source, size: int) -> None:
        """The file is open until the end of the `with` that the window stands in."""
        self._source = source
        self._buffer = np.empty(min(size, source.size + 1), np.uint8)
        self._file = source.path.open("rb", buffering=0)
        self.seek(0)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self._file.close()

    def seek(self, byte: int) -> None:
        """Go to a byte of the file."""
        self._file.seek(self._source.start + byte)
        self.base = self._source.base + byte
        self._fill(0)

    def move(self, position: int) -> None:
        """Go on: what stands at `position` comes to the beginning. Where that is there already, see more at once."""
        if position == 0:
            self._buffer = np.resize(self._buffer, 2 * len(self._buffer))
        kept = len(self.text) - position
        self._buffer[:kept] = self.text[position:].copy()
        self.base += position
        self._fill(kept)

    def _fill(self, kept: int) -> None:
        """Read on behind what is kept, until the buffer is full or the file ends."""
        filled, read = kept, -1
        try:
            while read and filled < len(self._buffer):
                read = self._file.readinto(self._buffer[filled:].data)
                filled += read
        except OSError as error:
            raise self._source.unreadable(error) from error
        self.whole = read == 0
        self.text: Bytes = self._buffer[:filled]


class Sources:
    """The files of a deck, in the order in which they were begun. A place is a byte of all of them, one after the other."""

    def __init__(self) -> None:
        self._sources: list[Source] = []

    def __len__(self) -> int:
        return len(self._sources)

    def __iter__(self) -> Iterator[Source]:
        return iter(self._sources)

    def add(self, path: Path) -> Source:
        """The next file. Raises InputError as `Source` does."""
        last = self._sources[-1] if self._sources else None
        source = Source(path, base=last.base + last.size + 1 if last else 0)
        self._sources.append(source)
        return source

    def at(self, place: int) -> Source:
        """The file that a place lies in."""
        return self._sources[bisect_right(self._sources, place, key=lambda source: source.base) - 1]

    def words(self, begin: int, end: int) -> str:
        """The text between two places of one file."""
        source = self.at(begin)
        return source.text[begin - source.base : end - source.base].tobytes().decode("latin-1")

    def where(self, place: int) -> str:
        """The file and the line of a place."""
        source = self.at(place)
        return f"{source.path}:{source.line_of(place - source.base)}"

    def refusal(self, place: int, reason: str) -> InputError:
        """An error that names file and line."""
        return InputError(f"{self.where(place)}: {reason}")


def count_newlines(text: Bytes) -> int:
    """Count the newlines, a megabyte at a time: what fits into the processor's cache."""
    return sum(int(np.count_nonzero(text[i : i + 2**20] == NEWLINE)) for i in range(0, text.size, 2**20))
