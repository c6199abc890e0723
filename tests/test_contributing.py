"""An eighth contestant, added by the text of CONTRIBUTING.md alone."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from numba import config

from tetrabench import registry

ROOT = Path(__file__).parents[1]


@pytest.mark.skipif(bool(config.DISABLE_JIT), reason="runs workers, which take minutes without the JIT")
def test_the_text_adds_a_contestant(tmp_path):
    text = (ROOT / "CONTRIBUTING.md").read_text()
    files = dict(re.findall(r"`([\w.]+)`:\n\n```\w+\n(.*?)```", text, re.DOTALL))
    assert set(files) == {"pyproject.toml", "hotcold.py"}
    folder, site = tmp_path / "hotcold", tmp_path / "site"
    folder.mkdir()
    for name, content in files.items():
        (folder / name).write_text(content)
    pip = [
        sys.executable,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--no-deps",
        "--no-build-isolation",
        "--target",
        site,
        folder,
    ]
    subprocess.run([str(word) for word in pip], check=True, capture_output=True)

    def tetrabench(*arguments):
        environment = {**os.environ, "PYTHONPATH": str(site)}
        command = [sys.executable, "-m", "tetrabench", *arguments]
        done = subprocess.run(command, env=environment, capture_output=True, text=True, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        return done.stdout

    assert "hotcold*" in tetrabench("list", "backends")
    run = [
        "run",
        "--model",
        "nozzle",
        "--tets",
        "2000",
        "--backend",
        "v3y,hotcold",
        "--rounds",
        "1",
        "-o",
        "out.json",
    ]
    tetrabench(*run)
    samples = json.loads((tmp_path / "out.json").read_text())["samples"]
    scenarios = {sample["task"] for sample in samples}
    assert scenarios == {scenario.name for scenario in registry.scenarios("tetra")}
    for scenario in scenarios:
        answers = {(s["backend"], s["status"], s["digest"]) for s in samples if s["task"] == scenario}
        assert len(answers) == 3  # the control too
        assert {status for _, status, _ in answers} == {"ok"}
        assert len({digest for _, _, digest in answers}) == 1
