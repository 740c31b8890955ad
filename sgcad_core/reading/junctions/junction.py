"""The junction of a crash: what kind, where its side leg lies, what controls it.

Reads resolved sentences and the vehicles' facts; legs lie at bearings seen from the junction, so a vehicle
that heads north comes from the leg at S. Knows no lane count.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Literal

from sgcad_core.kinds import (
    ALLEY,
    DRIVEWAY,
    FOUR_LEG,
    GARAGE,
    JUNCTIONS,
    PARKING_LOT,
    RAMP,
    JunctionKind,
    T,
    junction_kind,
)
from sgcad_core.reading.crash_facts import VehicleFacts
from sgcad_core.reading.junctions.approach_lanes import Approaches
from sgcad_core.reading.junctions.control import Control, control_of, controlled, signed_legs
from sgcad_core.reading.junctions.junction_stem import (
    BESIDE,
    ENDS,
    SIDE_ROAD,
    contradicted,
    crossing,
    stem_of,
    stem_told,
)
from sgcad_core.reading.junctions.unsupported_places import unsupported_places
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import DRIVES, Source
from sgcad_core.reading.roads.road_merge import MergedRoad
from sgcad_core.reading.roads.work_zones_openings import MEDIAN_OPENING, in_gores
from sgcad_core.reading.text.sentence_roles import STORY_ROLES
from sgcad_core.records.specs import Compass


@dataclass(frozen=True)
class JunctionFacts:
    """`stem`: bearing of the leg that ends here (T), of the driveway or of the ramp. `stopped`: bearings of the
    legs with a stop or yield sign. `stated`: the text names the kind (else it follows from the motion). `stem_stated`:
    the text says by compass where the stem lies. `unsupported`: kinds of places at which the crash happened and which
    cannot be drawn. `circle_lanes`: of a roundabout, as told.
    `skew_deg`: how far the crossing road is told to miss the right angle; `offset`: its legs do not face each other."""

    kind: JunctionKind = "none"
    stem: Compass | None = None
    control: Control = "none"
    stopped: tuple[Compass, ...] = ()
    stated: bool = False
    stem_stated: bool = False
    unsupported: tuple[str, ...] = ()
    circle_lanes: int | None = None
    skew_deg: int = 0
    offset: bool = False
    notes: tuple[str, ...] = field(default=())
    where: Mapping[str, Source] = field(default_factory=dict, compare=False, repr=False)
    """Where kind, control and stem were read, as far as they were."""


_NAMED = tuple((record, rule(record.rule)) for record in JUNCTIONS if record.rule)
_JUNCTION = rule("junction.junction")
_SKEWED, _OFFSET = rule("junction.skewed"), rule("junction.offset")
_SKEW_DEG, _MOST_SKEW_DEG = 30, 40
"""Where no angle is told: AASHTO calls 60 degrees the least that a junction should have."""
CIRCLE_LANES = rule("junction.roundabout_lanes")


def junction_of(
    statements: Sequence[Statement],
    vehicles: Sequence[VehicleFacts],
    roads: Sequence[MergedRoad],
    approaches: Approaches | None = None,
) -> JunctionFacts:
    """The junction that the story tells or that the vehicles' paths need; kind "none" on a plain road."""
    listed = approaches or Approaches()
    story = [t for t in statements if t.role in STORY_ROLES]
    heard = [t for t in statements if t.role in STORY_ROLES or t.role == "interview"]
    if _named(story)[0] == "none" and (_named(heard)[0] != "none" or _one_sided(heard, roads)):
        story = heard
    kind, stated = _kind(story, statements, vehicles, roads)
    kind = _kind_listed(kind, stated, listed)
    if kind == "none":
        return JunctionFacts(stated=stated)
    control, control_at = control_of(statements)
    record = junction_kind(kind)
    if record.legs == 2:
        return JunctionFacts(kind, stated=stated, where=_where(kind=_named(story)[1]))
    where = _where(kind=_named(story)[1] if record.rule else None, control=control_at)
    signed = control in ("stop", "yield", "flashing")
    halted = signed_legs(statements, vehicles, roads, record.crossing) if signed else ()
    if record.crossing:
        around = _circle_lanes(story) if record.round else None
        offset = any(_OFFSET.search(t.text) for t in story)
        more = (around, _skew_deg(story), offset)
        return JunctionFacts(kind, None, control, halted, stated, False, (), *more, where=where)
    lead = next((v.heading for v in vehicles if v.heading and v.origin not in BESIDE), None)
    said, stem_at = stem_told(story, vehicles, lead, only_compass=True) or (None, None)
    said = None if said and contradicted(said, vehicles) else said
    said = said or (listed.alone if kind == T else None)
    stem = said or stem_of(kind, story, vehicles, roads, halted, lead)
    where |= _where(stem=stem_at if said else None)
    halted = (stem,) if stem and signed else ()
    skew = _skew_deg(story)
    return JunctionFacts(kind, stem, control, halted, stated, said is not None, skew_deg=skew, where=where)


