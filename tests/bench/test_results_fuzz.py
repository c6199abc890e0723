"""Damaged results, and results of strangers: refused in one line, or shown without an exception and without harm."""

import copy
import csv
import io
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import pytest
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

from tests.report.made import change, make_results
from tests.test_cli import refusal, say
from tetrabench.bench import load_results, load_summary, read_results, save_results
from tetrabench.bench.history import add, read_history
from tetrabench.bench.journal import Journal, read_journal
from tetrabench.bench.record import Results
from tetrabench.errors import InputError, TetrabenchError
from tetrabench.printable import printable
from tetrabench.report.formats import FORMATS
from tetrabench.report.table import as_text

TWO = {"alfa sweeps=10": {"v3y": 1.0, "v4": 2.0}, "flow": {"v3y": 0.5, "v4": 0.25}}
SOUND = change(
    make_results(TWO, launches=2, rounds=1),
    *("flow", "v4"),
    figures={"sum": 1.0},
    series={"step": [1.0, 2.0], "step_s": [0.5, 0.25]},
)
FACTS = msgspec.to_builtins(SOUND)
NUMBERS = [-1, 0, 1, 2**31, 2**63, 2**64, 10**30, 0.5, -0.5, 1e308, 5e-324, 1e-300]
WORDS = ["", "x", "../../x", "<script>", "a|b", "\x1b[31m", "\u202e", "a\nb", "2011", "v4", "$x^{$", "=1+1", "-->"]
ODD = [None, True, [], {}, [[]], {"a": 1}, [None], *NUMBERS, *WORDS]
FUZZ = settings(deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)


def places(value: Any, at: tuple = ()) -> Iterator[tuple]:
    """Where there is a value in JSON."""
    for key, inner in value.items() if isinstance(value, dict) else enumerate(value):
        yield (*at, key)
        if isinstance(inner, dict | list):
            yield from places(inner, (*at, key))


PLACES = list(places(FACTS))
CHANGES = st.lists(st.tuples(st.sampled_from(PLACES), st.sampled_from(["drop", *ODD])), min_size=1, max_size=3)


def changed(changes: list[tuple[tuple, Any]]) -> dict:
    """The sound facts after some changes; one at a place that is no more does nothing."""
    facts = copy.deepcopy(FACTS)
    for place, value in changes:
        inner = facts
        try:
            for step in place[:-1]:
                inner = inner[step]
            inner[place[-1]] = copy.deepcopy(value)
            if value == "drop":
                del inner[place[-1]]
        except (KeyError, IndexError, TypeError):
            pass
    return facts


def is_one_line(error: Exception, path: Path | None = None) -> None:
    """Fail where a refusal is no line that a terminal can show, or does not name the file."""
    assert printable(str(error)) == str(error)
    assert path is None or str(path) in str(error)


def check_refusal(error: Exception, path: Path | str = "") -> None:
    """One line that names the file, without a sign that moves the cursor."""
    assert str(path) in str(error)
    assert printable(str(error)) == str(error)


def judge(path: Path) -> bool:
    """Whether a file is read; fails where it is neither shown in all forms nor refused in one line that names it."""
    try:
        results = read_results(path)
    except InputError as error:
        is_one_line(error, path)
        return False
    for show in (*FORMATS.values(), lambda run: as_text(run, intervals=True), lambda _: load_results(path)):
        try:
            show(results)
        except TetrabenchError as error:  # no cell ended well, say
            is_one_line(error)
    load_summary(path)
    return True


@FUZZ
@given(changes=CHANGES)
@example(changes=[(("samples", 2, "items"), 10**30)])  # once pandas: OverflowError
@example(changes=[(("samples", 2, "structure_bytes"), 2**63)])  # once pandas: TypeError
@example(changes=[(("samples", 6, "items"), -1)])  # once KeyError below the table
@example(changes=[(("launches", 1, "begun"), "x")])  # once ValueError as pyperf
@example(changes=[(("launches", 1, "begun"), "")])
@example(changes=[(("samples", 0, "repeats"), 0)])
@example(changes=[(("backends", 0, "against"), "x")])
def test_changed_results_are_refused_or_shown(changes: list, tmp_path: Path):
    path = tmp_path / "made.json"
    path.write_text(json.dumps(changed(changes)))
    judge(path)


