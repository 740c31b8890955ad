"""Seeded random road networks: any layout that a report can tell, every field of it drawn."""

from __future__ import annotations

import random
from collections.abc import Iterator
from typing import Any, get_args

from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records import RoadNetwork
from sgcad_core.roads.layout import road_spec
from sgcad_core.specs import Access, Compass, Leg, Median, RoadLayout, RoadSpec, Turn

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