def _where(**cues: Source | None) -> dict[str, Source]:
    return {name: source for name, source in cues.items() if source}


# ------------------------------------------------------------------ kind
def _kind(
    story: Sequence[Statement],
    statements: Sequence[Statement],
    vehicles: Sequence[VehicleFacts],
    roads: Sequence[MergedRoad],
) -> tuple[JunctionKind, bool]:
    if GARAGE in unsupported_places(statements):  # a level of it is drawn so
        return PARKING_LOT, True
    named = _named(story)[0]
    access = any(v.origin in DRIVES or v.target in DRIVES for v in vehicles)
    if in_gores(story) and named in ("none", "some"):
        return RAMP, True
    if _ramp_used(vehicles, roads) and _merging(story, roads) and named in ("none", "some"):
        return RAMP, True
    if named != "none" and named != "some":
        return named, True
    if access and not (named == "some" and controlled(story)):
        return _access_kind(vehicles), True
    if named == "some" or controlled(story):
        return (T, False) if _one_sided(story, roads) else (FOUR_LEG, False)
    if any(_RAMP_JOINS.search(t.text) for t in story) and _merging(story, roads):
        return RAMP, True
    if any(_DRIVE_NAMED.search(t.text) for t in story) and not crossing(vehicles):
        return DRIVEWAY, True
    if crossing(vehicles) or _turning(vehicles):
        return (T, False) if _one_sided(story, roads) or not crossing(vehicles) else (FOUR_LEG, False)
    return "none", False


def _kind_listed(kind: JunctionKind, stated: bool, listed: Approaches) -> JunctionKind:
    """The kind that the legs need of which lanes are listed; a kind that is named stays."""
    if kind == "none" or (kind in (T, FOUR_LEG) and not stated):
        if listed.crossing:
            return FOUR_LEG
        return T if listed.alone and kind != FOUR_LEG else kind
    return kind


def _access_kind(vehicles: Sequence[VehicleFacts]) -> JunctionKind:
    """The kind of access that vehicles leave or enter: an alley, if no other access is used."""
    used = {place for v in vehicles for place in (v.origin, v.target) if place in DRIVES}
    return ALLEY if used == {ALLEY} else DRIVEWAY


def _named(story: Sequence[Statement]) -> tuple[JunctionKind | Literal["some"], Source | None]:
    """The first junction kind that the story names, and where; "some" if it only says intersection."""
    some: Source | None = None
    for t in story:
        text = MEDIAN_OPENING.sub(" ", rule("junction.no_junction").sub(" ", t.text))
        found = [(match, words, record) for record, words in _NAMED if (match := words.search(text))]
        if found:
            first, words, record = min(found, key=lambda place: place[0].start())
            return record.kind, Source(t.number, first[0], words.id)
        plain = _JUNCTION.search(text)
        some = some or (Source(t.number, plain[0], _JUNCTION.id) if plain else None)
    return "some" if some else "none", some


def _skew_deg(story: Sequence[Statement]) -> int:
    """Degrees by which the crossing road misses the right angle; 0 where none are told."""
    match = next((m for t in story if (m := _SKEWED.search(t.text))), None)
    if match is None:
        return 0
    return min(abs(90 - int(match["angle"])), _MOST_SKEW_DEG) if match["angle"] else _SKEW_DEG


def _circle_lanes(story: Sequence[Statement]) -> int | None:
    """How many lanes go around in a roundabout, where the story tells it."""
    if match := next((m for t in story if (m := CIRCLE_LANES.search(t.text))), None):
        return 1 if match["one"] or match["one_around"] or match["one_with"] else 2
    return 2 if any(rule("junction.roundabout_lane").search(t.text) for t in story) else None


def _ramp_used(vehicles: Sequence[VehicleFacts], roads: Sequence[MergedRoad]) -> bool:
    """Whether a vehicle comes on a ramp."""
    return any(v.origin == RAMP for v in vehicles) or any(r.kind == RAMP and r.vehicles for r in roads)


def _merging(story: Sequence[Statement], roads: Sequence[MergedRoad]) -> bool:
    text = " ".join(t.text for t in story)
    return bool(rule("junction.merging").search(text)) or any(r.kind == "freeway" for r in roads)


_RAMP_JOINS, _DRIVE_NAMED = rule("junction.ramp_joins"), rule("junction.drive_named")


def _one_sided(story: Sequence[Statement], roads: Sequence[MergedRoad]) -> bool:
    """Whether a side road is told to lie on one side or to end."""
    ends = rule("junction.ends_at")
    return any(
        SIDE_ROAD.search(t.text) or ends.search(t.text) or (ENDS.search(t.text) and _JUNCTION.search(t.text))
        for t in story
    )


def _turning(vehicles: Sequence[VehicleFacts]) -> bool:
    """Whether a vehicle turns or means to, or drives in a lane that is for turns: such a lane ends at a junction."""
    turns = ("turn_left", "turn_right")
    return any({v.maneuver, v.meant} & set(turns) or v.lane_word in ("left_turn", "right_turn") for v in vehicles)
