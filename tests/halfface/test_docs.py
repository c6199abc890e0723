"""docs/halfface.md is true: its example runs, its tables name what there is, and all that there is."""

import re
from pathlib import Path

import numpy as np

from tetrabench.backends.tetra.halfface import HalfFaceMesh
from tetrabench.backends.tetra.halfface.sets import ElementSet
from tetrabench.backends.tetra.halfface.storage import HalfFaces

PAGE = (Path(__file__).parents[2] / "docs" / "halfface.md").read_text()


def public(cls: type) -> set[str]:
    return {name for name in dir(cls) if not name.startswith("_")}


def tables_after(heading: str) -> list[list[str]]:
    """The rows of the tables of a section, as their cells."""
    section = PAGE.split(f"## {heading}\n")[1].split("\n## ")[0]
    rows = [line for line in section.splitlines() if line.startswith("|") and not line.startswith("|---")]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", row)[1:-1]] for row in rows]


def named(cell: str, other: str) -> set[str]:
    return set(re.findall(r"`(\w+)`", other if cell == "the same" else cell))


def test_the_tables_of_operations_are_complete():
    rows = tables_after("Operations")
    heading = next(n for n, row in enumerate(rows) if row[0].startswith("the source (5.2, 5.8)"))
    of_mesh = set().union(*(named(here, source) for source, here in rows[1:heading]))
    of_sets = set().union(*(named(here, source) for source, here in rows[heading + 1 :]))
    there = public(HalfFaceMesh) | {"INVALID", "bits", "reuse_vertices", "manifold", "HalfFaceMesh"}
    assert of_mesh <= there
    assert public(HalfFaceMesh) <= of_mesh
    assert of_sets - {"in", "len"} <= public(ElementSet)


def test_the_table_of_arrays_is_complete():
    arrays = {name for row in tables_after("What is stored")[1:] for name in re.findall(r"`(\w+)`", row[0])}
    assert arrays == set(HalfFaces._fields) - {"counters", "queue", "table", "walk"}


def test_the_examples_run(capsys, tmp_path, monkeypatch):
    # a kernel is cached by its file, so the examples become one
    (tmp_path / "halfface_examples.py").write_text("\n".join(re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)))
    monkeypatch.syspath_prepend(tmp_path)
    import halfface_examples

    first, second, third = capsys.readouterr().out.splitlines()
    assert first.endswith("True False")
    assert second.endswith("[]")
    assert int(third) == np.bincount(halfface_examples.mesh.connectivity.ravel()).max()
