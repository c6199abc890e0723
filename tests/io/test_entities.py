"""XML of strangers: entities that grow without end, or name other files, are refused in one line by each format on XML."""

from pathlib import Path

import pytest

from tetrabench.errors import InputError
from tetrabench.io import read_mesh
from tetrabench.io.values import read_values

XML = pytest.mark.parametrize("suffix", [".vtu", ".xdmf", ".xml"])
ROOT = {".vtu": "VTKFile", ".xdmf": "Xdmf", ".xml": "dolfin"}


def laughs(suffix: str) -> str:
    """Ten entities, each ten times the one before: a gigabyte."""
    lines = ['<!ENTITY a0 "haha">', *(f'<!ENTITY a{n} "{f"&a{n - 1};" * 10}">' for n in range(1, 10))]
    return f"<?xml version='1.0'?><!DOCTYPE x [{''.join(lines)}]><{ROOT[suffix]}>&a9;</{ROOT[suffix]}>"


@XML
def test_entities_that_grow_without_end_are_refused(suffix: str, tmp_path: Path):
    path = tmp_path / f"bomb{suffix}"
    path.write_text(laughs(suffix))
    with pytest.raises(InputError, match=rf"bomb\{suffix}: cannot be read as") as refused:
        read_mesh(path)
    assert "\n" not in str(refused.value)


@XML
def test_entities_do_not_read_other_files(suffix: str, tmp_path: Path):
    (tmp_path / "secret").write_text("a secret")
    path = tmp_path / f"spy{suffix}"
    entity = f"<!DOCTYPE x [<!ENTITY s SYSTEM 'file://{tmp_path}/secret'>]>"
    path.write_text(f"<?xml version='1.0'?>{entity}<{ROOT[suffix]} type='&s;'>&s;</{ROOT[suffix]}>")
    with pytest.raises(InputError) as refused:
        read_mesh(path)
    assert "a secret" not in str(refused.value)


def test_values_are_read_no_other_way(tmp_path: Path):
    (tmp_path / "bomb.vtu").write_text(laughs(".vtu"))
    with pytest.raises(InputError, match=r"bomb\.vtu: cannot be read as"):
        read_values(tmp_path / "bomb.vtu")
