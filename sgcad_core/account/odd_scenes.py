"""What no crash has: who waits stands in the junction, a rail crosses the lanes, a wreck turns on the spot.

Compares the executed motion with the compiled roads and with what is told of the same actor. Each is a lack.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import combinations

import numpy as np

from sgcad_core.account.inputs import ExecutedCase, is_stated
from sgcad_core.account.records import Item
from sgcad_core.kinds import CHANGES
from sgcad_core.metrics.labels.observed_crash import VehicleMotion
from sgcad_core.metrics.lane_places import lane_steps
from sgcad_core.metrics.rest_error import whirls
from sgcad_core.planner.aftermath.rails import stands_on_road
from sgcad_core.planner.long_things import MOST_FLARE_DEG, runs_along
from sgcad_core.records.course import CourseTold
from sgcad_core.records.specs import Actor
from sgcad_core.roads.lane_positions import position

_STANDS_MPS = 0.3
_INTO_M = 1.0
"""By which a front may be over the edge of a junction."""
_SLANTED_RAD = math.radians(MOST_FLARE_DEG + 1.0)
"""Angle to the road of what runs along it, at most: a bend turns the road by a degree over the length of a thing."""
_WHIRLS_RAD, _MOST_SPIN_RAD = math.radians(115.0), math.radians(330.0)
"""A rotation on the spot that is one, and the most of a rotation of which no degrees are told."""
_LEAVES_M = 1.5
"""Distance from the road of one that is told to come to rest on it, at most."""


def odd_scenes(made: ExecutedCase) -> Iterator[Item]:
    """A lack for each such thing."""
    behavior = made.scenario.behavior
    for actor in behavior.actors if behavior else ():
        if actor.id not in made.tracks:
            continue
        yield from _waiting(made, actor)
        yield from _rail(made, actor)
        yield from _ending(made, actor)
    yield from _lying(made)
    yield from _one_lane(made)


def _item(field: str, who: str, text: str, reason: str) -> Item:
    return Item(kind="lacks", field=field, subject=who, value=None, text=text, reason=reason)


def _waiting(made: ExecutedCase, actor: Actor) -> Iterator[Item]:
    """One that is told to have stopped stands before the junction, unless it is told to be in it."""
    fact, course = made.told.get(f"vehicles.{actor.id}.maneuver"), made.said.crash.driven.get(actor.id, CourseTold())
    stops = fact is not None and is_stated(fact) and fact.value == actor.maneuver == "stopped"
    if not stops or course.inside or actor.gore:
        return
    one = VehicleMotion(made.crash, actor.id)
    pose = one.before[max(len(one.before) - 2, 0)]
    if not len(one.speed) or float(one.speed[-2:].min()) > _STANDS_MPS:
        return
    ahead = (made.sizes[actor.id][0] / 2 - _INTO_M) * np.array([math.cos(pose[2]), math.sin(pose[2])])
    at = np.array([pose[:2], pose[:2] + ahead])
    if any(float(junction.out_m(at).min()) < 0.0 for junction in made.crash.surface.junctions):
        yield _item(f"vehicles.{actor.id}.waits", actor.id, f"{actor.id} waits before the junction",
                    "it stands in the junction")  # fmt: skip


def _rail(made: ExecutedCase, actor: Actor) -> Iterator[Item]:
    """A long thing runs along the road, beside its lanes."""
    if not runs_along(actor) or actor.gore:
        return
    pose, surface = made.crash.paths[actor.id].pose[:1], made.crash.surface
    angle = _slant(made, actor.id, float(pose[0, 2]) + math.pi / 2)
    in_lanes = bool(stands_on_road(surface, pose, made.sizes[actor.id])[0])
    if angle > _SLANTED_RAD or in_lanes:
        why = "it reaches into the lanes" if in_lanes else f"it stands at {math.degrees(angle):.0f} degrees to it"
        yield _item(f"others.{actor.id}.place", actor.id, f"{actor.id} along the road", why)


def _slant(made: ExecutedCase, thing: str, runs_rad: float) -> float:
    """The least angle of a thing that runs in a direction to a road beside it: at a corner it runs along either one.
    The ways across a junction are no roads."""
    roads = made.crash.surface.roads
    away = roads.from_pieces(made.crash.paths[thing].pose[:1, :2])[0][0]
    ways = roads.ways[away <= away.min() + made.sizes[thing][1] / 2]
    return min(abs(math.remainder(runs_rad - float(way), math.pi)) for way in ways)


def _ending(made: ExecutedCase, actor: Actor) -> Iterator[Item]:
    """How a vehicle moves from its first contact on."""
    course = made.said.crash.driven.get(actor.id, CourseTold())
    if not actor.record.wheeled or actor.record.thing or course.rolls:
        return
    one = VehicleMotion(made.crash, actor.id)
    poses = one.path.pose[one.turns_from :].copy()
    poses[:, 2] = np.unwrap(poses[:, 2])
    whole = float(poses[:, 2].max() - poses[:, 2].min())
    spot = float(whirls(poses[:, None])[0])
    told = made.told.get(f"vehicles.{actor.id}.spin_deg") is not None
    if one.turns_from and spot > _WHIRLS_RAD and not told:
        yield _item(f"vehicles.{actor.id}.turns", actor.id, f"{actor.id} turns as it slides",
                    f"it turns by {math.degrees(spot):.0f} degrees on the spot")  # fmt: skip
    elif one.turns_from and whole > _MOST_SPIN_RAD and not told:
        yield _item(f"vehicles.{actor.id}.turns", actor.id, f"{actor.id} turns less than once around",
                    f"it turns by {math.degrees(whole):.0f} degrees")  # fmt: skip
    off = made.crash.surface.off(one.path.pose[one.hit :, :2])[0]
    if course.rest.where == "road" and off[-1] < 0.0 and off[0] < 0.0 and float(off.max()) > _LEAVES_M:
        yield _item(f"vehicles.{actor.id}.rest.way", actor.id, f"{actor.id} stays on the road",
                    f"it goes {off.max():.1f} m off the road and comes back")  # fmt: skip


def _lying(made: ExecutedCase) -> Iterator[Item]:
    """What lies in the road lies in its lanes, and an animal that comes from beside it is there when it is struck."""
    for other in made.reading.crash.others:
        if other.lies is None or other.id not in made.tracks:
            continue
        place = made.crash.paths[other.id].pose[made.crash.first_of(other.id)][None, :2]
        if float(made.crash.surface.off(place)[0][0]) > 0.0:
            yield _item(f"others.{other.id}.place", other.id, f"{other.id} ({other.word}) in the road",
                        "it lies beside the road")  # fmt: skip


def _one_lane(made: ExecutedCase) -> Iterator[Item]:
    """Two of one direction that are told to be in lanes of different numbers start in different lanes, where one of the
    two changes lanes. Numbers from the right and from the left are not compared."""
    told = [v for v in made.reading.crash.vehicles if v.lane is not None and v.id in made.tracks]
    for a, b in combinations(told, 2):
        changes = any(CHANGES.get(v.maneuver, 0) for v in (a, b))
        if a.heading != b.heading or a.lane == b.lane or (a.lane or 0) * (b.lane or 0) < 0 or not changes:
            continue
        lanes = [_first_lane(made, v.id) for v in (a, b)]
        if lanes[0] is not None and lanes[0] == lanes[1]:
            yield _item(f"vehicles.{b.id}.lane", b.id, f"{a.id} and {b.id} in lanes {a.lane} and {b.lane}",
                        "both start in one lane")  # fmt: skip


def _first_lane(made: ExecutedCase, who: str) -> tuple[str, int] | None:
    """The edge and the place of the lane in which a vehicle starts."""
    steps = lane_steps(made.graph, VehicleMotion(made.crash, who).before)
    at = position(made.graph, steps.lanes[steps.first]) if steps.first is not None else None
    return None if at is None or steps.first is None else (steps.lanes[steps.first].rpartition("_")[0], at.place)
