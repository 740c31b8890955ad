"""Where the fields of a JSON answer stand in its text, also while it is still being written.

Paths read `legs[0].lanes_in`; `legs[]` is the length of a list: the commas and brackets between its items.
Knows text only: no tokenizer, no schema, no model, nothing to import but the standard library.
"""

from __future__ import annotations

import contextlib
import json
import re
from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass, field

_STRING = re.compile(r'"(?:[^"\\]|\\.)*"?', re.DOTALL)
_SCALAR = re.compile(r"[^\s,\]}]+")
_SPACE = re.compile(r"\s*")
_PLACES = re.compile(r"\[\d*\]")


@dataclass(frozen=True)
class Span:
    """text[start:end] belongs to the field at `path`."""

    path: str
    start: int
    end: int


@dataclass
class _Scan:
    text: str
    spans: list[Span] = field(default_factory=list)
    open_path: str = "$"
    """Path of the field that was being read where the text ended."""


class _Ended(Exception):
    """The text stops before the value does."""


def field_spans(text: str) -> list[Span]:
    """Every leaf value (quotes included) and every list's structure, in order of the text.

    Of a text that breaks off, the fields up to there; a text that is no JSON gives what was read.
    """
    return _scanned(text).spans


def open_path(text: str) -> str:
    """The path of the field at which a JSON text breaks off; "$" at the root."""
    return _scanned(text).open_path


def is_refusal(text: str) -> bool:
    """True if the answer is the schema's refusal branch, {"refuse": reason, "missing": [...]}."""
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):  # a model that opens brackets without end
        return False
    return isinstance(found, dict) and "refuse" in found


def grounding(
    text: str, ends: Sequence[int], with_context: Sequence[float], without_context: Sequence[float]
) -> dict[str, float]:
    """Nats by field: log p(y|c,x) - log p(y|x) summed over the tokens that overlap the field.

    `ends[i]` is where token i ends in `text`; a token that runs over several fields counts to the first.
    """
    found: dict[str, float] = {}
    fields = iter(field_spans(text))
    span = next(fields, None)
    start = 0
    for end, with_, without in zip(ends, with_context, without_context, strict=True):
        while span and span.end <= start:
            found.setdefault(span.path, 0.0)
            span = next(fields, None)
        if span and span.start < end:
            found[span.path] = found.get(span.path, 0.0) + with_ - without
        start = end
    return found


def first_tokens(text: str, ends: Sequence[int]) -> dict[str, int]:
    """By path: which token a field begins in. `ends[i]` is where token i ends in `text`."""
    return {span.path: bisect_right(ends, span.start) for span in reversed(field_spans(text))}


def name_of(path: str) -> str:
    """A path without the places in its lists: "legs.lanes_in" of "legs[0].lanes_in"."""
    return _PLACES.sub("", path)


def _scanned(text: str) -> _Scan:
    scan = _Scan(text)
    with contextlib.suppress(_Ended):
        _value(scan, 0, "")
    return scan


def _value(scan: _Scan, at: int, path: str) -> int:
    """Read the value at `at`; where it ends. Raises _Ended."""
    at = _skip(scan, at, path)
    opening = scan.text[at]
    if opening == "{":
        return _object(scan, at, path)
    if opening == "[":
        return _array(scan, at, path)
    found = _STRING.match(scan.text, at) if opening == '"' else _SCALAR.match(scan.text, at)
    broken = opening == '"' and not (found and _closed(found[0]))
    end = len(scan.text) if broken or not found else found.end()
    scan.spans.append(Span(path or "$", at, end))
    scan.open_path = path or "$"
    if broken or not found or (opening != '"' and end == len(scan.text)):
        raise _Ended
    return end


def _object(scan: _Scan, at: int, path: str) -> int:
    at = _skip(scan, at + 1, path)
    while scan.text[at] != "}":
        key = _STRING.match(scan.text, at)
        if not key or not _closed(key[0]):
            raise _Ended
        name = json.loads(key[0], strict=False)
        inner = f"{path}.{name}" if path else str(name)
        at = _value(scan, _skip(scan, key.end(), inner) + 1, inner)
        at = _skip(scan, at, path)
        if scan.text[at] == ",":
            at = _skip(scan, at + 1, path)
    return at + 1


def _array(scan: _Scan, at: int, path: str) -> int:
    number, start = 0, at
    at = _skip(scan, at + 1, path)
    while scan.text[at] != "]":
        _structure(scan, path, start, at)
        at = start = _value(scan, at, f"{path}[{number}]")
        number += 1
        at = _skip(scan, at, path)
        if scan.text[at] == ",":
            at = _skip(scan, at + 1, path)
    _structure(scan, path, start, at + 1)
    return at + 1


def _structure(scan: _Scan, path: str, start: int, end: int) -> None:
    if end > start:
        scan.spans.append(Span(f"{path}[]", start, end))


def _skip(scan: _Scan, at: int, path: str) -> int:
    """The next place that is no white space. Raises _Ended at the end of the text, noting whose place it is."""
    found = _SPACE.match(scan.text, at)
    at = found.end() if found else at
    if at >= len(scan.text):
        scan.open_path = path or "$"
        raise _Ended
    return at


def _closed(text: str) -> bool:
    return len(text) > 1 and text.endswith('"') and _even_slashes(text[:-1])


def _even_slashes(text: str) -> bool:
    return (len(text) - len(text.rstrip("\\"))) % 2 == 0
