"""Seeded random places with a crash each: a layout that a report can tell, and the two actors that meet.

Every kind of junction of `sgcad_core.kinds` that the seeds cover, with what lies beside the lanes; contacts are those
that are usual at such a place. The layout's fields are what a network must show, the contact what a plan must bring.
"""

from __future__ import annotations

import random
from collections.abc import Callable, Mapping
from typing import Any, NamedTuple, get_args

from sgcad_core.records.specs import (  # fmt: skip
    Access,
    Actor,
    Area,
    BehaviorSpec,
    Beside,
    Compass,
    Contact,
    Leg,
    Maneuver,
    RoadLayout,
)
from sgcad_core.roads.layout import COMPASS


class Place(NamedTuple):
    """A layout with a crash; `kind` names both: "roundabout, enters"."""

    kind: str
    layout: RoadLayout
    behavior: BehaviorSpec


def random_place(seed: int) -> Place:
    """The place of a seed; kinds come in turn, so that any run of seeds covers all alike."""
    r = random.Random(seed)
    name = tuple(KINDS)[seed % len(KINDS)]
    return KINDS[name](r, name)


# ------------------------------------------------------------------ layouts
def _turned(bearing: Compass, eighths: int) -> Compass:
    return COMPASS[(COMPASS.index(bearing) + eighths) % 8]


def _edges(r: random.Random, *needed: Beside) -> tuple[Beside, ...]:
    return tuple({*needed, *r.sample(get_args(Beside), r.choice([0, 0, 1, 2]))} - ({"shoulder"} if needed else set()))


def _legs(r: random.Random, bearings: tuple[Compass, ...], most: int = 3, **fields: Any) -> tuple[Leg, ...]:
    """Legs of two roads: opposite ones have equal lanes."""
    lanes = {axis: r.randint(1, most) for axis in range(4)}
    found = []
    for bearing in bearings:
        count = lanes[COMPASS.index(bearing) % 4]
        found.append(Leg(bearing=bearing, lanes_in=count, lanes_out=count, **fields))
    return tuple(found)


def _cross(r: random.Random, legs: int = 4) -> tuple[Compass, ...]:
    """A leg by which the first vehicle comes, then those to its left, ahead and to its right, as one drives."""
    own = r.choice(COMPASS)
    return tuple(_turned(own, step) for step in (0, 2, 4, 6))[:legs]


def _control(r: random.Random) -> str:
    return r.choice(["none", "signal", "stop"])


# ------------------------------------------------------------------ crashes
def _actor(name: str, road: str, maneuver: Maneuver = "straight", **fields: Any) -> Actor:
    return Actor.model_validate(
        {"id": name, "kind": "car", "road": road, "direction": "forward", "maneuver": maneuver} | fields
    )


def _crash(first: Actor, second: Actor, areas: tuple[Area, Area]) -> BehaviorSpec:
    contact = Contact(striker=first.id, struck=second.id, striker_area=areas[0], struck_area=areas[1])
    return BehaviorSpec(actors=(first, second), contacts=(contact,))


def _roundabout_enters(r: random.Random, kind: str) -> Place:
    """An entering vehicle strikes one that comes around from the left."""
    own, left, ahead, right = _cross(r)
    circle = r.choice([1, 2])
    legs = _legs(r, (own, left, ahead, right), most=circle, beside=_edges(r))
    onward = r.choice([ahead, right])
    entering = _actor("V1", own, exit_road=r.choice([ahead, right]))
    crash = _crash(entering, _actor("V2", left, exit_road=onward), ("front", "right"))
    return Place(kind, RoadLayout(legs=legs, circle_lanes=circle), crash)


def _roundabout_waits(r: random.Random, kind: str) -> Place:
    """A vehicle that waits to enter is struck from behind."""
    bearings = tuple(r.sample(COMPASS, r.choice([3, 4, 5])))
    circle = r.choice([1, 2])
    legs = _legs(r, bearings, most=circle, beside=_edges(r, "sidewalk"), crosswalk=r.random() < 0.5)
    ways = {"exit_road": bearings[1], "lane": 1}
    crash = _crash(_actor("V1", bearings[0], **ways), _actor("V2", bearings[0], "stopped", **ways), ("front", "back"))
    return Place(kind, RoadLayout(legs=legs, circle_lanes=circle), crash)


