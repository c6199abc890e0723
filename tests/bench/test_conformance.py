"""check --contestant: crashes, endless loops and what cannot be compiled become sentences; answers are compared."""

import json
import re
from pathlib import Path

import msgspec
import pytest
from click.testing import CliRunner
from numba import config

from tests.examined import environment
from tetrabench.bench.catalogue import Inquiry
from tetrabench.bench.conformance import CHECKED, COMPILED, FAULTY, NOT_TRIED, PLAIN, SOUND, check_contestant, examine
from tetrabench.bench.examination import faults_of, noted, place_of
from tetrabench.bench.spawn import WorkerProcess
from tetrabench.cli import main
from tetrabench.errors import InputError
from tetrabench.protocols import Rule

BROKEN = Path(__file__).parents[1] / "polygon" / "broken.py"
STUBBORN = """
from dataclasses import replace
from tests.broken import broken_type
from tetrabench.backends.polygon import FORMATS
from tetrabench.backends.polygon.tables import Tables
from tetrabench.polygon import interface

def stubborn(good):
    def number_of_cells(storage):
        return len(f"{storage.cell_starts.tolist()!r}".split(",")) - 1
    return number_of_cells

made = broken_type(Tables, {interface.number_of_cells: stubborn})
CONTESTANTS = [replace(FORMATS["tables"], name="stubborn", build=lambda links: made(*FORMATS["tables"].build(links)))]
"""


def say(*words):
    return CliRunner().invoke(main, [str(word) for word in words])


@pytest.fixture
def use(monkeypatch):
    """use(path): a plug-in file, for this process and for workers."""
    from tetrabench import registry

    def use(path):
        for name, value in environment(path).items():
            monkeypatch.setenv(name, value)
        registry.forget()

    yield use
    registry.forget()


def examined(family, name, **more):
    """Faults by rule, and statuses by rule and mode."""
    with Inquiry() as guide:
        verdicts = list(examine(family, name, guide=guide, **more))
    assert all((verdict.status == FAULTY) == bool(verdict.faults) for verdict in verdicts)
    faults = {verdict.rule: verdict.faults for verdict in verdicts if verdict.faults}
    return faults, {(verdict.rule, verdict.mode): verdict.status for verdict in verdicts}


def test_a_crash_is_a_sentence_and_the_rules_behind_it_are_tried(use):
    use(BROKEN)
    faults, statuses = examined("polygon", "crashing")
    assert set(faults) == {"node-cells", "beginnings"}
    assert faults["node-cells"][0].startswith(
        "rule node-cells: the process ended with signal 11 (Segmentation fault) in node_cells (broken.py:"
    )
    assert statuses["node-star", PLAIN] == statuses["cell-nodes", PLAIN] == SOUND
    rest = {status for (_, mode), status in statuses.items() if mode in (CHECKED, COMPILED)}
    assert rest == {NOT_TRIED}


def test_an_endless_loop_is_a_sentence(use, monkeypatch):
    use(BROKEN)
    rules = ("cell-nodes",)
    with Inquiry() as guide:
        known = guide.describe("polygon")

    class Guide:
        def describe(self, family):
            return type(known)(**{f: getattr(known, f) for f in known.__struct_fields__} | {"rules": chosen})

    chosen = [rule for rule in known.rules if rule.name in rules]
    first, *rest = examine("polygon", "endless", guide=Guide(), timeout_s=12)
    assert first.faults[0].startswith("rule cell-nodes: it does not come to an end in cell_nodes (broken.py:")
    assert {verdict.status for verdict in rest} == {NOT_TRIED}


def test_nothing_else_is_asked_of_what_is_not_complete(use):
    use(BROKEN)
    faults, statuses = examined("polygon", "half")
    assert list(faults) == ["complete"]
    assert sorted(set(statuses.values())) == [FAULTY, NOT_TRIED]


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="compiles, which this environment is not for")
def test_what_cannot_be_compiled_is_said_in_a_line(use, tmp_path):
    path = tmp_path / "stubborn.py"
    path.write_text(STUBBORN)
    use(path)
    faults, statuses = examined("polygon", "stubborn")
    assert {mode for (_, mode), status in statuses.items() if status == FAULTY} == {CHECKED}
    assert list(faults) == ["counts"]
    [sentence] = faults["counts"]
    assert "\n" not in sentence
    assert sentence.startswith("number_of_cells: it cannot be compiled: ")
    assert sentence.endswith("(stubborn.py:10)")
    assert "f-string" in sentence


@pytest.mark.usefixtures("plugin")
def test_answers_are_compared_with_those_of_the_reference():
    faults, statuses = examined("scripted", "wrong")
    assert faults == {
        "scenario second": ["digest of scenario second on the small model is bad0, that of steady 20"],
    }
    assert statuses["scenario first", COMPILED] == SOUND
    faults, _ = examined("scripted", "crashing-small")
    assert faults == {
        "scenario second": ["scenario second: the process ended with signal 11 (Segmentation fault)"],
    }
    faults, statuses = examined("scripted", "lazy")
    assert faults == {}
    assert statuses["scenario second", COMPILED] == NOT_TRIED


