"""Roads and junctions are read off narratives and completed to layouts that carry every vehicle."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.reading.layout.layout_facts import Defaults, layout_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.reading.roads.road_facts import RoadFacts
from sgcad_core.reading.text.compass import turned
from sgcad_core.records.specs import RoadLayout
from sgcad_core.roads.layout import road_spec

V = "V1, a 2001 Ford Focus, "
W = "V2, a 1999 Honda Civic, "


def layout(text: str) -> RoadLayout:
    return layout_of_facts(read(text).roads)


def legs(text: str) -> dict[str, tuple[int, int]]:
    return {leg.bearing: (leg.lanes_in, leg.lanes_out) for leg in layout(text).legs}


def controls(text: str) -> dict[str, str]:
    return {leg.bearing: leg.control for leg in layout(text).legs}


# ------------------------------------------------------------------ roads
def test_a_bracket_gives_each_direction_its_lanes() -> None:
    text = V + "was traveling north in the right northbound lane of a five-lane, two-way road " \
        "(three lanes northbound, two lanes southbound). " + W + "was traveling south on the same road."  # fmt: skip
    assert legs(text) == {"S": (3, 2), "N": (2, 3)}


def test_two_roads_of_an_intersection_are_told_apart_by_axis() -> None:
    text = ("The crash occurred in the intersection of an east/west road with one lane in each direction and a "
            "north/south road with two lanes in each direction. V1 was westbound. V2 was northbound.")  # fmt: skip
    assert legs(text) == {"W": (1, 1), "E": (1, 1), "S": (2, 2), "N": (2, 2)}


def _counts(text: str) -> dict[str, int | None]:
    return {road.axis or "": road.lanes.total for road in read(text).roads.roads}


def test_one_lane_of_travel_is_the_whole_of_a_one_way_street_alone() -> None:
    met = "Two one-way streets meet here. Both streets have a single lane of travel. "
    assert _counts(met + "V1 was northbound on a one-way street. V2 went west on a one-way street.") == {"N": 1, "E": 1}
    mixed = "A one-way street meets a two-way street here. Both streets have one lane of travel. "
    counts = _counts(mixed + "V1 was northbound on the one-way street. V2 went west on the two-way street.")
    assert (counts["N"], counts["E"]) == (1, None)


@pytest.mark.parametrize("more", [
    "V1 crossed one lane of traffic and struck V2.", "One lane of traffic was blocked by a parked truck.",
    "The truck had one lane of traffic per direction to its left.", "A bus on a street blocked one lane of traffic.",
])  # fmt: skip
def test_a_lane_that_is_crossed_or_blocked_is_no_width_of_a_street(more: str) -> None:
    assert _counts(f"V1 was traveling north on a one-way street. {more}") == {"N": None}


@pytest.mark.parametrize(
    "walker",
    ["stepped from between two parked cars on the east side of the street", "walked into the road from the right"],
)
def test_who_walks_across_makes_no_road(walker: str) -> None:
    facts = read(f"A pedestrian {walker} and was hit by the front of a northbound taxi.").roads
    assert {v.id: v.heading for v in facts.crash.vehicles} == {"P1": "W", "V1": "N"}
    assert facts.junction.kind == "none"
    assert [road.axis for road in facts.roads] == ["N"]


def test_another_one_way_street_told_later_lends_no_lanes() -> None:
    text = ("V1 was northbound on a one-way street. V2 was westbound on a four-lane two-way road. A one-way street "
            "with three lanes runs parallel to the scene.")  # fmt: skip
    assert _counts(text) == {"N": None, "E": 4}


def test_lanes_of_a_one_way_street_stay_its_own_when_it_is_named_again() -> None:
    text = ("It happened in the intersection of a two-way road with two lanes in each direction and a one-way road "
            "with one lane of traffic. The northbound road has a yield sign. V1 was westbound on the two-way road and "
            "V2 was traveling north on the one-way road.")  # fmt: skip
    assert legs(text) == {"E": (2, 2), "W": (2, 2), "S": (1, 0), "N": (0, 1)}
    assert _counts(text)["N"] == 1


def test_two_roads_of_an_intersection_are_told_apart_by_what_was_said_of_them() -> None:
    text = ("The crash occurred in the intersection of a two-way roadway with two lanes in each direction and a "
            "one-lane, one-way roadway. V1 was traveling southbound on the one-way roadway. V2 was traveling east "
            "on the two-way roadway.")  # fmt: skip
    assert legs(text) == {"W": (2, 2), "E": (2, 2), "N": (1, 0), "S": (0, 1)}


def test_both_roads_get_what_is_said_of_two() -> None:
    text = "The crash occurred in the intersection of two four-lane roadways. V1 was eastbound. V2 was southbound."
    assert set(legs(text).values()) == {(2, 2)}


def test_the_intersecting_road_is_another_road() -> None:
    text = V + "was traveling west on a four-lane road approaching an intersection. " + W + \
        "was traveling north on the intersecting two-lane road."  # fmt: skip
    assert legs(text) == {"E": (2, 2), "W": (2, 2), "S": (1, 1), "N": (1, 1)}


def test_the_opening_road_is_the_one_that_vehicles_travel_on() -> None:
    text = "This crash occurred on a four lane undivided roadway. V1 was traveling south on the roadway behind V2."
    assert legs(text) == {"S": (2, 2), "N": (2, 2)}


def test_an_odd_total_has_a_turn_lane_on_each_approach_of_a_junction() -> None:
    text = V + "was traveling east on a three-lane, two-way road at a four-leg intersection. " + W + \
        "was traveling south on the intersecting three-lane road."  # fmt: skip
    assert set(legs(text).values()) == {(2, 1)}


def test_an_odd_total_without_a_junction_keeps_its_total() -> None:
    found = legs("V1 was traveling north on a three-lane road. V2 was traveling south on the same road.")
    assert {n: a + b for n, (a, b) in found.items()} == {"N": 3, "S": 3}
    assert found["S"][0] == found["N"][1]


def test_a_right_turn_lane_at_a_t_stands_on_its_approach_only() -> None:
    text = V + "was traveling east in the eastbound lane of a two-lane road and approached a T-intersection. " + W + (
        "was traveling south on a three-lane road (one southbound right-turn lane, one southbound through-lane, "
        "and one northbound lane). V1 turned left.")  # fmt: skip
    assert legs(text) == {"S": (1, 1), "N": (2, 1), "W": (1, 1)}


def test_a_speed_limit_belongs_to_the_road_it_is_told_of() -> None:
    text = (
        "The posted speed limit was 72 kmph (45 mph) for the eastbound lane and 40 kmph (25 mph) for the "
        "northbound lane. V1 was traveling east and V2 was traveling north when they met in the intersection."
    )
    assert {leg.bearing: leg.speed_limit_mph for leg in layout(text).legs} == {"W": 45, "E": 45, "S": 25, "N": 25}


def test_an_advisory_speed_is_no_limit() -> None:
    text = "The posted speed limit was 55 mph with an advisory speed of 35 mph. V1 was traveling north on the road."
    assert {leg.speed_limit_mph for leg in layout(text).legs} == {55}


def test_a_curve_is_seen_from_both_ends() -> None:
    text = "V1 was traveling west on a two-lane road negotiating a curve to the left. V2 was traveling east."
    assert {leg.bearing: leg.curve for leg in layout(text).legs} == {"E": "left", "W": "right"}


def test_headings_that_no_one_tells_follow_the_road() -> None:
    facts = read("The crash occurred in the westbound lane of a two-lane road. V1 struck the rear of V2.").roads
    assert {v.heading for v in facts.crash.vehicles} == {"W"}


# ------------------------------------------------------------------ junctions
@pytest.mark.parametrize(("text", "kind", "stem"), [
    ("V1 was northbound on a two-lane road and V2 was southbound. V1 drifted left of center.", "none", None),
    ("V1 was northbound. V2 was eastbound approaching the T-intersection and turned left.", "t", "W"),
    ("The crash occurred at a three-legged intersection with a road to the east. V1 and V2 were northbound.", "t", "E"),
    ("V1 was eastbound and V2 was westbound at the T intersection. V2 turned left.", "t", "S"),
    ("V1 and V2 were stopped northbound at the red light. V1 was struck by V2 from behind.", "four_leg", None),
    ("V1 was northbound. V2 was westbound on the intersecting road. They met in the intersection.", "four_leg", None),
    ("V1 was westbound. V2 was traveling south on a private driveway to enter the road.", "driveway", "N"),
    ("V2 was stopped eastbound, waiting to turn left into a gas station. V1 struck the rear of V2.", "driveway", "N"),
    ("There was no intersection nearby. V1 was northbound behind V2.", "none", None),
    ("V1 was eastbound, V2 was westbound. V1 struck V2 in a T-type configuration.", "none", None),
    ("V1 was merging from the entrance ramp onto the southbound freeway. V2 was southbound.", "ramp", None),
])  # fmt: skip
def test_the_junction_is_the_one_told_or_needed(text: str, kind: str, stem: str | None) -> None:
    junction = read(text).roads.junction
    assert junction.kind == kind
    assert stem is None or junction.stem == stem


@pytest.mark.parametrize(("text", "control"), [
    ("The intersection was controlled by traffic lights.", "signal"),
    ("The light turned green at the intersection.", "signal"),
    ("There were no traffic signals at the intersection.", "none"),
    ("V1 saw the brake lights of V2 at the intersection.", "none"),
    ("The streetlights at the intersection were on.", "none"),
    ("The intersection has a stop sign for westbound traffic.", "stop"),
    ("It is an all-way stop intersection.", "all_way_stop"),
    ("The intersection had a flashing yellow signal.", "flashing"),
    ("A yield sign stands at the intersection.", "yield"),
    ("The traffic lights at the intersection were not functioning and it worked as a four-way stop.", "all_way_stop"),
])  # fmt: skip
def test_only_what_controls_traffic_is_a_control(text: str, control: str) -> None:
    assert read(text + " V1 was traveling north and V2 was traveling west.").roads.junction.control == control


@pytest.mark.parametrize("sign", [
    "Westbound traffic is controlled by a stop sign.", "There is a stop sign for the westbound traffic.",
    "V2 stopped at the stop sign.", "The east/west road had a stop sign, the north/south road had no controls.",
])  # fmt: skip
def test_the_sign_stands_on_the_road_that_has_it(sign: str) -> None:
    text = f"V1 was traveling north and V2 was traveling west toward the intersection. {sign}"
    assert controls(text) == {"S": "none", "N": "none", "E": "stop", "W": "stop"}


@pytest.mark.parametrize("told", [
    "V1 was traveling north on a two-lane road with stop signs on the side street only.",
    "V1 was traveling north toward a crossroads that has stop signs for cross traffic only.",
    "V1, northbound, came to the crossing, which has stop signs posted on the minor road.",
])  # fmt: skip
def test_signs_on_the_side_street_stand_there_whoever_the_sentence_names(told: str) -> None:
    text = f"{told} V2 was westbound and entered the intersection. The front of V1 struck the left side of V2."
    assert controls(text) == {"S": "none", "N": "none", "E": "stop", "W": "stop"}


def test_at_a_t_the_sign_stands_on_the_stem() -> None:
    text = "V1 was northbound. V2 was eastbound at the T-intersection, stopped at the stop sign and turned left."
    assert controls(text) == {"S": "none", "N": "none", "W": "stop"}


def test_a_ramp_joins_from_the_right_behind() -> None:
    text = ("V1 was merging from a one-lane entrance ramp onto the westbound lanes of a divided freeway with "
            "three lanes in each direction. V2 was traveling west in lane one.")  # fmt: skip
    found = layout(text)
    assert {leg.bearing: leg.kind for leg in found.legs} == {"E": "road", "W": "road", "NE": "ramp"}
    assert next(leg for leg in found.legs if leg.bearing == "NE").lanes_out == 0


def test_what_had_to_be_assumed_is_noted() -> None:
    notes = read("V1 struck V2 on a street.").roads.notes
    assert any("lanes are not stated" in note for note in notes)
    assert any("no direction of travel" in note for note in notes)


def test_defaults_stand_in_for_what_is_not_told() -> None:
    found = layout_of_facts(read("V1 struck V2 on a street.").roads, Defaults(lanes_each_way=2, speed_limit_mph=30))
    assert {(leg.lanes_in, leg.lanes_out, leg.speed_limit_mph) for leg in found.legs} == {(2, 2, 30)}


# ------------------------------------------------------------------ any text
STORY = """
V1 V2 V3 Vehicle #1 was were traveling north eastbound westbound south the a two three-lane five lanes road roadway
intersection T-intersection driveway ramp freeway stop sign traffic light left right turn turned into from exiting
one-way two-way divided median in each direction lane of struck front side . , ( ) same intersecting curve to with
speed limit 45 mph both vehicles private merged parking lot stopped at parked crossing
"""
babble = st.lists(st.sampled_from(STORY.split()), min_size=1, max_size=60).map(" ".join)


def check(facts: RoadFacts) -> None:
    found = layout_of_facts(facts)
    spec = road_spec(found)
    assert len({leg.bearing for leg in found.legs}) == len(found.legs)
    assert sum(r.lanes_forward for r in spec.roads) > 0
    assert sum(r.lanes_backward for r in spec.roads) > 0
    assert (len(found.legs) > 2) == (facts.junction.kind != "none")


@given(babble)
@settings(max_examples=150, deadline=None)
def test_any_crash_babble_gives_a_layout(text: str) -> None:
    check(read(text).roads)


@given(st.text(max_size=120))
@settings(max_examples=60, deadline=None)
def test_any_text_gives_a_layout(text: str) -> None:
    check(read(text).roads)


way = st.sampled_from(["north", "south", "east", "west"])


deeds = st.sampled_from(["turned left", "turned right", "went straight"])


@given(way, way, st.sampled_from(["", "T-", "four-leg "]), deeds)
@settings(max_examples=60, deadline=None)
def test_every_vehicle_has_the_leg_it_comes_from(first: str, second: str, shape: str, deed: str) -> None:
    facts = read(
        f"V1 was traveling {first} on a two-lane road. "
        f"V2 was traveling {second} and approached the same {shape}intersection. "
        f"V2 {deed} and the front of V1 struck V2."
    ).roads
    found = {leg.bearing: leg for leg in layout_of_facts(facts).legs}
    for v in facts.crash.vehicles:
        assert v.heading
        assert found[turned(v.heading, 180)].lanes_in > 0


def test_waiting_to_turn_into_a_side_road_needs_that_road() -> None:
    text = (V + "was traveling north on a two-lane roadway and stopped before making a left turn onto a side road. "
            + W + "was traveling behind V1 and struck its rear.")  # fmt: skip
    assert set(legs(text)) == {"N", "S", "W"}


def test_a_quoted_t_is_a_shape() -> None:
    assert read("V1 was southbound at this 'T' intersection and was struck by V2.").roads.junction.kind == "t"


def test_a_turn_that_is_made_is_no_lane() -> None:
    text = (V + "was traveling southbound on a road with two lanes in each direction. " + W
            + "was traveling northbound in the left lane and attempting to make a left turn. At the four-leg "
            "intersection the front of V1 struck the right side of V2.")  # fmt: skip
    assert legs(text)["N"] == legs(text)["S"] == (2, 2)


@pytest.mark.parametrize(
    ("told", "kind"),
    [
        ("A van slowed on the interstate", "freeway"),
        ("A van was merging from an on-ramp onto the freeway", "freeway"),
        ("A van was on Elm Street near the freeway", "road"),
        ("A van came from the freeway onto Elm Street", "road"),
    ],
)
def test_a_freeway_is_the_road_of_whom_it_carries(told: str, kind: str) -> None:
    assert read(f"{told} and was sideswiped by a pickup in the right lane.").roads.streets[0].kind == kind


def test_two_whose_flanks_touch_on_a_ramp_s_road_drive_the_same_way() -> None:
    facts = read("While merging from the on-ramp onto the freeway, a truck sideswiped an SUV in the right lane.").roads
    (contact,) = facts.crash.contacts
    assert len({v.heading for v in facts.crash.vehicles}) == 1
    assert facts.crash.vehicles[0].origin == facts.junction.kind == "ramp"
    assert (contact.striker_area, contact.struck_area) == ("left", "right")  # who merges comes from the right


@pytest.mark.parametrize(("road", "mph"), [("freeway", 60), ("rural road", 50), ("road", None)])
def test_the_kind_of_road_stands_in_for_its_limit(road: str, mph: int | None) -> None:
    found = layout(V + f"was traveling north in the left lane of a four-lane {road}.")
    assert {leg.speed_limit_mph for leg in found.legs} == {mph}


def test_the_lane_in_which_it_happened_tells_the_heading() -> None:
    facts = read("The crash occurred in the westbound lane of a two-lane road. V1 was stopped. V2 was behind V1 "
                       "and the front of V2 struck the back of V1.").roads  # fmt: skip
    assert facts.crash.oriented
    assert [v.heading for v in facts.crash.vehicles] == ["W", "W"]


def test_a_center_turn_lane_that_is_turned_into_belongs_to_the_other_road() -> None:
    found = layout("The crash occurred at a T-intersection of a five-lane arterial road and a two-lane side street. "
                   "The five-lane roadway ran east/west with a center turn lane. The two-lane side street went "
                   "north/south. V1 was northbound attempting to turn left from the side street to go west. V2 was "
                   "eastbound. V1 began to turn left into the center turn lane. The front of V2 struck the left side "
                   "of V1.")  # fmt: skip
    assert {leg.bearing: leg.center_turn_lane for leg in found.legs} == {"E": True, "W": True, "S": False}


@pytest.mark.parametrize(("cross", "wide"), [("five", True), ("four", False)])
def test_a_center_turn_lane_lies_in_the_wide_road_and_not_in_one_of_two_lanes(cross: str, wide: bool) -> None:
    found = read("V1 was traveling south on a two-lane road, exiting a parking lot to cross an intersection. V2 was "
                 f"traveling west on a {cross}-lane road. The front of V2 contacted the left side of V1. V1 then came "
                 "to rest in the center turn lane.").roads  # fmt: skip
    told = {road.lanes.total: road.lanes.center_turn_lane for road in found.roads}
    assert told[2] is not wide
    assert {"five": told.get(5), "four": not told.get(4)}[cross]


@pytest.mark.parametrize("text", [
    "There were two lanes and a left turn lane in each direction.",
    "V1 was northbound on a road. There were a lane for left turns in each direction and two northbound lanes.",
    "V1 was northbound on a two-lane road. There was one lane for left turns in each direction.",
])  # fmt: skip
def test_turn_lanes_in_each_direction_belong_to_no_axis_of_their_own(text: str) -> None:
    facts = read(text).roads
    assert any("left" in turns for road in facts.roads for turns in road.lanes.turns.values())
