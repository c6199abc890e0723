"""The scripted plug-in, installed for this process and for the workers that it spawns."""

import os
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tetrabench import registry

PLUGIN = Path(__file__).with_name("scripted_plugin.py")
ENTRY_POINTS = """
[tetrabench.families]
scripted = scripted_plugin:FAMILY
[tetrabench.contestants]
scripted = scripted_plugin:CONTESTANTS
[tetrabench.scenarios]
scripted = scripted_plugin:SCENARIOS
"""


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[..., None]]:
    """install(distribution, entry_points, **modules): a distribution that lasts as long as the test."""

    def install(distribution: str, entry_points: str, **modules: str) -> None:
        folder = tmp_path / distribution
        metadata = folder / f"{distribution}-1.0.dist-info"
        metadata.mkdir(parents=True)
        (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {distribution}\nVersion: 1.0\n")
        (metadata / "entry_points.txt").write_text(entry_points)
        for name, text in modules.items():
            (folder / f"{name}.py").write_text(text)
        monkeypatch.syspath_prepend(folder)
        monkeypatch.setenv("PYTHONPATH", str(folder), prepend=os.pathsep)
        registry.forget()

    yield install
    registry.forget()


@pytest.fixture
def plugin(install: Callable[..., None], monkeypatch: pytest.MonkeyPatch) -> None:
    """The family `scripted`."""
    monkeypatch.delitem(__import__("sys").modules, "scripted_plugin", raising=False)
    install("scripted", ENTRY_POINTS, scripted_plugin=PLUGIN.read_text())
