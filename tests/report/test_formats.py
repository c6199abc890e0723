"""Forms for programs: what they read is what the tables say."""

import csv
import io
import json
import math
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest

from tests.report.made import change, make_launch, make_memory, make_results, make_sweep, slow
from tetrabench.bench.record import Results
from tetrabench.bench.statistics import BAD, Row, summary
from tetrabench.cli.options import format_option
from tetrabench.errors import InputError
from tetrabench.report.formats import FORMATS
from tetrabench.report.github import annotation, as_github
from tetrabench.report.pyperf import as_pyperf
from tetrabench.report.rows import as_csv, as_json
from tetrabench.report.table import as_markdown, as_text

TWO = {"alfa": {"v3y": 1.0, "v4": 2.0}, "flow": {"v3y": 0.5, "v4": 0.25}}


def test_each_form_is_an_option():
    def parameters():
        pass

    (option,) = format_option(parameters).__click_params__
    assert list(option.type.choices) == list(FORMATS)
    results = make_results(TWO)
    assert FORMATS["table"](results) == as_text(results)
    assert FORMATS["md"](results) == as_markdown(results)
    for form in FORMATS.values():
        assert form(results).endswith("\n")


# ---------------------------------------------------------------------- json, csv


def test_json_holds_the_rows_of_the_summary_whole():
    results = change(make_results(TWO), "alfa", "v4", status="crash", reason='"signal"\n11')
    said = json.loads(as_json(results))
    assert msgspec.convert(said["rows"], list[Row]) == summary(results)
    assert said["command"] == results.command
    assert said["environment"] == results.environment
    assert said["growth"] == []
    (v3y, v4) = said["memory"]
    assert (v3y["structure_bytes"], v3y["is_accounted"]) == (results.memory[0].structure_bytes, True)
    assert v4["structure"]["tetras"][0] == 248 * 642_720


def test_json_names_unaccounted_memory_and_growth():
    assert (
        json.loads(as_json(make_results(TWO, memory=[make_memory("v3y", retained_bytes=1)])))["memory"][0][
            "is_accounted"
        ]
        is False
    )
    grown = json.loads(as_json(make_sweep(TWO, {"v3y": 1, "v4": 2}, [10, 30, 100, 200, 300])))["growth"]
    assert [(one["task"], one["backend"], round(one["exponent"], 3)) for one in grown][:2] == [
        ("alfa", "v3y", 1.0),
        ("alfa", "v4", 2.0),
    ]


def test_csv_is_a_line_a_cell():
    results = change(make_results(TWO), "alfa", "v4", status="crash", reason='a "comma", and\na line')
    lines = list(csv.DictReader(io.StringIO(as_csv(results))))
    rows = summary(results)
    assert list(lines[0]) == list(Row.__struct_fields__)
    assert len(lines) == len(rows) == 6  # two tasks: reference, contestant, control
    for line, row in zip(lines, rows, strict=True):
        assert (line["task"], line["backend"], line["verdict"], line["reason"]) == (
            row.task,
            row.backend,
            row.verdict,
            row.reason,
        )
        assert line["ratio"] == ("" if row.ratio is None else repr(row.ratio))


# ---------------------------------------------------------------------- github


def annotations(results: Results) -> list[str]:
    return [line for line in as_github(results).splitlines() if line.startswith("::")]


def test_github_is_the_markdown_alone_where_all_went_well():
    results = make_results(TWO)
    assert as_github(results) == as_markdown(results)


@pytest.mark.parametrize("status", ["wrong-result", "unstable", "crash", "oom", "timeout", "error"])
def test_github_shows_each_cell_that_went_wrong(status: str):
    results = change(make_results(TWO), "alfa", "v4", status=status, reason="the reason")
    (verdict,) = {row.verdict for row in summary(results)} & BAD
    assert annotations(results) == [f"::error title=tetrabench%3A {verdict}::v4, alfa, nozzle: the reason"]


@pytest.mark.parametrize("status", ["skipped", "unsupported"])
def test_github_is_silent_about_what_was_not_to_be_done(status: str):
    assert annotations(change(make_results(TWO), "alfa", "v4", status=status, reason="the reason")) == []


def test_github_warns_of_what_cannot_be_believed():
    results = slow(make_results({"alfa": {"v3y": 1.0, "v4": 2.0, "v5": 2.0}}), "alfa", "v3y control", 1.2)
    (warning,) = annotations(results)  # one a task, not one a contestant
    assert warning.startswith("::warning title=tetrabench%3A nothing is ranked::alfa, nozzle: the control")
    (warning,) = annotations(make_results(TWO, memory=[make_memory("v4", retained_bytes=1)]))
    assert "unaccounted memory::v4, memory, nozzle" in warning
    (error,) = annotations(make_results(TWO, memory=[make_memory("v4", status="oom", reason="too large")]))
    assert error == "::error title=tetrabench%3A oom::v4, memory, nozzle: too large"
    assert annotations(make_results(TWO, ended="budget"))[0].startswith("::warning title=tetrabench%3A ended early::")


