"""One piece of knowledge, and the words by which full-text search finds it.

Knows no source and no database.
"""

from __future__ import annotations

import hashlib
import re
from typing import Literal, get_args

from sgcad_core.case.records import Record

Kind = Literal["api", "snippet", "xml", "example", "junction"]
Task = Literal["road", "scenario"]
KINDS: tuple[Kind, ...] = get_args(Kind)
TASKS: tuple[Task, ...] = get_args(Task)
_HUMPS = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
_NAMES = re.compile(r"\b(?:[a-z]+[A-Z]\w*|[A-Z]+[a-z]+[A-Z]\w*|\w+_\w+)\b")


class Chunk(Record):
    """A passage with its name. Equal ids are the same piece; another digest is another version of it."""

    id: str
    kind: Kind
    tasks: tuple[Task, ...]
    """Stages that the chunk can serve."""
    title: str
    text: str
    """What the model reads."""
    keywords: str = ""
    """Other words for the same thing; searched, not shown."""
    source: str = ""
    """Package and version, file or extract that it was read from."""
    data: str = ""
    """JSON for programs, such as a junction's legs and its plain XML; neither searched nor shown."""

    @property
    def digest(self) -> str:
        """Fingerprint of the whole chunk, 16 hex digits."""
        return hashlib.sha256(self.model_dump_json().encode()).hexdigest()[:16]

    @property
    def words(self) -> str:
        """The text of full-text search: title (twice, for its weight), keywords, text, and names split into words."""
        return "\n".join((self.title, self.title, split_names(self.title), self.keywords, split_names(self.text)))

    @property
    def gist(self) -> str:
        """The text of an embedder: the plain words first, since embedders read a few hundred tokens at most."""
        return "\n".join(part for part in (plain(self.title), self.keywords, self.text) if part)[:1000]


def split_names(text: str) -> str:
    """The text, followed by the words that camelCase and snake_case names in it are made of.

    "numLanes" also says "num Lanes", so that a question in plain words finds it.
    """
    parts = (" ".join(_HUMPS.findall(name)) for name in dict.fromkeys(_NAMES.findall(text)))
    return " ".join((text, *parts))


def plain(name: str) -> str:
    """A name with its humps as words: "xosc.LaneChangeAction" is "xosc.LaneChangeAction (lane change action)"."""
    humps = [" ".join(_HUMPS.findall(n)).lower() for n in _NAMES.findall(name)]
    return f"{name} ({', '.join(humps)})" if humps else name
