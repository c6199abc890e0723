"""Files are written whole, or what was there before stays."""

from pathlib import Path

import pytest

from tetrabench.drafts import drafted
from tetrabench.errors import InputError


def contents(folder: Path) -> dict[str, str]:
    return {file.name: file.read_text() for file in folder.iterdir()}


@pytest.fixture
def target(tmp_path: Path) -> Path:
    (tmp_path / "a.txt").write_text("before")
    return tmp_path / "a.txt"


def test_a_file_takes_its_place_when_it_is_complete(target: Path) -> None:
    with drafted(target) as draft:
        draft.write_text("after")
        assert draft.name == target.name
        assert draft.parent.parent == target.parent  # one file system: to move it there is one step
        assert target.read_text() == "before"
    assert contents(target.parent) == {"a.txt": "after"}


@pytest.mark.parametrize("error", [OSError(28, "No space left on device"), ValueError("odd"), KeyboardInterrupt()])
def test_what_breaks_off_leaves_what_was_there(target: Path, error: BaseException) -> None:
    told = InputError if isinstance(error, OSError) else type(error)

    def break_off() -> None:
        with drafted(target) as draft:
            draft.write_text("half")
            raise error

    with pytest.raises(told) as raised:
        break_off()
    assert contents(target.parent) == {"a.txt": "before"}
    if told is InputError:
        assert str(raised.value) == f"{target}: cannot be written: No space left on device"


def test_of_two_files_the_one_that_was_named_comes_last(target: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    moved = []
    usual = Path.replace
    monkeypatch.setattr(Path, "replace", lambda file, place: (moved.append(place), usual(file, place)))
    with drafted(target) as draft:
        for name in ("a.txt", "b.txt", "0.txt"):
            (draft.parent / name).write_text(name)
    assert moved[-1] == target
    assert contents(target.parent) == {name: name for name in ("a.txt", "b.txt", "0.txt")}


@pytest.mark.parametrize(
    ("name", "reason"),
    [("none/a", "No such file or directory"), ("a.txt/a", "Not a directory"), ("x" * 300, "File name too long")],
)
def test_places_where_nothing_can_be_written(target: Path, name: str, reason: str) -> None:
    with pytest.raises(InputError, match=f"cannot be written: {reason}$"), drafted(target.parent / name) as draft:
        draft.write_text("after")
    assert contents(target.parent) == {"a.txt": "before"}
