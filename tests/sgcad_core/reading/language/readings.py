"""What the language tests ask beside examples: rules that the code names, rules of a role that read a sentence."""

from __future__ import annotations

import re
from collections.abc import Iterator
from functools import lru_cache
from pathlib import Path

import yaml

from sgcad_core.kinds import JUNCTIONS
from sgcad_core.reading.language.data import Language

ROOT = Path(__file__).parents[4]
SENTENCES = Path(__file__).with_name("readings.yaml")
"""Role -> sentence -> keys of the role's rules that read it, in their order."""
FACTS = Path(__file__).with_name("facts.yaml")
"""Rule -> sentence -> field -> value that the whole reader draws from that sentence by that rule."""
_CODE = ("sgcad_core", "plugins", "research", "flows")


@lru_cache(maxsize=1)
def asked_for() -> frozenset[str]:
    """Ids that the code names, itself or in a record of a kind."""
    return frozenset(_named(r"\brule\(\s*\"([\w.]+)\"")) | {record.rule for record in JUNCTIONS if record.rule}


@lru_cache(maxsize=1)
def roles_asked_for() -> frozenset[str]:
    """Roles that the code names."""
    return frozenset(_named(r"\bof_role\(\s*\"(\w+)\"")) | {"light", "weather", "surface"}


@lru_cache(maxsize=1)
def classes_asked_for() -> frozenset[str]:
    """Word classes that the code names."""
    return frozenset(_named(r"\b(?:words|values)\(\s*\"(\w+)\""))


@lru_cache(maxsize=1)
def sentences() -> dict[str, dict[str, list[str]]]:
    """The sentences of the file."""
    found: dict[str, dict[str, list[str]]] = yaml.safe_load(SENTENCES.read_text(encoding="utf-8"))
    return found


@lru_cache(maxsize=1)
def facts_of_sentences() -> list[tuple[str, str, dict[str, object]]]:
    """(rule, sentence, facts) of the file of facts."""
    found: dict[str, dict[str, dict[str, object]]] = yaml.safe_load(FACTS.read_text(encoding="utf-8"))
    return [(id, sentence, facts) for id, told in found.items() for sentence, facts in told.items()]


def reading_faults(language: Language) -> list[str]:
    """Sentences that other rules of a role read than those told."""
    return [fault for role, told in sentences().items() for fault in _of_role(language, role, told)]


def _of_role(language: Language, role: str, told: dict[str, list[str]]) -> Iterator[str]:
    ids = language.roles.get(role, ())
    patterns = {id: language.pattern(language.rules[id]) for id in ids}
    for sentence, expected in told.items():
        found = [id for id, pattern in patterns.items() if pattern.search(sentence)]
        if found != expected:
            yield f"{role}: {sentence!r} is read by {', '.join(found) or 'none'}, not by {', '.join(expected)}"


def _named(pattern: str) -> Iterator[str]:
    for folder in _CODE:
        for file in sorted((ROOT / folder).rglob("*.py")):
            yield from re.findall(pattern, file.read_text(encoding="utf-8"))
