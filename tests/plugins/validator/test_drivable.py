"""Motions that no driver can drive before a contact are doubted; what is driven, struck or told as lost is not."""

from __future__ import annotations

import numpy as np
import pytest

from plugins.validator.drivable import Drivable
from sgcad_core.case.records import CrashReport, Evidence, Finding, RoadNetwork, Scenario, Trajectory
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import Actor, ActorKind, BehaviorSpec, Contact, Leg, Maneuver, RoadLayout, Surface
from sgcad_core.roads.layout import road_spec

CROSSED = "V1 was traveling north. V2 was traveling west. They struck each other at the intersection."
SPUN = "V1 was traveling north and skidded. V2 was traveling west. They struck each other at the intersection."


def crossing() -> RoadNetwork:
    legs = tuple(Leg.model_validate({"bearing": b, "lanes_in": 1, "lanes_out": 1}) for b in "NESW")
    spec = road_spec(RoadLayout(legs=legs))
    return compile_network(plain_xml(spec), spec)


CROSS = crossing()


def actor(name: str, road: str, exit_road: str) -> Actor:
    return Actor.model_validate({
        "id": name, "kind": "car", "road": road, "direction": "forward", "maneuver": "straight", "exit_road": exit_road,
    })  # fmt: skip


def judged(scenario: Scenario | RoadNetwork, text: str = CROSSED, odd: str = "doubt") -> list[Finding]:
    evidence = Evidence(report=CrashReport(case="c", narrative=text), network=CROSS)
    return Drivable.model_validate({"odd": odd}).findings(scenario, evidence)


def crossed(sides: tuple[str, str]) -> Scenario:
    said = Contact.model_validate({"striker": "V1", "struck": "V2", "striker_area": sides[0], "struck_area": sides[1]})
    actors = (actor("V1", "S", "N"), actor("V2", "E", "W"))
    return compile_scenario(BehaviorSpec(actors=actors, contacts=(said,)), CROSS)


def circling(
    radius_m: float,
    speed_mps: float,
    *,
    faces_rad: float = 0.0,
    maneuver: Maneuver = "straight",
    kind: ActorKind = "car",
    surface: Surface | None = None,
) -> Scenario:
    """A lone actor on a circle whose rear axle is the center's (0.2 m long), turned against its way by `faces_rad`."""
    t = np.arange(0, 3, 0.05)
    angle = speed_mps * t / radius_m
    motion = Trajectory(
        actor="V1", t_s=t, x_m=radius_m * np.sin(angle), y_m=radius_m * (1 - np.cos(angle)),
        heading_rad=angle + faces_rad, speed_mps=np.full(len(t), speed_mps),
    )  # fmt: skip
    alone = actor("V1", "S", "N").model_copy(update={"length_m": 0.2, "maneuver": maneuver, "kind": kind})
    behavior = BehaviorSpec(actors=(alone,), surface=surface)
    return Scenario(actors=(), behavior=behavior, planned=(motion,))


def test_an_ordinary_crash_is_not_doubted_though_the_wreck_spins() -> None:
    assert judged(crossed(("front", "left"))) == []


def test_sides_that_only_a_slide_brings_together_are_doubted_by_vehicle() -> None:
    scenario = crossed(("back", "back"))
    found = judged(scenario)
    assert [f.where for f in found] == ["actor V1", "actor V2"]
    assert {f.severity for f in found} == {"doubt"}
    assert all("slip angle" in f.value and "of 10 degrees" in f.value for f in found)
    assert any("no steering explains" in note for note in scenario.notes)


def test_a_told_loss_of_control_explains_everything() -> None:
    assert judged(crossed(("back", "back")), SPUN) == []


def test_a_note_is_all_where_the_config_says_so() -> None:
    assert {f.severity for f in judged(crossed(("back", "back")), odd="note")} == {"note"}


