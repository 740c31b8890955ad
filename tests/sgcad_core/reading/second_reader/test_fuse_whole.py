"""Whom a numbered report is believed: rules or model, field by field, and what becomes of the roads."""

from functools import partial

import pytest
from hypothesis import given
from hypothesis import strategies as st

from sgcad_core.case.records import CrashReport
from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.reading import Reading, read
from sgcad_core.reading.second_reader.answered_values import TakenValue, facts_of, model_claims
from sgcad_core.reading.second_reader.field_claims import KINDS, UNKNOWN_P, Claim, departures_past_the_road, rules_claim
from sgcad_core.reading.second_reader.fuse_whole import SURE, agree, decided, fused_with_answer, same
from sgcad_core.records.second_reader import Answered, Opinion, Weights
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, Leg, RoadLayout
from sgcad_core.roads.layout import road_spec

TEXT = (
    "V1 was traveling north on a two-lane, two-way road. V2 was traveling south on the same road. The front of V1 "
    "struck the front of V2."
)
OPEN = TEXT.replace("traveling north on", "traveling on")
"""The heading of V1 is inferred."""
THIN = "V1 met V2. Both vehicles were towed after the crash."
BELIEVED = {kind: Weights(differ=9.0, slope=0.0, agree=None) for kind in KINDS}
KNOWN = {"road.legs[]": 1.0}
"""Probabilities of a model that gives some: what it had no choice about is sure."""
UNHEARD = {kind: Weights(differ=-9.0, slope=0.0, agree=None) for kind in KINDS}


def legs(*some: Leg) -> RoadLayout:
    return RoadLayout(legs=some)


ROAD = legs(Leg(bearing="N", lanes_in=1, lanes_out=1), Leg(bearing="S", lanes_in=1, lanes_out=1))


def answered(layout: RoadLayout = ROAD, p: dict[str, float] | None = None, **v1: object) -> Answered:
    given_ = {"kind": "car", "road": "S", "maneuver": "straight"} | v1
    behavior = BehaviorSpec(
        actors=(
            Actor(id="V1", direction="forward", **given_),  # type: ignore[arg-type]
            Actor(id="V2", kind="car", road="N", direction="forward", maneuver="straight"),
        ),
        contacts=(Contact(striker="V1", struck="V2", striker_area="front", struck_area="front"),),
    )
    return Answered(layout=layout, behavior=behavior, p=KNOWN | (p or {}))


def told(text: str, said: Answered, weights: dict[str, Weights] = BELIEVED) -> Reading:
    return fused_with_answer(read(text), Opinion(answered=said, weights=weights))


def test_where_both_agree_nothing_changes() -> None:
    reading = read(TEXT)
    said = answered(maneuver="crossing_centerline")
    assert fused_with_answer(reading, Opinion(answered=said, weights=BELIEVED)) is reading


def test_a_believed_value_is_taken_and_is_a_fact_of_the_model() -> None:
    found = told(TEXT, answered(maneuver="turn_left", kind="bus", speed_mph=30))
    one = found.crash.vehicle("V1")
    assert one is not None
    assert (one.maneuver, one.kind, one.speed_mph) == ("turn_left", "bus", 30)
    facts = {fact.field: fact for fact in found.facts if fact.basis == "model"}
    assert facts["vehicles.V1.maneuver"].value == "turn_left"
    assert sum(fact.field == "vehicles.V1.maneuver" for fact in found.facts) == 1, "one value, one fact"
    assert found.roads.crash is found.crash


def test_a_claim_of_several_values_is_told_as_far_as_the_least_of_those_with_a_head() -> None:
    told_ = {"road.legs[0].bearing": 0.9, "road.legs[1].bearing": 0.7}
    claims = model_claims(answered().model_copy(update={"told": told_}))
    assert claims["legs"].told == 0.7, "the length of the list has no head"
    assert claims["lanes.N"].told == UNKNOWN_P


