"""From what is told to what follows: maneuvers decided, headings completed, contact sides completed.

Evidence is added up: stated headings beat relation words, relation words beat what the sides that touched
suggest. Angles here are clockwise degrees, as compass words turn. Knows no text.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from sgcad_core.reading.contacts.contact_sides import join_contacts
from sgcad_core.reading.contacts.contact_telling import Blow, with_areas
from sgcad_core.reading.inference.inference_state import QUARTER_DEG, Draft, Settled, end_of
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.maneuvers import (
    SHIFTED,
    Decision,
    changed_lanes_after_turn,
    decide,
    meant_turn,
    turned_before,
)
from sgcad_core.reading.motion.motion_record import Heard, Motion
from sgcad_core.reading.motion.relative_headings import contact_prefers, relative
from sgcad_core.reading.text.compass import between, turned
from sgcad_core.records.specs import Area, Compass, Maneuver


def settle(draft: Draft) -> Settled:
    """Decide everything that the text allows to decide."""
    out = Settled()
    pairs = _vehicle_blows(draft)
    _stated_headings(draft, out)
    for v in draft.who.ids:
        motion = draft.motions[v]
        _maneuver(out, v, decide(motion, _areas_hit(v, pairs), _same_way_turn(draft, out, v)))
        if motion.speeds_mph:
            out.speeds[v] = _take(out, f"{v} speed", motion.speeds_mph)
    _turned_headings(draft, out)
    _faced_headings(draft, out)
    _still_moving(draft, out, pairs)
    _change_hands(draft, out, pairs)
    _mend_headings(draft, out, pairs)
    _complete_headings(draft, out, pairs)
    out.exits = {v: e for v in draft.who.ids if (e := _exit(draft.motions[v], out, v)) is not None}
    out.contacts = join_contacts(draft, out, pairs)
    return out


def _still_moving(draft: Draft, out: Settled, pairs: list[Blow]) -> None:
    """In a near crash one who comes to a stop is seen to slow; only who stood all the time stands."""
    pair = {name for b in pairs[:1] for name in (b.actor, b.other)} or set(draft.who.ids[:2])
    for v in sorted(pair) if draft.near else ():
        cue = out.sources.get(f"{v} maneuver")
        if out.maneuvers[v] == "stopped" and cue and rule("near_events.came_to_stop").match(cue.words):
            out.maneuvers[v] = "slowing"


def _turned_headings(draft: Draft, out: Settled) -> None:
    """Who had turned before the crash heads where it is told to go since, else where the turn led."""
    for v, motion in draft.motions.items():
        turn = turned_before(motion, out.maneuvers[v])
        if turn is None or v not in out.headings:
            continue
        since = [h for h in motion.headings if h.cue.number > turn.number]
        if since:
            out.headings[v], out.sources[f"{v} heading"] = since[-1].value, since[-1].cue
        elif motion.exits:
            out.headings[v] = motion.exits[-1]
            out.sources[f"{v} heading"] = motion.sources[f"exit {motion.exits[-1]}"]
        else:
            out.headings[v] = turned(out.headings[v], 90 if turn.kind == "turn_right" else -90)
            out.stated.discard(v)


def _faced_headings(draft: Draft, out: Settled) -> None:
    """Of an account in order: who backs heads where it was last told to face, whatever way it had come before."""
    for v, motion in draft.motions.items():
        faced = [(cue.number, what.removeprefix("faces "), cue) for what, cue in motion.sources.items()
                 if what.startswith("faces ")]  # fmt: skip
        if motion.ordered and faced and out.maneuvers[v] == "backing":
            _, way, cue = max(faced, key=lambda told: told[0])
            out.headings[v], out.sources[f"{v} heading"] = way, cue  # type: ignore[assignment]
            out.stated.add(v)


def _change_hands(draft: Draft, out: Settled, pairs: list[Blow]) -> None:
    """Of a change of lane to a hand that nobody tells: towards the flank by which the two touched, away from a lane
    that is told."""
    for v in draft.who.ids:
        cue = out.sources.get(f"{v} maneuver")
        if out.maneuvers[v] != "lane_change_left" or v in out.told_maneuvers or (cue and cue.rule in SHIFTED):
            continue
        hit = next((b for b in pairs if v in (b.actor, b.other)), None)
        own, other = (hit.actor_area, hit.other_area) if hit and hit.actor == v else (
            (hit.other_area, hit.actor_area) if hit else (None, None))  # fmt: skip
        if (
            "right" in (own or "").split("/")
            or "left" in (other or "").split("/")
            or draft.motions[v].lane_word == "left"
        ):
            out.maneuvers[v] = "lane_change_right"


def _stated_headings(draft: Draft, out: Settled) -> None:
    for v, motion in draft.motions.items():
        turned_in = motion.exits and changed_lanes_after_turn(motion)
        if motion.headings or turned_in:
            out.headings[v] = _take(out, f"{v} heading", motion.headings) if motion.headings else motion.exits[0]
            if not motion.headings:
                out.sources[f"{v} heading"] = motion.sources[f"exit {motion.exits[0]}"]
            out.stated.add(v)


def _take(out: Settled, what: str, heard: list[Heard]) -> Any:
    """What was told with most weight, first of all."""
    best = max(heard, key=lambda h: h.weight)
    out.sources[what] = best.cue
    return best.value


def _maneuver(out: Settled, vehicle: str, decision: Decision) -> None:
    out.maneuvers[vehicle] = decision.maneuver
    if decision.told:
        out.told_maneuvers.add(vehicle)
    if decision.deed:
        out.sources[f"{vehicle} maneuver"] = decision.deed.cue


def _same_way_turn(draft: Draft, out: Settled, vehicle: str) -> Maneuver:
    """Which turn brings a vehicle into the direction of the other: right, unless it came from the left."""
    other = draft.who.other(vehicle)
    if other and {vehicle, other} <= out.stated and between(out.headings[vehicle], out.headings[other]) == 270:
        return "turn_left"
    return "turn_right"


def _vehicle_blows(draft: Draft) -> list[Blow]:
    """Contacts between numbered vehicles, one a pair, each completed from its other tellings."""
    hits = [b for b in draft.blows if b.other in draft.who.ids]
    found: list[Blow] = []
    for i, blow in enumerate(hits):
        if all({blow.actor, blow.other} != {b.actor, b.other} for b in found):
            found.append(with_areas(blow, hits[i + 1 :]))
    return found


def _areas_hit(vehicle: str, pairs: list[Blow]) -> tuple[Area | None, ...]:
    """Sides of the vehicle that were hit, first contact first; of a corner the end."""
    zones = (b.actor_area if b.actor == vehicle else b.other_area for b in pairs if vehicle in (b.actor, b.other))
    return tuple(end_of(z) for z in zones)


def _exit(motion: Motion, out: Settled, vehicle: str) -> Compass | None:
    """The told heading behind a turn, if it is not the initial one."""
    told = [e for e in motion.exits if e != out.headings.get(vehicle)]
    turns = out.maneuvers[vehicle] in ("turn_left", "turn_right", "u_turn", "merge") or meant_turn(motion)
    return told[0] if told and turns else None


# ------------------------------------------------------------------ headings
def _complete_headings(draft: Draft, out: Settled, pairs: list[Blow]) -> None:
    """Headings of vehicles that have none, from a partner that has; V1 heads north if nothing is told."""
    ids = draft.who.ids
    if not ids:
        return
    if not out.headings:
        _from_exits(draft, out)
    if not out.headings:
        out.headings[ids[0]] = "N"
    for _ in ids:
        for v in ids:
            partner = _partner(v, out.headings, pairs, draft)
            if v not in out.headings and partner:
                turn = relative(draft, out, partner, v, pairs)
                out.headings[v] = turned(out.headings[partner], turn)


def _mend_headings(draft: Draft, out: Settled, pairs: list[Blow]) -> None:
    """A told heading that both the told exit and the sides that touched contradict was a slip: the opposite one."""
    for v in sorted(out.stated):
        side = QUARTER_DEG.get(out.maneuvers[v])
        exits = draft.motions[v].exits
        partner = _partner(v, out.headings, pairs, draft)
        if side is None or not exits or partner not in out.stated or partner is None:
            continue
        if all(between(turned(out.headings[v], side), e) == 180 for e in exits):
            opposite = turned(out.headings[v], 180)
            if contact_prefers(out, partner, v, pairs, between(out.headings[partner], opposite)):
                out.headings[v] = opposite
                out.stated.discard(v)


def _from_exits(draft: Draft, out: Settled) -> None:
    """A vehicle that turned left to go west had come from the south."""
    for v in draft.who.ids:
        exits, maneuver = draft.motions[v].exits, out.maneuvers[v]
        if exits and maneuver in ("turn_left", "turn_right"):
            out.headings[v] = turned(exits[0], 90 if maneuver == "turn_left" else -90)
            return


def _partner(vehicle: str, known: Mapping[str, Compass], pairs: list[Blow], draft: Draft) -> str | None:
    """The vehicle that tells most of this one's heading: the first that it touched, else one that it is told to drive
    beside, else any."""
    for b in pairs:
        if vehicle in (b.actor, b.other):
            other = b.other if b.actor == vehicle else b.actor
            if other in known:
                return other
    beside = (other for _, kin, other, _ in draft.motions[vehicle].kin if kin == "same")
    return next((v for v in (*beside, *draft.who.ids) if v in known and v != vehicle), None)
