"""Inference from what is told: maneuvers decided, headings completed, contact sides completed.

Evidence is added up: stated headings beat relation words, relation words beat what the sides that touched
suggest. Angles here are clockwise degrees, as compass words turn. Knows no text.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sgcad_core.reading.contacts.contact_records import ContactMention, with_areas
from sgcad_core.reading.contacts.contact_sides import infer_contacts
from sgcad_core.reading.inference.inference_state import QUARTER_DEG, CrashInferred, CrashTold, end_of
from sgcad_core.reading.inference.lane_moves import change_hands, over_centerline, passing_by
from sgcad_core.reading.inference.silent_vehicles import ahead_in_queue, beside_road, from_entered_lanes, from_turn_lane
from sgcad_core.reading.inference.turn_ways import turns_by_way
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.heading_lane_cues import TURNS_TO
from sgcad_core.reading.motion.maneuvers import (
    Decision,
    changed_lanes_after_turn,
    decide,
    meant_turn,
    turned_before,
)
from sgcad_core.reading.motion.motion_record import VehicleMotion, WeightedValue
from sgcad_core.reading.motion.relative_headings import contact_prefers, relative
from sgcad_core.reading.text.compass import between, turned
from sgcad_core.records.specs import Area, Compass, Maneuver


def infer_crash(crash: CrashTold) -> CrashInferred:
    """Decide everything that the text allows to decide."""
    inferred = CrashInferred()
    pairs = _vehicle_contacts(crash)
    _stated_headings(crash, inferred)
    for v in crash.roster.ids:
        motion = crash.motions[v]
        _maneuver(inferred, v, decide(motion, _areas_hit(v, pairs), _same_way_turn(crash, inferred, v)))
        if motion.speeds_mph:
            inferred.speeds[v] = _take(inferred, f"{v} speed", motion.speeds_mph)
    _turned_headings(crash, inferred)
    _faced_headings(crash, inferred)
    _still_moving(crash, inferred, pairs)
    _set_going(crash, inferred, pairs)
    beside_road(crash, inferred, pairs)
    ahead_in_queue(crash, inferred, pairs)
    from_turn_lane(crash, inferred, pairs)
    change_hands(crash, inferred, pairs)
    _mend_headings(crash, inferred, pairs)
    _complete_headings(crash, inferred, pairs)
    turns_by_way(crash, inferred, pairs)
    over_centerline(crash, inferred, pairs)
    passing_by(crash, inferred)
    inferred.exits = {v: e for v in crash.roster.ids if (e := _exit(crash.motions[v], inferred, v)) is not None}
    inferred.contacts = infer_contacts(crash, inferred, pairs)
    return inferred


def _still_moving(crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention]) -> None:
    """In a near crash, makes a vehicle that comes to a stop slow, and sets one going that stood and then evades; a
    vehicle that stood all the time stays stopped."""
    evades = {e.vehicle: e.source.number for e in crash.near.evasions} if crash.near else {}
    pair = {name for b in pairs[:1] for name in (b.actor, b.other)} or set(crash.roster.ids[:2])
    lone = crash.roster.counted and not crash.contact_mentions  # one that "brakes to stop" and touches nothing
    for v in sorted(pair) if crash.near or lone else ():
        source = inferred.sources.get(f"{v} maneuver")
        comes = source and rule("near_events.came_to_stop").match(source.words)
        if inferred.maneuvers[v] == "stopped" and comes and (crash.near or comes[0].startswith("to")):
            inferred.maneuvers[v] = "slowing"
            continue
        stood = inferred.maneuvers[v] == "stopped" or (
            crash.motions[v].has_cue("stopped") and source is not None and source.rule == "near_deeds.follows_suit"
        )
        if stood and source and source.number <= evades.get(v, -1):
            inferred.maneuvers[v] = "straight"
            inferred.told_maneuvers.discard(v)
            inferred.started.add(v)


def _set_going(crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention]) -> None:
    """Sets a vehicle going that stood, where the first contact as told cannot come about otherwise.

    Its front strikes a flank, or its flank is struck by one that goes straight on across its way. Of 18
    such vehicles in a sample of coded reports 16 were coded as moving. Of an account in order the last act before the
    contact stands, unless its front strikes the flank of one that goes straight on across its way.
    """
    ordered = crash.roster.counted
    for b in pairs[:1] if not crash.near else ():
        for v, other in ((b.actor, b.other), (b.other, b.actor)):
            own, theirs = (end_of(zone) for zone in b.areas_of(v))
            if inferred.maneuvers[v] != "stopped" or "back" in (own, theirs):
                continue
            strikes = v == b.actor and not b.mutual and own == "front" and theirs in ("left", "right")
            if ordered and not (strikes and _crosses(inferred, other, v)):
                continue
            if strikes or (theirs == "front" and own in ("left", "right") and _crosses(inferred, other, v)):
                meant = meant_turn(crash.motions[v])
                inferred.maneuvers[v] = meant.maneuver if meant else "straight"
                if not meant:
                    inferred.told_maneuvers.discard(v)
                inferred.started.add(v)
                stop = inferred.sources[f"{v} maneuver"]
                inferred.sources[f"{v} maneuver"] = stop._replace(rule="infer.set_going")


def _crosses(inferred: CrashInferred, mover: str, stood: str) -> bool:
    """Whether a vehicle goes straight on across the way of another one, both ways being told."""
    told = {mover, stood} <= inferred.stated and inferred.maneuvers[mover] == "straight"
    return told and between(inferred.headings[stood], inferred.headings[mover]) in (90, 270)


def _turned_headings(crash: CrashTold, inferred: CrashInferred) -> None:
    """Gives a vehicle that turned before the crash the heading told since, else the one that the turn led to."""
    for v, motion in crash.motions.items():
        turn = turned_before(motion, inferred.maneuvers[v])
        if turn is None or v not in inferred.headings:
            continue
        since = [h for h in motion.headings if h.source.number > turn.number]
        if since:
            inferred.headings[v], inferred.sources[f"{v} heading"] = since[-1].value, since[-1].source
        elif motion.exits:
            inferred.headings[v] = motion.exits[-1]
            inferred.sources[f"{v} heading"] = motion.sources[f"exit {motion.exits[-1]}"]
        else:
            inferred.headings[v] = turned(inferred.headings[v], 90 if turn.kind == "turn_right" else -90)
            inferred.stated.discard(v)


def _faced_headings(crash: CrashTold, inferred: CrashInferred) -> None:
    """Gives a parked vehicle, and of an account in order a backing one, the last told facing, whatever heading its lane
    or its way before had."""
    for v, motion in crash.motions.items():
        faced = [(source.number, what.removeprefix("faces "), source) for what, source in motion.sources.items()
                 if what.startswith("faces ")]  # fmt: skip
        backs = motion.ordered and inferred.maneuvers[v] == "backing"
        if faced and (backs or inferred.maneuvers[v] == "parked"):
            _, way, source = max(faced, key=lambda told: told[0])
            inferred.headings[v], inferred.sources[f"{v} heading"] = way, source  # type: ignore[assignment]
            inferred.stated.add(v)


def _stated_headings(crash: CrashTold, inferred: CrashInferred) -> None:
    for v, motion in crash.motions.items():
        turned_in = motion.exits and changed_lanes_after_turn(motion)
        if motion.headings or turned_in:
            inferred.headings[v] = (
                _take(inferred, f"{v} heading", motion.headings) if motion.headings else motion.exits[0]
            )
            if not motion.headings:
                inferred.sources[f"{v} heading"] = motion.sources[f"exit {motion.exits[0]}"]
            inferred.stated.add(v)


def _take(inferred: CrashInferred, what: str, heard: list[WeightedValue]) -> Any:
    """What was told with most weight, first of all."""
    best = max(heard, key=lambda h: h.weight)
    inferred.sources[what] = best.source
    return best.value


def _maneuver(inferred: CrashInferred, vehicle: str, decision: Decision) -> None:
    inferred.maneuvers[vehicle] = decision.maneuver
    if decision.told:
        inferred.told_maneuvers.add(vehicle)
    if decision.cue:
        inferred.sources[f"{vehicle} maneuver"] = decision.cue.source


def _same_way_turn(crash: CrashTold, inferred: CrashInferred, vehicle: str) -> Maneuver:
    """Which turn brings a vehicle into the direction of the other: right, unless it came from the left."""
    other = crash.roster.other(vehicle)
    if (
        other
        and {vehicle, other} <= inferred.stated
        and between(inferred.headings[vehicle], inferred.headings[other]) == 270
    ):
        return "turn_left"
    return "turn_right"


def _vehicle_contacts(crash: CrashTold) -> list[ContactMention]:
    """Contacts between numbered vehicles, one a pair, each completed from its other tellings."""
    hits = [b for b in crash.contact_mentions if b.other in crash.roster.ids]
    found: list[ContactMention] = []
    for i, mention in enumerate(hits):
        if all({mention.actor, mention.other} != {b.actor, b.other} for b in found):
            found.append(with_areas(mention, hits[i + 1 :]))
    return found


def _areas_hit(vehicle: str, pairs: list[ContactMention]) -> tuple[Area | None, ...]:
    """Sides of the vehicle that were hit, first contact first; of a corner the end."""
    return tuple(end_of(b.areas_of(vehicle)[0]) for b in pairs if vehicle in (b.actor, b.other))


def _exit(motion: VehicleMotion, inferred: CrashInferred, vehicle: str) -> Compass | None:
    """The told heading behind a turn, if it is not the initial one."""
    told = [e for e in motion.exits if e != inferred.headings.get(vehicle)]
    turns = inferred.maneuvers[vehicle] in ("turn_left", "turn_right", "u_turn", "merge") or meant_turn(motion)
    return told[0] if told and turns else None


# ------------------------------------------------------------------ headings
def _complete_headings(crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention]) -> None:
    """Headings of vehicles that have none, from a partner that has; V1 heads north if nothing is told."""
    ids = crash.roster.ids
    if not ids:
        return
    _from_exits(crash, inferred)
    from_entered_lanes(crash, inferred, pairs)
    if not inferred.headings:
        inferred.headings[ids[0]] = "N"
    for _ in ids:
        for v in ids:
            partner = _partner(v, inferred.headings, pairs, crash)
            if v not in inferred.headings and partner:
                turn = relative(crash, inferred, partner, v, pairs)
                inferred.headings[v] = turned(inferred.headings[partner], turn)


def _mend_headings(crash: CrashTold, inferred: CrashInferred, pairs: list[ContactMention]) -> None:
    """A told heading that both the told exit and the sides that touched contradict was a slip: the opposite one."""
    for v in sorted(inferred.stated):
        side = QUARTER_DEG.get(inferred.maneuvers[v])
        exits = crash.motions[v].exits
        partner = _partner(v, inferred.headings, pairs, crash)
        if side is None or not exits or partner not in inferred.stated or partner is None:
            continue
        if all(between(turned(inferred.headings[v], side), e) == 180 for e in exits):
            opposite = turned(inferred.headings[v], 180)
            if contact_prefers(inferred, partner, v, pairs, between(inferred.headings[partner], opposite)):
                inferred.headings[v] = opposite
                inferred.stated.discard(v)


def _from_exits(crash: CrashTold, inferred: CrashInferred) -> None:
    """A vehicle that turned left to go west had come from the south; beside told headings where the way is plain."""
    for v in crash.roster.ids:
        motion, maneuver = crash.motions[v], inferred.maneuvers[v]
        plain = [e for e in motion.exits if motion.sources[f"exit {e}"].rule in TURNS_TO]
        exits = plain if inferred.headings else motion.exits
        if v not in inferred.headings and exits and maneuver in ("turn_left", "turn_right"):
            inferred.headings[v] = turned(exits[0], 90 if maneuver == "turn_left" else -90)
            if plain:
                inferred.sources[f"{v} heading"] = motion.sources[f"exit {exits[0]}"]


def _partner(vehicle: str, known: Mapping[str, Compass], pairs: list[ContactMention], crash: CrashTold) -> str | None:
    """The vehicle that tells most of this one's heading: the first that it touched, else one that it is told to drive
    beside, else any."""
    for b in pairs:
        if vehicle in (b.actor, b.other):
            other = b.other if b.actor == vehicle else b.actor
            if other in known:
                return other
    beside = (other for _, relation, other, _ in crash.motions[vehicle].relations if relation == "same")
    return next((v for v in (*beside, *crash.roster.ids) if v in known and v != vehicle), None)
