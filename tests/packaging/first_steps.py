"""What a newcomer types once tetrabench alone is installed, and what each has to answer."""

import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from time import monotonic
from typing import NamedTuple

from tests.packaging.environments import ROOT, run

COMMITTED = ROOT / "results" / "nozzle-120k-quick.json"


class Step(NamedTuple):
    """A command.

    Attributes:
        line: what follows `tetrabench`; FILE stands for a file of results.
        says: what has to be in the answer; code: the exit code.
    """

    line: str
    says: str = ""
    code: int = 0


QUICK = (
    Step("--version", "tetrabench 0."),
    Step("list backends", "v3y"),
    Step("generate box --tets 300 -o box.nas", "box.nas"),
    Step("convert box.nas box.vtu", "box.vtu"),
    Step("show FILE", "alfa"),
    # an extra that is missing is named, in one line
    Step("report FILE -o page.html", "pip install 'tetrabench[report]'", 2),
    Step("watch", 'pip install "tetrabench[watch]"', 2),
    Step("convert box.nas box.h5m", "pip install 'tetrabench[formats]'", 2),
)
"""Steps that compile next to nothing."""

WHOLE = (
    *QUICK,
    Step("info box.nas", "tetras"),
    Step("generate nozzle --tets 5000 -o nozzle.nas", "nozzle.nas"),
    Step("check --model nozzle.nas --backend v3y,v5y --scenario alfa,delete", "v5y"),
    Step("run -o first.json", "v3y"),
    Step("show first.json", "v3y"),
)


class Taken(NamedTuple):
    """What came of a step. fault: "" where all is well; seconds: of wall time."""

    step: str
    fault: str
    seconds: float


def take(steps: Iterable[Step], programs: Path, folder: Path, cache: Path) -> Iterator[Taken]:
    """Take steps in an empty folder, with a cache folder of their own."""
    for step in steps:
        began = monotonic()
        words = [str(COMMITTED) if word == "FILE" else word for word in step.line.split()]
        done = run([programs / "tetrabench", *words], folder, {"TETRABENCH_CACHE": str(cache)})
        said = done.stdout + done.stderr
        fault = ""
        if "Traceback" in said:
            fault = "a traceback"
        elif done.returncode != step.code:
            fault = f"exit code {done.returncode}"
        elif step.says not in said:
            fault = f"does not say {step.says!r}"
        elif step.code and done.stderr.count("\n") != 1:
            fault = "refused in more than a line"
        yield Taken(f"tetrabench {step.line}", f"{fault}: {said[-2000:]}" if fault else "", monotonic() - began)


def take_library(programs: Path, folder: Path, cache: Path) -> Taken:
    """Run the examples of README.md, on the nozzle.nas that an earlier step has left."""
    began = monotonic()
    (folder / "examples.py").write_text(
        "\n".join(re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(), re.S))
    )
    done = run([programs / "python", "-W", "error", "examples.py"], folder, {"TETRABENCH_CACHE": str(cache)})
    return Taken("README.md's library examples", done.stderr[-2000:] if done.returncode else "", monotonic() - began)
