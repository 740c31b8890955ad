"""The roads of a report laid on a real junction: the map's legs under the bearings that the report knows them by.

A leg of the map takes the bearing of the told leg that it lies nearest to, and its own heading as a skew. What the text
tells stands; what it leaves open is the map's. Knows no map file.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from sgcad_core.formats.osm.map_facts import compared, kind_told, lanes_agree, road_of, told_totals
from sgcad_core.formats.osm.names import StreetName, street_name
from sgcad_core.geometry.plane import Floats
from sgcad_core.kinds import JOINING
from sgcad_core.reading.layout.legs_used import legs_used
from sgcad_core.reading.roads.road_facts import RoadFact, RoadFacts
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import COMPASS, NAMES
from sgcad_core.records.place import LaidLeg, MapLeg, MapPlace, Place, PlaceFact
from sgcad_core.records.specs import Compass, Leg, RoadLayout, ToldRoad

NEAR_DEG = 35.0
"""Between a street as told and on the map, as the account and the validator `road_narrative` have it."""
NAMED_DEG = 60.0
"""The same of a street that is told by name to run that way: reports call a diagonal street by two compass points."""
MOST_SKEW_DEG = 40.0
_BESIDE_DEG = 75.0
"""A leg that is told beside one of the map that lies this near is that one, and it does not fit."""
_FAR = 1e6


Axes = Mapping[Compass, Sequence[StreetName]]


@dataclass(frozen=True)
class Fit:
    """A real place under a report's bearings. `reason`: why it does not fit; "" where it does."""

    reason: str
    legs: tuple[LaidLeg, ...] = ()
    facts: tuple[PlaceFact, ...] = ()
    layout: RoadLayout | None = None
    off_deg: float = 0.0
    """Mean angle between told and real legs."""


class _Pairs(NamedTuple):
    by_bearing: dict[Compass, MapLeg]
    """Legs of the map at told bearings."""
    further: list[MapLeg]
    """Legs of the map that no told leg lies near."""
    lacking: list[Leg]
    """Told legs that the map has not."""


def fit_of(facts: RoadFacts, told: RoadLayout, real: MapPlace, axes: Axes | None = None) -> Fit:
    """The place laid under the told legs. `told`: the layout of the text alone, without lanes added for vehicles;
    `axes`: names of the streets that are told to run along an axis."""
    streets = [leg for leg in told.legs if leg.kind not in JOINING]
    joining = [leg for leg in told.legs if leg.kind in JOINING]
    pairs = _paired(streets, real.legs, axes or {})
    if reason := _misfit(facts, pairs, real):
        return Fit(reason)
    kept, lacking = _legs_kept(facts, pairs, len(streets))
    laid = _with_bearings(pairs.by_bearing, kept, {leg.bearing for leg in (*joining, *lacking)})
    ours = {leg.bearing: leg for leg in streets}
    drawn = [_laid(one, ours.get(one.bearing), facts, real) for one in laid]
    circle = told.circle_lanes or (real.circle_lanes if not kind_told(facts) else 0)
    layout = told.model_copy(update={"legs": (*drawn, *lacking, *joining), "circle_lanes": circle})
    return Fit("", tuple(laid), tuple(compared(facts, laid, real)), layout, _mean_off(pairs.by_bearing))


# ------------------------------------------------------------------ a place that was found
def laid_on(place: Place | None, facts: RoadFacts, axes: Axes) -> Callable[[RoadLayout], RoadLayout] | None:
    """What lays a layout on a place; None where none was found. Legs keep the told bearings, however far they lie off:
    `settled` comes last."""
    if place is None or not place.found or place.place is None:
        return None
    real = place.place
    return lambda roads: fit_of(facts, roads, real, axes).layout or roads


