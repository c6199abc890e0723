"""The verbs, as a person meets them: what is printed where, exit codes, and no traceback."""

import json
import re
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest
from click.testing import CliRunner, Result

import tetrabench
from tests.report.made import change, make_results
from tetrabench.bench import save_results
from tetrabench.bench.record import Results
from tetrabench.cli import main
from tetrabench.protocols import Option
from tetrabench.report.formats import FORMATS
from tetrabench.report.table import as_markdown, as_text


def say(*words: object) -> Result:
    """What the command line answers."""
    return CliRunner().invoke(main, [str(word) for word in words])


def refusal(*words: object) -> str:
    """The one line with which bad input is refused."""
    result = say(*words)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr.startswith("tetrabench: ")
    assert result.stderr.count("\n") == 1
    return result.stderr


@pytest.fixture
def no_measuring(monkeypatch: pytest.MonkeyPatch):
    """Let `run` make its plan, and take these results for what was measured."""

    def let(results: Results) -> list:
        plans = []

        def run_benchmark(plan, *, progress, **_):
            plans.append(plan)
            progress.started(plan)
            progress.step("compiling", "alfa for v3y", 1, 2, None)
            progress.step("compiling", "flow for v3y", 2, 2, None)
            progress.step("launch 1 of 8", "alfa, v3y, round 1", 0, 2, None)
            progress.step("launch 1 of 8", "alfa, v3y, round 2", 1, 2, 4.0)
            progress.step("launch 2 of 8", "alfa, v3y, round 1", 1, 2, 65.0)
            return results

        monkeypatch.setattr("tetrabench.bench.run_benchmark", run_benchmark)
        return plans

    return let


RUN = ("run", "--model", "box", "--tets", "400")


def test_version_and_help():
    assert say("--version").stdout.strip() == f"tetrabench {tetrabench.__version__}"
    for verb in ("run", "show", "list", "generate"):
        assert verb in say("--help").stdout
        assert say(verb, "--help").exit_code == 0


@pytest.mark.parametrize(
    ("words", "answer"),
    [
        (["list", "colours"], "'colours' is not one of 'backends'"),
        (["run", "--model", "box", "--tets", "lots"], "100k"),
        (["run", "--modle", "box"], "Did you mean"),
        (["rnu", "--model", "box"], "no verb 'rnu'; did you mean 'run'?"),
    ],
)
def test_wrong_usage_is_one_line_and_2(words: list[str], answer: str):
    assert answer in refusal(*words)


def test_no_words_show_the_help():
    assert "Commands:" in say().stderr


def test_a_file_of_no_known_format_is_refused_before_the_work(tmp_path: Path):
    (tmp_path / "mesh.xyz").write_text("x")
    assert "'.xyz' names no known format" in refusal("run", "--model", tmp_path / "mesh.xyz")


# ---------------------------------------------------------------------- refusals


def test_a_model_of_another_family_says_of_which():
    assert "quad is a model of another family: add --family polygon" in refusal("run", "--model", "quad", "--dry-run")
    assert "add --family tetra" in refusal("run", "--family", "polygon", "--model", "nozzle", "--dry-run")


def test_a_file_of_another_family_is_sent_there(tmp_path):
    table = tmp_path / "start.csv"
    table.write_text("x,y\n1,2\n")
    assert "is a file of another family: add --family collision" in refusal("run", "--model", str(table), "--dry-run")


def test_missing_model_says_how_to_get_one(tmp_path: Path):
    assert "tetrabench generate nozzle" in refusal("run", "--model", tmp_path / "nozzle.nas")
    assert "no such file" in refusal("run", "--model", tmp_path / "other.nas")


def test_unknown_names_are_answered_with_the_nearest():
    assert "did you mean 'v3y'?" in refusal(*RUN, "--backend", "v3,v3yy")
    assert "did you mean 'explode'?" in refusal(*RUN, "--scenario", "exploed")
    assert "there are: collision, polygon, tetra" in refusal(*RUN, "--family", "tetras")
    assert "did you mean 'nozzle'?" in refusal("generate", "nozle", "-o", "nozzle.nas")


