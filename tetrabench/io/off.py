"""OFF, with cells of any number of nodes: meshio knows triangles alone.

A file is lines of numbers: OFF, how many points, cells and edges (nobody counts these), the coordinates of each point, and
for each cell how many nodes it has, and which, from 0. What follows in a line is colours; # begins a comment. (Geomview's
manual, chapter 4.2.5, without the prefixes that announce more than three coordinates a point.)
"""

from collections.abc import Iterator
from itertools import chain, islice, pairwise
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError


def read_off(path: Path) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    """Points (n, 3) float64, and the starts (m + 1,) and nodes (s,) of the cells, int64, as in PolygonMesh.

    Raises:
        InputError: no such file, another kind of OFF, or fewer points or cells than the file announces.
    """
    try:
        with path.open(encoding="utf-8", errors="replace") as file:
            lines = (words for line in file if (words := line.partition("#")[0].split()))
            return _read(path, lines)
    except OSError as error:
        raise InputError(f"{path}: cannot be read: {error.strerror or error}") from error
    except ValueError as error:
        raise InputError(f"{path}: cannot be read as OFF: {error}") from error


def _read(path: Path, lines: Iterator[list[str]]) -> tuple[NDArray[np.float64], NDArray[np.int64], NDArray[np.int64]]:
    head = next(lines, [""])
    if head[0] != "OFF":
        raise InputError(f"{path}: begins with {head[0][:20]!r}, not with OFF; other kinds of it are not read")
    counts = head[1:] or next(lines, [])
    if len(counts) < 2:
        raise InputError(f"{path}: does not say how many points and cells it holds")
    wanted = int(counts[0]), int(counts[1])
    points = [words[:3] for words in islice(lines, max(wanted[0], 0))]
    cells = [(int(words[0]), words) for words in islice(lines, max(wanted[1], 0))]
    found = len(points), len(cells)
    if found != wanted:
        told = "announces {:,} points and {:,} cells and holds {:,} and {:,}".format(*wanted, *found)
        raise InputError(f"{path}: {told}; is it cut?")
    for number, (size, words) in enumerate(cells):
        if not 0 <= size < len(words):
            raise InputError(f"{path}: cell {number} announces {size} nodes and holds {len(words) - 1}; is it cut?")
    starts = np.append(0, np.cumsum([size for size, _ in cells], dtype=np.int64))
    nodes = chain.from_iterable(words[1 : size + 1] for size, words in cells)
    return (
        np.array(points, np.float64).reshape(-1, 3),
        starts,
        np.fromiter(map(int, nodes), np.int64, int(starts[-1])),
    )


def write_off(points: NDArray[np.float64], starts: NDArray[np.int32], nodes: NDArray[np.int32], path: Path) -> None:
    """Write points (n, 3) and cells, as in PolygonMesh; coordinates with all their digits."""
    bounds, names = starts.tolist(), list(map(str, nodes.tolist()))
    with path.open("w", encoding="ascii") as file:
        file.write(f"OFF\n{len(points)} {len(bounds) - 1} 0\n")
        file.writelines(f"{x!r} {y!r} {z!r}\n" for x, y, z in points.tolist())
        file.writelines(f"{end - begin} {' '.join(names[begin:end])}\n" for begin, end in pairwise(bounds))
