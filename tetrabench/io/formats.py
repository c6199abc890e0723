"""Every format but Nastran, read and written through meshio (5.3), with its failures caught.

| format | suffixes | coordinates written | ids |
|---|---|---|---|
| Gmsh 4.1 (read: 2.2, 4.0, 4.1) | .msh | exact, binary | from 1 |
| VTK legacy 5.1 (read: all) | .vtk | exact, binary | kept |
| VTK XML | .vtu | exact, binary | kept |
| Medit | .mesh | exact, 17 digits | from 1 |
| Medit binary | .meshb | exact, binary | from 1 |
| Abaqus (one flat *NODE block) | .inp | exact, 17 digits | from 1 |
| XDMF (read: also with data in .h5) | .xdmf .xmf | exact, 17 digits | kept |
| SU2 | .su2 | exact, 19 digits | from 1 |
| TetGen | .ele with .node, either is named | exact, 17 digits | from 1 |
| MOAB | .h5m | exact, binary | from 1 |
| Salome | .med | exact, binary | from 1 |
| Exodus II | .e .exo .ex2 | exact, binary | from 1 |
| AVS UCD | .avs | exact, 17 digits | from 1 |
| DOLFIN XML | .xml | exact, 17 digits | from 1 |
| Netgen | .vol | exact, 17 digits | from 1 |
| surfaces: STL, PLY, OBJ, OFF | .stl .ply .obj .off | no tetras; see `tetrabench.io.polygons` | |

"Kept" are ids in two arrays of the file, `point_id` and `tetra_id`; a file without them is numbered from 1 in its own
order, whatever labels it has: meshio does not hand them on.

Other formats of meshio are left out because it hangs on files that are cut or no mesh at all (Ansys, MDPA, Tecplot), loses
cells of such files without a word (FLAC3D, PERMAS), cannot read what it writes (UGRID), or has no more than a draft of them
(CGNS, HMF).
"""

import contextlib
import io
import mmap
import os
import re
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from tetrabench.drafts import drafted
from tetrabench.errors import InputError, MemoryRefusedError
from tetrabench.memory import held_to_available, refuse_if_too_large
from tetrabench.mesh.check import settle
from tetrabench.mesh.tetra_mesh import MeshReport, TetraMesh

POINT_ID, TETRA_ID = "point_id", "tetra_id"
Values = Mapping[str, NDArray[np.float64]]


@dataclass(frozen=True)
class Format:
    """A row of FORMATS.

    Attributes:
        name: meshio's name.
        title: the name for a person.
        suffixes: in small letters.
        room: bytes of memory that reading takes at its peak, for each byte of the files; measured, rounded up.
        writes: whether it can hold tetras.
        options: for meshio's writer.
        keeps_ids: whether it can hold arrays of whole numbers for points and cells.
        keeps_values: whether it can hold numbers of tetras by name.
        doubt: says from the text of the file, and the number of cells that meshio found, why the mesh may be less than
            the file's; "" where it is not.
        last_line: what the last line of a file that is surely whole begins with; any other is worth a warning.
        prepare: what is given to meshio instead of the file's path, where it takes files for other ones.
    """

    name: str
    title: str
    suffixes: tuple[str, ...]
    room: float
    writes: bool = True
    options: Mapping[str, Any] = field(default_factory=dict)
    keeps_ids: bool = False
    keeps_values: bool = False
    doubt: Callable[[mmap.mmap, Counter[str]], str] = lambda text, cells: ""
    last_line: bytes = b""
    prepare: Callable[[Path], Any] = lambda path: path


class NoCellsError(InputError):
    """A file without cells of the kind that was asked for; it may hold others."""


