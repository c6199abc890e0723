"""Results of a later version that are read, and a write that fails. (What else there is to say is in test_results_files.)"""

import errno
from pathlib import Path

import pytest

from tests.bench.test_statistics import NOISE, results, samples
from tetrabench.bench import read_results, save_results
from tetrabench.errors import InputError

RICH = results(samples("v3y", NOISE, figures={"sum": None}), samples("v4", [[1.0]], status="crash", reason="signal 11"))


def test_a_field_that_a_later_version_has_added_is_left_out(tmp_path: Path):
    save_results(RICH, tmp_path / "r.json")
    text = (tmp_path / "r.json").read_text()
    (tmp_path / "r.json").write_text(text.replace('"profile"', '"colour": {"a": [1]}, "profile"', 1))
    assert read_results(tmp_path / "r.json") == RICH


def test_a_write_that_fails_leaves_the_file_that_was_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    save_results(results(), tmp_path / "r.json")

    def full(path, data):
        with open(path, "wb") as file:
            file.write(data[:100])
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(Path, "write_bytes", full)
    with pytest.raises(InputError, match=r"r\.json: cannot be written: No space left on device"):
        save_results(RICH, tmp_path / "r.json")
    assert read_results(tmp_path / "r.json") == results()
    assert [path.name for path in tmp_path.iterdir()] == ["r.json"]
