"""Mutated decks through the Nastran reader: it refuses with one line, or loses nothing. `make fuzz` tries a million.

What is asked of each deck: no other exception than InputError, no time over SECONDS, no warning, one line in the
message; and of a deck that is read: as many tetras as it has lines that begin with CTETRA before its end, all of
finite coordinates, and the same mesh again from what is written of it.

    python -m tests.io.fuzz_nastran --decks 1000000 --seed 1

NUMBA_BOUNDSCHECK=1 makes an access outside of an array an error; NUMBA_DISABLE_JIT=1 runs the kernels as Python.
"""

import argparse
import random
import re
import signal
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np

from tests.io.test_nastran import DIALECTS
from tetrabench.errors import InputError
from tetrabench.io.nastran import read_nastran, write_nastran
from tetrabench.mesh.models import generate

SECONDS = 20
TOKENS = [
    *("GRID", "GRID*", "CTETRA", "CTETRA*", "ctetra", "GRDSET", "CORD2R", "CORD1C", "INCLUDE 'deck.nas'", "INCLUDE '"),
    *("BEGIN BULK", "ENDDATA", "END BULK", "CHEXA", "+", "*", "+A", "*A", ",", ",,", "\t", "\n", "\r\n", "\n\n", "$"),
    *("=", "*(1)", " ", "        ", "1.5-3", "1.+2", "1.0D+3", "1.+999", "-.25", "1e400", "NaN", "inf", ".", "-", "E"),
    *("0", "-1", "1", "4", "99999999", "9" * 19, "9" * 40, "1.", "\x00", "\xff", "\xe4", "'", '"', "x" * 80, "0" * 400),
]
CARD = re.compile(rb"^[\x00-\x08\x0b-\x20]*CTETRA(?=[\x00-\x20,*]|\Z)", re.IGNORECASE)
FREE = re.compile(rb"^[\x00-\x09\x0b-\x20]*CTETRA[ \t*]*,", re.IGNORECASE)
END = re.compile(
    rb"^[\x00-\x20]*(ENDDATA(?=[\x00-\x20,*]|\Z)|END[\x00-\x09\x0b-\x20]+BULK(?=[\x00-\x20,*]|\Z))", re.IGNORECASE
)


def corpus() -> list[bytes]:
    """Small decks that are read, in every dialect, and a box in each form of field."""
    decks = [text.encode("latin-1") for text in DIALECTS.values()]
    with tempfile.TemporaryDirectory() as folder:
        for field in ("small", "large", "free"):
            path = Path(folder) / f"{field}.nas"
            write_nastran(generate("box", 12), path, field=field)
            decks += [path.read_bytes()] * (len(DIALECTS) // 3)
    return decks


def mutated(decks: list[bytes], draw: random.Random) -> bytes:
    """A deck of the corpus after one to three changes."""
    deck = bytearray(draw.choice(decks))
    for _ in range(draw.randint(1, 3)):
        change = draw.randrange(8) if draw.random() < 0.5 else draw.randrange(4)
        place = draw.randrange(len(deck) + 1)
        end = min(len(deck), place + draw.choice([1, 2, 8, 16, 60]))
        if change == 0:
            deck[place:end] = b""
        elif change == 1:
            deck[place:place] = draw.choice(TOKENS).encode("latin-1")
        elif change == 2:
            deck[place:end] = draw.choice(TOKENS).encode("latin-1")
        elif change == 3:
            deck[place:place] = deck[place:end]
        elif change == 4 and place < len(deck):
            deck[place] = draw.randrange(256)
        elif change == 5:
            lines = bytes(deck).splitlines(keepends=True)
            draw.shuffle(lines)
            deck = bytearray(b"".join(lines))
        elif change == 6:
            other = draw.choice(decks)
            begin = draw.randrange(len(other) + 1)
            deck[place:place] = other[begin : begin + draw.choice([8, 40, 200])]
        else:
            del deck[place:]
    return bytes(deck)


def expected_tetras(deck: bytes) -> int:
    """How many CTETRA cards stand before the end of a deck."""
    count = 0
    for line in deck.removeprefix(b"\xef\xbb\xbf").split(b"\n"):
        if END.match(line) and not starts_elsewhere(line):
            break
        count += bool(FREE.match(line)) or (bool(CARD.match(line)) and not starts_elsewhere(line))
    return count


def starts_elsewhere(line: bytes) -> bool:
    """Whether a line begins beyond its first field, and so is a continuation."""
    column = 0
    for letter in line:
        if letter > 32:
            break
        column += 8 if letter == 9 else 1
    return column >= 8


def judge(deck: bytes, folder: Path) -> str | None:
    """What is wrong with how a deck is taken; None where nothing is."""
    path = folder / "deck.nas"
    path.write_bytes(deck)
    try:
        mesh = read_nastran(path)
    except InputError as error:
        return None if "\n" not in str(error) and str(path) in str(error) else f"message: {error!r}"
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            raise
        return f"{type(error).__name__}: {error}"
    if len(mesh.tets) != expected_tetras(deck):
        return f"{len(mesh.tets)} tetras of {expected_tetras(deck)} cards"
    if not np.isfinite(mesh.points).all():
        return "a coordinate that is not finite"
    again = folder / "again.nas"
    write_nastran(mesh, again, field="free")
    back = read_nastran(again)
    same = back.points.tobytes() == mesh.points.tobytes() and (back.tets == mesh.tets).all()
    return None if same and (back.tet_ids == mesh.tet_ids).all() else "another mesh from what was written of it"


def _too_long(*_: object) -> None:
    raise TimeoutError(f"over {SECONDS} s")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--decks", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=0)
    options = parser.parse_args()
    warnings.simplefilter("error")
    signal.signal(signal.SIGALRM, _too_long)
    decks, faults, begin = corpus(), 0, time.monotonic()
    with tempfile.TemporaryDirectory() as folder:
        judge(decks[0], Path(folder))  # compiles
        for k in range(options.decks):
            deck = mutated(decks, random.Random(f"{options.seed} {k}"))
            signal.alarm(SECONDS)
            fault = judge(deck, Path(folder))
            signal.alarm(0)
            if fault:
                faults += 1
                print(f"deck {k} of seed {options.seed}: {fault}\n{deck!r}", flush=True)
            if (k + 1) % 1000 == 0:
                left = (time.monotonic() - begin) / (k + 1) * (options.decks - k - 1)
                print(f"\r{k + 1:,} decks, {faults} faults, {left / 60:.0f} min left", end="", file=sys.stderr)
    print(f"{options.decks:,} decks, seed {options.seed}: {faults} faults")
    sys.exit(bool(faults))


if __name__ == "__main__":
    main()
