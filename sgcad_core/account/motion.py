"""Stated motion of vehicles against executed one, with the criteria of `sgcad score`. Angles: clockwise from north."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import NamedTuple, cast

import numpy as np

from sgcad_core.account.inputs import ExecutedCase, is_stated
from sgcad_core.account.records import Item
from sgcad_core.geometry.plane import wrap_angle
from sgcad_core.kinds import ALLEY, CHANGES, DRIVEWAY, OVER_A_LINE, PARKING_LOT, RAMP
from sgcad_core.metrics.labels.course_label_match import vehicle_marks
from sgcad_core.metrics.labels.course_labels import POINT_DEG, CourseLabel, RestLabel, VehicleLabel
from sgcad_core.metrics.labels.observed_crash import VehicleMotion
from sgcad_core.metrics.lane_places import lane_steps
from sgcad_core.metrics.rest_error import attitude_of, near_m
from sgcad_core.metrics.road_departure import hand_of, left_road, moves_made
from sgcad_core.metrics.told_lanes import LANE_WORDS, TURN_LANES, ToldLane, told_lane
from sgcad_core.reading.text.compass import COMPASS, angle_of, compass_of_angle
from sgcad_core.records.acts import steering_of
from sgcad_core.records.course import CourseTold, DepartureSide, Move
from sgcad_core.records.facts import Fact, Value
from sgcad_core.roads.lane_positions import position

_HEADING_RAD = math.radians(45.0 + 22.5)
"""A heading is right within an eighth of the circle beside the compass word's own eighth, as the scorers have it."""
_LIES = {"wheels": "wheels", "roof": "roof", "left": "left side", "right": "right side"}
_STANDS_MPS, _AWAY_M = 1.0, 6.0
"""Speed below which a vehicle stands; distance from its first contact beyond which one that still drives leaves."""
_SPIN_DEG = 60.0
"""Tolerance of a stated angle of spin: reports give quarter turns."""


class Comparison(NamedTuple):
    """Whether the motion shows a fact; the value seen instead, and the reason in words."""

    has: bool
    instead: Value = None
    why: str = "not so in the scenario"


Judge = Callable[[ExecutedCase, str, Value], Comparison | None]
"""Compares a vehicle's fact with the execution; None: nothing to compare with."""


def motion_items(made: ExecutedCase) -> Iterator[Item]:
    """One item per stated fact of motion of the vehicles in the scenario."""
    for fact in made.reading.facts:
        parts = fact.field.split(".", 2)
        if parts[0] != "vehicles" or len(parts) < 3 or parts[1] not in made.tracks or not is_stated(fact):
            continue
        seen = judged(made, parts[1], parts[2], fact)
        if seen is not None:
            yield made.item(seen.has, fact.field, fact.value, seen.instead, why=seen.why)
    for who, course in made.reading.crash.courses.items():
        yield from _moves(made, who, course.moves) if who in made.tracks else ()


def _moves(made: ExecutedCase, who: str, moves: Sequence[Move]) -> Iterator[Item]:
    """One item for each of several moves before the first contact, in their order."""
    seen = moves_made(made.graph, VehicleMotion(made.crash, who), moves, made.sizes[who][0]) if moves else ()
    for number, (move, has) in enumerate(zip(moves, seen, strict=True)):
        text, why = f"{who} {move.words}", "it does not do so there in the scenario"
        yield made.item(has, f"vehicles.{who}.moves.{number}", move.words, why=why, text=text)


def judged(made: ExecutedCase, who: str, name: str, fact: Fact) -> Comparison | None:
    """A vehicle's fact of motion compared with the execution; None: nothing to compare with."""
    course = made.reading.crash.courses.get(who)
    if course and _judged_otherwise(made, who, course, name, fact.value):
        return None
    if name == "yaws" and not (course and course.moves):
        own = [Move("yaws", fact.value)]  # type: ignore[arg-type]
        turned = moves_made(made.graph, VehicleMotion(made.crash, who), own, made.sizes[who][0])
        return Comparison(turned[0], None, "it does not turn so before its first contact")
    if name in _JUDGES:
        return _JUDGES[name](made, who, fact.value)
    if name not in _LABELS:
        return None
    marks = _marks(made, who, _LABELS[name](fact.value))
    return Comparison(all(m >= 1.0 for m in marks.values())) if marks else None


