"""Who and what a report without numbers names, in words of their own."""

from __future__ import annotations

import pytest

from sgcad_core.reading.actors.makes import kind_of
from sgcad_core.reading.reading import read
from sgcad_core.reading.roads.lanes import divided_and_median
from sgcad_core.records.specs import ActorKind


@pytest.mark.parametrize(
    ("words", "kind"),
    [
        ("a person", "pedestrian"),
        ("a young man", "pedestrian"),
        ("a pole", "object"),
        ("the old utility pole", "object"),
        ("a van", "van"),
    ],
)
def test_people_and_things_are_no_cars(words: str, kind: ActorKind) -> None:
    assert kind_of(words, None) == (kind, True)


def test_who_drives_a_vehicle_does_not_make_it_a_person() -> None:
    assert kind_of("driven by a man", None) == ("car", False)


def test_a_guardrail_between_lanes_is_a_barrier() -> None:
    assert divided_and_median("The lanes were separated by a guardrail.") == (True, "barrier")


def test_a_guardrail_that_is_struck_divides_nothing() -> None:
    assert divided_and_median("V1 left the road and struck a guardrail.") == (None, None)


def test_the_hand_of_a_lane_change_that_nobody_tells_is_inferred() -> None:
    reading = read("V1 and V2 were traveling north on a four-lane road. V1 changed lanes and struck V2.")
    fact = next(f for f in reading.facts if f.field == "vehicles.V1.maneuver")
    assert (fact.value, fact.status) == ("lane_change_left", "inferred")


PAIRS = [
    ("A Beta-operated autonomous shuttle was involved in a collision with a City of Elmwood transit bus.", "V2"),
    ("The subject vehicle was going west. A deer ran out of a field. The deer contacted the left side of the truck.",
     "A1"),
    ("The Acme AV was stuck by a van while it was stopped at a light.", "V2"),
    ("The Acme AV was stopped. A heavy truck in front of it began to reverse and the rear of the cab made contact with "
     "the front of the Acme AV.", "V2"),
    ("The Acme AV hit the left side of the flatbed of a heavy truck.", "V2"),
]  # fmt: skip


@pytest.mark.parametrize(("told", "other"), PAIRS)
def test_the_other_one_is_found_by_other_words(told: str, other: str) -> None:
    contact = read(told).crash.contacts[0]
    assert contact.stated
    assert {contact.striker, contact.struck} == {"V1", other}


def test_who_backs_touches_with_its_back() -> None:
    told = "The Acme AV was stopped. A van backed out of a stall and hit the left side of the Acme AV."
    facts = read(told).crash
    areas = {facts.contacts[0].striker: facts.contacts[0].striker_area}
    areas[facts.contacts[0].struck] = facts.contacts[0].struck_area
    assert areas == {"V1": "left", "V2": "back"}


def test_a_push_is_a_contact_of_who_is_pushed() -> None:
    facts = read("The Acme AV was stopped, and a car stood behind it. A bus ran into the car and shoved it into "
                        "the rear bumper of the Acme AV.").crash  # fmt: skip
    assert {facts.contacts[0].striker, facts.contacts[0].struck} == {"V1", "V2"}


# ------------------------------------------------------------------ how somebody moved, people and riders
@pytest.mark.parametrize(
    ("text", "headings", "contact"),
    [
        ("A car turning right hit a cyclist in the bike lane on its right.", "NN", "V1 front B1 left"),
        ("A car was stopped when a pedestrian walked into the right side of it.", "NW", "P1 front V1 right"),
        ("The AV was on the interstate when a truck changed lanes into its left side.", "NN", "V2 right V1 left"),
        ("A pedestrian stepped out from behind a parked van and was hit by the front of a northbound taxi.", "WN",
         "V1 front P1 left"),
        ("A pedestrian ran from behind a bus and was struck by a car.", "NE", "V1 front P1 left"),
        ("A pedestrian crossing Oak Street was struck by a northbound car.", "WN", "V1 front P1 left"),
        ("A pedestrian walking east was struck by an eastbound pickup.", "EE", "V1 front P1 back"),
        ("A truck sideswiped a van in the right lane.", "NN", "V1 right V2 left"),
    ],
)  # fmt: skip
def test_who_moves_into_somebody_touches_them_on_the_told_side(text: str, headings: str, contact: str) -> None:
    facts = read(text).crash
    (first,) = facts.contacts
    assert "".join(v.heading or "-" for v in facts.vehicles) == headings
    assert f"{first.striker} {first.striker_area} {first.struck} {first.struck_area}" == contact
