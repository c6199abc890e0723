"""OBJ, with cells of any number of nodes, also such as are named relative to the last one: meshio takes these for others.

A file is statements, a line each: v and three coordinates, f and the nodes of a cell, from 1 or, below 0, from the last
one so far, each perhaps with its texture and its normal behind slashes. A backslash at the end of a line goes on in the next
one, # begins a comment. Lines, points and free forms are counted and skipped; groups, materials and the like are no part of a
mesh. (Wavefront, Advanced Visualizer manual, appendix B1.)
"""

from array import array
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError

SKIPPED = {"l": "line", "p": "vertex", "curv": "curve", "curv2": "curve", "surf": "surface"}


def read_obj(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64], Counter[str]]:
    """Points (n, 3) float64, the starts (m + 1,) and nodes (s,) of the cells, int64, as in PolygonMesh; what is skipped.

    Raises:
        InputError: no such file, one that may be cut, or a statement that makes no sense: says in which line.
    """
    points, sizes, nodes, skipped = array("d"), array("q"), array("q"), Counter[str]()
    number = 0
    try:
        with path.open(encoding="utf-8", errors="replace") as file:
            for number, words in _statements(path, file):  # noqa: B007 - for the error, too
                if words[0] == "v":
                    points.extend(_place(words[1:]))
                elif words[0] == "f":
                    sizes.append(len(words) - 1)
                    nodes.extend(_node(word, len(points) // 3) for word in words[1:])
                elif words[0] in SKIPPED:
                    skipped[SKIPPED[words[0]]] += 1
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
    except (ValueError, OverflowError) as error:
        raise InputError(f"{path}:{number}: cannot be read as OBJ: {error}") from error
    starts = np.append(0, np.cumsum(np.array(sizes, np.int64)))
    return np.array(points, np.float64).reshape(-1, 3), starts, np.array(nodes, np.int64), skipped


def _statements(path: Path, lines: Iterable[str]) -> Iterator[tuple[int, list[str]]]:
    """The words of each statement, and the number of the line that it ends in."""
    begun: list[str] = []
    for number, line in enumerate(lines, 1):
        if not line.endswith("\n"):
            raise InputError(f"{path}: ends within a line; is it cut?")
        text = line.partition("#")[0].strip()
        begun += text.removesuffix("\\").split()
        if begun and not text.endswith("\\"):
            yield number, begun
            begun = []
    if begun:
        raise InputError(f"{path}: ends within a statement; is it cut?")


def _place(words: list[str]) -> list[float]:
    """Three coordinates; a weight or a colour may follow, and z may be left out."""
    if len(words) < 2:
        raise ValueError(f"a point of {len(words)} coordinates")
    return [*map(float, words[:3]), *[0.0] * (3 - len(words))]


def _node(word: str, so_far: int) -> int:
    """The row of a node: `word` counts from 1, or below 0 back from the last of `so_far`."""
    named = int(word.partition("/")[0])
    row = named - 1 if named > 0 else so_far + named
    if named == 0 or row < 0:
        raise ValueError(f"a cell names node {named}, and {so_far:,} are there so far")
    return row