@dataclass
class Raw:
    """What meshio makes of a file.

    Attributes:
        form: the format.
        mesh: a meshio.Mesh, with whatever is in it.
        points: its points, (n, 3) float64 in any proper file.
        cells: how many there are of each of meshio's kinds.
        said: the warnings of meshio, once `raw_mesh` is left.
    """

    form: Format
    mesh: Any
    points: NDArray[np.float64]
    cells: Counter[str]
    said: list[str]

    @property
    def values(self) -> list[str]:
        """The names of what the file holds for its points and its cells, ids aside."""
        names = [*self.mesh.point_data, *self.mesh.cell_data]
        return sorted({str(name) for name in names} - {POINT_ID, TETRA_ID})


@contextlib.contextmanager
def raw_mesh(path: str | os.PathLike[str]) -> Iterator[Raw]:
    """Let meshio read a file in one of FORMATS, chosen by its suffix, and take what is wanted of it.

    TetGen's and XDMF's second file is found beside it.

    Raises:
        InputError: `path: reason` for a file that meshio cannot read, or that makes whoever takes it fail: meshio hands
            on whatever it made of a file, mesh or not; and for a file that may be cut.
    """
    form = BY_SUFFIX[Path(path).suffix.lower()]
    files = [Path(path), *(file for file in partners(Path(path)) if file.is_file())]
    refuse_if_too_large(f"reading {path}", form.room * sum(map(size_of, files)))
    with meshio_at_work(f"{path}: cannot be read as {form.title}") as said:
        import meshio  # takes a while, so not before it is needed

        mesh = meshio.read(form.prepare(Path(path)), file_format=form.name)
        points = np.array(mesh.points, np.float64, order="C", ndmin=2)
        cells: Counter[str] = Counter()
        for block in mesh.cells:
            cells[block.type] += len(block.data)
        yield Raw(form, mesh, points, cells, said)
    for file in files:
        with mapped(file) as text:
            reason = form.doubt(text, cells)
        if reason:
            raise InputError(f"{file}: {reason}")
    if form.last_line and not last_line(Path(path)).startswith(form.last_line):
        said.append(f"its last line belongs to the mesh; {form.title} files that are cut look the same")


def read_foreign(path: str | os.PathLike[str], *, unused: str = "drop", repair: str = "refuse") -> TetraMesh:
    """Read the tetras of a file in one of FORMATS, chosen by its suffix.

    Tetras with midside nodes are taken by their corners, and counted in `report.quadratic`; other cells are counted in
    `report.skipped`.

    Args:
        path: the file.
        unused: see `settle`.
        repair: see `settle`.

    Raises:
        NoCellsError: it holds other cells, or none.
        InputError: what `raw_mesh` and `settle` refuse.
    """
    with raw_mesh(path) as raw:
        points, blocks = raw.points, raw.mesh.cells
        tetras = [number for number, block in enumerate(blocks) if is_tetra(block.type) and len(block.data)]
        corners = [np.asarray(blocks[number].data)[:, :4].astype(np.int64) for number in tetras]
        point_ids = ids_among(raw.mesh.point_data, POINT_ID, [slice(None)], len(points))
        tet_ids = ids_among(raw.mesh.cell_data, TETRA_ID, tetras, sum(map(len, corners)))
        values = raw.values
    if not tetras:
        raise NoCellsError(f"{path}: holds no tetras; it holds {list_cells(raw.cells)}")
    if points.shape[1] != 3:
        raise InputError(f"{path}: its points have {points.shape[1]} coordinates, not 3")
    report = MeshReport(
        source=str(path),
        format=raw.form.title,
        skipped={kind: count for kind, count in raw.cells.most_common() if count and not is_tetra(kind)},
        quadratic=sum(count for kind, count in raw.cells.items() if is_tetra(kind) and kind != "tetra"),
        values=values,
        warnings=[f"{path}: {sentence}" for sentence in raw.said],
    )

    def where(kind: str, row: int) -> str:
        return f"{path}: {kind} {(point_ids if kind == 'point' else tet_ids)[row]}"

    mesh = TetraMesh(points, np.concatenate(corners), point_ids, tet_ids, report)
    return settle(mesh, where=where, unused=unused, repair=repair)


