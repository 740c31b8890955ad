"""The contacts with all their sides: corners decided, open sides completed from headings and maneuvers."""

from __future__ import annotations

from dataclasses import replace

from sgcad_core.kinds import ACROSS_LANES, CHANGES
from sgcad_core.reading.actors.people_objects import is_person
from sgcad_core.reading.contacts.contact_records import AREAS, GROUND, ContactFacts, ContactMention
from sgcad_core.reading.inference.inference_state import (
    TURN_DEG,
    CrashInferred,
    CrashTold,
    apart,
    end_of,
    is_sideswipe,
    side_hit,
)
from sgcad_core.reading.text.area_phrases import Zone
from sgcad_core.reading.text.compass import OPPOSITE_HAND, between
from sgcad_core.reading.text.sentence_roles import STORY_ROLES
from sgcad_core.records.specs import Area

_BENT = ("turn_left", "turn_right", "u_turn", *ACROSS_LANES)


def infer_contacts(crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention]) -> list[ContactFacts]:
    """Contacts of vehicles with all areas; the first two vehicles where none is told and nothing else was struck."""
    if not pairs and crash.roster.counted and crash.contact_mentions:
        return []  # the report tells a contact, with no vehicle
    if not pairs and any(
        mention.other not in crash.roster.ids and is_person(mention.other) for mention in crash.contact_mentions
    ):
        return []  # an actor without a number was hit; no contact of the vehicles is told
    if not pairs and any(_tells_thing(mention, crash) for mention in crash.contact_mentions):
        return []  # the vehicles struck things
    if not pairs and len(crash.roster.ids) >= 2:
        a, b = crash.roster.ids[:2]
        if crash.contact_mentions and frozenset((a, b)) in crash.missed:
            return []  # one of both struck something else
        guess = ContactMention(a, b, None, None, 0, "impact", mutual=True)
        return [replace(_join(crash, inferred, guess), stated=False)]
    return [_join(crash, inferred, mention) for mention in pairs]


def _tells_thing(mention: ContactMention, crash: CrashTold) -> bool:
    """Whether a sentence of the crash itself tells that a vehicle struck a thing that stops it."""
    told = mention.role in STORY_ROLES and mention.other not in crash.roster.ids
    return told and mention.other not in GROUND


def _join(crash: CrashTold, inferred: CrashInferred, mention: ContactMention) -> ContactFacts:
    """Striker first: the one that hits with its front where the other does not, or backs into it."""
    told = all(zone is not None and "/" not in zone for zone in (mention.actor_area, mention.other_area))
    a, b = mention.actor, mention.other
    area_a, area_b = _corners(crash, inferred, mention)
    if crash.roster.counted and not (area_a and area_b):
        area_a, area_b = _brushed(inferred, mention, area_a, area_b)
    if area_a is None and area_b is None and is_sideswipe(mention):
        area_a, area_b = _sideswiped(inferred, a, b)
    if is_sideswipe(mention) and (area_a is None) != (area_b is None):
        area_a, area_b = _flanks(inferred, a, b, area_a, area_b)
    if mention.mutual and area_a is None and area_b is None and _less_of_a_striker(inferred, a, b):
        a, b = b, a
    if area_a is None and area_b is None and (caught := _caught_up(crash, a, b)):
        a, b, area_a, area_b = *caught, "front", "back"
    if area_a is None and area_b is None and crash.near and _cuts_in(inferred, a, b):
        area_a, area_b = _sideswiped(inferred, a, b)
    area_a, area_b = complete_areas(inferred, a, b, area_a, area_b)
    leads_b = area_b == "front" and area_a != "front" and not _backs_into(inferred, a, area_a)
    if leads_b or (_backs_into(inferred, b, area_b) and _standing(inferred, a)):
        a, b, area_a, area_b = b, a, area_b, area_a
    may = {mention.actor: _allowed(mention.actor_area), mention.other: _allowed(mention.other_area)}
    return ContactFacts(a, b, area_a, area_b, told, True, may[a], may[b])


def _cuts_in(inferred: CrashInferred, a: str, b: str) -> bool:
    """Whether just one of two that drive one way changes lanes and neither stands: they come together side by side."""
    changes = [inferred.maneuvers[v] in (*CHANGES, "merge") for v in (a, b)]
    along = apart(between(inferred.headings.get(a, "N"), inferred.headings.get(b, "N")), 0) <= 45
    return along and sum(changes) == 1 and not (_standing(inferred, a) or _standing(inferred, b))


def _caught_up(crash: CrashTold, a: str, b: str) -> tuple[str, str] | None:
    """Striker and struck where the codes say that one came from behind with more speed, or in a near crash one is told
    to drive ahead of the other one or behind it."""
    for struck, striker in ((a, b), (b, a)):
        if crash.motions[struck].has_cue("code:hit_from_behind"):
            return striker, struck
        places = {word for _, _, other, word in crash.motions[struck].relations if other == striker and crash.near}
        if places & {"ahead", "behind"}:
            return (striker, struck) if "ahead" in places else (struck, striker)
    return None


