"""The crash configurations: one function each adds actors and contacts to half-made roads.

Each returns False where the roads do not allow it. Contacts agree with the directions: a vehicle that is hit by
one coming from its left is hit on its left side.
"""

from __future__ import annotations

from random import Random

from research.generator.crash.vehicles import KIND_WEIGHTS
from research.generator.crash.world import OPPOSITE, TURN_OF, Actor, Contact, Crash, pick
from sgcad_core.kinds import DRIVEWAY, INTERSECTIONS, PLAIN, RAMP


def _vehicle(rng: Random, leg: int, out: int | None, maneuver: str, purpose: str = "") -> Actor:
    return Actor("", pick(rng, KIND_WEIGHTS), leg % 8, None if out is None else out % 8, maneuver, purpose=purpose)


def _drivable(crash: Crash) -> list[int]:
    return [leg.bearing for leg in crash.legs if leg.lanes_in]


def opens(crash: Crash, bearing: int) -> bool:
    leg = crash.leg(bearing)
    return bool(leg and leg.lanes_out)


def _through(crash: Crash, rng: Random, main_only: bool = False) -> int | None:
    """A leg whose traffic can go straight on."""
    found = [b for b in _drivable(crash) if opens(crash, b + 4) and (crash.is_main(b) or not main_only)]
    return rng.choice(found) if found else None


def _side_facing(heading: int, other_leg: int) -> str:
    """The side of a vehicle that faces a vehicle coming from another leg (at a right angle)."""
    return "left" if (other_leg - (heading - 2)) % 8 == 0 else "right"


def _on_main(crash: Crash, rng: Random) -> int:
    """Any drivable leg of the main road."""
    found = [b for b in _drivable(crash) if crash.is_main(b)]
    return rng.choice(found)


# ------------------------------------------------------------------ configurations
def crossing(rng: Random, crash: Crash) -> bool:
    """Two straight paths at right angles."""
    a, b = _through(crash, rng), None
    others = [x for x in _drivable(crash) if a is not None and (x - a) % 4 == 2 and opens(crash, x + 4)]
    if a is None or not others:
        return False
    b = rng.choice(others)
    crash.actors = [_vehicle(rng, a, a + 4, "straight"), _vehicle(rng, b, b + 4, "straight")]
    struck = rng.randrange(2)
    hit, by = crash.actors[struck], crash.actors[1 - struck]
    crash.contacts = [Contact(1 - struck, struck, "front", _side_facing(hit.heading, by.leg))]
    return True


def left_opposite(rng: Random, crash: Crash) -> bool:
    """A left turn across the path of oncoming traffic."""
    found = [
        b for b in _drivable(crash)
        if (facing := crash.leg(b + 4)) and facing.lanes_in and opens(crash, b + 2) and opens(crash, b)
    ]  # fmt: skip
    if not found:
        return False
    a = rng.choice(found)
    crash.actors = [_vehicle(rng, a, a + 2, "turn_left"), _vehicle(rng, a + 4, a, "straight")]
    way = pick(rng, {"right": 60.0, "left": 0.0, "front": 20.0, "turner": 20.0})
    if way == "turner":
        crash.contacts = [Contact(0, 1, "front", rng.choice(("left", "left", "front")))]
    else:
        crash.contacts = [Contact(1, 0, "front", way)]
    return True


def left_lateral(rng: Random, crash: Crash) -> bool:
    """A left turn out of a side road or driveway across or into crossing traffic."""
    return _out_of_side(rng, crash, "turn_left")


def right_into(rng: Random, crash: Crash) -> bool:
    """A right turn into the path of traffic from the left."""
    return _out_of_side(rng, crash, "turn_right")


def _out_of_side(rng: Random, crash: Crash, maneuver: str) -> bool:
    step = TURN_OF[maneuver.removeprefix("turn_")]
    sides = [b for b in _drivable(crash) if not crash.is_main(b) and opens(crash, b + step)]
    if not sides:
        return False
    a = rng.choice(sides)
    heading = a + 4
    from_left, from_right = (heading - 2) % 8, (heading + 2) % 8
    other = from_left if maneuver == "turn_right" or rng.random() < 0.62 else from_right
    if other not in _drivable(crash) or not opens(crash, other + 4):
        return False
    crash.actors = [_vehicle(rng, a, a + step, maneuver), _vehicle(rng, other, other + 4, "straight")]
    side = "left" if other == from_left else "right"
    if rng.random() < 0.72:
        crash.contacts = [Contact(1, 0, "front", side)]
    else:
        crash.contacts = [Contact(0, 1, "front", _side_facing((other + 4) % 8, a))]
    return True


