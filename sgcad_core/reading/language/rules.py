"""Rules by id and by role, as handles that compile on first use. Knows no report.

A handle has the methods of a compiled pattern: `rule("control.signal").search(text)`.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any

from sgcad_core.reading.language.data import language
from sgcad_core.reading.language.needs import lacks
from sgcad_core.reading.language.records import RuleRecord, fault

Found = Callable[..., re.Match[str] | None]


@dataclass(frozen=True)
class Rule:
    """A rule of the data files. Reads nothing until it is used, so that a module may name its rules at its top."""

    id: str

    @cached_property
    def record(self) -> RuleRecord:
        """What the data file says. Raises ConfigError where it has no such rule."""
        found = language().rules.get(self.id)
        if found is None:
            stem = self.id.split(".", 1)[0]
            near = sorted(id for id in language().rules if id.startswith(f"{stem}.")) or ["none"]
            raise fault(f"{stem}.yaml", self.id, "there is no such rule", f"rules of that file: {', '.join(near)}")
        return found

    @cached_property
    def pattern(self) -> re.Pattern[str]:
        """The compiled pattern, slots filled."""
        return language().pattern(self.record)

    @property
    def yields(self) -> Mapping[str, Any]:
        """What the rule states wherever it reads."""
        return self.record.yields

    def given(self, **filling: str | tuple[str, ...]) -> re.Pattern[str]:
        """The pattern with the caller's slots filled with plain words (a tuple: any of them)."""
        return _given(self.id, tuple(sorted(filling.items())))

    def within(self, **filling: str) -> re.Pattern[str]:
        """The pattern with the caller's slots filled with patterns."""
        return _within(self.id, tuple(sorted(filling.items())))

    @cached_property
    def lacks(self) -> Callable[[str], bool]:
        """Whether a text has nothing of what every match holds; False says nothing."""
        return _lacks(self.record)

    # The pattern's own methods, asked only where the text may hold a match: a report asks thousands of times.
    @cached_property
    def search(self) -> Found:
        """`re.Pattern.search`."""
        find, lacks = self.pattern.search, self.lacks
        return lambda text, *within: None if lacks(text) else find(text, *within)

    @cached_property
    def match(self) -> Found:
        """`re.Pattern.match`."""
        return self.pattern.match  # one place of a text is tried faster than all of it is looked at

    @cached_property
    def fullmatch(self) -> Found:
        """`re.Pattern.fullmatch`."""
        return self.pattern.fullmatch

    @cached_property
    def finditer(self) -> Callable[..., Iterator[re.Match[str]]]:
        """`re.Pattern.finditer`."""
        find, lacks = self.pattern.finditer, self.lacks
        return lambda text, *within: iter(()) if lacks(text) else find(text, *within)

    @cached_property
    def findall(self) -> Callable[..., list[Any]]:
        """`re.Pattern.findall`."""
        find, lacks = self.pattern.findall, self.lacks
        return lambda text, *within: [] if lacks(text) else find(text, *within)

    @cached_property
    def sub(self) -> Callable[..., str]:
        """`re.Pattern.sub`."""
        sub, lacks = self.pattern.sub, self.lacks
        return lambda to, text, count=0: text if lacks(text) else sub(to, text, count)

    @cached_property
    def subn(self) -> Callable[..., tuple[str, int]]:
        """`re.Pattern.subn`."""
        return self.pattern.subn

    @cached_property
    def split(self) -> Callable[..., list[Any]]:
        """`re.Pattern.split`."""
        return self.pattern.split


@lru_cache(maxsize=None)  # noqa: UP033 - as many as there are rules
def rule(id: str) -> Rule:
    """The rule of an id, "file.name"; whether there is one is asked on first use."""
    return Rule(id)


def of_role(role: str) -> tuple[Rule, ...]:
    """The rules of a role in the order of their weight. Raises ConfigError where there is no such role."""
    found = language().roles.get(role)
    if found is None:
        raise fault("*.yaml", role, "no rule has this role", f"roles are {', '.join(sorted(language().roles))}")
    return tuple(rule(id) for id in found)


@lru_cache(maxsize=4096)
def _given(id: str, filling: tuple[tuple[str, str | tuple[str, ...]], ...]) -> re.Pattern[str]:
    patterns = {name: re.escape(w) if isinstance(w, str) else _any(w) for name, w in filling}
    return language().pattern(rule(id).record, patterns)


@lru_cache(maxsize=4096)
def _within(id: str, filling: tuple[tuple[str, str], ...]) -> re.Pattern[str]:
    return language().pattern(rule(id).record, dict(filling))


_ENOUGH = 12_000
"""Characters that a rule is asked about before it is worth knowing what its matches need, which takes about as long."""
_FEW = 16
"""So few characters are searched as fast as they are looked up."""


def _lacks(record: RuleRecord) -> Callable[[str], bool]:
    asked, needs = 0, tuple[str, ...]()

    def told(text: str) -> bool:
        nonlocal asked, needs
        if len(text) < _FEW:
            return False
        if asked < _ENOUGH:
            asked += len(text)
            if asked < _ENOUGH:
                return False
            needs = language().needs(record)
        return lacks(text, needs)

    return told


def _any(words: tuple[str, ...]) -> str:
    return f"(?:{'|'.join(map(re.escape, words))})"
