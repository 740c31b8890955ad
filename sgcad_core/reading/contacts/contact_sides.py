"""The contacts with all their sides: corners decided, open sides completed from headings and maneuvers."""

from __future__ import annotations

from sgcad_core.reading.actors.pedestrians_objects import is_person
from sgcad_core.reading.contacts.contact_telling import Blow
from sgcad_core.reading.inference.inference_state import (
    AREAS,
    TURN_DEG,
    Draft,
    Joined,
    Settled,
    apart,
    end_of,
    is_sideswipe,
    side_hit,
)
from sgcad_core.reading.text.area_phrases import Zone
from sgcad_core.reading.text.compass import OPPOSITE_HAND, between
from sgcad_core.records.specs import Area

_SIDLING = ("lane_change_left", "lane_change_right", "merge", "overtaking")
_BENT = ("turn_left", "turn_right", "u_turn", *_SIDLING)


def join_contacts(draft: Draft, out: Settled, pairs: list[Blow]) -> list[Joined]:
    if not pairs and draft.who.counted and draft.blows:
        return []  # the report tells what was touched, and it is no vehicle
    if not pairs and any(blow.other not in draft.who.ids and is_person(blow.other) for blow in draft.blows):
        return []  # somebody without a number was hit; the vehicles are not told to have touched
    if not pairs and len(draft.who.ids) >= 2:
        a, b = draft.who.ids[:2]
        if draft.blows and frozenset((a, b)) in draft.missed:
            return []  # one of both struck something else
        return [_join(draft, out, Blow(a, b, None, None, 0, "impact", mutual=True))._replace(told=False)]
    return [_join(draft, out, blow) for blow in pairs]


def _join(draft: Draft, out: Settled, blow: Blow) -> Joined:
    """Striker first: the one that hits with its front where the other does not, or backs into it."""
    told = all(zone is not None and "/" not in zone for zone in (blow.actor_area, blow.other_area))
    a, b = blow.actor, blow.other
    area_a, area_b = _corners(draft, out, blow)
    if draft.who.counted and not (area_a and area_b):
        area_a, area_b = _brushed(out, blow, area_a, area_b)
    if area_a is None and area_b is None and is_sideswipe(blow):
        area_a, area_b = _sideswiped(out, a, b)
    if blow.mutual and area_a is None and area_b is None and _less_of_a_striker(out, a, b):
        a, b = b, a
    if area_a is None and area_b is None and (caught := _caught_up(draft, a, b)):
        a, b, area_a, area_b = *caught, "front", "back"
    area_a, area_b = complete_areas(out, a, b, area_a, area_b)
    leads_b = area_b == "front" and area_a != "front" and not _backs_into(out, a, area_a)
    if leads_b or (_backs_into(out, b, area_b) and _standing(out, a)):
        a, b, area_a, area_b = b, a, area_b, area_a
    may = {blow.actor: _allowed(blow.actor_area), blow.other: _allowed(blow.other_area)}
    return Joined(a, b, area_a, area_b, told, True, may[a], may[b])


def _caught_up(draft: Draft, a: str, b: str) -> tuple[str, str] | None:
    """Striker and struck where the codes say that one came from behind with more speed."""
    for struck, striker in ((a, b), (b, a)):
        if draft.motions[struck].did("code:hit_from_behind"):
            return striker, struck
    return None


def _allowed(zone: Zone | None) -> tuple[Area, ...]:
    """Sides that a phrase may mean."""
    return tuple(area for area in AREAS if area in zone.split("/")) if zone else AREAS


def _less_of_a_striker(out: Settled, a: str, b: str) -> bool:
    """Whether b rather than a hits with its front: a turns or stands and b goes straight; else the higher number."""
    bent_a, bent_b = (out.maneuvers[v] in _BENT or _standing(out, v) for v in (a, b))
    return (bent_a and not bent_b) or (bent_a == bent_b and int(a[1:]) > int(b[1:]))


def _brushed(out: Settled, blow: Blow, area_a: Area | None, area_b: Area | None) -> tuple[Area | None, Area | None]:
    """Who goes past another touches a told corner or flank of it with the flank that faces it."""
    oncoming = apart(between(out.headings.get(blow.actor, "N"), out.headings.get(blow.other, "N")), 180) <= 45
    for mine, me, zone in ((area_a, blow.actor, blow.other_area), (area_b, blow.other, blow.actor_area)):
        flank = next((side for side in (zone or "").split("/") if side in OPPOSITE_HAND), None)
        if mine is None and flank and out.maneuvers[me] == "overtaking":
            touching: Area = flank if oncoming else OPPOSITE_HAND[flank]  # type: ignore[assignment]
            return (touching, area_b) if me == blow.actor else (area_a, touching)
    return area_a, area_b


