"""Who and what a report without numbers names, in words of their own."""

from __future__ import annotations

import pytest

from sgcad_core.narrative.makes import kind_of
from sgcad_core.narrative.median import divided_and_median
from sgcad_core.narrative.reading import crash_facts, read
from sgcad_core.specs import ActorKind


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
    contact = crash_facts(told).contacts[0]
    assert contact.stated
    assert {contact.striker, contact.struck} == {"V1", other}


def test_who_backs_touches_with_its_back() -> None:
    told = "The Acme AV was stopped. A van backed out of a stall and hit the left side of the Acme AV."
    facts = crash_facts(told)
    areas = {facts.contacts[0].striker: facts.contacts[0].striker_area}
    areas[facts.contacts[0].struck] = facts.contacts[0].struck_area
    assert areas == {"V1": "left", "V2": "back"}


def test_a_push_is_a_contact_of_who_is_pushed() -> None:
    facts = crash_facts("The Acme AV was stopped, and a car stood behind it. A bus ran into the car and shoved it into "
                        "the rear bumper of the Acme AV.")  # fmt: skip
    assert {facts.contacts[0].striker, facts.contacts[0].struck} == {"V1", "V2"}
