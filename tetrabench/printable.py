"""Words of others made harmless: what would move a terminal's cursor, end a line or turn the reading direction is spelled.

A name in a results file may be anything. What it says stays visible, as the escape that Python would write for it.
"""

import unicodedata

_HARMFUL = frozenset({"Cc", "Cf", "Cs", "Zl", "Zp"})
"""Unicode's categories of control and format characters (the marks of direction are among these), halves of pairs, and
separators of lines and paragraphs."""


def printable(text: str) -> str:
    """A text in which every sign has a shape: one line, left to right as it stands."""
    if text.isascii() and text.isprintable():
        return text
    return "".join(map(_spelled, text))


def _spelled(sign: str) -> str:
    return sign.encode("unicode_escape").decode() if unicodedata.category(sign) in _HARMFUL else sign
