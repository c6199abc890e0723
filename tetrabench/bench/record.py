"""Records: what a run leaves behind. Flat records with units in their names; JSON through msgspec."""

from pathlib import Path
from typing import Any

import msgspec

from tetrabench.bench.soundness import find_fault
from tetrabench.drafts import drafted
from tetrabench.errors import InputError
from tetrabench.memory import refuse_if_too_large
from tetrabench.printable import printable

SCHEMA = "tetrabench-results/1"
"""Its JSON schema is docs/results-1.schema.json. A field that is added keeps the number; all else raises it."""

MEBI = 2**20
ROOM = 12
"""Bytes of memory that a byte of a file takes, read: measured 4, rounded up for what is shown of it."""


class Model(msgspec.Struct, frozen=True, kw_only=True):
    """A model as it took part.

    Attributes:
        name: how it was asked for, without its folder, with its numbering unless that is natural; in a sweep over sizes
            with the size asked for.
        size: how many of each thing it holds, such as {"tetras": 642816, "points": 115541}.
        digest: of the file, 16 hexadecimal digits: two runs with the same digest ran on the same model.
        notes: what its reader warns of.
    """

    name: str
    size: dict[str, int] = {}
    digest: str = ""
    notes: list[str] = []


class Task(msgspec.Struct, frozen=True, kw_only=True):
    """A scenario with its counts.

    Attributes:
        name: that of the scenario; in a sweep over options followed by them, as in "alfa sweeps=10".
        scenario: whose counts `options` are.
        parallel: measured by wall time, on all cores; others by CPU time, on one.
    """

    name: str
    scenario: str
    options: dict[str, int] = {}
    parallel: bool = False


class Backend(msgspec.Struct, frozen=True, kw_only=True):
    """A contestant as it took part.

    Attributes:
        name: unique in the run.
        contestant: the name that its family knows it by.
        against: the name of the backend that its ratios refer to; its own where it is a reference.
        control: a second copy of the reference, which shows what differs when nothing does.
        checkout: the version of tetrabench that it ran in, where that is not the running one.
        extension: not from the source.
        options: what was chosen about the contestant, by name.
        exact: False of a contestant that is known to be wrong: it has no vote on what is right.
        compile_s: wall time to compile and load its kernels in the first launch, seconds.
        structure: bytes (used, reserved) of each buffer of the fresh structure on the first model, by name.
    """

    name: str
    contestant: str
    title: str
    against: str
    control: bool = False
    checkout: str = ""
    extension: bool = False
    options: dict[str, int] = {}
    exact: bool = True
    compile_s: float = 0.0
    structure: dict[str, tuple[int, int]] = {}


class Yardsticks(msgspec.Struct, frozen=True, kw_only=True):
    """What the core of a launch could do when the launch began: see `yardsticks`.

    Attributes:
        copy_gb_s, triad_gb_s: bytes read and written a second by a = b and a = b + 3 c, 1e9 bytes.
        latency_ns: one step of a random walk through memory that no cache holds, nanoseconds.
    """

    copy_gb_s: float
    triad_gb_s: float
    latency_ns: float


class Launch(msgspec.Struct, frozen=True, kw_only=True):
    """A fresh set of workers on one model, all alive at once.

    Attributes:
        launch: 0, 1, ...; group: where not all fit into memory at once, a launch is made group by group.
        core: that all its serial workers shared.
        begun: ISO date and time.
        load_1_minute: of the machine when it began.
        steal_share: share of the machine's time that other guests of its host took meanwhile.
        seconds: wall time spent on "starting", "compiling", "reading", "yardsticks", "preparing", "samples",
            "answers", "waiting" (for all of these to be handed over), of which warming runs side by side.
    """

    model: str
    launch: int
    group: int = 0
    core: int
    begun: str
    load_1_minute: float | None = None
    steal_share: float | None = None
    yardsticks: Yardsticks | None = None
    seconds: dict[str, float] = {}


class Memory(msgspec.Struct, frozen=True, kw_only=True):
    """What a contestant's structure takes, in a process of its own: see `memory`.

    Attributes:
        status: "ok", or as in `Sample`.
        structure: bytes (used, reserved) of each of its buffers, by name.
        retained_bytes: private bytes that the process has more once the structure stands and all else is given back;
            peak_bytes: at most meanwhile. None where the system does not tell.
        reason: what went wrong.
    """

    model: str
    backend: str
    status: str = "ok"
    structure: dict[str, tuple[int, int]] = {}
    retained_bytes: int | None = None
    peak_bytes: int | None = None
    reason: str = ""

    @property
    def structure_bytes(self) -> int:
        """Used bytes of all buffers."""
        return sum(used for used, _ in self.structure.values())

    @property
    def is_accounted(self) -> bool:
        """Whether the process holds what the structure claims to hold."""
        return self.retained_bytes is None or self.structure_bytes <= self.retained_bytes + MEBI


