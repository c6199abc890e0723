"""The source's tables beside today's: a run made from what the polygon source printed must give the same tables again."""

import msgspec
import pytest

from tests.report.made import change, make_backend, make_launch, make_memory, make_results, make_sample, slow
from tetrabench.bench.record import Task
from tetrabench.report.thesis.comparison import Comparison, compare_with_source
from tetrabench.report.thesis.figures import draw_figures
from tetrabench.report.thesis.page import as_html, as_markdown, make_section
from tetrabench.sources.polygon import MESHES, NODE_TASKS, SOURCE, VALUES

OURS = "tables"
LAUNCHES = 8


def run_of(model="quad", *, launches=LAUNCHES, name=""):
    """A run in which all took as long, and as much, as in the source; ours half as long as by-edge."""
    seconds = {task: dict(times) for task, times in {**SOURCE.times[model], **SOURCE.spoken[model]}.items()}
    for times in seconds.values():
        if "by-edge" in times:
            times[OURS] = times["by-edge"] / 2
    name = name or model
    backends = [make_backend(one, title=title, against="by-edge") for one, title in SOURCE.contestants.items()]
    backends.append(make_backend(OURS, title="all four lists", against="by-edge", extension=True))
    samples = [
        make_sample(task, one, launch, 0, spent, model=name, items=_items(model, task), unit="lists")
        for task, times in seconds.items()
        for launch in range(launches)
        for one, spent in times.items()
    ]
    facts = make_results({"cell-nodes": {"by-edge": 1.0}}, launches=launches, model=name)
    counts = {task: {"queries": 1_000_000} if task.startswith("random") else {} for task in seconds}
    return msgspec.structs.replace(
        facts,
        family="polygon",
        models=[msgspec.structs.replace(facts.models[0], size=MESHES[model])],
        tasks=[Task(name=task, scenario=task, options=options) for task, options in counts.items()],
        backends=backends,
        reference="by-edge",
        titles=list(SOURCE.contestants.values()),
        launches=[make_launch(launch, model=name) for launch in range(launches)],
        memory=[
            make_memory(one, model=name, structure={"all": (size, size)})
            for one, values in VALUES.get(model, {}).items()
            for size in [round(4 * values * MESHES[model]["cells"])]
        ],
        samples=samples,
    )


def _items(model, task):
    if task.startswith("random"):
        return 1_000_000
    return MESHES[model]["nodes" if task in NODE_TASKS or task.startswith("gas-node") else "cells"]


def tables_of(*runs):
    """By name; rows by their words."""
    tables = compare_with_source(runs, SOURCE).tables
    return {table.name: {tuple(row.words): row for row in table.rows} for table in tables}


@pytest.fixture(scope="module")
def quad():
    return run_of()


@pytest.mark.parametrize("model", list(MESHES))
def test_the_source_gives_its_own_tables_again(model):
    tables = tables_of(run_of(model))
    assert list(tables) == ["table 1", "table 2", "table 3", "table 4", "table 6", "table 7"]
    compared = 0
    for rows in tables.values():
        for row in rows.values():
            then = row.then.get(model, "").split(" ")[0].replace(",", "")
            if then:
                assert float(row.today[model].replace(",", "")) == pytest.approx(float(then), rel=0.006), row.words
                compared += 1
    assert compared == 3 + 5 * (model != "voronoi") + 20 + 20 + 1 + 1


def test_ours_stand_behind_and_are_marked(quad):
    rows = tables_of(quad)["table 3"]
    assert list(rows)[:6] == [("cell-nodes", one) for one in (*SOURCE.contestants, "tables*")]
    assert rows["cell-nodes", "tables*"].then == {}
    assert rows["cell-nodes", "tables*"].today["quad"] == "23.5"


def test_todays_times_are_of_as_many_as_the_source_asked(quad):
    small = quad
    for task in ("cell-nodes", "random-cell-nodes"):
        small = change(small, task, "by-node", items=10_000)
    tables = tables_of(small)
    assert tables["table 3"]["cell-nodes", "by-node"].today["quad"] == "21,900"
    assert tables["table 4"]["random-cell-nodes", "by-node"].today["quad"] == "85,900"