def _crosswalk(r: random.Random, kind: str) -> Place:
    """A pedestrian is struck on a crosswalk, at a junction or between two."""
    bearings = _cross(r, r.choice([3, 4])) if r.random() < 0.7 else (b := r.choice(COMPASS), _turned(b, 4))
    control = _control(r) if len(bearings) > 2 else "none"
    legs = _legs(r, bearings, beside=_edges(r, "sidewalk"), control=control)
    walked = tuple(leg.model_copy(update={"crosswalk": len(legs) > 2 or i == 0}) for i, leg in enumerate(legs))
    side: Area = r.choice(["left", "right"])
    walker = _actor("P1", bearings[0], kind="pedestrian")
    return Place(kind, RoadLayout(legs=walked), _crash(_actor("V1", bearings[0]), walker, ("front", side)))


def _parked(r: random.Random, kind: str) -> Place:
    """A passing vehicle strikes a car in the parking lane from behind."""
    own = r.choice(COMPASS)
    legs = _legs(r, (own, _turned(own, 4)), beside=_edges(r, "parking"))
    return Place(kind, RoadLayout(legs=legs), _crash(_actor("V1", own), _actor("V2", own, "parked"), ("front", "back")))


def _right_hook(r: random.Random, kind: str) -> Place:
    """A vehicle that turns right strikes a cyclist in the bicycle lane beside it."""
    own, left, ahead, right = _cross(r)
    legs = _legs(r, (own, left, ahead, right), beside=_edges(r, "bike_lane"), control=_control(r))
    cyclist = _actor("B1", own, kind="bicycle", exit_road=ahead)
    turner = _actor("V1", own, "turn_right", exit_road=right, lane=1)
    return Place(kind, RoadLayout(legs=legs), _crash(turner, cyclist, ("right", "left")))


def _lot_backs(r: random.Random, kind: str) -> Place:
    """A vehicle that backs out of a stall strikes one that drives or stands in the aisle."""
    own = r.choice(COMPASS)
    ends = (own, _turned(own, 4))
    backing = _actor("V1", own, "backing")
    other = _actor("V2", own, r.choice(["straight", "stopped"]))
    return Place(kind, RoadLayout(legs=_aisles(ends)), _crash(backing, other, ("back", "right")))


def _lot_crosses(r: random.Random, kind: str) -> Place:
    """Two vehicles cross where two aisles do."""
    own, left, ahead, right = _cross(r)
    crash = _crash(_actor("V1", own, exit_road=ahead), _actor("V2", left, exit_road=right), ("front", "right"))
    return Place(kind, RoadLayout(legs=_aisles((own, left, ahead, right))), crash)


def _aisles(ends: tuple[Compass, ...]) -> tuple[Leg, ...]:
    return tuple(Leg(bearing=end, lanes_in=1, lanes_out=1, kind="driveway", beside=("parking",)) for end in ends)


def _skewed(r: random.Random, legs: tuple[Leg, ...], crossing: tuple[Compass, ...]) -> tuple[Leg, ...]:
    """The same legs, those of the crossing road turned as one in half of all places."""
    skew = r.choice([0, 0, r.randint(-35, 35)])
    return tuple(leg.model_copy(update={"skew_deg": skew}) if leg.bearing in crossing else leg for leg in legs)


def _crossing(r: random.Random, kind: str) -> Place:
    """Two vehicles cross."""
    own, left, ahead, right = _cross(r)
    legs = _legs(r, (own, left, ahead, right), beside=_edges(r), control=_control(r))
    legs = _skewed(r, legs, (left, right))
    crash = _crash(_actor("V1", own, exit_road=ahead), _actor("V2", left, exit_road=right), ("front", "right"))
    return Place(kind, RoadLayout(legs=legs), crash)


def _left_turn(r: random.Random, kind: str) -> Place:
    """A vehicle turns left at a T before an oncoming one."""
    own, left, ahead, _ = _cross(r)
    legs = _skewed(r, _legs(r, (own, left, ahead), beside=_edges(r), control=_control(r)), (left,))
    turner = _actor("V2", own, "turn_left", exit_road=left)
    return Place(kind, RoadLayout(legs=legs), _crash(_actor("V1", ahead, exit_road=own), turner, ("front", "right")))


