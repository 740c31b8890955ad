"""What a reader claims of a crash, field by field, in terms that rules and model share.

A claim is a value with how sure it is. Fields are named by what they are of: `heading.V1`, `maneuver.V1`, `exit.V1`,
`kind.V1`, `lane.V1`, `speed.V1` (mph), `contact` (striker, struck), `areas` (side by id), `legs` (bearings), by axis
`lanes.N` (bearing, in, out), `turns.N`, `median.N`, `curve.N`, `limit.N` (mph), `control`, `light`, `weather`,
`surface`. Knows no prompt and no token.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import product
from typing import TYPE_CHECKING, Any, NamedTuple

from sgcad_core.kinds import JOINING, actor_kind
from sgcad_core.reading.contacts.contact_records import AREAS
from sgcad_core.reading.inference.inference_state import QUARTER_DEG
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import turned
from sgcad_core.records.specs import Compass, Leg

if TYPE_CHECKING:
    from sgcad_core.reading.contacts.contact_records import ContactFacts
    from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
    from sgcad_core.reading.reading import Reading
    from sgcad_core.reading.roads.road_facts import RoadFact, RoadFacts
    from sgcad_core.records.course import CourseTold

_THROUGH = {"through_right": "through", "left_through": "through"}
"""Readers differ in whether they say that one may also turn from a through lane."""
_ONWARD = (
    "straight",
    "slowing",
    "stopped",
    "overtaking",
    "lane_change_left",
    "lane_change_right",
    "crossing_centerline",
)
"""Maneuvers that keep to the initial heading."""
KINDS = (
    "kind", "heading", "maneuver", "exit", "lane", "speed", "contact", "areas", "legs", "lanes", "turns", "median",
    "curve", "limit", "control", "light", "weather", "surface",
)  # fmt: skip
"""Kinds of fields, for which a combiner has weights."""
UNKNOWN_P = 0.5
"""Of a value whose model gives no probabilities, as servers do not, or has no head that says whether it is told: the
weights alone then decide."""


class Claim(NamedTuple):
    """A value; whether the evidence tells it (of the rules 0 or 1, of a model the probability); the value's own
    probability and its grounding, where the reader gives them."""

    value: Any
    told: float = 1.0
    p: float = 1.0
    nats: float = 0.0
    also: tuple[Any, ...] = ()
    """Other values that the told one allows as well: a corner is two sides, evasive steering to the left also leaves
    the lane to the left, and a lane on either edge is "left" or "right" whatever the number of lanes."""


Claims = dict[str, Claim]


def kind_of(field: str) -> str:
    """ "heading" of "heading.V1"."""
    return field.partition(".")[0]


# ------------------------------------------------------------------ the rules'
def rules_claim(reading: Reading) -> Claims:
    """What the rules make of a text: every value that they have, and whether the text tells it."""
    crash, roads = reading.crash, reading.roads
    found = {key: claim for v in crash.vehicles for key, claim in _vehicle(v, crash.courses.get(v.id))}
    found |= {f"kind.{other.id}": Claim(other.kind) for other in crash.others}
    legs = layout_of_facts(roads).legs
    found |= _ways(crash, legs)
    first = crash.contacts[0] if crash.contacts and not crash.gap else None
    if first is not None:
        found["contact"] = Claim((first.striker, first.struck), first.stated)
        sides = {first.striker: first.striker_area, first.struck: first.struck_area}
        found["areas"] = Claim(by_id(sides), _sides_told(first), also=_corners(first))
    for key in ("light", "weather", "surface"):
        if (value := getattr(crash, key)) is not None:
            found[key] = Claim(value)
    return found | dict(_roads(roads, legs))


def _vehicle(v: VehicleFacts, course: CourseTold | None) -> Iterator[tuple[str, Claim]]:
    yield f"kind.{v.id}", Claim(v.kind, v.make is None)
    if v.heading is not None:
        yield f"heading.{v.id}", Claim(v.heading, v.heading_stated or _turned_from(v))
    evading = _EVADING.get(course.steers, ()) if course is not None and course.steers else ()
    yield f"maneuver.{v.id}", Claim(v.maneuver, v.maneuver_stated, also=evading)
    if v.speed_mph is not None:
        yield f"speed.{v.id}", Claim(v.speed_mph)


_EVADING: Mapping[str, tuple[str, ...]] = {
    "left": ("lane_change_left", "departing_road_left", "crossing_centerline"),
    "right": ("lane_change_right", "departing_road_right"),
}
"""What a steering in evasion looks like to a reader that has maneuvers only."""


def _turned_from(v: VehicleFacts) -> bool:
    """Whether the heading follows from a told turn and the told way out."""
    turn = QUARTER_DEG.get(v.maneuver)
    return v.maneuver_stated and turn is not None and v.exit_heading == turned(v.heading or "N", turn)


def _sides_told(contact: ContactFacts) -> bool:
    """Whether the text tells a side or a corner of both."""
    return contact.areas_stated or max(len(contact.striker_may), len(contact.struck_may)) < len(AREAS)


def _corners(contact: ContactFacts) -> tuple[Any, ...]:
    """Sides by id that told corners allow as well; an untold side allows no other."""
    mays = [
        may if len(may) < len(AREAS) else (area,)
        for may, area in ((contact.striker_may, contact.striker_area), (contact.struck_may, contact.struck_area))
    ]
    return tuple(by_id({contact.striker: mine, contact.struck: theirs}) for mine, theirs in product(*mays))


def _ways(crash: CrashFacts, drawn: tuple[Leg, ...]) -> Claims:
    """Lane and way out of every vehicle: a lane may be told by a word, a way out follows from a turn."""
    legs = {leg.bearing: leg for leg in drawn}
    found: Claims = {}
    for v in crash.vehicles:
        if (out := _way_out(v, legs)) is not None:
            found[f"exit.{v.id}"] = Claim(out, v.exit_heading is not None or v.maneuver_stated)
        comes = legs.get(turned(v.heading, 180)) if v.heading else None
        if (lane := _lane(v, comes.lanes_in if comes else 0)) is not None:
            words = _EDGES.get(v.lane_word or "", ()) if v.lane is None else ()
            found[f"lane.{v.id}"] = Claim(lane, v.lane is not None or v.lane_word is not None, also=words)
    return found


_EDGES = {"left": ("left",), "left_turn": ("left",), "right": ("right",), "right_turn": ("right",)}
_TURN_DEG = {**QUARTER_DEG, "u_turn": 180}


def _way_out(v: VehicleFacts, legs: Mapping[Compass, Leg]) -> Compass | None:
    """The told way out, else the leg that is nearest to where the maneuver leads; None where there is none near."""
    if v.exit_heading is not None or v.heading is None:
        return v.exit_heading
    toward = turned(v.heading, _TURN_DEG.get(v.maneuver, 0))
    near = [turned(toward, by) for by in (0, -45, 45)]
    return next((leg for leg in near if leg in legs), None)


def _lane(v: VehicleFacts, lanes: int) -> int | None:
    """1 = at the right curb; of a word as many as the leg that it comes in on has (0: unknown)."""
    if v.lane is not None:
        return v.lane if v.lane > 0 else lanes + 1 + v.lane if lanes else None
    word = v.lane_word or ("right" if lanes == 1 else "")
    if word in ("right", "right_turn"):
        return 1
    return {"left": lanes, "left_turn": lanes, "middle": (lanes + 1) // 2}.get(word) or None


def _roads(facts: RoadFacts, legs: tuple[Leg, ...]) -> Iterator[tuple[str, Claim]]:
    junction = facts.junction
    bearings = tuple(sorted(leg.bearing for leg in legs))
    yield "legs", Claim(bearings, junction.stated and (junction.stem is None or junction.stem_stated))
    roads = {road.axis: road for road in facts.streets if road.axis}
    for axis, some in by_axis(legs):
        road = roads.get(axis)
        yield f"lanes.{axis}", Claim(lanes_of(some), facts.lists(axis) or (road is not None and _counted(road)))
        if turns := turns_of(some):
            yield f"turns.{axis}", Claim(turns)
        told = road is not None and (road.lanes.median is not None or road.lanes.divided is not None)
        yield f"median.{axis}", Claim(some[0].median, told)
        yield f"curve.{axis}", Claim(curves_of(some), bool(road and road.curve))
        if road is not None and road.speed_limit_mph is not None:
            yield f"limit.{axis}", Claim(road.speed_limit_mph)
    yield "control", Claim(control_of(legs), junction.control != "none")


def _counted(road: RoadFact) -> bool:
    lanes = road.lanes
    return bool(lanes.total or lanes.each_way or lanes.toward or lanes.own)


# ------------------------------------------------------------------ shared terms
def by_axis(legs: Iterable[Leg]) -> list[tuple[Compass, tuple[Leg, ...]]]:
    """The streets of a layout by the axis on which they lie, legs in the order of their bearings."""
    streets = sorted((leg for leg in legs if leg.kind not in JOINING), key=lambda leg: leg.bearing)
    axes = dict.fromkeys(axis_of(leg.bearing) for leg in streets)
    return [(axis, tuple(leg for leg in streets if axis_of(leg.bearing) == axis)) for axis in axes]


def lanes_of(some: Iterable[Leg]) -> tuple[tuple[str, int, int], ...]:
    """Bearing, lanes in and lanes out of every leg of a road."""
    return tuple((leg.bearing, leg.lanes_in, leg.lanes_out) for leg in some)


def turns_of(some: Iterable[Leg]) -> tuple[tuple[str, tuple[str, ...]], ...]:
    """Uses of the lanes of every leg that has turn lanes, from the right curb."""
    uses = ((leg.bearing, tuple(_THROUGH.get(turn, turn) for turn in leg.turns_in)) for leg in some)
    return tuple((bearing, turns) for bearing, turns in uses if {"left", "right"} & {*turns})


def curves_of(some: Iterable[Leg]) -> tuple[tuple[str, str], ...]:
    """Bends by bearing."""
    return tuple((leg.bearing, leg.curve) for leg in some if leg.curve != "none")


def control_of(legs: Iterable[Leg]) -> tuple[tuple[str, str], ...]:
    """What controls each leg that is controlled."""
    return tuple(sorted((leg.bearing, leg.control) for leg in legs if leg.control != "none"))


def by_id(sides: Mapping[str, str]) -> tuple[tuple[str, str], ...]:
    """Sides in the order of the ids, as a value that can be compared."""
    return tuple(sorted(sides.items()))


def vehicles_of(crash: CrashFacts) -> frozenset[str]:
    """Ids of all actors that the rules know."""
    return frozenset([*(v.id for v in crash.vehicles), *(o.id for o in crash.others)])


def sayable(heard: Claims, crash: CrashFacts) -> Claims:
    """The claims without kinds of those that the rules read as a kind of which the embedded model knows no word, and
    without departures of vehicles that first strike what lies in the road."""
    kinds = {v.id: v.kind for v in crash.vehicles} | {other.id: other.kind for other in crash.others}
    beyond = {f"kind.{name}" for name, kind in kinds.items() if not actor_kind(kind).learned}
    beyond |= departures_past_the_road(heard, crash)
    return {key: claim for key, claim in heard.items() if key not in beyond}


def departures_past_the_road(heard: Claims, crash: CrashFacts) -> set[str]:
    """Keys of departures from the road of vehicles that first strike what lies in it."""
    lying, found = {other.id for other in crash.others if other.lies}, set()
    for vehicle in crash.vehicles:
        first, key = crash.first_contact(vehicle.id), f"maneuver.{vehicle.id}"
        departs = key in heard and str(heard[key].value).startswith("departing")
        if departs and first is not None and first.struck in lying:
            found.add(key)
    return found
