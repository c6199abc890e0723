"""What is kept of a part: one comparison a row, small enough to commit."""

from pathlib import Path
from typing import Any

import msgspec

FOLDER = Path(__file__).parents[2] / "results" / "measuring"


class Comparison(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A contestant beside the reference, in one scenario.

    Attributes:
        injected: the share of CPU time that the contestant burns on top: the truth.
        ratio: contestant / reference, as the tool has it; low, high: its interval, where the tool gives one.
        verdict: "faster", "slower", or else in the words of the tool.
        by: which of its rules says so, where the tool has several.
        launches: with tetrabench, ln of each launch's ratio: what the verdict was made of.
    """

    scenario: str
    contestant: str
    injected: float
    ratio: float
    low: float | None = None
    high: float | None = None
    verdict: str
    by: str = ""
    launches: list[float] = []


class Part(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """A session of one tool.

    Attributes:
        rule: how this tool says that there is a difference.
        command: what was run; where there are several lines, one after the other.
        seed: of the background load, and of what the tool draws itself.
        begun: ISO date and time; seconds: wall time of it all.
        side_s: wall time that one contestant took in one scenario, on average: two sides make a comparison.
        load_1_minute: of the machine when it ended; steal_share: of its time, taken by other guests of the host.
        controls: with tetrabench, the comparisons of the reference with its second copy.
        facts: other figures, by name.
    """

    part: str
    tool: str
    version: str = ""
    rule: str = ""
    command: list[str]
    seed: int = 0
    begun: str
    seconds: float
    side_s: float = 0.0
    load_1_minute: float | None = None
    steal_share: float | None = None
    environment: dict[str, Any] = {}
    comparisons: list[Comparison] = []
    controls: list[Comparison] = []
    facts: dict[str, Any] = {}


def save(part: Part, folder: Path = FOLDER) -> None:
    """Write a part as JSON, a comparison a line."""
    facts = msgspec.to_builtins(part)
    rows = {name: facts.pop(name) for name in ("comparisons", "controls") if name in facts}
    text = msgspec.json.format(msgspec.json.encode(facts), indent=1).decode().removesuffix("\n}")
    for name, comparisons in rows.items():
        lines = ",\n".join("  " + msgspec.json.encode(row).decode() for row in comparisons)
        text += f',\n "{name}": [\n{lines}\n ]'
    (folder / f"{part.part}.json").write_text(text + "\n}\n")


def read(folder: Path = FOLDER) -> list[Part]:
    """All parts, by name."""
    return [msgspec.json.decode(path.read_bytes(), type=Part) for path in sorted(folder.glob("*.json"))]