def _judged_otherwise(made: ExecutedCase, who: str, course: CourseTold, name: str, value: Value) -> bool:
    """Whether something else is judged for a fact: each of several moves, the moment of a speed, the told slowing."""
    driven = [move.kind for move in course.moves if move.kind != "yaws"]
    back, vehicle = "departs" in driven and driven[-1] != "departs", made.reading.crash.vehicle(who)
    slows = name == "evasion.none" and vehicle is not None and vehicle.maneuver == "slowing"
    moved = bool(course.moves) and (name == "evasion.steers" or value in OVER_A_LINE)
    return slows or moved or (name == "departs" and back) or (name == "speed_mph" and course.speed_at_impact)


def _marks(made: ExecutedCase, who: str, label: VehicleLabel) -> Mapping[str, float]:
    return vehicle_marks(CourseLabel("", {who: label}, ()), made.crash)[who]


# ------------------------------------------------------------------ as labels of the scorers
def _deeds(evasion: str) -> tuple[str, ...]:
    """The deeds of an evasive maneuver, as labels name them."""
    side = steering_of(evasion)  # type: ignore[arg-type]
    steers = () if side is None else ("steer",) if side == "either" else (f"steer_{side}",)
    return (*(("brake",) if "braking" in evasion else ()), *steers)


_LABELS: dict[str, Callable[[Value], VehicleLabel]] = {
    "maneuver": lambda value: VehicleLabel(maneuver=value),  # type: ignore[arg-type]
    "speed_mph": lambda value: VehicleLabel(speed_mph=float(value)),  # type: ignore[arg-type]
    "pace": lambda value: VehicleLabel(pace=value),  # type: ignore[arg-type]
    "evasion.brakes": lambda _: VehicleLabel(evasion=("brake",)),
    "evasion.steers": lambda value: VehicleLabel(evasion=("steer" if value == "either" else f"steer_{value}",)),
    "evasion.none": lambda _: VehicleLabel(evasion=()),
    "evasion": lambda value: VehicleLabel(evasion=_deeds(str(value))),
    "lost_control": lambda _: VehicleLabel(lost_control=True),
    "spin": lambda value: VehicleLabel(rest=RestLabel(turned="cw" if value == "clockwise" else "ccw")),
    "rest.facing_deg": lambda value: VehicleLabel(rest=RestLabel(facing=_point(float(value)))),  # type: ignore[arg-type]
    "rest.where": lambda value: VehicleLabel(rest=RestLabel(where=value)),  # type: ignore[arg-type]
}
"""Facts that the label scorers compare."""


def _point(degrees: float) -> str:
    return min(POINT_DEG, key=lambda word: abs((POINT_DEG[word] - degrees + 180) % 360 - 180))


# ------------------------------------------------------------------ others
def _heading(made: ExecutedCase, who: str, value: Value) -> Comparison | None:
    if value not in COMPASS:
        return None
    first, vehicle = float(made.tracks[who].heading_rad[0]), made.reading.crash.vehicle(who)
    if vehicle is not None and vehicle.maneuver == "backing" and not vehicle.faces:
        first += math.pi  # told is where it backs to
    off = abs(float(wrap_angle(np.array([first - angle_of(value)]))[0]))
    seen = compass_of_angle(first)
    return Comparison(off <= _HEADING_RAD, seen, f"it heads {seen}")


def _lane(made: ExecutedCase, who: str, value: Value) -> Comparison | None:
    """A numbered lane (1 = at the right curb, -1 = the leftmost), one by its side, or a turn lane."""
    vehicle = made.reading.crash.vehicle(who)
    side = told.side if vehicle and (told := told_lane(vehicle)) else 0
    told = ToldLane.of(value, side)
    if told.number is None and told.word not in LANE_WORDS:
        return None
    steps = lane_steps(made.graph, VehicleMotion(made.crash, who).before)
    first = steps.first
    if first is None and told.word in TURN_LANES:
        return None  # it stands in its turn, in the junction
    at = position(made.graph, steps.lanes[first]) if first is not None else None
    seen = f"it starts in lane {at.place} of {at.lanes}" if at else "it starts in no lane of its direction"
    if first is not None and steps.places[first] == "center_lane":
        seen = "it starts in the center turn lane"
    return Comparison(told.taken(made.graph, steps), at.place if at else None, seen)


