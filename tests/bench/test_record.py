"""Results written and read, and read as a frame; what is refused."""

import errno
from pathlib import Path

import msgspec
import pytest

from tests.bench.test_statistics import NOISE, results, samples
from tetrabench.bench import load_results, read_results, save_results
from tetrabench.bench.record import SCHEMA, Launch, Memory
from tetrabench.errors import InputError

RICH = results(
    samples("v3y", NOISE, figures={"sum": None, "count": 12.0}),
    samples("v6", [[1e-9, 0.1 + 0.2, 3.0]], digest="x"),
    samples("v4", [[1.0]], status="crash", reason="signal 11"),
    launches=[Launch(model="box", launch=0, core=1, begun="2024-01-01", seconds={"samples": 0.1})],
    memory=[Memory(model="box", backend="v3y", structure={"volume": (80, 96)}, retained_bytes=100)],
    ended="interrupted",
)


@pytest.mark.parametrize("run", [RICH, results()])
def test_round_trip(tmp_path: Path, run):
    save_results(run, tmp_path / "r.json")
    assert read_results(tmp_path / "r.json") == run
    assert [path.name for path in tmp_path.iterdir()] == ["r.json"]
    lines = (tmp_path / "r.json").read_text().splitlines()
    assert sum('{"model":"box"' in line for line in lines) == len(run.samples)  # one a line


def test_as_a_frame(tmp_path: Path):
    save_results(RICH, tmp_path / "r.json")
    frame = load_results(tmp_path / "r.json")
    wanted = "model task backend status launch round repeats cpu_s wall_s items digest structure_bytes peak_bytes"
    assert set(wanted.split()) <= set(frame.columns)
    assert list(frame.cpu_s[:24]) == list(NOISE.ravel())
    assert len(frame) == 24 + 3 + 1
    save_results(results(), tmp_path / "empty.json")
    assert list(load_results(tmp_path / "empty.json").columns) == list(frame.columns)


@pytest.mark.parametrize("text", ["", "[1, 2]", "\x00\xff", '"schema"', f'{{"schema": "{SCHEMA}"}}'])
def test_foreign_json_is_refused(tmp_path: Path, text: str):
    (tmp_path / "foreign.json").write_text(text)
    with pytest.raises(InputError, match=r"foreign\.json: no results of tetrabench"):
        load_results(tmp_path / "foreign.json")


@pytest.mark.parametrize("text", ["{}", '{"benchmarks": []}', '{"schema": null}'])
def test_json_of_another_program_is_refused(tmp_path: Path, text: str):
    (tmp_path / "foreign.json").write_text(text)
    with pytest.raises(InputError, match=r"foreign\.json: (no results of tetrabench|schema unknown)"):
        load_results(tmp_path / "foreign.json")


@pytest.mark.parametrize("share", [0.1, 0.5, 0.999])
def test_a_file_that_is_cut_off_is_refused(tmp_path: Path, share: float):
    save_results(RICH, tmp_path / "r.json")
    whole = (tmp_path / "r.json").read_bytes().rstrip()
    (tmp_path / "r.json").write_bytes(whole[: int(share * len(whole))])
    with pytest.raises(InputError, match=r"r\.json: no results of tetrabench, or cut off"):
        read_results(tmp_path / "r.json")


def test_another_versions_schema_is_refused(tmp_path: Path):
    save_results(msgspec.structs.replace(RICH, schema="tetrabench-results/99"), tmp_path / "old.json")
    with pytest.raises(InputError, match=f"schema tetrabench-results/99, this version reads {SCHEMA}"):
        read_results(tmp_path / "old.json")
    with pytest.raises(InputError, match="cannot read results: No such file"):
        read_results(tmp_path / "none.json")


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
    with pytest.raises(InputError, match=r"r\.json: cannot write: No space left on device"):
        save_results(RICH, tmp_path / "r.json")
    assert read_results(tmp_path / "r.json") == results()
    assert [path.name for path in tmp_path.iterdir()] == ["r.json"]
