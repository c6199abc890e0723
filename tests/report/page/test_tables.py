"""Each table against the results it comes from: every cell, its exact number and what the eye reads, reckoned anew."""

import math
from statistics import median

import msgspec
import pytest

from tests.report.made import change, make_backend, make_launch, make_memory, make_results, make_sweep
from tests.report.page.pages import TASKS, two_runs
from tetrabench.bench import Results
from tetrabench.bench.record import Yardsticks
from tetrabench.report.page import figures, tables
from tetrabench.report.page.subjects import ABSOLUTE, make_runs, make_subjects
from tetrabench.report.page.tables import Entry, Table
from tetrabench.report.sheets import make_pages

NAMES = ("v3", "v3y", "v4", "v5y")
UNITS = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}


def subjects_of(*runs: tuple[str, Results]):
    return make_subjects(make_runs(list(runs)))


def cells_of(table: Table) -> dict[tuple[str, ...], list[Entry]]:
    """Heads of a line -> its cells; each line has as many as the table has columns, and no two lines are of one thing."""
    assert all(len(line.heads) + len(line.cells) == len(table.head) for line in table.lines)
    found = {tuple(line.heads): line.cells for line in table.lines}
    assert len(found) == len(table.lines)
    return found


def whose(table: Table, *columns: str) -> bool:
    """Whether each line says to style.css and script.js the backend and the model that stand in its heads."""
    places = [table.head.index(name) for name in columns]
    return all([line.backend, line.model][: len(columns)] == [line.heads[at] for at in places] for line in table.lines)


def values(cells: list[Entry]) -> list[float | str | None]:
    return [cell.value for cell in cells]


def texts(cells: list[Entry]) -> list[str]:
    return [cell.text for cell in cells]


def read(text: str) -> float:
    """What the eye reads: 1.24 s, 84.0 ns, 43 %, 1,240, 0.62, 1.2x."""
    number, _, unit = text.replace(",", "").removesuffix("x").partition(" ")
    return float(number) * {**UNITS, "%": 0.01, "": 1.0}[unit]


def times_of(results: Results, model: str, task: str, backend: str) -> dict[tuple[int, int], float]:
    """(launch, round) -> CPU seconds, as they were measured."""
    return {
        (one.launch, one.round): one.cpu_s
        for one in results.samples
        if (one.model, one.task, one.backend, one.status) == (model, task, backend, "ok")
    }


def ratios_of(results: Results, model: str, task: str, backend: str, base: str) -> tuple[float, float, float]:
    """The median of all launches, the least, the largest: eight are so few that the interval is all of them."""
    mine, theirs = (times_of(results, model, task, name) for name in (backend, base))
    launches = {launch for launch, _ in mine}
    middles = [
        median(math.log(mine[place] / theirs[place]) for place in mine if place[0] == launch) for launch in launches
    ]
    return math.exp(median(middles)), math.exp(min(middles)), math.exp(max(middles))


@pytest.mark.parametrize("base", ["v3y", "v4"])
@pytest.mark.parametrize("task", ["init", "alfa"])
def test_times(base, task):
    runs = two_runs()
    subjects = subjects_of(*runs)
    rows = figures.times(subjects, ["v5y", "v3y", ABSOLUTE, "v4"])[task]
    table = tables.times_table(subjects, task, rows, base)
    assert table.caption == f"{task}: the numbers"
    assert table.head == ["backend", "model", "one run", "per item", "figure", "interval", "verdict"]
    cells = cells_of(table)
    assert [*cells] == [(name, model) for model in ("nozzle", "intake") for name in NAMES]
    assert whose(table, "backend", "model")
    tetras = {"nozzle": 642_720, "intake": 155_000}
    for (name, model), line in cells.items():
        assert [cell.kind for cell in line] == ["", "", "text", "span", "verdict"]
        if (task, name, model) == ("alfa", "v5y", "intake"):
            assert texts(line) == ["", "", "crashed", "", "crashed"]
            assert values(line) == [None] * 5
            continue
        results = dict(zip(("nozzle", "intake"), (run for _, run in runs), strict=True))[model]
        seconds = median(times_of(results, model, task, name).values())
        ratio, least, largest = ratios_of(results, model, task, name, base)
        assert values(line[:3]) == pytest.approx([seconds, seconds / tetras[model] * 1e9, ratio], rel=1e-12)
        assert values(line[3:]) == [None, None]
        assert read(line[0].text) == pytest.approx(seconds, rel=0.005)
        assert read(line[1].text) == pytest.approx(seconds / tetras[model], rel=0.005)
        assert line[0].text.endswith(" s")
        if name == base:
            assert texts(line[2:]) == ["1", "", "reference"]
        else:
            assert read(line[2].text) == pytest.approx(ratio, rel=0.05)
            assert [*map(read, line[3].text.split("-"))] == pytest.approx([least, largest], abs=0.0051)
            assert line[2].text.endswith("x")
            assert line[4].text == ("slower" if ratio > 1 else "faster")


