"""Facts of a scenario whose words often mean something else: guesses, though they were read.

The learned reader of numbered reports says how often such an answer is right
(`sgcad_core.reading.second_reader.unsure_answers`). A drawing shows legs and lanes, and a person knows better: there it
is not asked.
"""

from __future__ import annotations

from collections.abc import Iterator

from sgcad_core.account.inputs import ExecutedCase
from sgcad_core.account.records import Item
from sgcad_core.account.words import phrase
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.provenance.road_provenance import road_of_bearing
from sgcad_core.reading.text.compass import turned
from sgcad_core.records.edits import canonical, effective
from sgcad_core.records.facts import Value

_WORDS = "of 100 coded reports with such words"
_DRAWN = ("lanes", "junction")
"""Questions that a drawing answers."""


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
            found.setdefault(field, _item(made, field, value, text, one.p))
    yield from found.values()


def is_unsure(item: Item) -> bool:
    """Whether an item is a value that was read, and is right too seldom."""
    return item.kind == "guessed" and item.reason.endswith(_WORDS)


def _counts_lanes(field: str) -> bool:
    return field.startswith("roads.") and ".lane" in field


def _item(made: ExecutedCase, field: str, value: Value, text: str, p: float) -> Item:
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
        return f"contacts.0.{role}_area", getattr(crash.contacts[0], f"{role}_area"), ""
    if kind == "met":
        mine = crash.first_contact(of)
        other = None if mine is None else mine.struck if mine.striker == of else mine.striker
        return f"vehicles.{of}.touches", other, f"{of} first touches {other or 'no road user'}"
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
