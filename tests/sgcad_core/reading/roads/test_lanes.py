"""Lanes are counted as the text states them: totals, directions, turn lanes, one-way, medians."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.reading.roads.carriageway import MOST, carriageway
from sgcad_core.reading.roads.lanes import LaneFacts, compass, lane_facts
from sgcad_core.reading.text.normalise import normalize, number


def read(text: str) -> LaneFacts:
    return lane_facts(normalize(text))


@pytest.mark.parametrize(("text", "total"), [
    ("a two lane undivided road", 2), ("a 4-lane, two-way street", 4), ("a road with five lanes in total", 5),
    ("It consists of six travel lanes", 6), ("a one-lane ramp", 1),
    ("the double yellow two lane lines", None), ("it swerved across three lanes", None), ("the right lane", None),
])  # fmt: skip
def test_a_total_is_a_number_that_no_direction_claims(text: str, total: int | None) -> None:
    assert read(text).total == total


@pytest.mark.parametrize("text", [
    "with two lanes in each direction", "two travel lanes each way", "two lanes per direction", "two in each direction",
    "two through lanes for each direction", "two lanes of travel in both directions",
])  # fmt: skip
def test_lanes_each_way_have_many_spellings(text: str) -> None:
    assert read(text).each_way == 2


@pytest.mark.parametrize(("text", "toward"), [
    ("(two lanes eastbound, raised median, three lanes westbound)", {"E": 2, "W": 3}),
    ("(one northbound left-turn lane, one northbound lane, and one southbound lane)", {"N": 2, "S": 1}),
    ("(two westbound and two eastbound with a center turn lane)", {"W": 2, "E": 2}),
    ("The southbound side has three lanes including a left turn lane", {"S": 3}),
    ("The eastbound road consisted of three lanes, two through lanes and a right turn lane", {"E": 3}),
    ("two northbound through lanes, a left turn lane and a right turn lane, and one southbound lane", {"N": 4, "S": 1}),
    ("the third northbound lane, which was a left turn-only lane", {"N": 3}),
    ("two eastbound lanes and an eastbound lane for left turns", {"E": 3}),
    ("two eastbound lanes, one eastbound lane that was reserved for left turns only", {"E": 3}),
    ("two through lanes eastbound with a left only lane, one lane westbound", {"E": 3, "W": 1}),
    ("an eastbound bay for right-turning traffic and two eastbound lanes", {"E": 3}),
    ("two northbound lanes. V1 was stopped in a northbound lane for left turning traffic", {"N": 2}),
    ("two eastbound lanes, with a lane for left turns and through traffic", {"E": 2}),
    ("It had five northbound lanes. The fourth northbound lane, which was a left-turn lane, was empty", {"N": 5}),
    ("in the second northbound lane, which was a left turn lane, of a road with four northbound lanes", {"N": 4}),
    ("the two southbound lanes and the second northbound lane, which was a right turn lane", {"S": 2, "N": 2}),
    ("one lane for northbound traffic and two lanes for the southbound traffic", {"N": 1, "S": 2}),
    ("This street has five lanes, two southbound lanes, two northbound lanes and a two-way left turn lane",
     {"S": 2, "N": 2}),
    ("four lanes with two through lanes and a right turn lane in the westbound direction and one lane eastbound",
     {"W": 3, "E": 1}),
])  # fmt: skip
def test_lanes_are_summed_by_direction_of_travel(text: str, toward: dict[str, int]) -> None:
    assert read(text).toward == toward


def test_turn_lanes_are_kept_with_their_direction() -> None:
    facts = read("The northbound side had four lanes that included a left turn lane and a right turn lane")
    assert facts.turns == {"N": ("left", "right")}


def test_left_turn_lanes_for_both_directions_are_told_once() -> None:
    assert read("with a left turn lane in each direction").turns["each"] == ("left",)


def test_the_lane_a_vehicle_is_in_does_not_add_to_counted_lanes() -> None:
    facts = read("in the eastbound left-turn lane of a three-lane road "
                 "(one eastbound left turn lane, one eastbound lane, and one westbound lane)")  # fmt: skip
    assert facts.toward == {"E": 2, "W": 1}


@pytest.mark.parametrize("text", [
    "a five-lane road with a center turn lane", "undivided with two-way left turn lane", "a middle turn lane",
    "a TWLTL",
])  # fmt: skip
def test_a_center_turn_lane_is_told_apart(text: str) -> None:
    facts = read(text)
    assert facts.center_turn_lane
    assert facts.turns == {}


@pytest.mark.parametrize(("text", "one_way", "toward"), [
    ("a northbound one-way street", True, "N"), ("a one-way, two-lane road that ran east", True, "E"),
    ("a two-way roadway", False, None), ("a two-lane road", None, None),
])  # fmt: skip
def test_one_way_is_told_from_two_way(text: str, one_way: bool | None, toward: str | None) -> None:
    facts = read(text)
    assert (facts.one_way, facts.one_way_toward) == (one_way, toward)


@pytest.mark.parametrize(("text", "divided", "median"), [
    ("a divided highway", True, None), ("divided by a concrete barrier", True, "barrier"),
    ("divided by a grass median", True, "grass"), ("with a raised curb median", True, "raised"),
    ("an unprotected median", True, "grass"), ("separated by a painted median", True, "painted"),
    ("a not physically divided road", False, None), ("an undivided road", False, None),
    ("divided by two solid yellow lines", None, None), ("separated by a double yellow line", None, None),
    ("V1 struck the guardrail", None, None),
])  # fmt: skip
def test_painted_lines_do_not_divide_a_road(text: str, divided: bool | None, median: str | None) -> None:
    facts = read(text)
    assert (facts.divided, facts.median) == (divided, median)


def test_lanes_of_the_own_direction_are_no_total() -> None:
    facts = read("in the second of three lanes")
    assert (facts.own, facts.total) == (3, None)


@pytest.mark.parametrize(
    ("word", "point"), [("north", "N"), ("Southbound", "S"), ("northwesterly", "NW"), ("eastern", "E")]
)
def test_compass_words_lose_their_ending(word: str, point: str) -> None:
    assert compass(word) == point


def test_numbers_are_words_digits_or_an_article() -> None:
    assert [number(w) for w in ("3", "Three", "a", "single")] == [3, 3, 1, 1]


# ------------------------------------------------------------------ both directions
@pytest.mark.parametrize(("facts", "north", "south"), [
    (LaneFacts(total=4), (2, 2), (2, 2)), (LaneFacts(each_way=3), (3, 3), (3, 3)),
    (LaneFacts(total=3), (2, 1), (2, 1)), (LaneFacts(total=5, center_turn_lane=True), (2, 2), (2, 2)),
    (LaneFacts(total=4, center_turn_lane=True), (2, 2), (2, 2)), (LaneFacts(total=3, divided=True), (3, 3), (3, 3)),
    (LaneFacts(total=3, toward={"N": 2}), (2, 2), (1, 1)),
    (LaneFacts(toward={"N": 3}, turns={"N": ("left",)}), (3, 2), (2, 2)),
    (LaneFacts(each_way=2, turns={"any": ("left",)}), (3, 2), (2, 2)), (LaneFacts(), (1, 1), (1, 1)),
])  # fmt: skip
def test_open_lanes_are_completed(facts: LaneFacts, north: tuple[int, int], south: tuple[int, int]) -> None:
    both = carriageway(facts, "N", "N", {})
    assert [(both.way(w).approach, both.way(w).through) for w in ("N", "S")] == [north, south]


def test_a_one_way_road_has_lanes_one_way_only() -> None:
    both = carriageway(LaneFacts(total=2, one_way=True), "E", "W", {})
    assert (both.way("W").approach, both.way("E").approach) == (2, 0)


def test_a_vehicle_in_lane_three_needs_three_lanes() -> None:
    assert carriageway(LaneFacts(), "N", "S", {"S": 3}).way("S").approach == 3


small = st.integers(1, 12)
turns = st.lists(st.sampled_from(["left", "right"]), max_size=3).map(tuple)


@given(st.builds(
    LaneFacts, total=st.none() | small, each_way=st.none() | small,
    toward=st.dictionaries(st.sampled_from(["N", "S", "E"]), small, max_size=3),
    turns=st.dictionaries(st.sampled_from(["N", "S", "any", "each"]), turns, max_size=3),
    one_way=st.none() | st.booleans(), center_turn_lane=st.booleans(), divided=st.none() | st.booleans(),
))  # fmt: skip
@settings(max_examples=300, deadline=None)
def test_every_statement_gives_a_road_one_can_drive(facts: LaneFacts) -> None:
    both = carriageway(facts, "N", "N", {})
    assert both.ways
    assert all(1 <= way.approach <= MOST and 1 <= way.through <= MOST + 5 for way in both.ways.values())


@given(st.text(max_size=200))
@settings(max_examples=200, deadline=None)
def test_lane_facts_read_any_text(text: str) -> None:
    lane_facts(text)


@pytest.mark.parametrize(("said", "total", "one_way"), [
    ("a one-way roadway with one lane of travel", 1, True), ("a one-way street, two lanes wide", 2, True),
    ("a roadway with one lane of travel", None, None), ("a two-way road reduced to a one-way lane", None, None),
    ("a one-way street with a two-way radio post", None, True),
])  # fmt: skip
def test_lanes_of_one_way_streets(said: str, total: int | None, one_way: bool | None) -> None:
    facts = lane_facts(said)
    assert (facts.total, facts.one_way) == (total, one_way)
