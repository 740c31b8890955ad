"""Only what the narrative states for sure is held against a network."""

import pytest

from plugins.road_writer.template import Template
from plugins.validator.road_narrative import RoadNarrative
from sgcad_core.asking.prompts import answer_schema
from sgcad_core.asking.schema_holds import narrowed_schema
from sgcad_core.case.records import Context, CrashReport, Diagram, Evidence, Finding, RoadNetwork
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.lane_total_readings import allowed_totals
from sgcad_core.roads.layout import road_spec

ANSWER = answer_schema(RoadLayout)
CROSSING = (
    "V1 was traveling north on a four-lane, two-way road with a posted speed limit of 45 mph and was approaching "
    "a four-leg intersection. V2 was traveling west on the intersecting two-lane road. "
    "The front of V1 struck the left side of V2."
)
T = "V1 was northbound on a two-lane road. V2 was westbound, approaching the T-intersection, and turned left."
PLAIN = "V1 was traveling north on a two-lane road. V2 was traveling south on the same road and crossed the centerline."
ONE_WAY = "V1 was traveling north on a three-lane, one-way street and struck the rear of V2."


def network(*legs: Leg) -> RoadNetwork:
    spec = road_spec(RoadLayout(legs=legs))
    return compile_network(plain_xml(spec), spec)


def leg(bearing: str, lanes_in: int, lanes_out: int, limit: int | None = None) -> Leg:
    return Leg.model_validate(
        {"bearing": bearing, "lanes_in": lanes_in, "lanes_out": lanes_out, "speed_limit_mph": limit}
    )


def findings(text: str, artifact: RoadNetwork, pictured: bool = False) -> list[Finding]:
    diagrams = (Diagram(png=b"", width_px=1, height_px=1),) if pictured else ()
    return RoadNarrative().findings(artifact, Evidence(report=CrashReport(case="c", narrative=text, diagrams=diagrams)))


def repairs(text: str, *legs: Leg, pictured: bool = False) -> list[str]:
    return [f.what for f in findings(text, network(*legs), pictured) if f.severity == "question"]


@pytest.mark.parametrize("pictured", [False, True])
def test_four_told_legs_are_held_to_their_places_unless_a_diagram_may_show_others(pictured: bool) -> None:
    text = "V1 was traveling north approaching a four-leg intersection. V2 was northbound. V1 struck the rear of V2."
    found = findings(text, network(leg("N", 1, 1), leg("S", 1, 1), leg("W", 1, 1)), pictured)
    holds = next(f for f in found if "four-leg" in f.what).holds
    placed = [hold.either[0]["bearing"] for hold in holds if hold.at is not None]
    assert placed == ([] if pictured else [("N",), ("E",), ("S",), ("W",)])


BEYOND_HALF = "V1 was westbound on a three-lane road in lane 3. V2 was westbound in lane 2. V1 struck the rear of V2."
HIGHWAY = "V1 was westbound in lane three of a three-lane highway. V2 was westbound. V1 struck the rear of V2."


@pytest.mark.parametrize("text", [CROSSING, T, PLAIN, ONE_WAY, BEYOND_HALF, HIGHWAY])
def test_a_network_as_told_has_nothing_to_repair(text: str) -> None:
    written = Template().write(Context(narrative=text), (), (), None, 1)  # type: ignore[arg-type]
    assert findings(text, written) == []


def test_wrong_lane_totals_are_found() -> None:
    north_south, east_west = (leg("N", 1, 1, 45), leg("S", 1, 1, 45)), (leg("E", 1, 1), leg("W", 1, 1))
    assert any("north-south road has 4" in what for what in repairs(CROSSING, *north_south, *east_west))


def test_turn_lanes_beside_the_named_lanes_are_allowed_where_a_diagram_may_show_them() -> None:
    legs = (leg("N", 3, 2, 45), leg("S", 3, 2, 45), leg("E", 1, 1), leg("W", 1, 1))
    assert repairs(CROSSING, *legs, pictured=True) == []
    assert any("north-south road has 4 lanes" in what for what in repairs(CROSSING, *legs))