@pytest.mark.parametrize(
    ("scenario", "word"),
    [
        (circling(20.0, 12.0), None),
        (circling(20.0, 14.0), "lateral acceleration"),
        (circling(20.0, 12.0, surface="wet"), "lateral acceleration"),
        (circling(4.0, 5.5), None),
        (circling(2.0, 3.5), "yaw rate"),
        (circling(200.0, 12.0, faces_rad=0.15), None),
        (circling(200.0, 12.0, faces_rad=0.2), "slip angle"),
        (circling(200.0, 12.0, faces_rad=np.pi), "slip angle"),
        (circling(200.0, 2.0, faces_rad=np.pi, maneuver="backing"), None),
        (circling(20.0, 14.0, kind="pedestrian"), None),
    ],
)
def test_each_limit_is_held_by_itself(scenario: Scenario, word: str | None) -> None:
    found = judged(scenario)
    assert [f.value.rsplit(" ", 4)[0] for f in found] == ([word] if word else [])


def test_roads_and_scenarios_without_a_plan_are_left_to_others() -> None:
    assert judged(CROSS) == []
    assert judged(Scenario(actors=(), routes_xml="<routes/>")) == []


def test_boxes_that_come_to_rest_in_each_other_are_doubted_whatever_is_told() -> None:
    scenario = crossed(("front", "left"))
    first, second = scenario.planned
    x, y = second.x_m.copy(), second.y_m.copy()
    x[-1], y[-1] = first.x_m[-1] + 1.0, first.y_m[-1]
    moved = scenario.model_copy(update={"planned": (first, second.model_copy(update={"x_m": x, "y_m": y}))})
    for text in (CROSSED, SPUN):
        assert [(f.what, f.where) for f in judged(moved, text)] == [("two boxes overlap at rest", "V1 and V2")]


@pytest.mark.parametrize(("firm", "falls", "doubted"), [(False, True, False), (False, False, True), (True, True, True)])
def test_a_vehicle_may_lie_over_what_it_knocked_down(firm: bool, falls: bool, doubted: bool) -> None:
    scenario = crossed(("front", "left"))
    behavior, rest = scenario.behavior, scenario.planned[0].pose[-1]
    assert behavior is not None
    bush = Actor.model_validate({
        "id": "O1", "kind": "object", "road": "S", "direction": "forward", "maneuver": "stopped", "firm": firm,
        "length_m": 1.0, "width_m": 1.0,
    })  # fmt: skip
    t = scenario.planned[0].t_s
    x = np.full(len(t), rest[0])
    x[0] += 20.0 if falls else 0.0
    y, still = np.full(len(t), rest[1]), np.zeros(len(t))
    lies = Trajectory(actor="O1", t_s=t, x_m=x, y_m=y, heading_rad=still, speed_mps=still)
    with_bush = scenario.model_copy(update={
        "planned": (*scenario.planned, lies),
        "behavior": behavior.model_copy(update={"actors": (*behavior.actors, bush)}),
    })  # fmt: skip
    found = [f.where for f in judged(with_bush) if f.what == "two boxes overlap at rest"]
    assert found == (["V1 and O1"] if doubted else [])


@pytest.mark.parametrize("rolls", [True, False])
def test_one_that_rolls_over_slides_before_it_and_is_not_driven(rolls: bool) -> None:
    scenario = crossed(("front", "left"))
    first, second = scenario.planned
    at = int(np.searchsorted(first.t_s, 2.0))
    heading, roll = first.heading_rad.copy(), np.zeros(len(first.t_s))
    heading[at:] += np.minimum(0.15 * np.arange(len(heading) - at), 1.2)
    roll[at + 15 :] = 0.5 if rolls else 0.0
    turned = first.model_copy(update={"heading_rad": heading, "roll_rad": roll})
    moved = scenario.model_copy(update={"planned": (turned, second)})
    driven = [f.where for f in judged(moved, CROSSED) if f.what != "two boxes overlap at rest"]
    assert ("actor V1" in driven) == (not rolls)
