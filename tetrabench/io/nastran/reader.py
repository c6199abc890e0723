"""Read Nastran bulk data: the files of a deck, what stands scattered in it, and the mesh it makes."""

import os
import re
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from tetrabench.errors import InputError
from tetrabench.io.nastran import scan as scanning
from tetrabench.io.nastran.cards import (
    BLANK,
    DANGLING,
    MINUS,
    PLUS,
    REASONS,
    SMALL_D,
    SMALL_E,
    Bytes,
    Integers,
    line_end,
    split_card,
)
from tetrabench.io.nastran.coordinates import BASIC, FaultySystemError, Frames, System
from tetrabench.io.nastran.scan import (
    AT_INCLUDE,
    CORD,
    CTETRA,
    GRDSET_SYSTEM,
    GRID,
    NO_ROOM,
    NO_TEXT,
    Deck,
    empty_deck,
    roomier,
    scan,
    take_point,
    take_tetra,
)
from tetrabench.io.nastran.source import Source, Window, count_lines
from tetrabench.jit import kernel
from tetrabench.memory import refuse_if_too_large
from tetrabench.mesh.check import settle
from tetrabench.mesh.tetra_mesh import MeshReport, TetraMesh

MOST_FILES = 10_000
DEEPEST = 50  # files within files
PEAK = 2.0  # bytes of memory that a byte of a file takes: measured 0.8 (large field) to 1.8 (free field)
NUMBER_BYTES = 32  # of a number as it is usually written
EXPONENT = re.compile(r"(?<=[\d.])\s*(?:e\s*([+-]?)|([+-]))(?=\d)")
CARD_BYTES = 40  # a usual card has more; the deck grows where they have fewer


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


