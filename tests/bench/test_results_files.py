"""Results files: the published schema and page are those of the records; what is no such file is refused; pandas."""

import json
import re
from pathlib import Path

import jsonschema
import msgspec
import pytest

import tetrabench
from tests.report.made import change, make_results, make_sweep
from tetrabench.bench import load_results, load_summary, read_results, save_results, summary
from tetrabench.bench.record import SCHEMA, Memory, Results
from tetrabench.bench.schema import results_schema, spell_schema
from tetrabench.errors import InputError

DOCS = Path(__file__).parents[2] / "docs"
COMMITTED = [
    path for path in sorted((DOCS.parent / "results").glob("*.json")) if b'"schema"' in path.read_bytes()[:300]
]
TWO = {"alfa sweeps=10": {"v3y": 1.0, "v4": 2.0}, "flow": {"v3y": 0.5, "v4": 0.25}}
MADE = {
    "plain": make_results(launches=2),
    "sweep": make_sweep(TWO, {"v3y": 1, "v4": 2}, [100, 200], launches=1),
    "bad": change(make_results(TWO), "flow", "v4", status="crash", cpu_s=None, figures={"sum": None}),
    "empty": make_results(samples=[], models=[], memory=[], ended="interrupted"),
    "series": change(make_results(TWO), "flow", "v4", series={"step": [1.0, 2.0], "step_s": [0.5, 0.25]}),
    "odd": make_results(TWO, memory=[Memory(model="nozzle", backend="v4", status="oom", reason='"\n\x00é')]),
}


@pytest.fixture(params=MADE)
def saved(request: pytest.FixtureRequest, tmp_path: Path) -> tuple[Results, Path]:
    save_results(MADE[request.param], tmp_path / "made.json")
    return MADE[request.param], tmp_path / "made.json"


def in_one_order(schema):
    """A schema with the choices of each anyOf sorted: versions of msgspec differ in their order, which means nothing."""
    if isinstance(schema, list):
        return [in_one_order(part) for part in schema]
    if not isinstance(schema, dict):
        return schema
    settled = {name: in_one_order(part) for name, part in schema.items()}
    return settled | ({"anyOf": sorted(settled["anyOf"], key=json.dumps)} if "anyOf" in settled else {})


def test_the_published_schema_is_that_of_the_records():
    number = SCHEMA.rpartition("/")[2]
    published = (DOCS / f"results-{number}.schema.json").read_text()
    assert in_one_order(json.loads(published)) == in_one_order(json.loads(spell_schema())), "say: make schema"
    jsonschema.Draft202012Validator.check_schema(results_schema())


def test_what_is_saved_is_read_again_and_keeps_to_the_schema(saved: tuple[Results, Path]):
    results, path = saved
    assert read_results(path) == results
    jsonschema.validate(json.loads(path.read_bytes()), results_schema())


@pytest.mark.parametrize("path", COMMITTED, ids=lambda path: path.stem)
def test_committed_results_keep_to_the_schema(path: Path):
    jsonschema.validate(json.loads(path.read_bytes()), results_schema())
    assert summary(read_results(path))


@pytest.mark.parametrize(
    ("place", "value"),
    [(("schema",), "tetrabench-results/2"), (("samples", 0, "cpu_s"), "fast"), (("models",), None), (("seed",), 0.5)],
)
def test_the_schema_refuses_what_is_none(tmp_path: Path, place: tuple, value: object):
    save_results(make_results(TWO), tmp_path / "made.json")
    facts = json.loads((tmp_path / "made.json").read_bytes())
    inner = facts
    for step in place[:-1]:
        inner = inner[step]
    inner[place[-1]] = value
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate(facts, results_schema())
    (tmp_path / "made.json").write_text(json.dumps(facts))
    with pytest.raises(InputError, match=r"made\.json: "):
        read_results(tmp_path / "made.json")