def test_a_model_that_nobody_ran_has_no_figures_of_today(quad):
    row = tables_of(quad)["table 3"]["node-cells", "by-edge"]
    assert (row.then["hexagon"], row.today) == ("16 (1 tick)", {"quad": "16"})
    shuffled = slow(run_of("quad", name="quad shuffled"), "node-cells", "by-edge", 2.0)
    both = tables_of(quad, run_of("hexagon"), shuffled)["table 3"]["node-cells", "by-edge"]
    assert both.today == {"quad": "16", "hexagon": "16"}


def test_what_may_not_be_believed_is_no_figure(quad):
    wrong = change(quad, "cell-nodes", "by-node", status="wrong-result", reason="not the answer of most")
    assert tables_of(wrong)["table 3"]["cell-nodes", "by-node"].today["quad"] == "missing"
    short = slow(quad, "cell-nodes", "by-node", 0.001)
    assert tables_of(short)["table 3"]["cell-nodes", "by-node"].today["quad"] == "missing"
    share = tables_of(slow(quad, "gas-cell-adjacency", "edge-cell", 0.001))["table 7"]["edge-cell",]
    assert share.today["quad"].startswith("<0.")
    assert tables_of(run_of(launches=2))["table 3"]["cell-nodes", "by-node"].today["quad"] == "219?"


def test_a_doubted_task_has_no_figures(quad):
    control = make_backend("by-edge control", contestant="by-edge", against="by-edge", control=True)
    slower = [
        msgspec.structs.replace(one, backend=control.name, cpu_s=1.5 * one.cpu_s, process_cpu_s=1.5 * one.cpu_s)
        for one in quad.samples
        if (one.task, one.backend) == ("random-cell-nodes", "by-edge")
    ]
    doubted = msgspec.structs.replace(quad, backends=[*quad.backends, control], samples=[*quad.samples, *slower])
    rows = tables_of(doubted)["table 4"]
    assert rows["random-cell-nodes", "by-node"].today["quad"] == "unclear"
    assert rows["random-cell-neighbours", "by-node"].today["quad"] == "859"


def test_few_ticks_are_marked_in_ratios(quad):
    comparison = compare_with_source([quad], SOURCE)
    (subject,) = comparison.subjects
    assert subject.entry("node-cells", "by-node").is_coarse  # 31 ms over 16
    assert subject.entry("cell-nodes", "by-node").is_coarse  # 219 over 47
    assert not subject.entry("random-cell-nodes", "by-node").is_coarse
    (table,) = [text for text in as_markdown(comparison).split("\n\n") if "| node-cells | 2008 |" in text]
    assert "| node-cells | 2008 | 1.9? | 1 | 12? |" in table
    assert "| random-cell-nodes | 2008 | 2.0x | 1 | 0.70x |" in table
    (figure,) = draw_figures(comparison, quad).values()
    then, today = ([text.get_text() for text in axes.texts] for axes in figure.axes)
    assert "7.8?" in then
    assert "7.8" in today


def test_the_legend_of_long_titles_is_inside_the_figure(quad):
    (figure,) = draw_figures(compare_with_source([quad], SOURCE), quad).values()
    figure.canvas.draw()
    (legend,) = figure.legends
    assert legend.get_window_extent().width < figure.bbox.width


def test_a_finding_about_no_model_of_these_has_no_evidence(quad):
    comparison = compare_with_source([quad], SOURCE)
    (scrambled,) = [judged for judged in comparison.findings if judged.name == "scrambled"]
    assert as_html(comparison).count(scrambled.claim) == 1  # in the overview, with a dash
    assert "<ul>\n</ul>" not in as_html(comparison)
    both = compare_with_source([run_of("hexagon"), run_of("voronoi")], SOURCE)
    assert as_html(both).count(scrambled.claim) == 2


def test_pages_have_the_tables_and_stay_plain_data(quad):
    comparison = compare_with_source([quad], SOURCE)
    assert msgspec.json.decode(msgspec.json.encode(comparison), type=Comparison) == comparison
    page = as_html(comparison)
    assert page.count("<caption>Table ") == 6
    assert ">31 (2 ticks)</td>" in page
    assert "Memory</h3>" not in page  # table 2 says it
    assert "quad: seconds" not in page  # tables 3 and 4 say it
    assert make_section([quad])[0] == "A. A. Voropinov (2008) and today"