def test_times_that_are_no_figures_are_words():
    subjects = subjects_of(("run", make_results(TASKS, wobble=0.0)))
    table = tables.times_table(subjects, "free", figures.times(subjects, ["v3y"])["free"], "v3y")
    said = {name: texts(line[2:]) for (name, _), line in cells_of(table).items()}
    drift = [0.2 * (1 + launch / 8) * 1.01 for launch in range(8)]  # the middle one of three rounds
    ratio = (drift[3] + drift[4]) / 2 / 0.005  # a reference under 5 ms counts as 5 ms
    assert said == {
        "v3": ["too short", "", "too short"],
        "v3y": ["1", "", "reference"],
        "v4": ["58x", "40.4-75.8", "slower"],
        "v5y": ["too short", "", "too short"],
    }
    shown = {name: line[2].value for (name, _), line in cells_of(table).items()}
    assert shown == {"v3": None, "v3y": 1.0, "v4": pytest.approx(ratio, rel=0.002), "v5y": None}


def test_samples():
    runs = two_runs()
    rows = figures.samples(subjects_of(*runs))["alfa"]
    table = tables.samples_table(rows, "alfa")
    assert table.head[2:] == ["samples", "least", "median", "largest"]
    cells = cells_of(table)
    models = {"nozzle": runs[0][1], "intake": runs[1][1]}
    assert {*cells} == {(name, model) for name in NAMES for model in models} - {("v5y", "intake")}
    assert whose(table, "backend", "model")
    for (name, model), line in cells.items():
        mine, theirs = (times_of(models[model], model, "alfa", one) for one in (name, "v3y"))
        ratios = sorted(mine[place] / theirs[place] for place in mine)
        assert line[0] == Entry("16")
        assert values(line[1:]) == pytest.approx([ratios[0], (ratios[7] + ratios[8]) / 2, ratios[-1]], rel=1e-12)
        assert [read(text) for text in texts(line[1:])] == pytest.approx(values(line[1:]), rel=0.005)
        assert name == "v3y" or ratios[0] < values(line)[2] < ratios[-1]  # so that none stands for another


def test_trade():
    ((_, results), *_) = two_runs()
    sizes = {"v3": 100, "v3y": 150, "v4": 1000, "v5y": 130}
    memory = [make_memory(name, peak_bytes=642_720 * size) for name, size in sizes.items()]
    (subject,) = subjects_of(("run", msgspec.structs.replace(results, memory=memory)))
    kind, rows = figures.trade(subject)
    table = tables.trade_table(rows, subject.label, kind, "tetra")
    assert table.caption.startswith("nozzle: time of one run, and peak bytes a tetra")
    assert table.head == ["scenario", "backend", "model", "one run", "bytes a tetra", "front"]
    cells = cells_of(table)
    assert [*cells] == [(task, name, "nozzle") for task in TASKS for name in NAMES]
    assert whose(table, "backend", "model")
    for (task, name, _), line in cells.items():
        seconds = median(times_of(results, "nozzle", task, name).values())
        assert values(line[:2]) == pytest.approx([seconds, sizes[name]], rel=1e-12)
        assert read(line[0].text) == pytest.approx(seconds, rel=0.005)
        assert line[1].text == f"{sizes[name]:,}"
    front = {(task, name): line[2].text for (task, name, _), line in cells.items()}
    assert {name: front["alfa", name] for name in NAMES} == {"v3": "front", "v3y": "front", "v4": "", "v5y": ""}
    assert {name: front["free", name] for name in NAMES} == {"v3": "front", "v3y": "front", "v4": "", "v5y": "front"}


