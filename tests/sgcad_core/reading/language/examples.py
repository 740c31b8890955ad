"""Examples of rules and word classes: how they are written, and whether the rules read them so.

An example is a text with what is read between « and »; what the groups of the pattern say follows behind an arrow, a
bar between groups and two bars between places: `two lanes «each way» and «both sides» -> 1=each || 1=both`. The example
of a word class says in the same way what its words mean: `a «red» Ford -> red`. Draws no conclusion from a text.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from typing import NamedTuple

from sgcad_core.reading.language.data import Language
from sgcad_core.reading.language.records import RuleRecord, WordClass, fault

ARROW, BAR, PLACE = " -> ", " | ", " || "


class Read(NamedTuple):
    """One place of a text: where it begins and ends, and what its groups say ("1=each | side=left")."""

    start: int
    end: int
    says: str


def reads(pattern: re.Pattern[str], text: str, at: str = "anywhere") -> list[Read]:
    """Every place of a text that a pattern reads, as a rule with that `at` is asked."""
    if at == "anywhere":
        found: Iterable[re.Match[str] | None] = pattern.finditer(text)
    else:
        found = [pattern.match(text) if at == "start" else pattern.fullmatch(text)]
    return [Read(m.start(), m.end(), _says(m)) for m in found if m]


def word_reads(language: Language, of: WordClass, text: str) -> list[Read]:
    """Every word of a class in a text with what it means; of a class that is a pattern, every place it fits."""
    pattern = re.compile(class_pattern(language, of), re.IGNORECASE)
    values = {word.lower(): str(meaning) for word, meaning in language.values(of.name).items()} if of.plain else {}
    return [Read(m.start(), m.end(), values.get(m[0].lower(), "")) for m in pattern.finditer(text)]


def class_pattern(language: Language, of: WordClass) -> str:
    """The pattern that a class's examples are read with: words stand alone, phrases anywhere."""
    filled = language.filled(language.slot(of.name), of.file, of.name, {})
    return rf"(?<!\w){filled}(?!\w)" if of.pattern is None else filled


def written(text: str, places: Iterable[Read]) -> str:
    """The example that says what was read in a text."""
    out, at, said = "", 0, []
    for place in places:
        out += f"{text[at : place.start]}«{text[place.start : place.end]}»"
        at = place.end
        said.append(place.says)
    tail = ARROW + PLACE.join(said) if any(said) else ""
    return out + text[at:] + tail


def parsed(example: str) -> tuple[str, list[Read]]:
    """The text of an example and what it says is read there."""
    marked, _, tail = example.partition(ARROW)
    pieces = re.split(r"[«»]", marked)
    said = tail.split(PLACE) if tail else []
    places, text = [], ""
    for number, piece in enumerate(pieces):
        if number % 2:
            says = said[number // 2] if number // 2 < len(said) else ""
            places.append(Read(len(text), len(text) + len(piece), says))
        text += piece
    return text, places


def rule_faults(language: Language, record: RuleRecord) -> Iterator[str]:
    """What is wrong with a rule's examples; none: it reads every example as told and no counterexample."""
    pattern = language.pattern(record)
    if not record.examples:
        yield str(fault(record.file, record.id, "it has no example", "add a sentence that it must read"))
    for example in record.examples:
        text, told = parsed(example)
        found = reads(pattern, text, record.at)
        if found != told:
            remedy = f"it reads {written(text, found)!r}: mend the rule, or the example"
            yield str(fault(record.file, record.id, f"the example {example!r} is read otherwise", remedy))
    for text in record.counterexamples:
        if reads(pattern, text, record.at):
            yield str(fault(record.file, record.id, f"it reads the counterexample {text!r}", "mend the rule"))


def class_faults(language: Language, of: WordClass) -> Iterator[str]:
    """What is wrong with a word class's examples; a class that only includes others needs none."""
    if not of.examples and not of.includes:
        yield str(fault(of.file, of.name, "it has no example", "add a text with its words and what they mean"))
    for example in of.examples:
        text, told = parsed(example)
        found = word_reads(language, of, text)
        if found != told:
            remedy = f"it reads {written(text, found)!r}: mend the class, or the example"
            yield str(fault(of.file, of.name, f"the example {example!r} is read otherwise", remedy))


def faults(language: Language) -> list[str]:
    """Every fault of every example of a language."""
    found = [fault for record in language.rules.values() for fault in rule_faults(language, record)]
    return found + [fault for of in language.classes.values() for fault in class_faults(language, of)]


def _says(m: re.Match[str]) -> str:
    names = {number: name for name, number in m.re.groupindex.items()}
    said = [f"{names.get(n, n)}={text}" for n, text in enumerate(m.groups(), 1) if text is not None]
    return BAR.join(said)
