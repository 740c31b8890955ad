"""Lanes, turns, limits and signs that the tags of a way tell. Pure functions on tags; know no geometry.

Forward is the direction in which the way's nodes stand. What the map does not tell is None, and the usual value of its
class stands in where one is needed.
"""

from __future__ import annotations

import re
from typing import NamedTuple, cast

from sgcad_core.formats.osm.street_map import MapWay, Tags
from sgcad_core.records.specs import Turn
from sgcad_core.units import MPS_PER_MPH

MOST_LANES = 8
_LIMIT = re.compile(r"^(\d{1,3})(?:\.\d+)? ?(mph|km/h|kmh|kph)?$")
_LIMITS_MPH = (5, 85)
_MPH_PER_KMH = 1 / (3.6 * MPS_PER_MPH)
_USES = {
    "left": "left", "slight_left": "left", "sharp_left": "left", "reverse": "left", "right": "right",
    "slight_right": "right", "sharp_right": "right", "through": "through", "none": "through", "": "through",
    "merge_to_left": "through", "merge_to_right": "through",
}  # fmt: skip
_TURNS: dict[frozenset[str], Turn] = {
    frozenset({"left"}): "left", frozenset({"through"}): "through", frozenset({"right"}): "right",
    frozenset({"left", "through"}): "left_through", frozenset({"through", "right"}): "through_right",
    frozenset({"left", "right"}): "left_right", frozenset({"left", "through", "right"}): "any",
}  # fmt: skip
_ONE_WAY_KINDS = ("motorway", "motorway_link")


class WayLanes(NamedTuple):
    """Lanes for cars by direction; `known`: as the map counts them."""

    forward: int
    backward: int
    known: bool
    both: int = 0
    """Lanes for turns from both directions."""


def one_way(way: MapWay) -> int:
    """1: forward only, -1: backward only, 0: both."""
    told = way.tags.get("oneway", "")
    if told in ("-1", "reverse"):
        return -1
    if told in ("yes", "true", "1"):
        return 1
    return 1 if told != "no" and (way.ring or way.tags["highway"] in _ONE_WAY_KINDS) else 0


def lanes_of(way: MapWay) -> WayLanes:
    """Lanes of both directions. An odd total of a two-way street without further tags has its odd lane forward."""
    only, total = one_way(way), _count(way.tags, "lanes")
    forward, backward, both = (_count(way.tags, f"lanes:{side}") for side in ("forward", "backward", "both_ways"))
    if only:
        count = (
            total or (forward if only > 0 else backward) or (2 if way.tags["highway"] in ("motorway", "trunk") else 1)
        )
        return WayLanes(count if only > 0 else 0, count if only < 0 else 0, bool(total or forward or backward))
    shared = both or 0
    if forward is None and backward is None:
        if total is None or total < 2:
            return WayLanes(1, 1, False, shared)
        each = total - shared
        return WayLanes(each - each // 2, each // 2, True, shared)
    rest = None if total is None else total - shared - (forward or 0) - (backward or 0)
    other = rest if rest is not None and rest > 0 else 1
    return WayLanes(
        forward if forward is not None else other, backward if backward is not None else other, True, shared
    )


def turns_of(way: MapWay, forward: bool, lanes: int) -> tuple[Turn, ...]:
    """Uses of the lanes of a direction at its end, from the right curb; () where they are not told of each lane."""
    key = "turn:lanes:forward" if forward else "turn:lanes:backward"
    told = way.tags.get(key) or (way.tags.get("turn:lanes") if one_way(way) else None)
    if told is None:
        return ()
    found = [_turn(lane) for lane in told.split("|")]
    return cast("tuple[Turn, ...]", tuple(found[::-1])) if len(found) == lanes and None not in found else ()


def _turn(lane: str) -> Turn | None:
    return _TURNS.get(frozenset(_USES.get(use.strip(), "?") for use in lane.split(";")))


def limit_mph(way: MapWay, forward: bool) -> int | None:
    """The posted limit, miles an hour; numbers without a unit are km/h, as OpenStreetMap has them."""
    told = way.tags.get("maxspeed:forward" if forward else "maxspeed:backward") or way.tags.get("maxspeed", "")
    m = _LIMIT.match(told)
    if m is None:
        return None
    limit = round(int(m[1]) * (1 if m[2] == "mph" else _MPH_PER_KMH))
    return limit if _LIMITS_MPH[0] <= limit <= _LIMITS_MPH[1] else None


def _count(tags: Tags, key: str) -> int | None:
    """A number of lanes within what a road has; None where there is none."""
    text = tags.get(key, "").split(";")[0]
    return min(int(text), MOST_LANES) if text.isascii() and text.isdigit() and int(text) else None