@dataclass
class _Deck:
    """A deck while it is read."""

    main: Path
    sources: list[Source] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)
    deck: Deck = field(default_factory=lambda: empty_deck(0))

    # ------------------------------------------------------------------ files

    def read(self, path: Path, within: tuple[Path, ...]) -> None:
        """Scan a file, and those that it includes where it includes them."""
        last = self.sources[-1] if self.sources else None
        source = Source(path, base=last.base + last.size + 1 if last else 0)
        self.sources.append(source)
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
                    raise self.refusal(begin, REASONS[reason].format(field=self.words(begin, end)))

    def include(self, name: str, source: Source, place: int, within: tuple[Path, ...]) -> None:
        """Read the file of an INCLUDE, looked up next to the file that includes it, then next to the main one."""
        found = find_included(name, [source.path.parent, self.main.parent])
        if found is None:
            raise self.refusal(place, f"INCLUDE: there is no file {name!r} here or next to {self.main}")
        if any(found.samefile(other) for other in within):
            raise self.refusal(place, f"INCLUDE: {name!r} includes itself")
        if len(within) >= DEEPEST or len(self.sources) >= MOST_FILES:
            raise self.refusal(place, f"INCLUDE: over {DEEPEST} files deep, or {MOST_FILES} in all")
        self.read(found, within)

    # ------------------------------------------------------------------ places

    def source_of(self, place: int) -> Source:
        """The file that a place lies in."""
        bases = np.array([source.base for source in self.sources])
        return self.sources[int(np.searchsorted(bases, place, side="right")) - 1]

    def words(self, begin: int, end: int) -> str:
        """The text between two places of one file."""
        source = self.source_of(begin)
        return source.text[begin - source.base : end - source.base].tobytes().decode("latin-1")

    def where(self, place: int) -> str:
        """The file and the line of a place."""
        source = self.source_of(place)
        return f"{source.path}:{count_lines(source.text[: place - source.base]) + 1}"

    def refusal(self, place: int, reason: str) -> InputError:
        """An error that names file and line."""
        return InputError(f"{self.where(place)}: {reason}")

    # ------------------------------------------------------------------ what `scan` leaves over

    def parse_hard(self, window: Window) -> None:
        """Convert the numbers of a window whose exact value `parse_real` could not reach with one rounding."""
        deck, state = self.deck, self.deck.state
        hard = deck.hard[: state[scanning.HARD]]
        state[scanning.HARD] = 0
        short = hard[:, 2] - hard[:, 1] < NUMBER_BYTES  # an `e` may be put in
        spelled = np.zeros((np.count_nonzero(short), NUMBER_BYTES), np.uint8)
        spell(window.text, window.base, hard[short], spelled)
        values = np.empty(len(hard))
        with np.errstate(over="ignore"):
            values[short] = spelled.view(f"S{NUMBER_BYTES}").ravel().astype(np.float64)
        for row in np.flatnonzero(~short):
            values[row] = float(spelled_number(self.words(*hard[row, 1:].tolist())))
        deck.points.reshape(-1)[hard[:, 0]] = values
        for row in np.flatnonzero(~np.isfinite(values))[:1]:
            begin, end = hard[row, 1:].tolist()
            raise self.refusal(begin, f"{self.words(begin, end)} is beyond the largest number")

    def gather_loose(self) -> None:
        """Complete the cards whose continuation stands elsewhere, and make sure that all that stands elsewhere has a
        card."""
        loose = self.deck.loose[: self.deck.state[scanning.LOOSE]].copy()
        if not len(loose):
            return
        lines = self.continuations()
        for begin, end, place, kind, row, count in loose.tolist():
            if kind:
                name = self.words(begin, end)
                if name not in lines:
                    raise self.refusal(place, f"its continuation {name!r} is missing")
                if count < (5 if kind == GRID else 6):
                    self.complete(kind, row, place, lines)
        asked = self.names_asked_for()
        for _, _, place, kind, _, _ in loose.tolist():
            if not kind and (name := self.name_of(place)) and name not in asked:
                raise self.refusal(place, f"this line continues a card {name!r}, which is not there")

    def continuations(self) -> dict[str, list[int]]:
        """The lines that begin with the name of a continuation: places by name."""
        lines: dict[str, list[int]] = {}
        for source in self.sources:
            for match in re.finditer(rb"^[+*][^\s,]", source.text.tobytes(), re.MULTILINE):
                place = source.base + match.start()
                lines.setdefault(self.name_of(place), []).append(place)
        return lines

    def name_of(self, place: int) -> str:
        """The name that a continuation line begins with."""
        return re.split("[,\t\n]", self.words(place, place + 8))[0][1:].strip()

    def names_asked_for(self) -> set[str]:
        """The names of continuations that stand at the end of a line, of whatever card."""
        last_field = re.compile(rb"[+*]([^\s,+*]{1,7})[ \t,]*\r?$", re.MULTILINE)
        return {name.decode("latin-1") for source in self.sources for name in last_field.findall(source.text.tobytes())}

    def complete(self, kind: int, row: int, place: int, lines: dict[str, list[int]]) -> None:
        """Put a card together from its lines, wherever they stand, and take it again."""
        deck = self.deck
        card, place_of_line, reason = b"", place, -1
        for _ in range(8):  # a CTETRA of one field a line would be refused before
            card += self.line(place_of_line) + b"\n"
            text = np.frombuffer(card, np.uint8).copy()
            reason, count, _ = split_card(text, 0, deck.fields, deck.wrong)
            if reason != DANGLING:
                break
            name = bytes(card[deck.wrong[0] : deck.wrong[1]]).decode("latin-1")
            found = lines.get(name, [])
            if len(found) != 1:
                trouble = "is missing" if not found else f"stands {len(found)} times in the deck"
                raise self.refusal(place, f"its continuation {name!r} {trouble}")
            place_of_line = found[0]
        if reason == 0 and count < (5 if kind == GRID else 6):
            reason = DANGLING
        elif kind == CTETRA and reason == 0:
            reason = take_tetra(text, deck.fields, count, deck.tet_ids, deck.tets, row, deck.wrong)
        elif reason == 0:
            reason = take_point(text, deck.fields, False, deck.point_ids, deck.systems, deck.points, row, deck.wrong)
        if reason:
            words = bytes(card[deck.wrong[0] : deck.wrong[1]]).decode("latin-1")
            raise self.refusal(place, REASONS[reason].format(field=words))
        for k in range(3 if kind == GRID else 0):
            if np.isnan(deck.points[row, k]):
                begin, end = deck.fields[2 + k].tolist()
                words = card[begin:end].decode("latin-1")
                deck.points[row, k] = float(spelled_number(words))
                if not np.isfinite(deck.points[row, k]):
                    raise self.refusal(place, f"{words} is beyond the largest number")

    def line(self, place: int) -> bytes:
        """The line at a place, without its end."""
        source = self.source_of(place)
        begin = place - source.base
        return source.text[begin : line_end(source.text, begin)].tobytes().rstrip(b"\r")

    # ------------------------------------------------------------------ the mesh

    def mesh(self, *, unused: str, repair: str) -> TetraMesh:
        """The mesh of a deck that was read to its end."""
        deck, state = self.deck, self.deck.state
        report = MeshReport(source=str(self.main), format="Nastran", skipped=self.count_names(), warnings=self.warnings)
        points, tets = int(state[scanning.POINTS]), int(state[scanning.TETS])
        if not tets:
            cards = {"GRID": points} | report.skipped
            held = ", ".join(f"{name} {count}" for name, count in cards.items() if count)
            raise InputError(f"{self.main}: holds no CTETRA; it holds {held or 'no card at all'}")
        if not state[scanning.ENDED]:
            if state[scanning.BEGUN]:
                hint = "the file may have been cut off; if it is whole, end it with the line ENDDATA"
                raise InputError(f"{self.main}: BEGIN BULK, but no ENDDATA: {hint}")
            self.warnings.append(f"{self.main}: no ENDDATA; if the file's end were missing, nothing would show it")
        self.gather_loose()
        report.quadratic = int(state[scanning.QUADRATIC])
        point_ids, tet_ids = deck.point_ids[:points], deck.tet_ids[:tets]
        point_places, tet_places = deck.point_places[:points], deck.tet_places[:tets]
        coordinates = self.to_basic()

        corners, first, missing = indices_of(deck.tets[:tets], point_ids)
        if missing >= 0:
            row, corner = divmod(missing, 4)
            reason = f"CTETRA {tet_ids[row]} uses GRID {deck.tets[row, corner]}, which does not exist"
            raise self.refusal(int(tet_places[row]), reason)
        again = np.flatnonzero(first != np.arange(points))
        for row in again[(coordinates[again] != coordinates[first[again]]).any(axis=1)][:1]:
            raise self.refusal(int(point_places[row]), f"GRID {point_ids[row]} twice, at different places")
        if len(again):
            self.warnings.append(f"{self.main}: {len(again)} GRIDs stand twice, at the same place; each was taken once")
            kept = first == np.arange(points)
            corners = (np.cumsum(kept, dtype=np.int32) - np.int32(1))[corners]
            coordinates, point_ids, point_places = coordinates[kept], point_ids[kept], point_places[kept]

        def where(kind: str, row: int) -> str:
            places, ids, card = (
                (tet_places, tet_ids, "CTETRA") if kind == "tetra" else (point_places, point_ids, "GRID")
            )
            return f"{self.where(int(places[row]))}: {card} {ids[row]}"

        mesh = settle(
            TetraMesh(points=coordinates, tets=corners, point_ids=point_ids, tet_ids=tet_ids, report=report),
            where=where,
            unused=unused,
            repair=repair,
        )
        twice = first_repeated(mesh.tet_ids)
        if twice is not None:
            place = int(tet_places[np.flatnonzero(tet_ids == mesh.tet_ids[twice])[1]])
            raise self.refusal(place, f"CTETRA {mesh.tet_ids[twice]} twice, with different nodes")
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
                moved[chosen] = frames.to_basic(number, points[chosen])
                if number != BASIC and number not in known:
                    self.warnings.append(
                        f"{self.main}: coordinate system {number} of {np.count_nonzero(chosen)} GRIDs is not defined; "
                        "taken as the basic one"
                    )
        except FaultySystemError as error:
            raise self.refusal(error.place, str(error)) from None
        return moved

    def systems(self) -> Iterator[tuple[int, System]]:
        """The coordinate systems of the deck, by number."""
        seen: dict[int, tuple[object, ...]] = {}
        for kind, place in self.cords():
            for number, system in self.definitions(kind, place):
                same = (system.form, system.within, system.corners.tolist(), system.grids)
                if seen.setdefault(number, same) != same:
                    raise self.refusal(place, f"coordinate system {number} is defined twice, in different ways")
                yield number, system

    def definitions(self, kind: int, place: int) -> Iterator[tuple[int, System]]:
        """The one or two systems of a card."""
        source, deck = self.source_of(place), self.deck
        reason, count, _ = split_card(source.text, place - source.base, deck.fields, deck.wrong)
        spans = deck.fields[: max(count, 0)].tolist()
        words = [self.words(source.base + begin, source.base + end) if begin < end else "" for begin, end in spans]
        words += [""] * (11 - len(words))
        points, form = CORD[kind]
        try:
            if reason:
                raise ValueError(REASONS[reason].format(field=self.words(*(source.base + deck.wrong).tolist())))
            if points == 2:
                corners = np.array([float(spelled_number(word or "0")) for word in words[2:11]]).reshape(3, 3)
                yield int(words[0]), System(form, place, within=int(words[1] or 0), corners=corners)
            else:
                for first in (0, 4):
                    if words[first]:
                        grids = tuple(int(word) for word in words[first + 1 : first + 4])
                        yield int(words[first]), System(form, place, grids=grids)
        except ValueError as error:
            raise self.refusal(place, f"CORD{points}{form}: {error}") from None


