"""Vehicles of which a report tells little: beside the road, in a queue, in a turn lane, in lanes that others entered.

Knows what was read and is settled so far; no text.
"""

from __future__ import annotations

from sgcad_core.reading.contacts.contact_records import ContactMention
from sgcad_core.reading.inference.inference_state import CrashInferred, CrashTold, end_of
from sgcad_core.reading.motion.maneuvers import DEPARTURES
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.records.specs import Maneuver

_GOES_ON = ("near_deeds.goes_on", "deeds.moved_on", "deeds.came_on")
"""Rules of words that tell that one drives, not where to."""


def beside_road(crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention]) -> None:
    """Parks a vehicle of which nothing is told but that one that had left the road met it, after a thing or first."""
    for b in () if crash.roster.counted else pairs:
        for met, came in ((b.actor, b.other), (b.other, b.actor)):
            motion = crash.motions[met]
            beside = any(other == met for one in crash.motions.values() for _, _, other, _ in one.relations)
            silent = not (
                motion.headings or motion.cues or motion.relations or motion.lane or motion.lane_word or beside
            )
            if silent and inferred.maneuvers[came] in DEPARTURES:
                inferred.maneuvers[met] = "parked"
                inferred.sources[f"{met} maneuver"] = Source(b.number, b.words, "infer.beside_road")


def from_turn_lane(crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention]) -> None:
    """Turns a vehicle of which nothing is told but its turn lane, where it meets one that is told to come another
    way."""
    turns: dict[str, Maneuver] = {"left_turn": "turn_left", "right_turn": "turn_right"}
    for b in pairs[:1]:
        for v, other in ((b.actor, b.other), (b.other, b.actor)):
            turn = turns.get(crash.motions[v].lane_word or "")
            silent = f"{v} maneuver" not in inferred.sources and inferred.maneuvers[v] == "straight"
            told = {v, other} <= inferred.stated and inferred.headings[v] != inferred.headings[other]
            if crash.near:  # of a study headings are not told: it meets one that is not told to drive its way
                source = inferred.sources.get(f"{v} maneuver")
                silent = inferred.maneuvers[v] == "straight" and (source is None or source.rule in _GOES_ON)
                told = not any(kin == "same" for me in (v, other) for _, kin, *_ in crash.motions[me].relations)
            if turn and silent and told:
                inferred.maneuvers[v] = turn
                inferred.sources[f"{v} maneuver"] = Source(b.number, b.words, "infer.from_turn_lane")


def from_entered_lanes(crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention]) -> None:
    """Turns the one that is met in lanes that the other one entered to their way, where nothing else tells its own."""
    for b in pairs[:1]:
        for came, met in ((b.actor, b.other), (b.other, b.actor)):
            way = crash.motions[came].entered
            if way and came in inferred.headings and met not in inferred.headings and not crash.motions[met].relations:
                inferred.headings[met] = way


def ahead_in_queue(crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention]) -> None:
    """Stops a vehicle of which no maneuver is told but that another one stood behind it, and was pushed into it.

    So it was in 26 of 32 coded reports with "stopped behind" (CISS, those to learn from).
    """
    if crash.roster.counted:
        return
    rear_ends = {
        (v, b.other if v == b.actor else b.actor) for b in pairs for v in (b.actor, b.other)
        if tuple(end_of(zone) for zone in b.areas_of(v)) == ("front", "back")
    }  # fmt: skip
    for v in crash.roster.ids:
        stood = [d.number for d in crash.motions[v].cues if d.kind == "stopped"]
        for _, _, ahead, word in crash.motions[v].relations:
            if word != "behind" or ahead is None or ahead in inferred.told_maneuvers or (v, ahead) not in rear_ends:
                continue
            told = crash.motions[v].sources.get(f"same {ahead}")
            if told is None or told.number not in stood:
                continue
            if inferred.maneuvers[v] == "stopped" and inferred.maneuvers[ahead] == "straight":
                inferred.maneuvers[ahead] = "stopped"
                inferred.sources[f"{ahead} maneuver"] = told._replace(rule="infer.ahead_in_queue")
