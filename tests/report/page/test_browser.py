"""The page in a real browser: nothing fetched, no error, all charts drawn; the controls do what they say; for everybody."""

import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from tests.report.page.pages import (
    EVIL,
    HOSTILE,
    broken,
    browser_path,
    hostile,
    lines,
    single,
    sweep,
    thesis,
    two_runs,
)
from tetrabench.bench.statistics import summary_against
from tetrabench.report.cells import interval_of
from tetrabench.report.page import make_page
from tetrabench.report.page.subjects import ABSOLUTE
from tetrabench.report.thesis.page import make_section

playwright = pytest.importorskip("playwright.sync_api")
pytest.importorskip("vl_convert")

pytestmark = pytest.mark.xdist_group("browser")  # one browser for all

SIZES = {"desk": (1280, 900), "phone": (390, 844)}
MADE = {
    "two": two_runs,
    "sweep": sweep,
    "hostile": hostile,
    "thesis": thesis,
    "broken": broken,
    "single": single,
    "lines": lines,
}
QUIET = [
    "--no-sandbox",
    "--disable-gpu",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
]


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    folder = tmp_path_factory.mktemp("pages")
    paths = {name: folder / f"{name}.html" for name in MADE}
    for name, make in MADE.items():
        runs = make()
        extra = [make_section([results for _, results in runs])] if name == "thesis" else []
        paths[name].write_text(make_page(runs, extra=extra))
    return paths


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    path = browser_path()
    with playwright.sync_playwright() as driver:
        chromium = driver.chromium.launch(executable_path=path, args=QUIET)
        yield chromium
        chromium.close()


class Visit:
    """A page that somebody has open, what it complained of, and what it asked the world for."""

    def __init__(self, browser: Any, path: Path, *, size: str = "desk", **choices: Any) -> None:
        width, height = SIZES[size]
        self.context = browser.new_context(viewport={"width": width, "height": height}, **choices)
        self.page = self.context.new_page()
        self.said: list[str] = []
        self.asked: list[str] = []
        self.page.on("console", lambda message: self.said.append(f"{message.type}: {message.text}"))
        self.page.on("pageerror", lambda error: self.said.append(f"error: {error}"))
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.goto(path.as_uri())

    def __enter__(self) -> "Visit":
        return self

    def __exit__(self, *_: object) -> None:
        self.context.close()

    def see_all(self) -> None:
        """Go through all of the page, until every chart is drawn live."""
        charts = self.page.locator("figure:not([hidden]) .chart")
        for place in range(charts.count()):
            charts.nth(place).scroll_into_view_if_needed()
            name = charts.nth(place).get_attribute("data-figure")
            self.page.wait_for_function("name => chartOf(name).dataset.drawn", arg=name)

    def chart(self, name: str) -> Any:
        chart = self.page.locator(f'.chart[data-figure="{name}"]')
        chart.scroll_into_view_if_needed()
        self.page.wait_for_function("name => chartOf(name).dataset.drawn", arg=name)
        return chart

    def words(self, name: str) -> list[str]:
        """All text in a chart."""
        return self.chart(name).locator("svg text").all_text_contents()

    def do(self, name: str, act: Any) -> None:
        """Do something with the controls, and wait until a chart has been drawn anew."""
        before = self.chart(name).get_attribute("data-drawn")
        act(self.page)
        self.page.locator(
            f'.chart[data-figure="{name}"]'
        ).scroll_into_view_if_needed()  # others wait until they are seen
        self.page.wait_for_function("([name, before]) => chartOf(name).dataset.drawn !== before", arg=[name, before])


@pytest.fixture
def visit(browser: Any, files: dict[str, Path]) -> Iterator[Any]:
    opened: list[Visit] = []

    def go(name: str, **choices: Any) -> Visit:
        found = Visit(browser, files[name], **choices)
        opened.append(found)
        if choices.get("java_script_enabled", True):
            found.page.evaluate(
                "window.chartOf = (name) => document.querySelector(`.chart[data-figure=${CSS.escape(name)}]`)"
            )
        return found

    yield go
    for one in opened:
        one.context.close()


@pytest.mark.parametrize("name", MADE)
@pytest.mark.parametrize("size", SIZES)
def test_every_chart_is_drawn_without_a_word_and_without_the_network(visit, files, name, size):
    here = visit(name, size=size)
    here.see_all()
    assert here.said == []
    assert here.asked == [files[name].as_uri()]
    charts = here.page.locator("figure:not([hidden]) .chart")
    assert charts.count() == files[name].read_text().count('class="chart"')
    drawn = ".role-mark path, .role-mark line, .role-mark rect"
    drawn += ", .role-mark text" if name == "broken" else ""  # a word where no figure may stand
    for place in range(charts.count()):
        assert charts.nth(place).locator(drawn).count() > 0, charts.nth(place).get_attribute("data-figure")
        assert charts.nth(place).locator("canvas").count() == 0
    assert here.page.evaluate("document.documentElement.scrollWidth") <= SIZES[size][0]  # nothing sticks out