@pytest.mark.parametrize(("share", "status"), [(0.9, "stated"), (0.2, "inferred")])
def test_a_taken_value_is_a_guess_unless_the_evidence_tells_it(share: float, status: str) -> None:
    path = "crash.actors[0].maneuver"
    said = answered(maneuver="turn_left").model_copy(update={"told": {path: share}, "nats": {path: 1.25}})
    (fact,) = (fact for fact in told(TEXT, said).facts if fact.field == "vehicles.V1.maneuver")
    assert (fact.basis, fact.status, fact.nats) == ("model", status, 1.25)


def test_a_value_that_is_not_believed_is_left() -> None:
    reading = read(TEXT)
    said = answered(maneuver="turn_left", kind="bus")
    assert fused_with_answer(reading, Opinion(answered=said, weights=UNHEARD)) is reading
    assert fused_with_answer(reading, Opinion(answered=said, weights={})) is reading, (
        "kinds without weights are the rules'"
    )


def test_what_the_text_tells_outright_weighs() -> None:
    stubborn = {"maneuver": Weights(differ=1.0, slope=0.0, told=-3.0, agree=None)}
    rules = rules_claim(read(TEXT + " V1 was turning right."))
    said = answered(maneuver="turn_left")
    assert "maneuver.V1" not in decided(rules, model_claims(said), stubborn, 0.5)
    untold = {key: claim._replace(told=False) for key, claim in rules.items()}
    assert decided(untold, model_claims(said), stubborn, 0.5)["maneuver.V1"].value == "turn_left"


def test_lane_and_way_out_of_a_vehicle_on_another_way_are_not_taken() -> None:
    said = answered(lane=1, exit_road="S", road="N")  # the model has V1 come from the north
    believed = {kind: BELIEVED[kind] for kind in ("lane", "exit")}
    assert fused_with_answer(read(OPEN), Opinion(answered=said, weights=believed)) == read(OPEN)
    with_heading = told(OPEN, said, believed | {"heading": BELIEVED["heading"]}).crash.vehicle("V1")
    assert with_heading is not None
    assert (with_heading.heading, with_heading.exit_heading) == ("S", "S")


def test_a_told_heading_stays_whatever_the_model_believes() -> None:
    one = told(TEXT, answered(road="N", maneuver="turn_left")).crash.vehicle("V1")
    assert one is not None
    assert (one.heading, one.heading_stated, one.maneuver) == ("N", True, "turn_left")


def test_taken_values_are_facts_by_the_names_of_the_rules() -> None:
    tee = legs(*ROAD.legs, Leg(bearing="E", lanes_in=2, lanes_out=1, turns_in=("right", "left"), control="stop"))
    found = {fact.field: fact.value for fact in told(TEXT, answered(tee, kind="bus")).facts if fact.basis == "model"}
    assert found["junction.legs"] == ("E", "N", "S")
    assert (found["junction.control"], found["junction.stopped"]) == ("stop", ("E",))
    assert (found["roads.E.lanes_forward"], found["roads.E.lanes_backward"]) == (2, 1)
    assert found["roads.E.turn_lanes"] == ("right", "left")
    assert found["vehicles.V1.kind"] == "bus"


def test_facts_of_a_contact_name_who_and_with_which_side() -> None:
    crash = read(TEXT).crash
    one = partial(TakenValue, p=0.9, told=0.9, nats=1.0)
    found = [*facts_of("contact", one(("V2", "V1")), crash), *facts_of("areas", one((("V1", "left"),)), crash)]
    assert [(fact.field, fact.value) for fact in found] == [
        ("contacts.0.striker", "V2"), ("contacts.0.struck", "V1"), ("contacts.0.striker_area", "left"),
    ]  # fmt: skip
    assert [fact.field for fact in facts_of("weather", one("rain"), crash)] == ["conditions.weather"]
    assert [(f.field, f.value) for f in facts_of("curve.N", one(()), crash)] == [("roads.N.curve", "none")]
    assert [(f.field, f.value) for f in facts_of("limit.N", one(35), crash)] == [("roads.N.speed_limit_mph", 35)]
    assert [(f.field, f.value) for f in facts_of("control", one(()), crash)] == [("junction.control", "none")]


