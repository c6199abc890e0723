"""Archives of arrays, numpy's .npz, from anybody: no object in them is made, none is unpacked that memory has no room for."""

import zipfile
from pathlib import Path
from typing import IO, Any

import numpy as np

from tetrabench.memory import refuse_if_too_large

ROOM = 3
"""Bytes of memory for each byte that is unpacked: the array, and what is made of it."""


def open_archive(path: Path, file: IO[bytes]) -> Any:
    """The archive in an open file, as np.load gives it.

    Raises:
        MemoryRefusedError: unpacked it is more than there is memory for: a few kilobytes can hold gigabytes.
        Exception: whatever numpy and zipfile say of what is no archive.
    """
    with zipfile.ZipFile(file) as listed:
        unpacked = sum(member.file_size for member in listed.infolist())
    refuse_if_too_large(f"reading {path}", ROOM * unpacked)
    file.seek(0)
    return np.load(file, allow_pickle=False)
