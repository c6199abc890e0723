"""The verb report: what it writes where, exit codes, and no traceback."""

import builtins
from pathlib import Path

import pytest

from tests.report.made import make_results
from tests.report.page.pages import TASKS, two_runs
from tests.test_cli import refusal, say
from tetrabench.bench import save_results

ROOT = Path(__file__).parents[1]


@pytest.fixture
def files(tmp_path: Path) -> list[Path]:
    paths = []
    for name, results in two_runs():
        paths.append(tmp_path / f"{name}.json")
        save_results(results, paths[-1])
    return paths


def test_a_page_of_several_runs(files, tmp_path):
    result = say("report", *files, "-o", tmp_path / "report.html")
    assert (result.exit_code, result.stdout) == (0, "")
    assert f"wrote {tmp_path / 'report.html'}; open it in a browser" in result.stderr
    page = (tmp_path / "report.html").read_text()
    assert page.startswith("<!doctype html>")
    for name in ("first", "second"):
        assert f"<h3>{name}</h3>" in page
    assert str(tmp_path) not in page


def test_the_source_leads_where_it_is_asked_for(files, tmp_path):
    assert say("report", *files, "--thesis", "-o", tmp_path / "report.html").exit_code == 0
    page = (tmp_path / "report.html").read_text()
    assert page.index("(2011) and today") < page.index('<section id="tables"')
    assert say("report", *files, "--thesis", "-o", tmp_path / "thesis.md").exit_code == 0
    text = (tmp_path / "thesis.md").read_text()
    assert "| the source says |" in text
    assert "2011" in text


def test_what_cannot_be_written_or_read_is_refused_before_the_work(files, tmp_path):
    assert "a report is written as FILE.html or FILE.htm" in refusal("report", *files, "-o", tmp_path / "report.pdf")
    assert "FILE.html or FILE.htm or FILE.md" in refusal("report", *files, "--thesis", "-o", tmp_path / "report.pdf")
    assert "there is no folder" in refusal("report", *files, "-o", tmp_path / "none" / "report.html")
    assert "none.json: cannot read results" in refusal("report", tmp_path / "none.json", "-o", tmp_path / "a.html")
    assert "no results of tetrabench" in refusal("report", __file__, "-o", tmp_path / "a.html")
    assert "Missing argument" in refusal("report", "-o", tmp_path / "a.html")
    assert not list(tmp_path.glob("*.html"))


def test_answers_alone_are_no_report(tmp_path):
    save_results(make_results(TASKS, profile="check"), tmp_path / "check.json")
    assert "check: holds answers only" in refusal("report", tmp_path / "check.json", "-o", tmp_path / "a.html")


@pytest.mark.parametrize("missing", ["vl_convert", "jinja2"])
def test_without_the_extra_it_says_what_to_install(files, tmp_path, monkeypatch, missing):
    honest = builtins.__import__

    def broken(name, *more):
        if name == missing:
            raise ImportError(name)
        return honest(name, *more)

    monkeypatch.setattr(builtins, "__import__", broken)
    assert "pip install 'tetrabench[report]'" in refusal("report", *files, "-o", tmp_path / "a.html")
    assert not (tmp_path / "a.html").exists()


def test_what_was_there_stays_where_the_work_fails(files, tmp_path, monkeypatch):
    (tmp_path / "report.html").write_text("old")
    monkeypatch.setattr("tetrabench.report.page.make_page", lambda *_, **__: 1 / 0)
    assert say("report", *files, "-o", tmp_path / "report.html").exit_code != 0
    assert (tmp_path / "report.html").read_text() == "old"