def test_lanes_of_the_answer_become_the_road() -> None:
    wide = legs(Leg(bearing="N", lanes_in=3, lanes_out=2), Leg(bearing="S", lanes_in=2, lanes_out=3))
    layout = layout_of_facts(told(TEXT, answered(wide)).roads)
    assert {leg.bearing: (leg.lanes_in, leg.lanes_out) for leg in layout.legs} == {"N": (3, 2), "S": (2, 3)}


UNCOUNTED = "V1 was traveling north. V2 was traveling south. The front of V1 struck the front of V2."
WIDE = legs(Leg(bearing="N", lanes_in=2, lanes_out=2), Leg(bearing="S", lanes_in=2, lanes_out=2))


@pytest.mark.parametrize("lane", [1, 2])
def test_on_a_road_that_the_model_lays_it_also_says_who_drives_in_which_lane(lane: int) -> None:
    assert rules_claim(read(UNCOUNTED))["lane.V1"][:2] == (1, False), "of the one lane that the rules assume"
    found = told(UNCOUNTED, answered(WIDE, lane=lane))
    driver = found.crash.vehicle("V1")
    assert driver is not None
    assert driver.lane == lane
    assert [(f.value, f.basis) for f in found.facts if f.field == "vehicles.V1.lane"] == [(lane, "model")]


def test_who_is_taken_for_driving_another_way_gets_the_models_lane_there() -> None:
    untold = UNCOUNTED.replace("V1 was traveling north", "V1 was traveling on a road")
    found = told(untold, answered(legs(*WIDE.legs, Leg(bearing="W", lanes_in=2, lanes_out=2)), road="W", lane=2))
    driver = found.crash.vehicle("V1")
    assert driver is not None
    assert (driver.heading, driver.lane) == ("E", 2)


@pytest.mark.parametrize(
    ("text", "weights"),
    [
        (UNCOUNTED, BELIEVED | {"lanes": UNHEARD["lanes"]}),  # the rules' road stays
        (UNCOUNTED, BELIEVED | {"lane": UNHEARD["lane"]}),
        (UNCOUNTED.replace("traveling north", "traveling north in the right lane"), BELIEVED),
    ],
)
def test_a_lane_stays_where_the_road_does_the_lane_is_told_or_the_model_is_unsure(text, weights) -> None:
    before, found = read(text).crash.vehicle("V1"), told(text, answered(WIDE, lane=1), weights).crash.vehicle("V1")
    assert before is not None
    assert found is not None
    assert (found.lane, found.lane_word) == (before.lane, before.lane_word)


def test_a_junction_that_only_the_answer_has_is_drawn_and_the_told_lanes_stay() -> None:
    tee = legs(*ROAD.legs, Leg(bearing="E", lanes_in=2, lanes_out=1, control="stop"))
    only = {"legs": BELIEVED["legs"], "control": BELIEVED["control"]}
    found = told(TEXT, answered(tee), only)
    layout = {leg.bearing: leg for leg in layout_of_facts(found.roads).legs}
    assert (found.roads.junction.kind, found.roads.junction.stem) == ("t", "E")
    assert set(layout) == {"N", "S", "E"}
    assert (layout["N"].lanes_in, layout["E"].lanes_in, layout["E"].control) == (1, 2, "stop")


def test_legs_on_which_somebody_could_not_drive_are_not_taken() -> None:
    across = legs(Leg(bearing="E", lanes_in=1, lanes_out=1), Leg(bearing="W", lanes_in=1, lanes_out=1))
    only = {"legs": BELIEVED["legs"]}
    assert told(TEXT, answered(across), only).roads.answered is None