def _freeway(r: random.Random, own: Compass) -> tuple[Leg, ...]:
    fields = {"beside": r.choice([(), ("shoulder",)]), "median": r.choice(["grass", "barrier"])}
    return _legs(r, (own, _turned(own, 4)), speed_limit_mph=r.choice([55, 60, 65]), **fields)


def _ramp(r: random.Random, kind: str) -> Place:
    """A merging vehicle touches one on the road."""
    own = r.choice(COMPASS)
    legs = _freeway(r, own)
    ramp = Leg(bearing=_turned(own, -1), lanes_in=1, lanes_out=0, kind="ramp")
    merging = _actor("V1", ramp.bearing, "merge", exit_road=_turned(own, 4))
    crash = _crash(merging, _actor("V2", own, lane=1, exit_road=_turned(own, 4)), ("left", "right"))
    return Place(kind, RoadLayout(legs=(*legs, ramp)), crash)


def _exit(r: random.Random, kind: str) -> Place:
    """A vehicle that leaves by a ramp is struck from behind."""
    own = r.choice(COMPASS)
    legs = _freeway(r, own)
    ramp = Leg(bearing=_turned(own, 5), lanes_in=0, lanes_out=1, kind="ramp")
    way = {"lane": 1, "exit_road": ramp.bearing}
    crash = _crash(_actor("V1", own, **way), _actor("V2", own, "slowing", **way), ("front", "back"))
    return Place(kind, RoadLayout(legs=(*legs, ramp)), crash)


def _driveway(r: random.Random, kind: str) -> Place:
    """A vehicle that comes out of a driveway is struck in the side."""
    own = r.choice(COMPASS)
    legs = _legs(r, (own, _turned(own, 4)), most=2, beside=_edges(r))
    access = Access(leg=own, side="right", distance_m=r.choice([30.0, 45.0, 60.0]))
    leaving = _actor("V2", f"{own}_access_right", "turn_left", exit_road=f"{own}_outer")
    crash = _crash(_actor("V1", f"{own}_outer", exit_road=own), leaving, ("front", "left"))
    return Place(kind, RoadLayout(legs=legs, accesses=(access,)), crash)


def _alley_mouth(r: random.Random, kind: str) -> Place:
    """A vehicle that comes out of an alley, forwards or backwards, meets one on the street."""
    own, _, ahead, right = _cross(r)
    legs = _legs(r, (own, ahead), most=2, beside=_edges(r))
    mouth = Leg(bearing=right, lanes_in=1, lanes_out=1, kind="driveway", alley=True)
    along = _actor("V1", own, lane=1, exit_road=ahead)
    if r.random() < 0.5:
        crash = _crash(along, _actor("V2", right, "turn_left", exit_road=own), ("front", "left"))
    else:
        crash = _crash(_actor("V2", right, "backing", exit_road=own), along, ("back", "right"))
    return Place(kind, RoadLayout(legs=(*legs, mouth)), crash)


def _in_alley(r: random.Random, kind: str) -> Place:
    """Two vehicles meet in an alley, or one passes another that stands in it."""
    own = r.choice(COMPASS)
    ends: tuple[Compass, ...] = (own, _turned(own, 4))
    legs = tuple(Leg(bearing=end, lanes_in=1, lanes_out=1, kind="driveway", alley=True) for end in ends)
    crash = r.choice([
        _crash(_actor("V1", own), _actor("V2", ends[1], "stopped"), ("front", "front")),
        _crash(_actor("V1", own), _actor("V2", own, "stopped"), ("front", "back")),
        _crash(_actor("V1", own), _actor("V2", own, "parked"), ("right", "left")),
    ])  # fmt: skip
    return Place(kind, RoadLayout(legs=legs), crash)


