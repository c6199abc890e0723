"""Names found, names not found, plug-ins that cannot be loaded, names taken twice."""

import os
import re
import subprocess
import sys

import pytest

from tetrabench import registry
from tetrabench.bench.catalogue import Inquiry
from tetrabench.bench.messages import Find
from tetrabench.errors import InputError, PluginWarning

FAMILY = "[tetrabench.families]\n{name} = {module}:FAMILY\n"


@pytest.mark.usefixtures("plugin")
class TestNames:
    def test_a_plug_in_is_found(self):
        assert "scripted" in [family.name for family in registry.families()]
        assert registry.family("scripted").reference == "steady"
        assert [scenario.name for scenario in registry.scenarios("scripted")] == ["first", "second", "third", "many"]
        assert registry.contestant("scripted", "chatty").title == "scripted"
        assert registry.scenario("scripted", "second").name == "second"
        assert "steady" in [contestant.name for contestant in registry.contestants("scripted")]

    def test_families_do_not_mix(self):
        assert {contestant.family for contestant in registry.contestants("scripted")} == {"scripted"}

    def test_an_unknown_name_gets_the_nearest_one_and_the_list(self):
        with pytest.raises(
            InputError,
            match=r"no backend 'chaty' in the family scripted; did you mean 'chatty'.*there are: steady, other",
        ):
            registry.contestant("scripted", "chaty")
        with pytest.raises(
            InputError, match="no scenario 'zzz' in the family scripted; there are: first, second, third, many"
        ):
            registry.scenario("scripted", "zzz")
        with pytest.raises(InputError, match="no family 'script'; did you mean 'scripted'"):
            registry.contestants("script")

    def test_options_of_a_contestant(self):
        usual = registry.contestant("scripted", "tuned")
        assert {name: option.value for name, option in usual.options.items()} == {"capacity": 8, "recycle": 1}
        chosen = registry.contestant("scripted", "tuned", {"capacity": 16})
        assert {name: option.value for name, option in chosen.options.items()} == {"capacity": 16, "recycle": 1}
        assert (chosen.options["capacity"].least, chosen.options["capacity"].most) == (1, 63)
        assert (chosen.name, type(chosen)) == (usual.name, type(usual))
        assert registry.contestant("scripted", "tuned") is usual  # the table is as it was
        for value in (0, 64):
            with pytest.raises(
                InputError, match=f"tuned: capacity={value} cannot be; it takes 1 to 63: letters that a "
            ):
                registry.contestant("scripted", "tuned", {"capacity": value})
        with pytest.raises(InputError, match="no option of tuned 'capasity'; did you mean 'capacity'"):
            registry.contestant("scripted", "tuned", {"capasity": 8})
        with pytest.raises(InputError, match="no option of steady 'capacity'; there are: none"):
            registry.contestant("scripted", "steady", {"capacity": 8})


def skipped_by(reason):
    """Expect a warning that names a plug-in and what is wrong with it."""
    return pytest.warns(PluginWarning, match=f"skipped plug-in {reason}")