def test_a_file_that_is_cut_anywhere_is_refused_in_one_line(tmp_path: Path):
    path = tmp_path / "cut.json"
    save_results(make_results(TWO, launches=1, rounds=1), path)
    whole = path.read_bytes().rstrip()
    for length in {0, 1, len(whole) // 3, len(whole) // 2, len(whole) - 30, len(whole) - 1}:
        path.write_bytes(whole[:length])
        with pytest.raises(InputError, match=r"cut\.json: no results of tetrabench, or cut off") as refused:
            read_results(path)
        assert "\n" not in str(refused.value)


@pytest.mark.parametrize("text", ["{}", '{"benchmarks": [], "version": "1.0"}', "[1, 2]", "\x00\xff", '{"schema": 1}'])
def test_foreign_json_is_refused_in_one_line(tmp_path: Path, text: str):
    (tmp_path / "foreign.json").write_text(text)
    for load in (read_results, load_results, load_summary):
        with pytest.raises(InputError, match=r"foreign\.json: ") as refused:
            load(tmp_path / "foreign.json")
        assert "\n" not in str(refused.value)


def test_another_number_of_the_schema_is_refused(tmp_path: Path):
    for number in (0, 2):
        other = msgspec.structs.replace(make_results(TWO), schema=f"tetrabench-results/{number}")
        save_results(other, tmp_path / "other.json")
        with pytest.raises(InputError, match=f"schema tetrabench-results/{number}, this version reads {SCHEMA}"):
            read_results(tmp_path / "other.json")
    with pytest.raises(InputError, match="cannot read results"):
        read_results(tmp_path / "none.json")


# ---------------------------------------------------------------------- pandas


def test_samples_as_a_frame(saved: tuple[Results, Path]):
    results, path = saved
    frame = load_results(path)
    assert len(frame) == len(results.samples)
    assert frame.cpu_s.tolist() == pytest.approx(
        [float("nan") if one.cpu_s is None else one.cpu_s for one in results.samples], nan_ok=True
    )
    for column, kind in {"launch": "Int64", "cpu_s": "float64", "status": "string", "control": "boolean"}.items():
        assert str(frame[column].dtype) == kind


def test_frames_know_model_task_and_backend(tmp_path: Path):
    save_results(MADE["sweep"], tmp_path / "sweep.json")
    for frame in (load_results(tmp_path / "sweep.json"), load_summary(tmp_path / "sweep.json")):
        assert set(frame.model_tetras) == {100, 200}
        swept = frame[frame.scenario == "alfa"]
        assert set(swept.task) == {"alfa sweeps=10"}
        assert set(swept.option_sweeps) == {10}
        assert frame[frame.scenario == "flow"].option_sweeps.isna().all()
        assert set(frame[frame.control].backend) == {"v3y control"}
        assert set(frame.against) == {"v3y"}
        assert not frame.parallel.any()


def test_frames_know_the_options_of_backends(tmp_path: Path):
    made = make_results(TWO)
    options = {"v4": {"capacity": 8}}
    backends = [msgspec.structs.replace(one, options=options.get(one.name, {})) for one in made.backends]
    save_results(msgspec.structs.replace(made, backends=backends), tmp_path / "made.json")
    for frame in (load_results(tmp_path / "made.json"), load_summary(tmp_path / "made.json")):
        assert set(frame[frame.backend == "v4"].backend_capacity) == {8}
        assert frame[frame.backend != "v4"].backend_capacity.isna().all()
        assert set(frame[frame.backend == "v3y control"].contestant) == {"v3y"}


def test_series_are_in_a_frame(tmp_path: Path):
    save_results(MADE["series"], tmp_path / "made.json")
    frame = load_results(tmp_path / "made.json")
    assert frame[(frame.backend == "v4") & (frame.task == "flow")].series.iloc[0]["step"] == [1.0, 2.0]
    assert frame[frame.backend == "v3y"].series.iloc[0] == {}


def test_cells_as_a_frame(saved: tuple[Results, Path]):
    results, path = saved
    frame, rows = load_summary(path), summary(results)
    assert frame.verdict.tolist() == [row.verdict for row in rows]
    assert frame.ratio.isna().tolist() == [row.ratio is None for row in rows]


# ---------------------------------------------------------------------- the page


PAGE = (DOCS / "results.md").read_text()


def test_the_page_names_every_field():
    table = PAGE.partition("## What is in it")[2].partition("\n## ")[0]
    named = [
        name for line in re.findall(r"^\| (`.*?) \|", table, re.MULTILINE) for name in re.findall(r"`(\w+)`", line)
    ]
    assert named == list(Results.__struct_fields__)[: len(named)] == list(Results.__struct_fields__)


def test_the_page_names_the_formats():
    from tetrabench.report.formats import FORMATS

    table = PAGE.partition("## For other programs")[2]
    assert re.findall(r"^\| `(\w+)` \|", table, re.MULTILINE) == list(FORMATS)


def test_the_examples_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.chdir(tmp_path)
    save_results(make_results(TWO), tmp_path / "part.json")
    names: dict = {}
    for example in re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL):
        exec(example, names)
    assert names["fastest"].loc["flow"] == names["cells"].query("task == 'flow' and backend == 'v4'").seconds.item()
    assert names["per_tetra"].notna().all()


def test_they_are_part_of_the_public_face():
    assert (tetrabench.load_results, tetrabench.load_summary) == (load_results, load_summary)
