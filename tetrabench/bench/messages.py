"""What the parent and a worker say to each other: one request, one reply, a line of JSON each.

The order is Open, Warm for each task, Load, Measure again and again; or Open, Weigh; or Open, Examine again and again; or
Gauge, Describe, Find alone.
The end of the pipe means close.
"""

import msgspec

from tetrabench.bench.record import Yardsticks
from tetrabench.protocols import Option, Tour

PROTOCOL = 1
"""Of all this; the two ends may be different versions of tetrabench when one gate compares them."""


class Open(msgspec.Struct, frozen=True, tag=True):
    """Import the contestant and its family. `chained`: one net for all scenarios. `options`: what is chosen about the
    contestant. Reply: Done."""

    family: str
    contestant: str
    chained: bool = False
    protocol: int = PROTOCOL
    options: dict[str, int] = {}


class Warm(msgspec.Struct, frozen=True, tag=True):
    """Run a scenario once on the family's small model, so that its kernels are compiled. Reply: Done."""

    scenario: str
    options: dict[str, int]


class Load(msgspec.Struct, frozen=True, tag=True):
    """Put the contestant on stage with the model, a path. Reply: Loaded."""

    model: str


class Measure(msgspec.Struct, frozen=True, tag=True):
    """Take one sample: run the scenario so often, each time on a fresh subject. Reply: Measured."""

    scenario: str
    options: dict[str, int]
    repeats: int = 1


class Weigh(msgspec.Struct, frozen=True, tag=True):
    """Build the structure of a model, a path, and say what memory that takes. Reply: Weighed."""

    model: str


class Examine(msgspec.Struct, frozen=True, tag=True):
    """Look for what the contestant does wrong by a rule of its family. Where the worker was when it crashed, or after
    `patience_s` seconds, it writes into the file `notes`. Reply: Examined."""

    rule: str
    notes: str
    patience_s: float


class Gauge(msgspec.Struct, frozen=True, tag=True):
    """Measure what the machine can do. Reply: Gauged."""


class Describe(msgspec.Struct, frozen=True, tag=True):
    """Say what a family has to offer. Reply: Described."""

    family: str


class Find(msgspec.Struct, frozen=True, tag=True):
    """Find the file of a model, or generate it, and read it: see `Family.find_model`. Reply: Found."""

    family: str
    model: str
    size: int | None = None
    numbering: str = "natural"
    seed: int = 0


class Done(msgspec.Struct, frozen=True, tag=True):
    """It took so long: wall time in seconds. `compiled`: kernels that were in no cache."""

    wall_s: float
    compiled: int = 0


class Loaded(msgspec.Struct, frozen=True, tag=True):
    """The model is read. The bytes (used, reserved) of each buffer of the structure, where it stands by now."""

    structure: dict[str, tuple[int, int]]


class Measured(msgspec.Struct, frozen=True, tag=True, kw_only=True):
    """A sample's raw figures, as in `record.Sample`."""

    repeats: int
    prepare_s: float
    cpu_s: float
    process_cpu_s: float
    wall_s: float
    answer_s: float
    peak_bytes: int | None
    structure: dict[str, tuple[int, int]]
    digest: str
    figures: dict[str, float | None]
    items: int
    unit: str
    least_bytes: int | None
    series: dict[str, list[float]] = {}


class Weighed(msgspec.Struct, frozen=True, tag=True, kw_only=True):
    """Figures as in `record.Memory`. `compiled`: kernels that were in no cache, whose compiler is in the way of them."""

    structure: dict[str, tuple[int, int]]
    retained_bytes: int | None
    peak_bytes: int | None
    compiled: int = 0


class Gauged(msgspec.Struct, frozen=True, tag=True):
    """What the machine can do."""

    yardsticks: Yardsticks


class Examined(msgspec.Struct, frozen=True, tag=True):
    """What is wrong, a sentence each; none where the contestant keeps to the rule."""

    faults: list[str]


class RuleFacts(msgspec.Struct, frozen=True, kw_only=True):
    """What there is to know of a rule, see `protocols.Rule`."""

    name: str
    title: str
    essential: bool = False


class ContestantFacts(msgspec.Struct, frozen=True, kw_only=True):
    """What a plan needs to know of a contestant, see `protocols.Contestant`."""

    name: str
    title: str
    extension: bool = False
    options: dict[str, Option] = {}
    exact: bool = True


class ScenarioFacts(msgspec.Struct, frozen=True, kw_only=True):
    """What a plan needs to know of a scenario, see `protocols.Scenario`."""

    name: str
    options: dict[str, int]
    thesis: dict[str, int]
    parallel: bool = False


class Described(msgspec.Struct, frozen=True, tag=True, kw_only=True):
    """What a family has to offer, in the order of its tables. `skipped`: what plug-ins are broken, a sentence each."""

    reference: str
    thesis_order: list[str]
    contestants: list[ContestantFacts]
    scenarios: list[ScenarioFacts]
    default_model: str = ""
    size_option: str = "tets"
    tour: Tour | None = None
    skipped: list[str] = []
    rules: list[RuleFacts] = []


class Found(msgspec.Struct, frozen=True, tag=True):
    """The path of a model's file, and what it holds, see `protocols.ModelFacts`."""

    path: str
    size: dict[str, int] = {}
    notes: list[str] = []


class Skipped(msgspec.Struct, frozen=True, tag=True):
    """The contestant cannot run this scenario, and why. Reply to Warm and Measure."""

    reason: str


class Failed(msgspec.Struct, frozen=True, tag=True):
    """An exception ended the request; the worker goes on.

    `exit_code`: of an error that the user can mend, else 0. `oom`: there was not enough memory.
    """

    reason: str
    exit_code: int = 0
    oom: bool = False


Request = Open | Warm | Load | Measure | Weigh | Examine | Gauge | Describe | Find
Reply = Done | Loaded | Measured | Weighed | Examined | Gauged | Described | Found | Skipped | Failed


def encode(message: Request | Reply) -> bytes:
    """A message as a line."""
    return msgspec.json.encode(message) + b"\n"


def decode_request(line: bytes) -> Request:
    """A line as a request."""
    request: Request = msgspec.json.decode(line, type=Request)
    return request


def decode_reply(line: bytes) -> Reply:
    """A line as a reply."""
    reply: Reply = msgspec.json.decode(line, type=Reply)
    return reply