def test_bad_results_are_refused(tmp_path: Path):
    assert "cannot read" in refusal("show", tmp_path / "nothing.json")
    (tmp_path / "bad.json").write_text("{")
    assert "no results" in refusal("show", tmp_path / "bad.json")


def test_folder_for_the_results_is_looked_for_before_the_run(tmp_path: Path):
    result = say(*RUN, "-o", tmp_path / "nowhere" / "out.json")
    assert result.exit_code == 2
    assert "nowhere" in result.stderr


# ---------------------------------------------------------------------- run, made results


def test_options_reach_the_plan(no_measuring):
    plans = no_measuring(make_results())
    words = (
        *("--backend", "v3y,v4", "--backend", "v5", "--scenario", "flow, alfa", "--option", "alfa.sweeps=3,5"),
        *("--launches", "4", "--rounds", "2", "--seed", "7", "--budget", "10m", "--timeout", "30"),
    )
    say(*RUN, *words)
    (plan,) = plans
    assert [backend.name for backend in plan.backends] == ["v3y", "v4", "v5", "v3y control"]
    assert [task.name for task in plan.tasks] == ["flow", "alfa sweeps=3", "alfa sweeps=5"]
    assert [task.options["sweeps"] for task in plan.tasks[1:]] == [3, 5]
    assert (plan.effort.launches, plan.effort.rounds, plan.seed, plan.profile) == (4, 2, 7, "default")
    assert (plan.budget_s, plan.timeout_s) == (600.0, 30.0)
    for profile in ("thesis", "quick", "rigorous"):
        say(*RUN, f"--{profile}")
        assert plans[-1].profile == profile
    say("run", "--model", "box", "--tets", "300,1k")
    assert list(plans[-1].models) == ["box-300", "box-1000"]


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--quick", "--rigorous"], "--quick and --rigorous: choose one"),
        (["--resume"], "--resume goes on with the run to -o FILE.json"),
        (["--budget", "soon"], "'soon' is no time such as"),
        (["--timeout", "0"], "'0' is no time such as"),
        (["--option", "sweeps"], "write NAME=1,2,3"),
        (["--option", "alfa.sweeps=0"], "counts are 1 at least"),
        (["--option", "alfa.sleeps=3"], "no option 'alfa.sleeps'; did you mean 'alfa.sweeps'? there are: "),
        (["--launches", "0"], "launches: 0; at least one"),
        (["--thesis", "--rounds", "2"], "the thesis profile has one"),
    ],
)
def test_choices_that_cannot_be_taken(no_measuring, words: list[str], reason: str):
    plans = no_measuring(make_results())
    result = say(*RUN, *words)
    assert result.exit_code == 2
    assert reason in result.stderr
    assert result.stderr.count("\n") == 1
    assert not plans


def test_dry_run_says_what_and_does_nothing(no_measuring):
    plans = no_measuring(make_results())
    result = say(*RUN, "--scenario", "alfa,flow", "--backend", "v3y,v4", "--dry-run")
    assert result.exit_code == 0
    assert "8 launches of 3 rounds, at most 144 samples" in result.stdout
    assert "v3y, v4, v3y control" in result.stdout
    assert not plans


def test_table_on_stdout_and_the_rest_on_stderr(no_measuring, tmp_path: Path):
    results = make_results()
    no_measuring(results)
    output = tmp_path / "out.json"
    result = say(*RUN, "--scenario", "alfa,flow", "-o", output, "--charts", tmp_path / "charts")
    assert result.exit_code == 0
    assert result.stdout == as_text(results)
    written = [output, tmp_path / "charts" / "times.png", tmp_path / "charts" / "memory.png"]
    assert all(f"wrote {path}" in result.stderr for path in written)
    assert all(path.is_file() for path in written[1:])