class Sample(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """One contestant, one task, one turn.

    Attributes:
        task: the name of the task.
        status: "ok", "skipped" (not run, see `reason`), "unsupported" (the contestant cannot), "wrong-result" (not
            the answer of most), "unstable" (not always the same answer), "timeout", "crash", "oom" (out of memory),
            "error" (an exception).
        launch, group: whose workers; round: 0, 1, ... in the launch; turn: place in the order of the round.
        repeats: how often the scenario ran in this sample, each time on a fresh subject; all figures are sums.
        cpu_s: CPU time of the thread, seconds; process_cpu_s: of all its threads; wall_s: elapsed.
        prepare_s, answer_s: wall time of what is not timed, seconds.
        items, unit, least_bytes: the work done (see protocols.Work).
        digest, figures: the answer (see protocols.Answer); a figure that is infinite or not a number is None.
        series: what was counted or timed on the way, a number for each stretch of the run, by name (see protocols.Answer).
        structure_bytes: used bytes of the contestant's structure when the sample was over; reserved_bytes: with slack.
        peak_bytes: high-water mark of the process's memory in the sample, None where no one can tell.
        reason: why there is no figure, or what went wrong.
    """

    model: str
    task: str
    backend: str
    status: str
    launch: int
    round: int
    group: int = 0
    turn: int = 0
    repeats: int = 1
    cpu_s: float | None = None
    process_cpu_s: float | None = None
    wall_s: float | None = None
    prepare_s: float = 0.0
    answer_s: float = 0.0
    items: int | None = None
    unit: str = ""
    least_bytes: int | None = None
    digest: str = ""
    figures: dict[str, float | None] = {}
    series: dict[str, list[float]] = {}
    structure_bytes: int | None = None
    reserved_bytes: int | None = None
    peak_bytes: int | None = None
    reason: str = ""


class Effort(msgspec.Struct, frozen=True, kw_only=True):
    """How often: launches of so many rounds each.

    Attributes:
        hopeless_rounds: of a contestant that the first round shows to be hopeless, in all, one a launch.
        narrow: a cell ends early when its interval is narrower than this share; 0 never.
    """

    launches: int
    rounds: int
    hopeless_rounds: int
    narrow: float = 0.0


class Results(msgspec.Struct, frozen=True, kw_only=True):
    """A run.

    Attributes:
        schema: SCHEMA of the version that wrote it.
        command: how to repeat it.
        profile: "default", "quick", "rigorous", "thesis" or "check" (answers only, times mean nothing).
        reference: the backend that all ratios refer to unless `Backend.against` says otherwise.
        started: ISO date and time.
        elapsed_s: wall time of the whole run, seconds, without what was resumed.
        environment: processor, memory, system, versions: what figures depend on.
        titles: of all contestants of the family: charts give each its looks by its place among them, whoever takes part.
        memory: the memory pass.
        ended: why fewer samples were taken than planned: "" (they were not), "interrupted", "budget".
    """

    schema: str = SCHEMA
    command: str
    profile: str
    family: str
    models: list[Model]
    tasks: list[Task]
    backends: list[Backend]
    reference: str
    effort: Effort
    seed: int
    started: str
    elapsed_s: float = 0.0
    environment: dict[str, Any]
    titles: list[str] = []
    launches: list[Launch] = []
    memory: list[Memory] = []
    samples: list[Sample] = []
    ended: str = ""


def save_results(results: Results, path: Path) -> None:
    """Write results as JSON, a sample a line; whole or not at all."""
    with drafted(path) as draft:
        draft.write_bytes(_spell(results))


def _spell(results: Results) -> bytes:
    """JSON that people can look into: the facts indented, then a sample a line."""
    facts = msgspec.to_builtins(results)
    samples = facts.pop("samples")
    head = msgspec.json.format(msgspec.json.encode(facts), indent=1).removesuffix(b"\n}")
    lines = b",\n".join(b"  " + msgspec.json.encode(sample) for sample in samples)
    return head + b',\n "samples": [\n' + lines + b"\n ]\n}\n"


def read_results(path: Path) -> Results:
    """Read what `save_results` wrote.

    Raises:
        InputError: no such file, not our JSON, another version's schema, or facts that do not hang together;
            `MemoryRefusedError` where there is not enough memory to read it.
    """
    try:
        refuse_if_too_large(f"reading {path}", ROOM * path.stat().st_size)
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"{path}: cannot read results: {error.strerror}") from error
    try:
        schema = msgspec.json.decode(data, type=_Schema).schema
        if schema != SCHEMA:
            raise InputError(f"{path}: schema {printable(schema[:80]) or 'unknown'}, this version reads {SCHEMA}")
        results: Results = msgspec.json.decode(data, type=Results)
    except NO_JSON as error:
        reason = printable(f"{error}")
        raise InputError(f"{path}: no results of tetrabench, or cut off: {reason}") from error
    if fault := find_fault(results):
        raise InputError(f"{path}: these results do not hang together: {fault}")
    return results


NO_JSON = (msgspec.DecodeError, UnicodeDecodeError, RecursionError)
"""What msgspec raises for what is no JSON, no text, or nested without end."""


class _Schema(msgspec.Struct):
    schema: str = ""
