"""Word classes: each word once, with what it means. Knows no sentence."""

from __future__ import annotations

from typing import Any

from sgcad_core.reading.language.data import vocabulary


def words(name: str) -> tuple[str, ...]:
    """The words of a class in the order of the file. Raises ConfigError where there is no such class."""
    return tuple(vocabulary().values(name))


def values(name: str) -> dict[str, Any]:
    """Word -> meaning of a class: "northeast" -> "NE" of compass."""
    return vocabulary().values(name)


def slot(name: str) -> str:
    """The pattern of any word of a class, as one group."""
    return vocabulary().slot(name)
