"""Read Nastran bulk data: the files of a deck, and the mesh that it makes."""

import os
import re
from collections import Counter
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.io.nastran import scan as scanning
from tetrabench.io.nastran.cards import REASONS, Bytes, line_end, split_card
from tetrabench.io.nastran.coordinates import BASIC, FaultySystemError, Frames, System
from tetrabench.io.nastran.ids import first_repeated, indices_of
from tetrabench.io.nastran.scan import (
    AT_INCLUDE,
    CORD,
    GRDSET_SYSTEM,
    NO_ROOM,
    NO_TEXT,
    empty_deck,
    roomier,
    scan,
)
from tetrabench.io.nastran.scattered import Continuations, gather_loose
from tetrabench.io.nastran.source import Source, Sources, Window
from tetrabench.io.nastran.spelling import convert, real_number, whole_number
from tetrabench.memory import refuse_if_too_large
from tetrabench.mesh.check import find_faults, settle
from tetrabench.mesh.tetra_mesh import MeshReport, TetraMesh

MOST_FILES = 10_000
MOST_TOLD = 20  # kinds of cards
DEEPEST = 50  # files within files
PEAK = 2.0  # bytes of memory that a byte of a file takes: measured 0.8 (large field) to 1.8 (free field)
CARD_BYTES = 40  # a usual card has more; the deck grows where they have fewer
LONGEST_INCLUDE = 4096  # bytes of an INCLUDE with the name of its file
INCLUDE_CARD = re.compile(rb"\s*include[\s,=]*(?:'([^']*)'|\"([^\"]*)\"|([^\s$]*))", re.IGNORECASE)


def read_nastran(path: str | os.PathLike[str], *, unused: str = "drop", repair: str = "refuse") -> TetraMesh:
    """Read GRID and CTETRA of a Nastran bulk data file, and of the files that it includes.

    Coordinates are rounded correctly, as by float(), and turned into the basic coordinate system. Of a CTETRA
    with midside nodes the corners are taken, and `report.quadratic` counts it. Other cards are skipped, whatever
    they hold, and counted in `report.skipped`.

    Args:
        path: the file.
        unused: "drop" leaves out the points that no tetra uses, "keep" keeps them; `report.unreferenced`
            counts them.
        repair: "refuse" or "drop", see `settle`.

    Raises:
        InputError: `path:line: reason` for anything that cannot be taken: a malformed card, a node that does not
            exist, an id used twice, a file to include that is missing or includes itself; `path: reason` for a file
            that cannot be read, that begins with BEGIN BULK and is cut off before ENDDATA, or that holds no CTETRA.
        RepairableError: `settle` refuses a tetra, and repair="drop" would leave it out.
        MemoryRefusedError: the file is too large for the memory that there is.
    """
    deck = _Deck(Path(path))
    deck.read(deck.main, ())
    return deck.mesh(unused=unused, repair=repair)


