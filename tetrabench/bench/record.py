"""Records: what a run leaves behind. One flat record a sample, units in the names; JSON through msgspec."""

import os
from pathlib import Path
from typing import Any

import msgspec

from tetrabench.errors import InputError

SCHEMA = "tetrabench-results/0"  # 0: provisional, until measuring is complete


class Sample(msgspec.Struct, frozen=True, kw_only=True):
    """One contestant, one scenario, one turn.

    Attributes:
        status: "ok", "skipped" (see `reason`), "wrong-result", "crash", "error".
        round: 0, 1, ...; every contestant has its turn in each round.
        turn: place in the round's order.
        cpu_s: CPU time of the thread, seconds; process_cpu_s: of all its threads; wall_s: elapsed.
        items, unit, least_bytes: the work done (see protocols.Work).
        digest, figures: the answer (see protocols.Answer); a figure that is infinite or not a number is None.
        structure_bytes: used bytes of the contestant's structure when the sample was over.
        reserved_bytes: with slack.
        peak_bytes: high-water mark of the process's memory in the sample, None where no one can tell.
        reason: why there is no figure, or what went wrong.
    """

    family: str
    model: str
    scenario: str
    backend: str
    status: str
    round: int
    turn: int = 0
    cpu_s: float | None = None
    process_cpu_s: float | None = None
    wall_s: float | None = None
    items: int | None = None
    unit: str = ""
    least_bytes: int | None = None
    digest: str = ""
    figures: dict[str, float | None] = {}
    structure_bytes: int | None = None
    reserved_bytes: int | None = None
    peak_bytes: int | None = None
    reason: str = ""


class Backend(msgspec.Struct, frozen=True, kw_only=True):
    """A contestant as it took part.

    Attributes:
        compile_s: wall time to compile and load its kernels, seconds.
        first_sample_s: from the start of its worker to the start of its first sample, waiting not counted.
        structure: bytes (used, reserved) of each buffer of the fresh structure, by name.
    """

    name: str
    title: str
    extension: bool = False
    compile_s: float = 0.0
    first_sample_s: float = 0.0
    structure: dict[str, tuple[int, int]] = {}


class Results(msgspec.Struct, frozen=True, kw_only=True):
    """A run.

    Attributes:
        schema: SCHEMA of the version that wrote it.
        command: how to repeat it.
        profile: "default" or "thesis".
        options: the counts of each scenario.
        reference: the contestant that ratios refer to.
        environment: processor, memory, system, versions, load: what figures depend on.
        provisional: whether the figures come without intervals.
        interrupted: whether the run was broken off, so that samples are missing.
    """

    schema: str = SCHEMA
    command: str
    profile: str
    family: str
    model: str
    model_size: dict[str, int]
    options: dict[str, dict[str, int]]
    reference: str
    seed: int
    started: str
    environment: dict[str, Any]
    backends: list[Backend]
    samples: list[Sample]
    provisional: bool = True
    interrupted: bool = False


def save_results(results: Results, path: Path) -> None:
    """Write results as JSON, whole or not at all."""
    data = msgspec.json.format(msgspec.json.encode(results), indent=1)
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        temporary.write_bytes(data)
        os.replace(temporary, path)
    except OSError as error:
        temporary.unlink(missing_ok=True)
        raise InputError(f"{path}: cannot write results: {error.strerror}") from error


def read_results(path: Path) -> Results:
    """Read what `save_results` wrote.

    Raises:
        InputError: no such file, not our JSON, or another version's schema.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot read results: {error.strerror}") from error
    try:
        results = msgspec.json.decode(data, type=Results)
    except msgspec.DecodeError as error:
        raise InputError(f"{path}: no results of tetrabench: {error}") from error
    if results.schema != SCHEMA:
        raise InputError(f"{path}: schema {results.schema}, this version reads {SCHEMA}")
    return results
