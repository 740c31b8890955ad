"""Seeded random road networks and crashes on them: any layout that a report can tell, every field of it drawn."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any, get_args

from sgcad_core.case.records import RoadNetwork, Scenario
from sgcad_core.errors import InvalidOutput
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.openscenario.writing.versions import Encoding
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import (
    Access,
    Actor,
    Area,
    BehaviorSpec,
    Compass,
    Contact,
    Leg,
    Median,
    RoadLayout,
    RoadSpec,
    Turn,
)
from sgcad_core.roads.layout import road_spec

MANEUVERS = ("straight", "straight", "turn_left", "turn_right", "stopped", "lane_change_left", "lane_change_right",
             "crossing_centerline", "slowing", "backing", "negotiating_curve")  # fmt: skip
KINDS = ("car", "car", "suv", "pickup", "van", "truck", "bus", "motorcycle")
CONTROLS = ("none", "signal", "flashing", "stop", "yield")


def random_layout(seed: int) -> RoadSpec:
    """The spec of a random layout: two to five legs, up to two accesses."""
    r = random.Random(seed)
    bearings = r.sample(get_args(Compass), r.choice([2, 3, 3, 4, 4, 4, 5]))
    control = r.choice(CONTROLS)
    legs = tuple(_leg(r, bearing, control) for bearing in bearings)
    accesses = tuple(_access(r, r.choice(bearings)) for _ in range(r.choice([0, 0, 0, 1, 2])))
    return road_spec(RoadLayout(legs=legs, accesses=accesses))


def _leg(r: random.Random, bearing: Compass, control: str) -> Leg:
    ways = r.choice([(1, 1), (1, 1), (2, 2), (2, 1), (3, 2), (3, 3), (4, 4), (1, 0), (0, 2), (2, 0)])
    fields: dict[str, Any] = {
        "bearing": bearing, "lanes_in": ways[0], "lanes_out": ways[1], "control": r.choice([control, control, "none"]),
        "center_turn_lane": r.random() < 0.15, "median": r.choice((*["none"] * 4, *get_args(Median))),
        "kind": r.choice(["road"] * 6 + ["driveway", "ramp"]), "curve": r.choice(["none"] * 4 + ["left", "right"]),
        "speed_limit_mph": r.choice([None, None, 25, 35, 45, 55, 65]),
    }  # fmt: skip
    if ways[0] and r.random() < 0.25:
        fields["turns_in"] = tuple(r.choice(get_args(Turn)) for _ in range(ways[0]))
    return Leg(**fields)


def _access(r: random.Random, leg: Compass) -> Access:
    return Access(
        leg=leg, side=r.choice(["left", "right", "both"]), distance_m=r.choice([20, 40, 80, 120]),
        kind=r.choice(["driveway", "driveway", "road"]), control=r.choice(["none", "stop", "yield", "signal"]),
    )  # fmt: skip


def random_networks(count: int, first: int = 0) -> Iterator[tuple[str, RoadNetwork]]:
    """(name, network) of so many seeds; one that does not compile has net_xml None and its log says why."""
    for seed in range(first, first + count):
        spec = random_layout(seed)
        yield f"random-{seed}", compile_network(plain_xml(spec), spec)


def random_behavior(seed: int, spec: RoadSpec) -> BehaviorSpec:
    """Two vehicles that start on roads with lanes for them, and a contact between them."""
    r = random.Random(seed)
    starts = [
        (road.id, direction)
        for road in spec.roads
        for direction, lanes in (("forward", road.lanes_forward), ("backward", road.lanes_backward))
        if lanes
    ]
    actors = [_actor(r, f"V{n}", r.choice(starts)) for n in (1, 2)]
    areas = [r.choice(get_args(Area)) for _ in range(2)]
    contact = Contact(striker="V1", struck="V2", striker_area=areas[0], struck_area=areas[1])
    return BehaviorSpec(actors=tuple(actors), contacts=(contact,))


def _actor(r: random.Random, name: str, start: tuple[str, Any]) -> Actor:
    return Actor(
        id=name, kind=r.choice(KINDS), road=start[0], direction=start[1], maneuver=r.choice(MANEUVERS),
        speed_mph=r.choice([None, None, 15, 30, 45, 60]),
    )  # fmt: skip


def random_crashes(count: int, encoding: Encoding = "timed") -> Iterator[tuple[str, RoadNetwork, Scenario | str]]:
    """(name, network, scenario) on as many random maps; what cannot be planned has the planner's words instead."""
    for seed, (name, network) in enumerate(random_networks(count)):
        if network.net_xml is None or network.spec is None:
            yield name, network, f"no network: {network.log[-200:]}"
            continue
        try:
            yield name, network, compile_scenario(random_behavior(seed, network.spec), network, encoding=encoding)
        except InvalidOutput as fault:
            yield name, network, str(fault)