class _Deck:
    """A deck while it is read."""

    def __init__(self, main: Path) -> None:
        self.main = main
        self.sources = Sources()
        self.continuations = Continuations(self.sources)
        self.warnings: list[str] = []
        self.deck = empty_deck(0)

    # ------------------------------------------------------------------ files

    def read(self, path: Path, within: tuple[Path, ...]) -> None:
        """Scan a file, and those that it includes where it includes them."""
        source = self.sources.add(path)
        refuse_if_too_large(f"reading {path}", source.size * PEAK)
        if not within:
            self.deck = empty_deck(source.size // CARD_BYTES + 1024)
        state = self.deck.state
        with source.window() as window:
            position, reason = 0, NO_TEXT
            while reason:
                state[scanning.POSITION] = position
                reason = scan(window.text, window.base, window.whole, self.deck)
                position = int(state[scanning.POSITION])
                self.parse_hard(window)
                if reason == NO_ROOM:
                    self.deck = roomier(self.deck)
                elif reason == NO_TEXT:
                    window.move(position)
                    position = 0
                elif reason == AT_INCLUDE:
                    name, after = included_name(source.text, window.base + position - source.base)
                    self.include(name, source, window.base + position, (*within, path))
                    if state[scanning.ENDED]:
                        break
                    window.seek(after)
                    position = 0
                elif reason:
                    begin, end = (window.base + int(place) for place in self.deck.wrong)
                    raise self.sources.refusal(begin, REASONS[reason].format(field=self.sources.words(begin, end)))

    def include(self, name: str, source: Source, place: int, within: tuple[Path, ...]) -> None:
        """Read the file of an INCLUDE, looked up next to the file that includes it, then next to the main one."""
        found = find_included(name, [source.path.parent, self.main.parent])
        if found is None:
            raise self.sources.refusal(place, f"INCLUDE: there is no file {name!r} here or next to {self.main}")
        if any(found.samefile(other) for other in within):
            raise self.sources.refusal(place, f"INCLUDE: {name!r} includes itself")
        if len(within) >= DEEPEST or len(self.sources) >= MOST_FILES:
            raise self.sources.refusal(place, f"INCLUDE: over {DEEPEST} files deep, or {MOST_FILES} in all")
        self.read(found, within)

    def parse_hard(self, window: Window) -> None:
        """Convert the numbers of a window whose exact value `parse_real` could not reach with one rounding."""
        deck, state = self.deck, self.deck.state
        hard = deck.hard[: state[scanning.HARD]]
        state[scanning.HARD] = 0
        values = convert(window.text, hard[:, 1:] - window.base)
        for row in np.flatnonzero(~np.isfinite(values)):
            begin, end = hard[row, 1:].tolist()
            try:
                values[row] = real_number(self.sources.words(begin, end))
            except ValueError as error:
                raise self.sources.refusal(begin, str(error)) from None
        deck.points.reshape(-1)[hard[:, 0]] = values

    # ------------------------------------------------------------------ the mesh

    def mesh(self, *, unused: str, repair: str) -> TetraMesh:
        """The mesh of a deck that was read to its end."""
        deck, state = self.deck, self.deck.state
        report = MeshReport(
            source=str(self.main),
            format="Nastran",
            included=list(dict.fromkeys(str(source.path) for source in self.sources))[1:],
            skipped=self.count_names(),
            warnings=self.warnings,
        )
        points, tets = int(state[scanning.POINTS]), int(state[scanning.TETS])
        if not tets:
            cards = {"GRID": points} | report.skipped
            held = ", ".join([f"{name} {count}" for name, count in cards.items() if count][:MOST_TOLD])
            if 0 in next(iter(self.sources)).text[:4096]:
                held = "null bytes, as no deck does: is it a binary file?"
            raise InputError(f"{self.main}: holds no CTETRA; it holds {held or 'no card at all'}")
        if not state[scanning.ENDED]:
            if state[scanning.BEGUN]:
                hint = "the file may have been cut off; if it is whole, end it with the line ENDDATA"
                raise InputError(f"{self.main}: BEGIN BULK, but no ENDDATA: {hint}")
            self.warnings.append(f"{self.main}: no ENDDATA; if the file's end were missing, nothing would show it")
        gather_loose(deck, self.continuations)
        report.quadratic = int(state[scanning.QUADRATIC])
        point_ids, tet_ids = deck.point_ids[:points], deck.tet_ids[:tets]
        point_places, tet_places = deck.point_places[:points], deck.tet_places[:tets]
        coordinates = self.to_basic()

        corners, first, missing = indices_of(deck.tets[:tets], point_ids)
        if missing >= 0:
            row, corner = divmod(missing, 4)
            reason = f"CTETRA {tet_ids[row]} uses GRID {deck.tets[row, corner]}, which does not exist"
            raise self.sources.refusal(int(tet_places[row]), reason)
        again = np.flatnonzero(first != np.arange(points))
        for row in again[(coordinates[again] != coordinates[first[again]]).any(axis=1)][:1]:
            raise self.sources.refusal(int(point_places[row]), f"GRID {point_ids[row]} twice, at different places")
        if len(again):
            self.warnings.append(f"{self.main}: {len(again)} GRIDs stand twice, at the same place; each was taken once")
            kept = first == np.arange(points)
            corners = (np.cumsum(kept, dtype=np.int32) - np.int32(1))[corners]
            coordinates, point_ids, point_places = coordinates[kept], point_ids[kept], point_places[kept]

        def where(kind: str, row: int) -> str:
            places, ids, card = (
                (tet_places, tet_ids, "CTETRA") if kind == "tetra" else (point_places, point_ids, "GRID")
            )
            return f"{self.sources.where(int(places[row]))}: {card} {ids[row]}"

        mesh = settle(
            TetraMesh(points=coordinates, tets=corners, point_ids=point_ids, tet_ids=tet_ids, report=report),
            where=where,
            unused=unused,
            repair=repair,
        )
        twice = first_repeated(mesh.tet_ids)
        if twice is not None:
            left_out = [row for rows in find_faults(coordinates, corners, where).values() for row in rows]
            place = int(np.delete(tet_places, left_out)[twice])
            raise self.sources.refusal(place, f"CTETRA {mesh.tet_ids[twice]} twice, with different nodes")
        return mesh

    def count_names(self) -> dict[str, int]:
        """How many cards of each other name there are, the most frequent first."""
        names = self.deck.names[: self.deck.state[scanning.NAMES]].tolist()
        spelled = {kind.to_bytes(8, "big").lstrip(b"\0").decode() or "others": count for kind, count in names}
        cords = Counter("CORD{}{}".format(*CORD[kind]) for kind, _ in self.cords())
        return dict(Counter(spelled | cords).most_common())

    def cords(self) -> list[list[int]]:
        """Kind and place of the cards of coordinate systems."""
        cords: list[list[int]] = self.deck.cords[: self.deck.state[scanning.CORDS]].tolist()
        return cords

    def to_basic(self) -> NDArray[np.float64]:
        """Coordinates of the points in the basic system, (points, 3)."""
        deck, count = self.deck, self.deck.state[scanning.POINTS]
        points, systems = deck.points[:count], deck.systems[:count]
        systems[systems == GRDSET_SYSTEM] = deck.state[scanning.DEFAULT_SYSTEM]
        if not systems.any():
            return points
        known = dict(self.systems())
        frames = Frames(known, points, deck.point_ids[:count], systems)
        moved = points.copy()
        try:
            for number in np.unique(systems).tolist():
                chosen = systems == number
                with np.errstate(all="ignore"):  # what is beyond float64 is refused, as flat or as not finite
                    moved[chosen] = frames.to_basic(number, points[chosen])
                if number != BASIC and number not in known:
                    self.warnings.append(
                        f"{self.main}: coordinate system {number} of {np.count_nonzero(chosen)} GRIDs is not defined; "
                        "taken as the basic one"
                    )
        except FaultySystemError as error:
            raise self.sources.refusal(error.place, str(error)) from None
        return moved

    def systems(self) -> Iterator[tuple[int, System]]:
        """The coordinate systems of the deck, by number."""
        seen: dict[int, tuple[object, ...]] = {}
        for kind, place in self.cords():
            for number, system in self.definitions(kind, place):
                same = (system.form, system.within, system.corners.tolist(), system.grids)
                if seen.setdefault(number, same) != same:
                    raise self.sources.refusal(place, f"coordinate system {number} is defined twice, in different ways")
                yield number, system

    def definitions(self, kind: int, place: int) -> Iterator[tuple[int, System]]:
        """The one or two systems of a card."""
        points, form = CORD[kind]
        deck, card = self.deck, self.continuations.card(place)
        reason, count, _ = split_card(card, 0, deck.fields, deck.wrong)
        spans = [*deck.fields[:count].tolist(), deck.wrong.tolist()]
        *words, wrong = (card[begin:end].tobytes().decode("latin-1") for begin, end in spans)
        words += [""] * (11 - len(words))
        try:
            if reason:
                raise ValueError(REASONS[reason].format(field=wrong))
            if points == 2:
                corners = np.array([real_number(word or "0.") for word in words[2:11]]).reshape(3, 3)
                yield whole_number(words[0]), System(form, place, within=whole_number(words[1] or "0"), corners=corners)
            else:
                for first in (0, 4):
                    if words[first]:
                        grids = tuple(whole_number(word) for word in words[first + 1 : first + 4])
                        yield whole_number(words[first]), System(form, place, grids=grids)
        except ValueError as error:
            raise self.sources.refusal(place, f"CORD{points}{form}: {error}") from None


def included_name(text: Bytes, place: int) -> tuple[str, int]:
    """The file that the INCLUDE at `place` names, quoted or not, in quotes over several lines; the place after it."""
    match = INCLUDE_CARD.match(text[place : place + LONGEST_INCLUDE].tobytes())
    if match is None:
        return "", line_end(text, place) + 1
    quoted = next((part for part in match.groups() if part is not None), b"")
    name = b"".join(line.strip() for line in quoted.splitlines())
    return decoded(name), line_end(text, place + match.end()) + 1


def decoded(name: bytes) -> str:
    """The name of a file, which is UTF-8, or else Latin-1."""
    try:
        return name.decode()
    except UnicodeDecodeError:
        return name.decode("latin-1")


def find_included(name: str, folders: list[Path]) -> Path | None:
    """The file of that name in the first of the folders that has one; backslashes may stand for slashes."""
    for spelled in (name, name.replace("\\", "/")):
        for folder in folders:
            path = folder / spelled
            try:
                if name and path.is_file():
                    return path
            except OSError:  # no name that a file can have
                continue
    return None
