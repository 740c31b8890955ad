"""Evasion, spin, rest and later impacts as texts tell them. All texts are made up."""

from __future__ import annotations

import pytest

from sgcad_core.reading.reading import read
from sgcad_core.records.course import AT_IMPACT_M, CourseTold, ImpactTold, RestTold

INTRO = (
    "Vehicle #1 was a 2001 Ford Taurus traveling north in the northbound lane. "
    "Vehicle #2 was a 1999 Honda Civic traveling east in the eastbound lane. "
)
HIT = "The front of Vehicle #1 struck the left side of Vehicle #2. "


def course(text: str, vehicle: str = "V1") -> CourseTold:
    return read(INTRO + text).crash.courses.get(vehicle, CourseTold())


def impacts(text: str) -> list[tuple[str, str]]:
    return [(i.actor, i.other) for i in read(INTRO + text).crash.impacts]


# ------------------------------------------------------------------ before the contact
@pytest.mark.parametrize(
    "words",
    ["braked but could not stop", "applied the brakes in an attempt to avoid a collision", "slammed on his brakes"],
)
def test_braking_is_read_of_whoever_braked(words: str) -> None:
    text = f"The driver of Vehicle #1 {words}. {HIT}"
    assert course(text).brakes
    assert not course(text, "V2").brakes


def test_braking_told_behind_the_impact_as_an_answer_to_what_was_seen_is_read() -> None:
    assert course(
        f"{HIT}The driver of Vehicle #1 was at work. As soon as he realized the danger he hit the brakes."
    ).brakes


def test_a_turn_that_ends_in_a_stop_in_the_lanes_of_others_is_read() -> None:
    text = f"Vehicle #2 turned left and stopped in the northbound lanes. {HIT}"
    assert course(text, "V2").stops
    assert not course(f"Vehicle #2 stopped in the left turn lane, then turned left. {HIT}", "V2").stops


@pytest.mark.parametrize("words", ["at the time of impact", "when it struck Vehicle #2"])
def test_a_speed_at_the_impact_is_told_apart(words: str) -> None:
    assert course(f"{HIT}Vehicle #1 was traveling at 30 mph {words}.").speed_at_impact
    assert not course(f"{HIT}Vehicle #1 was traveling at 30 mph.").speed_at_impact


def test_an_offset_frontal_crash_is_one_of_both() -> None:
    text = "The front of Vehicle #1 struck the front of Vehicle #2 in an offset-frontal manner."
    assert course(text).offset
    assert course(text, "V2").offset


@pytest.mark.parametrize("words", ["did not brake", "never saw the brake lights ahead", "had replaced his brakes"])
def test_brakes_alone_are_no_braking(words: str) -> None:
    assert not course(f"The driver of Vehicle #1 {words}. {HIT}").brakes


@pytest.mark.parametrize(
    ("words", "hand"),
    [("swerved to the right", "right"), ("steered left", "left"), ("swerved", "either"),
     ("attempted to avoid it by steering hard left", "left")],
)  # fmt: skip
def test_steering_has_a_hand(words: str, hand: str) -> None:
    assert course(f"The driver of Vehicle #1 {words}. {HIT}").steers == hand


def test_what_an_onlooker_did_is_his_own_deed() -> None:
    text = f"The driver of Vehicle #2 noticed Vehicle #1 turning into her path and steered to the right. {HIT}"
    assert course(text, "V2").steers == "right"
    assert course(text, "V1").steers is None


def test_a_told_inaction_is_read() -> None:
    assert course(f"{HIT} The driver of Vehicle #1 did not take any avoidance actions.").no_evasion


def test_steering_behind_the_contact_is_no_evasion() -> None:
    text = f"{HIT} Vehicle #1 swerved right and then left. Both vehicles came to final rest facing east."
    assert course(text).steers is None


# ------------------------------------------------------------------ behind it
@pytest.mark.parametrize(
    ("words", "rest"),
    [
        ("came to rest facing west", RestTold(270.0)),
        ("came to final rest facing north-northeast", RestTold(22.5)),
        ("came to rest in the intersection facing south", RestTold(180.0, "intersection")),
        ("came to rest in the westbound lane", RestTold(None, "road", lane_way="W")),
        ("came to rest in lane two of eastbound travel", RestTold(None, "road", lane=2, lane_way="E")),
        ("came to rest facing south in its original lane", RestTold(180.0, "road", lane="own")),
        ("came to rest in the road straddling lane one and lane two", RestTold(None, "road")),
        ("came to rest off the north side of the road", RestTold(None, "off_road", "N")),
        ("came to rest on the northbound shoulder", RestTold(None, "shoulder", "E")),
        ("departed the right side of the road and came to rest in a field", RestTold(None, "off_road", "right")),
        ("came to rest on the northwest corner of the intersection", RestTold(None, "off_road", "NW")),
        ("came to rest against a large tree", RestTold(against="tree")),
        ("rolled over and came to rest on its roof", RestTold(attitude="roof")),
        ("rolled onto its left side and came to rest", RestTold(attitude="left")),
        ("came to rest in the northbound shoulder", RestTold(None, "shoulder", "E")),
    ],
)
def test_a_rest_is_read_in_its_parts(words: str, rest: RestTold) -> None:
    assert course(f"{HIT} Vehicle #1 {words}.").rest == rest


