"""Where tables come from: entry points of distributions, ours like anybody's, and files that a person names.

A table is what a plug-in adds: families, contestants, scenarios, models or workloads. What is wrong with a plug-in of
others is named, and the plug-in skipped: it must not stand in the way of a run that may not want it.
"""

import hashlib
import importlib.metadata
import os
import re
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from importlib.metadata import EntryPoint, entry_points
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Annotated, Any

import msgspec
from msgspec import Meta

from tetrabench.errors import InputError, PluginWarning
from tetrabench.printable import printable
from tetrabench.protocols import Contestant, Family, Option, Scenario
from tetrabench.traces import spell_error

OURS = "tetrabench"

VARIABLE = "TETRABENCH_PLUGINS"
"""The environment variable that holds the paths of plug-in files, so that workers know them too."""

GROUPS = ("families", "contestants", "scenarios", "models", "workloads", "sources")
"""Of entry points, each after `tetrabench.`. One of the first four, in capitals, is the name of a table in a file."""

_KINDS: Mapping[str, type] = {"families": Family, "contestants": Contestant, "scenarios": Scenario}
_NAME = re.compile(r"\w[\w.+-]*")

_Word = Annotated[str, Meta(pattern=f"^{_NAME.pattern}$")]
_OPTIONS = dict[_Word, Any]
_COUNTS = dict[_Word, int]
_FACTS: Mapping[str, Mapping[str, Any]] = {
    "families": {"reference": str, "default_model": str, "size_option": str, "thesis_order": list[str]},
    "contestants": {"title": str, "trade_off": str, "extension": bool, "is_exact": bool, "options": _OPTIONS},
    "scenarios": {"title": str, "parallel": bool, "options": _COUNTS, "thesis": _COUNTS},
    "models": {"title": str},
    "workloads": {"title": str, "mix": dict[str, Annotated[float, Meta(ge=0, le=sys.float_info.max)]]},
}
"""What members of each group must hold, beside a name: tables, verbs and pages take it for granted."""


class PluginError(Exception):
    """What is wrong with a plug-in."""


@dataclass(frozen=True)
class Table:
    """A table that has not been loaded yet.

    Attributes:
        owner: whose it is: a distribution, or a file.
        family: of all its members; None in a file, where each says so itself.
        load: import it; whatever a plug-in does at import may come out.
    """

    owner: str
    family: str | None
    load: Callable[[], Any]


_skipped: dict[str, None] = {}


def skipped() -> list[str]:
    """What has been skipped in this process, a sentence for each."""
    return list(_skipped)


def forget() -> None:
    """Forget what has been skipped: the tables are about to be looked through again."""
    _skipped.clear()


def skip(owner: str, reason: object) -> None:
    """Go on without a plug-in, or a part of it, and say so.

    Raises:
        InputError: it is a part of tetrabench itself.
    """
    sentence = printable(" ".join(f"plug-in {owner}: {reason}".split()))
    if owner == OURS:
        raise InputError(sentence)
    if sentence not in _skipped:
        _skipped[sentence] = None
        warnings.warn(f"skipped {sentence}", PluginWarning, stacklevel=2)


def tables(group: str) -> list[Table]:
    """The tables of a group: ours first, then by distribution, then those in files as they were named."""
    owners = {entry: _distribution(entry) for entry in entry_points(group=f"{OURS}.{group}")}
    return [
        *(
            Table(owners[entry], entry.name, _loader(entry))
            for entry in sorted(owners, key=lambda entry: (owners[entry] != OURS, owners[entry]))
        ),
        *(Table(path.name, None, _reader(path, group.upper())) for path in files() if group in GROUPS[:4]),
    ]


def members(table: Table, group: str) -> Iterator[Any]:
    """The sound members of a table; what is wrong with the others, or with all of it, is skipped."""
    try:
        loaded = table.load()
        found = [loaded] if group == "families" and table.family else _listed(loaded)  # an entry point is one family
    except (Exception, SystemExit) as error:  # whatever a plug-in does at import
        skip(table.owner, error if isinstance(error, PluginError) else f"cannot be imported: {_spell(error)}")
        return
    for member in found:
        reason = _what_is_wrong(member, group, table.family)
        if reason:
            skip(table.owner, reason)
        else:
            yield member


def _listed(table: Iterable[Any]) -> list[Any]:
    """The members of a table that may be asked for again: the first to look would leave an iterator empty."""
    if isinstance(table, Iterator):
        raise PluginError(f"a table of it is a {type(table).__name__}, which can be read but once; make it a tuple")
    return list(table)


def files() -> list[Path]:
    """The plug-in files that were named, each once."""
    named = os.environ.get(VARIABLE, "").split(os.pathsep)
    return list(dict.fromkeys(Path(name).absolute() for name in named if name))


