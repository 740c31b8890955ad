"""The place of a report in the maps that a user gave: found by the names of its streets or by coordinates, and fitted.

Of several places of the same names the one stands that fits what is told best; where two fit equally none does. Knows
maps and the reading; draws nothing.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import combinations
from typing import NamedTuple

from sgcad_core.formats.osm.fit import Fit, fit_of
from sgcad_core.formats.osm.junctions import Cluster, blocks_of, junction_at, junctions_of, nearest_point
from sgcad_core.formats.osm.legs import junction_place, street_place
from sgcad_core.formats.osm.names import StreetName, street_name
from sgcad_core.formats.osm.street_map import StreetMap
from sgcad_core.geometry.globe import Plane, Spot
from sgcad_core.kinds import JOINING, PARKING_LOT, RAMP, junction_kind
from sgcad_core.reading.roads.named_places import NamedPlaces, NamedStreet, named_places
from sgcad_core.reading.roads.road_facts import RoadFacts
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import COMPASS
from sgcad_core.records.place import MapPlace, Place
from sgcad_core.records.specs import Compass, RoadLayout

NEAR_M = 60.0
"""A junction this near to told coordinates is meant by them."""
BESIDE_M = 100.0
"""A street this near to told coordinates is meant by them."""
SURE = 0.1
"""By how much the score of a place must be above all others."""
SAME_M = 20.0
"""Extracts overlap: places nearer than this are one."""


class _Candidate(NamedTuple):
    place: MapPlace
    fit: Fit
    score: float


def axes_of(narrative: str) -> dict[Compass, tuple[StreetName, ...]]:
    """The streets that a narrative tells to run along an axis, by their names."""
    found: dict[Compass, tuple[StreetName, ...]] = {}
    for street in named_places(narrative).streets:
        name = street_name(street.text)
        for axis in dict.fromkeys(map(axis_of, street.ways)):
            found[axis] = (*found.get(axis, ()), *([name] if name else ()))
    return found


def real_place(narrative: str, facts: RoadFacts, told: RoadLayout, maps: Sequence[StreetMap]) -> Place:
    """Where the report's place is, or why it was not found. `told`: the layout of the text, as it counts lanes."""
    if facts.junction.kind in (RAMP, PARKING_LOT):
        return _lost(f"{junction_kind(facts.junction.kind).called} is drawn as told")
    named = named_places(narrative)
    if not named.some:
        return _lost("the report names no street and no coordinates")
    meets = junction_kind(facts.junction.kind).legs > 2 and facts.junction.kind not in JOINING
    found = [place for made in maps for place in (_junctions if meets else _points)(made, named)]
    if not found:
        return _lost(_why_none(named, maps, meets))
    axes = axes_of(narrative)
    fitted = [(place, fit_of(facts, told, place, axes)) for place in _distinct(found)]
    fits = [_Candidate(p, fit, _score(p, fit, named, narrative, maps)) for p, fit in fitted if not fit.reason]
    if not fits:
        return _lost(f"{_called(fitted[0][0])} in {fitted[0][0].source} does not fit: {fitted[0][1].reason}")
    return _best(fits)


def _best(fits: Sequence[_Candidate]) -> Place:
    """The best of the places that fit; none where two fit equally well."""
    ranked = sorted(fits, key=lambda one: -one.score)
    first, *rest = ranked
    if rest and rest[0].score > first.score - SURE:
        at = "; ".join(f"{c.place.latitude:.5f}, {c.place.longitude:.5f}" for c in ranked[:4])
        known = "; ".join(dict.fromkeys(_called(c.place) for c in ranked[:4]))
        return _lost(f"{len(ranked)} places fit equally ({known}: {at}); tell its town or its coordinates")
    return Place(found=True, place=first.place, legs=first.fit.legs, facts=first.fit.facts)


def _lost(reason: str) -> Place:
    return Place(found=False, reason=reason)


def _called(place: MapPlace) -> str:
    return " and ".join(place.streets) or f"{place.latitude:.5f}, {place.longitude:.5f}"


def _distinct(found: Sequence[MapPlace]) -> list[MapPlace]:
    """The places without those that another extract has too."""
    kept: list[MapPlace] = []
    for place in found:
        plane = Plane(place.latitude, place.longitude)
        if all(math.hypot(*plane.metres((k.latitude, k.longitude))) > SAME_M for k in kept):
            kept.append(place)
    return kept


def _score(place: MapPlace, fit: Fit, named: NamedPlaces, narrative: str, maps: Sequence[StreetMap]) -> float:
    """How well a place is meant: 1 for each fact that agrees, -1 against; nearness to coordinates and the town's name
    weigh more, the angles of the legs less than any of them."""
    score = sum(1.0 if fact.agrees else -1.0 for fact in fit.facts) - fit.off_deg / 100.0
    if named.latitude is not None and named.longitude is not None:
        off = math.hypot(*Plane(place.latitude, place.longitude).metres((named.latitude, named.longitude)))
        score -= min(off / 10.0, 1000.0)
    made = next(made for made in maps if made.source == place.source)
    town = _town_of(made, (place.latitude, place.longitude))
    return score + (10.0 if town and town.lower() in narrative.lower() else 0.0)


