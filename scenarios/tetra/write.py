"""write: the net to disk, as a Nastran file. From the thesis' assignment page."""

import tempfile
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from tetrabench.io import read_mesh, write_mesh
from tetrabench.jit.mix import mixed_with
from tetrabench.protocols import Answer, Options, Work
from tetrabench.scenarios.tetra.base import TetraScenario
from tetrabench.tetra.net import TetraNet


class Writing(NamedTuple):
    """Which net goes into which folder."""

    net: TetraNet
    folder: tempfile.TemporaryDirectory[str]

    @property
    def path(self) -> Path:
        """The file."""
        return Path(self.folder.name) / "net.nas"


class Write(TetraScenario):
    """Gather the tetras in iteration order and write them with the points. Includes what the file system takes."""

    name = "write"
    title = "write the net to disk as a Nastran file"

    def prepare(self, stage: Any, options: Options) -> Writing:
        """A net, and a folder that goes when the sample goes."""
        return Writing(stage.net(), tempfile.TemporaryDirectory(prefix="tetrabench-"))

    def run(self, writing: Writing) -> None:
        """Write it."""
        write_mesh(writing.net.to_mesh(), writing.path)

    def answer(self, writing: Writing, outcome: None) -> Answer:
        """What the file says when it is read back: its tetras and the bits of its coordinates, in order."""
        mesh = read_mesh(writing.path)
        size = writing.path.stat().st_size
        writing.folder.cleanup()
        words = np.concatenate([mesh.points.view(np.uint64).ravel(), mesh.tets.astype(np.uint64).ravel()])
        weights = np.arange(1, 2 * len(words), 2, dtype=np.uint64)  # odd: no word is lost in the product
        total = int((words * weights).sum(dtype=np.uint64))
        figures = {"points": len(mesh.points), "tetras": len(mesh.tets), "bytes": size}
        return Answer(mixed_with(total, len(mesh.points), len(mesh.tets)), figures)

    def work(self, writing: Writing, outcome: None) -> Work:
        """Written tetras."""
        return Work(len(writing.net), "tetras")
