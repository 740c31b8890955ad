"""A backbone that answers from a list or a file, for tests and for replaying a run.

An entry is a text, or a mapping with `answer` (a text or JSON) and any of these conditions:

    - {case: c1, stage: road, attempt: 2, narrative: "struck", task: "road", answer: {...}}

`case`, `stage` and `attempt` must equal the query's, `narrative` and `task` are words that must occur
there. An entry with a condition answers every query that meets it, the first in the file wins; the others
answer in their order, once each. Gives no logits, so a decoder that contrasts is refused.

A recorded dialogue is an entry with the answers of a case in their order, the last one for all further attempts:

    - {case: c1, road: [{...}], scenario: [{...}, {...}]}

`file` may be a folder of such files. In a folder, asked.yaml keeps the digest of what each stage was asked when its
answers were written; a stage that is asked anything else is refused.
"""

from __future__ import annotations

import hashlib
import json
import threading
from collections.abc import Iterator
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

ASKED = "asked.yaml"
"""In a folder of dialogues: case -> stage -> digest of the question (`question_digest`)."""


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


class Dialogue(BaseModel):
    """A recorded dialogue: the answers to one case, by stage and attempt."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    case: str
    about: str = ""
    """What is peculiar to it, for readers."""
    road: tuple[Any, ...] = ()
    scenario: tuple[Any, ...] = ()

    def entries(self) -> Iterator[Answer]:
        """One entry an answer; the last one of a stage for all further attempts as well."""
        stages: dict[Stage, tuple[Any, ...]] = {"road": self.road, "scenario": self.scenario}
        for stage, answers in stages.items():
            for number, answer in enumerate(answers, 1):
                last = number == len(answers)
                yield Answer(case=self.case, stage=stage, attempt=None if last else number, answer=answer)


def question_digest(query: Query) -> str:
    """What a stage asks, evidence and repair left out: the instructions with the roads, and the schema."""
    asked = json.dumps([query.task, query.answer_schema], sort_keys=True, default=dict)
    return hashlib.sha256(asked.encode()).hexdigest()[:12]


class Scripted(Backbone):
    """Answers from a script instead of a model, for tests and replays.

    answers are entries in the config; file holds further ones (a YAML list, one JSON value a line in .jsonl, or a
    folder of such files).
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
        found = [entry for i, value in enumerate(self.answers, 1) for entry in _entries(value, i, None)]
        for file in _files(self.file):
            found += [entry for i, value in enumerate(_read(file), 1) for entry in _entries(value, i, file)]
        return tuple(found)

    @cached_property
    def asked(self) -> dict[str, dict[str, str]]:
        """What the dialogues of a folder were asked, by case and stage; empty where no digests are kept."""
        kept = self.file / ASKED if self.file else None
        return _read_digests(kept) if kept and kept.is_file() else {}

    def generate(self, context: Context, query: Query, decoder: Decoder, seed: int = 0) -> Generation:
        """The first entry whose conditions hold, else the next without any. Raises InvalidOutput if none is left."""
        if decoder.needs_prior:
            raise ConfigError(
                f"decoder {type(decoder).__name__} needs logits; the scripted backbone gives none: use decoder 'greedy'"
            )
        self._check_question(query)
        text = self.answer(context, query)
        return Generation(text=text, finish="refused" if is_refusal(text) else "stop")

    def _check_question(self, query: Query) -> None:
        """Raises ConfigError if the recorded answers of this stage were given to another prompt or schema."""
        kept = self.asked.get(query.case, {}).get(query.stage or "")
        if kept and kept != (now := question_digest(query)):
            raise ConfigError(
                f"backbone.file {self.file}: case {query.case!r}, stage {query.stage}: the prompt or the answer schema "
                f"has changed since its answers were recorded (digest {now}, kept {kept}): read them against the "
                "new prompt, mend what it asks otherwise, then `python -m research.benchmarks.scenes.recorded --keep`"
            )

    def answer(self, context: Context, query: Query) -> str:
        """The text of `generate`, whatever the question says."""
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


def _files(source: Path | None) -> list[Path]:
    """The files of answers: the one named, or those of a folder in their order."""
    if source is None:
        return []
    return sorted(f for f in source.glob("*.yaml") if f.name != ASKED) if source.is_dir() else [source]


def _read_digests(file: Path) -> dict[str, dict[str, str]]:
    try:
        found = yaml.safe_load(file.read_text(encoding="utf-8"))
        return {str(case): dict(stages) for case, stages in dict(found or {}).items()}
    except (OSError, TypeError, ValueError, *YAML_FAULTS) as fault:
        raise ConfigError(
            f"{file}: no mapping of case, stage and digest ({fault}): write it anew with --keep"
        ) from fault


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


def _entries(value: Any, number: int, file: Path | None) -> list[Answer]:
    """The entries that one value of a script stands for."""
    try:
        if isinstance(value, dict) and "case" in value and not {"answer", "stage"} & set(value):
            return list(Dialogue(**value).entries())
        return [Answer(**value) if isinstance(value, dict) and "answer" in value else Answer(answer=value)]
    except ValidationError as fault:
        raise ConfigError(f"backbone{f'.file {file}' if file else ''}: answer {number}: {fault}") from fault