@pytest.mark.usefixtures("plugin")
def test_what_could_not_be_compared_is_said():
    done = say("check", "--contestant", "lazy", "--family", "scripted")
    assert done.exit_code == 0
    *_, why, last = done.stdout.splitlines()
    assert why.startswith("scenario second, not compared: ")
    assert re.fullmatch(r"lazy does what is asked of it \(\d+ s\); 1 of 4 scenarios were not compared", last)

    with Inquiry() as guide:
        known = guide.describe("scripted")

    class Guide:
        def describe(self, family):
            return msgspec.structs.replace(known, reference="crashing-small")

    [odd] = [one for one in examine("scripted", "other", guide=Guide()) if one.status != SOUND]
    assert (odd.rule, odd.status, odd.faults) == ("scenario second", NOT_TRIED, [])
    assert odd.note.startswith(
        "crashing-small, which tells what is right, has no answer: the process ended with signal"
    )


@pytest.mark.usefixtures("plugin")
def test_whoever_gives_up_does_not_wait_for_what_does_not_end(monkeypatch):
    ends = []

    def note(name):
        usual = getattr(WorkerProcess, name)
        monkeypatch.setattr(WorkerProcess, name, lambda worker: (ends.append(name), usual(worker)))

    def interrupt(phase, detail, done, total):
        if detail == "second":
            raise KeyboardInterrupt

    with Inquiry() as guide:
        note("close")
        note("kill")
        with pytest.raises(KeyboardInterrupt):
            list(examine("scripted", "other", guide=guide, step=interrupt))
        assert ends == ["kill"] * 2
        ends.clear()
        list(examine("scripted", "other", guide=guide))
        assert ends == ["close", "kill"] * 2


def test_a_rule_has_five_minutes_unless_somebody_says_otherwise(monkeypatch):
    given = []
    monkeypatch.setattr(
        "tetrabench.bench.conformance.examine", lambda *_, timeout_s, **__: given.append(timeout_s) or ()
    )
    for words in ((), ("--timeout", "20s"), ("--timeout", "1h")):
        say("check", "--contestant", "by-node", "--family", "polygon", *words)
    assert given == [300.0, 20.0, 3600.0]


@pytest.mark.usefixtures("plugin")
def test_the_library_asks_in_workers_too():
    verdicts = check_contestant("other", family="scripted")
    assert [verdict.rule for verdict in verdicts] == [f"scenario {n}" for n in ("first", "second", "third", "many")]
    assert {verdict.status for verdict in verdicts} == {SOUND}
    with pytest.raises(InputError, match="no backend 'nobody'"):
        check_contestant("nobody", family="scripted")


def test_the_verb_says_what_is_wrong(use):
    use(BROKEN)
    done = say("check", "--contestant", "one-condition", "--family", "polygon")
    assert done.exit_code == 3
    assert "cell-neighbours, plain Python: squares around a hole: cell_neighbours(" in done.stdout
    assert done.stdout.splitlines()[-1].startswith("one-condition: faults in 2 rules; ")
    assert "one-condition, plain Python: complete" in done.stderr
    told = json.loads(say("check", "--contestant", "half", "--family", "polygon", "--format", "json").stdout)
    assert {verdict["status"] for verdict in told} == {FAULTY, NOT_TRIED}


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--model", "box"], "leave out --model"),
        (["--tets", "100"], "leave out --tets"),
        (["--backend", "v3"], "leave out --backend"),
        (["--seed", "3"], "leave out --seed"),
        (["--format", "csv"], "--format table or json"),
        (["--family", "hexa"], "no family 'hexa'"),
    ],
)
def test_what_does_not_go_with_it_is_refused(words, told):
    done = say("check", "--contestant", "v3", *words)
    assert done.exit_code == 2
    assert done.stdout == ""
    assert told in done.stderr
    assert done.stderr.count("\n") == 1


class Rules:
    """A family with one rule, which does as it is told."""

    name = "made"

    def __init__(self, faults):
        self.rules = (Rule("only", "all is well", faults),)


def test_exceptions_are_sentences_and_no_more_than_some_are_told():
    def raising(contestant):
        yield "first"
        raise SystemExit("over\nand out")

    [first, second] = faults_of(Rules(raising), None, "only")
    assert first == "first"
    assert second.startswith("raising: SystemExit: over (test_conformance.py:")
    assert faults_of(Rules(lambda _: (f"{n}" for n in iter(int, 1))), None, "only") == ["0"] * 5
    with pytest.raises(InputError, match="no rule 'other'"):
        faults_of(Rules(raising), None, "other")


def test_a_name_that_is_not_there_is_said_before_any_is_examined(monkeypatch):
    monkeypatch.setattr("tetrabench.bench.conformance.examine", lambda *_, **__: pytest.fail("it was examined"))
    done = say("check", "--contestant", "by-node,nobody", "--family", "polygon")
    assert done.exit_code == 2
    assert "no backend 'nobody' in the family polygon; there are: by-node" in done.stderr


def test_notes_that_were_not_taken_say_nothing(tmp_path):
    notes = tmp_path / "notes"
    assert place_of(notes) == ""
    with noted(notes, 60):
        pass
    assert place_of(notes) == ""