@contextmanager
def using(paths: Iterable[str | os.PathLike[str]]) -> Iterator[None]:
    """Name plug-in files beside those that are named already, for this process and those that it spawns.

    Raises:
        InputError: a path with what stands between two in `VARIABLE`.
    """
    before = os.environ.get(VARIABLE)
    named = [*files(), *(Path(path).absolute() for path in paths)]
    for path in named:
        if os.pathsep in str(path):
            raise InputError(
                f"{path}: a plug-in cannot lie at a path with '{os.pathsep}', which parts two paths; move it"
            )
    os.environ[VARIABLE] = os.pathsep.join(map(str, named))
    try:
        yield
    finally:
        if before is None:
            del os.environ[VARIABLE]
        else:
            os.environ[VARIABLE] = before


def _loader(entry: EntryPoint) -> Callable[[], Any]:
    def load() -> Any:
        try:
            return entry.load()
        except (Exception, SystemExit) as error:
            raise PluginError(f"cannot import {entry.value}: {_spell(error)}") from error

    return load


def _reader(path: Path, name: str) -> Callable[[], Any]:
    """The table of this name in a file; empty where it has none, as long as it has another."""

    def load() -> Any:
        module = _module(path)
        names = [group.upper() for group in GROUPS[:4]]
        if not any(hasattr(module, other) for other in names):
            raise PluginError(f"has none of the tables {', '.join(names)}")
        return getattr(module, name, ())

    return load


def _module(path: Path) -> ModuleType:
    """A file as a module; once in a process, as any import.

    Its name follows from its content: kernels that are kept on disk know it by that name, wherever it lies.
    """
    if not path.is_file():
        raise PluginError(f"there is no file {path}")
    digest = hashlib.sha256(path.read_bytes()).hexdigest()[:8]
    name = re.sub(r"\W", "_", f"{path.stem}_{digest}")
    if name in sys.modules:
        return sys.modules[name]
    spec = spec_from_file_location(name, path)
    if spec is None or spec.loader is None:
        raise PluginError(f"{path} is no Python file; its name must end in .py")
    module = module_from_spec(spec)
    sys.modules[name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[name]
        raise
    return module


def _what_is_wrong(member: Any, group: str, family: str | None) -> str:
    """Why something can be no member of a table; "" where it can. Raises nothing, whatever it is."""
    try:
        return next(_faults(member, group, family), "")
    except Exception as error:  # a property may raise anything
        return f"one of its {group}, a {type(member).__name__}, is none: {_spell(error)}"


def _faults(member: Any, group: str, family: str | None) -> Iterator[str]:
    """What is wrong with a member of a table; each can only be found where none was found before."""
    if isinstance(member, type):
        yield f"the class {member.__name__} is one of its {group}; a table holds objects: {member.__name__}()"
    name, facts = member.name, _FACTS[group]
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        yield f"{name!r} is no name for one of its {group}: letters, digits, - and . in a word"
    wanted = [attribute for attribute in vars(_KINDS.get(group, object)) if not attribute.startswith("_")]
    missing = [attribute for attribute in dict.fromkeys([*wanted, *facts]) if not hasattr(member, attribute)]
    if missing:
        yield f"{name} has no {', '.join(missing)}, which all {group} have"
    if group == "families":
        if family not in (None, name):
            yield f"the family {name} is registered under another name, {family}"
    elif family is None and not isinstance(getattr(member, "family", None), str):
        yield f"{name} does not say its family"
    elif family not in (None, getattr(member, "family", family)):
        yield f"{name} belongs to the family {member.family}, and is registered under {family}"
    for fact, kind in facts.items():
        yield from _faults_of_fact(name, fact, getattr(member, fact), kind)
    if group == "scenarios" and not set(member.thesis) <= set(member.options):
        yield f"{name} has counts in `thesis` that are not in its `options`"


def _faults_of_fact(name: str, fact: str, value: Any, kind: Any) -> Iterator[str]:
    """What is wrong with an attribute of the member `name`, which should be of this kind; likewise."""
    try:
        msgspec.convert(value, kind)
        for title, option in value.items() if kind == _OPTIONS else ():
            if not isinstance(option, Option):
                yield f"{name} has an option {title!r} that is none: {option!r:.60} is no Option"
            elif not option.least <= msgspec.convert(asdict(option), Option).value <= option.most:
                yield f"{name} has an option {title!r} whose value is beyond its own limits: {option!r:.90}"
    except msgspec.ValidationError as error:
        yield f"the `{fact}` of {name}, {value!r:.90}, cannot be: {error}"


def _spell(error: BaseException) -> str:
    return spell_error(error, entered_from=(__file__, importlib.__file__, importlib.metadata.__file__))


def _distribution(entry: EntryPoint) -> str:
    return entry.dist.name if entry.dist else "an unknown distribution"