def test_without_a_diagram_the_lanes_of_another_road_do_not_excuse_those_of_this() -> None:
    legs = (leg("N", 1, 1, 45), leg("S", 1, 1, 45), leg("E", 2, 2), leg("W", 2, 2))
    assert repairs(CROSSING, *legs, pictured=True) == []
    assert len([what for what in repairs(CROSSING, *legs) if "lanes in both directions together" in what]) == 2


def test_lanes_told_way_by_way_are_held_against_their_own_road_even_beside_a_diagram() -> None:
    told = CROSSING.replace("four-lane, two-way road", "three-lane road (two northbound lanes, one southbound lane)")
    legs = (leg("N", 1, 1, 45), leg("S", 1, 1, 45), leg("E", 2, 1), leg("W", 2, 1))
    assert any("north-south road has 3 to 4 lanes" in what for what in repairs(told, *legs, pictured=True))
    vague = CROSSING.replace("four-lane", "three-lane")
    assert repairs(vague, *legs, pictured=True) == []


def test_a_junction_without_the_named_legs_is_found() -> None:
    assert any("four-leg intersection" in what for what in repairs(CROSSING, leg("N", 2, 2), leg("S", 2, 2)))


WAITING = (
    "V1 was northbound on a two-lane road and stopped, waiting to make a left turn into a private driveway. V2 was "
    "traveling north behind V1. The front of V2 struck the rear of V1."
)
FROM_THE_SIDE = (
    "This crash occurred at a T-intersection. V1 was traveling eastbound on the two-lane main road. The side street "
    "joins it from the north. The front of V1 struck the left side of V2."
)


@pytest.mark.parametrize(("text", "right", "wrong"), [
    (T, "SNE", "SNW"), (WAITING, "SNW", "SNE"), (FROM_THE_SIDE, "WEN", "WES"), (CROSSING, "SNWE", "SNW"),
])  # fmt: skip
def test_a_junction_laid_the_wrong_way_round_is_found_and_held_to_the_legs_that_vehicles_use(
    text: str, right: str, wrong: str
) -> None:
    def sides(bearings: str) -> list[Finding]:
        legs = [leg(bearing, 2 - (bearing in "EW"), 2 - (bearing in "EW")) for bearing in bearings]
        return [f for f in findings(text, network(*legs)) if "come from or turn into" in f.what]

    assert sides(right) == []
    (found,) = sides(wrong)
    legs = narrowed_schema(ANSWER, found.holds)["anyOf"][0]["properties"]["legs"]
    assert legs["minItems"] == len(right)
    bearings = [place["properties"]["bearing"]["enum"] for place in legs["prefixItems"]]
    assert bearings == [[bearing] for bearing in "NESW" if bearing in right]


def test_beside_a_diagram_an_unnamed_junction_is_not_held_to_legs_that_only_the_text_suggests() -> None:
    text = T.replace(", approaching the T-intersection,", " at the intersection")
    (found,) = findings(text, network(leg("S", 1, 1), leg("N", 1, 1), leg("W", 1, 1)), pictured=True)
    assert found.holds == ()


def test_a_plain_road_is_not_asked_for_the_legs_of_a_junction_that_nobody_names() -> None:
    assert repairs(WAITING.replace(" into a private driveway", ""), leg("N", 1, 1), leg("S", 1, 1)) == []


def test_a_lane_number_beyond_the_road_is_found_and_held_where_no_diagram_counts_lanes() -> None:
    text = "V1 was traveling north in lane three. V2 was traveling north behind V1 and struck the rear of V1."
    legs = (leg("N", 2, 2), leg("S", 2, 2))
    assert repairs(text, *legs, pictured=True) == []
    (found,) = [f for f in findings(text, network(*legs)) if f.severity == "question"]
    assert "at least 3 lanes that head north" in found.what
    assert repairs(text, *held([found], *legs), leg("E", 1, 1)) == []