def test_no_terminal_nothing_animated(no_measuring):
    no_measuring(make_results())
    result = say(*RUN, "--scenario", "alfa,flow", "--backend", "v3y")
    assert not set("\r\x1b") & set(result.output)
    assert [line for line in result.stderr.splitlines() if line] == [  # rich before 14.3 ends with an empty one
        "box: 2 tasks on v3y; 8 launches of 3 rounds at most",
        "compiling: alfa for v3y",
        "launch 1 of 8: alfa, v3y, round 1",
        "launch 2 of 8: alfa, v3y, round 1 (1 of 2 done, 1:05 left)",
    ]


def test_wrong_answers_are_3_and_shown(no_measuring):
    no_measuring(change(make_results(), "alfa", "v4", status="wrong-result", reason="v4 says 1, most say 2"))
    result = say(*RUN)
    assert result.exit_code == 3
    assert "v4 says 1, most say 2" in result.stdout


def test_interrupted_is_130_and_says_how_to_go_on(no_measuring, tmp_path: Path):
    no_measuring(make_results(ended="interrupted"))
    result = say(*RUN, "-o", tmp_path / "out.json")
    assert result.exit_code == 130
    assert f"go on with --resume -o {tmp_path / 'out.json'}" in result.stderr
    assert "no results are kept without -o" in say(*RUN).stderr


def test_check_says_right_or_wrong_and_no_times(no_measuring):
    results = make_results(profile="check")
    plans = no_measuring(change(results, "alfa", "v4", status="wrong-result", reason="v4 says 1, most say 2"))
    result = say("check", "--model", "box", "--tets", "300")
    assert plans[0].profile == "check"
    assert result.exit_code == 3
    assert re.search(r"^alfa +agrees +agrees +agrees +wrong", result.stdout, re.MULTILINE)
    assert "v4 says 1, most say 2" in result.stdout
    assert not re.search(r"\d+ ms", result.stdout)


def test_interrupted_before_anything_is_130(monkeypatch):
    def interrupt(*args, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr("tetrabench.bench.make_plan", interrupt)
    result = say(*RUN)
    assert (result.exit_code, result.stderr) == (130, "tetrabench: interrupted\n")


def test_show_says_what_run_said(tmp_path: Path):
    results = make_results()
    path = tmp_path / "out.json"
    save_results(results, path)
    assert say("show", path).stdout == as_text(results)
    assert say("show", path, "--format", "md").stdout == as_markdown(results)
    assert say("show", path, "--intervals").stdout == as_text(results, intervals=True)
    assert say("show", path, "--intervals", "--format", "md").stdout == as_markdown(results, intervals=True)
    for name in ("json", "csv", "github", "pyperf"):
        assert say("show", path, "--format", name).stdout == FORMATS[name](results)
    result = say("show", path, "--charts", tmp_path, "--chart-format", "svg")
    assert result.exit_code == 0
    assert (tmp_path / "times.svg").is_file()


# ---------------------------------------------------------------------- list, generate


def test_lists():
    backends = say("list", "backends").stdout
    for name in ("v3", "v3x", "v3y", "v4", "v5", "v5x", "v5y"):
        assert re.search(rf"^{name} ", backends, re.MULTILINE)
    assert "property arrays, flag + list" in backends
    assert "sweeps 50 (thesis 200)" in say("list", "scenarios").stdout
    assert re.search(r"^nozzle ", say("list", "models").stdout, re.MULTILINE)


def test_options_of_backends_are_listed_with_their_limits(monkeypatch: pytest.MonkeyPatch):
    facts = {"title": "buckets", "trade_off": "none", "extension": False}
    options = {"capacity": Option(8, 1, 63, "objects that a leaf holds")}
    known = [
        SimpleNamespace(name="tree", options=options, is_exact=True, **facts),
        SimpleNamespace(name="leaf", options={}, is_exact=False, **facts),
    ]
    monkeypatch.setattr("tetrabench.registry.contestants", lambda family: known)
    said = say("list", "backends").stdout
    assert re.search(r"^tree.capacity +8 +1 to 63 +objects that a leaf holds$", said, re.MULTILINE)
    assert "leaf is known to give wrong answers: it takes part where --backend names it" in said
    monkeypatch.setattr("tetrabench.registry.contestants", lambda family: known[1:])
    assert "--option" not in say("list", "backends").stdout


def test_sizes_are_told_in_what_the_family_counts(no_measuring):
    plans = no_measuring(make_results())
    say("run", "--model", "box", "--tets", "300,1k")
    assert list(plans[-1].models) == ["box-300", "box-1000"]
    say("run", "--family", "collision", "--objects", "5,50k,100k")
    assert list(plans[-1].models) == ["uniform-5", "uniform-50000", "uniform-100000"]
    told = refusal("run", "--objects", "300", "--dry-run")
    assert "--objects: models of the family tetra are counted in --tets; say that, or name another --family" in told
    assert "--tets and --objects: choose one" in refusal("run", "--tets", 3, "--objects", 3)


def test_generate_writes_a_mesh_and_states_its_quality(tmp_path: Path):
    first, second = tmp_path / "a.nas", tmp_path / "b.nas"
    result = say("generate", "box", "--tets", "0.4k", "--seed", 3, "-o", first)
    assert result.exit_code == 0
    assert re.search(r"384 tets, 125 points.* smallest dihedral angle \d+\.\d degrees", result.stdout)
    assert f"wrote {first}" in result.stderr
    say("generate", "box", "--tets", "400", "--seed", 3, "-o", second)
    assert first.read_bytes() == second.read_bytes()
    say("generate", "box", "--tets", "400", "--seed", 3, "--numbering", "shuffled", "-o", second)
    assert first.read_bytes() != second.read_bytes()


# ---------------------------------------------------------------------- real processes


def in_process(*words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, *words], capture_output=True, text=True, check=False)


