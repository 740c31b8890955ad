"""Which mentions are one road: road mentions gathered into roads with one set of lane facts each.

A road is known by its compass axis, else by what was said of it ("the one-way roadway"), else by its place in
the story ("the same roadway", "the intersecting roadway"). Knows no junction and decides no lane count.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace

from sgcad_core.kinds import ALLEY, JOINING
from sgcad_core.reading.roads.lane_sources import derived_sources, with_center_lane_placed, with_sources_of_both
from sgcad_core.reading.roads.lanes import LaneFacts
from sgcad_core.reading.roads.road_mentions import Kind, RoadMention, axis_of
from sgcad_core.reading.text.compass import turned
from sgcad_core.records.specs import Compass

_OWN_KINDS = (*JOINING, "freeway", ALLEY)
"""Kinds of road that a mention tells by its word alone."""


@dataclass
class MergedRoad:
    """One road while its mentions come in. `cross`: told as the other, side or intersecting road."""

    axis: Compass | None
    kind: Kind = "road"
    lanes: LaneFacts = field(default_factory=LaneFacts)
    vehicles: list[str] = field(default_factory=list)
    cross: bool = False
    sentences: list[int] = field(default_factory=list)
    axis_at: int | None = None
    """The sentence that names the axis; None: it follows from the vehicles."""

    def take(self, mention: RoadMention) -> None:
        """Add what a mention says; what was said first stays."""
        self.axis = self.axis or mention.axis
        if self.axis_at is None and mention.axis and mention.axis == self.axis:
            self.axis_at = mention.sentence
        self.lanes = merged(self.lanes, mention.lanes)
        self.vehicles += [v for v in mention.vehicles if v not in self.vehicles and mention.how == "on"]
        self.sentences.append(mention.sentence)
        if mention.kind in _OWN_KINDS:
            self.kind = mention.kind


def merged(first: LaneFacts, more: LaneFacts) -> LaneFacts:
    """Both statements of one road; where they differ, a longer list of directions wins, else the first."""
    toward = {**more.toward, **first.toward}
    for way, count in more.toward.items():
        turn_only = first.toward.get(way) == len(first.turns.get(way, ()))
        toward[way] = count if turn_only and count > toward[way] else toward[way]
    found = replace(
        first, total=first.total or more.total, each_way=first.each_way or more.each_way, toward=toward,
        turns={**more.turns, **first.turns} if len(more.turns) <= len(first.turns) else {**first.turns, **more.turns},
        one_way=more.one_way if first.one_way is None else first.one_way,
        one_way_toward=first.one_way_toward or more.one_way_toward,
        center_turn_lane=first.center_turn_lane or more.center_turn_lane, median=first.median or more.median,
        divided=more.divided if first.divided is None else first.divided, one_lane=first.one_lane or more.one_lane,
        highway=first.highway or more.highway, leg_totals={**more.leg_totals, **first.leg_totals},
    )  # fmt: skip
    return with_sources_of_both(found, first, more)


def merge_roads(mentions: Iterable[RoadMention], headings: Mapping[str, Compass]) -> list[MergedRoad]:
    """Roads in the order of the text; driveways and ramps apart, "both roads" told to every road."""
    roads: list[MergedRoad] = []
    shared: list[RoadMention] = []
    for mention in mentions:
        if mention.relation == "both":
            shared.append(mention)
            continue
        if not _informative(mention):
            continue
        if mention.kind in JOINING:
            _special(roads, mention, headings)
            continue
        _road_of(roads, mention, headings).take(_with_leg(_with_own(mention, headings), headings))
    if not roads and any(not m.lanes.empty for m in shared):
        roads.append(MergedRoad(None))
    roads = _settled(roads, headings)
    for mention in shared:
        for road in _streets(roads):
            if not _counted(road.lanes):
                road.lanes = merged(road.lanes, mention.lanes)
            elif mention.lanes.one_lane:
                road.lanes = replace(road.lanes, one_lane=True)
    for road in roads:
        if road.lanes.one_way and road.lanes.one_lane and not (lane_count(road.lanes) or road.lanes.toward):
            road.lanes = replace(road.lanes, total=1, where=derived_sources(road.lanes, "total", "one_way"))
    for road, lanes in zip(roads, with_center_lane_placed([road.lanes for road in roads]), strict=True):
        road.lanes = lanes
    return roads


def _with_own(m: RoadMention, headings: Mapping[str, Compass]) -> RoadMention:
    """ "V1 was in the second of three lanes": three lanes in V1's direction."""
    way = next((headings[v] for v in m.vehicles if v in headings), None)
    if not m.lanes.own or not way or way in m.lanes.toward:
        return m
    where = derived_sources(m.lanes, f"toward {way}", "own")
    return replace(m, lanes=replace(m.lanes, toward={**m.lanes.toward, way: m.lanes.own}, where=where))


