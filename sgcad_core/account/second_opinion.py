"""Where two readers of a report say different things, and what an account makes of it.

A model that reads a report answers on its own account: what the rules read otherwise is a second opinion beside it, no
lack. What the model was not asked for, or left open, still lacks, and so does what a person says. A writer without a
model follows the rules, so what they ask about then lacks.
"""

from __future__ import annotations

import re
from collections.abc import Collection, Iterable, Iterator, Sequence
from typing import Literal

from sgcad_core.account.inputs import ExecutedCase
from sgcad_core.account.motion import judged
from sgcad_core.account.records import Disagreement, Item
from sgcad_core.account.words import phrase
from sgcad_core.case.records import Finding, Stage
from sgcad_core.execution.contact import realised
from sgcad_core.reading.provenance.crash_provenance import CONFIDENCE
from sgcad_core.records.acts import ACT_FIELDS, act_of
from sgcad_core.records.facts import Fact, Value

Writer = Literal["model", "rules"]
_SHOWN = (
    "maneuver", "lane", "speed_mph", "from_stop", "lost_control", "spin", "spin_deg", "rolls", "departs",
    "rest.where", "rest.facing_deg", "rest.attitude", "rest.distance_m",
)  # fmt: skip
"""Fields whose value as a model answered it is held against the execution."""
_ANSWERED: dict[Stage, re.Pattern[str]] = {
    "road": re.compile(r"(roads|junction|approaches)\..*"),
    "scenario": re.compile(
        r"vehicles\.V\d+\.(kind|heading|maneuver|lane|lane_word|speed_mph|origin|target)|conditions\..*"
        r"|contacts\.0\.(striker|struck|striker_area|struck_area)"
    ),
}
"""Fields of which a model's answer always says something, or leaves it open (`_own`)."""
_ACTS = {
    "from_stop": "from_rest", "evasion.brakes": "evasion", "evasion.steers": "evasion", "evasion.none": "evasion",
} | {name: name for name in ACT_FIELDS}  # fmt: skip
"""Facts of a vehicle's acts -> the field of the answer that says them, where it says something of acts at all."""


def disagreements_of(
    questions: Iterable[Finding], facts: Iterable[Fact], models: Collection[Stage], stage_of: Stage
) -> Iterator[Disagreement]:
    """The questions of a stage's kept attempt, settled by its writer's value; `facts`: those as written."""
    by: Writer = "model" if stage_of in models else "rules"
    kept = {fact.field: fact for fact in facts if fact.basis in ("model", "diagram")}
    for finding in questions:
        if finding.severity == "question" and (told := finding.told) is not None:
            own = kept.get(told.field)
            sure = own.confidence if own else CONFIDENCE.model if by == "model" else CONFIDENCE.inferred
            yield Disagreement(
                field=told.field, subject=_subject(told.field), kept=finding.value, kept_by=by, kept_confidence=sure,
                other=told.value, by=told.by, confidence=told.confidence, start=told.start, end=told.end,
                text=finding.what,
            )  # fmt: skip


def weighed(
    made: ExecutedCase, told: Iterable[Item], asked: Sequence[Disagreement], models: Collection[Stage]
) -> tuple[list[Item], list[Disagreement]]:
    """The items of an account, and all disagreements: those asked about, then those that only the account finds."""
    fields, items, found = {one.field for one in asked}, list[Item](), list(asked)
    for item in told:
        stage = _stage(item.field)
        if item.kind == "has" or stage not in models or _by_person(made, item.field):
            items.append(item)
        elif item.field in fields or (_answered(stage, item) and _own(made, item) is not None):
            items += _as_answered(made, item)
            found += [_against(made, item)] if item.field not in fields else []
        else:
            items.append(item)
    lacking = {item.field for item in items if item.kind == "lacks"}
    items += [_lack(one) for one in asked if one.kept_by == "rules" and one.field not in lacking]
    return items, found


def _stage(field: str) -> Stage:
    return "road" if field.startswith(("roads.", "junction.", "approaches.", "place.")) else "scenario"


def _subject(field: str) -> str:
    parts = field.split(".")
    return parts[1] if parts[0] in ("vehicles", "others") else ".".join(parts[:2]) if len(parts) > 2 else parts[0]


def _by_person(made: ExecutedCase, field: str) -> bool:
    fact = made.told.get(field)
    return fact is not None and fact.basis == "person"


def _answered(stage: Stage, item: Item) -> bool:
    """Whether the answer of a stage has a field for what the item tells."""
    return _ANSWERED[stage].fullmatch(item.field) is not None or (stage == "scenario" and _act(item) is not None)


def _act(item: Item) -> str | None:
    """The field of a vehicle's acts that says what the item tells; None where it tells no act."""
    return _ACTS.get(item.field.split(".", 2)[2]) if item.field.count(".") > 1 else None


def _own(made: ExecutedCase, item: Item) -> Value:
    """The model's own value; None where it left the field open."""
    name = item.field.rpartition(".")[2]
    behavior = made.scenario.behavior
    actor = next((a for a in behavior.actors if a.id == item.subject), None) if behavior else None
    if (act := _act(item)) is not None and item.field.startswith("vehicles."):
        value: Value = act_of(actor.acts if actor else None, act)
        return value
    if name in ("lane", "lane_word", "speed_mph"):
        return getattr(actor, name.removesuffix("_word"), None)
    if name in ("maneuver", "kind"):
        return getattr(actor, name, None)
    return item.seen if item.seen is not None else "otherwise"


def _as_answered(made: ExecutedCase, item: Item) -> Iterator[Item]:
    """What the model says of the field: shown by the execution, or lacking."""
    own, name = _own(made, item), item.field.split(".", 2)[-1]
    if item.field.startswith("contacts."):
        has = realised(made.scenario.declared, made.execution.contact)
        yield item.model_copy(update={"kind": "has", "value": own, "seen": None, "reason": ""} if has else {})
    elif name in _SHOWN and own is not None and item.subject in made.tracks:
        fact = Fact(field=item.field, value=own, basis="model", status="stated", rule="answer", confidence=0.5)
        if seen := judged(made, item.subject, name, fact):
            yield made.item(seen.has, item.field, own, seen.instead, why=seen.why)


def _against(made: ExecutedCase, item: Item) -> Disagreement:
    fact = made.told.get(item.field)
    return Disagreement(
        field=item.field, subject=item.subject, kept=_own(made, item), kept_by="model",
        kept_confidence=CONFIDENCE.model, other=item.value, by="rules",
        confidence=fact.confidence if fact else CONFIDENCE.stated, start=item.start, end=item.end, text=item.reason,
    )  # fmt: skip


def _lack(one: Disagreement) -> Item:
    """What a writer without a model did not bring about, though it follows the reader who asks."""
    return Item(
        kind="lacks", field=one.field, subject=one.subject, value=one.other, seen=one.kept,
        text=phrase(one.field, one.other), reason=one.text, start=one.start, end=one.end,
    )  # fmt: skip
