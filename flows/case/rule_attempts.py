"""What a writer without a model read, in the place of a prompt and an answer: an attempt's files are never empty.

Pure functions on records; knows no file.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from sgcad_core.case.records import Attempt, RoadNetwork, Scenario
from sgcad_core.records.facts import Fact
from sgcad_core.result import CaseRecord, facts_of

_ROAD = ("roads.", "junction.")
NO_MODEL = "No model was asked. Read by rules, each with the sentence [begin-end) that it is from:"


def with_reading(attempts: Iterable[Attempt], record: CaseRecord) -> tuple[Attempt, ...]:
    """The attempts; those that asked no model show the facts of their stage as prompt, what they wrote as answer."""
    facts = facts_of(record)
    return tuple(a if a.prompt or a.answer or a.generation else _told(a, facts, record) for a in attempts)


def _told(attempt: Attempt, facts: Iterable[Fact], record: CaseRecord) -> Attempt:
    mine = [f for f in facts if f.field.startswith(_ROAD) == (attempt.stage == "road")]
    lines = [NO_MODEL, "", *map(_line, mine)] if mine else [NO_MODEL, "", "nothing of this stage is told"]
    return attempt.model_copy(update={"prompt": "\n".join(lines) + "\n", "answer": _written(attempt, record)})


def _line(fact: Fact) -> str:
    value = ", ".join(fact.value) if isinstance(fact.value, tuple) else fact.value
    place = f" [{fact.start}-{fact.end}]" if fact.start is not None else ""
    assumed = " (assumed)" if fact.status == "default" else ""
    return f"{fact.field} = {value}{assumed}  {fact.basis}, {fact.status}: {fact.rule}{place}"


def _written(attempt: Attempt, record: CaseRecord) -> str:
    """The specs that were written, as JSON, and what was remarked; in words where nothing was written."""
    outcome = record.outcomes[attempt.stage]
    artifact = outcome.artifact if outcome.kept in (0, attempt.number) else None
    parts = list(_specs(artifact))
    return "\n".join(parts) + "\n" if parts else f"nothing was written: {outcome.reason or 'see findings.json'}\n"


def _specs(artifact: RoadNetwork | Scenario | None) -> Iterator[str]:
    if isinstance(artifact, RoadNetwork) and artifact.spec:
        yield artifact.spec.model_dump_json(indent=1, exclude_defaults=True)
    elif isinstance(artifact, RoadNetwork):
        yield f"a network that no spec describes ({artifact.source}); see road.net.xml"
    if isinstance(artifact, Scenario):
        yield artifact.behavior.model_dump_json(indent=1) if artifact.behavior else "a scenario without a behavior spec"
        yield from artifact.notes
