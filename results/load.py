"""A large model opened: does what it takes stay within the estimate by which it would be refused? `load-10m.json`.

    python results/load.py --tets 10M --backend v3y,v5y,v4,halfface

The model is generated into a temporary folder, a process of its own for each step. Opening is measured in its two parts,
reading the file and building the net: the peak of each beyond what the process held before, beside what the part asked
for when it looked whether there is room. Then the same is tried where there is too little room, for reading and for
building: refused by the estimate, with the exit code of the command line, before the memory is gone.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

RESULTS = Path(__file__).parent
BACKENDS = "v3y,v5y,v4,halfface"
WARMING = 2000  # tetras of the model that kernels are compiled, or loaded, with
ROOM = 2**28  # bytes of address space that the interpreter takes beside the arrays: threads, libraries

Facts = dict[str, Any]


def main() -> None:
    """Measure, print a line for each part, and write the file."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--tets", default="10M", help="such as 300k or 10M")
    parser.add_argument("--backend", default=BACKENDS)
    parser.add_argument("--suffix", default=".nas", help="of the file: its format")
    parser.add_argument("--folder", type=Path, help="for the file, and left there; a temporary one unless given")
    parser.add_argument("-o", "--output", type=Path, default=RESULTS / "load-10m.json")
    parser.add_argument("--step", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.step:
        print(json.dumps(STEPS[options.step](options.folder, options.backend)))
        return
    from tetrabench.bench.environment import describe_environment

    with tempfile.TemporaryDirectory() as temporary:
        path = (options.folder or Path(temporary)) / f"nozzle-{options.tets}{options.suffix}"
        if not path.exists():
            verb("generate", "nozzle", "--tets", options.tets, "-o", str(path))
        found: Facts = {
            "command": f"python results/load.py --tets {options.tets} --backend {options.backend}",
            "environment": describe_environment(),
            "file": {"format": options.suffix, "bytes": path.stat().st_size},
            "opened": [tell(step("open", path, backend)) for backend in options.backend.split(",")],
            "refused": [tell(step(name, path, options.backend.split(",")[0])) for name in ("info", "read", "build")],
        }
    options.output.write_text(json.dumps(found, indent=1) + "\n")


def step(name: str, path: Path, backend: str) -> Facts:
    """What one step tells, in a process of its own."""
    from tetrabench.bench.memory import WEIGHING

    command = [sys.executable, __file__, "--step", name, "--folder", str(path), "--backend", backend]
    done = subprocess.run(command, env=os.environ | WEIGHING, stdout=subprocess.PIPE, text=True, check=True)
    facts: Facts = json.loads(done.stdout)
    return facts


def tell(facts: Facts) -> Facts:
    """The same, said."""
    print(json.dumps(facts), flush=True)
    return facts


def verb(*words: str) -> subprocess.CompletedProcess[str]:
    """A verb of the command line."""
    return subprocess.run([sys.executable, "-m", "tetrabench", *words], capture_output=True, text=True, check=False)


# ---------------------------------------------------------------------- steps


def open_file(path: Path, backend: str) -> Facts:
    """Open a file in two parts, as `tetrabench.open(path, backend)` does in one."""
    import tetrabench

    warm(path, backend)
    mesh, reading = measured(lambda: tetrabench.read_mesh(path))
    net, building = measured(lambda: tetrabench.open(mesh, backend))
    return {"backend": backend, "tetras": len(net), "points": len(mesh.points), "read": reading, "build": building}


def refuse_verb(path: Path, backend: str) -> Facts:
    """`tetrabench info` with address space for itself and half of what reading takes."""
    asked = estimates(lambda: read(path))[0]
    limit = address_space() + ROOM + int(asked / 2)
    code = f"ulimit -v {limit // 1024}; exec {sys.executable} -m tetrabench info {path}"
    begin = time.monotonic()
    done = subprocess.run(["sh", "-c", code], capture_output=True, text=True, check=False)
    said = done.stderr.replace(str(path), path.name).strip()
    return {"what": "tetrabench info", "exit_code": done.returncode, "said": said, "seconds": time.monotonic() - begin}


def refuse_reading(path: Path, backend: str) -> Facts:
    """Reading with half of the room that it asks for."""
    asked = estimates(lambda: read(path))[0]
    return {"what": "reading", **refused(lambda: read(path), int(asked / 2), path)}


def refuse_building(path: Path, backend: str) -> Facts:
    """Building with half of the room that it asks for, once the file is read."""
    import tetrabench

    warm(path, backend)
    mesh = tetrabench.read_mesh(path)
    asked = estimates(lambda: tetrabench.open(mesh, backend).close())[-1]
    return {"what": "building", **refused(lambda: tetrabench.open(mesh, backend), int(asked / 2), path)}


STEPS: dict[str, Callable[[Path, str], Facts]] = {
    "open": open_file,
    "info": refuse_verb,
    "read": refuse_reading,
    "build": refuse_building,
}


def read(path: Path) -> None:
    """Read a file, and keep nothing."""
    import tetrabench

    tetrabench.read_mesh(path)


def warm(path: Path, backend: str) -> None:
    """Compile, or load, what opening a file of this suffix needs: no part of what the model takes."""
    import tetrabench

    with tempfile.TemporaryDirectory() as folder:
        small = Path(folder) / f"small{path.suffix}"
        tetrabench.write_mesh(tetrabench.generate("nozzle", WARMING), small)
        tetrabench.open(small, backend).close()


def measured(part: Callable[[], Any]) -> tuple[Any, Facts]:
    """What a part returns; how long it took, the resident bytes that it added at its peak, and the most it asked for."""
    from tetrabench.bench.memory import peak_bytes, reset_peak, trim_heap

    asked: list[float] = []
    trim_heap()
    reset_peak()
    before, begin = peak_bytes(), time.monotonic()
    with overheard(asked):
        made = part()
    seconds, peak = time.monotonic() - begin, peak_bytes()
    if before is None or peak is None:
        sys.exit("this system does not tell what a process holds")
    return made, {"seconds": seconds, "peak_bytes": peak - before, "asked_bytes": round(max(asked))}


def estimates(part: Callable[[], object]) -> list[float]:
    """What a part asks for, in bytes."""
    asked: list[float] = []
    with overheard(asked):
        part()
    return asked


def refused(part: Callable[[], object], room: int, path: Path) -> Facts:
    """How a part ends with so many bytes of address space left."""
    from tetrabench.bench.memory import peak_bytes, reset_peak
    from tetrabench.errors import MemoryRefusedError

    limit = address_space() + room
    resource.setrlimit(resource.RLIMIT_AS, (limit, limit))
    reset_peak()
    before, begin = peak_bytes() or 0, time.monotonic()
    try:
        part()
    except MemoryRefusedError as error:
        said, code = str(error).replace(str(path), path.name), error.exit_code
    else:
        said, code = "not refused", 0
    seconds = time.monotonic() - begin
    return {"exit_code": code, "said": said, "seconds": seconds, "peak_bytes": (peak_bytes() or 0) - before}


def address_space() -> int:
    """Bytes of addresses that this process has in use."""
    return int(Path("/proc/self/statm").read_text().split()[0]) * os.sysconf("SC_PAGE_SIZE")


class overheard:  # noqa: N801 - reads as a sentence where it is used
    """Writes down what `refuse_if_too_large` is asked for, wherever it is called."""

    def __init__(self, asked: list[float]) -> None:
        self.asked = asked
        self.places: list[tuple[Any, Any]] = []

    def __enter__(self) -> None:
        from tetrabench import memory

        honest = memory.refuse_if_too_large

        def listening(what: str, needed: float, *more: str) -> None:
            self.asked.append(needed)
            honest(what, needed, *more)

        for name, module in list(sys.modules.items()):
            if name.startswith("tetrabench") and getattr(module, "refuse_if_too_large", None) is honest:
                self.places.append((module, honest))
                module.refuse_if_too_large = listening  # type: ignore[attr-defined]

    def __exit__(self, *_: object) -> None:
        for module, honest in self.places:
            module.refuse_if_too_large = honest


if __name__ == "__main__":
    main()
