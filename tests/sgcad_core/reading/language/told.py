"""What a text tells as a flat record of fields, and the same read by a language that lacks a rule.

Fields are those of `Reading.facts`; besides them whatever a reading holds that is no fact of a vehicle, a contact or a
road (`near`, `gap`, `roads.crosswalk`, ...), its sentences as read, and the text without its persons. A field that
nobody tells is None.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from sgcad_core.reading.language import rule
from sgcad_core.reading.language.data import language
from sgcad_core.reading.language.rules import _given, _within
from sgcad_core.reading.reading import Reading, read
from sgcad_core.reading.text.privacy import redact

FOLDER = Path(__file__).with_name("told")
"""File of rules -> rule -> text -> field -> value; null: the text tells nothing of that field."""
_METHODS = ("search", "match", "fullmatch", "finditer", "findall", "sub", "subn", "split")


_FLAGS = re.compile(r"^(\(\?[a-z]+\))?")
"""Flags for a whole pattern, which have to stand first."""


@lru_cache(maxsize=1)
def told() -> dict[str, dict[str, dict[str, object]]]:
    """Rule -> text -> fields, of all files."""
    found: dict[str, dict[str, dict[str, object]]] = {}
    for file in sorted(FOLDER.glob("*.yaml")):
        records = yaml.safe_load(file.read_text(encoding="utf-8"))
        found |= {f"{file.stem}.{name}": texts for name, texts in records.items()}
    return found


def drawn(text: str) -> dict[str, object]:
    """All that is read of a text, by field; tuples as lists."""
    reading = read(text)
    found: dict[str, Any] = {"redacted": redact(text), **_besides(reading)}
    for fact in reading.facts:
        found.setdefault(fact.field, fact.value)
    return {field: list(value) if isinstance(value, tuple) else value for field, value in found.items()}


def _besides(reading: Reading) -> dict[str, object]:
    crash, roads, near = reading.crash, reading.roads, reading.crash.near_crash
    found: dict[str, object] = {
        "vehicles": len(crash.vehicles), "others": len(crash.others), "contacts": len(crash.contacts),
        "impacts": len(crash.impacts), "roads": len(roads.roads), "sentences": len(reading.sentences),
        "as_read": " ".join(s.text for s in reading.sentences),
        "gap": crash.gap.reason if crash.gap else None, "lost_control": reading.lost_control,
        "slight": crash.slight or None, "inside": sorted(v for v, c in crash.courses.items() if c.inside) or None,
        "offset": sorted(v for v, c in crash.courses.items() if c.offset) or None,
        "at_impact": sorted(v for v, c in crash.courses.items() if c.speed_at_impact) or None,
        "leaves_road": sorted(who for who, course in crash.driven.items() if course.departs),
        "near": bool(near), "near.clearance_m": near.clearance_m if near else None,
        "roads.merge_lane": roads.merge_lane, "roads.crosswalk": roads.crosswalk, "roads.urban": roads.urban,
        "roads.center_line": roads.center_line or None,
        "roads.ground": list(roads.ground) or None,
        "roads.beside": roads.beside, "roads.leaves": roads.leaves, "junction.unsupported": roads.junction.unsupported,
        "junction.circle_lanes": roads.junction.circle_lanes, "junction.skew_deg": roads.junction.skew_deg,
        "junction.offset": roads.junction.offset, "roads.highway": any(road.lanes.highway for road in roads.roads),
    }  # fmt: skip
    return found | {f"near.{vehicle}": how for vehicle, how in (near.evasions if near else ())}


def differs(text: str, fields: dict[str, object]) -> dict[str, object]:
    """What a text gives for the told fields where that is something else."""
    found = drawn(text)
    return {field: found.get(field) for field, value in fields.items() if found.get(field) != value}


@contextmanager
def silenced(id: str) -> Iterator[None]:
    """The language with a rule that reads nothing, its groups kept."""
    handle = rule(id)
    kept = dict(handle.__dict__)
    never = tuple(_FLAGS.sub(r"\1(?!)(?:", one, 1) + ")" for one in handle.record.alternatives)
    record = replace(handle.record, alternatives=never)
    pattern = language().pattern(record)
    _given.cache_clear(), _within.cache_clear()
    handle.__dict__.update({name: getattr(pattern, name) for name in _METHODS}, pattern=pattern, record=record)
    try:
        yield
    finally:
        handle.__dict__.clear()
        handle.__dict__.update(kept)
        _given.cache_clear(), _within.cache_clear()
