"""Who began a crash, and which sentence says so."""

import pytest

from sgcad_core.reading.reading import read

PLAIN = "Vehicle 1 was traveling north. Vehicle 2 was traveling east. The front of V1 struck the left side of V2. "


def roles(text):
    return {f.field.split(".")[1]: f for f in read(text).facts if f.field.endswith(".role")}


def values(text):
    return {name: fact.value for name, fact in roles(text).items()}


@pytest.mark.parametrize(
    ("told", "initiator"),
    [
        ("The critical reason for the critical event was not coded to V1. ", "V2"),
        ("The critical reason for the critical event was coded to V1 as a decision error. ", "V1"),
        ("The critical precrash event for V1 was other vehicle encroachment from the crossing street. ", "V2"),
        ("The driver of V2 was cited for failure to yield. ", "V2"),
        ("V2 ran the red light. ", "V2"),
        ("V1 encroached into the lane of V2. ", "V1"),
        ("V2 encroached into the lane of V1. ", "V2"),
    ],
)
def test_codes_citations_and_broken_rules_tell_who_began(told, initiator):
    assert [k for k, v in values(PLAIN + told).items() if v == "initiator"] == [initiator]


def test_the_sentence_that_says_so_is_kept():
    code = "The critical reason for the critical event was not coded to V1."
    text = PLAIN + code
    fact = roles(text)["V1"]
    assert (fact.value, fact.status, fact.rule) == ("responder", "stated", "crash_roles.reason_none")
    assert text[fact.start : fact.end] == code


def test_codes_outweigh_maneuvers():
    turning = "Vehicle 1 was turning left. Vehicle 2 was traveling east. The front of V2 struck the left side of V1. "
    assert values(turning)["V1"] == "initiator"
    assert values(turning + "The critical reason was coded to V2 as too fast for conditions.")["V1"] == "responder"


def test_who_runs_into_the_rear_began():
    text = "Vehicle 1 was stopped north. Vehicle 2 was traveling north. The front of V2 struck the rear of V1."
    assert values(text) == {"V1": "responder", "V2": "initiator"}


def test_who_backs_into_one_that_stands_began():
    text = "Vehicle 1 was stopped, facing west. V2, ahead of it, backed up and the back of V2 struck the front of V1."
    assert values(text) == {"V1": "responder", "V2": "initiator"}
    assert read(text).crash.contacts[0].striker == "V2"


def test_a_critical_event_of_a_stopped_vehicle_ahead_is_its_owners_doing():
    text = (
        "Vehicle 1 was northbound. Vehicle 2 was northbound. The front of V1 struck the rear of V2. "
        "The critical precrash event for V1 was other motor vehicle in lane, other vehicle stopped. "
    )
    assert values(text)["V1"] == "initiator"


def test_who_takes_no_part_in_the_first_contact_is_a_bystander():
    text = PLAIN + "Vehicle 3 was stopped west. V2 then struck the front of V3 with its front."
    assert values(text)["V3"] == "bystander"
    assert roles(text)["V3"].status == "default"


def test_where_nothing_tells_them_apart_the_striker_began_and_that_is_a_default():
    fact = roles(PLAIN)["V1"]
    assert (fact.value, fact.status) == ("initiator", "default")


STANDS = "Vehicle 1 was stopped at the red light, facing north. "
DRIVES_ON = "Vehicle 1 was traveling north and had a green light. "
HIT = "The front of Vehicle 1 struck the pedestrian. "


@pytest.mark.parametrize(
    ("text", "initiator"),
    [
        (DRIVES_ON + "A pedestrian was crossing the road from east to west against the signal. " + HIT, "P1"),
        (STANDS + "A pedestrian crossing against the signal walked into the front of Vehicle 1.", "P1"),
        (DRIVES_ON + "A pedestrian darted out from between parked cars. " + HIT, "P1"),
        (DRIVES_ON + "A pedestrian was walking outside the crosswalk. " + HIT, "P1"),
        ("Vehicle 1 was traveling north. A deer ran onto the road. The front of Vehicle 1 struck the deer.", "A1"),
        (DRIVES_ON + "A pedestrian was walking in the crosswalk. " + HIT, "V1"),
        ("Vehicle 1 was turning left. A pedestrian crossed with the signal. " + HIT, "V1"),
        ("Vehicle 1 ran the red light. A pedestrian was crossing in the crosswalk. " + HIT, "V1"),
    ],
)
def test_people_and_animals_begin_a_crash_where_they_step_out_against_a_vehicle(text, initiator):
    assert [k for k, v in values(text).items() if v == "initiator"] == [initiator]
