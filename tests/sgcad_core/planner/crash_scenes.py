"""Crash scenes drawn at random as reports tell them: layouts, pairs of maneuvers, areas that occur with them.

`draw_scene(seed)` is deterministic. Networks are compiled once a process.
"""

from __future__ import annotations

import functools
import random
from collections.abc import Callable

from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import Access, Actor, BehaviorSpec, Contact, Leg, RoadLayout
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.roads.layout import road_spec

COMPASS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")
KINDS = ("car", "car", "car", "suv", "pickup", "van", "truck", "bus", "motorcycle")


def leg(bearing: str, lanes: int = 1, **more: object) -> Leg:
    return Leg.model_validate({"bearing": bearing, "lanes_in": lanes, "lanes_out": lanes, **more})


LAYOUTS: dict[str, RoadLayout] = {
    "four_leg": RoadLayout(legs=tuple(leg(b) for b in "NESW")),
    "four_leg_wide": RoadLayout(legs=(leg("N", 2), leg("E", 3), leg("S", 2), leg("W", 3))),
    "four_leg_mixed": RoadLayout(legs=(leg("N", 1), leg("E", 2), leg("S", 1), leg("W", 2))),
    "four_leg_turn_lanes": RoadLayout(
        legs=tuple(leg(b, 2, turns_in=("through_right", "left"), center_turn_lane=b in "EW") for b in "NESW")
    ),
    "four_leg_divided": RoadLayout(legs=(leg("N"), leg("E", 2, median="grass"), leg("S"), leg("W", 2, median="grass"))),
    "four_leg_rotated": RoadLayout(legs=tuple(leg(b) for b in ("NE", "SE", "SW", "NW"))),
    "tee": RoadLayout(legs=tuple(leg(b) for b in "ESW")),
    "tee_wide": RoadLayout(legs=(leg("N", 2), leg("E", 1), leg("S", 2))),
    "wye": RoadLayout(legs=tuple(leg(b) for b in ("N", "SE", "SW"))),
    "straight": RoadLayout(legs=(leg("N"), leg("S"))),
    "straight_wide": RoadLayout(legs=(leg("E", 2), leg("W", 2))),
    "freeway": RoadLayout(legs=(leg("N", 3, median="barrier"), leg("S", 3, median="barrier"))),
    "curve": RoadLayout(legs=(leg("E", 1, curve="left"), leg("W"))),
    "bend": RoadLayout(legs=(leg("N"), leg("SE"))),
    "driveway_right": RoadLayout(legs=(leg("N"), leg("S")), accesses=(Access(leg="S", side="right"),)),
    "driveway_left_wide": RoadLayout(legs=(leg("E", 2), leg("W", 2)), accesses=(Access(leg="W", side="left"),)),
    "driveways_at_junction": RoadLayout(legs=tuple(leg(b) for b in "NESW"), accesses=(Access(leg="S", side="both"),)),
}  # fmt: skip


@functools.cache
def network(name: str) -> LaneGraph:
    spec = road_spec(LAYOUTS[name])
    made = compile_network(plain_xml(spec), spec)
    assert made.net_xml is not None, made.log
    return parse_net(made.net_xml)


def turn(bearing: str, eighths: int) -> str:
    return COMPASS[(COMPASS.index(bearing) + eighths) % 8]


class Draw:
    """One random scene in the making."""

    def __init__(self, seed: int, layout: str | None = None) -> None:
        self.random = random.Random(seed)
        self.layout = layout or self.random.choice(list(LAYOUTS))
        self.legs = {item.bearing: item for item in LAYOUTS[self.layout].legs}

    def pick(self, *choices):
        return self.random.choice(choices)

    def actor(self, number: int, road: str, maneuver: str, exit_road: str | None = None, **more) -> Actor:
        lanes = self.legs[road].lanes_in if road in self.legs else 1
        stated = self.random.random() < 0.3 and maneuver not in ("turn_left", "turn_right")
        fields = {
            "id": f"V{number}", "kind": self.pick(*KINDS), "road": road, "direction": "forward", "maneuver": maneuver,
            "exit_road": exit_road, "lane": self.random.randint(1, lanes) if stated else None,
            "speed_mph": self.random.choice((25, 30, 35, 40, 45, 55)) if self.random.random() < 0.3 else None,
        }  # fmt: skip
        return Actor.model_validate(fields | more)

    def contact(self, striker: str, areas: tuple[str, str], struck: str) -> Contact:
        return Contact.model_validate(
            {"striker": striker, "struck": struck, "striker_area": areas[0], "struck_area": areas[1]}
        )

    def pair(self, first: Actor, second: Actor, *areas: tuple[str, str]) -> tuple[list[Actor], Contact]:
        return [first, second], self.contact(first.id, self.random.choice(areas), second.id)

    def opposite_legs(self) -> tuple[str, str] | None:
        found = [b for b in self.legs if turn(b, 4) in self.legs]
        return (b := self.random.choice(found), turn(b, 4)) if found else None


