"""What fuzzers found, and seeds of theirs: tried again. `python -m tests.fuzz` looks for more."""

from pathlib import Path

import pytest

from tests.fuzz.targets import TARGETS, attempt, seed

CORPUS = Path(__file__).parent / "corpus"
KEPT = sorted(path for path in CORPUS.rglob("*") if path.is_file())


@pytest.mark.parametrize("path", KEPT, ids=lambda path: f"{path.parent.name}-{path.name}")
def test_what_was_found_stays_mended(path: Path):
    attempt(path.parent.name, path.read_bytes())


@pytest.mark.parametrize("name", TARGETS)
def test_seeds_cut_and_changed(name: str, tmp_path: Path):
    whole = seed(name, tmp_path)
    attempt(name, whole)
    step = max(1, len(whole) // 12)
    for place in range(0, len(whole), step):
        attempt(name, whole[:place])
        attempt(name, whole[:place] + bytes([whole[place] ^ 0x15]) + whole[place + 1 :])


def test_the_corpus_is_small():
    assert sum(path.stat().st_size for path in KEPT) < 100_000
    assert {path.parent.name for path in KEPT} <= set(TARGETS)