def test_a_rest_of_both_is_each_ones_rest() -> None:
    text = f"{HIT} Both vehicles came to rest in the roadway facing north."
    assert course(text).rest == course(text, "V2").rest == RestTold(0.0, "road")


def test_where_the_contact_was_is_no_rest() -> None:
    text = "The front of Vehicle #1 struck the left side of Vehicle #2 in the intersection. Vehicle #1 was towed."
    assert course(text).rest == RestTold()


@pytest.mark.parametrize(
    ("words", "spin", "degrees"),
    [("Vehicle #2 rotated counterclockwise approximately 150 degrees.", "counterclockwise", 150.0),
     ("The impact caused Vehicle #2 to rotate in a clockwise manner.", "clockwise", None)],
)  # fmt: skip
def test_a_spin_is_the_struck_ones(words: str, spin: str, degrees: float | None) -> None:
    told = course(HIT + words, "V2")
    assert (told.spin, told.spin_deg) == (spin, degrees)


# ------------------------------------------------------------------ later impacts
@pytest.mark.parametrize("what", ["curb", "ditch", "raised island"])
def test_what_is_driven_over_behind_the_first_contact_is_struck(what: str) -> None:
    text = f"{HIT} Vehicle #2 then struck a {what} with its right front tire."
    assert impacts(text) == [("V2", what.split()[-1])]


def test_a_front_wheel_that_strikes_something_is_no_flank() -> None:
    text = f"{HIT} Vehicle #2 then struck a curb with its left front wheel."
    assert [i.actor_area for i in read(INTRO + text).crash.impacts] == ["front"]


def test_the_ground_is_no_thing_that_is_struck() -> None:
    assert impacts(f"{HIT} Vehicle #2 then struck the ground.") == []


def test_things_are_hit_in_the_order_of_the_text() -> None:
    text = f"{HIT} Vehicle #1 then struck a utility pole. Vehicle #2 continued and hit a curb and a wooden fence."
    assert impacts(text) == [("V1", "pole"), ("V2", "curb"), ("V2", "fence")]


def test_what_was_hit_before_the_vehicles_met_is_marked() -> None:
    text = f"Vehicle #1 crossed the center line and struck a stone wall. {HIT}"
    assert read(INTRO + text).crash.impacts == (ImpactTold("V1", "wall", after=0),)


def test_a_side_slap_is_a_second_contact_of_the_same_two() -> None:
    assert impacts(f"{HIT} The two vehicles then side-slapped.") == [("V1", "V2")]


def test_a_retelling_in_an_interview_is_no_second_contact() -> None:
    text = f"{HIT} The driver of Vehicle #2 stated that Vehicle #1 struck the right side of his car."
    assert impacts(text) == []


# ------------------------------------------------------------------ facts
def test_every_fact_of_a_course_has_its_sentence() -> None:
    text = f"{INTRO}The driver of Vehicle #1 braked. {HIT}Vehicle #1 came to rest facing west."
    facts = {f.field: f for f in read(text).facts}
    braked, facing = facts["vehicles.V1.evasion.brakes"], facts["vehicles.V1.rest.facing_deg"]
    assert text[braked.start : braked.end] == "The driver of Vehicle #1 braked."
    assert (facing.value, facing.basis) == (270.0, "text")
    assert text[facing.start : facing.end] == "Vehicle #1 came to rest facing west."


@pytest.mark.parametrize("told", ["after striking Vehicle #2 rotated", "after colliding with Vehicle #2, then rotated"])
def test_what_follows_a_contact_told_again_is_the_strikers_deed(told: str) -> None:
    assert impacts(f"{HIT} Vehicle #1 {told} clockwise and then contacted a utility pole.") == [("V1", "pole")]


# ------------------------------------------------------------------ how far
@pytest.mark.parametrize(
    ("words", "meters"),
    [
        ("came to rest approximately 12 meters north of the point of impact", 12.0),
        ("came to final rest 40 feet from the initial impact", 12.2),
        ("traveled approximately 60 meters before coming to rest in a field", 60.0),
        ("was knocked 25 meters coming to rest on its side", 25.0),
        ("slid 20 yards and came to a stop", 18.3),
    ],
)
def test_the_distance_to_the_rest_is_read(words: str, meters: float) -> None:
    assert course(f"{HIT} Vehicle #1 {words}.").rest.distance_m == meters


