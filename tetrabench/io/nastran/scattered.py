"""Continuations that do not stand below their card: found by name, in whatever file of the deck.

`scan` notes them in `Deck.loose`. They are rare, so the whole text is gone through once one is met.
"""

import re
from functools import cached_property

import numpy as np

from tetrabench.io.nastran.cards import (
    DANGLING,
    GRID,
    MOST_FIELDS,
    REASONS,
    Bytes,
    bare_name,
    field_end,
    line_form,
    name_end,
    split_card,
)
from tetrabench.io.nastran.scan import (
    LOOSE,
    POINT_FIELDS,
    TETRA_FIELDS,
    Deck,
    take_point,
    take_tetra,
)
from tetrabench.io.nastran.source import Sources
from tetrabench.io.nastran.spelling import real_number

NAMED_LINE = re.compile(rb"^ {0,7}[+*][^\s,]", re.MULTILINE)
LAST_FIELD = re.compile(rb"[+*]([^\s,+*$]{1,7})[ \t,]*\r?(?:\$[^\n]*)?$", re.MULTILINE)


class Continuations:
    """The continuations of a deck by name. They are looked for when the first one is asked for: the deck was read then."""

    def __init__(self, sources: Sources) -> None:
        self.sources = sources

    def card(self, place: int) -> Bytes:
        """The card that begins at a place, (n,) uint8: its lines one below the other, wherever they stand.

        Raises:
            InputError: a continuation is missing, or there are several of its name.
        """
        fields, wrong = np.zeros((MOST_FIELDS, 2), np.int64), np.zeros(2, np.int64)
        card = self._lines_from(place)
        text = np.frombuffer(card, np.uint8).copy()
        while split_card(text, 0, fields, wrong)[0] == DANGLING:  # comes to an end: a card has MOST_FIELDS
            name = card[wrong[0] : wrong[1]].decode("latin-1")
            found = self._places.get(name, [])
            if len(found) != 1:
                trouble = "is missing" if not found else f"stands {len(found)} times in the deck"
                raise self.sources.refusal(place, f"its continuation {name!r} {trouble}")
            card += self._lines_from(found[0])
            text = np.frombuffer(card, np.uint8).copy()
        return text

    def are_there(self, name: str) -> bool:
        """Whether there is a continuation of that name."""
        return name in self._places

    def are_asked_for(self, name: str) -> bool:
        """Whether a line, of whatever card, has that name in its last field."""
        return name in self._asked_for

    def name_at(self, place: int) -> str:
        """The name that a line begins with, without the sign before it."""
        source = self.sources.at(place)
        text, begin = source.text, place - source.base
        end, free, _, _ = line_form(text, begin)
        first, last = bare_name(text, begin, name_end(text, begin, field_end(text, begin, end) if free else end))
        return self.sources.words(source.base + first, source.base + last)

    @cached_property
    def _places(self) -> dict[str, list[int]]:
        """The lines that begin with the name of a continuation, by name."""
        places: dict[str, list[int]] = {}
        for source in self.sources:
            for match in NAMED_LINE.finditer(source.text.tobytes()):
                place = source.base + match.start()
                places.setdefault(self.name_at(place), []).append(place)
        return places

    @cached_property
    def _asked_for(self) -> set[str]:
        """The names of continuations that stand in the last field of a line."""
        texts = (source.text.tobytes() for source in self.sources)
        return {name.decode("latin-1") for text in texts for name in LAST_FIELD.findall(text)}

    def _lines_from(self, place: int) -> bytes:
        """The line at a place, and those below that continue it."""
        source = self.sources.at(place)
        begin = place - source.base
        _, _, end = split_card(source.text, begin, np.zeros((MOST_FIELDS, 2), np.int64), np.zeros(2, np.int64))
        return source.text[begin:end].tobytes() + b"\n"


def gather_loose(deck: Deck, continuations: Continuations) -> None:
    """Complete the cards whose continuation stands elsewhere, and make sure that all that stands elsewhere has a card.

    Args:
        deck: in and out.
        continuations: those of its files.

    Raises:
        InputError: a continuation is missing, or faulty; or a line continues a card that is not there.
    """
    sources = continuations.sources
    loose = deck.loose[: deck.state[LOOSE]].tolist()
    for begin, end, place, kind, row, count in loose:
        if kind:
            name = sources.words(begin, end)
            if not continuations.are_there(name):
                raise sources.refusal(place, f"its continuation {name!r} is missing")
            if count < (POINT_FIELDS if kind == GRID else TETRA_FIELDS):
                take_card(deck, continuations, kind, row, place)
    for _, _, place, kind, _, _ in loose:
        name = "" if kind else continuations.name_at(place)
        if name and not continuations.are_asked_for(name):
            raise sources.refusal(place, f"this line continues a card {name!r}, which is not there")


def take_card(deck: Deck, continuations: Continuations, kind: int, row: int, place: int) -> None:
    """Put together the GRID or CTETRA that begins at a place, and put it into its row of the deck.

    Raises:
        InputError: it is faulty.
    """
    card, sources = continuations.card(place), continuations.sources
    fields, wrong = deck.fields, deck.wrong
    reason, count, _ = split_card(card, 0, fields, wrong)
    if reason == 0 and count < (POINT_FIELDS if kind == GRID else TETRA_FIELDS):
        reason = DANGLING
    elif reason == 0 and kind == GRID:
        reason = take_point(card, fields, False, deck.point_ids, deck.systems, deck.points, row, wrong)
    elif reason == 0:
        reason = take_tetra(card, fields, count, deck.tet_ids, deck.tets, row, wrong)
    if reason:
        words = card[wrong[0] : wrong[1]].tobytes().decode("latin-1")
        raise sources.refusal(place, REASONS[reason].format(field=words))
    for k in range(3 if kind == GRID else 0):
        if np.isnan(deck.points[row, k]):
            begin, end = fields[2 + k]
            try:
                deck.points[row, k] = real_number(card[begin:end].tobytes().decode("latin-1"))
            except ValueError as error:
                raise sources.refusal(place, str(error)) from None