def rear_end(rng: Random, crash: Crash) -> bool:
    """A vehicle runs into the one ahead; a third may be pushed or follow."""
    a = _through(crash, rng, main_only=crash.layout == DRIVEWAY)
    if a is None:
        return False
    lead = _lead(rng, crash, a)
    crash.actors = [lead, _vehicle(rng, a, a + 4, "straight")]
    crash.contacts = [Contact(1, 0, "front", "back")]
    if rng.random() < 0.2:
        ahead = _vehicle(rng, a, lead.out, lead.maneuver, lead.purpose)
        crash.actors.append(ahead)
        crash.contacts.append(Contact(0, 2, "front", "back"))
    return True


def _lead(rng: Random, crash: Crash, a: int) -> Actor:
    how = pick(rng, {"stopped": 55.0, "slowing": 24.0, "straight": 14.0, "turning": 7.0})
    purposes = {"traffic": 1.0}
    if crash.layout in INTERSECTIONS:
        control = crash.leg(a).control  # type: ignore[union-attr]
        purposes = {"light": 6.0 * (control == "signal"), "sign": 3.0 * (control == "stop"), "traffic": 1.5}
    for turn in ("left", "right"):
        if opens(crash, a + TURN_OF[turn]):
            purposes[f"turn_{turn}"] = 2.0
    purpose = pick(rng, purposes)
    out: int | None = (a + TURN_OF[purpose.removeprefix("turn_")]) if purpose.startswith("turn_") else a + 4
    if how == "turning":
        if not purpose.startswith("turn_"):
            how, out = "stopped", a + 4
        else:
            return _vehicle(rng, a, out, purpose)
    if how == "straight":
        return _vehicle(rng, a, a + 4, "straight")
    return _vehicle(rng, a, out, how, purpose)


def head_on(rng: Random, crash: Crash) -> bool:
    """One crosses the center line into oncoming traffic."""
    a = _through(crash, rng, main_only=True)
    leg = crash.leg(a) if a is not None else None
    if a is None or leg is None or not leg.lanes_out or leg.median in ("raised", "grass", "barrier"):
        return False
    straight = "negotiating_curve" if leg.curve != "none" else "straight"
    crash.actors = [_vehicle(rng, a, a + 4, "crossing_centerline"), _vehicle(rng, a + 4, a, straight)]
    way = pick(rng, {"front": 62.0, "side": 20.0, "swipe": 12.0, "back": 2.0})
    striker = rng.randrange(2)
    crash.contacts = {
        "front": [Contact(striker, 1 - striker, "front", "front")],
        "side": [Contact(1, 0, "front", pick(rng, {"right": 0.6, "left": 0.4}))],
        "swipe": [Contact(striker, 1 - striker, "left", "left")],
        "back": [Contact(1, 0, "front", "back")],
    }[way]
    if rng.random() < 0.15:
        crash.actors.append(_vehicle(rng, a + 4, a, straight))
        first, sides = crash.contacts[0], {"left": 1.0, "right": 1.0, "front": 0.6}
        sides.pop(first.striker_area if first.striker == 0 else first.struck_area, None)  # where the other one is
        crash.contacts.append(Contact(2, 0, "front", pick(rng, sides)))
    return True


def lane_change(rng: Random, crash: Crash) -> bool:
    """A sideswipe or a strike between lanes of one direction."""
    found = [
        b for b in _drivable(crash)
        if (back := crash.leg(b)) and back.lanes_in >= 2
        and opens(crash, b + 4) and (ahead := crash.leg(b + 4)) and ahead.lanes_out >= 2
    ]  # fmt: skip
    if not found:
        return False
    a, side = rng.choice(found), rng.choice(("left", "right"))
    other = OPPOSITE[side]
    crash.actors = [_vehicle(rng, a, a + 4, f"lane_change_{side}"), _vehicle(rng, a, a + 4, "straight")]
    way = pick(rng, {"swipe": 55.0, "behind": 20.0, "into": 25.0})
    crash.contacts = {
        "swipe": [Contact(0, 1, side, other)],
        "behind": [Contact(1, 0, "front", rng.choice(("back", side)))],
        "into": [Contact(0, 1, "front", rng.choice((other, "back")))],
    }[way]
    return True


def departure(rng: Random, crash: Crash) -> bool:
    """One vehicle leaves the road and strikes an object."""
    a = _through(crash, rng)
    if a is None:
        return False
    side = rng.choice(("right", "right", "left"))
    crash.actors = [
        _vehicle(rng, a, a + 4, f"departing_road_{side}"),
        Actor("", "object", (a + 4) % 8, None, "stopped"),
    ]
    crash.contacts = [Contact(0, 1, pick(rng, {"front": 75.0, "right": 14.0, "left": 11.0}), "front")]
    return True


