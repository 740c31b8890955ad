"""Moves out of the own lane, settled by the other vehicle: over the middle of the road, to which hand, past oncoming.

Knows what was read and is settled so far; no text but the words of a cue.
"""

from __future__ import annotations

from sgcad_core.kinds import CHANGES
from sgcad_core.reading.contacts.contact_records import ContactMention
from sgcad_core.reading.contacts.near_crash import RETURNS
from sgcad_core.reading.inference.inference_state import CrashInferred, CrashTold
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.maneuvers import INTO_LANE_OF, INTO_LANE_OF_OTHER, OUT_OF_LANE_LEFT, SHIFTED
from sgcad_core.reading.motion.motion_record import VehicleMotion
from sgcad_core.reading.text.compass import against
from sgcad_core.records.course import Hand

_FROM_RIGHT = {"right": 0, "middle": 1, "left": 2}
"""Lanes by their words, from the right curb."""


def over_centerline(crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention]) -> None:
    """Out of the own lane to the left, or into that of one that comes the other way: over the middle of the road."""
    for v in crash.roster.ids:
        source = inferred.sources.get(f"{v} maneuver")
        hit = next((b for b in pairs if v in (b.actor, b.other)), None)
        if hit is None or source is None or source.rule not in (OUT_OF_LANE_LEFT, INTO_LANE_OF, INTO_LANE_OF_OTHER):
            continue
        other = hit.other if hit.actor == v else hit.actor
        if against(inferred.headings[v], inferred.headings[other]):
            inferred.maneuvers[v] = "crossing_centerline"


def change_hands(crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention]) -> None:
    """Directs a lane change without a told side: towards the flank of the contact, away from a told lane."""
    for v in crash.roster.ids:
        source = inferred.sources.get(f"{v} maneuver")
        into = _lane_entered(crash, inferred, pairs, v)
        hand = _hand_between(crash.motions[v], into) or _hand_left(crash, v)
        if inferred.maneuvers[v] in CHANGES and hand:
            inferred.maneuvers[v] = "lane_change_left" if hand == "left" else "lane_change_right"
            continue
        if (
            inferred.maneuvers[v] != "lane_change_left"
            or v in inferred.told_maneuvers
            or (source and source.rule in SHIFTED)
        ):
            continue
        told = _told_hand(crash.motions[v], source.words if source else "")
        hit = next((b for b in pairs if v in (b.actor, b.other)), None)
        own, other = hit.areas_of(v) if hit else (None, None)
        towards = (
            "right" in (own or "").split("/")
            or "left" in (other or "").split("/")
            or crash.motions[v].lane_word == "left"
            or _meets_merging(inferred, hit, v)
        )
        if told == "right" or (told is None and towards):
            inferred.maneuvers[v] = "lane_change_right"


def passing_by(crash: CrashTold, inferred: CrashInferred) -> None:
    """Straight on for one of two that passes the other one where that comes against it: no overtaking."""
    if len(crash.roster.ids) != 2:
        return
    for v, other in (crash.roster.ids, crash.roster.ids[::-1]):
        source = inferred.sources.get(f"{v} maneuver")
        passes = inferred.maneuvers[v] == "overtaking" and source and rule("deeds.passes").search(source.words)
        opposite = any(relation == "opposite" for _, relation, _, _ in crash.motions[v].relations)
        told = opposite or {v, other} <= inferred.stated
        if passes and told and against(inferred.headings[v], inferred.headings[other]):
            inferred.maneuvers[v] = "straight"
            inferred.told_maneuvers.discard(v)


def _hand_left(crash: CrashTold, v: str) -> Hand | None:
    """The hand of a lane change from which one steers back, as told, to the other hand."""
    backs = (
        (e.maneuver for e in crash.near.evasions if e.vehicle == v and e.source.rule == RETURNS) if crash.near else ()
    )
    return next(("right" if how.endswith("left") else "left" for how in backs if not how.endswith("steering")), None)


def _meets_merging(inferred: CrashInferred, hit: ContactMention | None, v: str) -> bool:
    """Whether the other one of a contact merges, which it does from the right."""
    return hit is not None and inferred.maneuvers.get(hit.other if hit.actor == v else hit.actor) == "merge"


def _lane_entered(crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention], v: str) -> str:
    """The word of the lane into which one changes: told, else that of the one that it comes before and that keeps its
    lane."""
    motion = crash.motions[v]
    hit = next((b for b in pairs if v in (b.actor, b.other)), None)
    other = hit and (hit.other if hit.actor == v else hit.actor)
    source = inferred.sources.get(f"{v} maneuver")
    if motion.to_lane is None and other and source and source.rule in (INTO_LANE_OF, INTO_LANE_OF_OTHER):
        return str(crash.motions[other].lane_word) if inferred.maneuvers[other] not in CHANGES else ""
    return str(motion.to_lane)


def _hand_between(motion: VehicleMotion, into: str) -> Hand | None:
    """The hand on which the lane lies into which it changes, by the words of both lanes; None where one is open."""
    start, end = _FROM_RIGHT.get(str(motion.lane_word)), _FROM_RIGHT.get(into)
    if start is None or end is None or start == end:
        return None
    return "left" if end > start else "right"


def _told_hand(motion: VehicleMotion, words: str) -> Hand | None:
    """The hand of a lane change by its words, or by the lanes that it leaves and enters; None if neither tells it."""
    hands = {m[0].lower() for m in rule("deeds.hand").finditer(words)}
    if len(hands) == 1:
        return "left" if hands == {"left"} else "right"
    start, end = motion.lane, motion.to_lane
    if start is None and motion.lane_word is None and end in ("left", "right"):
        return "left" if end == "left" else "right"
    if start is None or not isinstance(end, int) or start == end or (start < 0) != (end < 0):
        return None
    return "left" if end > start else "right"
