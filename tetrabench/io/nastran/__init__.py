"""Nastran bulk data: GRID and CTETRA, read and written at the speed of the disk.

A card is a name and fields. It stands on one line or goes on in continuation lines, each in one of three
forms (MSC Nastran Quick Reference Guide, "Bulk Data Entries", Format of Bulk Data):

    small field   10 fields of 8 columns:         GRID    7               1.5     -.25    2.+1
    large field   `*` in field 1, 4 of 16:        GRID*   7                               1.5             -.25
                                                  *       2.+1
    free field    a comma anywhere on the line:   GRID,7,,1.5,-.25,2.+1

One file for each layer, so that a dialect touches one of them: `source` (the files of a deck), `cards` (a card of
any form to one list of fields, a field to a number), `scan` (the loop over the cards; fills a `Deck`), `spelling`
(the numbers that are left), `scattered` (continuations elsewhere), `coordinates` (coordinate systems), `ids`
(ids to rows), `reader` (INCLUDE, and from a deck to a mesh), `writer`.
"""

from tetrabench.io.nastran.reader import read_nastran
from tetrabench.io.nastran.writer import write_nastran

__all__ = ["read_nastran", "write_nastran"]