def _with_leg(m: RoadMention, headings: Mapping[str, Compass]) -> RoadMention:
    """ "V1 was southbound on a five-lane road": five lanes on the leg north of a junction, on which it comes."""
    ways = {headings[v] for v in m.vehicles if v in headings}
    if m.lanes.total is None or m.how != "on" or len(ways) != 1:
        return m
    return replace(m, lanes=replace(m.lanes, leg_totals={turned(ways.pop(), 180): m.lanes.total}))


def _informative(m: RoadMention) -> bool:
    return bool(m.axis or m.vehicles or m.relation or not m.lanes.empty or m.kind in _OWN_KINDS)


def _special(roads: list[MergedRoad], mention: RoadMention, headings: Mapping[str, Compass]) -> None:
    """Driveways and ramps: one road each, they never merge with a street."""
    own = next((r for r in roads if r.kind == mention.kind), None)
    if own is None:
        own = MergedRoad(None, kind=mention.kind, cross=True)
        roads.append(own)
    own.take(replace(mention, axis=mention.axis or _axis_of_vehicles(mention, headings)))
    own.vehicles += [v for v in mention.vehicles if mention.how == "from" and v not in own.vehicles]


def _axis_of_vehicles(m: RoadMention, headings: Mapping[str, Compass]) -> Compass | None:
    if m.how not in ("on", "from"):
        return None
    return next((axis_of(headings[v]) for v in m.vehicles if v in headings), None)


def _streets(roads: list[MergedRoad]) -> list[MergedRoad]:
    return [r for r in roads if r.kind not in JOINING]


def _road_of(roads: list[MergedRoad], m: RoadMention, headings: Mapping[str, Compass]) -> MergedRoad:
    """The road that a mention means; a new one if none fits."""
    axis = m.axis or (_axis_of_vehicles(m, headings) if m.how == "on" else None)
    streets = _streets(roads)
    if axis:
        found = next((r for r in streets if r.axis == axis), None) or _unplaced(streets, m)
        if found and found.axis is None:
            found.axis = axis
    else:
        found = _by_story(streets, m)
    if found is None:
        found = MergedRoad(axis, cross=m.relation == "other")
        roads.append(found)
    found.cross = found.cross or (m.relation == "other" and found is not next(iter(streets), found))
    return found


def _unplaced(streets: list[MergedRoad], m: RoadMention) -> MergedRoad | None:
    """A road without an axis yet that this mention may place."""
    free = [r for r in streets if r.axis is None and r.cross == (m.relation == "other")]
    alike = [r for r in free if alike_lanes(m.lanes, r.lanes)]
    if alike:
        return alike[0]
    open_to = [r for r in free if m.lanes.total is None and m.lanes.each_way is None and not _clash(m.lanes, r.lanes)]
    if m.relation == "other":
        return free[0] if free else None
    told_once = [r for r in streets if not r.cross]
    return open_to[0] if len(open_to) == 1 and (m.definite or m.vehicles) and len(told_once) == 1 else None


def _by_story(streets: list[MergedRoad], m: RoadMention) -> MergedRoad | None:
    """The road that a mention without an axis means."""
    if not streets:
        return None
    if m.relation == "same":
        return streets[-1]
    if m.relation == "other":
        cross = [r for r in streets if r.cross]
        return cross[0] if cross else streets[1] if len(streets) == 2 else None
    if m.relation == "main":
        return next((r for r in streets if not r.cross), None)
    alike = [r for r in streets if alike_lanes(m.lanes, r.lanes)]
    if alike and (m.definite or (len(streets) == 1 and m.sentence not in streets[0].sentences)):
        return alike[0]
    if m.definite:
        free = [r for r in streets if not _clash(m.lanes, r.lanes)]
        return free[-1] if free else None
    same_sentence = [r for r in streets if m.sentence in r.sentences]
    if same_sentence and m.lanes.empty:
        return same_sentence[-1]
    waiting = [r for r in streets if not _counted(r.lanes)]
    return waiting[-1] if waiting and not same_sentence else _last_of_sentence(waiting, m)