def test_growth():
    sizes = [300, 100, 10_000, 3000, 1000]  # columns are in order whatever the run's is
    run = make_sweep({"alfa": {"v3y": 0.1, "v4": 0.3}}, {"v3y": 1.0, "v4": 1.2}, sizes, launches=3, rounds=1)
    lost = [one for one in run.samples if (one.backend, one.model) != ("v4", "nozzle-1000")]
    rows = figures.growth(subjects_of(("sweep", msgspec.structs.replace(run, samples=lost))))
    table = tables.growth_table(rows, "tetras")
    assert table.caption == "Time of an item, by the number of tetras"
    assert table.head == ["scenario", "backend", "run", "100", "300", "1,000", "3,000", "10,000"]
    cells = cells_of(table)
    assert [*cells] == [("alfa", "v3y", "sweep"), ("alfa", "v4", "sweep")]
    assert whose(table, "backend")
    assert not [line.model for line in table.lines if line.model]  # a line is of several
    for (_, name, _), line in cells.items():
        for size, entry in zip(sorted(sizes), line, strict=True):
            if (name, size) == ("v4", 1000):
                assert entry == Entry("")
                continue
            seconds = median(times_of(run, f"nozzle-{size}", "alfa", name).values())
            assert entry.value == pytest.approx(seconds / size * 1e9, rel=1e-12)
            assert read(entry.text) == pytest.approx(seconds / size, rel=0.005)
    assert values(cells["alfa", "v4", "sweep"])[0] < values(cells["alfa", "v4", "sweep"])[-1]


def test_fields():
    tetras = 642_720
    buffers = {
        "v3": {"tetras": (232 * tetras, 300 * tetras), "points": (3 * tetras, 5 * tetras)},
        "v4": {"tetras": (1264 * tetras, 1264 * tetras), "holes": (0, 16), "tree": (1, 2 * tetras)},
    }
    results = make_results({"alfa": {"v3y": 1.0, "v3": 1.0, "v4": 1.0}})
    memory = [make_memory(name, structure=structure) for name, structure in buffers.items()]
    memory.append(make_memory("v3y", status="oom"))
    rows = figures.fields(subjects_of(("run", msgspec.structs.replace(results, memory=memory))))
    table = tables.fields_table(rows, "tetra")
    assert table.caption.startswith("Bytes a tetra")
    assert table.head == ["backend", "model", "tetras", "points", "holes", "tree", "all"]
    assert whose(table, "backend", "model")
    cells = cells_of(table)
    assert {heads: values(line) for heads, line in cells.items()} == {
        ("v3", "nozzle"): [232.0, 3.0, None, None, 235.0],
        ("v4", "nozzle"): [1264.0, None, 0.0, 1 / tetras, pytest.approx(1264 + 1 / tetras)],
    }
    assert {heads: texts(line) for heads, line in cells.items()} == {
        ("v3", "nozzle"): ["232", "3.0", "", "", "235"],
        ("v4", "nozzle"): ["1,264", "", "0", "<0.1", "1,264"],
    }


def test_memory():
    tetras = 642_720
    results = make_results({"alfa": {"v3y": 1.0, "v3": 1.0, "v4": 1.0, "v5y": 1.0}})
    two = {"a": (200 * tetras, 999 * tetras), "b": (40 * tetras, 999 * tetras)}
    memory = [
        make_memory("v3y", structure=two, retained_bytes=251 * tetras, peak_bytes=1302 * tetras),
        make_memory("v3", structure={"a": (7 * tetras, 7 * tetras)}, retained_bytes=8 * tetras, peak_bytes=None),
        make_memory("v4", status="oom"),
    ]
    backends = [msgspec.structs.replace(one, structure={}) for one in results.backends]
    table = tables.memory_table(
        subjects_of(("run", msgspec.structs.replace(results, memory=memory, backends=backends)))
    )
    assert table.head == ["backend", "model", "structure", "retained", "peak"]
    assert whose(table, "backend", "model")
    assert cells_of(table) == {
        ("v3y", "nozzle"): [Entry("240.0", 240.0), Entry("251.0", 251.0), Entry("1,302.0", 1302.0)],
        ("v3", "nozzle"): [Entry("7.0", 7.0), Entry("8.0", 8.0), Entry("no figure")],
        ("v4", "nozzle"): [Entry("no memory")] * 3,
        ("v5y", "nozzle"): [Entry("no figure")] * 3,
    }


