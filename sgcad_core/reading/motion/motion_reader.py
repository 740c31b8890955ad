"""Motion of each vehicle before the crash: heading, lane, speed, maneuver cues, origin and target.

Reads segments (one subject each) and the critical-event sentences that many reports carry. What an interview says
counts only where nothing else does. Knows no contact and infers nothing across vehicles.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from sgcad_core.reading.actors.unnumbered_actors import PARTS
from sgcad_core.reading.actors.vehicles import MENTION, Roster, VehicleDescription
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.motion.clauses import Segment, Statement
from sgcad_core.reading.motion.heading_lane_cues import (
    note_headings_of_mentions,
    read_heading,
    read_lane,
    read_lane_change,
    read_origin_and_target,
    read_relations,
    read_straddle,
)
from sgcad_core.reading.motion.maneuver_cues import read_maneuver_cues
from sgcad_core.reading.motion.motion_record import ManeuverCue, VehicleMotion
from sgcad_core.reading.roads.street_names import driven_on
from sgcad_core.reading.text.sentence_roles import HIT, Role
from sgcad_core.reading.text.speeds import read_speed, read_speeds_beside

_WEIGHT: dict[Role, int] = {"approach": 4, "impact": 3, "opening": 3, "road": 3, "avoidance": 3, "conditions": 3,
                          "rest": 2}  # fmt: skip
_UNREAD: tuple[Role, ...] = ("codes", "factors", "towing", "injury", "restraint", "police", "health", "formal")


def read_motions(
    statements: Sequence[Statement], segments: Iterable[Segment], roster: Roster, struck_at: int | None = None
) -> dict[str, VehicleMotion]:
    """Motion of every vehicle of the roster; `struck_at`: the sentence of the contact, where that is known."""
    found = {v: VehicleMotion(watched=v == roster.ids[0], ordered=roster.counted) for v in roster.ids}
    for identity in roster.vehicles if roster.counted else ():
        _read_part(found[identity.id], identity, roster)
    impact = min((t.number for t in statements if t.role == "impact"), default=len(statements))
    impact = struck_at if roster.counted and struck_at is not None else impact
    own = () if roster.counted else reversed(statements)
    touched = {
        v: t.number for t in own if t.role == "impact" for v in MENTION.findall(t.text)
    }  # each in the first sentence of its own contact: a third vehicle still waits behind that of the others
    texts = {t.number: t.text for t in statements}
    from_median = counts_from_median(texts.values(), roster)
    contact_sentence = next((t for t in statements if t.number == impact), None) if roster.counted else None
    for segment in segments:
        if segment.role in _UNREAD or (contact_sentence and _behind(contact_sentence, segment)):
            continue
        for vehicle in segment.subjects:
            motion = found[vehicle]
            motion.at = segment.number
            after = segment.number > max(impact, touched.get(vehicle, 0))
            late = after and bool(motion.headings or motion.cues)
            if late and roster.counted:
                continue
            most = 2 if late else 4
            _read(motion, segment, vehicle, roster, most, after, from_median)
            before = texts.get(segment.number, "")[: segment.at]
            read_speed(motion, segment.text, _weight(segment, most), before)
    for t in statements:
        for motion in found.values():
            motion.at = t.number
        if t.role not in _UNREAD:
            note_headings_of_mentions(found, t.text, _WEIGHT.get(t.role, 1))
        if t.role in ("codes", "factors"):
            read_critical_event(found, t, roster)
    if not roster.counted:
        read_speeds_beside(found, [t for t in statements if t.role not in _UNREAD])
    streets = driven_on(statements)
    for v, motion in found.items():
        motion.street = streets.get(v)
        _hear_interview(motion)
    return found


def counts_from_median(texts: Iterable[str], roster: Roster) -> bool:
    """Whether "the number 1 lane" is the leftmost one, as police in the U.S. count.

    Reports of NHTSA's investigators count from the right curb in these words too. They number vehicles, never name a
    road, and have words of their own.
    """
    told = tuple(texts)
    named = roster.counted or any(rule("street_names.numbered").search(text) for text in told)
    return named or not any(rule("motion_reader.counts_from_curb").search(text) for text in told)


def _hear_interview(motion: VehicleMotion) -> None:
    """Raises the weight of interview cues of a vehicle whose motion is told nowhere else."""
    if motion.ordered or any(d.weight >= 2 or d.kind.startswith("code:") for d in motion.cues):
        return
    motion.cues = [d._replace(weight=3) for d in motion.cues]


def _behind(contact_sentence: Statement, segment: Segment) -> bool:
    """Whether a segment of the sentence of the contact tells what came behind it."""
    if segment.number != contact_sentence.number or not rule("motion_reader.next_event").search(
        contact_sentence.text[: segment.at]
    ):
        return False
    return any(not rule("motion_reader.no_hit").search(contact_sentence.text[: m.start()].lower())
               for m in HIT.finditer(contact_sentence.text, 0, segment.at))  # fmt: skip


def _read_part(motion: VehicleMotion, identity: VehicleDescription, roster: Roster) -> None:
    """Where a vehicle drives beside the subject, as its first description says: "the lead vehicle"."""
    words = " ".join(source.words for source in identity.described).lower().split()
    part = next((PARTS[word] for word in words if word in PARTS), None)
    if part and identity.id != roster.ids[0]:
        motion.relations.append((4, "opposite" if part == "opposite" else "same", roster.ids[0], part))


def _read(
    motion: VehicleMotion, segment: Segment, vehicle: str, roster: Roster, most: int, after: bool, from_median: bool
) -> None:
    """`most`: the highest weight; what is told again behind the impact (`after`) is another witness."""
    text = _until_stopped(rule("motion_reader.brackets").sub(" ", segment.text), after)
    if motion.ordered:
        text = text.replace(f"{vehicle.lower()}'s ", "its ")
        text = rule("motion_reader.strangers").sub(lambda m: " " * len(m[0]), text)
    weight = _weight(segment, most)
    before_hit = _until_hit(text) if segment.role != "rest" else _until_rest(text)
    read_heading(motion, before_hit, weight)
    read_maneuver_cues(motion, before_hit, weight, segment.number, segment.at)
    read_relations(motion, before_hit, weight, vehicle, roster)
    if segment.role != "rest":
        read_lane(motion, before_hit, from_median)
        read_straddle(motion, before_hit, from_median)
        if not after:
            read_lane_change(motion, before_hit, from_median)
        read_origin_and_target(motion, before_hit, after)


def _weight(segment: Segment, most: int) -> int:
    return min(_WEIGHT.get(segment.role, 1), most)


def _until_stopped(text: str, after: bool) -> str:
    """The text without the end of a motion that the impact began: "spun and stopped in the road", "stopped facing
    west"."""
    found = rule("motion_reader.stopped_at_last").search(text) or (
        rule("motion_reader.stopped_there").search(text) if after else None
    )
    return (
        text[: found.start()]
        if found and (after or rule("motion_reader.thrown").search(text[: found.start()]))
        else text
    )