def included_name(text: Bytes, place: int) -> tuple[str, int]:
    """The file that the INCLUDE at `place` names, quoted or not, in quotes over several lines; the place after it."""
    words = text[place : place + 4096].tobytes().decode("latin-1")
    match = re.match(r"\s*include[\s,=]*(?:'([^']*)'|\"([^\"]*)\"|([^\s$]*))[^\n]*\n?", words, re.IGNORECASE)
    if match is None:
        return "", place + len(words.split("\n")[0]) + 1
    quoted = next((part for part in match.groups() if part is not None), "")
    return "".join(line.strip() for line in quoted.splitlines()), place + match.end()


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


def spelled_number(words: str) -> str:
    """A number as Python spells it: 1.5-3, 1.5D-3 and 1.5 E -3 mean 1.5e-3."""
    return EXPONENT.sub(r"e\1\2", words.strip().lower().replace("d", "e"))


@kernel
def spell(text: Bytes, base: int, hard: Integers, spelled: Bytes) -> None:
    """Copy each number of `hard` into a row of `spelled`, as `spelled_number` does."""
    for row in range(len(hard)):
        length, exponent = 0, False
        for i in range(hard[row, 1] - base, hard[row, 2] - base):
            lettered = text[i] | 32 == SMALL_D or text[i] | 32 == SMALL_E
            signed = text[i] == PLUS or text[i] == MINUS
            if lettered or (signed and length > 0 and not exponent):
                spelled[row, length] = SMALL_E
                length += 1
                exponent = True
            if text[i] > BLANK and not lettered:
                spelled[row, length] = text[i]
                length += 1