def test_the_sound_ones_are_shown(tmp_path: Path):
    save_results(SOUND, tmp_path / "made.json")
    assert judge(tmp_path / "made.json")


@pytest.mark.parametrize(
    ("place", "value", "reason"),
    [
        (("samples", 2, "items"), 10**30, r"samples\[2\].items"),
        (("samples", 2, "round"), -1, r"samples\[2\].round"),
        (("samples", 2, "cpu_s"), 1e308, r"samples\[2\].cpu_s"),
        (("samples", 2, "repeats"), 0, r"samples\[2\].repeats"),
        (("samples", 2, "task"), "x", r"samples\[2\].task: there is no task 'x'"),
        (("backends", 1, "name"), "v3y", "backends: 'v3y' is there twice"),
        (("backends", 1, "against"), "x", "no backend 'x'"),
        (("launches", 1, "begun"), "x", r"launches\[1\].begun: 'x' is no date"),
        (("environment", "a"), [[[[[[[[1]]]]]]]], "without end"),
    ],
)
def test_what_does_not_hang_together_is_named(place: tuple, value: object, reason: str, tmp_path: Path):
    path = tmp_path / "made.json"
    path.write_text(json.dumps(changed([(place, value)])))
    with pytest.raises(InputError, match=rf"made\.json: these results do not hang together: .*{reason}"):
        read_results(path)


@FUZZ
@given(cut=st.integers(0, 5000), junk=st.binary(max_size=4))
def test_bytes_that_are_wrong_are_refused_or_shown(cut: int, junk: bytes, tmp_path: Path):
    path = tmp_path / "made.json"
    save_results(SOUND, path)
    whole = path.read_bytes()
    path.write_bytes(whole[:cut] + junk + whole[cut + len(junk) :] if junk else whole[:cut])
    judge(path)


