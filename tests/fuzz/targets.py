"""What fuzzers try: each target takes the bytes of a file, and fails where these are neither read nor refused as they should.

A refusal is one line that names the file. What is read can be shown. A broken plug-in is skipped, never fatal.
"""

import tempfile
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import msgspec

from tests.report.made import change, make_results
from tetrabench import plugins, registry
from tetrabench.bench import read_results, save_results
from tetrabench.bench.history import add, read_history
from tetrabench.bench.journal import Journal, read_journal
from tetrabench.bench.record import Results
from tetrabench.collision.start.files import read_objects, write_objects
from tetrabench.collision.start.models import generate_objects
from tetrabench.errors import InputError, TetrabenchError
from tetrabench.io import read_mesh, write_mesh
from tetrabench.io.polygons import read_polygons, write_polygons
from tetrabench.mesh.models import generate
from tetrabench.mesh.polygon.models import generate_polygons
from tetrabench.printable import printable
from tetrabench.report.formats import FORMATS

TWO = {"alfa": {"v3y": 1.0, "v4": 2.0}}
SNIPPETS = [
    *(
        "import os",
        "import nothing_of_this_name",
        "raise SystemExit(3)",
        "raise ValueError('a\\nb')",
        "1 / 0",
        "def",
        "(",
        "\x00",
    ),
    *(
        "class Odd:",
        "    name = 'odd'",
        "    family = 'collision'",
        "    family = 'none'",
        "    options = {}",
        "    options = 3",
    ),
    *(
        "    title = trade_off = source = 'x'",
        "    extension = is_exact = is_compiled = True",
        "    stable_refs = True",
    ),
    *(
        "    @property",
        "    def name(self): raise KeyError(self)",
        "    def __getattr__(self, name): return name",
        "    thesis = {}",
    ),
    *("CONTESTANTS = [Odd()]", "CONTESTANTS = 3", "CONTESTANTS = [None, 1, 'x', Odd, Odd()]", "CONTESTANTS = ()"),
    *(
        "SCENARIOS = [Odd()]",
        "MODELS = [Odd()]",
        "FAMILIES = [Odd()]",
        "FAMILIES = [None]",
        "MODELS = {1: 2}",
        "SCENARIOS = None",
    ),
    *(
        "from tetrabench.backends.collision import CONTESTANTS",
        "from tetrabench.scenarios.tetra import SCENARIOS",
        "# \x1b[2J",
    ),
]
"""Lines that plug-ins are made of: a fuzzer chooses among these, for what it writes itself would be run."""


def try_results(data: bytes, folder: Path) -> None:
    """A results file, shown in all forms."""
    run = _read(lambda path: read_results(path), data, folder / "made.json")
    if run is not None:
        for show in FORMATS.values():
            try:
                show(run)
            except TetrabenchError as error:
                _check(error)


def try_journal(data: bytes, folder: Path) -> None:
    """The journal of a run, to go on from."""
    read = _read(read_journal, data, folder / "made.jsonl")
    if read is not None:
        FORMATS["table"](read[0])


def try_history(data: bytes, folder: Path) -> None:
    """A history of runs."""
    _read(read_history, data, folder / "made.jsonl")


def try_polygons(suffix: str) -> Callable[[bytes, Path], None]:
    """A mesh of polygons."""
    return lambda data, folder: _read(read_polygons, data, folder / f"made{suffix}")


def try_objects(suffix: str) -> Callable[[bytes, Path], None]:
    """A start of objects."""
    return lambda data, folder: _read(read_objects, data, folder / f"made{suffix}")


def try_tetras(suffix: str) -> Callable[[bytes, Path], None]:
    """A mesh of tetras."""
    return lambda data, folder: _read(read_mesh, data, folder / f"made{suffix}")


def try_plugin(data: bytes, folder: Path) -> None:
    """A plug-in file of SNIPPETS, one for each byte."""
    path = folder / f"made_{abs(hash(data))}.py"
    path.write_text("\n".join(SNIPPETS[byte % len(SNIPPETS)] for byte in data[:40]))
    with plugins.using([path]), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        registry.forget()
        try:
            assert "kdtree" in [one.name for one in registry.contestants("collision")]
            assert registry.scenarios("collision")
            assert registry.families()
            assert all(printable(sentence) == sentence for sentence in registry.skipped())
        finally:
            path.unlink()
    registry.forget()


TARGETS: dict[str, Callable[[bytes, Path], None]] = {
    "results": try_results,
    "journal": try_journal,
    "history": try_history,
    "plugin": try_plugin,
    "obj": try_polygons(".obj"),
    "off": try_polygons(".off"),
    "ply": try_polygons(".ply"),
    "polygons-npz": try_polygons(".npz"),
    "objects-npz": try_objects(".npz"),
    "objects-csv": try_objects(".csv"),
    "vtu": try_tetras(".vtu"),
}


def seed(name: str, folder: Path) -> bytes:
    """A file that is read, of the kind that a target takes."""
    kind, _, suffix = name.rpartition("-")
    path = folder / f"seed.{suffix}"
    if name in ("results", "journal", "history"):
        run = change(
            make_results(TWO, launches=1, rounds=1), "alfa", "v4", series={"step": [1.0]}, figures={"sum": 1.0}
        )
        if name == "results":
            save_results(run, path)
        elif name == "history":
            add(run, path)
        else:
            first = msgspec.structs.replace(run, samples=[], launches=[], memory=[])
            with path.open("wb") as file:
                journal = Journal(msgspec.convert(msgspec.to_builtins(first), Results), file)
                journal.begin()
                for part in (*run.memory, *run.launches, *run.samples):
                    journal.write(part)
    elif name == "plugin":
        lines = ["class Odd:", "    name = 'odd'", "    family = 'collision'", "CONTESTANTS = [Odd()]"]
        return bytes(map(SNIPPETS.index, lines))
    elif kind == "objects":
        write_objects(generate_objects("uniform", 3), path)
    elif name == "vtu":
        write_mesh(generate("box", 6), path)
    else:
        write_polygons(generate_polygons("quad", 4), path)
    return path.read_bytes()


def attempt(name: str, data: bytes) -> None:
    """Try some bytes, in a folder of their own."""
    with tempfile.TemporaryDirectory() as folder:
        TARGETS[name](data, Path(folder))


def _read(reader: Callable[[Path], Any], data: bytes, path: Path) -> Any:
    """What is read, None where it is refused as it should be."""
    path.write_bytes(data)
    try:
        return reader(path)
    except InputError as error:
        _check(error, path)
        return None


def _check(error: Exception, path: Path | str = "") -> None:
    """One line that names the file; what a person sees of it is printable, see `cli.speech.say`."""
    assert str(path) in str(error), error
    assert len(str(error).splitlines()) == 1, error