def test_annotations_stand_in_a_comment_that_nothing_ends_early():
    results = change(make_results(TWO), "alfa", "v4", status="crash", reason="100 %\n::error::--> \r")
    page = as_github(results)
    assert page.startswith(as_markdown(results))
    assert page.removeprefix(as_markdown(results)).count("-->") == 1
    (line,) = annotations(results)
    assert line.endswith("v4, alfa, nozzle: 100 %25%0A::error::--%3E %0D")
    assert annotation("notice", "a:b,c", "d:e,f") == "::notice title=a%3Ab%2Cc::d:e,f"


# ---------------------------------------------------------------------- pyperf


def pyperf(*words: object) -> str:
    """What pyperf says."""
    command = [sys.executable, "-m", "pyperf", *map(str, words)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_pyperf_reads_its_own_format(tmp_path: Path):
    old, new = tmp_path / "old.json", tmp_path / "new.json"
    old.write_text(as_pyperf(make_results(TWO)))
    new.write_text(as_pyperf(slow(make_results(TWO), "flow", "v4", 2.0)))
    assert "alfa/v4/nozzle" in pyperf("show", old)
    stats = pyperf("stats", old)
    assert "Number of run with values: 8" in stats
    assert "Number of value per run: 3" in stats
    compared = pyperf("compare_to", old, new)
    assert "flow/v4/nozzle" in compared
    assert "2.00x slower" in compared
    assert "cpu_model_name: Intel Core2 T6400" in pyperf("metadata", old)


def test_pyperf_loads_what_was_measured():
    suite = pytest.importorskip("pyperf").BenchmarkSuite.loads(as_pyperf(make_results(TWO)))
    results = make_results(TWO)
    assert suite.get_benchmark_names() == [
        f"{task}/{name}/nozzle" for task in TWO for name in ("v3y", "v4", "v3y control")
    ]
    for row in summary(results):
        benchmark = suite.get_benchmark(f"{row.task}/{row.backend}/{row.model}")
        assert math.isclose(benchmark.median(), row.seconds)
        assert benchmark.get_nrun() == row.launches
        assert benchmark.get_nvalue() == row.samples
        assert benchmark.get_unit() == "second"


def test_pyperfs_values_are_of_one_run_on_the_clock_that_counts():
    results = change(make_results({"alfa": {"v3y": 1.0}}), "alfa", "v3y", repeats=4, cpu_s=8.0, wall_s=12.0)
    said = json.loads(as_pyperf(results))
    assert said["benchmarks"][0]["runs"][0]["values"] == [2.0, 2.0, 2.0]
    assert said["benchmarks"][0]["metadata"] == {"name": "alfa/v3y/nozzle", "loops": 4, "timer": "cpu time"}
    tasks = [msgspec.structs.replace(task, parallel=True) for task in results.tasks]
    said = json.loads(as_pyperf(msgspec.structs.replace(results, tasks=tasks)))
    assert said["benchmarks"][0]["runs"][0]["values"] == [3.0, 3.0, 3.0]


def test_pyperf_leaves_out_what_went_wrong_and_refuses_nothing_at_all():
    results = change(make_results(TWO), "alfa", "v4", status="crash")
    assert not any("alfa/v4" in one["metadata"]["name"] for one in json.loads(as_pyperf(results))["benchmarks"])
    zero = change(make_results({"alfa": {"v3y": 1.0}}), "alfa", "v3y", cpu_s=0.0)
    assert len(json.loads(as_pyperf(zero))["benchmarks"]) == 1  # the control
    with pytest.raises(InputError, match="no cell ended well"):
        as_pyperf(make_results(samples=[]))


def test_pyperf_knows_when_and_where_a_launch_ran():
    results = make_results({"alfa": {"v3y": 1.0}}, launches=1)
    launches = [make_launch(begun="2026-01-02T03:04:05+00:00", core=3, load_1_minute=0.5)]
    said = json.loads(as_pyperf(msgspec.structs.replace(results, launches=launches)))
    assert said["benchmarks"][0]["runs"][0]["metadata"] == {
        "date": "2026-01-02 03:04:05",
        "cpu_affinity": "3",
        "load_avg_1min": 0.5,
    }
