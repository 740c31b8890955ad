"""Rows of a gist as tokens to learn from: the prompt as the backbone writes it, the answer, and where it may choose.

The loss asks at each choice for all tokens that lead to an allowed value, together (Cour, Sapp & Taskar 2011, "Learning
from partial labels"). Tokens of the prompt, and those that the grammar forces, are never asked for. Knows no weights.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from random import Random
from typing import Any, NamedTuple

from plugins.backbone.hf_prompt import Prompter
from plugins.backbone.prompt import Parts
from research.adapters.gist_spelling import GistSpelling, following
from research.rows.partial_labels import OPTIONS, Told


class Choice(NamedTuple):
    """At this index of the tokens one of `allowed` should stand; `weight` is a factor of its loss."""

    at: int
    allowed: tuple[int, ...]
    weight: float


@dataclass(frozen=True)
class Example:
    """Tokens of prompt and answer, up to the last choice; `answer` is the index of the answer's first token."""

    ids: tuple[int, ...]
    choices: tuple[Choice, ...]
    answer: int


class Teacher:
    """Writes examples for one model and one task (the text of a prompt file)."""

    def __init__(self, prompter: Prompter, task: str, rows: Sequence[Told]) -> None:
        self.prompter, self.task = prompter, task
        self.spelling = GistSpelling(prompter.tokenizer)
        self.usual = {key: [told.allowed[key] for told in rows if key in told.allowed] for key in OPTIONS}
        """Of each field what rows say of it: what stands in an answer of which the field is not known."""

    def example(self, told: Told, seed: int, blank: bool = False) -> Example:
        """Prompt and answer of a row; `blank`: without its report, so that the model learns what is usual.

        An answer goes by one value of those allowed; of an unknown field it has a value of another row's.
        """
        rng = Random(f"{seed}-{told.id}-{blank}")
        parts = Parts(task=self.task, passages=(), narrative="" if blank else told.text.strip(), diagrams=(), repair="")
        ids = list(self.prompter.prompt(parts).ids)
        answer, choices = len(ids), []
        for key in OPTIONS:
            value = self._chosen(told, key, rng)
            choices += self._choices(told, key, value, len(ids) + len(self.spelling.leads[key]))
            ids += self.spelling.piece(key, value)
        last = max((choice.at for choice in choices), default=answer)
        return Example(tuple(ids[: last + 1]), tuple(choices), answer)

    def _chosen(self, told: Told, key: str, rng: Random) -> str:
        some: Sequence[Any] = told.allowed.get(key) or (rng.choice(self.usual[key]) if self.usual[key] else ())
        return json.dumps(rng.choice(some)) if some else rng.choice(OPTIONS[key])

    def _choices(self, told: Told, key: str, value: str, start: int) -> list[Choice]:
        """Where the tokens of a value might go on to another one, if anything is known of the field."""
        if key not in told.allowed:
            return []
        values, weight = self.spelling.values[key], float(told.weight.get(key, 1.0))
        right = [values[json.dumps(one)] for one in told.allowed[key]]
        return [
            Choice(start + depth, tuple(sorted(following(right, values[value][:depth]))), weight)
            for depth in self.spelling.branches(key, value)
        ]


def examples(teacher: Teacher, rows: Sequence[Told], seed: int, blank: float, longest: int) -> list[Example]:
    """All rows that are at most `longest` tokens, and a share of them without their report."""
    rng = Random(seed)
    found = [teacher.example(told, seed) for told in rows]
    found = [one for one in found if len(one.ids) <= longest]
    found += [teacher.example(told, seed, blank=True) for told in rng.sample(list(rows), round(blank * len(rows)))]
    return [one for one in found if one.choices]