def settled(layout: RoadLayout, place: Place | None) -> tuple[RoadLayout, Place | None]:
    """The layout with every leg at a bearing from which its skew reaches it; the place with the ids of its roads."""
    if place is None or not place.found:
        return layout, place
    moved: dict[Compass, Compass] = {}
    free = [bearing for bearing in COMPASS if all(leg.bearing != bearing for leg in layout.legs)]
    legs = list(layout.legs)
    for i, leg in enumerate(legs):
        heading = 45.0 * COMPASS.index(leg.bearing) + leg.skew_deg
        if abs(leg.skew_deg) > MOST_SKEW_DEG and free:
            to = min(free, key=lambda bearing, heading=heading: _off_deg(bearing, heading))  # type: ignore[misc]
            free.remove(to)
            moved[leg.bearing] = to
            legs[i] = leg.model_copy(update={"bearing": to, "skew_deg": round(_skew_deg(to, heading))})
    accesses = tuple(a.model_copy(update={"leg": moved.get(a.leg, a.leg)}) for a in layout.accesses)
    laid = tuple(one.model_copy(update={"road": moved.get(one.bearing, one.bearing)}) for one in place.legs)
    drawn = layout.model_copy(update={"legs": tuple(legs), "accesses": accesses})
    return RoadLayout.model_validate(drawn.model_dump()), place.model_copy(update={"legs": laid})


def posted_on_map(told: Mapping[str, ToldRoad], place: Place | None) -> dict[str, ToldRoad]:
    """The told roads, with limits that the map has as posted ones."""
    limited = {one.road for one in place.legs if one.leg.limit_mph} if place else set()
    return {
        name: road._replace(posted=True) if name.partition("_")[0] in limited else road for name, road in told.items()
    }


def known_from(place: Place | None, note: str) -> bool:
    """Whether a note says that something is not told which the map tells."""
    found = place is not None and place.found and all(one.leg.lanes_known for one in place.legs)
    return found and ("lanes are not stated" in note or "kind of junction" in note)


# ------------------------------------------------------------------ which leg is which
def _assigned(costs: Floats) -> tuple[Sequence[int], Sequence[int]]:
    """Rows and columns of the cheapest pairs."""
    from scipy.optimize import linear_sum_assignment  # slow to load, and few reports come with a map

    rows, columns = linear_sum_assignment(costs)
    return rows, columns


def _paired(streets: Sequence[Leg], legs: Sequence[MapLeg], axes: Axes) -> _Pairs:
    """Told legs and those of the map, so that the angles between them are least in sum."""
    costs = np.array([[_apart(told.bearing, leg, axes) for leg in legs] for told in streets])
    rows, columns = _assigned(costs) if costs.size else ((), ())
    pairs = {int(i): int(k) for i, k in zip(rows, columns, strict=True) if costs[i, k] < _FAR}
    return _Pairs(
        {streets[i].bearing: legs[k] for i, k in pairs.items()},
        [leg for k, leg in enumerate(legs) if k not in pairs.values()],
        [leg for i, leg in enumerate(streets) if i not in pairs],
    )


def _apart(bearing: Compass, leg: MapLeg, axes: Axes) -> float:
    """Degrees between a told leg and one of the map; very many where they cannot be the same."""
    wanted = axes.get(axis_of(bearing), ())
    own = [name for text in leg.names if (name := street_name(text))]
    named = any(one.likeness(name) for one in own for name in wanted)
    off = _off_deg(bearing, leg.heading_deg)
    other = bool(wanted) and bool(own) and not named
    return _FAR if other or off > (NAMED_DEG if named else NEAR_DEG) else off


def _misfit(facts: RoadFacts, pairs: _Pairs, real: MapPlace) -> str:
    """Why the map's legs do not carry the told ones; "" where they do."""
    used = [leg for leg in pairs.lacking if leg.bearing in legs_used(facts, faced=True)]
    turned = [
        o.heading_deg for leg in used for o in pairs.further if _off_deg(leg.bearing, o.heading_deg) < _BESIDE_DEG
    ]
    matched = [bearing for bearing in pairs.by_bearing if bearing in legs_used(facts)]
    if len(used) < 2 and not turned and pairs.by_bearing and (matched or not legs_used(facts)):
        return ""
    lie = ", ".join(f"{leg.heading_deg:.0f}" for leg in real.legs)
    wanted = ", ".join(NAMES[leg.bearing] for leg in used or pairs.lacking)
    return f"the report has roads to the {wanted}, the legs on the map lie at {lie} degrees"


def _legs_kept(facts: RoadFacts, pairs: _Pairs, told: int) -> tuple[list[MapLeg], list[Leg]]:
    """Further legs of the map, and told legs that it lacks, that are drawn: the number of legs is the told one where it
    is told, and vehicles have the legs that they use."""
    used = legs_used(facts)
    if not kind_told(facts):
        return pairs.further, [leg for leg in pairs.lacking if leg.bearing in used]
    room = max(told - len(pairs.by_bearing) - sum(leg.bearing in used for leg in pairs.lacking), 0)
    kept = pairs.further[:room]
    lacking = sorted(pairs.lacking, key=lambda leg: leg.bearing not in used)
    return kept, lacking[: max(told - len(pairs.by_bearing) - len(kept), 0)]