def test_limits():
    runs = two_runs()
    yards = {"nozzle": 1000.0, "intake": 250.0}
    runs = [
        (
            name,
            msgspec.structs.replace(
                run,
                launches=[
                    msgspec.structs.replace(
                        one, yardsticks=Yardsticks(copy_gb_s=1.0, triad_gb_s=yards[one.model], latency_ns=1.0)
                    )
                    for one in run.launches
                ],
            ),
        )
        for name, run in runs
    ]
    table = tables.limits_table(figures.limits(subjects_of(*runs)))
    assert table.head == ["scenario", "backend", "model", "GB/s", "share"]
    cells = cells_of(table)
    assert [*cells] == [("alfa", name, model) for model in yards for name in NAMES][:-1]  # v5y crashed on intake
    assert whose(table, "backend", "model")
    for (_, name, model), line in cells.items():
        results = runs[[*yards].index(model)][1]
        gb_s = 400 / median(times_of(results, model, "alfa", name).values())
        assert values(line) == pytest.approx([gb_s, gb_s / yards[model]], rel=1e-12)
        assert read(line[0].text) == pytest.approx(gb_s, rel=0.005)
        assert read(line[1].text) == pytest.approx(gb_s / yards[model], abs=0.005)
        assert line[1].text.endswith(" %")


def test_sheets():
    """Each cell of `tetrabench show`, at its place; what ranks it is its class."""
    ((_, results), *_) = two_runs()
    shown = make_pages(change(results, "alfa", "v4", status="oom"))
    assert len(shown.sheets) == 2  # of times with costs, and of bandwidth
    for sheet in shown.sheets:
        table = tables.sheet_table(sheet)
        assert (table.caption, table.head) == (sheet.title, sheet.head)
        assert [[*line.heads, *texts(line.cells)] for line in table.lines] == [
            [cell.text for cell in row] for row in [*sheet.rows, *sheet.costs]
        ]
        assert all(line.backend == line.model == "" for line in table.lines)  # nobody takes columns away
    of_times = cells_of(tables.sheet_table(shown.sheets[0]))
    assert of_times["alfa",][-2] == Entry("no memory", None, "out-of-memory")
    assert of_times["alfa",][-1] == Entry("2.5x", None, "slower")
    assert of_times["free",][-1] == Entry("too short", None, "too-short")
    assert [*of_times][-3:] == [("retained",), ("peak",), ("compiling",)]


def test_answers():
    """Whoever gave another answer than all others, or none, is not seen among them."""
    results = change(make_results(TASKS, launches=2), "alfa", "v4", digest="f00", status="wrong-result")
    results = change(results, "alfa", "v5y", digest="", status="crash")
    results = change(results, "free", "v3", digest="0dd")
    samples = [  # once so, once so
        msgspec.structs.replace(one, digest="bad", status="unstable")
        if (one.task, one.backend, one.launch) == ("init", "v4", 1)
        else one
        for one in results.samples
    ]
    (subject,) = subjects_of(("run", msgspec.structs.replace(results, samples=samples)))
    table = tables.answers_table(subject)
    assert table.caption == "nozzle: answers"
    assert table.head == ["scenario", "digest", "given by"]
    usual = {task: f"{sum(map(ord, task)):016x}" for task in TASKS}
    said = sorted((line.heads[0], *texts(line.cells)) for line in table.lines)
    assert said == sorted(
        [
            ("init", usual["init"], "v3, v3y, v3y control, v4, v5y"),
            ("init", "bad", "v4"),
            ("alfa", usual["alfa"], "v3, v3y, v3y control"),
            ("alfa", "f00", "v4"),
            ("free", "0dd", "v3"),
            ("free", usual["free"], "v3y, v3y control, v4, v5y"),
        ]
    )