def test_lanes_beside_a_ramp_are_the_rules_since_the_model_knows_no_acceleration_lane() -> None:
    text = (
        "V1 was traveling north in the right lane of a six-lane highway with three lanes in each direction. V2 was "
        "merging from the on-ramp. The front of V2 struck the right side of V1."
    )
    before = read(text)
    assert before.roads.junction.kind == "ramp"
    wide = legs(Leg(bearing="N", lanes_in=2, lanes_out=2), Leg(bearing="S", lanes_in=2, lanes_out=2))
    said = answered(wide)
    assert "lanes.N" in decided(rules_claim(before), model_claims(said), {"lanes": BELIEVED["lanes"]}, 0.5)
    assert told(text, said, {"lanes": BELIEVED["lanes"]}).roads == before.roads


@pytest.mark.parametrize(
    ("text", "key", "value"),
    [
        ("The right front corner of V1 struck the front of V2.", "areas", (("V1", "front"), ("V2", "front"))),
        ("V1 swerved left to avoid V2. The front of V1 struck V2.", "maneuver.V1", "lane_change_left"),
        ("V1 swerved right to avoid V2. The front of V1 struck V2.", "maneuver.V1", "departing_road_right"),
    ],
)
def test_what_the_rules_read_may_allow_the_models_value_as_well(text: str, key: str, value: object) -> None:
    roads = "V1 was traveling north on a two-lane road. V2 was traveling south on the same road. "
    rules = rules_claim(read(roads + text))
    assert agree(key, rules[key], Claim(value))
    assert not agree(key, rules[key], Claim("backing"))


def test_a_lane_on_an_edge_is_the_same_however_many_lanes_a_reader_sees() -> None:
    text = "V1 was traveling north in the left lane of a six-lane road. V2 was traveling south on the same road. "
    rules = rules_claim(read(text + "The front of V1 struck the front of V2."))["lane.V1"]
    two = legs(Leg(bearing="N", lanes_in=2, lanes_out=2), Leg(bearing="S", lanes_in=2, lanes_out=2))
    said = {lane: model_claims(answered(two, lane=lane))["lane.V1"] for lane in (1, 2)}
    assert rules.value == 3
    assert agree("lane.V1", rules, said[2])
    assert not agree("lane.V1", rules, said[1])
    counted = rules._replace(also=())  # "the third lane": a number
    assert not agree("lane.V1", counted, said[2])


def test_lanes_agree_by_the_legs_that_both_have() -> None:
    ours = Claim((("N", 1, 2), ("S", 2, 1)))
    assert agree("lanes.N", ours, Claim((("S", 2, 1),)))
    assert not agree("lanes.N", ours, Claim((("S", 2, 2),)))
    assert not agree("lanes.N", ours, Claim(()))


def test_a_heading_that_follows_from_a_told_turn_is_told() -> None:
    turned_ = "V1 was traveling north on a two-lane road. V2 pulled out of a parking lot and turned right onto the "
    rules = rules_claim(read(turned_ + "northbound lane. The front of V1 struck the left side of V2."))
    assert rules["heading.V2"][:2] == ("W", True)


def test_no_road_gets_fewer_lanes_than_the_text_counts() -> None:
    text = TEXT.replace("two-lane, two-way road", "four-lane, two-way road")
    layouts = {n: legs(*(Leg(bearing=b, lanes_in=n, lanes_out=n) for b in ("N", "S"))) for n in (1, 3)}  # type: ignore[arg-type]
    only = {"lanes": BELIEVED["lanes"]}
    assert told(text, answered(layouts[1]), only).roads == read(text).roads
    found = layout_of_facts(told(text, answered(layouts[3]), only).roads)
    assert {leg.lanes_in for leg in found.legs} == {3}, "there may be more: turn lanes"