def _spin_deg(made: ExecutedCase, who: str, value: Value) -> Comparison | None:
    if not isinstance(value, int | float):
        return None
    one = VehicleMotion(made.crash, who)
    turned = abs(math.degrees(float(wrap_angle(np.diff(one.path.pose[one.turns_from :, 2])).sum())))
    return Comparison(abs(turned - float(value)) <= _SPIN_DEG, round(turned), f"it turns by {turned:.0f} degrees")


def _side(made: ExecutedCase, who: str, value: Value) -> Comparison | None:
    where = made.told.get(f"vehicles.{who}.rest.where")
    if where is None or where.value in ("road", "intersection"):
        return None
    label = VehicleLabel(rest=RestLabel(where=where.value, side=str(value)))  # type: ignore[arg-type]
    mark = _marks(made, who, label).get("rest_side")
    return None if mark is None else Comparison(mark >= 1, why="it comes to rest on another side")


def _distance(made: ExecutedCase, who: str, value: Value) -> Comparison | None:
    """How far from its place at its first contact it comes to rest."""
    if not isinstance(value, int | float):
        return None
    one = VehicleMotion(made.crash, who)
    seen = math.dist(one.path.pose[one.hit, :2], one.path.pose[-1, :2])
    return Comparison(abs(seen - value) <= near_m(value), round(seen, 1), f"it comes to rest {seen:.0f} m from there")


def _rest_lane(made: ExecutedCase, who: str, value: Value) -> Comparison | None:
    """Whether it comes to rest in the told lane, or in one of the told direction."""
    course = made.reading.crash.courses.get(who)
    marks = VehicleMotion(made.crash, who).rest(course.rest) if course else {}
    return Comparison(marks["lane"], why="it comes to rest in another lane") if "lane" in marks else None


def _attitude(made: ExecutedCase, who: str, value: Value) -> Comparison | None:
    seen = attitude_of(float(made.tracks[who].rolls[-1]))
    return Comparison(seen == value, seen, f"it comes to rest on its {_LIES[seen]}")


def _from_rest(made: ExecutedCase, who: str, value: Value) -> Comparison:
    """Whether a vehicle stands before its first contact and then moves on into it."""
    speed = made.tracks[who].speed_mps[: VehicleMotion(made.crash, who).hit + 1]
    slowest = float(speed.min())
    stops = (course := made.reading.crash.courses.get(who)) is not None and course.stops
    starts = slowest < _STANDS_MPS and float(speed[int(speed.argmin()) if stops else -2 :].max()) > _STANDS_MPS
    return Comparison(starts, round(slowest, 1), f"it never drives slower than {slowest:.1f} m/s before its contact")


def _comes(made: ExecutedCase, who: str, value: Value) -> Comparison:
    """Whether a vehicle drives, then stands until its first contact; or stands, and moves off before it."""
    speed = made.tracks[who].speed_mps[: VehicleMotion(made.crash, who).hit]
    stands = len(speed) > 1 and float(speed[-2]) < _STANDS_MPS < float(speed.max())
    return _from_rest(made, who, value) if value == "moves_off" else Comparison(stands, why="it stands all the time")


def _straddles(made: ExecutedCase, who: str, value: Value) -> Comparison:
    """Whether the two sides of a vehicle are in two lanes at its first contact."""
    pose = VehicleMotion(made.crash, who).before[-1:]
    out = made.sizes[who][1] / 2 * np.column_stack((-np.sin(pose[:, 2]), np.cos(pose[:, 2]), np.zeros(1)))
    left, right = (lane_steps(made.graph, pose + hand * out).lanes[0] for hand in (1.0, -1.0))
    over = left != right and bool(left and right)
    return Comparison(over, why="it stands in one lane")


def _rolls(made: ExecutedCase, who: str, value: Value) -> Comparison:
    most = float(np.abs(made.tracks[who].rolls).max())
    return Comparison(most >= math.pi / 2 - 1e-3, round(math.degrees(most)), "it stays on its wheels")


def _roll_quarters(made: ExecutedCase, who: str, value: Value) -> Comparison:
    turned = round(abs(float(made.tracks[who].rolls[-1])) / (math.pi / 2))
    return Comparison(turned == value, turned, f"it rolls {turned} quarter turn{'s' * (turned != 1)}")


