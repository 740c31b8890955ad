"""One spelling for mentions, units and directions; sentences with roles."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.reading.text.normalise import normalize, sentences


@pytest.mark.parametrize(
    "mention",
    ["V1", "V 1", "V-1", "v1", "Vehicle #1", "Vehicle # 1", "Vehicle 1", "vehicle one", "Vehicle One (V1)",
     "Vehicle one (V1 - case vehicle)", "Vehicle #1 (V1 )", "Vehicle No. 1", "Veh. #1", "Vehicle. # 1"],
)  # fmt: skip
def test_every_spelling_of_a_numbered_vehicle_becomes_one(mention: str) -> None:
    assert normalize(f"{mention} went south and {mention} stopped.") == "V1 went south and V1 stopped."


@pytest.mark.parametrize(
    ("written", "normal"),
    [
        ("Vehicle #2,2001 Honda Civic", "V2, 2001 Honda Civic"),
        ("the truck (V 2 - grey)", "the truck (V2, grey)"),
        ("the truck (grey, Vehicle #2)", "the truck (V2, grey)"),
        ("at 50kmph (31mph).V2 slowed", "at 50 kmph (31 mph). V2 slowed"),
        ("at 31 M.P.H. or 50 km/h", "at 31 mph or 50 kmph"),
        ("an east bound and a north-bound car", "an eastbound and a northbound car"),
        ("the N/B lane", "the northbound lane"),
        ("facing north-west", "facing northwest"),
        ("a “T” intersection", "a T-intersection"),
        ("a 3-way intersection", "a T-intersection"),
        ("a 4-leg intersection", "a four-leg intersection"),
        ("a 4 lane road with one lane", "a four-lane road with one lane"),
        ("with it’s front", "with its front"),
        ("on the raod thru town", "on the road through town"),
        ("It stopped.. Then it went.", "It stopped. Then it went."),
    ],
)
def test_spelling_variants_have_one_normal_form(written: str, normal: str) -> None:
    assert normalize(written) == normal


def test_one_way_and_two_year_old_are_no_vehicle_numbers() -> None:
    assert normalize("Five vehicles, 3-lane") == "Five vehicles, three-lane"


@given(st.text(max_size=300))
@settings(max_examples=300, deadline=None)
def test_normalizing_twice_changes_nothing_and_any_text_is_accepted(text: str) -> None:
    once = normalize(text)
    assert normalize(once) == once
    assert all(s.text for s in sentences(text))


@given(st.lists(st.sampled_from(
    ["Vehicle", "vehicle one", "#", "1", "2", "V", "(V1", "V 2)", "- case vehicle)", ",", ".", "..", "2001", "mph",
     "kmph", "east", "bound", "north", "-", "T", "intersection", "four", "lane", "(", ")", "\n\n", "\n", "A", "front"]),
    max_size=25), st.sampled_from(["", " "]))  # fmt: skip
@settings(max_examples=500, deadline=None)
def test_normalizing_report_like_scraps_twice_changes_nothing(pieces: list[str], glue: str) -> None:
    once = normalize(glue.join(pieces))
    assert normalize(once) == once


@pytest.mark.parametrize(
    ("sentence", "role"),
    [
        ("The crash occurred at a four-way intersection on a weekday.", "opening"),
        ("The roadway was straight and level with a speed limit of 35 mph.", "road"),
        ("It was daylight and the road was dry.", "conditions"),
        ("Vehicle #1, a 2001 Ford Focus, was traveling west in the right lane.", "approach"),
        ("The driver of V1 braked and swerved right.", "avoidance"),
        ("The front of V1 struck the left side of V2.", "impact"),
        ("V2 rotated clockwise 90 degrees and came to rest facing east.", "rest"),
        ("Both vehicles were towed due to damage.", "towing"),
        ("He stated that V2 had turned left in front of him.", "interview"),
        ("The Critical Pre-crash Event for Vehicle #1 was coded as turning left.", "codes"),
        ("An associated factor was the use of a phone.", "factors"),
    ],
)
def test_role_is_what_a_sentence_is_for(sentence: str, role: str) -> None:
    assert sentences(sentence)[0].role == role


def test_a_near_miss_is_no_impact() -> None:
    assert sentences("V1 steered right to avoid contact with V2.")[0].role == "avoidance"


def test_sentences_end_at_full_stops_without_a_space_but_not_at_abbreviations() -> None:
    found = sentences("V1 was 1.5 m off the road.V2 was approx. 3 m behind.\n\nIt stopped.")
    assert [s.text for s in found] == ["V1 was 1.5 m off the road.", "V2 was approx. 3 m behind.", "It stopped."]
    assert [s.paragraph for s in found] == [0, 0, 1]


def test_a_sentence_without_an_end_is_cut_and_nothing_is_lost() -> None:
    found = sentences("the weather was " * 500)
    assert max(len(s.text) for s in found) <= 1000
    assert " ".join(s.text for s in found).split() == ["the", "weather", "was"] * 500