def indices_of(ids: Integers, point_ids: Integers) -> tuple[NDArray[np.int32], NDArray[np.int32], int]:
    """Translate ids to indices into `point_ids`, to the first of equal ones.

    Args:
        ids: (m, 4), positive.
        point_ids: (n,), positive.

    Returns:
        (m, 4) int32; (n,) int32, the same for `point_ids` themselves; the flat index of the first id that is not
        there, or -1.
    """
    count = len(point_ids)
    most = int(point_ids.max(initial=0))
    if most < 16 * count + 1_000_000:
        table = np.full(most + 2, -1, np.int32)  # the last entry stands for all ids beyond
        table[point_ids[::-1]] = np.arange(count - 1, -1, -1, dtype=np.int32)
        found = np.empty(ids.shape, np.int32)
        missing = look_up(ids, table, found)
        return found, table[point_ids], missing
    ordered, first = np.unique(point_ids, return_index=True)
    places = np.minimum(np.searchsorted(ordered, ids), len(ordered) - 1)
    found = np.where(ordered[places] == ids, first[places], -1).astype(np.int32)
    missing = int(np.argmin(found.ravel())) if found.min(initial=0) < 0 else -1
    return found, first[np.searchsorted(ordered, point_ids)].astype(np.int32), missing


@kernel
def look_up(ids: Integers, table: NDArray[np.int32], found: NDArray[np.int32]) -> int:
    """Fill `found` from the table, whose last entry stands for all ids beyond; return the first that is missing."""
    missing, last = -1, len(table) - 1
    for row in range(len(ids) - 1, -1, -1):
        for k in range(3, -1, -1):
            found[row, k] = table[min(ids[row, k], last)]
            if found[row, k] < 0:
                missing = 4 * row + k
    return missing


def first_repeated(ids: Integers) -> int | None:
    """Find the first row whose id stands in an earlier row."""
    if (ids[1:] > ids[:-1]).all():
        return None
    order = np.argsort(ids, kind="stable")
    again = order[1:][ids[order[1:]] == ids[order[:-1]]]
    return int(again.min()) if again.size else None