def crossing(d: Draw):
    """Two that cross straight on: the one from the left is struck on its right side, and so on."""
    own = [b for b in d.legs if turn(b, 2) in d.legs and turn(b, 4) in d.legs]
    if not own:
        return None
    road = d.random.choice(own)
    from_right = turn(road, -2)
    other = from_right if from_right in d.legs and d.random.random() < 0.5 else turn(road, 2)
    side = "right" if other == from_right else "left"
    face = "left" if side == "right" else "right"
    a, b = d.actor(1, road, d.pick("straight", "straight", "slowing")), d.actor(2, other, "straight")
    return d.pair(a, b, ("front", face), (side, "front"), (side, "front"), ("front", face), ("front", "front"))


def left_across(d: Draw):
    """A left turn across the path of one from ahead."""
    legs = d.opposite_legs()
    exits = [turn(legs[0], 2)] if legs and turn(legs[0], 2) in d.legs else []
    if not legs or not exits:
        return None
    a = d.actor(1, legs[0], "turn_left", exits[0])
    b = d.actor(2, legs[1], "straight")
    return d.pair(a, b, ("right", "front"), ("front", "front"), ("front", "left"), ("right", "front"))


def left_into(d: Draw):
    """A left turn out of a side road, into or across the path of one from the left or right."""
    starts = [b for b in d.legs if turn(b, 2) in d.legs and turn(b, -2) in d.legs]
    if not starts:
        return None
    road = d.random.choice(starts)
    a = d.actor(1, road, "turn_left", turn(road, 2))
    if d.random.random() < 0.6:
        b = d.actor(2, turn(road, 2), "straight")
        return d.pair(a, b, ("left", "front"), ("left", "front"), ("front", "right"), ("front", "front"))
    b = d.actor(2, turn(road, -2), "straight")
    return d.pair(a, b, ("right", "front"), ("front", "left"), ("front", "front"))


def right_into(d: Draw):
    """A right turn into the path of one from the left."""
    starts = [b for b in d.legs if turn(b, 2) in d.legs and turn(b, -2) in d.legs]
    if not starts:
        return None
    road = d.random.choice(starts)
    a = d.actor(1, road, "turn_right", turn(road, -2))
    b = d.actor(2, turn(road, 2), "straight")
    return d.pair(a, b, ("left", "front"), ("left", "front"), ("front", "right"), ("back", "front"))


def rear_end(d: Draw):
    road = d.random.choice(list(d.legs))
    a = d.actor(1, road, d.pick("straight", "straight", "slowing"))
    b = d.actor(2, road, d.pick("stopped", "stopped", "slowing", "straight"), lane=a.lane)
    return d.pair(a, b, ("front", "back"))


def head_on(d: Draw):
    legs = d.opposite_legs()
    if not legs or "divided" in d.layout or d.layout == "freeway":
        return None
    a = d.actor(1, legs[0], d.pick("crossing_centerline", "crossing_centerline", "overtaking"))
    b = d.actor(2, legs[1], d.pick("straight", "negotiating_curve"))
    return d.pair(a, b, ("front", "front"), ("front", "front"), ("left", "left"), ("right", "front"), ("left", "front"))


def side_swipe(d: Draw):
    road = d.random.choice(list(d.legs))
    lanes = d.legs[road].lanes_in
    if lanes < 2:  # a lane change needs both lanes on its carriageway
        return None
    way = d.pick("left", "right")
    lane = d.random.randint(1, lanes - 1)
    a = d.actor(1, road, f"lane_change_{way}", lane=lane + (way == "right"))
    b = d.actor(2, road, "straight", lane=lane + (way == "left"))
    other = "right" if way == "left" else "left"
    return d.pair(a, b, (way, other), (way, other), ("front", other))


