"""Names found, names not found, plug-ins that cannot be loaded, names taken twice."""

import pytest

from tetrabench import registry
from tetrabench.errors import InputError

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

    def test_a_table_of_no_family_is_an_error(self, install):
        install("lost_plugin", "[tetrabench.contestants]\nmine = lost:CONTESTANTS\n", lost="CONTESTANTS = []")
        with pytest.raises(InputError, match=r"plug-in lost_plugin: 'mine' in tetrabench.contestants is no family"):
            registry.contestants("scripted")

    def test_two_contestants_of_one_name(self, install):
        table = "from types import SimpleNamespace\nCONTESTANTS = [SimpleNamespace(name='steady')]\n"
        install("rival", "[tetrabench.contestants]\nscripted = rival_table:CONTESTANTS\n", rival_table=table)
        with pytest.raises(InputError, match="'steady' is defined twice, by rival and by scripted"):
            registry.contestant("scripted", "chatty")

    def test_an_unknown_name_gets_the_nearest_one_and_the_list(self):
        with pytest.raises(InputError, match=r"no backend 'chaty'; did you mean 'chatty'.*there are: steady, other"):
            registry.contestant("scripted", "chaty")
        with pytest.raises(InputError, match="no scenario 'zzz'; there are: first, second, third, many"):
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


def test_a_plug_in_that_cannot_be_imported_is_named(install):
    install(
        "broken_plugin",
        FAMILY.format(name="broken", module="broken_module"),
        broken_module="import no_such_thing",
    )
    with pytest.raises(InputError, match=r"plug-in broken_plugin: cannot import broken_module:FAMILY: .*no_such_thing"):
        registry.family("broken")


def test_a_name_taken_twice_names_both_distributions(install):
    table = "from types import SimpleNamespace\nFAMILY = SimpleNamespace(name='twin')\n"
    install("plugin_one", FAMILY.format(name="twin", module="twin_one"), twin_one=table)
    install("plugin_two", FAMILY.format(name="twin", module="twin_two"), twin_two=table)
    with pytest.raises(InputError, match="'twin' is defined twice, by plugin_one and by plugin_two"):
        registry.family("twin")
