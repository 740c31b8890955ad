"""Fenced blocks and XML documents in a model's free answer. Knows no format's meaning."""

from __future__ import annotations

import re
from typing import NamedTuple

_FENCE = re.compile(r"^[ \t]*```[ \t]*([\w+-]*)[^\n]*\n(.*?)(?:^[ \t]*```[ \t]*$|\Z)", re.DOTALL | re.MULTILINE)


class Block(NamedTuple):
    """A fenced block: its language in small letters ("" if none is told), its text, where the fences stand."""

    language: str
    text: str
    start: int
    end: int


def fenced_blocks(answer: str) -> list[Block]:
    """All fenced blocks in order; one that the answer's end cuts off counts."""
    return [Block(m[1].lower(), m[2], m.start(), m.end()) for m in _FENCE.finditer(answer)]


def xml_document(answer: str, root: str) -> str:
    """The last XML element named `root` in an answer, fences and words left out; "" where there is none.

    The last, since a model that thinks aloud gives its drafts first.
    """
    pattern = rf"<{root}(?:\s[^<>]*)?(?:/>|>.*?</{root}\s*>)"
    found = re.findall(pattern, answer, re.DOTALL)
    return str(found[-1]) if found else ""