def test_a_word_stands_where_no_figure_may(visit):
    here = visit("broken")
    assert here.chart("times-init").locator(".mark-symbol path").count() == 0
    assert sorted(word for word in here.words("times-init") if word in ("crashed", "no ref.")) == [
        "crashed",
        *["no ref."] * 3,
    ]
    assert here.words("times-alfa").count("no ref.") == 1
    here.do("times-init", lambda page: page.select_option("select[name=base]", "v4"))
    assert here.words("times-init").count("crashed") == 1
    assert here.chart("times-init").locator(".mark-symbol path").count() == 3  # those who did not
    assert here.said == []


def test_who_is_alone_is_compared_with_itself(visit):
    here = visit("single")
    assert "1 backend, 1 model." in here.page.locator("header").inner_text()
    assert "One way to store the same thing" in here.page.locator("#measured").inner_text()
    assert here.chart("times-alfa").locator(".mark-symbol path").count() == 1
    assert here.page.locator('figure:has([data-figure="times-alfa"]) td.verdict').all_text_contents() == ["reference"]
    v3y = here.page.locator('input[name=backends][value="v3y"]')
    v3y.uncheck()
    assert here.page.locator("figure:visible").count() == 0  # there is nothing to show
    v3y.check()
    assert here.page.locator("figure:visible").count() > 0
    assert here.said == []


def test_a_section_beside_the_source_is_in_the_page(visit):
    here = visit("thesis")
    section = here.page.locator("#extra-0")
    assert "(2011) and today" in section.locator("h2").inner_text()
    assert section.locator("svg[role=img]").bounding_box()["width"] > 300
    assert section.locator("table").count() == 4


def test_names_of_others_do_nothing(visit):
    here = visit("hostile")
    here.see_all()
    assert here.page.evaluate("window.hacked") is None
    assert HOSTILE in here.page.locator("main").inner_text()
    assert EVIL in here.page.locator("main").inner_text()
    here.page.locator('.chart[data-figure="times-alfa"] .mark-symbol path').first.hover()
    here.page.locator("#vg-tooltip-element").wait_for()
    assert here.page.evaluate("window.hacked") is None
    assert here.page.locator("#vg-tooltip-element img, #vg-tooltip-element script").count() == 0


def test_a_backend_that_is_not_wanted_leaves_charts_and_tables(visit):
    here = visit("two")
    v4 = here.page.locator('input[name=backends][value="v4"]')
    assert "v4" in here.words("times-alfa")
    figure = here.page.locator("figure", has=here.chart("times-alfa"))
    marks = here.chart("times-alfa").locator(".mark-symbol path").count()
    here.do("times-alfa", lambda _: v4.uncheck())
    assert "v4" not in here.words("times-alfa")
    assert here.chart("times-alfa").locator(".mark-symbol path").count() == marks - 2  # on both models
    assert figure.locator("tr[data-backend=v4]:visible").count() == 0
    assert figure.locator("tr[data-backend=v3]:visible").count() == 2
    here.do("times-alfa", lambda _: v4.check())
    assert "v4" in here.words("times-alfa")
    assert figure.locator("tr[data-backend=v4]:visible").count() == 2


def test_a_curve_loses_the_point_of_a_backend_that_is_not_wanted(visit):
    here = visit("lines")
    name = "option-capacity-gravity-uniform"
    assert "leaf-only (wrong answers)" in here.words(name)
    marks = here.chart(name).locator(".mark-symbol.role-mark path").count()
    assert here.page.locator("#controls details").get_attribute("open") is not None
    here.do(name, lambda page: page.locator('input[name=backends][value="kdtree capacity=4"]').uncheck())
    assert here.chart(name).locator(".mark-symbol.role-mark path").count() == marks - 1
    here.do(name, lambda page: page.locator("input[value=linear]").check())
    assert here.said == []


def test_a_model_that_is_not_wanted_leaves(visit):
    here = visit("two")
    before = here.chart("times-init").locator(".mark-symbol path").count()
    here.do("times-init", lambda page: page.locator('input[name=models][value="intake"]').uncheck())
    assert here.chart("times-init").locator(".mark-symbol path").count() == before / 2
    assert here.page.locator('.chart[data-figure="trade-intake"]').is_hidden()
    assert here.page.locator("tr[data-model=intake]:visible").count() == 0


@pytest.mark.parametrize("base", ["v4", "v5y"])
def test_another_base_moves_marks_and_numbers(visit, base):
    here = visit("two")
    assert not [word for word in here.words("times-alfa") if word.startswith("0.25")]
    here.do("times-alfa", lambda page: page.select_option("select[name=base]", base))
    for _, results in two_runs():
        for row in summary_against(results, base):
            line = here.page.locator(
                f'figure:has([data-figure="times-{row.task}"]) tr[data-backend="{row.backend}"][data-model="{row.model}"]'
            )
            assert line.locator("td.verdict").text_content() == row.verdict
            if row.verdict in ("slower", "faster"):
                assert float(line.locator("td.text data").get_attribute("value")) == pytest.approx(row.ratio, rel=1e-5)
                assert line.locator("td.span").text_content() == interval_of(row)
                if row.task == "alfa":
                    assert line.locator("td.text").text_content() in here.words("times-alfa")
    assert f"compared with {base}" in here.page.locator("#said").text_content()