def _town_of(made: StreetMap, spot: Spot) -> str:
    """The settlement of the extract nearest to a place; "" where it names none."""
    plane = Plane(*spot)
    return min(made.settlements, key=lambda one: math.hypot(*plane.metres(one[1])), default=("", spot))[0]


# ------------------------------------------------------------------ places of a map
def _ways(made: StreetMap, named: NamedPlaces) -> dict[NamedStreet, Mapping[int, int]]:
    """The named streets that the map has, with their ways; a second spelling of the same ways is left out."""
    found: dict[NamedStreet, Mapping[int, int]] = {}
    for street in named.streets:
        name = street_name(street.text)
        ways = made.named(name) if name else {}
        if ways and all(set(ways) != set(other) for other in found.values()):
            found[street] = ways
    return found


def _junctions(made: StreetMap, named: NamedPlaces) -> Iterator[MapPlace]:
    """The junctions of any two named streets; without such the one at the coordinates."""
    ways, some = _ways(made, named), False
    for one, other in combinations(ways, 2):
        for cluster in junctions_of(made, ways[one], ways[other]):
            some = True
            yield junction_place(made, cluster, _on_map(made, cluster, (ways[one], ways[other])))
    if not some and named.latitude is not None and named.longitude is not None:
        near = junction_at(made, (named.latitude, named.longitude), NEAR_M)
        if near:
            yield junction_place(made, near, _on_map(made, near, ()))


def _on_map(made: StreetMap, cluster: Cluster, streets: Sequence[Mapping[int, int]]) -> tuple[str, ...]:
    """The streets' names as the map has them, of the ways at the junction."""
    here = [i for node in sorted(cluster.nodes) for i in made.at[node] if not made.ways[i].ring]
    groups = [[i for i in here if i in ways] for ways in streets] or [[i] for i in here]
    named = (_name(made, group[0]) for group in groups if group)
    return tuple(dict.fromkeys(name for name in named if name))


def _name(made: StreetMap, way: int) -> str:
    tags = made.ways[way].tags
    return tags.get("name") or tags.get("ref", "")


def _points(made: StreetMap, named: NamedPlaces) -> Iterator[MapPlace]:
    """The point of the street of the crash: of the first named one that the map has, or nearest to the coordinates."""
    ways = _ways(made, named)
    spot = (named.latitude, named.longitude)
    if spot[0] is not None and spot[1] is not None:
        pool = [i for street in ways.values() for i in street] or range(len(made.ways))
        near = nearest_point(made, pool, (spot[0], spot[1]))
        if near and near[1] <= BESIDE_M:
            yield street_place(made, near[0], (_name(made, near[0].way),), "nearest to the coordinates")
        return
    street = next(iter(ways), None)
    if street is None:
        return
    main = ways[street]
    for wanted, how in _spots(made, ways, main, named):
        if near := nearest_point(made, main, wanted):
            yield street_place(made, near[0], (_name(made, near[0].way),), how)


def _spots(
    made: StreetMap, ways: Mapping[NamedStreet, Mapping[int, int]], main: Mapping[int, int], named: NamedPlaces
) -> list[tuple[Spot, str]]:
    """Places on or near the street, and in words how they were chosen."""
    met = {s.text: junctions_of(made, main, other) for s, other in ways.items() if other is not main}
    corners = {text: [c.place for c in clusters] for text, clusters in met.items() if clusters}
    away = named.away
    if away and away.street in corners:
        angle = math.radians(45.0 * COMPASS.index(away.way))
        step = away.metres * math.sin(angle), away.metres * math.cos(angle)
        how = f"{away.metres:.0f} m {away.way} of {away.street}"
        return [(Plane(*corner).spot(*step), how) for corner in corners[away.street]]
    blocks = blocks_of(made, main)
    if len(corners) > 1:
        (one, first), (other, second) = list(corners.items())[:2]
        middle = (first[0][0] + second[0][0]) / 2, (first[0][1] + second[0][1]) / 2
        return [(middle, f"halfway between {one} and {other}")]
    for text, places in corners.items():
        return [(_nearest(blocks, corner), f"the middle of the block next to {text}") for corner in places]
    return [(blocks[0][0], "the middle of its longest block, since the report does not tell where on it")]


def _nearest(blocks: Sequence[tuple[Spot, float]], corner: Spot) -> Spot:
    """The middle of the block that is nearest to a corner."""
    return min((middle for middle, _ in blocks), key=lambda middle: math.hypot(*Plane(*corner).metres(middle)))


def _why_none(named: NamedPlaces, maps: Sequence[StreetMap], meets: bool) -> str:
    """Why no place was found."""
    files = ", ".join(made.source for made in maps[:4]) + (f" and {len(maps) - 4} more" if len(maps) > 4 else "")
    if not named.streets:
        return f"no {'junction' if meets else 'street'} of {files} is near {named.latitude}, {named.longitude}"
    known = {street.text for made in maps for street in _ways(made, named)}
    lacking = [s.text for s in named.streets if s.text not in known and s.sure]
    if len(known) > 1:
        return f"{' and '.join(sorted(known))} do not meet in {files}"
    has = f"{files} has {next(iter(known))} but" if known else f"{files} has"
    if lacking:
        return f"{has} no {' and no '.join(lacking)}"
    if known and meets:
        return f"the report names {next(iter(known))} alone, and a junction needs two streets"
    return f"{has} none of {', '.join(s.text for s in named.streets)}"
