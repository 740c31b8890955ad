"""Labels of phrases: what a record says of its phrase beside the words, as letters that travel with the text.

A label stands behind the words that it belongs to: at the end of a phrase, or of the alternative that alone has it.
So after the choices of a phrase are made exactly the labels of what was chosen are left, and `fill` takes them out.
Knows no list of phrases; `phrases/labels.yaml` says what each label means.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import Any

import yaml

from sgcad_core.errors import ConfigError

FIELDS = ("order", "tells", "needs", "form")
"""Of a record, in which labels stand: who is named first, what is stated, what must be there, how it is built."""
_FIRST = 0x100000
"""Private-use letters from here on are the marks of labels, apart from those of notes and of sentences."""
_MARKS = re.compile("[\U00100000-\U0010fffd]+")
_INLINE = re.compile(r"<([a-z_]+)>")


@dataclass(frozen=True)
class Label:
    """One label: the field of a record that names it, what it means, whose phrases may have it."""

    name: str
    field: str
    says: str
    lists: tuple[str, ...]
    slots: tuple[str, ...] = ()

    def allowed_in(self, heading: str) -> bool:
        """Whether phrases of a list may have this label; a list `KEY.inner` is one of the lists of KEY."""
        return bool({"*", heading, heading.partition(".")[0]} & set(self.lists))


def load(name: str) -> Any:
    """What a YAML file of the folder of phrases holds."""
    text = files("research.generator").joinpath(f"phrases/{name}.yaml").read_text(encoding="utf-8")
    return yaml.load(text, Loader=getattr(yaml, "CSafeLoader", yaml.SafeLoader))  # noqa: S506 - both are safe


@cache
def registry() -> dict[str, Label]:
    """Every label by its name. Raises ConfigError for one whose field there is not."""
    found = {name: Label(name, **{k: _tuple(v) for k, v in entry.items()}) for name, entry in load("labels").items()}
    for label in found.values():
        if label.field not in FIELDS:
            raise ConfigError(f"phrases/labels.yaml: {label.name} has the field {label.field!r}; use one of {FIELDS}")
    return found


def _tuple(value: Any) -> Any:
    return tuple(value) if isinstance(value, list) else value


@cache
def _letters() -> dict[str, str]:
    return {name: chr(_FIRST + place) for place, name in enumerate(registry())}


@cache
def _named() -> dict[str, str]:
    return {letter: name for name, letter in _letters().items()}


def mark(name: str) -> str:
    """The letter of a label. Raises KeyError for a label that there is not."""
    return _letters()[name]


def marked(text: str, names: tuple[str, ...] = ()) -> str:
    """A phrase with letters for its labels: those written in it as `<label>`, and further ones behind it."""
    return _INLINE.sub(lambda found: mark(found[1]), text) + "".join(mark(name) for name in names)


def inline(text: str) -> list[str]:
    """Names of the labels written in the text of a record."""
    return _INLINE.findall(text)


def has(text: str, name: str) -> bool:
    """Whether a phrase has a label; of one whose choices are not made, whether it may have it."""
    return mark(name) in text


def labels_of(text: str) -> set[str]:
    """Every label of a phrase."""
    return {_named()[letter] for run in _MARKS.findall(text) for letter in run}


def plain(text: str) -> str:
    """A phrase without its labels."""
    return _MARKS.sub("", text)
