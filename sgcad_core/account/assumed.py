"""Assumptions of a scenario, one per field: defaults, facts that only follow from stated ones, and unsure values.

Knows facts. A model's answer counts as an assumption only where the evidence does not contain it. Unsure are values
whose words often mean something else, as the learned reader of numbered reports has it
(`sgcad_core.reading.second_reader.numbered.unsure_answers`): guesses, though they were read. A drawing shows legs and
lanes, and a person knows better: there it is not asked.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator

from sgcad_core.account.inputs import ExecutedCase
from sgcad_core.account.records import Item
from sgcad_core.account.words import phrase
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.provenance.road_provenance import road_of_bearing
from sgcad_core.reading.second_reader.numbered.numbered_answers import side_of
from sgcad_core.reading.text.compass import turned
from sgcad_core.records.edits import canonical, effective
from sgcad_core.records.facts import Fact, Value

_NO_PART = re.compile(r"\.role$|\.lanes_backward$|^others\.[A-Z]\d+\.(start_(lane|road)|exit_road)$")
"""Labels that move nothing, and halves of what is listed once."""
_FOLLOWS = re.compile(
    r"contacts\.\d+\.(striker|struck|striker_area|struck_area)$|vehicles\.V\d+\.(heading|maneuver|start_road)$"
    r"|junction\.(kind|stem|stopped)$"
)
"""Fields that count as assumed where their value is inferred from stated facts."""

_WORDS = "of 100 coded reports with such words"
_DRAWN = ("lanes", "junction")
"""Questions that a drawing answers."""


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


# ------------------------------------------------------------------ words that mean two things
def unsure_items(made: ExecutedCase) -> Iterator[Item]:
    """An item for each answer of the reading that is right too seldom, once a field."""
    given = {canonical(edit.field) for edit in effective(made.reading.edits)}
    found = dict[str, Item]()
    for one in made.reading.unsure:
        kind, _, of = one.question.partition(".")
        if kind in _DRAWN and (made.pictured or made.network.place):
            continue
        field, value, text = _asked(made, kind, of)
        if field not in given and not (kind == "lanes" and any(_counts_lanes(name) for name in given)):
            found.setdefault(field, _guess(made, field, value, text, one.p))
    yield from found.values()


def is_unsure(item: Item) -> bool:
    """Whether an item is a value that was read, and is right too seldom."""
    return item.kind == "guessed" and item.reason.endswith(_WORDS)


def _counts_lanes(field: str) -> bool:
    return field.startswith("roads.") and ".lane" in field


def _guess(made: ExecutedCase, field: str, value: Value, text: str, p: float) -> Item:
    fact = made.told.get(field)
    return Item(
        kind="guessed", field=field, subject=".".join(field.split(".")[:2]) if field[0] != "v" else field.split(".")[1],
        value=value, text=text or phrase(field, value), reason=f"right in {100 * p:.0f} {_WORDS}",
        start=fact.start if fact else None, end=fact.end if fact else None,
    )  # fmt: skip


def _asked(made: ExecutedCase, kind: str, of: str) -> tuple[str, Value, str]:
    """The field that a question asks for, its value, and both in words where the field's name does not say it."""
    crash, roads = made.reading.crash, made.reading.roads
    if kind == "lanes":
        return _lanes(made, of)
    if kind == "junction":
        return "junction.kind", roads.junction.kind, ""
    if kind == "area":
        role = "striker" if crash.contacts[0].striker == of else "struck"
        return f"contacts.0.{role}_area", side_of(crash, of), ""
    name = "maneuver" if kind == "maneuver" else "heading"
    return f"vehicles.{of}.{name}", getattr(crash.vehicle(of), name), ""


def _lanes(made: ExecutedCase, of: str) -> tuple[str, Value, str]:
    v = made.reading.crash.vehicle(of)
    bearing = turned(v.heading, 180) if v is not None and v.heading else ""
    road = road_of_bearing(made.reading.roads, bearing) or "main"
    legs = layout_of_facts(made.reading.roads).legs
    leg = next(leg for leg in legs if leg.bearing == bearing)
    both = leg.lanes_in + leg.lanes_out
    return (
        f"roads.{road}.lanes_total",
        both,
        f"the road of {of} has {both} lanes, {leg.lanes_in} of them in its direction",
    )
