"""What rules and a model claim of one crash, in the same terms."""

from sgcad_core.reading.reading import read
from sgcad_core.reading.second_reader.answered_values import model_claims
from sgcad_core.reading.second_reader.field_claims import KINDS, UNKNOWN_P, by_axis, kind_of, rules_claim
from sgcad_core.records.second_reader import Answered
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, Leg, RoadLayout

TEXT = (
    "The crash occurred at a four-leg intersection controlled by a traffic signal. The north/south road has two lanes "
    "in each direction and a posted speed limit of 35 mph. V1, a 2004 Honda Civic, was traveling north in the left "
    "lane. V2 was traveling south and turned left. The front of V1 struck the right side of V2. It was dark."
)
LAYOUT = RoadLayout(
    legs=(
        Leg(bearing="N", lanes_in=2, lanes_out=1, turns_in=("through_right", "left"), control="signal"),
        Leg(bearing="S", lanes_in=1, lanes_out=1, median="grass", speed_limit_mph=35),
        Leg(bearing="E", lanes_in=1, lanes_out=1, kind="driveway"),
    )
)
BEHAVIOR = BehaviorSpec(
    actors=(
        Actor(id="V1", kind="suv", road="S", direction="forward", exit_road="N", maneuver="straight", speed_mph=30),
        Actor(id="V2", kind="car", road="N_outer", direction="forward", lane=2, maneuver="turn_left"),
        Actor(id="O1", kind="object", road="N", direction="forward", maneuver="stopped"),
    ),
    contacts=(Contact(striker="V1", struck="V2", striker_area="front", struck_area="right"),),
    light="dark",
)


def test_rules_claim_what_is_told_and_what_they_assume_apart() -> None:
    found = rules_claim(read(TEXT))
    assert found["contact"][:2] == (("V1", "V2"), True)
    assert found["areas"].value == (("V1", "front"), ("V2", "right"))
    assert found["heading.V1"][:2] == ("N", True)
    assert found["maneuver.V2"][:2] == ("turn_left", True)
    assert found["lane.V1"][:2] == (2, True), "the left one of two"
    assert found["exit.V2"].value == "E"
    assert found["lanes.N"][:2] == ((("N", 2, 2), ("S", 2, 2)), True)
    assert found["lanes.E"].told is False
    assert found["limit.N"].value == 35
    assert {value for _, value in found["control"].value} == {"signal"}
    assert found["light"].value == "dark"
    assert "weather" not in found


def test_of_a_text_without_a_crash_the_rules_claim_no_contact() -> None:
    found = rules_claim(read("The weather was fine."))
    assert not {"contact", "areas"} & found.keys()


def test_a_model_claims_its_values_with_their_probabilities() -> None:
    p = {
        "crash.contacts[0].striker": 0.5, "crash.contacts[0].struck": 0.5, "crash.actors[0].road": 0.9,
        "road.legs[0].lanes_in": 0.7, "road.legs[1].lanes_in": 0.8, "road.legs[0].turns_in[1]": 0.6,
    }  # fmt: skip
    found = model_claims(Answered(layout=LAYOUT, behavior=BEHAVIOR, p=p))
    assert found["contact"].p == 0.25
    assert found["heading.V1"][:3] == ("N", UNKNOWN_P, 0.9)
    assert found["heading.V2"].value == "S", "the outer piece of a leg is that leg"
    assert found["exit.V1"].value == "N"
    assert "exit.V2" not in found
    assert "lane.V1" not in found
    assert "heading.O1" not in found
    assert found["lanes.N"][:3] == ((("N", 2, 1), ("S", 1, 1)), UNKNOWN_P, 0.7)
    assert found["turns.N"][:3] == ((("N", ("through", "left")),), UNKNOWN_P, 0.6)
    assert "lanes.E" not in found, "a driveway is no street"
    assert found["legs"].value == ("E", "N", "S")


def test_grounding_of_a_claim_is_that_of_all_its_values() -> None:
    nats = {"crash.contacts[0].striker": 1.5, "crash.contacts[0].struck": 0.5, "road.legs[0].lanes_in": -0.5}
    found = model_claims(Answered(layout=LAYOUT, behavior=BEHAVIOR, p={"road.legs[]": 1.0}, nats=nats))
    assert found["contact"].nats == 2.0
    assert found["lanes.N"].nats == -0.5
    assert found["heading.V1"].nats == 0.0


def test_without_probabilities_every_value_is_even() -> None:
    found = model_claims(Answered(layout=LAYOUT, behavior=BEHAVIOR))
    assert found["heading.V1"].p == 0.5
    assert found["contact"].p == 0.25


def test_every_field_is_of_a_kind_that_can_be_weighed() -> None:
    keys = rules_claim(read(TEXT)).keys() | model_claims(Answered(layout=LAYOUT, behavior=BEHAVIOR)).keys()
    assert {kind_of(key) for key in keys} <= set(KINDS)


def test_streets_go_by_axis() -> None:
    assert [(axis, [leg.bearing for leg in some]) for axis, some in by_axis(LAYOUT.legs)] == [("N", ["N", "S"])]


def test_a_told_corner_is_told_and_its_other_side_is_allowed_as_well() -> None:
    told = "V1 was traveling west. V2 was also traveling west ahead of V1. The right side of V1 struck the {} of V2."
    corner = rules_claim(read(told.format("left rear corner")))["areas"]
    assert corner.told
    assert {dict(sides)["V2"] for sides in (corner.value, *corner.also)} == {"back", "left"}
    untold = rules_claim(read("V1 was traveling west. V2 was traveling north. V1 and V2 collided."))
    assert not untold["areas"].told


def test_both_of_three_are_the_two_that_are_named_last() -> None:
    told = "V1, V2 and V3 were northbound. V1 struck V2, and V3 struck V1, and both were turning left."
    claims = rules_claim(read(told))
    assert {v: claims[f"maneuver.{v}"].value == "turn_left" for v in ("V1", "V2", "V3")} == {
        "V1": True, "V2": False, "V3": True,
    }  # fmt: skip


def test_a_sign_at_a_street_stops_those_who_come_to_it() -> None:
    told = (
        "V1 was traveling north on Elm Street. V2 was traveling east on Oak Street. V1 stopped at the stop sign at Oak "
        "Street and then drove on. The front of V1 struck the left side of V2."
    )
    assert dict(rules_claim(read(told))["control"].value).keys() == {"N", "S"}