def test_lanes_told_of_one_direction_are_held_on_its_approach() -> None:
    text = (
        "This crash occurred at a T-intersection. The southbound lanes consisted of a right-turn lane, two through "
        "lanes and a left-turn lane. V1 was traveling east and turned right. V2 was traveling south."
    )
    legs = (leg("N", 2, 2), leg("S", 2, 2), leg("W", 1, 1))
    found = [f for f in findings(text, network(*legs)) if "4 lanes that head south" in f.what]
    assert [hold.values for f in found for hold in f.holds] == [("N",)]
    assert held(found, *legs)[0].lanes_in == 4
    assert [f for f in findings(text, network(*held(found, *legs))) if "that head south" in f.what] == []


def test_lanes_of_one_direction_that_do_not_add_up_are_passed_over() -> None:
    text = "V1 was traveling north on a five-lane road with two southbound lanes and one northbound lane."
    found = findings(text, network(leg("N", 2, 3), leg("S", 3, 2)))
    assert not [f for f in found if "that head" in f.what]


def test_a_lane_number_that_the_told_lanes_contradict_is_passed_over() -> None:
    text = "V1 was traveling north in lane three on a two-lane, two-way road. V2 was traveling south."
    assert repairs(text, leg("N", 1, 1), leg("S", 1, 1)) == []


def test_a_vehicle_without_a_road_is_found() -> None:
    what = repairs(PLAIN, leg("E", 1, 1), leg("W", 1, 1))
    assert any("V1 travels north" in w for w in what)
    assert any("V2 travels south" in w for w in what)


def test_traffic_against_a_one_way_street_is_found() -> None:
    assert any("one-way" in what for what in repairs(ONE_WAY, leg("N", 3, 3), leg("S", 3, 3)))


def test_of_a_one_way_road_with_a_median_both_carriageways_may_be_drawn() -> None:
    divided = ONE_WAY.replace("one-way street", "one-way street with a grass median")
    assert divided != ONE_WAY
    assert not [what for what in repairs(divided, leg("N", 3, 3), leg("S", 3, 3)) if "one-way" in what]


MIXED = (
    "V1 was traveling westbound on a two-way road with one lane in each direction. V2 was northbound on a one-lane, "
    "one-way street. The vehicles met in the intersection and the front of V2 struck the left side of V1."
)


def test_a_two_way_road_drawn_in_one_direction_is_found_and_held() -> None:
    north = (leg("N", 0, 1), leg("S", 1, 0))
    assert repairs(MIXED, leg("E", 1, 1), leg("W", 1, 1), *north) == []
    wrong = (leg("E", 2, 0), leg("W", 0, 2), *north)
    (found,) = [f for f in findings(MIXED, network(*wrong)) if f.severity == "question"]
    assert "east-west road is two-way" in found.what
    assert repairs(MIXED, *held([found], *wrong)) == []
    divided = MIXED.replace("a two-way road", "a divided, two-way road")
    assert not any("is two-way" in what for what in repairs(divided, *wrong))


def test_lanes_told_of_a_one_way_road_are_held_where_no_diagram_counts_them() -> None:
    legs = (leg("E", 1, 1), leg("W", 1, 1), leg("N", 0, 3), leg("S", 3, 0))
    assert [what for what in repairs(MIXED, *legs) if "1 lanes that head north" in what]
    assert repairs(MIXED, *legs, pictured=True) == []
    uncounted = MIXED.replace("one-lane, one-way", "one-way")
    assert repairs(uncounted, *legs) == []


