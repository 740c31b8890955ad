"""Templates of roles and events: what the parse leaves open is filled in by how the roles stand to each other."""

from __future__ import annotations

from typing import Any

import pytest

from plugins.scenario_writer.text2scenario import Representation, facts_of
from tests.transcripts_rivals import PARSED, event, role


def facts(roles: list[dict[str, Any]], *events: dict[str, Any]) -> Any:
    return facts_of(Representation.model_validate({**PARSED, "roles": roles, "events": list(events)}))


@pytest.mark.parametrize(("striker", "struck", "side"), [
    ("N", "N", "back"), ("N", "S", "front"), ("E", "N", "left"), ("W", "N", "right"), ("NE", "N", "back"),
    ("S", "E", "left"), ("N", "E", "right"),
])  # fmt: skip
def test_a_side_that_is_open_follows_from_the_headings(striker: str, struck: str, side: str) -> None:
    found = facts([role("V1", struck), role("V2", striker)], event("V2", "strikes", "V1"))
    (contact,) = found.contacts
    assert (contact.striker_area, contact.struck_area, contact.areas_stated) == ("front", side, False)


def test_a_side_that_is_told_stands() -> None:
    found = facts([role("V1", "N"), role("V2", "N")], event("V2", "strikes", "V1", "right", "left"))
    assert (found.contacts[0].striker_area, found.contacts[0].struck_area) == ("right", "left")


def test_a_maneuver_is_the_last_thing_done_before_the_first_contact() -> None:
    found = facts(
        [role("V1", "N"), role("V2", "S")], event("V1", "stopped"), event("V1", "turn_left"), event("V2", "straight"),
        event("V2", "strikes", "V1"), event("V1", "departing_road_right"),
    )  # fmt: skip
    first, second = found.vehicles
    assert (first.maneuver, first.from_stop) == ("turn_left", True)
    assert (second.maneuver, second.from_stop) == ("straight", False)


def test_without_any_heading_the_scene_is_not_oriented() -> None:
    assert facts([role("V1", None), role("V2", None)]).oriented is False
    assert facts([role("V1", "N"), role("V2", None)]).oriented is True


def test_people_and_objects_take_part_beside_the_vehicles() -> None:
    found = facts([role("V1", "N"), role("P1", None, "pedestrian")], event("V1", "strikes", "P1"))
    assert [v.id for v in found.vehicles] == ["V1"]
    assert (found.contacts[0].struck, found.contacts[0].struck_area) == ("P1", "back")