def _lane_closed(r: random.Random, kind: str) -> Place:
    """A vehicle that leaves a closed lane touches one beside it, or one that waits before the cones is struck."""
    own = r.choice(COMPASS)
    ends: tuple[Compass, ...] = (own, _turned(own, 4))
    count, right = r.randint(2, 4), r.random() < 0.6
    shut = r.randint(1, count - 1) if r.random() < 0.3 else 1
    closed = tuple(range(1, shut + 1)) if right else tuple(range(count - shut + 1, count + 1))
    fields: dict[str, Any] = {
        "lanes_in": count, "lanes_out": count, "speed_limit_mph": r.choice([35, 45, 55, 65]),
        "median": r.choice(["none", "grass", "barrier"]), "beside": r.choice([(), ("shoulder",)]),
    }  # fmt: skip
    legs = (Leg(bearing=own, **fields), Leg(bearing=ends[1], closed_out=closed, **fields))
    leaves, stays = (shut, shut + 1) if right else (count - shut + 1, count - shut)
    way: Maneuver = r.choice(["merge", "lane_change_left" if right else "lane_change_right"])
    sides: tuple[Area, Area] = ("left", "right") if right else ("right", "left")
    crash = r.choice([
        _crash(_actor("V1", own, way, lane=leaves), _actor("V2", own, lane=stays), sides),
        _crash(_actor("V2", own, lane=leaves), _actor("V1", own, "stopped", lane=leaves), ("front", "back")),
        _crash(_actor("V2", own, lane=stays), _actor("V1", own, "slowing", lane=stays), ("front", "back")),
    ])  # fmt: skip
    return Place(kind, RoadLayout(legs=legs), crash)


def _median_opening(r: random.Random, kind: str) -> Place:
    """A vehicle that turns round through an opening in the median, or waits to, is struck."""
    own = r.choice(COMPASS)
    far = _turned(own, 4)
    count = r.randint(1, 3)  # one lane and a narrow median leave no car the room to turn
    fields: dict[str, Any] = {
        "lanes_in": count, "lanes_out": count,
        "median": r.choice(["raised", "grass", "barrier"]) if count > 1 else "grass",
        "speed_limit_mph": r.choice([35, 45, 55]), "beside": r.choice([(), ("shoulder",)]),
    }  # fmt: skip
    legs = tuple(Leg(bearing=end, **fields) for end in (own, far))
    around, inner = _actor("V2", far, "u_turn", exit_road=far), count
    crash = r.choice([
        _crash(_actor("V1", own, exit_road=far), around, ("front", "right")),
        _crash(_actor("V1", far, lane=inner), _actor("V2", far, "stopped", lane=inner), ("front", "back")),
        _crash(_actor("V1", far, lane=inner), around, ("front", "left")),
    ])  # fmt: skip
    return Place(kind, RoadLayout(legs=legs, opening=True), crash)


def _gore(r: random.Random, kind: str) -> Place:
    """A vehicle that crosses a gore touches one on the road, or one that strays into it strikes what stands there."""
    own = r.choice(COMPASS)
    legs, far, off = _freeway(r, own), _turned(own, 4), _turned(own, 5)
    ramp = Leg(bearing=off, lanes_in=0, lanes_out=1, kind="ramp")
    along = _actor("V1", own, lane=1, exit_road=far)
    crash = r.choice([
        _crash(_actor("V2", own, lane=1, exit_road=far, gore=True), along, ("left", "right")),
        _crash(along, _actor("V2", own, "stopped", gore=True), ("front", "back")),
        _crash(along, _actor("O1", own, "stopped", kind="object", gore=True), ("front", "front")),
    ])  # fmt: skip
    return Place(kind, RoadLayout(legs=(*legs, ramp)), crash)


KINDS: Mapping[str, Callable[[random.Random, str], Place]] = {
    "roundabout, enters": _roundabout_enters, "roundabout, waits": _roundabout_waits, "crosswalk": _crosswalk,
    "parking lane": _parked, "bicycle lane": _right_hook, "four legs": _crossing, "t": _left_turn,
    "parking lot, backs": _lot_backs,
    "parking lot, crosses": _lot_crosses, "ramp, merges": _ramp, "ramp, leaves": _exit, "driveway": _driveway,
    "alley, comes out": _alley_mouth, "alley, within": _in_alley,
    "lane closed": _lane_closed, "median opening": _median_opening, "gore": _gore,
}  # fmt: skip
