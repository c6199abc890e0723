"""What a person asks to watch, found by name: the structures with their options, and the objects to start from."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from tetrabench import registry
from tetrabench.errors import InputError

if TYPE_CHECKING:
    from pathlib import Path

    from tetrabench.collision.contestant import CollisionContestant

FAMILY = "collision"
USUAL_OBJECTS = 2_000  # of a generated model: what one can follow by eye


def find_contestants(backend: str, options: Iterable[str] = ()) -> dict[str, CollisionContestant]:
    """All contestants by name, in the order of their tables.

    Args:
        backend: to begin with; options that name no contestant are its own.
        options: such as "kdtree.capacity=8" or "capacity=8".

    Raises:
        InputError: no such backend or option, or a value beyond its limits.
    """
    registry.contestant(FAMILY, backend)
    chosen: dict[str, dict[str, int]] = {}
    for text in options:
        match = re.fullmatch(r"\s*(?:([^=\s]+)\.)?([^.=\s]+)\s*=\s*(\d+)\s*", text)
        if match is None:
            raise InputError(f"option '{text}': write NAME=N or BACKEND.NAME=N, in a whole number")
        owner, name, value = match.groups()
        chosen.setdefault(owner or backend, {})[name] = int(value)
    changed: dict[str, Any] = {owner: registry.contestant(FAMILY, owner, values) for owner, values in chosen.items()}
    known: dict[str, Any] = {one.name: one for one in registry.contestants(FAMILY)}
    return known | changed


def with_option(contestant: CollisionContestant, name: str, value: int) -> CollisionContestant:
    """The same structure with another value of an option.

    Raises:
        InputError: it has no such option, or the value is beyond its limits.
    """
    values = {known: option.value for known, option in contestant.options.items()} | {name: value}
    return replace(contestant, options=registry.choose_options(contestant.name, contestant.options, values))


def find_file(model: str, objects: int | None, *, numbering: str, seed: int) -> Path:
    """The file of a model, or of one that is generated, with so many objects, or USUAL_OBJECTS.

    Raises:
        InputError: see `find_model` of the family.
    """
    family = registry.family(FAMILY)
    if objects is None and model in family.models:
        objects = USUAL_OBJECTS
    return family.find_model(model, size=objects, numbering=numbering, seed=seed)