def write_foreign(mesh: TetraMesh, path: str | os.PathLike[str], values: Values | None = None) -> None:
    """Write a mesh in one of FORMATS, chosen by the suffix: a whole file (TetGen: two), or none.

    Args:
        mesh: what to write.
        path: the file.
        values: of the tetras, by name, (m,) float64 each, where the format keeps any: `read_values` reads them.

    Raises:
        InputError: meshio or the system cannot write the file.
    """
    form = BY_SUFFIX[Path(path).suffix.lower()]
    ids = {TETRA_ID: mesh.tet_ids} if form.keeps_ids else {}
    data = {
        "point_data": {POINT_ID: mesh.point_ids} if form.keeps_ids else {},
        "cell_data": {name: [numbers] for name, numbers in {**ids, **(values or {})}.items()},
    }
    with drafted(path) as draft, meshio_at_work(f"{path}: cannot be written as {form.title}"):
        import meshio

        raw = meshio.Mesh(mesh.points, [("tetra", mesh.tets)], **data)
        meshio.write(draft, raw, file_format=form.name, **form.options)


def size_of(file: Path) -> int:
    """Bytes of a file that holds something."""
    try:
        with mapped(file) as text:
            # meshio looks for the first line of TetGen's files beyond their end, for ever.
            if re.search(rb"(?m)^[ \t]*[^#\s]", text):
                return len(text)
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror or error}") from error
    except ValueError:  # nothing can be mapped
        pass
    raise InputError(f"{file}: is empty")


def last_line(file: Path) -> bytes:
    """The last line of a file."""
    with mapped(file) as text:
        return text[text.rfind(b"\n", 0, len(text) - 1) + 1 :]


@contextlib.contextmanager
def mapped(file: Path) -> Iterator[mmap.mmap]:
    """The text of a file, not read before it is looked at."""
    with open(file, "rb") as stream, mmap.mmap(stream.fileno(), 0, access=mmap.ACCESS_READ) as text:
        yield text


def partners(path: Path) -> list[Path]:
    """The files that may belong to a file of two."""
    suffixes = {".ele": [".node"], ".node": [".ele"], ".xdmf": [".h5"], ".xmf": [".h5"]}
    return [path.with_suffix(suffix) for suffix in suffixes.get(path.suffix.lower(), [])]


@contextlib.contextmanager
def meshio_at_work(failure: str) -> Iterator[list[str]]:
    """Turn whatever meshio does instead of its work into one InputError, and keep what it prints.

    It raises anything, ends the process with SystemExit, tells the reason on stdout alone, and takes as much memory as
    a damaged file tells it to.

    Args:
        failure: what has failed, when it has.

    Yields:
        A list, filled at the end with the warnings of meshio.
    """
    said: list[str] = []
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
        try:
            with held_to_available(), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                # numpy still takes a number that is none for the end of the data.
                warnings.filterwarnings("error", "string or file could not be read to its end")
                yield said
        except MemoryError as error:
            raise MemoryRefusedError(f"{failure}: it needs more memory than there is, or it is damaged") from error
        except InputError:  # ours
            raise
        except (Exception, SystemExit) as error:
            told = " ".join(out.getvalue().split()) if isinstance(error, SystemExit) else first_line(error)
            raise InputError(
                f"{failure}: {told or 'meshio refuses it and gives no reason; it may be damaged'}"
            ) from error
    parts = re.split(r"\b(?:Warning|Info|Error): ", err.getvalue())[1:]
    said += dict.fromkeys(" ".join(part.split()) for part in parts)


def first_line(error: BaseException) -> str:
    """What an error says, in one line, with its kind where that is not said better."""
    text = " ".join(str(error).split())
    if isinstance(error, OSError) and error.strerror:
        return f"{error.strerror}: {error.filename}" if error.filename else error.strerror
    if isinstance(error, ModuleNotFoundError):
        return f"{error.name} is missing; pip install 'tetrabench[formats]' brings it"
    if type(error).__name__ in ("ReadError", "WriteError"):  # meshio's own
        return text
    return f"{type(error).__name__}: {text}" if text else type(error).__name__