@pytest.mark.parametrize(
    "words",
    ["left 20 meters of skid marks before the impact", "came to rest 900 meters from the impact",
     "traveled 20 meters, struck a pole and came to rest"],
)  # fmt: skip
def test_other_lengths_are_no_distance_to_the_rest(words: str) -> None:
    assert course(f"{HIT} Vehicle #1 {words}.").rest.distance_m is None


# ------------------------------------------------------------------ where the contact is told
def test_a_rest_in_the_sentence_of_the_contact_is_read() -> None:
    hit = (
        "The front of Vehicle #1 struck the left side of Vehicle #2 and both vehicles came to rest in the intersection."
    )
    assert {course(hit, who).rest.where for who in ("V1", "V2")} == {"intersection"}
    alone = "The front of Vehicle #1 struck a fence and Vehicle #1 came to final rest facing east."
    assert course(alone).rest.facing_deg == 90.0


@pytest.mark.parametrize(
    ("words", "rest"),
    [("with final rest facing south", RestTold(facing_deg=180.0)),
     ("and came to rest inside the intersection", RestTold(where="intersection")),
     ("and came to rest at the southern portion of the intersection", RestTold(where="intersection")),
     ("and came to rest on the driver's side", RestTold(attitude="left")),
     ("and came to rest on its passenger side", RestTold(attitude="right")),
     ("and came to rest at the point of impact", RestTold(distance_m=AT_IMPACT_M)),
     ("and came to rest just after impact", RestTold(distance_m=AT_IMPACT_M)),
     ("and came to rest off-road", RestTold(where="off_road"))],
)  # fmt: skip
def test_further_words_for_a_rest(words: str, rest: RestTold) -> None:
    assert course(f"{HIT}Vehicle #1 rotated counterclockwise {words}.").rest == rest


def test_a_told_distance_goes_before_the_place_of_the_impact() -> None:
    assert course(f"{HIT}Vehicle #1 came to rest 10 m from the point of impact.").rest.distance_m == 10.0


@pytest.mark.parametrize(("told", "lost"), [
    ("V1 rotated clockwise across the centerline and struck the front of V2 with its right side.", True),
    ("V1 struck V2, and V1 rotated clockwise and its left side contacted V3.", False),
    ("The front of V2 contacted V1, which caused V1 to rotate clockwise where its rear contacted V3.", False),
    ("The front of V1 struck the left side of V2. V1 then rotated clockwise, striking V2 with its left side.", False),
    ("The front of V1 struck the left side of V2. Following this impact V1 spun and contacted V3.", False),
    ("V1 struck V2. V1 lost control and struck V3.", True),
])  # fmt: skip
def test_one_that_turns_by_the_first_contact_did_not_lose_control(told: str, lost: bool) -> None:
    reading = read(f"V1 was northbound. V2 was southbound on the same road. V3 was behind V2. {told}")
    assert reading.crash.courses.get("V1", CourseTold()).lost_control is lost
    assert reading.lost_control is lost, "the planner is told so"


@pytest.mark.parametrize(
    ("words", "where", "side"),
    [
        ("departed the roadway to the right, where its left side scraped a fence", "off_road", "right"),
        ("came to rest on its left side in a field", "off_road", None),
        ("came to rest on its right side in the roadway", "road", None),
        ("departed the roadway to its left side and came to rest in a field", "off_road", "left"),
        ("came to rest down a slight embankment on the right side of the roadway", "off_road", "right"),
        ("came to rest in the ditch on the east side of the road", "off_road", "E"),
    ],
)  # fmt: skip
def test_the_side_of_a_rest_is_one_of_the_road_not_of_the_vehicle(words: str, where: str, side: str | None) -> None:
    rest = course(f"{HIT}Vehicle #2 {words}.", "V2").rest
    assert (rest.where, rest.side) == (where, side)


@pytest.mark.parametrize(
    ("told", "quarters"),
    [
        ("Its left wheels struck a culvert and V1 tripped and rolled left six quarter turns.", 6),
        ("Its front struck a bank. V1 fell over two quarter turns to the right.", 2),
    ],
)
def test_a_rollover_is_read_in_the_sentence_of_the_contact_and_without_a_verb_of_rolling(told, quarters) -> None:
    course = read(f"V1 was northbound and left the road on the right. {told}").crash.courses["V1"]
    assert (course.rolls, course.roll_quarters) == (True, quarters)


def test_the_vehicle_behind_words_of_time_is_the_one_told_of() -> None:
    text = "V1 was northbound, left the road and struck a pole. After impact, the vehicle came to rest facing south."
    assert read(text).crash.courses["V1"].rest.facing_deg == 180.0
