"""The records of the data files, read strictly: every fault names file, record and remedy. Compiles nothing."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from sgcad_core.errors import ConfigError

At = Literal["anywhere", "start", "whole"]
"""Where a rule reads: any place of a text, its beginning, or all of it (`search`, `match`, `fullmatch`)."""


@dataclass(frozen=True)
class WordClass:
    """Words of one kind, each once in all the vocabulary.

    `words`: plain words with what they mean (a mapping), or patterns of words (a list; then each stands for itself).
    `includes`: classes whose words are its own too. `pattern`: a phrase made of other classes; it has no words.
    """

    name: str
    file: str
    about: str
    words: Mapping[str, Any] = field(default_factory=dict)
    plain: bool = True
    includes: tuple[str, ...] = ()
    pattern: str | None = None
    examples: tuple[str, ...] = ()


@dataclass(frozen=True)
class RuleRecord:
    """One wording, or a few that say the same.

    `alternatives`: patterns, any of which reads; slots such as `{compass}` stand for word classes. `yields`: what the
    rule states wherever it reads (groups of the pattern come besides). `weight`: its place among the rules of its role,
    the lowest is asked first. `given`: words that the caller puts into slots, with samples for the examples.
    """

    id: str
    file: str
    role: str
    alternatives: tuple[str, ...]
    at: At = "anywhere"
    case: bool = False
    weight: float = 0.0
    yields: Mapping[str, Any] = field(default_factory=dict)
    given: Mapping[str, str] = field(default_factory=dict)
    about: str = ""
    examples: tuple[str, ...] = ()
    counterexamples: tuple[str, ...] = ()


_CLASS_KEYS = {"about", "words", "includes", "pattern", "examples"}
_RULE_KEYS = {
    "about", "role", "pattern", "any", "at", "case", "weight", "yields", "given", "examples", "counterexamples",
}  # fmt: skip


def word_class(file: str, name: str, raw: object) -> WordClass:
    """A record of a vocabulary file."""
    record = _mapping(file, name, raw, _CLASS_KEYS)
    words = record.get("words", {})
    plain = isinstance(words, dict)
    if not plain and not isinstance(words, list):
        raise fault(file, name, f"words is {type(words).__name__}", "give a list, or a mapping of word to meaning")
    if ("pattern" in record) == bool(words or record.get("includes")):
        raise fault(file, name, "neither words nor a pattern, or both", "give words (or includes), or a pattern")
    return WordClass(
        name, file, str(record.get("about", "")),
        {str(w): v for w, v in words.items()} if plain else {str(w): str(w) for w in words},
        plain, _texts(file, name, record, "includes"), one_line(record["pattern"]) if "pattern" in record else None,
        _texts(file, name, record, "examples"),
    )  # fmt: skip


def rule_record(file: str, name: str, raw: object) -> RuleRecord:
    """A record of a rule file; its id is the file's stem, a dot and its key."""
    record = _mapping(file, name, raw, _RULE_KEYS)
    stem = file.removesuffix(".yaml")
    if ("pattern" in record) == ("any" in record):
        raise fault(file, name, "it has both pattern and any, or neither", "give one pattern, or a list under any")
    at = record.get("at", "anywhere")
    if at not in ("anywhere", "start", "whole"):
        raise fault(file, name, f"at is {at!r}", "write anywhere, start or whole")
    patterns = (str(record["pattern"]),) if "pattern" in record else _texts(file, name, record, "any")
    return RuleRecord(
        f"{stem}.{name}", file, str(record.get("role", stem)), tuple(map(one_line, patterns)), at,
        bool(record.get("case", False)),
        float(record.get("weight", 0)), record.get("yields", {}), record.get("given", {}), str(record.get("about", "")),
        _texts(file, name, record, "examples"), _texts(file, name, record, "counterexamples"),
    )  # fmt: skip


def one_line(pattern: str) -> str:
    """A pattern of several lines as one: breaks and indentation are nothing, spaces within a line are spaces."""
    return "".join(line.strip() for line in pattern.splitlines()) if "\n" in pattern else pattern


def fault(file: str, name: str, what: str, remedy: str) -> ConfigError:
    """The error for a data file: where, what, what to do."""
    return ConfigError(f"sgcad_core/reading/language/**/{file}, record {name!r}: {what}; {remedy}")


def _mapping(file: str, name: str, raw: object, known: set[str]) -> dict[str, Any]:
    if not isinstance(raw, dict):
        raise fault(file, name, f"it is {type(raw).__name__}, not a mapping", "indent its fields below its name")
    odd = sorted(str(key) for key in set(raw) - known)
    if odd:
        raise fault(file, name, f"unknown field {', '.join(odd)}", f"known are {', '.join(sorted(known))}")
    return raw


def _texts(file: str, name: str, record: Mapping[str, Any], key: str) -> tuple[str, ...]:
    found = record.get(key, [])
    if not isinstance(found, list) or not all(isinstance(text, str) for text in found):
        raise fault(file, name, f"{key} is no list of texts", "put each text on a line with a dash, quoted")
    return tuple(found)