@pytest.mark.parametrize(("place", "found"), [
    ("a driveway", True), ("the side road. The side street joins the road from the west", True),
    ("a street", False),
])  # fmt: skip
def test_a_turn_into_a_named_place_needs_a_junction(place: str, found: bool) -> None:
    text = f"V1 was northbound on a two-lane road and turned left into {place}. V2 was southbound and struck its side."
    plain = (leg("N", 1, 1), leg("S", 1, 1))
    assert bool(repairs(text, *plain)) == found
    here = [f for f in findings(text, network(*plain)) if f.value == "no junction"]
    assert [f.holds[0].at_least for f in here] == [3] * found
    assert [f.severity for f in findings(text, network(*plain), pictured=True) if f.value == "no junction"] == (
        ["doubt"] * found
    )
    assert repairs(text, *plain, leg("W", 1, 1)) == []


@pytest.mark.parametrize("text", [
    "V1 was northbound on Interstate 95, which has three lanes in each direction, and struck the rear of V2.",
    "V1 was northbound on a one-way street with a two-way radio on and struck the rear of V2 at an intersection.",
    "At the intersection V1 was northbound where the two-way road was reduced to a one-way lane. V2 was ahead of V1.",
])  # fmt: skip
def test_one_carriageway_is_no_fault_where_the_text_does_not_say_that_both_are_there(text: str) -> None:
    assert not any("two-way" in what for what in repairs(text, leg("N", 0, 3), leg("S", 3, 0)))


def test_roads_whose_axes_the_text_leaves_open_are_not_held_to_their_directions() -> None:
    text = (
        "The crash occurred at the intersection of a two-way street and a one-way street. V1 drove west on the one-way "
        "street. V2 drove east. The front of V1 struck the front of V2."
    )
    legs = (leg("E", 1, 1), leg("W", 1, 1), leg("N", 0, 1), leg("S", 1, 0))
    assert not any("-way in" in what for what in repairs(text, *legs))


def test_what_somebody_only_plans_needs_no_junction() -> None:
    text = (
        "V1 was northbound on a two-lane road, planning to turn left into a driveway some distance ahead. V1 crossed "
        "the center line and struck V2, which was southbound, head on."
    )
    assert repairs(text, leg("N", 1, 1), leg("S", 1, 1)) == []


@pytest.mark.parametrize("also", [
    "V3 was southbound and V4 was eastbound.", "A driveway lies opposite, from which V3 came.",
])  # fmt: skip
def test_a_t_beside_which_more_is_told_may_have_a_fourth_leg(also: str) -> None:
    text = f"The crash occurred at a T-intersection. V1 was northbound and V2 was westbound. {also} V1 struck V2."
    legs = tuple(leg(bearing, 1, 1) for bearing in "NESW")
    assert [f.severity for f in findings(text, network(*legs)) if "leg too many" in f.what] == ["note"]


def test_a_t_with_four_legs_is_held_to_three_unless_a_diagram_may_show_another() -> None:
    legs = tuple(leg(bearing, 1, 1) for bearing in "NESW")
    (found,) = [f for f in findings(FROM_THE_SIDE, network(*legs)) if "leg too many" in f.what]
    assert (found.severity, found.holds[0].at_most) == ("question", 3)
    held_to = narrowed_schema(ANSWER, found.holds)["anyOf"][0]["properties"]["legs"]
    assert (held_to["minItems"], held_to["maxItems"]) == (2, 3)
    assert all(f.severity == "note" for f in findings(FROM_THE_SIDE, network(*legs), pictured=True))


def test_a_wrong_limit_and_an_unnamed_junction_are_notes() -> None:
    legs = (leg("N", 2, 2, 30), leg("S", 2, 2, 30), leg("E", 1, 1), leg("W", 1, 1))
    found = findings(CROSSING, network(*legs))
    assert [(f.severity, "45 mph" in f.what) for f in found] == [("note", True)]
    found = findings(PLAIN, network(leg("N", 1, 1), leg("S", 1, 1), leg("E", 1, 1)))
    assert [f.severity for f in found] == ["note"]


