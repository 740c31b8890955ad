"""How many deletions in the language data the language tests notice.

    python -m benchmarks.mutants [--count 300] [--seed 1] [--all] [--missed]

A mutant lacks one alternative of a pattern, one rule, or one word of the vocabulary. It is noticed if an example, a
sentence of `tests/sgcad_core/language/readings.yaml` or the list of rules that the code asks for tells. What is asked
here is what the tests of that folder ask, of the records that the deletion can touch.
"""

from __future__ import annotations

import argparse
import random
import sys
import time
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any, Literal

from sgcad_core.errors import ConfigError
from sgcad_core.language.branches import alternatives, without
from sgcad_core.language.data import SLOT, Language, language
from sgcad_core.language.examples import class_faults, rule_faults
from sgcad_core.language.records import RuleRecord, WordClass
from tests.sgcad_core.language.readings import asked_for, reading_faults

Kind = Literal["alternative", "rule", "word"]


@dataclass(frozen=True)
class Mutant:
    """A language with one deletion: what is gone, in words, and which record it was taken from."""

    kind: Kind
    name: str
    gone: str
    rule: RuleRecord | None = None
    words: WordClass | None = None

    def of(self, whole: Language) -> Language:
        """The whole language with this deletion."""
        if self.words is not None:
            return Language({**whole.classes, self.name: self.words}, whole.rules)
        rules = {id: record for id, record in whole.rules.items() if id != self.name}
        return Language(whole.classes, {**rules, self.name: self.rule} if self.rule is not None else rules)


def mutants(whole: Language) -> list[Mutant]:
    """Every deletion that can be made."""
    found: list[Mutant] = []
    for record in whole.rules.values():
        found.append(Mutant("rule", record.id, "the rule"))
        found += _of_rule(record)
    for of in whole.classes.values():
        found += _of_class(of)
    return found


def noticed(mutant: Mutant, whole: Language) -> bool:
    """Whether the language tests fail on a mutant."""
    changed = mutant.of(whole)
    try:
        if mutant.kind == "rule":
            return mutant.name in asked_for() or bool(reading_faults(changed))
        if mutant.words is not None:
            users = _users(whole, mutant.name)
            if any(True for of in users["classes"] for _ in class_faults(changed, changed.classes[of])):
                return True
            return any(True for id in users["rules"] for _ in rule_faults(changed, changed.rules[id]))
        return any(True for _ in rule_faults(changed, changed.rules[mutant.name]))
    except ConfigError:
        return True


def _of_rule(record: RuleRecord) -> Iterator[Mutant]:
    for at, pattern in enumerate(record.alternatives):
        rest = record.alternatives[:at] + record.alternatives[at + 1 :]
        if rest:
            yield Mutant("alternative", record.id, pattern, replace(record, alternatives=rest))
        for group, number in alternatives(pattern):
            fewer = (*record.alternatives[:at], without(pattern, group, number), *record.alternatives[at + 1 :])
            start, end = group.branches[number]
            yield Mutant("alternative", record.id, pattern[start:end], replace(record, alternatives=fewer))


def _of_class(of: WordClass) -> Iterator[Mutant]:
    for word in of.words:
        rest = {w: meaning for w, meaning in of.words.items() if w != word}
        if rest:
            yield Mutant("word", of.name, word, words=replace(of, words=rest))
        for group, number in () if of.plain else alternatives(word):
            fewer = {without(word, group, number) if w == word else w: meaning for w, meaning in of.words.items()}
            yield Mutant("word", of.name, f"a part of {word}", words=replace(of, words=fewer))
    for group, number in alternatives(of.pattern or ""):
        start, end = group.branches[number]
        gone = (of.pattern or "")[start:end]
        yield Mutant("word", of.name, gone, words=replace(of, pattern=without(of.pattern or "", group, number)))


def _users(whole: Language, name: str) -> Mapping[str, list[str]]:
    """Classes and rules in which a class stands, itself among them."""
    classes = [name]
    for one in classes:
        classes += [
            other.name for other in whole.classes.values()
            if other.name not in classes and one in {*other.includes, *_slots([other.pattern or "", *other.words])}
        ]  # fmt: skip
    rules = [r.id for r in whole.rules.values() if set(classes) & _slots(r.alternatives)]
    return {"classes": classes, "rules": rules}


def _slots(patterns: Any) -> set[str]:
    return {slot for pattern in patterns for slot in SLOT.findall(pattern)}


def main(argv: list[str] | None = None) -> int:
    """Print the share of mutants that are noticed; exit 1 below 95 %."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mutants", description=__doc__.splitlines()[0])  # type: ignore[union-attr]
    parser.add_argument("--count", type=int, default=300, help="mutants drawn")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--all", action="store_true", help="every mutant that there is")
    parser.add_argument("--missed", action="store_true", help="name those that go unnoticed")
    args = parser.parse_args(argv)
    whole, began = language(), time.perf_counter()
    every = mutants(whole)
    drawn = every if args.all else random.Random(args.seed).sample(every, min(args.count, len(every)))
    missed = [m for m in drawn if not noticed(m, whole)]
    kinds, lost = Counter(m.kind for m in drawn), Counter(m.kind for m in missed)
    for kind in kinds:
        sys.stdout.write(f"{kind}: {kinds[kind] - lost[kind]} of {kinds[kind]} noticed\n")
    share = 1 - len(missed) / len(drawn)
    seconds = time.perf_counter() - began
    found = f"{len(drawn) - len(missed)} of {len(drawn)} noticed ({share:.1%}) of {len(every)} there are"
    sys.stdout.write(f"{found}; {seconds:.0f} s\n")
    for m in missed if args.missed else ():
        sys.stdout.write(f"  {m.kind} of {m.name}: {m.gone}\n")
    return 0 if share >= 0.95 else 1


if __name__ == "__main__":
    sys.exit(main())