def parked(d: Draw):
    road = d.random.choice(list(d.legs))
    a = d.actor(1, road, d.pick("straight", "departing_road_right"))
    b = d.actor(2, road, "parked")
    return d.pair(a, b, ("front", "back"), ("right", "left"), ("front", "left"))


def backing(d: Draw):
    road = d.random.choice(list(d.legs))
    a = d.actor(1, road, "backing", speed_mph=None)
    b = d.actor(2, road, d.pick("straight", "stopped"), lane=a.lane)
    return d.pair(a, b, ("back", "front"))


def u_turn(d: Draw):
    road = d.random.choice(list(d.legs))
    a = d.actor(1, road, "u_turn", lane=None)
    b = d.actor(2, road, "straight")
    return d.pair(a, b, ("left", "front"), ("front", "right"))


def walker(d: Draw):
    road = d.random.choice(list(d.legs))
    a = d.actor(1, road, "straight")
    if d.random.random() < 0.5:
        b = d.actor(2, road, d.pick("straight", "stopped"), id="P1", kind="pedestrian", lane=None, speed_mph=None)
        return d.pair(a, b, ("front", "left"), ("front", "right"), ("front", "back"))
    b = d.actor(2, road, "straight", id="B1", kind="bicycle", lane=None, speed_mph=10)
    return d.pair(a, b, ("front", "back"), ("right", "left"))


def off_road(d: Draw):
    road = d.random.choice(list(d.legs))
    a = d.actor(1, road, d.pick("departing_road_right", "departing_road_left"))
    b = d.actor(2, road, "stopped", id="O1", kind="object", lane=None, speed_mph=None)
    return d.pair(a, b, ("front", "front"), ("left", "front"), ("right", "front"))


def driveway(d: Draw):
    accesses = LAYOUTS[d.layout].accesses
    if not accesses:
        return None
    access = accesses[0]
    side = "right" if access.side == "both" else access.side
    own, outer = f"{access.leg}_access_{side}", f"{access.leg}_outer"
    turning = d.pick("turn_left", "turn_right")
    into_leg = (turning == "turn_left") == (side == "right")
    b = d.actor(2, outer, "straight")
    if d.random.random() < 0.5:
        a = d.actor(1, own, turning, outer if into_leg else access.leg)
        areas = ("left", "front") if side == "right" else ("right", "front")
        return d.pair(a, b, areas, ("front", "right" if side == "right" else "left"))
    if side == "left":
        a = d.actor(1, access.leg, "turn_right", own, direction="backward")
        return d.pair(a, d.actor(2, access.leg, "straight", direction="backward"), ("back", "front"))
    a = d.actor(1, access.leg, "turn_left", own, direction="backward")
    return d.pair(a, b, ("right", "front"), ("front", "left"), ("front", "front"))


CATEGORIES: dict[str, tuple[Callable[[Draw], tuple[list[Actor], Contact] | None], int]] = {
    "crossing": (crossing, 6), "left_across": (left_across, 5), "left_into": (left_into, 5),
    "right_into": (right_into, 2), "rear_end": (rear_end, 4), "head_on": (head_on, 4), "side_swipe": (side_swipe, 3),
    "parked": (parked, 1), "backing": (backing, 1), "u_turn": (u_turn, 1), "walker": (walker, 2),
    "off_road": (off_road, 2), "driveway": (driveway, 4),
}  # fmt: skip


def draw_scene(seed: int) -> tuple[str, str, BehaviorSpec]:
    """(category, layout name, behavior); one or two more actors in a third of the scenes."""
    names = [name for name, (_, weight) in CATEGORIES.items() for _ in range(weight)]
    for attempt in range(1000):
        d = Draw(seed * 1000 + attempt)
        name = d.random.choice(names)
        found = CATEGORIES[name][0](d)
        if found is not None:
            actors, contact = found
            return name, d.layout, BehaviorSpec(actors=tuple(actors + _others(d)), contacts=(contact,))
    raise AssertionError(f"no scene for seed {seed}")


def _others(d: Draw) -> list[Actor]:
    count = d.random.choice((0, 0, 0, 0, 1, 1, 2))
    return [
        d.actor(
            3 + i, d.random.choice(list(d.legs)), d.pick("straight", "stopped", "turn_left", "turn_right", "slowing")
        )
        for i in range(count)
    ]
