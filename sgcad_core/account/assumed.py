"""Assumptions of a scenario, one per field: defaults, and facts that only follow from stated ones.

Knows facts. A model's answer counts as an assumption only where the evidence does not contain it.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from sgcad_core.account.inputs import ExecutedCase
from sgcad_core.account.records import Item
from sgcad_core.account.words import phrase
from sgcad_core.records.facts import Fact

_NO_PART = re.compile(r"\.role$|\.lanes_backward$|^others\.[A-Z]\d+\.(start_(lane|road)|exit_road)$")
"""Labels that move nothing, and halves of what is listed once."""
_FOLLOWS = re.compile(
    r"contacts\.\d+\.(striker|struck|striker_area|struck_area)$|vehicles\.V\d+\.(heading|maneuver|start_road)$"
    r"|junction\.(kind|stem|stopped)$"
)
"""Fields that count as assumed where their value is inferred from stated facts."""


def assumed_items(made: ExecutedCase, facts: Iterable[Fact]) -> Iterator[Item]:
    """One item per field, from its last fact; a junction without a stated control is assumed to have none."""
    last = {fact.field: fact for fact in facts}
    for fact in last.values():
        if _on_map(fact.field, made):
            continue
        if fact.value is not None and not _NO_PART.search(fact.field) and (reason := _reason(fact)):
            yield _item(fact, reason, made)
    junction = made.reading.roads.junction
    place = made.network.place
    signed = place is not None and place.found and any(one.leg.control != "none" for one in place.legs)
    if junction.kind not in ("none", "parking_lot") and "junction.control" not in last and not signed:
        fact = Fact(field="junction.control", value="none", basis="default", status="default", rule="", confidence=0.2)
        yield _item(fact, "not told", made)


def _on_map(field: str, made: ExecutedCase) -> bool:
    """Whether the map of the real place tells what the report leaves open."""
    place = made.network.place
    if place is None or not place.found or place.place is None:
        return False
    if field == "junction.kind":
        return len(place.place.legs) > 2
    of, _, name = field.removeprefix("roads.").partition(".")
    leg = next((one.leg for one in place.legs if one.road == of), None)
    return leg is not None and (leg.limit_mph is not None if name == "speed_limit_mph" else leg.lanes_known)


def _reason(fact: Fact) -> str:
    """The reason why a fact counts as assumed; "" where it does not."""
    if fact.status == "default":
        return "not told"
    if fact.basis == "text" and fact.status == "inferred" and _FOLLOWS.match(fact.field):
        return f"follows from what is told ({fact.rule.replace('_', ' ')})"
    if fact.basis == "model" and fact.status == "inferred":
        return "answered by the model, and the evidence does not tell it"
    return ""


def _item(fact: Fact, reason: str, made: ExecutedCase) -> Item:
    parts = fact.field.split(".")
    subject = parts[1] if parts[0] in ("vehicles", "others") else ".".join(parts[:-1])
    return Item(
        kind="assumed", field=fact.field, subject=subject, value=fact.value, text=phrase(fact.field, fact.value),
        reason=reason, start=fact.start, end=fact.end,
    )  # fmt: skip
