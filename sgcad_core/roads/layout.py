"""A road layout (hub, legs, accesses) drawn as a road network on the ground.

Pure geometry: every leg becomes a polyline from its end to the hub, every access a short road that joins
its leg at a node of its own. Ids are those promised by `RoadLayout`; a second joint on one leg gets a
number ("N_joint2", the piece between the joints "N_mid", a third "N_mid2"; a second access of one side
"N_access_left2"). Knows no SUMO, no OpenDRIVE and nothing of narratives.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import get_args

from sgcad_core.kinds import RAMP
from sgcad_core.records.specs import (
    Access,
    Compass,
    Leg,
    Node,
    NodeControl,
    Point,
    Road,
    RoadLayout,
    RoadSpec,
    is_aisle,
)
from sgcad_core.roads.circle import Mouth, Rim, circle_roads, node_of, rim_of
from sgcad_core.roads.road_geometry import LANE_M, MEDIAN_M, beside_m

HUB = "hub"
"""Id of the junction that a layout draws."""

COMPASS: tuple[Compass, ...] = get_args(Compass)
OUTER = "_outer"
"""Behind a leg's name: its piece beyond the last access."""
LEG_M = 240.0
"""Length of a leg: 8 s at 65 mph, so that every approach begins on the road."""
ARC_M = 120.0
"""A curved leg bends over this length from the hub; beyond, it runs straight."""
_LONGEST_M = {RAMP: ARC_M, "aisle": 80.0}
"""Length of short legs: a long ramp would meet the road that it joins, and aisles are short."""
ACCESS_M = 45.0
ACCESS_ROAD_M = 80.0
BEYOND_JOINT_M = 60.0
RADIUS_M = 350.0
"""Curve radius: 20 degrees a leg, so that oncoming vehicles on two curved legs still face each other."""
VIA_STEP_M = 15.0
RAMP_ANGLE = math.radians(28)
"""Between a ramp and the road it joins; sharper, and the lanes overlap over half of the ramp."""
CLEAR_OF_JUNCTION_M = 20.0
"""From the edge of a crossing road to a joint: room for the junction's corners and a car before it."""
BEYOND_RIM_M = 45.0
"""From the rim of a roundabout to a joint: behind the splitter island."""
JOINT_GAP_M = 16.0
"""Two joints on one leg stand at least this far apart, else they are one joint."""


def road_spec(layout: RoadLayout, leg_m: float = LEG_M) -> RoadSpec:
    """The network of a layout: hub at (0, 0), north up, legs of `leg_m` metres; ids as `RoadLayout` promises.

    Two legs make a plain road, whose hub is no junction. Of several legs with one bearing the first stands.
    A leg with an access far out is longer. A roundabout has a circle of nodes in place of the hub.
    """
    legs = tuple({leg.bearing: leg for leg in reversed(layout.legs)}.values())[::-1]
    mouths = [Mouth(leg.bearing, _angle(leg), _width(leg), "sidewalk" in leg.beside) for leg in legs]
    rim = rim_of(layout.circle_lanes, mouths) if layout.circle_lanes else None
    nodes, roads = circle_roads(rim, mouths) if rim else ([_hub(layout, legs)], [])
    for leg in legs:
        accesses = [a for a in layout.accesses if a.leg == leg.bearing]
        length_m = min(leg_m, _LONGEST_M.get("aisle" if is_aisle(leg) else leg.kind, leg_m))
        drawn = _LegDrawing(leg, _path(leg, legs, rim), _clearance(leg, legs, rim), _crowd(layout, leg), length_m, rim)
        leg_nodes, leg_roads = drawn.draw(accesses)
        nodes += leg_nodes
        roads += leg_roads
    return RoadSpec(nodes=tuple(nodes), roads=tuple(roads))


def _hub(layout: RoadLayout, legs: Sequence[Leg]) -> Node:
    opens = layout.opening and len(legs) == 2
    return Node(id=HUB, x_m=0, y_m=0, control=hub_control(legs), opening=opens)


def hub_control(legs: Sequence[Leg]) -> NodeControl:
    """The control of the hub: signal before flashing before stop before yield; none on a plain road.

    Legs without incoming lanes do not count.
    """
    seen = [leg.control for leg in legs if leg.lanes_in]
    if len(legs) < 3 or not seen:
        return "none"
    if seen.count("stop") == len(seen):
        return "all_way_stop"
    return next((c for c in ("signal", "flashing", "stop", "yield") if c in seen), "none")


