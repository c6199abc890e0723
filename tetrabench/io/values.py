"""What a file holds for each tetra besides its vertices: numbers by name, such as the states that `write_mesh` keeps."""

import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tetrabench.io.formats import BY_SUFFIX, TETRA_ID, is_tetra, meshio_at_work, partners, size_of
from tetrabench.memory import refuse_if_too_large


def read_values(path: str | os.PathLike[str]) -> dict[str, NDArray[np.float64]]:
    """Read the numbers of the tetras of a file, in the order in which `read_mesh` gives these.

    Args:
        path: the file, of a suffix that `read_mesh` knows.

    Returns:
        Name -> (m,) float64. Vectors and ids are left out, as is what not every tetra has. None in formats that hold no
        values, Nastran among them.

    Raises:
        InputError: meshio cannot read the file.
    """
    form = BY_SUFFIX.get(Path(path).suffix.lower())
    if form is None or not form.keeps_values:
        return {}
    files = [Path(path), *(file for file in partners(Path(path)) if file.is_file())]
    refuse_if_too_large(f"reading {path}", form.room * sum(map(size_of, files)))
    with meshio_at_work(f"{path}: cannot be read as {form.title}"):
        import meshio

        raw = meshio.read(path, file_format=form.name)
        tetras = [number for number, block in enumerate(raw.cells) if is_tetra(block.type) and len(block.data)]
        count = sum(len(raw.cells[number].data) for number in tetras)
        values = {}
        for name, blocks in raw.cell_data.items():
            numbers = np.concatenate([blocks[number] for number in tetras]) if tetras else np.empty(0)
            is_value = name != TETRA_ID and not name.startswith("gmsh:")  # those are numbers of its groups
            if is_value and numbers.shape == (count,) and numbers.dtype.kind in "iuf":
                values[name] = numbers.astype(np.float64)
    return values
