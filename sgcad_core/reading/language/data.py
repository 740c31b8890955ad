"""All word classes and rules as one immutable value, and patterns with their slots filled. Reads the data files.

Tests make a `Language` with changed records.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

import yaml

from sgcad_core.reading.language.alternatives import any_of
from sgcad_core.reading.language.needs import Told, needs_of, slot, told_by, told_by_any, told_by_words
from sgcad_core.reading.language.records import RuleRecord, WordClass, fault, rule_record, word_class

HERE = Path(__file__).parent
SLOT = re.compile(r"\{([a-z][a-z_]*)\}")
"""A place for a word class in a pattern; repetitions such as {0,3} are none."""
_DEEPEST = 8
_LOADER = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


@dataclass(frozen=True)
class Language:
    """Every word class by name and every rule by id."""

    classes: Mapping[str, WordClass]
    rules: Mapping[str, RuleRecord]

    def values(self, name: str) -> dict[str, Any]:
        """Word -> meaning of a class, included classes first."""
        own = self._class(name, "vocabulary", name)
        found: dict[str, Any] = {}
        for other in own.includes:
            found |= self.values(other)
        return found | dict(own.words)

    def slot(self, name: str, file: str = "vocabulary", record: str = "") -> str:
        """The pattern that a slot stands for, as one group. `file` and `record`: the asking record, for the error."""
        own = self._class(name, file, record or name)
        if own.pattern is not None:
            return f"(?:{own.pattern})"
        if self._plain(own):
            return any_of(self.values(name))
        parts = [self.slot(other, own.file, name) for other in own.includes]
        return f"(?:{'|'.join(parts + [re.escape(w) if own.plain else w for w in own.words])})"

    def _plain(self, own: WordClass) -> bool:
        """Whether a class, those that it includes too, has plain words only."""
        return (
            own.plain
            and own.pattern is None
            and all(self._plain(self._class(n, own.file, own.name)) for n in own.includes)
        )

    def pattern(self, record: RuleRecord, given: Mapping[str, str] | None = None) -> re.Pattern[str]:
        """A rule compiled; `given` are patterns for the caller's slots (the samples where absent)."""
        samples = {name: re.escape(word) for name, word in record.given.items()}
        text = "|".join(record.alternatives)
        filled = self.filled(text, record.file, record.id, samples | dict(given or {}))
        try:
            return re.compile(filled, 0 if record.case else re.IGNORECASE)
        except re.error as error:
            remedy = "mend the pattern; a literal brace is written \\{"
            raise fault(record.file, record.id, f"the pattern does not compile ({error})", remedy) from error

    def filled(self, text: str, file: str, record: str, given: Mapping[str, str]) -> str:
        """A pattern with all its slots filled, those inside slots too."""
        for _ in range(_DEEPEST):
            if not SLOT.search(text):
                return text
            text = SLOT.sub(lambda m: given[m[1]] if m[1] in given else self.slot(m[1], file, record), text)
        raise fault(file, record, f"slots nest deeper than {_DEEPEST}", "let no class stand in its own pattern")

    def needs(self, record: RuleRecord) -> tuple[str, ...]:
        """Words in small letters, one of which is in every text that the rule reads; none if that is not known."""
        samples = {name: told_by_words([word]) for name, word in record.given.items()}
        return needs_of(self._told("|".join(record.alternatives), samples))

    def _told(self, text: str, given: Mapping[str, Told]) -> Told:
        names = list(dict.fromkeys(SLOT.findall(text)))
        slots = [given[name] if name in given else self._told_by(name) for name in names]
        return told_by(SLOT.sub(lambda m: slot(names.index(m[1])), text), slots)

    def _told_by(self, name: str) -> Told:
        """What a word class tells, asked once."""
        if name not in self._seen:
            own = self._class(name, "vocabulary", name)
            if self._plain(own):
                self._seen[name] = told_by_words(self.values(name))
            else:
                texts = (
                    [own.pattern]
                    if own.pattern is not None
                    else list(map(re.escape, own.words) if own.plain else own.words)
                )
                others = [self._told_by(other) for other in own.includes]
                self._seen[name] = told_by_any([*others, *(self._told(text, {}) for text in texts)])
        return self._seen[name]

    @cached_property
    def _seen(self) -> dict[str, Told]:
        return {}

    @cached_property
    def roles(self) -> dict[str, tuple[str, ...]]:
        """Ids of each role's rules in the order of their weight."""
        found: dict[str, list[RuleRecord]] = {}
        for record in self.rules.values():
            found.setdefault(record.role, []).append(record)
        return {role: tuple(r.id for r in sorted(of, key=lambda r: r.weight)) for role, of in found.items()}

    def _class(self, name: str, file: str, record: str) -> WordClass:
        if name not in self.classes:
            remedy = f"word classes are {', '.join(sorted(self.classes))}"
            raise fault(file, record, f"unknown slot {{{name}}}", remedy)
        return self.classes[name]


@lru_cache(maxsize=1)
def language() -> Language:
    """The data files of the package, read once."""
    rules = [rule_record(*item) for item in _records(HERE / "rules")]
    return Language(vocabulary().classes, {r.id: r for r in rules})


@lru_cache(maxsize=1)
def vocabulary() -> Language:
    """The word classes alone, for modules that need words before any rule is read."""
    classes: dict[str, WordClass] = {}
    for file, name, record in _records(HERE / "vocabulary"):
        if name in classes:
            raise fault(file, name, f"{classes[name].file} has a class of that name", "give one of both another name")
        classes[name] = word_class(file, name, record)
    return Language(classes, {})


def words(name: str) -> tuple[str, ...]:
    """The words of a class in the order of the file. Raises ConfigError where there is no such class."""
    return tuple(vocabulary().values(name))


def values(name: str) -> dict[str, Any]:
    """Word -> meaning of a class: "northeast" -> "NE" of compass."""
    return vocabulary().values(name)


def _records(folder: Path) -> list[tuple[str, str, object]]:
    """(file name, record name, record) of every YAML file of a folder."""
    found: list[tuple[str, str, object]] = []
    for file in sorted(folder.glob("*.yaml")):
        try:
            raw = yaml.load(file.read_text(encoding="utf-8"), Loader=_LOADER)  # noqa: S506 - both are safe loaders
        except yaml.YAMLError as error:
            raise fault(file.name, "-", f"no YAML ({error})", "mend the line; quote texts and patterns") from error
        for name, record in (raw or {}).items():
            if not isinstance(name, str):  # YAML reads a bare on, off, yes and no as a truth value
                raise fault(file.name, str(name), "its name is no text", "quote it")
            found.append((file.name, name, record))
    return found