# ------------------------------------------------------------------ lines
@dataclass(frozen=True)
class _Path:
    """The center line of a leg, measured outwards from the hub: an arc, then its tangent."""

    angle_rad: float
    turn_per_m: float
    straight_m: float = 0.0
    """It begins this far from the hub, and bends from there on."""

    def heading(self, s_m: float) -> float:
        """Outward direction, radians counter-clockwise from east."""
        return self.angle_rad + self.turn_per_m * min(max(s_m - self.straight_m, 0.0), ARC_M)

    def at(self, s_m: float) -> tuple[float, float]:
        """The point s_m metres from the hub along the line."""
        k = self.turn_per_m
        if not k:
            return s_m * math.cos(self.angle_rad), s_m * math.sin(self.angle_rad)
        a, b, beyond = self.angle_rad, self.heading(s_m), max(s_m - self.straight_m - ARC_M, 0.0)
        x, y = (math.sin(b) - math.sin(a)) / k, (math.cos(a) - math.cos(b)) / k
        x, y = x + self.straight_m * math.cos(a), y + self.straight_m * math.sin(a)
        return x + beyond * math.cos(b), y + beyond * math.sin(b)

    def between(self, outer_m: float, inner_m: float) -> tuple[Point, ...]:
        """Inner points of the piece from outer_m in to inner_m; none on a straight line."""
        if not self.turn_per_m:
            return ()
        count = max(1, round((outer_m - inner_m) / VIA_STEP_M))
        steps = [outer_m + (inner_m - outer_m) * i / count for i in range(1, count)]
        return tuple(_point(*self.at(s)) for s in steps)


def _point(x: float, y: float) -> Point:
    return Point(x_m=round(x, 2), y_m=round(y, 2))


def _node(name: str, place: tuple[float, float], control: NodeControl = "none") -> Node:
    return Node(id=name, x_m=round(place[0], 2), y_m=round(place[1], 2), control=control)


def bearing_rad(bearing: Compass, skew_deg: float = 0.0) -> float:
    """Direction of a compass point, turned clockwise by a skew, radians counter-clockwise from east."""
    return math.radians(90 - 45 * COMPASS.index(bearing) - skew_deg)


def _angle(leg: Leg) -> float:
    return bearing_rad(leg.bearing, leg.skew_deg)


def _path(leg: Leg, legs: Sequence[Leg], rim: Rim | None = None) -> _Path:
    """Driving inwards, a left curve turns counter-clockwise; read outwards it is the mirror image.

    Into a circle every leg runs straight at the middle, a ramp as well.
    """
    bend = {"none": 0.0, "left": -1 / RADIUS_M, "right": 1 / RADIUS_M}[leg.curve]
    if rim:
        return _Path(_angle(leg), bend, rim.radius_m)
    return _Path(_ramp_angle(leg, legs) if leg.kind == RAMP else _angle(leg), bend)


def _ramp_angle(leg: Leg, legs: Sequence[Leg]) -> float:
    """A ramp leans to the road that it joins where that lies within 45 degrees."""
    own = _angle(leg)
    for other in legs:
        gap = (_angle(other) - own + math.pi) % (2 * math.pi) - math.pi
        if other.kind != RAMP and 0.1 < abs(gap) < math.radians(50):
            return _angle(other) - math.copysign(RAMP_ANGLE, gap)
    return own


def _clearance(leg: Leg, legs: Sequence[Leg], rim: Rim | None = None) -> float:
    """The least distance of a joint from the hub: clear of the widest other road or of the circle, metres."""
    if rim:
        return rim.radius_m + BEYOND_RIM_M
    return CLEAR_OF_JUNCTION_M + max((_width(o) for o in legs if o is not leg), default=2 * LANE_M) / 2


def _width(leg: Leg) -> float:
    """Lanes and median of a leg, metres."""
    lanes = (leg.lanes_in + leg.lanes_out + leg.center_turn_lane) * LANE_M + MEDIAN_M[leg.median]
    return lanes + sum(beside_m(leg, what) for what in leg.beside) * ((leg.lanes_in > 0) + (leg.lanes_out > 0))


def _crowd(layout: RoadLayout, leg: Leg) -> float:
    """The longest access of this leg that meets no other leg and no access of one, as a share."""
    index = COMPASS.index(leg.bearing)
    near = {COMPASS[(index + 1) % 8], COMPASS[index - 1]} & {o.bearing for o in layout.legs}
    others = any(a.leg != leg.bearing for a in layout.accesses)
    return 0.5 if near else 0.8 if others else math.inf