def _rolls_to(made: ExecutedCase, who: str, value: Value) -> Comparison:
    """Whether it rolls with the told side leading; rolls are positive to the right."""
    rolls = made.tracks[who].rolls
    leads = "right" if float(rolls[int(np.abs(rolls).argmax())]) > 0 else "left"
    return Comparison(leads == value, leads, f"its {leads} side leads when it rolls")


def _departs(made: ExecutedCase, who: str, value: Value) -> Comparison:
    """Whether a vehicle is off the road at its first contact, on the told side; any side fits one along its way."""
    poses = VehicleMotion(made.crash, who).before
    seen = left_road(made.graph, poses, made.sizes[who][0])
    if seen is None:
        return Comparison(False, None, "it is on the road at its first contact")
    wanted = hand_of(cast("DepartureSide", value), float(poses[0, 2]))
    return Comparison(wanted in (None, seen), seen, f"it leaves the road on the {seen}")


def _to_lane(made: ExecutedCase, who: str, value: Value) -> Comparison | None:
    """Whether a change of lanes leads into the told one: it lies beside the lane in which the vehicle starts."""
    vehicle = made.reading.crash.vehicle(who)
    side = CHANGES.get(vehicle.maneuver, 0) if vehicle else 0
    if not side:
        return None
    told = ToldLane.of(value, side)
    steps = lane_steps(made.graph, VehicleMotion(made.crash, who).before)
    first = steps.first
    at = position(made.graph, steps.lanes[first], side) if first is not None else None
    seen = f"its change leads into lane {at.place} of {at.lanes}" if at else "its change leads into no lane"
    return Comparison(told.taken(made.graph, steps), at.place if at else None, seen)


def _joins(end: str) -> Judge:
    """A comparison of the kind of road that a vehicle comes from or enters (`end`), or might enter if met before."""

    def judged(made: ExecutedCase, who: str, value: Value) -> Comparison | None:
        wanted = {DRIVEWAY: DRIVEWAY, ALLEY: ALLEY, PARKING_LOT: DRIVEWAY, RAMP: RAMP}.get(str(value))
        actors = made.scenario.behavior.actors if made.scenario.behavior else ()
        spec, actor = made.network.spec, next((a for a in actors if a.id == who and getattr(a, end)), None)
        if wanted is None or spec is None or actor is None:
            return None
        kinds = {road.id: ALLEY if road.alley else road.kind for road in spec.roads}
        onward = end == "exit_road" and actor.maneuver in ("straight", "slowing", "negotiating_curve", "stopped")
        kind = wanted if onward and wanted in kinds.values() else kinds.get(getattr(actor, end), "road")
        lot = made.reading.roads.junction.kind == PARKING_LOT or (str(value) == RAMP and _in_gore(made, who))
        return Comparison(kind == wanted or lot, kind, f"that road is drawn as a {kind}")

    return judged


def _leaves(made: ExecutedCase, who: str, value: Value) -> Comparison:
    """Whether a vehicle still drives in the end, away from the place of its first contact."""
    one = VehicleMotion(made.crash, who)
    away_m = math.dist(one.path.pose[one.hit, :2], one.path.pose[-1, :2])
    drives = float(made.tracks[who].speed_mps[-1]) > _STANDS_MPS
    return Comparison(drives and away_m > _AWAY_M, round(away_m), "it stays at the scene")


def _in_gore(made: ExecutedCase, who: str) -> bool:
    """Whether it crosses the gore of a ramp, so that it is on the ramp for a while."""
    behavior = made.scenario.behavior
    return behavior is not None and any(a.gore for a in behavior.actors if a.id == who)


_JUDGES: dict[str, Judge] = {
    "heading": _heading, "lane": _lane, "lane_word": _lane, "to_lane": _to_lane,
    "spin_deg": _spin_deg, "rest.side": _side, "rest.attitude": _attitude, "from_stop": _from_rest,
    "from_rest": _from_rest, "comes": _comes, "leaves": _leaves, "rolls": _rolls, "straddles": _straddles,
    "roll_quarters": _roll_quarters, "rolls_to": _rolls_to, "departs": _departs, "origin": _joins("road"),
    "target": _joins("exit_road"), "rest.distance_m": _distance, "rest.lane": _rest_lane, "rest.lane_way": _rest_lane,
}  # fmt: skip
