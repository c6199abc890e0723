"""Archives of strangers: a few kilobytes that hold gigabytes are refused by what they say, before any is unpacked."""

import zipfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from tetrabench.collision.start.files import read_objects
from tetrabench.errors import InputError, MemoryRefusedError
from tetrabench.mesh.polygon.store import load_polygons

READERS = pytest.mark.parametrize("reader", [load_polygons, read_objects])


@READERS
def test_a_bomb_is_refused_before_it_is_unpacked(reader: Callable, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = tmp_path / "bomb.npz"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("points.npy", bytes(2_000_000))
    assert path.stat().st_size < 10_000
    monkeypatch.setattr("tetrabench.memory.available_bytes", lambda: 5_000_000)
    monkeypatch.setattr("numpy.load", lambda *_, **__: pytest.fail("unpacked"))
    with pytest.raises(MemoryRefusedError, match=r"reading .*bomb\.npz needs about 5\.7 MiB"):
        reader(path)


@READERS
@pytest.mark.parametrize(
    "shape", [(10**15,), (2**62, 4), (-1,), (10**4300,)], ids=["TB", "overflow", "below 0", "digits"]
)
def test_an_array_that_claims_to_be_huge_is_damaged(reader: Callable, shape: tuple[int, ...], tmp_path: Path):
    names = ("points", "starts", "nodes", "conditions", "report", "x", "y", "vx", "vy", "r", "m", "box", "source")
    head = f"{{'descr': '<f8', 'fortran_order': False, 'shape': {shape if len(shape) > 1 else f'({_digits(shape[0])},)'}}}\n"
    text = np.lib.format.magic(1, 0) + len(head).to_bytes(2, "little") + head.encode()
    with zipfile.ZipFile(tmp_path / "huge.npz", "w") as archive:
        for name in names:
            archive.writestr(f"{name}.npy", text)
    with pytest.raises(InputError, match=r"huge\.npz: .*damaged"):
        reader(tmp_path / "huge.npz")


def _digits(number: int) -> str:
    """Also of numbers that Python is loath to write."""
    return str(number) if number < 10**4000 else "9" * 4301


@READERS
@pytest.mark.parametrize("text", [b"", b"no array", b"\x93NUMPY", b"\x93NUMPX" + bytes(100)])
def test_a_member_that_is_no_array_is_damaged(reader: Callable, text: bytes, tmp_path: Path):
    """Found by fuzzing: numpy gives its bytes."""
    names = ("points", "starts", "nodes", "conditions", "x", "y", "vx", "vy", "r", "m")
    with zipfile.ZipFile(tmp_path / "made.npz", "w") as archive:
        for name in names:
            archive.writestr(f"{name}.npy", text)
    with zipfile.ZipFile(tmp_path / "made.npz", "a") as archive:
        for name, array in {
            "report": np.frombuffer(b"{}", np.uint8),
            "box": np.ones(2),
            "source": np.ones(2, np.uint8),
        }.items():
            with archive.open(f"{name}.npy", "w") as file:
                np.lib.format.write_array(file, array)
    with pytest.raises(InputError, match=r"made\.npz: .*(damaged|a list of numbers is needed)"):
        reader(tmp_path / "made.npz")
