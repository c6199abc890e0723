"""docs/polygon.md is true: its examples run, its table names the formats that there are, with their formulas."""

import re
from pathlib import Path

import numpy as np
import pytest
from numba import config

from tetrabench.backends.polygon import CONTESTANTS

PAGE = (Path(__file__).parents[2] / "docs" / "polygon.md").read_text()


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="compiled examples, on meshes too large without")
def test_the_examples_run(tmp_path, monkeypatch, capsys):
    # a kernel is cached by its file, so the examples become one
    (tmp_path / "polygon_examples.py").write_text("\n".join(re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)))
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.chdir(tmp_path)
    import polygon_examples as examples

    assert len(examples.net) == 10_000
    assert examples.most_neighbours(examples.net.storage, examples.out) == np.diff(examples.net.to_mesh().starts).max()
    assert capsys.readouterr().out.count("[") == 7


def test_the_table_is_that_of_the_formats():
    table = PAGE.split("## As a library")[0].splitlines()
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table if line.startswith("|")]
    shown = {row[0]: row[-1] for row in rows[2:]}
    assert shown == {one.name + " *" * one.extension: one.values for one in CONTESTANTS}
