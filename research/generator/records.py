"""The phrases of made reports as records: text, what it tells and needs, order of words, weight, side of the split.

`phrases/NAME.yaml` holds lists: `LIST:` or `LIST.key:`, below it the sections `counted` (phrases that follow counts of
real reports; they keep their share), `further` (breadth of English, so that words of reports that were not foreseen
have been met in some sentence) and `training` (like further, but never in a held-out report). A record is a text, or a
mapping of a text and of what is said of it:

    text    the phrase: `[a|b]` chooses, `{slot}` is filled, `[a|b<label>]` gives an alternative a label
    order   the actor named first in a clause of a contact: `struck`, `place`; else the striker
    tells   facts that it states beside those of its slots
    needs   what must be there for it to be used
    form    how it is built
    weight  how often it counts
    split   `held_out` for phrases that are never trained on and make the test set, `trains` for those that only train

`phrases/labels.yaml` says what the labels mean. No fact of a phrase is read from its words: the label is the fact.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, fields
from functools import cache
from math import ceil
from random import Random
from typing import Any

from research.generator import phrase_labels
from sgcad_core.errors import ConfigError

SHARE = 0.6
"""How often a choice should fall on further phrases, at most; the rest follows the counts."""
SECTIONS = ("counted", "further", "training")
SPLITS = ("both", "held_out", "trains")
SLOTS = re.compile(r"\{(\w+)\}")
Lists = dict[str, Any]


@dataclass(frozen=True)
class Phrase:
    """One record."""

    text: str
    order: str = ""
    tells: tuple[str, ...] = ()
    needs: tuple[str, ...] = ()
    form: tuple[str, ...] = ()
    weight: int = 1
    split: str = "both"

    @property
    def whole(self) -> tuple[str, ...]:
        """Labels that the phrase has whatever is chosen in it."""
        return (self.order,) * bool(self.order) + self.tells + self.needs + self.form

    @property
    def marked(self) -> str:
        """The text with the letters of its labels."""
        return phrase_labels.marked(self.text, self.whole) if self.whole or "<" in self.text else self.text


class Group:
    """The phrases of one list as choices fall on them; a phrase stands there as often as it counts."""

    def __init__(self, **sections: Sequence[Phrase]) -> None:
        """`sections`: of `SECTIONS`, those that the list has."""
        counted, further, training = (_unrolled(sections.get(name, ())) for name in SECTIONS)
        self._counted = tuple(sections.get("counted", ()))
        held, both, trained = (
            _unrolled([one for one in self._counted if one.split in splits])
            for splits in (("held_out",), ("both",), ("both", "trains"))
        )
        again = trained * max(0, round(_wanted(further, trained)) - 1) + further
        more = (trained * ceil(_wanted(training, trained)) + training) if training else []
        self._sides = {
            False: tuple((trained or counted) + again + more),
            True: tuple(held or both + again),
        }
        self._kept: dict[Any, tuple[str, ...]] = {}

    def side(self, held_out: bool) -> tuple[str, ...]:
        """The phrases of one side of the split; a list without held-out ones serves both, but for those that only
        train."""
        return self._sides[held_out]

    def drawn(self, rng: Random) -> str:
        """One of the counted phrases by its weight, of either side of the split."""
        return rng.choices([one.marked for one in self._counted], [one.weight for one in self._counted])[0]

    def without(self, held_out: bool, names: Iterable[str] = (), slots: Iterable[str] = ()) -> tuple[str, ...]:
        """The phrases of a side that have none of these labels and none of these slots."""
        key = (held_out, frozenset(names), frozenset(slots))
        if key not in self._kept:
            signs = [phrase_labels.mark(name) for name in key[1]] + [f"{{{slot}}}" for slot in key[2]]
            self._kept[key] = tuple(one for one in self._sides[held_out] if not any(sign in one for sign in signs))
        return self._kept[key]


def _unrolled(phrases: Iterable[Phrase]) -> list[str]:
    return [phrase.marked for phrase in phrases for _ in range(phrase.weight)]


def _wanted(more: Sequence[str], counted: Sequence[str]) -> float:
    """How often the counted phrases must stand beside further ones to keep their share."""
    return len(more) * (1 - SHARE) / SHARE / max(1, len(counted))


@cache
def slots_of(clause: str) -> tuple[str, ...]:
    """The slots of a clause in their order."""
    return tuple(SLOTS.findall(clause))


def group(*texts: str) -> Group:
    """A list of phrases without records, as tests and single sentences have them; "~" marks held-out ones."""
    return Group(
        counted=[Phrase(text.lstrip("~"), split="held_out" if text.startswith("~") else "both") for text in texts]
    )


def read(name: str) -> Lists:
    """The lists of a file: groups, and where it has `LIST.key` dictionaries of groups.

    Raises ConfigError that names every record at fault.
    """
    out: Lists = {}
    for heading, sections in records(name).items():
        key, _, inner = heading.partition(".")
        if inner:
            out.setdefault(key, {})[inner] = Group(**sections)
        else:
            out[key] = Group(**sections)
    return out


@cache
def records(name: str) -> Mapping[str, Mapping[str, tuple[Phrase, ...]]]:
    """The records of a file by list and section. Raises ConfigError that names every record at fault."""
    faults: list[str] = []
    found: dict[str, dict[str, tuple[Phrase, ...]]] = {}
    for heading, sections in phrase_labels.load(name).items():
        for section, entries in sections.items():
            where = f"phrases/{name}.yaml: {heading}.{section}"
            if section not in SECTIONS:
                faults.append(f"{where} is no section; use {', '.join(SECTIONS)}")
            found.setdefault(heading, {})[section] = tuple(_checked(where, heading, one, faults) for one in entries)
    if faults:
        raise ConfigError("\n".join(faults))
    return found


_FIELDS = {field.name for field in fields(Phrase)}


def _checked(where: str, heading: str, entry: Any, faults: list[str]) -> Phrase:
    """A record of a list; what is wrong with it goes to `faults`."""
    if isinstance(entry, str) and "<" not in entry:
        return Phrase(entry)
    given = {"text": entry} if isinstance(entry, str) else entry
    if not isinstance(given, dict) or not isinstance(given.get("text"), str):
        faults.append(f"{where}: {entry!r} is no phrase; write a text, or a mapping with `text`")
        return Phrase("")
    known: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in given.items() if k in _FIELDS}
    phrase = Phrase(**known)
    faults += [f"{where}: {phrase.text!r}: {fault}" for fault in _faults(phrase, heading, set(given) - _FIELDS)]
    return phrase


def _faults(phrase: Phrase, heading: str, strange: set[str]) -> Iterator[str]:
    """What is wrong with a record, with its remedy."""
    for key in sorted(strange):
        yield f"unknown field {key!r}; use {', '.join(sorted(_FIELDS))}"
    if phrase.split not in SPLITS:
        yield f"split {phrase.split!r}; use {' or '.join(SPLITS)}"
    if not isinstance(phrase.weight, int) or phrase.weight < 1:
        yield f"weight {phrase.weight!r}; use a whole number from 1"
    if phrase.text.count("[") != phrase.text.count("]"):
        yield "its brackets do not match; close every `[`"
    placed = [(name, field) for field in phrase_labels.FIELDS for name in _named(phrase, field)]
    for name, field in placed + [(name, "") for name in phrase_labels.inline(phrase.text)]:
        yield from _misplaced(name, field, phrase, heading)


def _named(phrase: Phrase, field: str) -> tuple[str, ...]:
    value = getattr(phrase, field)
    return (value,) * bool(value) if isinstance(value, str) else value


def _misplaced(name: str, field: str, phrase: Phrase, heading: str) -> Iterator[str]:
    """What is wrong with a label of a phrase; `field` is "" for one within the text."""
    label = phrase_labels.registry().get(name)
    if label is None:
        known = ", ".join(phrase_labels.registry())
        yield f"unknown label {name!r}; add it to phrases/labels.yaml or use one of {known}"
        return
    if field and field != label.field:
        yield f"{name!r} stands in `{field}`; it belongs in `{label.field}`"
    if not label.allowed_in(heading):
        yield f"{name!r} is not asked for in {heading}; take it out or add the list to the label"
    if label.slots and not set(label.slots) & set(SLOTS.findall(phrase.text)):
        yield f"{name!r} needs one of the slots {', '.join(label.slots)}; name one or take the label out"
