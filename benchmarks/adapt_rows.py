"""Rows of a gist as tokens to learn from: the prompt as the backbone writes it, the answer, and where it may choose.

The loss asks at each choice for all tokens that lead to an allowed value, together (Cour, Sapp & Taskar 2011, "Learning
from partial labels"). Tokens of the prompt, and those that the grammar forces, are never asked for. Knows no weights.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from random import Random
from typing import Any, NamedTuple

from mini.told import OPTIONS, Told
from plugins.backbone.hf_prompt import Prompter
from plugins.backbone.prompt import Parts


class Choice(NamedTuple):
    """At this index of the tokens one of `allowed` should stand; `weight` is a factor of its loss."""

    at: int
    allowed: tuple[int, ...]
    weight: float


@dataclass(frozen=True)
class Example:
    """Tokens of prompt and answer, up to the last choice."""

    ids: tuple[int, ...]
    choices: tuple[Choice, ...]


class Teacher:
    """Writes examples for one model and one task (the text of a prompt file)."""

    def __init__(self, prompter: Prompter, task: str, rows: Sequence[Told]) -> None:
        self.prompter, self.task = prompter, task
        self.spelled = {key: {value: self._spell(value.strip('"')) for value in some} for key, some in OPTIONS.items()}
        self.usual = {key: [told.allowed[key] for told in rows if key in told.allowed] for key in OPTIONS}
        """Of each field what rows say of it: what stands in an answer of which the field is not known."""

    def example(self, told: Told, seed: int, blank: bool = False) -> Example:
        """Prompt and answer of a row; `blank`: without its report, so that the model learns what is usual.

        An answer goes by one value of those allowed; of an unknown field it has a value of another row's. Raises
        ValueError where the tokenizer spells an answer otherwise than piece by piece.
        """
        rng = Random(f"{seed}-{told.id}-{blank}")
        parts = Parts(task=self.task, passages=(), narrative="" if blank else told.text.strip(), diagrams=(), repair="")
        ids = list(self.prompter.prompt(parts).ids)
        begun, choices, said = len(ids), [], ""
        for key in OPTIONS:
            value = self._chosen(told, key, rng)
            lead = self._lead(said, key)
            ids += self._spell(lead)
            choices += self._choices(told, key, value, len(ids))
            ids += self.spelled[key][value]
            said += lead + value.strip('"')
        if self._spell(said) != ids[begun:]:
            raise ValueError(f"the tokenizer does not spell {said!r} piece by piece; use a model of another tokenizer")
        last = max((choice.at for choice in choices), default=begun)
        return Example(tuple(ids[: last + 1]), tuple(choices))

    def _lead(self, said: str, key: str) -> str:
        """What the grammar writes in front of a field's value: the quotes of strings are no choice."""
        fields = list(OPTIONS)
        before = fields[fields.index(key) - 1] if said else None
        closing = '"' if before and _quoted(before) else ""
        opening = '"' if _quoted(key) else ""
        return closing + ("," if said else "{") + f'"{key}":' + opening

    def _chosen(self, told: Told, key: str, rng: Random) -> str:
        some: Sequence[Any] = told.allowed.get(key) or (rng.choice(self.usual[key]) if self.usual[key] else ())
        return json.dumps(rng.choice(some)) if some else rng.choice(OPTIONS[key])

    def _choices(self, told: Told, key: str, value: str, start: int) -> list[Choice]:
        """Where the tokens of a value might go on to another one, if anything is known of the field."""
        if key not in told.allowed:
            return []
        spelled, own = self.spelled[key], self.spelled[key][value]
        right = [spelled[json.dumps(one)] for one in told.allowed[key]]
        found = []
        for depth in range(len(own)):
            if len(_next(spelled.values(), own[:depth])) > 1:
                allowed = tuple(sorted(_next(right, own[:depth])))
                found.append(Choice(start + depth, allowed, float(told.weight.get(key, 1.0))))
        return found

    def _spell(self, text: str) -> list[int]:
        found: list[int] = self.prompter.tokenizer(text, add_special_tokens=False)["input_ids"]
        return found


def _next(spelled: Any, begun: Sequence[int]) -> set[int]:
    """Tokens behind a beginning in those spellings that have it."""
    depth = len(begun)
    return {one[depth] for one in spelled if len(one) > depth and one[:depth] == begun}


def _quoted(key: str) -> bool:
    return OPTIONS[key][0].startswith('"')


def examples(teacher: Teacher, rows: Sequence[Told], seed: int, blank: float, longest: int) -> list[Example]:
    """All rows that are at most `longest` tokens, and a share of them without their report."""
    rng = Random(seed)
    found = [teacher.example(told, seed) for told in rows]
    found = [one for one in found if len(one.ids) <= longest]
    found += [teacher.example(told, seed, blank=True) for told in rng.sample(list(rows), round(blank * len(rows)))]
    return [one for one in found if one.choices]


def targets(some: Sequence[Example]) -> Mapping[int, int]:
    """Token -> how often it is asked for: what a check of the targets reads."""
    counted: dict[int, int] = {}
    for example in some:
        for choice in example.choices:
            for token in choice.allowed:
                counted[token] = counted.get(token, 0) + 1
    return counted