def _sideswiped(out: Settled, a: str, b: str) -> tuple[Area, Area]:
    """Flank to flank: left to left of oncoming vehicles, else by the lane change, else a on the left."""
    if apart(between(out.headings[a], out.headings[b]), 180) <= 45:
        return "left", "left"
    a_goes_left = out.maneuvers[a] == "lane_change_left" or out.maneuvers[b] == "lane_change_right"
    return ("left", "right") if a_goes_left else ("right", "left")


def _corners(draft: Draft, out: Settled, blow: Blow) -> tuple[Area | None, Area | None]:
    """Each corner as its end or its flank: the flank where the paths cross and the other hits with its front."""
    turn = between(out.headings[blow.actor], out.headings[blow.other])
    pair = (blow.actor, blow.other)
    skidding = any(draft.motions[v].did("lost_control", 3) for v in pair) and turn == 0
    bent = skidding or turn % 180 != 0 or any(out.maneuvers[v] in _BENT for v in pair)
    zones = {blow.actor: blow.actor_area, blow.other: blow.other_area}
    areas: dict[str, Area | None] = {}
    for me, you in ((blow.actor, blow.other), (blow.other, blow.actor)):
        mine, yours = zones[me], zones[you]
        flank = (
            bent
            and mine
            and mine.count("/") == 1
            and yours in ("front", None)
            and out.maneuvers[me] not in ("stopped", "parked")
        )
        areas[me] = mine.split("/")[1] if flank and mine else end_of(mine)  # type: ignore[assignment]
    if set(areas.values()) == {"back"} and not any(out.maneuvers[v] == "backing" for v in pair):
        areas = {v: _flank_of(zones[v]) or areas[v] for v in pair}
    return areas[blow.actor], areas[blow.other]


def _flank_of(zone: Zone | None) -> Area | None:
    """The flank of a corner: two rear corners touch with it where nobody backs, since nobody drives tail first."""
    return zone.split("/")[1] if zone and zone.count("/") == 1 else None  # type: ignore[return-value]


def complete_areas(out: Settled, a: str, b: str, area_a: Area | None, area_b: Area | None) -> tuple[Area, Area]:
    """Sides that the text leaves open, from headings and maneuvers; a is the grammatical striker."""
    area_a, area_b = (
        "back" if side is None and out.maneuvers[v] == "backing" else side for v, side in ((a, area_a), (b, area_b))
    )
    if area_a and area_b:
        return area_a, area_b
    turn = between(out.headings.get(a, "N"), out.headings.get(b, "N")) if a in out.headings and b in out.headings else 0
    at_contact = (turn + TURN_DEG.get(out.maneuvers[b], 0.0) - TURN_DEG.get(out.maneuvers[a], 0.0)) % 360
    if area_a is None and area_b is None:
        if _standing(out, a) and not _standing(out, b):
            return side_hit(-at_contact), "front"
        return "front", side_hit(-at_contact)
    if area_a is None:
        if _standing(out, a) and not _standing(out, b) and area_b in ("left", "right"):
            return _flank_facing(area_b, turn), area_b
        if (
            {out.maneuvers[a], out.maneuvers[b]} & set(_SIDLING)
            and area_b in ("left", "right")
            and apart(turn, 0) <= 45
        ):
            return ("right" if area_b == "left" else "left"), area_b
        return ("front", area_b) if area_b != "front" else (side_hit(at_contact), area_b)  # type: ignore[return-value]
    if {out.maneuvers[a], out.maneuvers[b]} & set(_SIDLING) and area_a in ("left", "right") and apart(turn, 0) <= 45:
        return area_a, "right" if area_a == "left" else "left"
    return (area_a, side_hit(-at_contact)) if area_a == "front" else (area_a, "front")


def _flank_facing(flank: Area, turn: float) -> Area:
    """The flank of one that stands which faces the told flank of one that passes it."""
    return flank if apart(turn, 180) <= 45 else "right" if flank == "left" else "left"


def _backs_into(out: Settled, vehicle: str, area: Area | None) -> bool:
    return out.maneuvers[vehicle] == "backing" and area == "back"


def _standing(out: Settled, vehicle: str) -> bool:
    return out.maneuvers[vehicle] in ("stopped", "parked")
