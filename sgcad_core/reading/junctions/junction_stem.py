"""Where the leg lies that ends at a junction, of the driveway or of the ramp. Knows no words for kinds of junctions."""

from __future__ import annotations

from collections.abc import Sequence

from sgcad_core.kinds import ALLEY, DRIVEWAY, JOINING, RAMP, JunctionKind
from sgcad_core.reading.crash_facts import VehicleFacts
from sgcad_core.reading.inference.inference_state import QUARTER_DEG
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import DRIVES, Source
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.roads.road_merge import MergedRoad
from sgcad_core.reading.text.compass import between, compass_of, turned
from sgcad_core.records.specs import Compass

SIDE_ROAD = rule("junction.side_road")
ENDS = rule("junction.ends")
BESIDE = (*DRIVES, RAMP, "side_road")
"""Where vehicles come from that come in by the stem."""


def stem_of(
    kind: JunctionKind,
    story: Sequence[Statement],
    vehicles: Sequence[VehicleFacts],
    roads: Sequence[MergedRoad],
    halted: Sequence[Compass],
    lead: Compass | None,
) -> Compass | None:
    """Where a side leg lies that no compass word tells: on the side that the vehicles' paths need, else right of V1."""
    main = next((r.axis for r in roads if r.axis and r.kind not in JOINING and not r.cross), None)
    from_paths = _stem_of_paths(vehicles, halted, main if kind in (DRIVEWAY, ALLEY) else None)
    if from_paths:
        return from_paths
    said = stem_told(story, vehicles, lead)
    if said:
        return said[0]
    if runs_out := _stem_run_out(story, vehicles):
        return runs_out
    meant = _stem_meant(story, vehicles)
    if meant:
        return meant
    if len(halted) == 1:
        return halted[0]
    return turned(lead, 90) if lead else None


def _stem_of_paths(vehicles: Sequence[VehicleFacts], halted: Sequence[Compass], main: Compass | None) -> Compass | None:
    """The leg that one vehicle comes from or turns into while the others keep to the through road (`main`)."""
    for v in vehicles:
        if v.heading and v.origin in BESIDE and axis_of(v.heading) != main:
            return turned(v.heading, 180)
    known = [v for v in vehicles if v.heading and v.maneuver != "parked"]
    axes = list(dict.fromkeys(axis_of(v.heading) for v in known if v.heading))
    if len(axes) > 1:
        return turned(_on_stem(known, halted).heading or "N", 180)
    for v in known:
        side = QUARTER_DEG.get(v.maneuver)
        if side and v.heading:
            return turned(v.heading, side)
        if v.exit_heading and v.heading and between(v.heading, v.exit_heading) in (90, 270):
            return v.exit_heading
    return None


def _stem_run_out(story: Sequence[Statement], vehicles: Sequence[VehicleFacts]) -> Compass | None:
    """The leg on which a lone vehicle comes that leaves the road straight ahead, where its own road ends."""
    moving = [v for v in vehicles if v.maneuver != "parked"]
    if len(moving) != 1 or not moving[0].heading or QUARTER_DEG.get(moving[0].maneuver):
        return None
    for t in story:
        found = rule("junction.runs_out").search(t.text)
        if found and compass_of(found["side"] or "") in (None, moving[0].heading):
            return turned(moving[0].heading, 180)
    return None


def _stem_meant(story: Sequence[Statement], vehicles: Sequence[VehicleFacts]) -> Compass | None:
    """The side that a vehicle waited, slowed or meant to turn to."""
    for v in sorted(vehicles, key=lambda v: v.target is None):
        for t in story:
            turn = rule("junction.turn_side").search(t.text)
            mine = v.id in rule("common.vehicle").findall(t.text[: turn.start()])[-1:] if turn else False
            if (
                turn
                and v.heading
                and (mine or (t.subject == v.id and not rule("common.vehicle_begins").search(t.text[: turn.start()])))
            ):
                return turned(v.heading, -90 if (turn["a"] or turn["b"]).lower() == "left" else 90)
    return None


def _on_stem(known: Sequence[VehicleFacts], halted: Sequence[Compass]) -> VehicleFacts:
    """The vehicle on the ending leg, of vehicles on two axes: it turns, or it has the sign."""

    def likely(v: VehicleFacts) -> tuple[bool, bool, bool]:
        turns = v.maneuver in ("turn_left", "turn_right")
        return turns, bool(v.heading and turned(v.heading, 180) in halted), v.maneuver != "straight"

    return max(known, key=likely)


def contradicted(stem: Compass, vehicles: Sequence[VehicleFacts]) -> bool:
    """Whether a vehicle is told to come from a leg that does not exist with that stem."""
    told = [v for v in vehicles if v.heading and v.heading_stated]
    if any(v.heading == stem and v.maneuver not in ("turn_left", "turn_right") for v in told):
        return True
    leaving = [turned(v.heading, QUARTER_DEG[v.maneuver]) for v in told if v.heading and v.maneuver in QUARTER_DEG]
    if turned(stem, 180) in leaving:
        return True
    turning = [axis_of(v.heading) for v in told if v.heading and v.maneuver in ("turn_left", "turn_right")]
    return crossing(told) and len(turning) == 1 and turning[0] != axis_of(stem)


def crossing(vehicles: Sequence[VehicleFacts]) -> bool:
    """Whether two of the moving vehicles come on different axes, both headings told."""
    told = [v.heading for v in vehicles if v.heading and v.heading_stated and v.maneuver != "parked"][:2]
    return len(told) == 2 and axis_of(told[0]) != axis_of(told[1])


def stem_told(
    story: Sequence[Statement], vehicles: Sequence[VehicleFacts], lead: Compass | None, only_compass: bool = False
) -> tuple[Compass, Source] | None:
    """The bearing of the stem that the story tells by compass or, unless `only_compass`, by hand; and where."""
    for t in story:
        ends = ENDS.search(t.text)
        way = compass_of(ends["dir"]) if ends and ends["dir"] and rule("junction.junction").search(t.text) else None
        if ends and way:
            return turned(way, 180), Source(t.number, ends["dir"], ENDS.id)
        place = SIDE_ROAD.search(t.text) or rule("junction.drive_side").search(t.text)
        if place:
            word = next(filter(None, place.groups()))
            found = _bearing(word, t, vehicles, lead)
            if found and not (only_compass and word.lower() in ("left", "right")):
                return found, Source(t.number, word, "junction.side_road")
    return None


def _bearing(word: str, statement: Statement, vehicles: Sequence[VehicleFacts], lead: Compass | None) -> Compass | None:
    """A compass point as it stands; left and right as the sentence's vehicle (or the first) heads."""
    if word.lower() not in ("left", "right"):
        return compass_of(word)
    own = next((v.heading for v in vehicles if v.id == statement.subject and v.heading), lead)
    return turned(own, -90 if word.lower() == "left" else 90) if own else None