def _allowed(zone: Zone | None) -> tuple[Area, ...]:
    """Sides that a phrase may mean."""
    return tuple(area for area in AREAS if area in zone.split("/")) if zone else AREAS


def _less_of_a_striker(inferred: CrashInferred, a: str, b: str) -> bool:
    """Whether b rather than a hits with its front: a turns or stands and b goes straight; else the higher number."""
    bent_a, bent_b = (inferred.maneuvers[v] in _BENT or _standing(inferred, v) for v in (a, b))
    return (bent_a and not bent_b) or (bent_a == bent_b and int(a[1:]) > int(b[1:]))


def _brushed(
    inferred: CrashInferred, mention: ContactMention, area_a: Area | None, area_b: Area | None
) -> tuple[Area | None, Area | None]:
    """Gives an overtaking vehicle, and one that goes along a front corner, the flank that faces the other one."""
    if along := _goes_along(inferred, mention):
        return along
    oncoming = (
        apart(between(inferred.headings.get(mention.actor, "N"), inferred.headings.get(mention.other, "N")), 180) <= 45
    )
    for mine, me, zone in ((area_a, mention.actor, mention.other_area), (area_b, mention.other, mention.actor_area)):
        flank = next((side for side in (zone or "").split("/") if side in OPPOSITE_HAND), None)
        if mine is None and flank and inferred.maneuvers[me] == "overtaking":
            touching: Area = flank if oncoming else OPPOSITE_HAND[flank]  # type: ignore[assignment]
            return (touching, area_b) if me == mention.actor else (area_a, touching)
    return area_a, area_b


def _goes_along(inferred: CrashInferred, mention: ContactMention) -> tuple[Area, Area] | None:
    """The flanks of one that is told to touch, with no side, a front corner of another one that drives its way: it
    would not meet that end in driving on."""
    a, b = mention.actor, mention.other
    end, _, hand = (mention.other_area or "").partition("/")
    along = between(inferred.headings.get(a, "N"), inferred.headings.get(b, "N")) == 0
    moves = inferred.maneuvers[a] in ("straight", *ACROSS_LANES) and inferred.maneuvers[b] != "backing"
    if mention.actor_area or mention.mutual or not (along and moves and end == "front" and hand in OPPOSITE_HAND):
        return None
    return OPPOSITE_HAND[hand], hand  # type: ignore[return-value]


def _sideswiped(inferred: CrashInferred, a: str, b: str) -> tuple[Area, Area]:
    """Flank to flank: left to left of oncoming vehicles, else by the lane change, else a on the left."""
    if apart(between(inferred.headings[a], inferred.headings[b]), 180) <= 45:
        return "left", "left"
    a_goes_left = inferred.maneuvers[a] in ("lane_change_left", "merge") or inferred.maneuvers[b] == "lane_change_right"
    return ("left", "right") if a_goes_left else ("right", "left")


def _flanks(
    inferred: CrashInferred, a: str, b: str, area_a: Area | None, area_b: Area | None
) -> tuple[Area | None, Area | None]:
    """Both flanks of a sideswipe that tells one of them, where the vehicles touch along each other."""
    turn = between(inferred.headings.get(a, "N"), inferred.headings.get(b, "N"))
    at_contact = (turn + TURN_DEG.get(inferred.maneuvers[b], 0.0) - TURN_DEG.get(inferred.maneuvers[a], 0.0)) % 360
    told = area_a or area_b
    if told not in OPPOSITE_HAND or min(apart(at_contact, 0), apart(at_contact, 180)) > 45:
        return area_a, area_b
    facing = _flank_facing(told, at_contact)
    return area_a or facing, area_b or facing


def _corners(crash: CrashTold, inferred: CrashInferred, mention: ContactMention) -> tuple[Area | None, Area | None]:
    """Each corner as its end or its flank: the flank where the paths cross and the other hits with its front."""
    turn = between(inferred.headings[mention.actor], inferred.headings[mention.other])
    pair = (mention.actor, mention.other)
    skidding = any(crash.motions[v].has_cue("lost_control", 3) for v in pair) and turn == 0
    bent = skidding or turn % 180 != 0 or any(inferred.maneuvers[v] in _BENT for v in pair)
    zones = {mention.actor: mention.actor_area, mention.other: mention.other_area}
    sidles = any(inferred.maneuvers[v] in ACROSS_LANES for v in pair)
    along = {v: turn == 0 and (sidles or inferred.maneuvers[v] in _BENT) for v in pair}
    areas: dict[str, Area | None] = {}
    for me, you in ((mention.actor, mention.other), (mention.other, mention.actor)):
        mine, yours = zones[me], zones[you]
        flank = (
            bent
            and mine
            and mine.count("/") == 1
            and (yours in ("front", None) or (along[me] and yours in OPPOSITE_HAND))
            and (inferred.maneuvers[me] not in ("stopped", "parked") or _passed_by(mine, yours, turn))
        )
        flank = flank or _beside(mine, yours, turn)
        flank = flank or (crash.roster.counted and _brushes_by(inferred, pair, mine, yours, turn))
        areas[me] = mine.split("/")[1] if flank and mine else end_of(mine)  # type: ignore[assignment]
    if set(areas.values()) == {"back"} and not any(inferred.maneuvers[v] == "backing" for v in pair):
        areas = {v: _flank_of(zones[v]) or areas[v] for v in pair}
    return areas[mention.actor], areas[mention.other]