def test_seconds_stand_where_nothing_is_compared(visit):
    here = visit("two")
    here.do("times-alfa", lambda page: page.select_option("select[name=base]", ABSOLUTE))
    line = here.page.locator('figure:has([data-figure="times-alfa"]) tr[data-backend=v3y][data-model=nozzle]')
    assert re.fullmatch(r"[\d.]+ s", line.locator("td.text").text_content())
    assert line.locator("td.text").text_content() in here.words("times-alfa")
    assert any(word.endswith("s") and not word.endswith("x") for word in here.words("times-alfa"))


def test_a_linear_scale_begins_at_nought(visit):
    here = visit("two")
    assert "0x" not in here.words("times-alfa")
    here.do("times-alfa", lambda page: page.locator("input[value=linear]").check())
    assert "0x" in here.words("times-alfa")


def test_the_keyboard_reaches_everything(visit):
    here = visit("two")
    here.chart("times-init")
    reached: list[str] = []
    for _ in range(60):
        here.page.keyboard.press("Tab")
        reached.append(here.page.evaluate("document.activeElement.name || document.activeElement.className"))
    assert reached[0] == "skip"
    assert {"backends", "models", "base", "scale", "scroll"} <= set(reached)
    here.page.locator('input[name=backends][value="v4"]').focus()
    here.do("times-init", lambda page: page.keyboard.press("Space"))
    assert "v4" not in here.words("times-init")


def test_a_mark_tells_its_numbers_to_the_pointer(visit):
    here = visit("two")
    here.chart("times-alfa").locator(".mark-symbol path").first.hover()
    here.page.locator("#vg-tooltip-element.visible").wait_for()
    assert "v3" in here.page.locator("#vg-tooltip-element").inner_text()


@pytest.mark.parametrize("size", SIZES)
def test_without_scripts_the_pictures_are_there(visit, files, size):
    here = visit("two", size=size, java_script_enabled=False)
    charts = here.page.locator(".chart > svg")
    assert charts.count() == files["two"].read_text().count('class="chart"')
    for place in range(charts.count()):
        assert charts.nth(place).bounding_box()["width"] <= SIZES[size][0]
        assert charts.nth(place).locator(".role-mark path, .role-mark line").count() > 0
    assert here.page.locator("#controls").is_hidden()
    assert here.page.locator("tr[data-backend=v4]:visible").count() > 0


def test_on_paper_there_are_charts_and_no_controls(visit):
    here = visit("two")
    here.see_all()
    here.page.emulate_media(media="print")
    assert here.page.locator("#controls").is_hidden()
    assert here.page.locator("nav").is_hidden()
    assert here.page.locator('.chart[data-figure="times-alfa"] svg').is_visible()
    box = here.page.locator('figure:has([data-figure="times-alfa"]) .scroll')
    assert box.evaluate("one => one.scrollHeight <= one.clientHeight + 1")  # a table is not cut


def test_on_paper_all_charts_say_what_their_tables_say_though_nobody_has_seen_them(visit):
    here = visit("two")
    here.page.select_option("select[name=base]", "v4")
    here.page.wait_for_function(
        "[...document.querySelectorAll('figure:not([hidden]) .chart')].every(chart => chart.dataset.drawn)"
    )
    assert here.page.evaluate("scrollY") == 0
    for task in ("init", "alfa"):
        figure = here.page.locator(f'figure:has([data-figure="times-{task}"])')
        told = figure.locator("tr[data-backend=v3y][data-model=nozzle] td.text").text_content()
        assert told in figure.locator("svg text").all_text_contents()
        assert figure.locator(".chart").get_attribute("aria-label").endswith("compared with v4.")


def test_ink_is_light_in_the_dark(visit):
    def ink(here: Visit) -> tuple[float, float]:
        colours = here.chart("times-alfa").evaluate(
            "one => [getComputedStyle(one.querySelector('svg text')).fill, getComputedStyle(document.body).backgroundColor]"
        )
        text, paper = (sum(map(float, re.findall(r"[\d.]+", colour)[:3])) / 3 for colour in colours)
        return text, paper

    text, paper = ink(visit("two", color_scheme="dark"))
    assert text > 200 > 60 > paper
    text, paper = ink(visit("two", color_scheme="light"))
    assert text < 60 < 200 < paper


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize(
    ("name", "size"), [("two", "desk"), ("two", "phone"), ("sweep", "desk"), ("thesis", "desk"), ("lines", "desk")]
)
def test_no_barrier_by_axe(visit, name, size, scheme):
    axe = pytest.importorskip("axe_playwright_python.sync_playwright")
    here = visit(name, size=size, color_scheme=scheme)
    here.see_all()
    found = axe.Axe().run(here.page).response["violations"]
    serious = [one for one in found if one["impact"] in ("serious", "critical")]
    assert not [(one["id"], one["nodes"][0]["html"], one["nodes"][0]["failureSummary"]) for one in serious]
