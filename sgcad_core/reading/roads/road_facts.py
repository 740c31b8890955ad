"""The roads of a crash as its narrative tells them.

Roads with lanes as stated, their junction, limits, curves and vehicles. What the text leaves open stays None here;
`sgcad_core.reading.layout.layout_facts` fills it. Knows no road network format.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from sgcad_core.kinds import (
    ALLEY,
    DRIVEWAY,
    FOUR_LEG,
    GORE,
    JOINING,
    MEDIAN_OPENING,
    RAMP,
    ROUNDABOUT,
    WORK_ZONE,
    T,
    actor_kind,
)
from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
from sgcad_core.reading.inference.inference_state import QUARTER_DEG
from sgcad_core.reading.junctions.approach_lanes import Approaches, approaches_of
from sgcad_core.reading.junctions.junction import CIRCLE_LANES, JunctionFacts, junction_of
from sgcad_core.reading.junctions.unsupported_places import unsupported_places
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.motion.absolute_headings import turned_to_roads
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.roads.lanes import LaneFacts
from sgcad_core.reading.roads.road_details import (
    Curve,
    SpeedLimit,
    curves,
    painted_and_beside,
    rural_source,
    speed_limits,
)
from sgcad_core.reading.roads.road_mentions import Kind, RoadMention, axis_of, road_mentions
from sgcad_core.reading.roads.road_merge import MergedRoad, merge_roads
from sgcad_core.reading.roads.work_zones_openings import (
    CLOSED_LANES,
    ClosedLanes,
    closed_lanes,
    in_gores,
    keeps_lane_open,
    median_opening,
    names_closure,
    names_gore,
    undrawn,
    with_entered_median,
)
from sgcad_core.reading.text.compass import AXIS_NAMES, COMPASS, turned
from sgcad_core.reading.text.sentence_roles import STORY_ROLES
from sgcad_core.records.specs import Beside, CenterLine, Compass, Ground, RoadLayout


@dataclass(frozen=True)
class RoadFact:
    """One road. `axis` N, NE, E or SE (N runs north and south); `cross`: told as the intersecting road."""

    axis: Compass | None
    kind: Kind
    lanes: LaneFacts
    vehicles: tuple[str, ...]
    cross: bool = False
    speed_limit_mph: int | None = None
    curve: tuple[tuple[Compass, Literal["left", "right"]], ...] = ()
    """(travel direction, side) of each bend told."""
    rural: bool = False
    where: Mapping[str, Source] = field(default_factory=dict, compare=False, repr=False)
    """Where axis, limit, each curve ("curve N") and "rural" were read; lanes know their own."""

    @property
    def ways(self) -> tuple[tuple[Compass, int], ...]:
        """Lanes told of one direction, by the direction of travel."""
        return tuple((way, self.lanes.toward[way]) for way in COMPASS if way in self.lanes.toward)


@dataclass(frozen=True)
class RoadFacts:
    """All roads of a crash, the streets first; `crash`: the vehicles that the roads must carry.

    Where no heading is told, the headings in `crash` are turned to fit the roads; a told lane ("in the eastbound
    lanes") then makes them `turned_to_roads`.
    """

    roads: tuple[RoadFact, ...]
    junction: JunctionFacts
    crash: CrashFacts
    notes: tuple[str, ...] = field(default=())
    merge_lane: bool = False
    """Whether a lane for merging (acceleration lane) is told."""
    beside: tuple[Beside, ...] = ()
    """What the story tells of the edges of its roads."""
    crosswalk: bool = False
    """Whether it tells a marked crosswalk, or a pedestrian struck at a junction."""
    urban: bool = False
    closed: ClosedLanes | None = None
    """Lanes that a work zone closes, where they can be drawn."""
    opening: Source | None = None
    """Where an opening in the median is told, if it can be drawn."""
    leaves: bool = False
    """Whether the ramp that is told leads off the road, not onto it."""
    approaches: Approaches = field(default_factory=Approaches)
    """Lanes of single approaches, where they are listed."""
    answered: RoadLayout | None = None
    """The layout that a model answered, where some of it is `taken` (fields of
    `sgcad_core.reading.second_reader.field_claims`)."""
    taken: frozenset[str] = frozenset()
    center_line: CenterLine = ""
    ground: tuple[Ground, ...] = ()
    """Ground beside its roads that the story names."""

    def lists(self, axis: Compass) -> bool:
        """Whether the story tells every lane of both legs on an axis, leg by leg, and turn lanes among them."""
        return _listed(self.approaches, self.junction, axis)

    @property
    def streets(self) -> tuple[RoadFact, ...]:
        """Roads that are neither driveway nor ramp."""
        return tuple(r for r in self.roads if r.kind not in JOINING)


def roads_of(statements: tuple[Statement, ...], roster: Roster, crash: CrashFacts) -> RoadFacts:
    """The roads that resolved sentences tell, and the crash turned to fit them. A text without roads gives none."""
    mentions, crash = _alleys(road_mentions(_telling(statements), roster.ids), crash)
    crash = turned_to_roads(crash, mentions, statements)
    driven = tuple(v for v in crash.vehicles if not actor_kind(v.kind).walks) or crash.vehicles
    headings = {v.id: v.heading for v in driven if v.heading}
    left_on = next((c.departs for c in crash.courses.values() if c.departs in ("left", "right")), None)
    limits, bends = speed_limits(statements, headings), curves(statements, headings, left_on)
    merged = merge_roads(mentions, headings) or [MergedRoad(None) for _ in limits[:1]]
    gathered = with_entered_median(merged, statements)
    approaches = approaches_of(statements)
    junction = junction_of(statements, driven, gathered, approaches)
    rural = rural_source(statements)
    roads = tuple(_with_rural(_road(r, gathered, limits, bends, headings), rural) for r in gathered)
    roads = _placed(tuple(_center_lane_elsewhere(r, roads) for r in roads), approaches)
    merge_lane = any(_MERGE_LANE.search(t.text) for t in statements)
    story = [t.text for t in statements if t.role in STORY_ROLES]
    beside = tuple(rule.yields["beside"] for rule in of_role("beside") if any(map(rule.search, story)))
    walked = any(map(_CROSSWALK.search, story)) or (
        junction.kind != "none" and any(actor_kind(other.kind).walks for other in crash.others)
    )
    notes = _open_ends(roads, junction, crash)
    in_gore = in_gores(statements)
    leaves = (any(map(_EXIT_RAMP.search, story)) or bool(in_gore)) and not any(map(_ENTRANCE_RAMP.search, story))
    shut = closed_lanes(statements, driven)
    on = next((r.lanes for r in roads if shut and r.kind not in JOINING and r.axis == axis_of(shut.toward)), None)
    closed = shut if shut and junction.kind == "none" and keeps_lane_open(shut, on or LaneFacts()) else None
    opens = median_opening(statements)
    opening = opens if junction.kind == "none" and not closed else None
    gore = in_gore if junction.kind == RAMP else {}
    crash = replace(crash, gore=gore)
    places = {
        WORK_ZONE: (names_closure(statements), closed),
        MEDIAN_OPENING: (opens, opening),
        GORE: (names_gore(statements), gore),
    }
    roads = tuple(uncounted(r) if r.axis and _listed(approaches, junction, r.axis) else r for r in roads)
    junction = replace(junction, unsupported=undrawn(unsupported_places(statements), places))
    if closed and not closed.side_stated:
        notes = (*notes, "which lane is closed is not told")
    told_places = (merge_lane, beside, walked, any(map(_URBAN.search, story)), closed, opening, leaves)
    line, ground = painted_and_beside(story)
    return RoadFacts(roads, junction, crash, notes, *told_places, approaches, center_line=line, ground=ground)


def _alleys(mentions: tuple[RoadMention, ...], crash: CrashFacts) -> tuple[tuple[RoadMention, ...], CrashFacts]:
    """An alley is the road of a crash within it, if no vehicle just turns into it; else it joins as driveways do."""
    within = {v for m in mentions if m.kind == ALLEY and m.how == "on" for v in m.vehicles}
    joining = {v.id for v in crash.vehicles if ALLEY in (v.origin, v.target)}
    turns = {v.id for v in crash.vehicles if v.maneuver in QUARTER_DEG}
    if within - joining and joining <= within - turns:
        kept = tuple(_staying(v) if v.id in joining else v for v in crash.vehicles)
        return tuple(m for m in mentions if m.kind != ALLEY or m.vehicles), replace(crash, vehicles=kept)
    return tuple(replace(m, kind=DRIVEWAY) if m.kind == ALLEY else m for m in mentions), crash


def _staying(v: VehicleFacts) -> VehicleFacts:
    origin, target = (None if place == ALLEY else place for place in (v.origin, v.target))
    return replace(v, origin=origin, target=target)


def _with_rural(road: RoadFact, rural: Source | None) -> RoadFact:
    return replace(road, rural=True, where={**road.where, "rural": rural}) if rural else road


def _listed(approaches: Approaches, junction: JunctionFacts, axis: Compass) -> bool:
    if junction.kind not in (T, FOUR_LEG):
        return False
    stem = junction.stem
    legs = (stem,) if stem and axis_of(stem) == axis else (axis, turned(axis, 180))
    told = [approaches.of(leg, stem) for leg in legs]
    return any(one.turns_in for one in told) and all(one.lanes_in and one.lanes_out for one in told)


def uncounted(road: RoadFact) -> RoadFact:
    """The road without the lanes that were counted for all of it, where those of each leg are told."""
    return replace(road, lanes=replace(road.lanes, total=None, each_way=None, toward={}, turns={}, own=None))


def _placed(roads: tuple[RoadFact, ...], approaches: Approaches) -> tuple[RoadFact, ...]:
    """The roads, with streets on other axes than those of the two roads whose approaches are listed put there."""
    axes = approaches.crossing
    streets = [r for r in roads if r.kind not in JOINING and r.axis]
    if len(axes) != 2 or {r.axis for r in streets} <= {*axes}:
        return roads
    free = [axis for axis in axes if axis not in {r.axis for r in streets}]
    astray = [r for r in streets if r.axis not in axes]
    moved = dict(zip(map(id, astray), free, strict=False))
    kept = (r for r in roads if id(r) in moved or r not in astray)
    return tuple(replace(r, axis=moved.get(id(r), r.axis)) for r in kept)


def _center_lane_elsewhere(road: RoadFact, roads: tuple[RoadFact, ...]) -> RoadFact:
    """A two-lane road has no center turn lane where the other road has one: a vehicle only turned into that."""
    others = any(r.lanes.center_turn_lane and r.lanes.total != 2 for r in roads if r is not road)
    if not (others and road.lanes.center_turn_lane and road.lanes.total == 2):
        return road
    return replace(road, lanes=replace(road.lanes, center_turn_lane=False))


_MERGE_LANE = rule("roads.merge_lane")
_URBAN = rule("roads.urban")
_CROSSWALK = rule("roads.crosswalk")
_EXIT_RAMP, _ENTRANCE_RAMP = rule("roads.exit_ramp"), rule("roads.entrance_ramp")


def _telling(statements: tuple[Statement, ...]) -> list[Statement]:
    """Sentences that may describe roads: the story, then restraint and other sentences that also name lanes."""
    story = [_without_circle(t) for t in statements if t.role in STORY_ROLES]
    return story + [t for t in statements if t.role in ("restraint", "towing", "injury") and "lane" in t.text]


def _without_circle(statement: Statement) -> Statement:
    """The sentence without the lanes of a roundabout, which are those of no road, and without closed ones."""
    return statement._replace(text=CLOSED_LANES.sub("some were closed", CIRCLE_LANES.sub(ROUNDABOUT, statement.text)))


def _road(
    road: MergedRoad,
    all_roads: list[MergedRoad],
    limits: tuple[SpeedLimit, ...],
    bends: tuple[Curve, ...],
    headings: dict[str, Compass],
) -> RoadFact:
    streets = [r for r in all_roads if r.kind not in JOINING]
    along = [h for h in headings.values() if axis_of(h) == road.axis]
    lead = (along[0] if along else road.axis) if streets and road is streets[0] else None
    limit = _limit(road, limits) if road.kind != DRIVEWAY else None
    curves = _bends(road, lead, bends)
    where = {f"curve {way}": bend.source for way, bend in curves.items()}
    where |= {"axis": Source(road.axis_at, "", "mentions.axis")} if road.axis_at is not None else {}
    where |= {"speed_limit": limit.source} if limit else {}
    return RoadFact(
        road.axis, road.kind, road.lanes, tuple(road.vehicles), road.cross,
        limit.mph if limit else None, tuple((way, bend.side) for way, bend in curves.items()), where=where,
    )  # fmt: skip


def _limit(road: MergedRoad, limits: tuple[SpeedLimit, ...]) -> SpeedLimit | None:
    """The road's own limit, else one that holds for all."""
    own = [limit for limit in limits if limit.axis and limit.axis == road.axis]
    cross = [limit for limit in limits if limit.cross and not limit.axis and road.cross]
    everywhere = [limit for limit in limits if not limit.axis and not limit.cross]
    return next(iter(own + cross + everywhere), None)


def _bends(road: MergedRoad, lead: Compass | None, bends: tuple[Curve, ...]) -> dict[Compass, Curve]:
    """Bends of the road's own directions; one without belongs to the main road as its first vehicle drives (`lead`)."""
    found: dict[Compass, Curve] = {}
    for bend in bends:
        if bend.toward and road.axis and axis_of(bend.toward) == road.axis:
            found.setdefault(bend.toward, bend)
    return found or ({lead: bends[0]} if lead and bends and bends[0].toward is None else {})


def _open_ends(roads: tuple[RoadFact, ...], junction: JunctionFacts, crash: CrashFacts) -> tuple[str, ...]:
    """What a layout has to assume because the text does not say it."""
    streets = [r for r in roads if r.kind not in JOINING]
    notes = [
        f"the {AXIS_NAMES[r.axis or 'N']} road's lanes are not stated"
        for r in streets
        if not (r.lanes.total or r.lanes.each_way or r.lanes.toward or r.lanes.one_way)
    ]
    notes += ["no road is described"] if not streets else []
    notes += ["no direction of travel is stated"] if not crash.oriented else []
    if junction.kind in (T, FOUR_LEG) and not junction.stated:
        notes.append("the kind of junction is not stated")
    return tuple(notes)
