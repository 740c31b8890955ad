"""The answer that a reading gives to each question of `sgcad_core.reading.second_reader.numbered.numbered_questions`.

"+" stands between answers that are the same. Knows no words and no weights.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

from sgcad_core.kinds import actor_kind
from sgcad_core.reading.text.compass import between, turned

if TYPE_CHECKING:
    from sgcad_core.reading.contacts.contact_records import ContactFacts
    from sgcad_core.reading.crash_facts import CrashFacts, VehicleFacts
    from sgcad_core.records.specs import Area, Compass, RoadLayout

_LEFT, _RIGHT = "lane_change_left", "lane_change_right"
MANEUVERS: Mapping[str, str] = {
    "straight": "straight", "slowing": "straight", "negotiating_curve": "straight", "other": "straight",
    "departing_road_left": "straight", "departing_road_right": "straight", "stopped": "stopped", "parked": "stopped",
    "turn_left": "turn_left", "turn_right": "turn_right", "u_turn": "u_turn", "backing": "backing", _LEFT: _LEFT,
    "crossing_centerline": _LEFT, "overtaking": _LEFT, _RIGHT: _RIGHT, "merge": f"{_LEFT}+{_RIGHT}",
}  # fmt: skip
"""Maneuver -> the one that stands for it among the answers; "+": either."""


def answer_of(question: str, crash: CrashFacts, layout: RoadLayout) -> str | None:
    """The answer of a reading to a question ("maneuver.V1"); None where it has none."""
    kind, _, of = question.partition(".")
    if kind == "junction":
        return "yes" if len(layout.legs) > 2 or layout.accesses else "no"
    v, one = crash.vehicle(of), crash.vehicle("V1")
    if v is None:
        return None
    if kind == "turned":
        return relative(one, v) if one else None
    if kind == "area":
        return side_of(crash, of)
    if kind == "met":
        return met(crash, of)
    return MANEUVERS[v.maneuver] if kind == "maneuver" else lanes_of(v, layout)


def same(answer: str, own: str | None) -> bool:
    """Whether an answer is the rules' own."""
    return own is not None and answer in own.split("+")


def first_contact(crash: CrashFacts) -> ContactFacts | None:
    """The crash's first contact, if the rules can read one."""
    return crash.contacts[0] if crash.contacts and not crash.gap else None


def side_of(crash: CrashFacts, vehicle: str) -> Area | None:
    """The side of a vehicle that the crash's first contact touches; None where it has no part in that."""
    first = first_contact(crash)
    if first is None or vehicle not in (first.striker, first.struck):
        return None
    return first.striker_area if vehicle == first.striker else first.struck_area


def met(crash: CrashFacts, vehicle: str) -> str:
    """What a vehicle's first contact is with."""
    mine = crash.first_contact(vehicle) if not crash.gap else None
    if mine is None:
        return "thing" if any(i.actor == vehicle for i in crash.impacts) else "none"
    other = mine.struck if mine.striker == vehicle else mine.striker
    if other.startswith("V"):
        return "vehicle"
    kind = next((o.kind for o in crash.others if o.id == other), "object")
    return "animal" if other.startswith("A") else "person" if actor_kind(kind).walks or other[0] in "PB" else "thing"


def relative(one: VehicleFacts, two: VehicleFacts) -> str | None:
    """How far clockwise the second body is turned against the first one, to 90 degrees."""
    ways = [body_way(v) for v in (one, two)]
    if ways[0] is None or ways[1] is None:
        return None
    return str(round(between(ways[0], ways[1]) / 90) % 4 * 90)


def body_way(v: VehicleFacts) -> Compass | None:
    """Where its front points: a vehicle that backs goes the other way."""
    if v.heading is None:
        return None
    return turned(v.heading, 180) if v.maneuver == "backing" and not v.faces else v.heading


def lanes_of(v: VehicleFacts, layout: RoadLayout) -> str | None:
    """Lanes of the leg that a vehicle comes in on; None where it comes in on none."""
    bearing = turned(v.heading, 180) if v.heading else None
    leg = next((leg for leg in layout.legs if leg.bearing == bearing), None)
    return f"own{leg.lanes_in}+both{leg.lanes_in + leg.lanes_out}" if leg else None