def test_a_named_turn_lane_stays() -> None:
    text = (
        "The crash occurred at a four-leg intersection. The north/south road is a five-lane, two-way street with two "
        "lanes in each direction and a northbound left-turn lane; the east/west road is a two-lane, two-way street. V1 "
        "was traveling north. V2 was traveling south. The front of V1 struck the front of V2."
    )
    arms = (Leg(bearing="E", lanes_in=1, lanes_out=1), Leg(bearing="W", lanes_in=1, lanes_out=1))
    center = (Leg(bearing=b, lanes_in=2, lanes_out=2, center_turn_lane=True) for b in ("N", "S"))  # type: ignore[arg-type]
    only = {"lanes": BELIEVED["lanes"]}
    assert told(text, answered(legs(*center, *arms)), only).roads == read(text).roads


def test_told_lanes_stay_counted_where_the_answers_are_not_laid() -> None:
    arms = (Leg(bearing="E", lanes_in=1, lanes_out=1), Leg(bearing="W", lanes_in=1, lanes_out=1))
    north_alone = legs(*arms, Leg(bearing="N", lanes_in=3, lanes_out=3))
    whole_cross = legs(*north_alone.legs, Leg(bearing="S", lanes_in=3, lanes_out=3))
    only = {"lanes": BELIEVED["lanes"]}
    before = read(TEXT).roads.roads
    assert told(TEXT, answered(north_alone, road="E"), only).roads.roads == before, "V1 comes from the south"
    (north,) = told(TEXT, answered(whole_cross), only).roads.roads
    assert before[0].lanes.total == 2
    assert north.lanes.total is None, "laid, and no road across of which no leg is taken"


def test_what_the_evidence_tells_by_the_models_own_head_weighs() -> None:
    weights = {"maneuver": Weights(differ=0.0, slope=0.0, tells=1.0, agree=None)}
    rules = rules_claim(read(TEXT))
    for share, taken in ((0.02, False), (0.5, True), (0.98, True)):
        said = answered(maneuver="turn_left").model_copy(update={"told": {"crash.actors[0].maneuver": share}})
        claims = model_claims(said)
        assert claims["maneuver.V1"].told == share
        assert claims["heading.V1"].told == UNKNOWN_P, "no head says"
        assert ("maneuver.V1" in decided(rules, claims, weights, 0.5)) is taken


@pytest.mark.parametrize("place", ["a roundabout", "a parking lot"])
def test_places_that_the_model_has_not_learned_stay_as_told(place: str) -> None:
    reading = read(f"The crash occurred in {place}. {TEXT}")
    tee = legs(*ROAD.legs, Leg(bearing="E", lanes_in=2, lanes_out=1))
    assert (
        fused_with_answer(reading, Opinion(answered=answered(tee), weights=BELIEVED)).roads.junction
        == reading.roads.junction
    )


def test_another_first_contact_comes_first() -> None:
    text = TEXT + " V3 was stopped behind V2, facing south. V2 was pushed back and its back struck the front of V3."
    assert len(read(text).crash.contacts) > 1
    behavior = BehaviorSpec(
        actors=tuple(
            Actor(id=f"V{n}", kind="car", road="N", direction="forward", maneuver="straight") for n in (1, 2, 3)
        ),
        contacts=(Contact(striker="V3", struck="V2", striker_area="front", struck_area="back"),),
    )
    only = {key: BELIEVED[key] for key in ("contact", "areas")}
    found = told(text, Answered(layout=ROAD, behavior=behavior), only).crash.contacts
    assert (found[0].striker, found[0].struck, found[0].struck_area) == ("V3", "V2", "back")
    assert {frozenset((c.striker, c.struck)) for c in found} == {frozenset(("V1", "V2")), frozenset(("V2", "V3"))}


def test_a_contact_of_strangers_is_not_taken() -> None:
    behavior = answered(maneuver="crossing_centerline").behavior.model_copy(
        update={"contacts": (Contact(striker="V8", struck="V9", striker_area="front", struck_area="left"),)}
    )
    reading = read(TEXT)
    assert (
        fused_with_answer(reading, Opinion(answered=Answered(layout=ROAD, behavior=behavior), weights=BELIEVED))
        is reading
    )


