"""Parts of an OpenDRIVE file that netconvert ignores, in SUMO's terms: signs, center lanes, merging lanes.

An approach is named as netconvert names edges: road "7" gives "-7" along s and "7" against it. Junctions keep
their ids. Reads the codes that this project writes (US R1-1, R1-2) and Germany's (206, 205), which many
tools use for every country.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Literal, NamedTuple

from sgcad_core.formats.opendrive.geometry import number
from sgcad_core.formats.xml import Element

Sign = Literal["stop", "yield"]
LaneLink = tuple[str, int, str, int]
"""Approach, lane index from the right curb, edge behind the junction, lane index."""
IMPORTED = frozenset({
    "driving", "stop", "restricted", "parking", "entry", "exit", "offRamp", "onRamp", "mwyEntry", "mwyExit",
    "bidirectional", "roadWorks", "tram", "rail",
})  # fmt: skip
"""Lane types that netconvert makes lanes of (its opendriveNetconvert.typ.xml); the others are left out of the count."""
SIGNS: Mapping[str, Sign] = {"R1-1": "stop", "206": "stop", "R1-2": "yield", "205": "yield"}


class SignedJunction(NamedTuple):
    """A junction with signs: SUMO's node type, the project's word for the control, approaches that give way."""

    type: str
    control: str
    minor: frozenset[str]


def signed_junctions(root: Element) -> dict[str, SignedJunction]:
    """Junctions with stop or yield signs and without signal heads, by id."""
    signs = _signs(root)
    found = {}
    for junction, approaches in _approaches(root).items():
        told = {edge: signs[edge] for edge in approaches if edge in signs}
        if told and "head" not in told.values():
            found[junction] = _junction(told, approaches)
    return found


def _junction(told: Mapping[str, str], approaches: frozenset[str]) -> SignedJunction:
    minor = frozenset(told)
    if "stop" in told.values():
        every = all(told.get(edge) == "stop" for edge in approaches)
        return (
            SignedJunction("allway_stop", "all_way_stop", minor)
            if every
            else SignedJunction("priority_stop", "stop", minor)
        )
    return SignedJunction("priority", "yield", minor)


def _signs(root: Element) -> dict[str, str]:
    """The control at the end of each approach: "stop", "yield" or "head" (a signal head outranks signs)."""
    found: dict[str, str] = {}
    for road in root.iterfind("road"):
        for signal in road.iterfind("signals/signal"):
            kind = "head" if is_head(signal) else SIGNS.get(signal.get("type", ""))
            for edge in _edges_at(road, signal) if kind else ():
                found[edge] = "head" if "head" in (kind, found.get(edge)) else str(kind)
    return found


def is_head(signal: Element) -> bool:
    """Whether a signal is a traffic light."""
    return bool(signal.get("type", "").startswith("10000") and signal.get("dynamic") == "yes")


def _edges_at(road: Element, signal: Element) -> Iterator[str]:
    """The approach that a signal stands for."""
    if signal.get("orientation") in ("+", "none"):
        yield f"-{road.get('id')}"
    if signal.get("orientation") in ("-", "none"):
        yield str(road.get("id"))


def _approaches(root: Element) -> dict[str, frozenset[str]]:
    """Junction -> approaches that lead into it by a lane."""
    return {
        str(junction.get("id")): frozenset(
            f"{'-' if number(link, 'from') < 0 else ''}{connection.get('incomingRoad')}"
            for connection in junction.iterfind("connection")
            for link in connection.iterfind("laneLink")
        )
        for junction in root.iterfind("junction")
    }


def imported_lanes(root: Element) -> dict[str, list[Element]]:
    """Edge -> the <lane> elements that netconvert makes lanes of, from the right curb; roads of one section."""
    found: dict[str, list[Element]] = {}
    for road in root.iterfind("road[@junction='-1']"):
        sections = road.findall("lanes/laneSection")
        for side, mark in (("right", "-"), ("left", "")) if len(sections) == 1 else ():
            lanes = [lane for lane in sections[0].iterfind(f"{side}/lane") if lane.get("type") in IMPORTED]
            if lanes:
                lanes.sort(key=lambda lane: -abs(number(lane, "id")))
                found[f"{mark}{road.get('id')}"] = lanes
    return found


def width_of(lane: Element) -> float | None:
    """The greatest width at the beginning of a <width> of a lane, as netconvert takes it; None where it has none."""
    return max((number(width, "a") for width in lane.iterfind("width")), default=None)


# ------------------------------------------------------------------ lanes across junctions
def lane_links(root: Element) -> frozenset[LaneLink]:
    """Ways across junctions, lane to lane, over connecting roads of one lane section.

    netconvert takes only the first of several lanes of a road that lead into one lane.
    """
    roads = {str(road.get("id")): road for road in root.iterfind("road")}
    found = set()
    for connection in root.iterfind("junction/connection"):
        inner = roads.get(connection.get("connectingRoad"))
        came = roads.get(connection.get("incomingRoad"))
        if inner is not None and came is not None and connection.get("contactPoint") == "start":
            found |= set(_links(connection, came, inner, roads))
    return frozenset(found)


def _links(connection: Element, came: Element, inner: Element, roads: Mapping[str, Element]) -> Iterator[LaneLink]:
    target = inner.find("link/successor[@elementType='road']")
    goes = roads.get(target.get("elementId")) if target is not None else None
    if goes is None or len(inner.findall("lanes/laneSection")) != 1:
        return
    for link in connection.iterfind("laneLink"):
        end = inner.find(f"lanes/laneSection/*/lane[@id='{link.get('to')}']/link/successor")
        places = _place(came, link.get("from")), _place(goes, None if end is None else end.get("id"))
        if places[0] and places[1]:
            yield (*places[0], *places[1])


def _place(road: Element, lane: str | None) -> tuple[str, int] | None:
    """netconvert's edge and lane index of a lane; None where it makes none."""
    sections = road.findall("lanes/laneSection")
    found = None if lane is None else sections[0].find(f"*/lane[@id='{lane}']")
    if len(sections) != 1 or found is None or found.get("type") not in IMPORTED:
        return None
    here = int(number(found, "id"))
    outside = [other for other in found.getparent().iterfind("lane") if other.get("type") in IMPORTED]
    index = sum(abs(number(other, "id")) > abs(here) for other in outside)
    return f"{'-' if here < 0 else ''}{road.get('id')}", index
