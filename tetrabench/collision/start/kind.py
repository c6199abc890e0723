"""Objects as a kind of model: what the verbs about models know of them."""

from tetrabench.collision.objects import Start
from tetrabench.collision.start.files import (
    EXACT,
    TABLE,
    check_objects_target,
    holds_objects,
    read_objects,
    write_objects,
)
from tetrabench.collision.start.inspection import inspect_objects
from tetrabench.collision.start.models import MODELS, generate_objects
from tetrabench.collision.start.numbering import renumber_objects
from tetrabench.io import check_field
from tetrabench.io.kinds import FilePath, Kind


def _check_target(path: FilePath, field: str | None) -> None:
    check_objects_target(path)
    check_field(path, field)


def _write(start: Start, path: FilePath, field: str | None) -> str:
    check_field(path, field)
    write_objects(start, path)
    return ""


def _count(start: Start) -> str:
    return f"{len(start.objects.x):,} objects"


OBJECTS = Kind(
    model=Start,
    models=MODELS,
    suffixes=(EXACT, TABLE),
    holds=holds_objects,
    make=lambda name, size, numbering, seed: generate_objects(name, size, numbering=numbering, seed=seed),
    read=lambda path, unused, repair: read_objects(path),
    check_target=_check_target,
    write=_write,
    renumber=renumber_objects,
    count=_count,
    describe=_count,
    source=lambda start: start.source,
    inspect=inspect_objects,
    tell=lambda start, unused: [],
    drawn_by="objects are drawn by: tetrabench watch --model {} --steps 0 --record FILE.png",
    family="collision",
)