def test_a_crash_that_the_rules_cannot_read_is_the_models_if_that_is_sure() -> None:
    assert read(THIN).crash.gap is not None
    found = told(THIN, answered(maneuver="backing"))
    assert found.crash.gap is None
    assert found.crash.contacts[0].areas_stated
    one = found.crash.vehicle("V1")
    assert one is not None
    assert one.maneuver == "backing"
    spec = road_spec(layout_of_facts(found.roads))
    assert behavior_of_facts(found.crash, spec).contacts[0].striker == "V1"


@pytest.mark.parametrize("path", ["crash.contacts[0].striker", "crash.contacts[0].struck_area", "crash.actors[1].road"])
def test_a_crash_that_nobody_can_read_stays_refused(path: str) -> None:
    found = told(THIN, answered(p={path: SURE - 0.05}))
    assert found.crash.gap is not None
    assert not [fact for fact in found.facts if fact.basis == "model"]


def test_no_gap_is_filled_where_no_crash_is_told() -> None:
    found = told("V1 and V2 were parked.", answered())
    assert found.crash.gap is not None


def test_unnumbered_reports_are_left_to_the_rules() -> None:
    reading = read("The AV was stopped when an SUV struck its rear bumper.")
    assert reading.crash.unnumbered
    assert fused_with_answer(reading, Opinion(answered=answered(), weights=BELIEVED)) is reading


def test_a_report_is_read_with_its_opinion() -> None:
    report = CrashReport(case="a", narrative=TEXT, opinion=Opinion(answered=answered(kind="bus"), weights=BELIEVED))
    one = report.reading.crash.vehicle("V1")
    assert one is not None
    assert one.kind == "bus"


def test_a_person_wins_over_the_model() -> None:
    from sgcad_core.reading.reading_with_edits import with_edits
    from sgcad_core.records.edits import Edit

    tee = legs(*ROAD.legs, Leg(bearing="E", lanes_in=2, lanes_out=1))
    found = told(TEXT, answered(tee, kind="bus"))
    assert found.roads.junction.kind == "t"
    said = [Edit(field="junction.kind", value="none"), Edit(field="vehicles.V1.kind", value="van")]
    mine = with_edits(found, said)
    one = mine.crash.vehicle("V1")
    assert one is not None
    assert one.kind == "van"
    assert len(layout_of_facts(mine.roads).legs) == 2


@given(st.integers(0, 60), st.integers(0, 60))
def test_speeds_are_the_same_to_one_mph(one: int, other: int) -> None:
    assert same("speed.V1", one, other) is (abs(one - other) <= 1)
    assert same("limit.N", one, other) is (one == other)


COMPASS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")


@given(
    st.lists(st.sampled_from(COMPASS), min_size=2, max_size=6, unique=True),
    st.sampled_from(COMPASS),
    st.sampled_from(["straight", "turn_left", "turn_right", "stopped", "backing", "lane_change_left"]),
)
def test_whatever_the_model_answers_a_road_comes_out_that_carries_everybody(ends, road, maneuver) -> None:
    layout = legs(*(Leg(bearing=end, lanes_in=1, lanes_out=1) for end in ends))
    found = told(TEXT, answered(layout, road=road, maneuver=maneuver))
    spec = road_spec(layout_of_facts(found.roads))
    assert {actor.id for actor in behavior_of_facts(found.crash, spec).actors} >= {"V1", "V2"}


@pytest.mark.parametrize(("text", "kept"), [
    ("V1 was northbound. The front of V1 struck a ladder in the roadway.", False),
    ("V1 was northbound. The front of V1 struck a pole.", True),
])  # fmt: skip
def test_what_lies_in_the_road_is_not_struck_beside_it(text: str, kept: bool) -> None:
    heard = {"maneuver.V1": Claim("departing_road_right")}
    assert departures_past_the_road(heard, read(text).crash) == (set() if kept else {"maneuver.V1"})
