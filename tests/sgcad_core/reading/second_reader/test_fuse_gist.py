"""A second opinion: who is believed, what changes in the reading, and that each change is told."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.case.records import CrashReport
from sgcad_core.reading.reading import read
from sgcad_core.reading.second_reader.combiner import model_right
from sgcad_core.reading.second_reader.fuse_gist import decide, fused_with_gist
from sgcad_core.reading.second_reader.seven_question_gist import FIELDS, alike, areas, meeting, rule_values
from sgcad_core.records.second_reader import Heard, Opinion, Weights

TEXT = (
    "The Waymo AV was stopped at a red light on Main Street. An SUV traveling behind it made contact with the rear "
    "bumper of the Waymo AV with its front bumper."
)
NUMBERED = "V1 was traveling north. V2 was stopped. The front of V1 struck the back of V2."
SURE = {key: Weights() for key in FIELDS}


def opinion(weights: dict[str, Weights] | None = None, p: float = 0.99, **values: bool | str) -> Opinion:
    return Opinion(heard={k: Heard(value=v, p=p) for k, v in values.items()}, weights=weights or SURE)


def test_a_sure_model_is_believed_where_both_differ_and_an_unsure_one_is_not() -> None:
    reading = read(TEXT)
    assert reading.crash.unnumbered
    told = fused_with_gist(reading, opinion(subject="backing"))
    assert told.crash.vehicles[0].maneuver == "backing"
    assert fused_with_gist(reading, opinion(p=0.3, subject="backing")) is reading
    stubborn = {"subject": Weights(told=-9.0)}
    assert fused_with_gist(reading, opinion(stubborn, subject="backing")) is reading


def test_each_change_is_a_fact_of_the_model() -> None:
    reading = read(TEXT)
    told = fused_with_gist(reading, opinion(other_area="left", subject="turn_left"))
    added = told.facts[len(reading.facts) :]
    assert {(f.field, f.value, f.basis) for f in added} == {
        ("gist.subject", "turn_left", "model"),
        ("gist.other_area", "left", "model"),
    }
    contact = meeting(told.crash)
    assert contact is not None
    assert areas(contact) == ("back", "left")
    assert told.roads.crash is told.crash


def test_a_near_crash_and_a_contact_turn_into_each_other() -> None:
    reading = read(TEXT)
    near = fused_with_gist(reading, opinion(touched=False))
    assert near.crash.near_crash is not None
    assert near.crash.contacts
    assert fused_with_gist(near, opinion(touched=True)).crash.near_crash is None


def test_a_junction_that_the_rules_miss_is_added() -> None:
    text = TEXT.replace("at a red light ", "")
    assert read(text).roads.junction.kind == "none"
    assert fused_with_gist(read(text), opinion(junction=True)).roads.junction.kind == "four_leg"
    assert fused_with_gist(read(text), opinion(junction=False)).roads.junction.kind == "none"


def test_numbered_reports_and_missing_weights_are_the_rules() -> None:
    reading = read(NUMBERED)
    assert fused_with_gist(reading, opinion(subject="backing")) is reading
    mine = read(TEXT)
    assert fused_with_gist(mine, Opinion(heard={"subject": Heard(value="backing", p=1.0)})) is mine


def test_a_contact_that_the_rules_cannot_read_is_filled_in_by_a_sure_model_alone() -> None:
    text = "The Waymo AV was stopped in traffic when a collision with an SUV occurred. The Waymo AV was then towed."
    reading = read(text)
    whole = {
        "touched": True, "met": "suv", "subject": "stopped", "other": "straight", "subject_area": "back",
        "other_area": "front",
    }  # fmt: skip
    assert meeting(reading.crash) is None
    assert reading.crash.gap
    assert reading.crash.gap.unread
    told = fused_with_gist(reading, opinion(**whole)).crash
    assert told.gap is None
    assert (told.contacts[0].striker, told.contacts[0].struck) == ("V2", "V1")
    assert fused_with_gist(reading, opinion(p=0.55, **whole)).crash.gap


def test_what_both_say_alike_is_the_rules_value_with_the_share_of_agreement() -> None:
    say = rule_values(read(TEXT))
    found = decide(opinion({"subject": Weights(agree=0.97)}, subject="parked"), say)["subject"]
    assert (found.value, found.p, found.changed) == ("stopped", 0.97, False)
    assert alike("straight", "slowing")
    assert not alike("turn_left", "turn_right")


@given(st.floats(0, 1), st.floats(0, 1))
def test_a_surer_model_is_believed_no_less(one: float, other: float) -> None:
    low, high = sorted((one, other))
    weights = Weights(differ=-0.4, slope=0.7, told=-1.0)
    assert model_right(weights, low, told=True) <= model_right(weights, high, told=True)
    assert model_right(weights, high, told=True) <= model_right(weights, high, told=False)


def test_a_report_is_read_with_its_opinion() -> None:
    report = CrashReport(case="a", narrative=TEXT)
    assert report.reading.crash.vehicles[0].maneuver == "stopped"
    told = report.model_copy(update={"opinion": opinion(subject="backing")})
    assert told.reading.crash.vehicles[0].maneuver == "backing"
    assert report.reading.crash.vehicles[0].maneuver == "stopped"


@pytest.mark.parametrize("values", [{"met": "pedestrian"}, {"subject": "other"}])
def test_what_cannot_be_taken_over_leaves_the_reading(values: dict[str, str]) -> None:
    reading = read(TEXT)
    assert fused_with_gist(reading, opinion(**values)) is reading


def test_what_the_report_makes_likelier_is_believed_the_more_up_to_a_bound() -> None:
    weights = Weights(differ=-1.0, nats=0.5)
    even = [model_right(weights, 0.5, told=False, nats=nats) for nats in (-3.0, 0.0, 2.0, 6.0, 60.0)]
    assert even[0] == even[1] < 0.5 <= even[2] < even[3] == even[4]
    assert model_right(Weights(differ=-1.0), 0.5, told=False, nats=5.0) == even[1], "without a weight it says nothing"