def test_repairs_stand_before_notes() -> None:
    legs = (leg("N", 1, 1, 30), leg("S", 1, 1, 30), leg("E", 1, 1), leg("W", 1, 1))
    severities = [f.severity for f in findings(CROSSING, network(*legs))]
    assert severities == sorted(severities, key=lambda s: s != "question")
    assert set(severities) == {"question", "note"}


def test_what_did_not_compile_or_says_nothing_is_passed_over() -> None:
    assert findings(CROSSING, RoadNetwork()) == []
    assert findings("", network(leg("N", 1, 1), leg("S", 1, 1))) == []


@pytest.mark.parametrize(("bearings", "found"), [("EWN", []), ("EWS", ["doubt"]), ("NSW", ["question"])])
def test_a_leg_that_only_the_struck_side_tells_is_a_doubt(bearings: str, found: list[str]) -> None:
    text = (
        "V1 was traveling west on a road. V2 was making a left turn from the side road at a T-intersection. "
        "The front of V1 struck the left side of V2."
    )
    here = [f for f in findings(text, network(*(leg(bearing, 1, 1) for bearing in bearings))) if "turn into" in f.what]
    assert [f.severity for f in here] == found
    held = [hold.either[0]["bearing"][0] for f in here for hold in f.holds]
    assert held == ["N", "E", "W"][: 3 * bool(found)]


@pytest.mark.parametrize(("said", "low", "high"), [
    ("a four-lane, two-way road", 4, 5), ("a five-lane road with a center turn lane", 4, 6),
    ("a road with two lanes in each direction", 4, 5),
])  # fmt: skip
def test_allowed_totals_hold_what_the_words_may_mean(said: str, low: int, high: int) -> None:
    road = read(f"V1 was traveling north on {said}.").roads.streets[0]
    assert (min(allowed_totals(road)), max(allowed_totals(road))) == (low, high)
    assert max(allowed_totals(road, pictured=False)) == high - 1


def test_turn_lanes_of_both_approaches_lie_one_behind_the_other() -> None:
    lanes = ", ".join(f"one {way} left turn lane, one {way} lane" for way in ("northbound", "southbound"))
    said = f"a four-lane road ({lanes})"
    assert allowed_totals(read(f"V1 was traveling north on {said}.").roads.streets[0], pictured=False) == {3, 4}


def test_turn_lanes_among_lanes_told_way_by_way_are_not_counted_twice() -> None:
    said = "a five-lane road (two southbound lanes, two northbound lanes, one northbound left turn lane)"
    road = read(f"V1 was traveling north on {said}.").roads.streets[0]
    assert allowed_totals(road, pictured=False) == {5}
    assert max(allowed_totals(road)) == 6


@pytest.mark.parametrize("said", ["a divided four-lane highway", "a two-lane, one-way street", "a road"])
def test_a_road_whose_drawn_total_is_open_allows_anything(said: str) -> None:
    assert allowed_totals(read(f"V1 was traveling north on {said}.").roads.streets[0]) == set()


def held(found: list[Finding], *legs: Leg) -> list[Leg]:
    """Legs with the first choice of every hold that means them."""
    for hold in (hold for finding in found for hold in finding.holds):
        choice = {name: values[0] for name, values in hold.either[0].items()} if hold.either else {}
        legs = tuple(leg.model_copy(update=choice if leg.bearing in hold.values else {}) for leg in legs)
    return list(legs)


def test_lanes_that_a_finding_holds_are_those_of_the_text() -> None:
    legs = (leg("N", 1, 1, 45), leg("S", 1, 1, 45), leg("E", 1, 1), leg("W", 1, 1))
    found = [f for f in findings(CROSSING, network(*legs)) if f.severity == "question"]
    (hold,) = [hold for finding in found for hold in finding.holds]
    assert set(hold.values) == {"N", "S"}
    allowed = {n + out for choice in hold.either for n in choice["lanes_in"] for out in choice["lanes_out"]}
    assert allowed == allowed_totals(read(CROSSING).roads.streets[0], pictured=False)
    assert repairs(CROSSING, *held(found, *legs)) == []


