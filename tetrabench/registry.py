"""Families, contestants and scenarios by name, all found through entry points, ours like anybody's.

An entry point is named after its family, and names an explicit table: one `Family` in the group
`tetrabench.families`, an iterable of contestants in `tetrabench.contestants`, of scenarios in
`tetrabench.scenarios`, usual mixes of these, `Workload`s, in `tetrabench.workloads`, and what its source published,
one `Source`, in `tetrabench.sources`. Only the tables of the family that is asked for are imported.
"""

import dataclasses
import functools
from collections.abc import Iterable, Mapping
from importlib.metadata import EntryPoint, entry_points
from typing import Any

from tetrabench.errors import InputError, find_named
from tetrabench.protocols import Contestant, Family, Option, Options, Scenario, Workload
from tetrabench.sources import Source


def families() -> list[Family]:
    """All families.

    Raises:
        InputError: a plug-in cannot be imported, or two of them use one name.
    """
    return [family(name) for name in _families()]


def family(name: str) -> Family:
    """One family.

    Raises:
        InputError: its plug-in cannot be imported, two of them use one name, or there is none of that name.
    """
    loaded: Family = _load(find_named("family", _families(), name))
    return loaded


def contestants(family_name: str) -> list[Contestant]:
    """All contestants of a family, in the order of their tables.

    Raises:
        InputError: a plug-in cannot be imported, or two contestants of one family have one name.
    """
    return list(_members("tetrabench.contestants", family_name).values())


def contestant(family_name: str, name: str, options: Options | None = None) -> Contestant:
    """One contestant; `options` are values that are chosen about it, by name, instead of its own.

    Raises:
        InputError: as `contestants`, or there is none of that name; as `choose_options`.
    """
    known: dict[str, Any] = _members("tetrabench.contestants", family_name)
    found = find_named("backend", known, name)
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
        InputError: a plug-in cannot be imported, or two scenarios of one family have one name.
    """
    return list(_members("tetrabench.scenarios", family_name).values())


def scenario(family_name: str, name: str) -> Scenario:
    """One scenario.

    Raises:
        InputError: as `scenarios`, or there is none of that name.
    """
    known: dict[str, Scenario] = _members("tetrabench.scenarios", family_name)
    return find_named("scenario", known, name)


def workloads(family_name: str) -> dict[str, Workload]:
    """The usual mixes of a family's scenarios, by name; none where nobody named any.

    Raises:
        InputError: a plug-in cannot be imported, or two workloads of one family have one name.
    """
    return _members("tetrabench.workloads", family_name)


def source(family_name: str) -> Source:
    """What the source of a family published.

    Raises:
        InputError: its plug-in cannot be imported, two of them use one name, or the family has no source.
    """
    found = _entry_points("tetrabench.sources")
    known = _by_name((entry.name, entry, _distribution(entry)) for entry in found)
    loaded: Source = _load(find_named("source of the family", known, family_name))
    return loaded


@functools.cache
def _families() -> dict[str, EntryPoint]:
    found = _entry_points("tetrabench.families")
    return _by_name((entry.name, entry, _distribution(entry)) for entry in found)


@functools.cache
def _members(group: str, family_name: str) -> dict[str, Any]:
    find_named("family", _families(), family_name)
    found = _entry_points(group)
    for entry in found:
        if entry.name not in _families():  # else a plug-in's table would go unnoticed
            known = ", ".join(_families())
            raise InputError(
                f"plug-in {_distribution(entry)}: '{entry.name}' in {group} is no family; there are: {known}"
            )
    return _by_name(
        (member.name, member, _distribution(entry))
        for entry in found
        if entry.name == family_name
        for member in _load(entry)
    )


def _by_name(members: Iterable[tuple[str, Any, str]]) -> dict[str, Any]:
    """The members (name, itself, distribution) by name."""
    known: dict[str, tuple[Any, str]] = {}
    for name, member, distribution in members:
        if name in known:
            _, other = known[name]
            raise InputError(f"'{name}' is defined twice, by {other} and by {distribution}: remove one")
        known[name] = (member, distribution)
    return {name: member for name, (member, _) in known.items()}


def _entry_points(group: str) -> list[EntryPoint]:
    """Ours first, then by distribution."""
    names = {entry: _distribution(entry) for entry in entry_points(group=group)}
    return sorted(names, key=lambda entry: (names[entry] != "tetrabench", names[entry]))


def _load(entry: EntryPoint) -> Any:
    try:
        return entry.load()
    except Exception as error:  # whatever a plug-in does at import
        reason = f"{type(error).__name__}: {error}"
        raise InputError(f"plug-in {_distribution(entry)}: cannot import {entry.value}: {reason}") from error


def _distribution(entry: EntryPoint) -> str:
    return entry.dist.name if entry.dist else "an unknown distribution"
