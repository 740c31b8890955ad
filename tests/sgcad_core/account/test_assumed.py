"""Values that were read and are right too seldom: how they are told, and where they are not asked for."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import pytest

from sgcad_core.account.assumed import is_unsure, unsure_items
from sgcad_core.account.records import Item
from sgcad_core.reading.reading import read
from sgcad_core.reading.reading_with_edits import with_edits
from sgcad_core.records.edits import Edit
from sgcad_core.records.second_reader import Unsure

TEXT = (
    "V1 was traveling east on a four lane road in lane one. V2 was traveling east on the same road in lane two. "
    "The front of V2 struck the left side of V1."
)


def found(*questions: str, pictured: bool = False, text: str = TEXT, edits: tuple[Edit, ...] = ()) -> list[Item]:
    """The items of a report whose answers to these questions are right in 58 of 100."""
    reading = with_edits(replace(read(text), unsure=tuple(Unsure(question=q, p=0.58) for q in questions)), edits)
    told = {fact.field: fact for fact in reading.facts}
    network = SimpleNamespace(place=None)
    return list(unsure_items(SimpleNamespace(reading=reading, told=told, pictured=pictured, network=network)))


@pytest.mark.parametrize(("question", "field", "text"), [
    ("lanes.V1", "roads.main.lanes_total", "the road of V1 has 4 lanes, 2 of them in its direction"),
    ("maneuver.V1", "vehicles.V1.maneuver", "V1 maneuver straight"),
    ("area.V2", "contacts.0.striker_area", "contact 1 striking side front"),
    ("area.V1", "contacts.0.struck_area", "contact 1 struck side left"),
    ("junction", "junction.kind", "junction kind road without a junction"),
    ("turned.V2", "vehicles.V2.heading", "V2 heads E"),
])  # fmt: skip
def test_each_question_is_told_as_the_fact_that_it_asks_for(question, field, text) -> None:
    (item,) = found(question)
    assert (item.kind, item.field, item.text) == ("guessed", field, text)
    assert item.reason == "right in 58 of 100 coded reports with such words"
    assert is_unsure(item)


def test_two_vehicles_of_one_road_ask_once_for_its_lanes() -> None:
    assert len(found("lanes.V1", "lanes.V2")) == 1


@pytest.mark.parametrize(("question", "asked"), [("lanes.V1", 0), ("junction", 0), ("maneuver.V1", 1)])
def test_a_drawing_shows_legs_and_lanes(question, asked) -> None:
    assert len(found(question, pictured=True)) == asked


@pytest.mark.parametrize(("edit", "left"), [
    (Edit(field="V1.maneuver", value="turn_left"), ["roads.main.lanes_total"]),
    (Edit(field="roads.E.lanes_forward", value=2), ["vehicles.V1.maneuver"]),
])  # fmt: skip
def test_what_a_person_gives_is_no_guess(edit, left) -> None:
    assert [one.field for one in found("lanes.V1", "maneuver.V1", edits=(edit,))] == left


def test_a_heading_that_is_told_nowhere_is_a_guess_and_was_not_read() -> None:
    item = Item(
        kind="guessed", field="vehicles.V2.heading", subject="V2", value="E", text="V2 heads E", reason="told nowhere"
    )
    assert not is_unsure(item)
