"""The page as text: complete, self-contained, its numbers exact, everything from results escaped."""

import gzip
import html
import json
import re
from base64 import b64decode
from html.parser import HTMLParser

import msgspec
import pytest

from tests.report.made import make_results
from tests.report.page.pages import EVIL, HOSTILE, TASKS, hostile, sweep, two_runs
from tetrabench.bench import summary
from tetrabench.report.page import figures, make_page
from tetrabench.report.page.subjects import make_runs, make_subjects

pytest.importorskip("vl_convert")


def figures_of(text: str) -> dict:
    """The numbers that script.js unpacks."""
    return json.loads(gzip.decompress(b64decode(re.search(r'id="figures">(.*?)</script>', text)[1])))


class Page(HTMLParser):
    """What stands in a page: its tags, its text outside scripts, and the lines of its tables."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict]] = []
        self.texts: list[str] = []
        self.lines: list[tuple[str, dict, list[str]]] = []  # caption, attributes, values of <data>
        self.within: list[str] = []
        self.caption = ""
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attributes):
        facts = dict(attributes)
        self.tags.append((tag, facts))
        if tag not in ("meta", "link", "input", "br", "img"):
            self.within.append(tag)
        if tag == "caption":
            self.caption = ""
        if tag == "tr":
            self.lines.append((self.caption, facts, []))
        if tag == "data":
            self.lines[-1][2].append(facts["value"])

    def handle_endtag(self, tag):
        while self.within and self.within.pop() != tag:
            pass

    def handle_data(self, data):
        if self.within and self.within[-1] == "caption":
            self.caption += data
        if not {"script", "style"} & set(self.within):
            self.texts.append(data)


@pytest.fixture(scope="module")
def text():
    return make_page(two_runs())


def test_it_is_one_file_that_asks_for_nothing(text):
    page = Page(text)
    assert not [tag for tag, facts in page.tags if tag in ("link", "iframe", "img", "object")]
    assert not [facts for tag, facts in page.tags if "src" in facts or facts.get("href", "#")[0] != "#"]
    policy = next(facts["content"] for tag, facts in page.tags if facts.get("http-equiv") == "Content-Security-Policy")
    assert "default-src 'none'" in policy
    assert "http" not in policy


def test_the_numbers_are_those_of_the_results(text):
    """Each table of times: seconds of one run, time of an item, ratio: the value behind each is exact."""
    page = Page(text)
    lines = {
        (caption.split(":")[0], facts["data-backend"], facts["data-model"]): values
        for caption, facts, values in page.lines
        if caption.endswith(": the numbers") and "data-backend" in facts
    }
    rows = [row for _, results in two_runs() for row in summary(results) if not row.control]
    assert len(lines) == len(rows) == 2 * 3 * 4
    for row in rows:
        is_shown = row.ratio is not None and row.verdict != "too short"
        ratio = 1.0 if row.verdict == "reference" else row.ratio if is_shown else None
        known = [one for one in (row.seconds, row.ns_per_item, ratio) if one is not None]
        assert [float(one) for one in lines[row.task, row.backend, row.model]] == known


def test_the_drawn_numbers_are_those_of_the_results(text):
    figures = figures_of(text)
    columns = figures["times-alfa"]["columns"]
    drawn = {
        key: value
        for *names, value in zip(columns["model"], columns["backend"], columns["base"], columns["value"], strict=True)
        for key in [tuple(names)]
    }
    rows = [row for _, results in two_runs() for row in summary(results) if row.task == "alfa" and row.ratio]
    assert rows
    for row in rows:
        if not row.control:
            assert drawn[row.model, row.backend, "v3y"] == pytest.approx(row.ratio, rel=1e-5)


def test_every_chart_has_a_picture_words_and_a_table(text):
    charts = re.findall(
        r'<div class="chart" role="img" aria-label="([^"]+)" data-words="[^"]+" data-figure="([^"]+)">(.*?)</div>',
        text,
        re.DOTALL,
    )
    figures = figures_of(text)
    assert sorted(name for _, name, _ in charts) == sorted(figures)
    assert {figures[name]["kind"] for name in figures} == {"times", "samples", "trade", "fields", "limits"}
    for words, name, svg in charts:
        assert len(words) > 30, name
        assert svg.startswith("<svg")
        assert re.search(r"mark-(symbol|line|rect)", svg), name
    assert (
        text.count("<figure")
        == len(charts)
        == len(re.findall(r"</div>\s*\n?<div class=\"scroll\"[^>]*>\s*<table>", text))
    )


def test_pictures_say_what_tables_say(text):
    """Shortening them may touch lengths of lines, never words and figures."""
    drawn = figures.times(make_subjects(make_runs(two_runs())), ["v3y"])
    for task, rows in drawn.items():
        svg = re.search(f'data-figure="times-{task}">(.*?)</div>', text, re.DOTALL)[1]
        words = {re.sub("<[^>]+>", "", one) for one in re.findall(r"<text[^>]*>(.*?)</text>", svg)}
        told = {row["text"] or row["word"] for row in rows} - {"1"}
        assert {html.escape(one) for one in told} <= words


def test_growth_is_there_where_there_are_sizes():
    assert 'id="growth"' in make_page(sweep())
    assert 'id="growth"' not in make_page(two_runs())


def test_what_comes_from_results_stays_text():
    page = Page(make_page(hostile()))
    assert sum(tag == "script" for tag, _ in page.tags) == 3  # the numbers, what draws, ours
    assert not any(tag == "img" for tag, _ in page.tags)
    said = "".join(page.texts)
    assert HOSTILE in said
    assert EVIL in said
    assert not [facts for _, facts in page.tags if any(name.startswith("on") for name in facts)]


def test_wrong_answers_are_called_wrong_at_the_top():
    results = make_results(TASKS)
    results.samples[:] = [
        msgspec.structs.replace(one, status="wrong-result") if (one.task, one.backend) == ("alfa", "v4") else one
        for one in results.samples
    ]
    top = "".join(Page(make_page([("run", results)])).texts).partition("What was measured")[0]
    assert "Wrong answers." in top
    assert "v4 in alfa on nozzle: wrong" in " ".join(top.split())


def measured(runs) -> list[str]:
    """The lines of "What was measured", as they are read."""
    part = re.search(r'<section id="measured">(.*?)<details>', make_page(runs), re.DOTALL)[1]
    return [" ".join(html.unescape(re.sub("<[^>]+>", "", line)).split()) for line in re.findall(r"<li.*?</li>", part)]


def test_what_was_measured_is_what_the_run_says():
    """Sizes, digests, the counts of each task, how often, and whether that is all."""
    results = make_results(TASKS, launches=7, rounds=2, profile="rigorous")
    options = {"init": {}, "alfa": {"sweeps": 200}, "free": {"deletions": 20_000, "per_launch": 3}}
    results.tasks[:] = [msgspec.structs.replace(one, options=options[one.name]) for one in results.tasks]
    lines = [
        f"nozzle: 642,720 tetras, 112,339 points, digest {642_720:016x}",
        "init, alfa (200 sweeps), free (20,000 deletions, 3 per launch)",
        "7 launches of 2 rounds at most; profile rigorous",
    ]
    assert measured([("run", results)]) == lines
    for ended in ("budget", "interrupted"):
        told = f"Ended early ({ended}): samples are missing."
        assert measured([("run", msgspec.structs.replace(results, ended=ended))]) == [*lines, told]


def test_a_section_of_answers_has_each_digest(text):
    digests = {one.digest for _, results in two_runs() for one in results.samples if one.status == "ok"}
    assert len(digests) == len(TASKS)
    shown = text.partition('<section id="answers">')[2]
    assert {digest for digest in digests if shown.count(f"<td>{digest}</td>") == 2} == digests  # a line on each model


def test_what_to_use_comes_first_where_the_run_has_what_the_work_needs(text):
    assert 'id="advice"' not in text
    tasks = ("init", "alfa", "flow", "delete", "explode", "locate", "select")
    results = make_results({task: {"v3y": 1.0, "v4": 2.0} for task in tasks})
    counts = {"delete": {"deletions": 20_000}, "explode": {"splits": 50_000}}
    results.tasks[:] = [msgspec.structs.replace(one, options=counts.get(one.name, {})) for one in results.tasks]
    page = make_page([("run", results)])
    assert page.index('<section id="advice">') < page.index('<section id="measured">')
    assert '<th scope="row">simulation</th><td>use v3y</td><td>v4 2.00x</td>' in page
    several = [msgspec.structs.replace(one, against=one.name) for one in results.backends if not one.control]
    assert 'id="advice"' not in make_page([("gate", msgspec.structs.replace(results, backends=several))])


def test_sections_of_others_lead(text):
    page = make_page(two_runs(), extra=[("Which & why", "<p class='holds'>so</p>")])
    assert "<h2>Which &amp; why</h2>" in page
    assert "<p class='holds'>so</p>" in page
    assert page.index("Which &amp; why</h2>") < page.index('id="tables"')


def test_a_full_report_is_small():
    """The default effort on four models with all of the source's scenarios and contestants: under 3 MB."""
    runs = [
        (name, make_results(launches=8, rounds=3, model=name))
        for name in ("nozzle", "nozzle shuffled", "intake", "pipe")
    ]
    twelve = []
    for name, results in runs:
        again = [msgspec.structs.replace(one, task=f"{one.task} too") for one in results.samples]
        tasks = [msgspec.structs.replace(one, name=f"{one.name} too") for one in results.tasks]
        results.samples.extend(again)
        results.tasks.extend(tasks)
        twelve.append((name, results))
    assert len(make_page(twelve).encode()) < 3e6