def pedestrian(rng: Random, crash: Crash) -> bool:
    """A person on foot or on a bicycle crosses the road."""
    a = _through(crash, rng, main_only=True)
    if a is None:
        return False
    kind = rng.choice(("pedestrian", "pedestrian", "bicycle"))
    leg = a if crash.layout == PLAIN else (a + 4) % 8
    crash.actors = [_vehicle(rng, a, a + 4, "straight"), Actor("", kind, leg, None, "straight")]
    crash.contacts = [Contact(0, 1, "front", rng.choice(("left", "right")))]
    return True


def parked(rng: Random, crash: Crash) -> bool:
    """A parked vehicle is struck."""
    a = _through(crash, rng)
    if a is None:
        return False
    mover = _vehicle(rng, a, a + 4, rng.choice(("straight", "departing_road_right")))
    crash.actors = [mover, _vehicle(rng, a, None, "parked")]
    crash.contacts = [Contact(0, 1, "front", rng.choice(("back", "back", "left")))]
    return True


def u_turn(rng: Random, crash: Crash) -> bool:
    """A U-turn in front of following or oncoming traffic."""
    a = _through(crash, rng, main_only=True)
    if a is None or not opens(crash, a):
        return False
    same = rng.random() < 0.6 or crash.leg(a + 4).lanes_in == 0  # type: ignore[union-attr]
    crash.actors = [
        _vehicle(rng, a, a, "u_turn"),
        _vehicle(rng, a if same else a + 4, a + 4 if same else a, "straight"),
    ]
    crash.contacts = [Contact(1, 0, "front", "left" if same else "right")]
    return True


def backing(rng: Random, crash: Crash) -> bool:
    """A vehicle backs out of a driveway."""
    drive = next(leg.bearing for leg in crash.legs if leg.kind == DRIVEWAY)
    b = _on_main(crash, rng)
    crash.actors = [
        _vehicle(rng, drive, rng.choice((drive + 2, drive - 2)), "backing"),
        _vehicle(rng, b, b + 4, "straight"),
    ]
    heading = (drive + 4) % 8
    facing = OPPOSITE[_side_facing(heading, b)]
    crash.contacts = [Contact(1, 0, "front", rng.choice((facing, "back")))]
    if rng.random() < 0.3:
        crash.contacts = [Contact(0, 1, "back", _side_facing((b + 4) % 8, drive))]
    return opens(crash, b + 4)


def merge(rng: Random, crash: Crash) -> bool:
    """A vehicle merges from a ramp into a highway lane."""
    ramp = next(leg.bearing for leg in crash.legs if leg.kind == RAMP)
    a = (ramp + 1) % 8
    if a % 4 != crash.main % 4 or not opens(crash, a + 4) or not crash.leg(a).lanes_in:  # type: ignore[union-attr]
        return False
    crash.actors = [_vehicle(rng, ramp, a + 4, "merge"), _vehicle(rng, a, a + 4, "straight")]
    way = pick(rng, {"swipe": 50.0, "behind": 25.0, "into": 25.0})
    crash.contacts = {
        "swipe": [Contact(0, 1, "left", "right")],
        "behind": [Contact(1, 0, "front", "back")],
        "into": [Contact(0, 1, "front", rng.choice(("right", "back")))],
    }[way]
    return True


def overtaking(rng: Random, crash: Crash) -> bool:
    """Passing on the left: into oncoming traffic or into one that turns left."""
    a = _through(crash, rng, main_only=True)
    if a is None or not opens(crash, a) or crash.leg(a).median not in ("none", "painted"):  # type: ignore[union-attr]
        return False
    passing = _vehicle(rng, a, a + 4, "overtaking")
    if opens(crash, a + 2) and crash.layout != PLAIN:
        crash.actors = [passing, _vehicle(rng, a, a + 2, "turn_left")]
        crash.contacts = [Contact(0, 1, "front", "left")]
    else:
        crash.actors = [passing, _vehicle(rng, a + 4, a, "straight")]
        crash.contacts = [Contact(0, 1, "front", "front")] if rng.random() < 0.7 else [Contact(0, 1, "left", "left")]
    return True


BUILDERS = {
    f.__name__: f
    for f in (crossing, left_opposite, left_lateral, right_into, rear_end, head_on, lane_change, departure, pedestrian,
              parked, u_turn, backing, merge, overtaking)
}  # fmt: skip
