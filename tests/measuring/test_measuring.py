"""The evidence: page and data agree, the plug-in does what its names say, and what other tools say is read rightly."""

import pytest

from tests.measuring import injected, page, picture
from tests.measuring.page import PAGE, TABLES, shown, table
from tests.measuring.record import Comparison, Part, read, save
from tests.measuring.tools import said_by_pyperf, said_by_pytest_benchmark
from tetrabench import registry
from tetrabench.bench import agenda, plan, ring, statistics

TEXT = PAGE.read_text()


@pytest.mark.parametrize("name", TABLES)
def test_the_page_shows_what_is_committed(name):
    parts = read()
    assert shown(name, TEXT) == (table(name, parts) if parts else "")


def test_the_page_says_what_the_code_does():
    default, quick, rigorous = (plan.EFFORTS[name] for name in ("default", "quick", "rigorous"))
    for said in (
        f"{default.launches} launches of {default.rounds} rounds by default, {quick.launches} of {quick.rounds} with",
        f"{rigorous.launches} of {rigorous.rounds} with",
        f"narrower than {default.narrow:.0%}".replace("%", " %"),
        f"beyond 1 by more than {statistics.BEYOND - 1:.0%}".replace("%", " %"),
        f"within {statistics.ALIKE - 1:.0%}".replace("%", " %"),
        f"beyond {statistics.CLEAR:g} times",
        f"shorter than {1e3 * statistics.SHORTEST_S:g} ms",
        f"Samples of {1e3 * ring.LONG_S:g} ms",
        f"{statistics.PARALLEL:g} times the CPU time",
        f"more than {agenda.HOPELESS:g} times",
    ):
        assert said in TEXT.replace("\n", " "), said


def part(tool="tetrabench", **facts):
    comparisons = [
        Comparison(
            scenario="alfa", contestant=name, injected=share, ratio=1 + share, low=1.0, high=1.5, verdict=verdict
        )
        for name, share, verdict in [
            ("same-1", 0.0, "same"),
            ("same-2", 0.0, "slower"),
            ("slower-10", 0.1, "inconclusive"),
            ("slower-20", 0.2, "faster"),
            ("slower-30", 0.3, "slower"),
        ]
    ]
    return Part(
        part=f"{tool}-0", tool=tool, command=["x"], begun="2026-01-02T03:04", seconds=60, comparisons=comparisons
    )


def test_a_part_survives_its_file(tmp_path):
    save(part(), tmp_path)
    assert read(tmp_path) == [part()]


def test_the_tables_count():
    assert list(page.equal_codes([part()]))[1] == ["tetrabench", "2", "1", "0", "1", "0", "1.00"]
    assert list(page.power([part()]))[1] == ["tetrabench", "0 of 1", "0 of 1", "1 of 1", "1"]
    assert ["slower", "1", "0", "0", "1"] in page.neither_words([part()])


def test_the_overhead_is_what_is_named_outside_and_what_is_not_named_at_all():
    spent = {"samples": 30.0, "compiling": 12.0, "starting": 3.0, "waiting": 1.0}
    one = Part(part="cost", tool="tetrabench", command=[], begun="", seconds=60, facts={"spent_s": spent})
    assert page.overhead(one) == pytest.approx(18 / 60)


def test_the_picture_is_drawn(tmp_path):
    save(part(), tmp_path)
    save(part("hyperfine"), tmp_path)
    picture.draw(tmp_path, tmp_path / "picture.svg")
    assert (tmp_path / "picture.svg").read_text().startswith("<?xml")


@pytest.mark.parametrize("share", [0.0, 0.3])
def test_a_slowed_contestant_burns_its_share(share, monkeypatch):
    """CPU time of the thread as the plug-in sees it: 10 s for the workload, and a step each time it looks."""
    clock = iter([0.0, 10.0] + [10.0 + 0.5 * step for step in range(100)])
    looks = []
    monkeypatch.setattr(injected.time, "thread_time", lambda: looks.append(next(clock)) or looks[-1])

    class Scenario:
        def run(self, own):
            return own * 2

    assert injected.Injected(Scenario()).run(injected.Subject(21, share)) == 42
    assert looks[-1] == pytest.approx(10.0 * (1 + share))


def test_the_plug_in_keeps_its_scenarios_as_they_are():
    for ours in injected.SCENARIOS:
        theirs = registry.scenario("tetra", ours.name)
        assert (ours.options, ours.parallel, ours.family) == (theirs.options, theirs.parallel, "injected")
    assert [one.name for one in injected.SCENARIOS] == list(injected.NAMES)
    assert {one.build for one in injected.CONTESTANTS} == {registry.contestant("tetra", "v3y").build}
    assert [one.name for one in injected.CONTESTANTS] == list(injected.SHARES)


PYPERF = """alfa: Mean +- std dev: [v3y] 8.4 ms +- 2.1 ms -> [slower-10] 9.9 ms +- 0.2 ms: 1.18x slower
explode: Mean +- std dev: [v3y] 57.0 ms +- 6.0 ms -> [slower-10] 28.6 ms +- 2.0 ms: 2.00x faster

Benchmark hidden because not significant (2): flow, deform

Geometric mean: 1.23x faster
"""


def test_what_pyperf_says():
    assert said_by_pyperf(PYPERF, "alfa") == "slower"
    assert said_by_pyperf(PYPERF, "explode") == "faster"
    assert said_by_pyperf(PYPERF, "flow") == said_by_pyperf(PYPERF, "deform") == "not significant"
    with pytest.raises(ValueError, match="nothing about locate"):
        said_by_pyperf(PYPERF, "locate")


PYTEST_BENCHMARK = """ERROR: Performance has regressed:
\ttest_workload[flow] (0001_v3y) - Field 'min' has failed PercentageRegressionCheck: 17.344412209 > 5.000000000
\ttest_workload[alfa] (0001_v3y) - Field 'median' has failed PercentageRegressionCheck: 12.5 > 10.000000000
"""


def test_what_pytest_benchmark_says():
    said = {
        (name, rule): said_by_pytest_benchmark(PYTEST_BENCHMARK, name, rule)
        for name in ("flow", "alfa")
        for rule in ("min:5%", "median:10%")
    }
    assert [key for key, verdict in said.items() if verdict == "slower"] == [("flow", "min:5%"), ("alfa", "median:10%")]
