"""Families, contestants, scenarios, models and workloads by name, ours like anybody's.

They come from explicit tables: see `tetrabench.plugins`, which also says what becomes of broken ones. Only the tables of
the family that is asked for are imported, from files all.
"""

import dataclasses
import functools
from collections.abc import Iterator, Mapping
from typing import Any

from tetrabench import plugins
from tetrabench.errors import InputError, find_named
from tetrabench.plugins import OURS, PluginError, Table
from tetrabench.protocols import Contestant, Family, Option, Options, Scenario, Workload
from tetrabench.sources import Source


def families() -> list[Family]:
    """All families, with the models of plug-ins."""
    return [found for name in list(_families()) if (found := _family(name))]


def family(name: str) -> Family:
    """One family, with the models of plug-ins.

    Raises:
        InputError: there is none of that name.
    """
    find_named("family", _families(), name)
    found = _family(name)
    if found is None:
        raise InputError(f"the family {name} cannot be used; what is wrong with its plug-in was said before")
    return found


def contestants(family_name: str) -> list[Contestant]:
    """All contestants of a family, in the order of their tables.

    Raises:
        InputError: there is no such family.
    """
    return list(_members("contestants", family_name).values())


def contestant(family_name: str, name: str, options: Options | None = None) -> Contestant:
    """One contestant; `options` are values that are chosen about it, by name, instead of its own.

    Raises:
        InputError: there is no such family, or none of that name in it; as `choose_options`.
    """
    found = _find("backend", "contestants", family_name, name)
    chosen: Contestant = (
        dataclasses.replace(found, options=choose_options(name, found.options, options)) if options else found
    )
    return chosen


def choose_options(owner: str, known: Mapping[str, Option], values: Options) -> dict[str, Option]:
    """The options of a contestant, `owner`, with these values instead of their own.

    Raises:
        InputError: it has no such option, or the value is beyond the option's limits.
    """
    for name, value in values.items():
        option = find_named(f"option of {owner}", known, name)
        if not option.least <= value <= option.most:
            limits = f"{option.least} to {option.most}"
            raise InputError(f"{owner}: {name}={value} cannot be; it takes {limits}: {option.title}")
    return {name: dataclasses.replace(option, value=values.get(name, option.value)) for name, option in known.items()}


def scenarios(family_name: str) -> list[Scenario]:
    """All scenarios of a family, in the order of their tables.

    Raises:
        InputError: there is no such family.
    """
    return list(_members("scenarios", family_name).values())


def scenario(family_name: str, name: str) -> Scenario:
    """One scenario.

    Raises:
        InputError: there is no such family, or none of that name in it.
    """
    found: Scenario = _find("scenario", "scenarios", family_name, name)
    return found


def workloads(family_name: str) -> dict[str, Workload]:
    """The usual mixes of a family's scenarios, by name; none where nobody named any.

    Raises:
        InputError: there is no such family.
    """
    return _members("workloads", family_name)


def source(family_name: str) -> Source:
    """What the source of a family published.

    Raises:
        InputError: the family has no source, or one that cannot be imported.
    """
    known = {table.family: table for table in reversed(plugins.tables("sources")) if table.family}
    table = find_named("source of the family", known, family_name)
    try:
        found: Source = table.load()
    except PluginError as error:
        raise InputError(f"the source of the family {family_name}: plug-in {table.owner}: {error}") from error
    return found


def skipped() -> list[str]:
    """What plug-ins, or parts of them, have been skipped so far in this process, and why: a sentence each."""
    return plugins.skipped()


def forget() -> None:
    """Look through the tables again, when they are asked for next; families lose the models of plug-ins until then."""
    for family, name in _added:
        family.drop_model(name)
    _added.clear()
    for cached in (_families, _family, _members):
        cached.cache_clear()
    plugins.forget()


@functools.cache
def _families() -> dict[str, tuple[Table, Any]]:
    """By name: the table of each family, and itself where that had to be loaded to know its name."""
    found: dict[str, tuple[Table, Any]] = {}
    taken: dict[str, str] = {}
    for table in plugins.tables("families"):
        named = [(table.family, None)] if table.family else [(o.name, o) for o in plugins.members(table, "families")]
        found |= {name: (table, one) for name, one in named if _is_free("family", name, table.owner, taken)}
    return found


@functools.cache
def _family(name: str) -> Family | None:
    """A family with the models of plug-ins; None where it is broken."""
    table, loaded = _families()[name]
    found: Family | None = loaded or next(plugins.members(table, "families"), None)
    if found is not None:
        _add_models(found)
    return found


_added: list[tuple[Family, str]] = []
"""Models of plug-ins that families have by now."""


def _add_models(family: Family) -> None:
    taken = dict.fromkeys(family.models, OURS)
    for owner, model in _of_family("models", family.name):
        if _is_free("model", model.name, owner, taken):
            try:
                family.add_model(model)
                _added.append((family, model.name))
            except Exception as error:  # whatever a family says to what is no model of its kind
                plugins.skip(owner, f"the model {model.name}: {error}")


def _find(kind: str, group: str, family_name: str, name: str) -> Any:
    return find_named(kind, _members(group, family_name), name, f"in the family {family_name}")


@functools.cache
def _members(group: str, family_name: str) -> dict[str, Any]:
    known = _families()
    find_named("family", known, family_name)
    for table in plugins.tables(group):
        if table.family not in (None, *known):  # else a plug-in's table would go unnoticed
            families = ", ".join(known)
            plugins.skip(table.owner, f"'{table.family}' in {OURS}.{group} is no family; there are: {families}")
    taken: dict[str, str] = {}
    return {
        one.name: one
        for owner, one in _of_family(group, family_name)
        if _is_free(group.removesuffix("s"), one.name, owner, taken)
    }


def _of_family(group: str, family_name: str) -> Iterator[tuple[str, Any]]:
    """The members of a family's tables, with their owners."""
    for table in plugins.tables(group):
        if table.family in (None, family_name):
            for one in plugins.members(table, group):
                if table.family or one.family == family_name:
                    yield table.owner, one
                elif one.family not in _families():  # else it would go unnoticed
                    plugins.skip(
                        table.owner, f"{one.name} is of no family '{one.family}'; there are: {', '.join(_families())}"
                    )


def _is_free(kind: str, name: str, owner: str, taken: dict[str, str]) -> bool:
    """Whether a name is still to be had; then it is `owner`'s, else what bears it is skipped."""
    if name in taken:
        plugins.skip(owner, f"the {kind} '{name}' is defined twice; that of {taken[name]} is taken")
        return False
    taken[name] = owner
    return True