def _until_hit(text: str) -> str:
    """The part before the contact, with what is told to be done at it: what follows is the effect, not the approach."""
    for m in HIT.finditer(text):
        if not rule("motion_reader.no_hit").search(text[: m.start()]):
            moving = rule("motion_reader.moving_hit").match(m.group())
            meanwhile = rule("motion_reader.while_hitting").search(text, m.end())
            return text[: m.end() if moving else m.start()] + (f", {meanwhile.group()}" if meanwhile else "")
    return text


def _until_rest(text: str) -> str:
    cut = rule("motion_reader.rest").search(text)
    return text[: cut.start()] if cut else text


def read_critical_event(found: dict[str, VehicleMotion], statement: Statement, roster: Roster) -> None:
    """Adds cues and relations of a critical-event sentence."""
    text = statement.text.lower()
    if not rule("critical_events.event").search(text):
        return
    named = [v for v in MENTION.findall(statement.text) if v in roster.ids]
    owner = named[0] if named else statement.subject
    if owner not in found or rule("critical_events.uncoded").match(text):
        return
    if rule("critical_events.other_vehicle").search(text):
        _other_code(found, owner, text, statement.number, roster)
    else:
        for event in of_role("own_event"):
            if code := event.search(text):
                found[owner].cues.append(
                    ManeuverCue(f"code:{event.yields['deed']}", 2, statement.number, code.group(), event.id)
                )


def _other_code(found: dict[str, VehicleMotion], owner: str, text: str, number: int, roster: Roster) -> None:
    other = roster.other(owner)
    for event in of_role("others_event"):
        if not (code := event.search(text)):
            continue
        what = event.yields
        if "kin" in what:
            for me, you in ((owner, other), (other, owner)) if other else ((owner, other),):
                if me:
                    found[me].relations.append((3, what["kin"], you, "code"))
        elif who_did := (owner if what["whom"] == "self" else other):
            found[who_did].cues.append(ManeuverCue(f"code:{what['deed']}", 2, number, code.group(), event.id))