@pytest.mark.parametrize(
    "text",
    [
        b'{"schema": "tetrabench-results/1", "environment": ' + b"[" * 100_000,
        b"[" * 1_000_000,
        b'{"schema": "tetrabench-results/1", "x": ' + b'{"a":' * 100_000 + b"1" + b"}" * 100_001,
        b'{"schema": "a\\nb\\u001b[31m"}',
        b'{"schema": "\xff"}',
        b'{"\\ud800": 1, "schema": 1}',
        b'{"schema": "tetrabench-results/1", "seed": ' + b"9" * 100_000 + b"}",
        b'{"schema": "tetrabench-results/1", "schema": "x"}',
    ],
    ids=["cut deep", "deep", "whole and deep", "lines", "no text", "half a sign", "long", "twice"],
)
@pytest.mark.parametrize("verb", ["show", "recommend", "history add"])
def test_no_verb_is_hurt(text: bytes, verb: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    Path("made.json").write_bytes(text)
    assert "made.json: " in refusal(*verb.split(), "made.json")


# ---------------------------------------------------------------------- journals and histories


@pytest.fixture(scope="module")
def journal() -> bytes:
    """That of the sound run."""
    file = io.BytesIO()
    run = msgspec.structs.replace(SOUND, samples=[], launches=[], memory=[])
    written = Journal(msgspec.convert(msgspec.to_builtins(run), Results), file)  # type: ignore[arg-type]
    written.begin()
    for part in (*SOUND.backends, *SOUND.memory, *SOUND.samples):
        written.write(part)
    return file.getvalue()


@FUZZ
@given(
    line=st.integers(0, 20), place=st.integers(0, 400), junk=st.sampled_from([b"", b"-1", b"1e999", b'"x"', b"\xff"])
)
@example(line=1, place=len(b'{"backend":{"name":"v'), junk=b"x")  # once ValueError: no such backend
def test_a_damaged_journal_is_refused_or_read(line: int, place: int, junk: bytes, journal: bytes, tmp_path: Path):
    lines = journal.split(b"\n")
    at = min(line, len(lines) - 1)
    lines[at] = lines[at][:place] + junk + lines[at][place + 1 :]
    path = tmp_path / "made.jsonl"
    path.write_bytes(b"\n".join(lines))
    try:
        run, size = read_journal(path)
    except InputError as error:
        is_one_line(error, path)
    else:
        assert 0 < size <= path.stat().st_size
        as_text(run)


@FUZZ
@given(
    place=st.integers(0, 2000), junk=st.sampled_from([b"", b"-", b"1e999", b"e300", b'"x"', b"\xff", b"\n", b"null"])
)
def test_a_damaged_history_is_refused_or_drawn(place: int, junk: bytes, tmp_path: Path):
    path = tmp_path / "made.jsonl"
    path.unlink(missing_ok=True)
    add(SOUND, path)
    whole = path.read_bytes()
    path.write_bytes(whole[:place] + junk + whole[place + 1 :])
    try:
        read_history(path)
    except InputError as error:
        is_one_line(error, path)


# ---------------------------------------------------------------------- names that do harm


EVIL = "</script><img src=x onerror=alert(1)>|[a](b)\x1b[2J\u202e\n::error::$x^{$ -->"


def evil_run() -> Results:
    """A sound run whose names, titles and notes would all like to be more than words."""
    names = {"nozzle": EVIL, "v4": f"=v4{EVIL}", "flow": f"flow {EVIL}"}

    def renamed(value: Any) -> Any:
        if isinstance(value, dict):
            return {key: renamed(one) for key, one in value.items()}
        if isinstance(value, list):
            return [renamed(one) for one in value]
        return names.get(value, value) if isinstance(value, str) else value

    facts = renamed(msgspec.to_builtins(SOUND))
    facts["models"][0]["notes"] = [EVIL]
    facts["command"], facts["environment"]["processor"], facts["backends"][1]["title"] = EVIL, EVIL, EVIL
    facts["samples"][-1] |= {"status": "crash", "reason": EVIL, "cpu_s": None}
    return msgspec.convert(facts, Results)


def test_names_stay_words_in_every_form(tmp_path: Path):
    run = evil_run()
    for name in ("table", "md", "github"):
        text = FORMATS[name](run)
        assert "script" in text
        assert not re.search(r"[\x00-\x09\x0b-\x1f\u202e]", text), name
        assert not re.search(r"(?m)^\s*::", text.partition("\n<!--\n")[0]), name
    for name in ("md", "github"):
        tables, _, comment = FORMATS[name](run).partition("\n<!--\n")
        assert not re.search(r"(?<!\\)[<\[]", tables), name
        heads = [re.sub(r"\\\|", "", line) for line in tables.splitlines() if line.startswith("|")]
        assert len({line.count("|") for line in heads}) <= 2, "a name has made a cell of its own"
        assert comment.count("-->") <= 1
    rows = list(csv.reader(io.StringIO(FORMATS["csv"](run))))
    assert not any(field.startswith("=") for row in rows for field in row)
    assert any(field.startswith("'=v4") for row in rows for field in row)


def test_names_stay_words_on_the_page(tmp_path: Path):
    """Once a hang: what draws the charts ends its thread at a control character."""
    save_results(evil_run(), tmp_path / "evil.json")
    result = say("report", tmp_path / "evil.json", "-o", tmp_path / "evil.html")
    assert result.exit_code == 0, result.stderr
    page = (tmp_path / "evil.html").read_text()
    assert "&lt;img src=x" in page
    assert "<img" not in page
    assert page.count("</script>") == page.count("<script")


def test_charts_lie_in_their_folder_whatever_a_model_is_called(tmp_path: Path):
    from tetrabench.report.chart import draw_charts

    model = msgspec.structs.replace(SOUND.models[0], name="../../x\x00/$x^{$")
    samples = [msgspec.structs.replace(one, model=model.name) for one in SOUND.samples]
    run = msgspec.structs.replace(SOUND, models=[model], samples=samples)
    paths = draw_charts(run, tmp_path / "charts")
    assert paths
    assert {path.resolve().parent for path in paths} == {(tmp_path / "charts").resolve()}
    assert [path.name for path in tmp_path.iterdir()] == ["charts"]


@given(text=st.text())
def test_printable_words_are_one_line_that_says_the_same(text: str):
    spelled = printable(text)
    assert len(spelled.splitlines()) <= 1
    assert printable(spelled) == spelled
    if text.isprintable():
        assert spelled == text