# ------------------------------------------------------------------ one leg and its accesses
@dataclass(frozen=True)
class _LegDrawing:
    leg: Leg
    path: _Path
    clearance_m: float
    crowd: float
    length_m: float
    rim: Rim | None = None

    def draw(self, accesses: Sequence[Access]) -> tuple[list[Node], list[Road]]:
        """Nodes but the hub, and roads from the hub outwards."""
        joints = self._joints(accesses)
        length = max(self.length_m, joints[-1][0] + BEYOND_JOINT_M if joints else 0.0)
        name = self.leg.bearing
        places = [(node_of(name), self.rim.radius_m)] if self.rim else [(HUB, 0.0)]
        places += [(f"{name}_joint{_number(i)}", s) for i, (s, _) in enumerate(joints)]
        places += [(f"{name}_end", length)]
        nodes = [_node(n, self.path.at(s), self._joint_control(n, joints)) for n, s in places[1:]]
        if self.rim:
            nodes.insert(0, _node(*places[0][:1], self.path.at(places[0][1]), "yield"))
        roads = [self._piece(i, places) for i in range(len(places) - 1)]
        for (joint, s), (_, joined) in zip(places[1:-1], joints, strict=True):
            for access, side in joined:
                node, road = self._access(access, side, joint, s, roads)
                nodes.append(node)
                roads.append(road)
        return nodes, roads

    def _joints(self, accesses: Sequence[Access]) -> list[tuple[float, list[tuple[Access, str]]]]:
        """(distance, [(access, side)]) outwards; near ones share a joint unless that has the side already."""
        joints: list[tuple[float, list[tuple[Access, str]]]] = []
        for access in sorted(accesses, key=lambda a: a.distance_m):
            place = max(access.distance_m, self.clearance_m)
            sides = ["left", "right"] if access.side == "both" else [access.side]
            taken = {side for _, side in joints[-1][1]} if joints else set()
            if joints and place < joints[-1][0] + JOINT_GAP_M and not taken & set(sides):
                joints[-1][1].extend((access, side) for side in sides)
                continue
            place = max(place, joints[-1][0] + 2 * JOINT_GAP_M) if joints else place
            joints.append((place, [(access, side) for side in sides]))
        return joints

    def _joint_control(self, name: str, joints: list[tuple[float, list[tuple[Access, str]]]]) -> NodeControl:
        """A joint has the strongest control of its accesses; an end none."""
        if not name.startswith(f"{self.leg.bearing}_joint"):
            return "none"
        index = int(name.removeprefix(f"{self.leg.bearing}_joint") or 1) - 1
        seen = [access.control for access, _ in joints[index][1]]
        return next((c for c in ("signal", "stop", "yield") if c in seen), "none")

    def _piece(self, index: int, places: Sequence[tuple[str, float]]) -> Road:
        """The leg's road between two places, forward towards the hub."""
        (inner, s_in), (outer, s_out) = places[index], places[index + 1]
        leg, last = self.leg, len(places) - 2
        suffix = "" if index == 0 else OUTER if index == last else f"_mid{_number(index - 1)}"
        walked = leg.crosswalk and index == 0
        return Road(
            id=f"{leg.bearing}{suffix}", from_node=outer, to_node=inner,
            lanes_forward=leg.lanes_in, lanes_backward=leg.lanes_out,
            turns_forward=leg.turns_in if index == 0 else (), center_turn_lane=leg.center_turn_lane,
            median=leg.median, via=self.path.between(s_out, s_in), kind=leg.kind,
            minor=index == 0 and (leg.control in ("stop", "yield") or leg.kind != "road" or self.rim is not None),
            speed_limit_mph=leg.speed_limit_mph, beside=leg.beside, alley=leg.alley,
            closed_backward=leg.closed_out,
            crosswalks=(inner,) if walked else (),
        )  # fmt: skip

    def _access(self, access: Access, side: str, joint: str, s_m: float, so_far: list[Road]) -> tuple[Node, Road]:
        """An access at a right angle to the leg; left as one drives towards the hub."""
        stem = f"{self.leg.bearing}_access_{side}"
        name = stem + _number(sum(r.id.startswith(stem) for r in so_far))
        away = self.path.heading(s_m) + (-math.pi / 2 if side == "left" else math.pi / 2)
        length = min(ACCESS_ROAD_M if access.kind == "road" else ACCESS_M, max(self.crowd * s_m, 12.0))
        x, y = self.path.at(s_m)
        end = _node(f"{name}_end", (x + length * math.cos(away), y + length * math.sin(away)))
        road = Road(
            id=name, from_node=end.id, to_node=joint, lanes_forward=access.lanes_in,
            lanes_backward=access.lanes_out, kind=access.kind, minor=True,
        )  # fmt: skip
        return end, road


def _number(index: int) -> str:
    """Nothing for the first, then 2, 3, ..."""
    return "" if index == 0 else str(index + 1)
