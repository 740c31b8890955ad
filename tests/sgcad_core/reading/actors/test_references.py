"""Who is who in reports that number nobody, and what such a report lacks."""

from __future__ import annotations

import pytest

from sgcad_core.errors import Refused
from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.reading.text.normalise import sentences
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.layout import road_spec

NUMBERED = [
    ("The Acme AV was stopped when a white van hit it. The van left.", "V1 was stopped when a white van "
     "(V2) hit it. V2 left."),
    ("A van hit the test vehicle.", "A van (V2) hit V1."),
    ("The subject vehicle stopped. Another car struck the subject vehicle.", "V1 stopped. a car (V2) struck V1."),
    ("A sedan passed. A second sedan struck the first sedan.", "A sedan (V1) passed. A second sedan (V2) struck V1."),
    ("The Acme AV was stopped. A van hit the stationary Acme AV's rear bumper.",
     "V1 was stopped. A van (V2) hit V1's rear bumper."),
    ("The Acme AV was stopped. A Honda CR-V hit it. The Honda's bumper was dented.",
     "V1 was stopped. A Honda CR-V (V2) hit it. V2's bumper was dented."),
    ("An Acme vehicle was stopped in traffic. It was following the car ahead when vehicle 2 struck it.",
     "An Acme vehicle (V1) was stopped in traffic. It was following the car (V3) ahead when V2 struck it."),
    ("A car hit another car.", "A car (V1) hit a car (V2)."),
]  # fmt: skip


@pytest.mark.parametrize(("text", "told"), NUMBERED)
def test_phrases_become_numbers(text: str, told: str) -> None:
    assert " ".join(s.text for s in sentences(text)) == told


def test_a_text_with_numbers_keeps_its_phrases() -> None:
    text = "V1 was stopped when a white van hit it."
    assert sentences(text)[0].text == text


def test_who_was_announced_is_not_counted_twice() -> None:
    facts = read(
        "On May 3 an Acme Autonomous Vehicle (Acme AV) was in a collision involving a pickup truck on Oak. "
        "The Acme AV was "
        "parked facing north. A pickup truck traveling north made contact with the rear of the parked Acme AV."
    ).crash
    assert [(v.id, v.kind) for v in facts.vehicles] == [("V1", "car"), ("V2", "pickup")]
    assert facts.contacts[0].striker == "V2"


def test_who_touches_nobody_is_no_actor() -> None:
    facts = read(
        "The Acme AV was stopped behind a bus. A van approached from behind and its front made contact with "
        "the rear of the "
        "Acme AV."
    ).crash
    assert [(v.id, v.kind, v.maneuver) for v in facts.vehicles] == [("V1", "car", "stopped"), ("V2", "van", "straight")]


@pytest.mark.parametrize(
    ("text", "other"),
    [
        ("A cyclist rode out and struck the right side of the Acme AV.", "B1"),
        ("The front of the Acme AV struck a pedestrian who was crossing.", "P1"),
        ("A dog ran into the road and was struck by the front of the Acme AV.", "A1"),
        ("A scooterist hit the left side of the Acme AV.", "B1"),
    ],
)
def test_people_cyclists_and_animals_have_their_own_ids(text: str, other: str) -> None:
    reading = read(text)
    contact = reading.crash.contacts[0]
    assert {contact.striker, contact.struck} == {"V1", other}
    assert any(fact.field.startswith(f"vehicles.{other}.") for fact in reading.facts)


MANEUVERS = [
    ("The Acme AV was stopped for a red light. The light turned green and the Acme AV proceeded forward. A "
     "van struck the "
     "rear of the Acme AV.", ("straight", "straight")),
    ("The Acme AV was traveling north and slowed to a stop. A van initially stopped behind the Acme AV "
     "proceeded forward "
     "and struck the rear of the stationary Acme AV.", ("stopped", "straight")),
    ("The Acme AV was parked at the curb. A van in front of the Acme AV began to reverse, and the rear of the van made "
     "contact with the front of the parked Acme AV.", ("parked", "backing")),
    ("The Acme AV reversed to make room, then came to a stop. A van that was parked pulled out and the left "
     "side of the van "
     "made contact with the front of the Acme AV.", ("stopped", "straight")),
    ("The Acme AV was waiting for an opportunity to pass a bus. A van drove around the left of the Acme AV "
     "and its right "
     "side made contact with the rear left corner of the stopped Acme AV.", ("stopped", "overtaking")),
    ("The Acme AV was stopped. A van behind it maneuvered to the left as it approached, and its right front corner "
     "made contact with the left rear corner of the Acme AV.", ("stopped", "lane_change_left")),
    ("A van crossed over into the lane of the Acme AV. The Acme AV veered right, and the front of the van made contact "
     "with the left side of the Acme AV.", ("straight", "straight")),
    ("The Acme AV braked to a stop soon after passing the crosswalk. A van made contact with its rear.",
     ("stopped", "straight")),
    ("The Acme AV was going north in the right lane, traffic to its left was stopped. The front of a van made contact "
     "with the rear of the Acme AV.", ("straight", "straight")),
    ("The Acme AV was en route to a rider when it stopped for a dog. A van backed out and made contact with its left "
     "side.", ("stopped", "backing")),
    ("The Acme AV slowed and moved into the left lane. The front of a van made contact with its rear.",
     ("lane_change_left", "straight")),
    ("A van was heading north. A cyclist made contact with the left side of the stopped Acme AV, backed up a little, "
     "and rode on.", ("stopped", "straight")),
]  # fmt: skip