def list_cells(cells: Counter[str]) -> str:
    """What cells a file holds, in words."""
    return ", ".join(f"{kind} {count:,}" for kind, count in cells.items() if count) or "no cells at all"


def is_tetra(kind: str) -> bool:
    """Whether cells of this kind are tetras, of any order. Their first four nodes are the corners."""
    return kind.startswith("tetra") or kind == "VTK_LAGRANGE_TETRAHEDRON"


def ids_among(data: Mapping[str, Any], name: str, blocks: Sequence[Any], count: int) -> NDArray[np.int64]:
    """Ids as they stand in some blocks of the file's data, where they are numbers for all; else the numbers from 1."""
    ids = np.concatenate([data[name][block] for block in blocks]) if name in data and blocks else np.empty(0)
    if ids.shape == (count,) and ids.dtype.kind in "iu":
        return ids.astype(np.int64)
    return np.arange(1, count + 1, dtype=np.int64)


# Where meshio takes what there is of a file for all of it.


def doubt_vtk(text: mmap.mmap, cells: Counter[str]) -> str:
    """meshio stops at the end of the file, however many cells are announced."""
    return doubt_count(re.findall(rb"(?m)^CELL_TYPES[ \t]+(\d+)", text), sum(cells.values()))


def doubt_su2(text: mmap.mmap, cells: Counter[str]) -> str:
    """As VTK. `NELEM` counts the cells of the volume; those of the surface stand in markers. In the plane there is none."""
    if re.search(rb"(?m)^[ \t]*NDIME[ \t]*=[ \t]*2\b", text):
        return ""
    volume = sum(cells[kind] for kind in ("tetra", "hexahedron", "wedge", "pyramid"))
    return doubt_count(re.findall(rb"(?m)^[ \t]*NELEM[ \t]*=[ \t]*(\d+)", text), volume) or doubt_last_line(text)


def doubt_count(announced: list[bytes], found: int) -> str:
    """Compare the number of cells that a file announces with that of those that are there."""
    wanted = sum(map(int, announced))
    return f"announces {wanted:,} cells and holds {found:,}; is it cut?" if announced and wanted != found else ""


def doubt_end(mark: bytes) -> Callable[[mmap.mmap, Counter[str]], str]:
    """Look for the line at the end."""

    def doubt(text: mmap.mmap, cells: Counter[str]) -> str:
        return "" if re.search(rb"(?m)^[ \t]*" + mark, text) else f"has no line {mark.decode()!r}; is it cut?"

    return doubt


def doubt_last_line(text: mmap.mmap, cells: object = None) -> str:
    """A last line that is none may end within a number."""
    return "" if text[-1:] == b"\n" else "ends within a line; is it cut? if not, end that line"


def doubt_abaqus(text: mmap.mmap, cells: Counter[str]) -> str:
    """meshio keeps the last *NODE block alone, and ignores keywords and parameters that make, move or hold others."""
    blocks = len(re.findall(rb"(?mi)^\*node[ \t]*(?:,|\r?$)", text))
    if blocks > 1:
        return f"has {blocks} *NODE blocks, and meshio takes the last alone; write it as one flat mesh, without parts"
    beyond = re.search(
        rb"(?mi)^\*(?:ngen|nfill|ncopy|nmap|elgen|elcopy|system)\b"
        rb"|^\*(?:node|element)\b[^\n]*\binput[ \t]*=|^\*node\b[^\n]*\bsystem[ \t]*=[ \t]*[cs]",
        text,
    )
    if beyond:
        keyword = beyond[0].decode("latin-1").strip()
        return f"uses {keyword!r}, which meshio ignores; write it as one flat mesh"
    return doubt_last_line(text)


