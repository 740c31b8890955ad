"""Acts beside the maneuver: what a course tells in a writer's words, and a writer's words over what was read."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from sgcad_core.reading.reading import read
from sgcad_core.reading.reading_with_acts import with_acts
from sgcad_core.records.acts import ACT_FIELDS, Acts, Rest, act_of, acts_of, course_with, courses_with, with_said
from sgcad_core.records.answer_schema import trained_schema
from sgcad_core.records.course import CourseTold, Move, RestTold
from sgcad_core.records.specs import Actor, BehaviorSpec

COMPASS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")
BOOL = st.booleans()


def maybe(*values):
    return st.sampled_from((None, *values))


RESTS = st.builds(
    RestTold, facing_deg=st.none() | st.floats(0, 360), attitude=maybe("wheels", "roof", "left", "right"),
    where=maybe("road", "intersection", "shoulder", "median", "off_road"), side=maybe(*COMPASS, "left", "right"),
    against=maybe("a tree"), distance_m=st.none() | st.floats(0, 500), lane=maybe(1, 3, -1, "own", "left_turn"),
    lane_way=maybe("N", "E"),
)  # fmt: skip
COURSES = st.builds(
    CourseTold, from_rest=BOOL, brakes=BOOL, steers=maybe("left", "right", "either"), no_evasion=BOOL,
    lost_control=BOOL, departs=maybe(*COMPASS, "left", "right", "either"),
    spin=maybe("clockwise", "counterclockwise"), spin_deg=st.none() | st.floats(1, 1440), rolls=BOOL,
    roll_quarters=st.none() | st.integers(1, 24), rolls_to=maybe("left", "right"), rest=RESTS,
)  # fmt: skip


@given(COURSES)
def test_the_acts_of_a_course_change_nothing_in_it(course):
    known = replace(course, no_evasion=course.no_evasion and not (course.brakes or course.steers))
    assert course_with(known, acts_of(known)) == known


@given(COURSES, COURSES)
def test_what_is_said_stands_and_what_is_open_is_as_read(read_of, said_of):
    said = acts_of(said_of) or Acts()
    made = course_with(read_of, said)
    again = acts_of(made) or Acts()
    for name in ACT_FIELDS:
        told = act_of(said, name)
        if told is not None:
            assert act_of(again, name) == told
        elif name not in ("rest.side", "evasion"):
            assert act_of(again, name) == act_of(acts_of(read_of), name)


def test_a_side_is_of_the_place_that_was_told_with_it():
    read_of = CourseTold(rest=RestTold(where="shoulder", side="N"))
    assert course_with(read_of, Acts(rest=Rest(where="median"))).rest == RestTold(where="median")
    assert course_with(read_of, Acts(rest=Rest(where="shoulder"))).rest.side == "N"


def test_another_side_of_departure_takes_the_moves_that_were_read():
    read_of = CourseTold(departs="left", moves=(Move("departs", "left"), Move("returns")))
    assert course_with(read_of, Acts(departs="right")).moves == ()
    assert course_with(read_of, Acts(departs="left")).moves == read_of.moves


@pytest.mark.parametrize(
    ("evasion", "brakes", "steers", "none"),
    [("none", False, None, True), ("braking", True, None, False), ("steering", False, "either", False),
     ("braking_and_steering_left", True, "left", False), ("accelerating", False, None, False)],
)  # fmt: skip
def test_an_evasive_maneuver_in_the_words_of_a_course(evasion, brakes, steers, none):
    made = course_with(CourseTold(brakes=True, no_evasion=True), Acts(evasion=evasion))
    assert (made.brakes, made.steers, made.no_evasion) == (brakes, steers, none)


def test_vehicles_of_which_nothing_is_said_keep_their_course():
    courses = {"V1": CourseTold(brakes=True)}
    assert courses_with(courses, {"V1": None, "V2": Acts(rolls=True)}) == {**courses, "V2": CourseTold(rolls=True)}


def test_values_are_laid_by_their_names():
    acts = with_said(Acts(rest=Rest(where="road")), {"rest.facing_deg": 90, "spin": "clockwise", "rest.where": None})
    assert acts == Acts(spin="clockwise", rest=Rest(facing_deg=90))
    assert with_said(acts, {}) is acts
    with pytest.raises(ValidationError):
        with_said(None, {"rest.facing_deg": 400})


def test_a_reading_goes_by_what_its_writer_says():
    reading = read("V1 was traveling north. V2 was traveling east. The front of V1 struck the left side of V2.")
    actors = (
        Actor(
            id="V1", kind="car", road="S", direction="forward", maneuver="straight",
            acts=Acts(from_rest=True, signal="red", lost_control=True),
        ),
        Actor(id="V2", kind="car", road="W", direction="forward", maneuver="straight"),
    )  # fmt: skip
    made = with_acts(reading, BehaviorSpec(actors=actors))
    assert made.crash.driven["V1"].from_rest
    assert (made.signals, made.lost_control) == ({"V1": "red"}, True)
    assert with_acts(reading, None) is reading
    assert with_acts(reading, BehaviorSpec(actors=actors[1:])) is reading


def test_the_embedded_model_is_asked_as_it_learned():
    assert "from_rest" not in str(trained_schema(BehaviorSpec))
    assert "from_rest" in str(BehaviorSpec.model_json_schema())