def _last_of_sentence(waiting: list[MergedRoad], m: RoadMention) -> MergedRoad | None:
    """ "The north/south roadway was a two-lane two-way roadway": both nouns are one road."""
    mine = [r for r in waiting if m.sentence in r.sentences]
    return mine[-1] if mine else None


def lane_count(f: LaneFacts) -> int | None:
    """Lanes in both directions as far as stated."""
    if f.total:
        return f.total
    if f.each_way:
        return 2 * f.each_way
    return sum(f.toward.values()) + f.center_turn_lane if len(f.toward) > 1 else None


def _counted(f: LaneFacts) -> bool:
    return bool(lane_count(f) or f.toward or f.one_way)


def alike_lanes(first: LaneFacts, second: LaneFacts) -> bool:
    """Whether two statements give the same number of lanes, or both (and only then) say one-way."""
    if _clash(first, second):
        return False
    if first.one_way and second.one_way:
        return True
    a, b = lane_count(first), lane_count(second)
    if a and b:
        return a == b
    return first.one_way is False and second.one_way is False


def _clash(first: LaneFacts, second: LaneFacts) -> bool:
    """Statements that cannot be of one road."""
    if {first.one_way, second.one_way} == {True, False}:
        return True
    if first.one_way_toward and second.one_way_toward and first.one_way_toward != second.one_way_toward:
        return True
    a, b = lane_count(first), lane_count(second)
    if first.one_way is True and (second.each_way or len(second.toward) > 1):
        return True
    slack = first.center_turn_lane or second.center_turn_lane or bool(first.total) != bool(second.total)
    return bool(a and b and abs(a - b) > slack)


# ------------------------------------------------------------------ end of the text
def _settled(roads: list[MergedRoad], headings: Mapping[str, Compass]) -> list[MergedRoad]:
    """Every vehicle's heading has a road, and every road an axis where the story leaves one."""
    streets = _streets(roads)
    special = [r for r in roads if r not in streets]
    on_special = {v for r in special for v in r.vehicles}
    for vehicle, heading in headings.items():
        if vehicle not in on_special:
            _place_vehicle(streets, vehicle, axis_of(heading))
    _place_rest(streets)
    return streets + special


def _place_vehicle(streets: list[MergedRoad], vehicle: str, axis: Compass) -> None:
    road = next((r for r in streets if r.axis == axis), None)
    if road is None:
        own = [r for r in streets if r.axis is None and vehicle in r.vehicles]
        free = own or [r for r in streets if r.axis is None and not r.cross] or [r for r in streets if r.axis is None]
        road = free[0] if free else MergedRoad(axis)
        if not free:
            streets.append(road)
        road.axis = axis
    if vehicle not in road.vehicles:
        road.vehicles.append(vehicle)


def _place_rest(streets: list[MergedRoad]) -> None:
    """Roads still without an axis: the other names of placed roads in their order, or the crossing road."""
    placed = [r for r in streets if r.axis]
    free = [r for r in streets if r.axis is None]
    lacking = [r for r in placed if not _counted(r.lanes)]
    if len(free) > 1 and len(lacking) > 1:
        for road, other in zip(free, lacking, strict=False):
            other.lanes = merged(other.lanes, road.lanes)
            streets.remove(road)
        return
    for road in free:
        _place_one(streets, placed, road)


def _place_one(streets: list[MergedRoad], placed: list[MergedRoad], road: MergedRoad) -> None:
    lacking = [r for r in placed if not _counted(r.lanes)]
    if not placed:
        road.axis = "N"
        placed.append(road)
    elif lacking and not road.cross:
        for other in lacking:
            other.lanes = merged(other.lanes, road.lanes)
        streets.remove(road)
    elif len(placed) == 1 and (road.cross or not alike_lanes(road.lanes, placed[0].lanes)) and not road.lanes.empty:
        road.axis = axis_of(turned(placed[0].axis or "N", 90))
        road.cross = True
        placed.append(road)
    else:
        later = [r for r in placed if min(r.sentences, default=0) > min(road.sentences, default=0)]
        namesakes = [r for r in later if r.lanes.one_way and alike_lanes(r.lanes, road.lanes)]
        if len(namesakes) == 1:  # "the one-way street" of a later sentence has the lanes that were counted before
            namesakes[0].lanes = merged(namesakes[0].lanes, road.lanes)
        streets.remove(road)