def doubt_ply(text: mmap.mmap, cells: Counter[str]) -> str:
    """meshio takes what there is of a file that is cut."""
    announced = re.findall(rb"(?m)^element face (\d+)", text[: text.find(b"end_header")])
    return doubt_count(announced, sum(cells.values()))


def prepare_ply(path: Path) -> io.BytesIO:
    """Both names that the nodes of a face go by are usual, and meshio takes the cells for none under one of them.

    Raises:
        InputError: a binary file with values of its faces, where meshio loses its place; or a head without an end, which
            it looks for beyond the end of the file, for ever.
    """
    data = path.read_bytes()
    end = re.search(rb"(?m)^[ \t]*end_header[ \t\r]*$", data)
    if end is None:
        raise InputError(f"{path}: has no line 'end_header'; is it cut?")
    head, rest = data[: end.start()], data[end.start() :]
    if b"format ascii" not in head and head[head.find(b"element face") :].count(b"\nproperty ") > 1:
        raise InputError(f"{path}: has values of its faces, such as colours; write it without them, or as text")
    head = re.sub(rb"(?m)^(property list \w+ \w+) vertex_index\b", rb"\1 vertex_indices", head)
    return io.BytesIO(head + rest)


def prepare_gmsh(path: Path) -> Path:
    """Ansys Fluent's files have the same suffix, and are what meshio writes into it unless it is told otherwise.

    Raises:
        InputError: it is one of these.
    """
    with mapped(path) as text:
        if re.match(rb"\s*\(", text):
            raise InputError(
                f"{path}: is a mesh of Ansys Fluent, and .msh is read as Gmsh's; meshio writes that with file_format='gmsh'"
            )
    return path


def prepare_obj(path: Path) -> io.StringIO:
    """meshio refuses normals and textures that are not as many as the points, and takes colours for coordinates."""
    with path.open(encoding="utf-8", errors="replace") as file:
        lines = (line.split() for line in file if line.startswith(("v ", "f ", "v\t", "f\t")))
        return io.StringIO("".join(" ".join(words[:4] if words[0] == "v" else words) + "\n" for words in lines))


FORMATS = (
    Format("gmsh", "Gmsh", (".msh",), room=7, keeps_values=True, prepare=prepare_gmsh),
    Format("vtk", "VTK", (".vtk",), room=6, keeps_ids=True, keeps_values=True, doubt=doubt_vtk),
    Format("vtu", "VTK XML", (".vtu",), room=15, keeps_ids=True, keeps_values=True),
    Format("medit", "Medit", (".mesh", ".meshb"), room=5),
    Format("abaqus", "Abaqus", (".inp",), room=10, doubt=doubt_abaqus, last_line=b"*"),
    Format(
        "xdmf", "XDMF", (".xdmf", ".xmf"), room=12, options={"data_format": "XML"}, keeps_ids=True, keeps_values=True
    ),
    Format("su2", "SU2", (".su2",), room=14, doubt=doubt_su2),
    Format("tetgen", "TetGen", (".ele", ".node"), room=4, doubt=doubt_last_line),
    Format("h5m", "MOAB", (".h5m",), room=12),
    Format("med", "Salome", (".med",), room=5),
    Format("exodus", "Exodus II", (".e", ".exo", ".ex2"), room=7),
    Format("avsucd", "AVS UCD", (".avs",), room=9, doubt=doubt_last_line),
    Format("dolfin-xml", "DOLFIN XML", (".xml",), room=4),
    Format("netgen", "Netgen", (".vol",), room=11, doubt=doubt_end(b"endmesh")),
    Format("stl", "STL", (".stl",), room=10, writes=False),
    Format("ply", "PLY", (".ply",), room=28, writes=False, doubt=doubt_ply, prepare=prepare_ply),
    Format("obj", "OBJ", (".obj",), room=13, writes=False, doubt=doubt_last_line, prepare=prepare_obj),
    Format("off", "OFF", (".off",), room=10, writes=False),
)
BY_SUFFIX = {suffix: form for form in FORMATS for suffix in form.suffixes}