def _passed_by(mine: Zone, yours: Zone | None, turn: float) -> bool:
    """Whether the flank of the other one goes along a front corner, in one direction.

    A rear corner of one that stands is its end to those who fill in forms: so in 75 of 75 reports of automated
    vehicles (to learn from) that were passed on that hand, the flank in 44.
    """
    end, hand = mine.split("/")
    return end == "front" and turn == 0 and yours in OPPOSITE_HAND and hand == OPPOSITE_HAND[yours]


def _beside(mine: Zone | None, yours: Zone | None, turn: float) -> bool:
    """Whether a corner touches with its flank whatever the maneuver: corners of opposite hands side by side, or a rear
    corner that an oncoming front finds."""
    hand, other = _flank_of(mine), _flank_of(yours)
    rear = end_of(mine) == "back"
    if turn == 180:
        ends = {end_of(mine), end_of(yours)}
        return hand is not None and (
            (rear and end_of(yours) == "front") or (other == hand and ends == {"front", "back"})
        )
    return turn == 0 and hand is not None and other == OPPOSITE_HAND[hand] and end_of(mine) == end_of(yours)


def _brushes_by(
    inferred: CrashInferred, pair: tuple[str, str], mine: Zone | None, yours: Zone | None, turn: float
) -> bool:
    """Whether front corners of one hand touch as one drives past another one that stands and faces it."""
    stands = any(_standing(inferred, v) for v in pair)
    return stands and turn == 180 and mine == yours and end_of(mine) == "front" and _flank_of(mine) is not None


def _flank_of(zone: Zone | None) -> Area | None:
    """The flank of a corner: two rear corners touch with their flanks where no vehicle backs."""
    return zone.split("/")[1] if zone and zone.count("/") == 1 else None  # type: ignore[return-value]


def complete_areas(
    inferred: CrashInferred, a: str, b: str, area_a: Area | None, area_b: Area | None
) -> tuple[Area, Area]:
    """Sides that the text leaves open, from headings and maneuvers; a is the grammatical striker."""
    area_a, area_b = (
        "back" if side is None and inferred.maneuvers[v] == "backing" else side
        for v, side in ((a, area_a), (b, area_b))
    )
    if area_a and area_b:
        return area_a, area_b
    turn = (
        between(inferred.headings.get(a, "N"), inferred.headings.get(b, "N"))
        if a in inferred.headings and b in inferred.headings
        else 0
    )
    at_contact = (turn + TURN_DEG.get(inferred.maneuvers[b], 0.0) - TURN_DEG.get(inferred.maneuvers[a], 0.0)) % 360
    if area_a is None and area_b is None:
        if _standing(inferred, a) and not _standing(inferred, b):
            return side_hit(-at_contact), "front"
        return "front", side_hit(-at_contact)
    if area_a is None:
        if _standing(inferred, a) and not _standing(inferred, b) and area_b in ("left", "right"):
            return _flank_facing(area_b, turn), area_b
        if (
            {inferred.maneuvers[a], inferred.maneuvers[b]} & ACROSS_LANES
            and area_b in ("left", "right")
            and apart(turn, 0) <= 45
        ):
            return ("right" if area_b == "left" else "left"), area_b
        return ("front", area_b) if area_b != "front" else (side_hit(at_contact), area_b)  # type: ignore[return-value]
    if (
        {inferred.maneuvers[a], inferred.maneuvers[b]} & ACROSS_LANES
        and area_a in ("left", "right")
        and apart(turn, 0) <= 45
    ):
        return area_a, "right" if area_a == "left" else "left"
    return (area_a, side_hit(-at_contact)) if area_a == "front" else (area_a, "front")


def _flank_facing(flank: Area, turn: float) -> Area:
    """The flank of one that stands which faces the told flank of one that passes it."""
    return flank if apart(turn, 180) <= 45 else "right" if flank == "left" else "left"


def _backs_into(inferred: CrashInferred, vehicle: str, area: Area | None) -> bool:
    return inferred.maneuvers[vehicle] == "backing" and area == "back"


def _standing(inferred: CrashInferred, vehicle: str) -> bool:
    return inferred.maneuvers[vehicle] in ("stopped", "parked")
