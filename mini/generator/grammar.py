"""The small language in which clauses are written: `[a|b|c]` chooses, `{slot}` is filled, `~` marks held-out.

A clause list is one string a clause; a clause that starts with "~" belongs to the families that are never
trained on and make the test set. Choices may nest. Filling a slot is reported, so that the caller knows which
facts the text told.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from random import Random

_CHOICE = re.compile(r"\[([^\[\]]*)\]")
_SLOT = re.compile(r"\{(\w+)\}")
Fill = Callable[[str], str]


def clauses(text: str) -> list[str]:
    """One clause a line; blank lines and `#` lines are passed over."""
    return [line.strip() for line in text.strip().splitlines() if line.strip() and not line.startswith("#")]


def families(options: list[str], held_out: bool) -> list[str]:
    """The clauses of one side of the split; a list without held-out clauses serves both."""
    kept = [o.lstrip("~") for o in options if o.startswith("~") == held_out]
    return kept or [o.lstrip("~") for o in options]


def choose(rng: Random, clause: str) -> str:
    """Resolve every `[a|b]`, innermost first."""
    while True:
        found = _CHOICE.search(clause)
        if not found:
            return clause
        chosen = rng.choice(found[1].split("|"))
        clause = clause[: found.start()] + chosen + clause[found.end() :]


def fill(clause: str, slot: Fill) -> str:
    """Put slot values in and tidy the spaces."""
    text = _SLOT.sub(lambda m: slot(m[1]), clause)
    text = re.sub(r" +", " ", text)
    text = re.sub(r" ([,.;])", r"\1", text)
    text = re.sub(r",+(?=[,.;])", "", text)
    return text.strip()


def sentence(text: str) -> str:
    """First letter large, one full stop at the end."""
    text = text.strip()
    text = text[:1].upper() + text[1:]
    return text if text.endswith((".", "!", "?")) else text + "."
