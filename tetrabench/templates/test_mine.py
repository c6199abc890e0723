"""mine keeps to the rules of its family, those of `tetrabench check --contestant mine`."""

from importlib.metadata import entry_points
from pathlib import Path

import pytest

import tetrabench


def test_it_keeps_to_the_rules(monkeypatch: pytest.MonkeyPatch) -> None:
    """In plain Python, with bounds checks, and compiled: one to three minutes."""
    if not entry_points(group="tetrabench.contestants", value="mine:CONTESTANTS"):  # it is not installed: find it here
        monkeypatch.setenv("TETRABENCH_PLUGINS", str(Path(__file__).with_name("mine.py")))
    verdicts = tetrabench.check_contestant("mine", "FAMILY")
    assert [f"{one.rule}, {one.mode}: {fault}" for one in verdicts for fault in one.faults] == []
    assert any(one.status == "sound" for one in verdicts)