@pytest.mark.parametrize(("text", "maneuvers"), MANEUVERS)
def test_what_is_told_last_before_the_contact_is_what_a_vehicle_did(text: str, maneuvers: tuple[str, str]) -> None:
    assert tuple(v.maneuver for v in read(text).crash.vehicles) == maneuvers


REFUSED = [
    ("My seat belt buzzer never stops and the dealer will not repair it.", "tells no crash"),
    ("El coche circulaba por la avenida y fue golpeado por otro vehículo que venía en sentido contrario.",
     "not in English"),
    ("Case 1: V1 hit V2 in the rear.\nCase 2: V1 struck a tree.", "holds 2 reports"),
    ("[REDACTED, MAY CONTAIN CONFIDENTIAL BUSINESS INFORMATION]", "blacked out"),
    ("Acme is filing this report under Standing General Order 7. Acme may amend it.", "no account of the crash"),
    ("The Acme AV was in an incident while a van was near. Both left.", "cannot be read"),
    ("The car was driving north and stopped for a light.", "tells no crash"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "reason"), REFUSED)
def test_what_cannot_be_read_is_refused_by_name(text: str, reason: str) -> None:
    spec = road_spec(
        RoadLayout(legs=(Leg(bearing="N", lanes_in=1, lanes_out=1), Leg(bearing="S", lanes_in=1, lanes_out=1)))
    )
    with pytest.raises(Refused, match=reason) as refused:
        behavior_of_facts(read(text).crash, spec)
    assert refused.value.missing


def test_a_first_mention_that_touches_nobody_is_no_subject() -> None:
    facts = read("A car passed by. A van struck the rear of a stopped bus.").crash
    assert [(v.id, v.kind) for v in facts.vehicles] == [("V1", "van"), ("V2", "bus")]


def test_a_crash_of_others_beside_the_subject_is_refused() -> None:
    gap = read("The test vehicle was parked. A van struck the rear of a stopped bus.").crash.gap
    assert gap is not None
    assert "subject" in gap.reason


def test_the_contact_of_the_subject_comes_before_those_of_others() -> None:
    facts = read(
        "The Acme AV was at a red light. A van stopped behind the Acme AV. A bus struck the rear of the van, and "
        "the front of the van then made contact with the rear of the stopped Acme AV."
    ).crash
    assert [(c.striker, c.struck) for c in facts.contacts] == [("V2", "V1"), ("V3", "V2")]
    assert [v.maneuver for v in facts.vehicles][:2] == ["stopped", "stopped"]


def test_an_opened_door_is_a_side_of_its_vehicle() -> None:
    contact = read(
        "The Acme AV was parked. A van passed as a rider in the Acme AV opened the rear left door and the door made "
        "contact with the right side of the van."
    ).crash.contacts[0]
    areas = {contact.striker: contact.striker_area, contact.struck: contact.struck_area}
    assert areas == {"V1": "left", "V2": "right"}


def test_a_thing_without_a_name_of_its_own_is_hit() -> None:
    facts = read("The Acme AV was northbound when its front made contact with a hanging chain.").crash
    assert [(c.striker, c.struck) for c in facts.contacts] == [("V1", "O1")]
    assert facts.others[0].word == "chain"


def test_a_car_that_hit_another_car_is_not_alone() -> None:
    facts = read("A car hit another car. Nobody was hurt.").crash
    assert [v.id for v in facts.vehicles] == ["V1", "V2"]
    assert [(c.striker, c.struck, c.stated) for c in facts.contacts] == [("V1", "V2", True)]


@pytest.mark.parametrize(
    ("area", "may"),
    [
        ("rear left side", ("back", "left")),
        ("front passenger side", ("front", "right")),
        ("driver side rear", ("back", "left")),
        ("rear left door", ("left",)),
    ],
)
def test_an_end_and_a_side_are_a_corner_and_a_door_is_a_side(area: str, may: tuple[str, ...]) -> None:
    found = read(f"A van struck the {area} of the stopped Acme AV.").crash.contacts[0]
    assert found.struck == "V1"
    assert sorted(found.struck_may) == sorted(may)


def test_driver_b_hit_the_truck_of_driver_a() -> None:
    contact = read("Driver B hit Driver A's truck head-on.").crash.contacts[0]
    assert (contact.striker, contact.struck) == ("V2", "V1")


def test_a_numbered_bicycle_is_one() -> None:
    facts = read("V1 was northbound. V2, a bicycle, was southbound. V2 struck the front of V1.").crash
    assert [v.kind for v in facts.vehicles] == ["car", "bicycle"]


def test_a_vehicle_of_a_company_that_is_struck_from_the_rear_is_the_one_named_before() -> None:
    crash = read(
        "The Acme vehicle was stopped at a red light on Oak Avenue. Vehicle 2 struck the Acme vehicle from the rear."
    ).crash
    first = crash.contacts[0]
    assert (first.striker, first.struck) == ("V2", "V1")
    assert [v.id for v in crash.vehicles] == ["V1", "V2"]