@pytest.mark.parametrize("module", ["numba", "numpy", "matplotlib", "pandas"])
def test_help_and_the_public_face_are_light(module: str):
    for code in (
        "import tetrabench, tetrabench.cli",
        "from tetrabench.cli import main; main(['--help'], standalone_mode=False)",
    ):
        assert in_process("-c", f"{code}; import sys; assert {module!r} not in sys.modules").returncode == 0


def test_a_whole_run_in_a_process_of_its_own(tmp_path: Path):
    output = tmp_path / "out.json"
    words = (*RUN, "--backend", "v3y,v5y", "--scenario", "alfa,free", "--quick", "-o", str(output))
    done = in_process("-m", "tetrabench", *words)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "Both contestants gave the same answers: 2 scenarios, one digest each." in done.stdout
    assert not set("\r\x1b") & set(done.stdout + done.stderr)
    assert [model["name"] for model in json.loads(output.read_bytes())["models"]] == ["box"]
    frame = tetrabench.load_results(output)
    assert set(frame.status) == {"ok"}
    assert len(frame) == 2 * 3 * 9
    assert frame.groupby("task").digest.nunique().eq(1).all()


def test_bad_input_in_a_process_of_its_own():
    done = in_process("-m", "tetrabench", "run", "--model", "nowhere.nas")
    assert done.returncode == 2
    assert "Traceback" not in done.stderr


# ---------------------------------------------------------------------- the public face


def test_public_face():
    assert all(getattr(tetrabench, name) is not None for name in tetrabench.__all__)
    assert set(tetrabench.__all__) <= set(dir(tetrabench))
    with pytest.raises(AttributeError, match="no attribute 'nonsense'"):
        tetrabench.nonsense  # noqa: B018


def test_open_takes_a_mesh_or_a_file(tmp_path: Path):
    mesh = tetrabench.generate("box", 48)
    tetrabench.write_mesh(mesh, tmp_path / "box.nas")
    assert len(tetrabench.open(mesh)) == 48
    assert tetrabench.open(tmp_path / "box.nas", backend="v4").contestant.name == "v4"