def test_answers_are_those_of_one_model():
    runs = two_runs()
    other = [msgspec.structs.replace(one, digest="a11") for one in runs[1][1].samples]
    sweep = make_sweep({"alfa": {"v3y": 0.1, "v4": 0.3}}, {"v3y": 1.0, "v4": 1.0}, [10, 20], launches=1)
    for subject, digest in zip(
        subjects_of(runs[0], ("second", msgspec.structs.replace(runs[1][1], samples=other))),
        (f"{sum(map(ord, 'alfa')):016x}", "a11"),
        strict=True,
    ):
        assert digest in {line.cells[0].text for line in tables.answers_table(subject).lines}
    mixed = [msgspec.structs.replace(one, digest=one.model) for one in sweep.samples]
    for subject in subjects_of(("sweep", msgspec.structs.replace(sweep, samples=mixed))):
        assert [line.cells[0].text for line in tables.answers_table(subject).lines] == [subject.model.name]


def test_machine():
    yards = [(20.0, 16.0, 90.0), (22.0, 18.0, 80.0), (30.0, 17.0, 85.0)]
    launches = [
        make_launch(
            place,
            load_1_minute=load,
            steal_share=steal,
            yardsticks=Yardsticks(copy_gb_s=copy, triad_gb_s=triad, latency_ns=latency),
        )
        for place, (load, steal, (copy, triad, latency)) in enumerate(
            zip((2.0, 0.25, 1.0), (0.0, 0.031, None), yards, strict=True)
        )
    ]
    environment = {
        "processor": "Intel Core2 T6400",
        "memory_gb": 4,
        "caches": {"L1": "32 KiB", "L2": "2 MiB"},
        "cores": [0, 1],
        "governor": None,
        "note": "",
    }
    results = make_results(TASKS, launches=3, environment=environment)
    table = tables.machine_table(msgspec.structs.replace(results, launches=launches))
    assert (table.caption, table.head) == ("The machine", ["fact", "value"])
    assert {heads[0]: text for heads, (text,) in ((one, texts(cell)) for one, cell in cells_of(table).items())} == {
        "processor": "Intel Core2 T6400",
        "memory gb": "4",
        "caches": "L1 32 KiB, L2 2 MiB",
        "cores": "0, 1",
        "load when launches began": "0.25 to 2.00",
        "time taken by other guests": "3 % at most",
        "copy": "22.0 GB/s",
        "triad": "17.0 GB/s",
        "a random access": "85.0 ns",
        "begun": "2011-05-01T12:00:00+00:00",
        "took": "1,000 s",
    }


def test_a_machine_that_does_not_tell():
    bare = [make_launch(yardsticks=None)]
    results = make_results(TASKS, launches=1, environment={"cores": 2})
    table = tables.machine_table(msgspec.structs.replace(results, launches=bare))
    assert [line.heads[0] for line in table.lines] == ["cores", "begun", "took"]


def test_an_extension_is_called_so_in_every_table():
    """By its shown name, in lines and in what script.js looks for."""
    results = make_results({"alfa": {"v3y": 1.0, "mine": 2.0}})
    backends = [make_backend("mine", extension=True) if one.name == "mine" else one for one in results.backends]
    subjects = subjects_of(("run", msgspec.structs.replace(results, backends=backends)))
    kind, traded = figures.trade(subjects[0])
    made = [
        tables.times_table(subjects, "alfa", figures.times(subjects, ["v3y"])["alfa"], "v3y"),
        tables.samples_table(figures.samples(subjects)["alfa"], "alfa"),
        tables.trade_table(traded, "nozzle", kind, "tetra"),
        tables.fields_table(figures.fields(subjects), "tetra"),
        tables.memory_table(subjects),
        tables.limits_table(figures.limits(subjects)),
    ]
    for table in made:
        assert {line.backend for line in table.lines} == {"v3y", "mine*"}, table.caption
        assert whose(table, "backend", "model")
    assert "mine*" in tables.answers_table(subjects[0]).lines[0].cells[1].text
