"""Replaces numbers of the text in a reading by the final ids of people, cyclists and animals.

A text without numbers is read with a number for every actor; here V2, a cyclist, becomes B1. Knows no text.
"""

from __future__ import annotations

from dataclasses import fields, is_dataclass, replace
from typing import Any, TypeVar

from sgcad_core.records.facts import Fact
from sgcad_core.records.timeline import Act

T = TypeVar("T")
_LONGEST_NAME = 60
"""Characters of a dotted name; longer strings are texts."""


def renamed(value: T, called: dict[str, str]) -> T:
    """A record with every id, alone or within a dotted name, as the actor is called in the end."""
    if not called:
        return value
    return _renamed(value, called)  # type: ignore[no-any-return]


def _renamed(value: Any, called: dict[str, str]) -> Any:
    if isinstance(value, str):
        return ".".join(called.get(part, part) for part in value.split(".")) if len(value) < _LONGEST_NAME else value
    if isinstance(value, Fact):
        return value.model_copy(update={n: _renamed(getattr(value, n), called) for n in ("field", "value")})
    if isinstance(value, Act):
        return value.model_copy(update={n: _renamed(getattr(value, n), called) for n in ("actor", "other")})
    if is_dataclass(value) and not isinstance(value, type):
        return replace(value, **{f.name: _renamed(getattr(value, f.name), called) for f in fields(value) if f.init})
    if isinstance(value, tuple):
        parts = [_renamed(part, called) for part in value]
        return type(value)(*parts) if hasattr(value, "_fields") else tuple(parts)
    if isinstance(value, dict):
        return {_renamed(k, called): _renamed(v, called) for k, v in value.items()}
    return value
