"""Findings only where a behavior contradicts what the text tells for sure."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from itertools import product
from typing import Any

import pytest

from plugins.validator.behavior_narrative import BehaviorNarrative
from sgcad_core.case.records import CrashReport, Evidence, Finding, RoadNetwork, Scenario
from sgcad_core.reading.behavior.behavior import behavior_of_facts
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import Access, Actor, BehaviorSpec, Leg, RoadLayout, RoadSpec
from sgcad_core.roads.layout import road_spec

SPEC = road_spec(RoadLayout(legs=tuple(Leg(bearing=b, lanes_in=1, lanes_out=1) for b in ("N", "E", "S", "W"))))
TEXT = (
    "V1 was traveling north. V2 was traveling south and turned left at the intersection. "
    "The front of V1 struck the right side of V2."
)
GOOD = behavior_of_facts(read(TEXT).crash, SPEC)


def _found(behavior: BehaviorSpec | None, text: str = TEXT, **fields: Any) -> list[Finding]:
    evidence = Evidence(report=CrashReport(case="x", narrative=text), network=RoadNetwork(spec=SPEC))
    return BehaviorNarrative(**fields).findings(Scenario(actors=(), behavior=behavior), evidence)


def _changed(index: int, **changes: Any) -> BehaviorSpec:
    actors = list(GOOD.actors)
    actors[index] = actors[index].model_copy(update=changes)
    return GOOD.model_copy(update={"actors": tuple(actors)})


def _turning(actor: Actor) -> Actor:
    return actor.model_copy(update={"maneuver": "turn_right", "exit_road": "E"})


def _contact(**changes: Any) -> BehaviorSpec:
    return GOOD.model_copy(update={"contacts": (GOOD.contacts[0].model_copy(update=changes),)})


def test_what_the_text_says_passes() -> None:
    assert _found(GOOD) == []


def test_a_missing_and_an_invented_vehicle_are_named() -> None:
    assert [f.what for f in _found(_changed(1, id="V3"))][:2] == [
        "the report's vehicle V2 is missing",
        "the report numbers no such vehicle",
    ]


def test_a_wrong_heading_names_the_ways_that_fit() -> None:
    (finding,) = _found(_changed(0, road="E"))
    assert "first travels W, but the report says N" in finding.what
    assert finding.remedy == "start it on S forward or N backward"


@pytest.mark.parametrize(("road", "direction", "fine"), [("E", "forward", True), ("E", "backward", True),
                                                        ("S", "forward", False)])  # fmt: skip
def test_who_backs_may_face_along_its_way_or_go_along_it_tail_first(road: str, direction: str, fine: bool) -> None:
    text = "The AV was going north. A van facing east reversed, and the rear of the van hit the right side of the AV."
    written = behavior_of_facts(read(text).crash, SPEC)
    van = written.actors[1].model_copy(update={"road": road, "direction": direction, "exit_road": None})
    found = _found(written.model_copy(update={"actors": (written.actors[0], van)}), text)
    assert (not any("first travels" in f.what for f in found)) == fine


@pytest.mark.parametrize("maneuver", ["turn_right", "straight", "stopped"])
def test_another_maneuver_than_the_told_turn_is_asked_again(maneuver: str) -> None:
    (finding,) = _found(_changed(1, maneuver=maneuver))
    assert (finding.severity, finding.value, finding.remedy) == ("question", maneuver, "use turn_left")


def test_slowing_instead_of_stopped_is_no_contradiction() -> None:
    text = "V1 was northbound. V2 was stopped ahead of V1. V1 struck the rear of V2."
    good = behavior_of_facts(read(text).crash, SPEC)
    second = good.actors[1].model_copy(update={"maneuver": "slowing"})
    assert _found(good.model_copy(update={"actors": (good.actors[0], second)}), text) == []


def test_sides_that_the_text_names_are_asked_again_and_the_striker_may_stand_in_either_role() -> None:
    (finding,) = _found(_contact(struck_area="left"))
    assert (finding.severity, finding.where) == ("question", "contacts[0]")
    assert finding.remedy == "declare striker V1, struck V2: front of V1, right of V2"
    swapped = _contact(striker="V2", struck="V1", striker_area="right", struck_area="front")
    assert _found(swapped) == []


def test_a_corner_may_be_read_either_way() -> None:
    text = "V1 was northbound. V2 was eastbound. The front of V1 struck the left front of V2."
    good = behavior_of_facts(read(text).crash, SPEC)
    other = good.contacts[0].model_copy(update={"striker_area": "front", "struck_area": "front"})
    assert [f.severity for f in _found(good.model_copy(update={"contacts": (other,)}), text)] == ["doubt"]
    elsewhere = good.model_copy(update={"contacts": (other,), "actors": (_turning(good.actors[0]), good.actors[1])})
    assert "doubt" not in [f.severity for f in _found(elsewhere, text)]
    unheaded = text.replace("V2 was eastbound", "V2 was there")
    behavior = behavior_of_facts(read(unheaded).crash, SPEC)
    swapped = {"front": "left", "left": "front"}[behavior.contacts[0].struck_area]
    changed = behavior.contacts[0].model_copy(update={"struck_area": swapped})
    assert [f.severity for f in _found(behavior.model_copy(update={"contacts": (changed,)}), unheaded)] == ["note"]


def test_a_contact_that_is_not_declared_is_asked_for() -> None:
    (finding,) = _found(GOOD.model_copy(update={"contacts": ()}))
    assert finding.what == "the report tells a contact, but none is declared"


def test_severities_are_configuration() -> None:
    assert [f.severity for f in _found(_changed(1, maneuver="straight"), maneuvers="note")] == ["note"]
    assert [f.severity for f in _found(_contact(struck_area="left"), areas="note")] == ["note"]


@pytest.mark.parametrize("text", ["Nothing was numbered here.", ""])
def test_a_text_without_vehicles_judges_nothing(text: str) -> None:
    assert _found(GOOD, text) == []


def test_other_artifacts_are_passed_over() -> None:
    assert _found(None) == []
    evidence = Evidence(report=CrashReport(case="x", narrative=TEXT))
    assert BehaviorNarrative().findings(RoadNetwork(), evidence) == []


def _held(actor: Actor, choice: Mapping[str, Sequence[Any]]) -> Iterator[Actor]:
    """The actor under every combination of what a choice allows."""
    for values in product(*choice.values()):
        yield actor.model_copy(update=dict(zip(choice, values, strict=True)))


@pytest.mark.parametrize(
    ("index", "wrong"),
    [
        (0, {"road": "E"}),
        (0, {"direction": "backward"}),
        (1, {"maneuver": "straight"}),
        (1, {"road": "S"}),
        (1, {"exit_road": "W"}),
    ],
)
def test_whatever_a_finding_holds_an_answer_to_passes(index: int, wrong: dict[str, str]) -> None:
    behavior = _changed(index, **wrong)
    found = [f for f in _found(behavior) if f.severity == "question"]
    holds = [hold for f in found for hold in f.holds]
    assert found
    assert holds
    for hold in holds:
        assert (hold.items, hold.key, hold.values) == ("actors", "id", (behavior.actors[index].id,))
        for choice in hold.either:
            for actor in _held(behavior.actors[index], choice):
                actors = tuple(actor if i == index else a for i, a in enumerate(behavior.actors))
                assert _found(behavior.model_copy(update={"actors": actors})) == []


def test_a_held_turn_leaves_by_a_road_on_that_side() -> None:
    (finding,) = _found(_changed(1, maneuver="straight"))
    starts = {(*choice["road"], *choice["direction"]): choice["exit_road"] for choice in finding.holds[0].either}
    assert starts == {("N", "forward"): ("E",)}


@pytest.mark.parametrize(("road", "exit_road", "leaves"), [("N", "W", "E"), ("N", "S", "E"), ("E", "N", "S")])
def test_a_turn_that_leaves_by_the_road_of_another_is_asked_again(road: str, exit_road: str, leaves: str) -> None:
    text = TEXT.replace("V2 was traveling south and turned", "V2 turned")
    (finding,) = _found(_changed(1, road=road, exit_road=exit_road), text)
    assert finding.severity == "question"
    assert finding.what == f"V2 would leave {road} by {exit_road}, which is no turn_left"
    assert finding.remedy == f"leave by {leaves}"
    starts = {choice["road"][0]: choice["exit_road"] for choice in finding.holds[0].either}
    assert starts == {"N": ("E",), "E": ("S",), "S": ("W",), "W": ("N",)}
    assert {choice["maneuver"] for choice in finding.holds[0].either} == {("turn_left",)}


def test_of_a_turn_that_no_text_tells_nobody_knows_what_is_wrong() -> None:
    text = "V1 was traveling north. V2 came out. The front of V1 struck the right side of V2."
    assert _found(_changed(1, exit_road="W"), text) == []


def _layout(*bearings: str, accesses: tuple[Access, ...] = (), **legs: Leg) -> RoadSpec:
    return road_spec(RoadLayout(
        legs=tuple(legs.get(b) or Leg(bearing=b, lanes_in=1, lanes_out=1) for b in bearings), accesses=accesses
    ))  # fmt: skip


@pytest.mark.parametrize(
    ("spec", "start", "exit_road"),
    [
        (_layout("N", "E", "S", "W", accesses=(Access(leg="N", side="right", distance_m=40),)), "N_outer", "E"),
        (_layout("N", "E", "S", "W", accesses=(Access(leg="E", side="right", distance_m=40),)), "N", "E_outer"),
        (_layout("N", "E", "S", "W", accesses=(Access(leg="S", side="left", distance_m=40),)), "N", "S_access_left"),
        (_layout("N", "E", "S", "W"), "N", "N"),
        (_layout("N", "E", "S", "W", E=Leg(bearing="E", lanes_in=1, lanes_out=0)), "N", "E"),
        (_layout("N", "S", "SE"), "N", "SE"),
    ],
)
def test_a_turn_further_on_or_the_wrong_way_is_not_judged_by_the_next_junction(
    spec: RoadSpec, start: str, exit_road: str
) -> None:
    evidence = Evidence(report=CrashReport(case="x", narrative=TEXT), network=RoadNetwork(spec=spec))
    behavior = _changed(1, road=start, exit_road=exit_road)
    assert {road.id for road in spec.roads} >= {start, exit_road}
    found = BehaviorNarrative().findings(Scenario(actors=(), behavior=behavior), evidence)
    assert [f for f in found if "which is no" in f.what] == []


def test_a_turn_without_an_exit_or_on_a_road_without_any_is_left_alone() -> None:
    assert _found(_changed(1, exit_road=None)) == []
    plain = road_spec(RoadLayout(legs=tuple(Leg(bearing=b, lanes_in=1, lanes_out=1) for b in ("N", "S"))))
    evidence = Evidence(report=CrashReport(case="x", narrative=TEXT), network=RoadNetwork(spec=plain))
    found = BehaviorNarrative().findings(Scenario(actors=(), behavior=_changed(1, exit_road="S")), evidence)
    assert [f for f in found if "which is no" in f.what] == []


def test_a_missing_vehicle_is_held_to_its_place_and_a_contact_to_the_first() -> None:
    missing, invented = _found(_changed(1, id="V3"))[:2]
    assert [(hold.at, hold.either[0]["id"]) for hold in missing.holds] == [(0, ("V1",)), (1, ("V2",))]
    assert "V3" not in invented.holds[0].either[0]["id"]
    (sides,) = _found(_contact(struck_area="left"))
    assert sides.holds[0].line() == "contacts[0]: striker V1, struck V2, striker_area front, struck_area right"


def test_a_start_is_held_where_the_road_has_no_such_turn() -> None:
    plain = road_spec(RoadLayout(legs=tuple(Leg(bearing=b, lanes_in=1, lanes_out=1) for b in ("N", "S"))))
    evidence = Evidence(report=CrashReport(case="x", narrative=TEXT), network=RoadNetwork(spec=plain))
    wrong = _changed(1, road="S", exit_road="N")
    found = BehaviorNarrative().findings(Scenario(actors=(), behavior=wrong), evidence)
    held = [hold for finding in found if finding.where == "V2.road" for hold in finding.holds]
    assert [hold.line() for hold in held] == ["actors with id V2: road N, direction forward, maneuver turn_left"]


def test_an_invented_vehicle_behind_the_numbered_ones_becomes_something_else() -> None:
    third = GOOD.actors[1].model_copy(update={"id": "V3"})
    behavior = GOOD.model_copy(update={"actors": (*GOOD.actors, third)})
    invented = next(f for f in _found(behavior) if f.what == "the report numbers no such vehicle")
    (hold,) = invented.holds
    assert hold.at == 2
    assert not {name for name in hold.either[0]["id"] if str(name).startswith("V")}


CORNER = TEXT.replace("the right side of V2", "the right front of V2")


@pytest.mark.parametrize(("side", "severity"), [
    ("right", None), ("front", "doubt"), ("left", "question"), ("back", "question"),
])  # fmt: skip
def test_a_corner_may_be_either_of_its_sides_and_no_other(side: str, severity: str | None) -> None:
    found = [f for f in _found(_contact(struck_area=side), CORNER) if "sides" in f.what]
    assert [f.severity for f in found] == ([severity] if severity else [])
    for finding in found:
        (hold,) = finding.holds
        assert set(hold.either[0]["struck_area"]) == ({"right"} if severity == "doubt" else {"right", "front"})
        assert hold.either[0]["striker_area"] == ("front",)


@pytest.mark.parametrize(("said", "may"), [
    ("the left rear of V2", {"left", "back"}), ("the rear of V2", {"back"}), ("V2", {"front", "left", "right", "back"}),
])  # fmt: skip
def test_facts_keep_which_sides_the_words_allow(said: str, may: set[str]) -> None:
    (contact,) = read(TEXT.replace("the right side of V2", said)).crash.contacts
    assert set(contact.struck_may if contact.struck == "V2" else contact.striker_may) == may


BEHIND = (
    "V1 was stopped on the roadway facing north. V2 was traveling in the same direction. "
    "The front of V2 struck the rear of V1."
)


@pytest.mark.parametrize(("text", "moved", "road"), [
    (BEHIND, 1, "S"), (BEHIND.replace("rear of V1", "right rear of V1"), 1, "S"),
    (BEHIND.replace("facing north", "in traffic"), 1, "S"),
    (BEHIND.replace("facing north", "in traffic").replace("in the same direction", "north"), 0, "S"),
])  # fmt: skip
def test_of_a_rear_end_crash_both_start_the_same_way(text: str, moved: int, road: str) -> None:
    def found(behavior: BehaviorSpec) -> list[Finding]:
        return [f for f in _found(behavior, text) if "head different ways" in f.what]

    right = behavior_of_facts(read(BEHIND).crash, SPEC)
    assert found(right) == []
    actors = list(right.actors)
    actors[moved] = actors[moved].model_copy(update={"road": "E"})
    (finding,) = found(right.model_copy(update={"actors": tuple(actors)}))
    assert finding.where == f"V{moved + 1}.road"
    (hold,) = finding.holds
    assert {choice["road"] for choice in hold.either} == {(road,)}


def test_one_that_turned_before_it_was_struck_from_behind_may_head_elsewhere() -> None:
    text = "V1 was northbound and turned left. V2 was westbound. The front of V2 struck the rear of V1."
    behavior = behavior_of_facts(read(text).crash, SPEC)
    assert not [f for f in _found(behavior, text) if "head different ways" in f.what]


TOLD = (
    "V1 was traveling north at 40 mph and changed lanes to the left. V2 was traveling north. "
    "The left side of V1 struck the right side of V2."
)


def test_a_told_speed_that_is_missing_or_far_off_is_a_question() -> None:
    told = behavior_of_facts(read(TOLD).crash, SPEC)
    for said, asked in ((None, True), (55, True), (37, False), (40, False)):
        actors = (told.actors[0].model_copy(update={"speed_mph": said}), *told.actors[1:])
        found = [f for f in _found(told.model_copy(update={"actors": actors}), TOLD) if f.where == "V1.speed_mph"]
        assert bool(found) is asked
        assert all(f.severity == "question" and f.told and f.told.value == 40 for f in found)


def test_every_told_maneuver_is_asked_about_unless_turns_alone_are_wanted() -> None:
    told = behavior_of_facts(read(TOLD).crash, SPEC)
    actors = (told.actors[0].model_copy(update={"maneuver": "straight"}), *told.actors[1:])
    wrong = told.model_copy(update={"actors": actors})
    assert "V1.maneuver" in {f.where for f in _found(wrong, TOLD) if f.severity == "question"}
    assert "V1.maneuver" not in {f.where for f in _found(wrong, TOLD, every=False)}
