"""The rules writer: a narrative and a network become a scenario whose contact happens."""

from __future__ import annotations

import pytest

from plugins.scenario_writer.rules import Rules
from sgcad_core.case.records import Context, Generation, Query, RoadNetwork, Scenario, sizes_of
from sgcad_core.errors import InvalidOutput, Refused
from sgcad_core.execution.contact import first_contact
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.layout import road_spec


def _never(context: Context, query: Query) -> Generation:
    raise AssertionError("rules ask no model")


@pytest.fixture(scope="module")
def cross() -> RoadNetwork:
    spec = road_spec(RoadLayout(legs=tuple(Leg(bearing=b, lanes_in=1, lanes_out=1) for b in ("N", "E", "S", "W"))))
    return compile_network(plain_xml(spec), spec)


def _write(text: str, network: RoadNetwork) -> Scenario:
    return Rules().write(Context(narrative=text), (), (), _never, 1, network)


@pytest.mark.parametrize(
    ("text", "sides"),
    [
        ("V1 was northbound. V2 was westbound. The front of V1 struck the left side of V2.", {"V1": "front", "V2":
        "left"}),
        ("V1 was eastbound. V2 was westbound and turned left. V1's front struck V2's right side.",
         {"V1": "front", "V2": "right"}),
        ("V1 was southbound. V2 was stopped ahead of V1. V2 was rear-ended by V1.", {"V1": "front", "V2": "back"}),
    ],
)  # fmt: skip
def test_the_told_contact_is_the_first_one(text: str, sides: dict[str, str], cross: RoadNetwork) -> None:
    scenario = _write(text, cross)
    seen = first_contact(scenario.planned, sizes_of(scenario.actors))
    assert seen is not None
    assert {seen.actor: seen.actor_area, seen.other: seen.other_area} == sides


def test_every_numbered_vehicle_moves(cross: RoadNetwork) -> None:
    scenario = _write("V1 and V2 were northbound. V3 was southbound. V1 struck the rear of V2.", cross)
    assert [t.actor for t in scenario.planned] == ["V1", "V2", "V3"]


def test_what_is_inferred_stands_in_the_notes(cross: RoadNetwork) -> None:
    notes = _write("V1 was northbound. V2 struck the left side of V1.", cross).notes
    assert "V2's heading is not told: inferred as E" in notes
    told = _write("V1 was northbound. V2 was westbound. V1's front hit V2's left side.", cross)
    assert not any("inferred" in note for note in told.notes)


def test_a_narrative_without_vehicles_is_refused(cross: RoadNetwork) -> None:
    with pytest.raises(Refused, match="tells no crash"):
        _write("Nothing happened on the road.", cross)


def test_a_network_that_did_not_compile_is_not_guessed_at() -> None:
    with pytest.raises(InvalidOutput, match=r"no net\.xml"):
        _write("V1 was northbound.", RoadNetwork())


def test_without_a_spec_the_roads_are_read_back_from_the_network(cross: RoadNetwork) -> None:
    text = "V1 was traveling north and V2 was traveling west. V1 struck the right side of V2 with its front."
    bare = cross.model_copy(update={"spec": None, "layout": None})
    assert _write(text, bare).behavior == _write(text, cross).behavior


# ------------------------------------------------------------------ doubts
CORNER = "V1 was northbound. V2 was westbound. The front of V2 made contact with the left front of V1."
"""V2 comes from the right: only the front of that corner can be touched."""


def test_where_the_checks_doubt_a_reading_others_are_tried_and_told(cross: RoadNetwork) -> None:
    doubted = Rules(try_others=False).write(Context(narrative=CORNER), (), (), _never, 1, cross)
    scenario = _write(CORNER, cross)
    said = [note for note in scenario.notes if note.startswith("doubt")]
    assert doubted.oddity >= 0.5
    assert scenario.oddity <= doubted.oddity
    assert len(said) == 1
    assert "the front of V1 instead of the left: " in said[0]


def test_an_undoubted_reading_is_not_varied(cross: RoadNetwork) -> None:
    notes = _write("V1 was northbound. V2 was westbound. V1's front hit V2's left side.", cross).notes
    assert not any(note.startswith("doubt") for note in notes)


def test_a_told_loss_of_control_is_no_doubt(cross: RoadNetwork) -> None:
    notes = _write(CORNER + " V1 had lost control on the ice.", cross).notes
    assert not any(note.startswith("doubt") for note in notes)


def test_what_vehicles_strike_later_stands_in_the_scenario(cross: RoadNetwork) -> None:
    text = "V1 was northbound. V2 was westbound. V1's front hit V2's left side. V1 then struck a utility pole."
    scenario = _write(text, cross)
    assert [(a.id, a.type) for a in scenario.actors][2:] == [("O1", "object")]
    assert scenario.behavior is not None
    assert [(c.striker, c.struck) for c in scenario.behavior.contacts] == [("V1", "V2"), ("V1", "O1")]
