"""The hand of a turn that is told by its end alone: "turning north", "from eastbound to northbound".

Knows what was read and is settled so far; no text.
"""

from __future__ import annotations

from sgcad_core.reading.contacts.contact_records import ContactMention
from sgcad_core.reading.inference.inference_state import CrashInferred, CrashTold, end_of
from sgcad_core.reading.motion.heading_lane_cues import TURNING_WAY
from sgcad_core.reading.text.compass import OPPOSITE_HAND, between, turned
from sgcad_core.records.specs import Compass


def turns_by_way(crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention]) -> None:
    """Turns each vehicle whose turn is told by the way behind it, where nothing else tells its maneuver.

    An untold way before the turn that lies along the way behind it is one across it.
    """
    for v in crash.roster.ids:
        end = _end(crash, inferred, v)
        if end is None:
            continue
        start = inferred.headings[v]
        if v not in inferred.stated and between(start, end) % 180 == 0:
            start = _across(crash, inferred, pairs, v, end) or start
        angle = between(start, end)
        if angle % 180 == 0:
            continue
        inferred.headings[v] = start
        inferred.maneuvers[v] = "turn_right" if angle < 180 else "turn_left"
        inferred.told_maneuvers.add(v)
        inferred.sources[f"{v} maneuver"] = crash.motions[v].sources[f"exit {end}"]


def _end(crash: CrashTold, inferred: CrashInferred, vehicle: str) -> Compass | None:
    """The way behind a turn of unknown hand; None where the vehicle drives that way already."""
    motion = crash.motions[vehicle]
    if inferred.maneuvers[vehicle] != "straight" or vehicle in inferred.told_maneuvers:
        return None
    ends = [e for e in motion.exits if motion.sources[f"exit {e}"].rule == TURNING_WAY]
    return ends[0] if ends and all(h.value != ends[0] for h in motion.headings) else None


def _across(
    crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention], vehicle: str, end: Compass
) -> Compass | None:
    """The way from the told side, or the side touched, of the vehicle that is met; clockwise of the end if neither.

    None where it is struck from behind, or strikes so: its turn is over.
    """
    hit = next((b for b in pairs if vehicle in (b.actor, b.other)), None)
    if hit is None:
        return turned(end, 90)
    own, theirs = (end_of(zone) for zone in hit.areas_of(vehicle))
    if "back" in (own, theirs):
        return None
    met = inferred.headings[hit.other if hit.actor == vehicle else hit.actor]
    came = crash.motions[vehicle].from_side or (theirs if theirs in OPPOSITE_HAND else OPPOSITE_HAND.get(own or ""))
    return turned(met, 90 if came == "left" else -90) if came and between(met, end) % 180 == 0 else turned(end, 90)
