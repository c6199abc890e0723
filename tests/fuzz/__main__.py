"""Fuzzing by coverage, with atheris and the JIT off: `make fuzz`, or one target for some minutes.

    python -m tests.fuzz results --seconds 300 --corpus out/fuzz

atheris (3.0) has to be installed: `pip install atheris`. What makes a target fail is left in the folder as crash-...; a
small part of what was found is kept in tests/fuzz/corpus, and replayed by the tests.
"""

import argparse
import os
import sys
import tempfile
from pathlib import Path


def main() -> None:
    """Try one target until the time is over, or it fails."""
    os.environ["NUMBA_DISABLE_JIT"] = "1"
    import atheris

    with atheris.instrument_imports(include=["tetrabench"]):
        from tests.fuzz.targets import TARGETS, attempt, seed
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("target", choices=TARGETS)
    parser.add_argument("--seconds", type=int, default=300)
    parser.add_argument("--corpus", type=Path, default=Path("out/fuzz"))
    options = parser.parse_args()
    corpus = options.corpus / options.target
    corpus.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        (corpus / "seed").write_bytes(seed(options.target, Path(folder)))
    limits = [f"-max_total_time={options.seconds}", "-timeout=20", "-rss_limit_mb=4096", "-max_len=8192"]
    kept = Path(__file__).parent / "corpus" / options.target
    known = [str(kept)] if kept.exists() else []
    atheris.Setup(
        [sys.argv[0], *limits, f"-artifact_prefix={corpus.parent}/{options.target}-", str(corpus), *known],
        lambda data: attempt(options.target, data),
    )
    atheris.Fuzz()


if __name__ == "__main__":
    main()