def test_a_missing_junction_and_a_one_way_road_are_held() -> None:
    (finding,) = [f for f in findings(CROSSING, network(leg("N", 2, 2), leg("S", 2, 2))) if f.where == "junction"]
    assert finding.holds[0].line() == "at least 4 legs"
    legs = (leg("N", 2, 1), leg("S", 1, 2))
    found = [f for f in findings(ONE_WAY, network(*legs)) if "one-way" in f.what]
    assert set(found[0].holds[0].values) == {"N", "S"}
    assert all(0 in (*choice["lanes_in"], *choice["lanes_out"]) for choice in found[0].holds[0].either)


def test_a_direction_that_no_road_carries_is_held_on_both_legs() -> None:
    legs = (leg("N", 0, 2), leg("S", 2, 0), leg("E", 1, 1), leg("W", 0, 1))
    found = [f for f in findings(T.replace("northbound", "southbound"), network(*legs)) if "no road carries" in f.what]
    assert [hold.values for hold in found[0].holds] == [("N",), ("S",)]
    assert [tuple(hold.either[0]) for hold in found[0].holds] == [("lanes_in",), ("lanes_out",)]
    changed = held(found, *legs)
    assert not any("no road carries" in what for what in repairs(T.replace("northbound", "southbound"), *changed))


def test_a_missing_junction_gets_its_legs_where_the_told_paths_use_every_one() -> None:
    (found,) = [f for f in findings(FROM_THE_SIDE, network(leg("E", 1, 1), leg("W", 1, 1))) if f.severity == "question"]
    told = {hold.at: hold.either[0]["bearing"] for hold in found.holds if hold.either}
    assert told == {0: ("N",), 1: ("E",), 2: ("W",)}
    guessed = FROM_THE_SIDE.replace("The side street joins it from the north. ", "")
    (found,) = [f for f in findings(guessed, network(leg("E", 1, 1), leg("W", 1, 1))) if f.severity == "question"]
    assert [hold.at_least for hold in found.holds] == [3]


def test_a_roundabout_that_is_told_must_be_drawn() -> None:
    text = "V1 was northbound and entered a roundabout. V1 struck the rear of V2."
    legs = [leg(at, 1, 1) for at in ("N", "E", "S", "W")]
    missed = findings(text, network(*legs))[0]
    assert (missed.severity, missed.value) == ("question", "no roundabout")
    spec = road_spec(RoadLayout(legs=tuple(legs), circle_lanes=1))
    drawn = findings(text, compile_network(plain_xml(spec), spec))
    assert not [found.what for found in drawn if found.severity != "note"]


@pytest.mark.parametrize(
    ("place", "called"), [("in a parking garage", "a parking garage"), ("at a railroad crossing", "a railway crossing")]
)
def test_a_crash_at_a_place_that_cannot_be_drawn_as_it_is_is_noted(place: str, called: str) -> None:
    plain = network(leg("N", 1, 1), leg("S", 1, 1))
    noted = findings(f"The crash occurred {place}. V1 was northbound and struck the rear of V2.", plain)
    assert [found.severity for found in noted if found.value == called] == ["note"]


def test_a_told_control_that_stands_nowhere_is_a_question_with_its_sentence() -> None:
    text = (
        "The crash occurred at a four-leg intersection controlled by a traffic signal. V1 was northbound and struck V2."
    )
    legs = [leg(way, 1, 1) for way in ("N", "E", "S", "W")]
    (asked,) = [f for f in findings(text, network(*legs)) if f.where == "junction.control"]
    assert (asked.severity, asked.value) == ("question", "none")
    assert asked.told is not None
    assert "traffic signal" in asked.told.sentence
    signal = [one.model_copy(update={"control": "signal"}) for one in legs]
    assert not [f for f in findings(text, network(*signal)) if f.where == "junction.control"]