class TestBrokenPlugins:
    """Whatever is wrong with a plug-in, it is named, and the rest of the world goes on."""

    def test_one_that_cannot_be_imported(self, install):
        install(
            "broken",
            FAMILY.format(name="broken", module="broken_module"),
            broken_module="import no_such_thing",
        )
        with skipped_by(r"broken: cannot import broken_module:FAMILY: .*no_such_thing"):
            known = [family.name for family in registry.families()]
        assert "broken" not in known
        assert "tetra" in known
        assert registry.skipped() == [
            "plug-in broken: cannot import broken_module:FAMILY: ModuleNotFoundError: No module named 'no_such_thing'"
            " (broken_module.py:1)"
        ]
        with pytest.raises(InputError, match="the family broken cannot be used"):
            registry.family("broken")

    @pytest.mark.usefixtures("plugin")
    @pytest.mark.parametrize(
        ("table", "reason"),
        [
            ("raise SystemExit('enough')", "cannot import odd_table:CONTESTANTS: SystemExit: enough"),
            ("def broken(:", "cannot import odd_table:CONTESTANTS: SyntaxError"),
            ("CONTESTANTS = 7", "cannot be imported: TypeError: 'int' object is not iterable"),
            ("", "cannot import odd_table:CONTESTANTS: AttributeError"),
            ("CONTESTANTS = [None]", "one of its contestants, a NoneType, is none: AttributeError"),
            ("CONTESTANTS = [One(name='a b')]", "'a b' is no name for one of its contestants"),
            ("CONTESTANTS = [One(name=7)]", "7 is no name for one of its contestants"),
            ("CONTESTANTS = [One(name='mine')]", "mine has no title, trade_off, family, extension, options, is_exact,"),
            (
                "CONTESTANTS = [Full(name='mine', family='tetra')]",
                "mine belongs to the family tetra, and is registered",
            ),
            (
                "CONTESTANTS = [Full(name='mine', options={'a': 7})]",
                "mine has an option 'a' that is none: 7 is no Option",
            ),
            ("CONTESTANTS = [Full(name='mine', options=3)]", "the `options` of mine, 3, cannot be: Expected `object`"),
            ("CONTESTANTS = [Full(name='mine', options={'a b': TWO})]", "the `options` of mine, {'a b': Option("),
            (
                "CONTESTANTS = [Full(name='mine', options={'a': Option(0.5, 0, 1, 'x')})]",
                "the `options` of mine, {'a': Option(value=0.5, least=0, most=1, title='x')}, cannot be: Expected `int`",
            ),
            (
                "CONTESTANTS = [Full(name='mine', options={'a': Option(0, 1, 2, 'x')})]",
                "mine has an option 'a' whose value is beyond its own limits: Option(value=0, least=1",
            ),
            ("CONTESTANTS = [Full(name='mine', title=None)]", "the `title` of mine, None, cannot be: Expected `str`"),
            ("CONTESTANTS = [Full(name='mine', is_exact='no')]", "the `is_exact` of mine, 'no', cannot be: Expected"),
            ("CONTESTANTS = [Full(name='steady')]", "the contestant 'steady' is defined twice; that of "),
        ],
    )
    def test_a_table_that_is_odd(self, install, table, reason):
        head = (
            "from types import SimpleNamespace as One\n"
            "from tetrabench.protocols import Option\n"
            "TWO = Option(1, 0, 2, 'x')\n"
            "class Full(One):\n"
            "    title = trade_off = 'x'\n    family = 'scripted'\n    extension = False\n    options = {}\n"
            "    is_exact = True\n"
        )
        text = "[tetrabench.contestants]\nscripted = odd_table:CONTESTANTS\n"
        sys.modules.pop("odd_table", None)
        install("zodd", text, odd_table=table if "broken" in table else head + table)
        with skipped_by("zodd: " + re.escape(reason)):
            known = registry.contestants("scripted")
        assert "steady" in [one.name for one in known]
        assert not any(type(one).__name__ in ("Full", "One") for one in known)
        assert len(registry.skipped()) == 1

    @pytest.mark.usefixtures("plugin")
    @pytest.mark.parametrize(
        ("group", "fact", "reason"),
        [
            ("scenarios", "thesis={'turns': 0.5}", "the `thesis` of mine, {'turns': 0.5}, cannot be: Expected `int`"),
            ("scenarios", "thesis={'turns': 5}", "mine has counts in `thesis` that are not in its `options`"),
            ("scenarios", "options={'turns': True}", "the `options` of mine, {'turns': True}, cannot be"),
            ("scenarios", "parallel=None", "the `parallel` of mine, None, cannot be"),
            (
                "workloads",
                "mix={'first': 'often'}",
                "the `mix` of mine, {'first': 'often'}, cannot be: Expected `float`",
            ),
            (
                "workloads",
                "mix={'first': -1.0}",
                "the `mix` of mine, {'first': -1.0}, cannot be: Expected `float` >= 0",
            ),
            ("workloads", "mix={'first': float('nan')}", "the `mix` of mine, {'first': nan}, cannot be"),
            ("workloads", "mix=None", "the `mix` of mine, None, cannot be"),
            ("workloads", "title=7; mix={}", "the `title` of mine, 7, cannot be: Expected `str`, got `int`"),
            ("workloads", "", "mine has no mix, which all workloads have"),
        ],
    )
    def test_a_fact_of_a_wrong_type(self, install, group, fact, reason):
        base = "scripted_plugin.Scenario" if group == "scenarios" else "object"
        table = (
            f"import scripted_plugin\nclass One({base}):\n    name = title = 'mine'\n    family = 'scripted'\n    {fact}\n"
            "TABLE = [One.__new__(One)]\n"
        )
        sys.modules.pop("odd_fact", None)
        install("zodd", f"[tetrabench.{group}]\nscripted = odd_fact:TABLE\n", odd_fact=table)
        with skipped_by("zodd: " + re.escape(reason)):
            known = getattr(registry, group)("scripted")
        assert len(known) == (4 if group == "scenarios" else 0)

    @pytest.mark.usefixtures("plugin")
    def test_a_source_that_cannot_be_imported(self, install):
        install("zodd", "[tetrabench.sources]\nscripted = no_such_source:SOURCE\n")
        with pytest.raises(InputError, match="the source of the family scripted: plug-in zodd: cannot import no_such"):
            registry.source("scripted")

    @pytest.mark.usefixtures("plugin")
    def test_a_sound_member_beside_a_broken_one(self, install):
        members = "[None, Contestant('sound'), Contestant('')]"
        table = f"from scripted_plugin import Contestant\nCONTESTANTS = {members}\n"
        sys.modules.pop("half_table", None)
        install("half", "[tetrabench.contestants]\nscripted = half_table:CONTESTANTS\n", half_table=table)
        with pytest.warns(PluginWarning) as warned:
            assert registry.contestant("scripted", "sound").name == "sound"
        assert len(warned) == 2

    @pytest.mark.usefixtures("plugin")
    def test_a_table_of_no_family(self, install):
        install("lost_plugin", "[tetrabench.contestants]\nmine = lost:CONTESTANTS\n", lost="CONTESTANTS = []")
        with skipped_by("lost_plugin: 'mine' in tetrabench.contestants is no family"):
            assert registry.contestants("scripted")

    def test_a_name_taken_twice_names_both_distributions(self, install):
        table = "from types import SimpleNamespace\nFAMILY = SimpleNamespace(name='twin')\n"
        install("plugin_one", FAMILY.format(name="twin", module="twin_one"), twin_one=table)
        install("plugin_two", FAMILY.format(name="twin", module="twin_two"), twin_two=table)
        with skipped_by("plugin_two: the family 'twin' is defined twice; that of plugin_one is taken"):
            registry.scenarios("tetra")

    def test_what_is_wrong_with_ours_is_no_matter_of_plug_ins(self, install):
        install("tetrabench", "[tetrabench.families]\ntoo = no_such_module:FAMILY\n")
        with pytest.raises(InputError, match="plug-in tetrabench: cannot import no_such_module"):
            registry.families()


