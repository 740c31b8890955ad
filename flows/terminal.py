"""Text made safe to print in a terminal."""

from __future__ import annotations

import unicodedata

from rich import markup


def escape(text: str) -> str:
    """The text as rich shows it unchanged, control characters made visible.

    Names of files and reasons come from outside: an escape sequence in them could color, move and clear.
    """
    return markup.escape(escape_plain(text))


def escape_plain(text: str) -> str:
    """The text with control characters made visible, for lines that rich does not write."""
    return "".join(c if c == "\n" or unicodedata.category(c) != "Cc" else "\ufffd" for c in text)


def counted(number: int, noun: str) -> str:
    """A number with its noun: "1 arm", "2 arms"."""
    return f"{number} {noun}{'' if number == 1 else 's'}"