def _with_bearings(told: Mapping[Compass, MapLeg], further: Iterable[MapLeg], taken: set[Compass]) -> list[LaidLeg]:
    """All legs with a bearing each; further ones at the nearest free bearing within reach of a skew."""
    laid = [LaidLeg(bearing=bearing, leg=leg) for bearing, leg in told.items()]
    free = [bearing for bearing in COMPASS if bearing not in told and bearing not in taken]
    legs = list(further)
    costs = np.array([[_off_deg(bearing, leg.heading_deg) for bearing in free] for leg in legs])
    if costs.size:
        rows, columns = _assigned(np.where(costs <= MOST_SKEW_DEG, costs, _FAR))
        laid += [
            LaidLeg(bearing=free[k], leg=legs[i])
            for i, k in zip(rows, columns, strict=True) if costs[i, k] <= MOST_SKEW_DEG
        ]  # fmt: skip
    return laid


def _off_deg(bearing: Compass, heading_deg: float) -> float:
    return abs(_skew_deg(bearing, heading_deg))


def _skew_deg(bearing: Compass, heading_deg: float) -> float:
    """How far a heading lies clockwise of a bearing, degrees."""
    return math.remainder(heading_deg - 45.0 * COMPASS.index(bearing), 360.0)


def _mean_off(pairs: Mapping[Compass, MapLeg]) -> float:
    return sum(_off_deg(b, leg.heading_deg) for b, leg in pairs.items()) / max(len(pairs), 1)


# ------------------------------------------------------------------ what stands
def _laid(one: LaidLeg, ours: Leg | None, facts: RoadFacts, real: MapPlace) -> Leg:
    """The leg as it is drawn."""
    leg, road = one.leg, road_of(facts, one.bearing)
    drawn = ours or Leg(bearing=one.bearing, lanes_in=1, lanes_out=1)
    update: dict[str, Any] = {"skew_deg": round(_skew_deg(one.bearing, leg.heading_deg)), "curve": "none"}
    update |= _lanes(leg, drawn, road, facts)
    if "control" not in facts.junction.where and len(real.legs) > 2:
        update["control"] = leg.control if update["lanes_in"] else "none"
    if leg.limit_mph and not (road and road.speed_limit_mph):
        update["speed_limit_mph"] = leg.limit_mph
    if drawn.median == "none" and leg.median != "none" and update["lanes_in"] and update["lanes_out"]:
        update["median"] = leg.median
    return drawn.model_copy(update=update)


def _lanes(leg: MapLeg, drawn: Leg, road: RoadFact | None, facts: RoadFacts) -> dict[str, Any]:
    """Lanes of the map where the text leaves them open or tells as many; where the map does not count them, the usual
    ones, but only in the directions that it has."""
    counts = (leg.lanes_in, leg.lanes_out)
    told = told_totals(road)
    if told and not lanes_agree(told, leg):
        return {"lanes_in": drawn.lanes_in, "lanes_out": drawn.lanes_out}
    if not leg.lanes_known:
        usual = (drawn.lanes_in or 1, drawn.lanes_out or 1)
        counts = (usual[0] if counts[0] else 0, usual[1] if counts[1] else 0)
    ways = _ways_needed(facts, drawn.bearing)
    counts = (max(counts[0], ways[0]), max(counts[1], ways[1]))
    turns = (
        leg.turns_in if len(leg.turns_in) == counts[0] else drawn.turns_in if len(drawn.turns_in) == counts[0] else ()
    )
    center = {"center_turn_lane": True} if leg.center_turn_lane and all(counts) else {}
    return {"lanes_in": counts[0], "lanes_out": counts[1], "turns_in": turns, **center}


def _ways_needed(facts: RoadFacts, bearing: Compass) -> tuple[int, int]:
    """1 for each direction of a leg, in and out, in which a vehicle is told to drive."""
    inward = COMPASS[(COMPASS.index(bearing) + 4) % 8]
    driving = [v for v in facts.crash.vehicles if v.heading_stated and v.maneuver not in ("parked", "backing")]
    return int(any(v.heading == inward for v in driving)), int(any(v.exit_heading == bearing for v in driving))