@pytest.fixture
def write_plugin(tmp_path, monkeypatch):
    """write_plugin(text): a plug-in file of that text, named to this process and its workers."""

    def write(text, name="mine.py"):
        path = tmp_path / name
        path.write_text(text)
        monkeypatch.setenv("TETRABENCH_PLUGINS", str(path), prepend=os.pathsep)
        registry.forget()
        return path

    yield write
    monkeypatch.undo()
    registry.forget()


MINE = """
import dataclasses
from tetrabench import registry
from tetrabench.backends.tetra import CONTESTANTS as THEIRS
from tetrabench.mesh.models.box import BOX
from tetrabench.scenarios.tetra.alfa import Alfa

class Mine(Alfa):
    name = "mine-alfa"

CONTESTANTS = [dataclasses.replace(one, name=f"my-{one.name}") for one in THEIRS[:1]]
SCENARIOS = [Mine()]
MODELS = [dataclasses.replace(BOX, name="my-box")]
"""


class TestFiles:
    def test_its_tables_are_found(self, write_plugin, tmp_path):
        write_plugin(MINE)
        assert registry.contestant("tetra", "my-v3").title == registry.contestant("tetra", "v3").title
        assert registry.scenario("tetra", "mine-alfa").options == {"sweeps": 50}
        assert "my-v3" not in [one.name for one in registry.contestants("polygon")]
        family = registry.family("tetra")
        assert family.models["my-box"] == family.models["box"]
        one, other = (family.find_model(name, size=400, numbering="natural", seed=0) for name in ("my-box", "box"))
        assert one.read_text().replace("my-box", "box") == other.read_text()

    def test_a_model_is_made_anew_when_its_file_changes(self, write_plugin):
        text = MINE.replace("BOX, name", "BOX, build=lambda tets: BOX.build(tets), name")
        before = write_plugin(text)
        family = registry.family("tetra")
        first = family.find_model("my-box", size=400, numbering="natural", seed=0)
        before.write_text(text + "# another\n")
        assert family.find_model("my-box", size=400, numbering="natural", seed=0) == first  # seen once in a process
        code = (
            "from tetrabench import registry; family = registry.family('tetra');"
            "print(family.find_model('my-box', size=400, numbering='natural', seed=0))"
        )
        done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
        assert done.stdout.strip() != str(first)

    def test_a_model_is_made_anew_when_a_file_changes_that_its_maker_takes_things_from(self, write_plugin, monkeypatch):
        folder = write_plugin("x = 1", "helper_of_mine.py").parent
        text = MINE.replace("BOX, name", "BOX, build=make, name")
        head = "import helper_of_mine\ndef make(tets):\n    return helper_of_mine.make(tets)\n"
        monkeypatch.setenv("TETRABENCH_PLUGINS", str(write_plugin(head + text)))
        found = []
        for size in ("tets", "2 * tets"):
            helper = f"from tetrabench.mesh.models.box import BOX\ndef make(tets):\n    return BOX.build({size})\n"
            (folder / "helper_of_mine.py").write_text(helper)
            code = (
                "from tetrabench import registry; family = registry.family('tetra');"
                "path = family.find_model('my-box', size=400, numbering='natural', seed=0);"
                "print(path, family.describe_model(path).size['tetras'])"
            )
            done = subprocess.run(
                [sys.executable, "-B", "-c", code],
                capture_output=True,
                text=True,
                check=True,
                env=os.environ | {"PYTHONPATH": str(folder)},
            )
            found.append(done.stdout.split())
        assert [tetras for _, tetras in found] == ["384", "810"]
        assert found[0][0] != found[1][0]

    @pytest.mark.parametrize(
        ("text", "reason"),
        [
            ("1/0", "cannot be imported: ZeroDivisionError: division by zero"),
            ("raise SystemExit", "cannot be imported: SystemExit"),
            ("\0", "cannot be imported: "),
            (
                MINE.replace("[dataclasses", "(dataclasses", 1).replace("[:1]]", "[:1])"),
                "a table of it is a generator, which can be read but once; make it a tuple",
            ),
            ("THINGS = []", "has none of the tables FAMILIES, CONTESTANTS, SCENARIOS, MODELS"),
            ("class One:\n    name = title = 'mine'\nMODELS = [One()]", "mine does not say its family"),
            (
                "class One:\n    name = title = 'mine'\n    family = 'tetras'\nMODELS = [One()]",
                "mine is of no family 'tetras'; there are: ",
            ),
            (
                MINE.replace("[Mine()]", "[Mine]"),
                "the class Mine is one of its scenarios; a table holds objects: Mine()",
            ),
            (
                "class One:\n    name = title = 'mine'\n    family = 'tetra'\nMODELS = [One()]",
                "the model mine: a One, not a tetrabench.mesh.models.model.Model",
            ),
            (MINE.replace("my-box", "box"), "the model 'box' is defined twice; that of tetrabench is taken"),
        ],
    )
    def test_a_broken_one_is_named_and_skipped(self, write_plugin, text, reason):
        write_plugin(text)
        with skipped_by("mine.py: " + re.escape(reason)):
            assert "v3" in [one.name for one in registry.contestants("tetra")]
            registry.scenarios("tetra")
            registry.family("tetra")

    def test_one_that_is_not_there(self, write_plugin):
        write_plugin("").unlink()
        with skipped_by("mine.py: there is no file "):
            registry.family("tetra")

    def test_a_worker_knows_it_too_and_says_what_is_skipped_once(self, write_plugin, capfd):
        write_plugin(MINE)
        write_plugin("1/0", "other.py")
        with Inquiry() as guide:
            with skipped_by("other.py: cannot be imported: ZeroDivisionError"):
                described = guide.describe("tetra")
            assert "my-v3" in [one.name for one in described.contestants]
            found = guide.find_model(Find("tetra", "my-box", 400))
        assert found.size["tetras"] == 384
        assert capfd.readouterr().err == ""
