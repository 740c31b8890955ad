"""A backbone that answers from a list or a file, for tests and for replaying a run.

An entry is a text, or a mapping with `answer` (a text or JSON) and any of these conditions:

    - {case: c1, stage: road, attempt: 2, narrative: "struck", task: "road", answer: {...}}

`case`, `stage` and `attempt` must equal the query's, `narrative` and `task` are words that must occur
there. An entry with a condition answers every query that meets it, the first in the file wins; the others
answer in their order, once each. Gives no logits, so a decoder that contrasts is refused.
"""

from __future__ import annotations

import json
import threading
from functools import cached_property
from pathlib import Path
from typing import Any, ClassVar

import yaml
from pydantic import BaseModel, ConfigDict, PrivateAttr, ValidationError, model_validator

from sgcad_core.asking.json_field_spans import is_refusal
from sgcad_core.case.records import Context, Generation, Query, Stage
from sgcad_core.errors import ConfigError, InvalidOutput
from sgcad_core.interfaces import Backbone, Decoder
from sgcad_core.system.yaml_faults import YAML_FAULTS


class Answer(BaseModel):
    """One entry; a condition left None always holds."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    answer: Any
    case: str | None = None
    stage: Stage | None = None
    attempt: int | None = None
    narrative: str | None = None
    task: str | None = None

    @property
    def conditional(self) -> bool:
        """True if any condition is set."""
        return any(v is not None for v in (self.case, self.stage, self.attempt, self.narrative, self.task))

    def meets(self, context: Context, query: Query) -> bool:
        """True if every condition holds."""
        equal = ((self.case, query.case), (self.stage, query.stage), (self.attempt, query.attempt))
        within = ((self.narrative, context.narrative), (self.task, query.task))
        return all(w is None or w == v for w, v in equal) and all(w is None or w in v for w, v in within)

    @property
    def text(self) -> str:
        """The answer as a model would have written it: compact JSON unless it is a text already."""
        if isinstance(self.answer, str):
            return self.answer
        return json.dumps(self.answer, separators=(",", ":"), ensure_ascii=False)


class Scripted(Backbone):
    """Answers from a script instead of a model, for tests and replays.

    answers are entries in the config; file holds further ones (a YAML list, or one JSON value a line in .jsonl).
    """

    gives_logits: ClassVar[bool] = False
    answers: tuple[Any, ...] = ()
    file: Path | None = None

    _lock: threading.Lock = PrivateAttr(default_factory=threading.Lock)
    _used: int = PrivateAttr(default=0)

    @model_validator(mode="after")
    def _has_answers(self) -> Scripted:
        if not self.answers and self.file is None:
            raise ValueError("needs `answers` or `file`: a scripted backbone has nothing else to say")
        return self

    @cached_property
    def entries(self) -> tuple[Answer, ...]:
        """Every entry, inline ones first. Raises ConfigError naming file, entry and fault."""
        raw = [*self.answers, *(_read(self.file) if self.file else ())]
        return tuple(_entry(value, i, self.file) for i, value in enumerate(raw, 1))

    def generate(self, context: Context, query: Query, decoder: Decoder, seed: int = 0) -> Generation:
        """The first entry whose conditions hold, else the next without any. Raises InvalidOutput if none is left."""
        if decoder.needs_prior:
            raise ConfigError(
                f"decoder {type(decoder).__name__} needs logits; the scripted backbone gives none: use decoder 'greedy'"
            )
        text = self._answer(context, query)
        return Generation(text=text, finish="refused" if is_refusal(text) else "stop")

    def _answer(self, context: Context, query: Query) -> str:
        for entry in self.entries:
            if entry.conditional and entry.meets(context, query):
                return entry.text
        plain = [entry for entry in self.entries if not entry.conditional]
        with self._lock:
            place, self._used = self._used, self._used + 1
        if place < len(plain):
            return plain[place].text
        raise InvalidOutput(
            f"the script has no answer for case {query.case!r}, stage {query.stage}, attempt {query.attempt}: "
            f"its {len(plain)} answers without a condition are used up; add an entry"
        )


def _read(file: Path) -> list[Any]:
    try:
        text = file.read_text(encoding="utf-8")
        if file.suffix == ".jsonl":
            return [json.loads(line) for line in text.splitlines() if line.strip()]
        found = yaml.safe_load(text)
    except (OSError, *YAML_FAULTS) as fault:
        raise ConfigError(f"backbone.file {file}: cannot be read: {fault}") from fault
    if not isinstance(found, list):
        raise ConfigError(f"backbone.file {file}: expected a list of answers, found {type(found).__name__}")
    return found


def _entry(value: Any, number: int, file: Path | None) -> Answer:
    if not isinstance(value, dict) or "answer" not in value:
        return Answer(answer=value)
    try:
        return Answer(**value)
    except ValidationError as fault:
        raise ConfigError(f"backbone{f'.file {file}' if file else ''}: answer {number}: {fault}") from fault
