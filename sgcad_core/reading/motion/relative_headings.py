"""How one vehicle heads relative to another, where no two headings are told.

Evidence is added up: relation words, critical events, maneuvers, and which sides touched. Knows no text.
"""

from __future__ import annotations

from sgcad_core.kinds import RAMP, actor_kind
from sgcad_core.reading.contacts.contact_records import ContactMention
from sgcad_core.reading.inference.inference_state import (
    HIT_FROM,
    CrashInferred,
    CrashTold,
    apart,
    bend_deg,
    end_of,
    is_sideswipe,
    side_met,
)
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.maneuvers import INTO_LANE_OF
from sgcad_core.reading.motion.motion_record import DRIVES
from sgcad_core.reading.text.area_phrases import Zone
from sgcad_core.records.specs import Area

QUARTERS = (0, 90, 180, 270)

_REAR_END = {"front", "back"}
_STREET = 2.0
"""That both are told by name to drive on one street, or on two."""


def relative(crash: CrashTold, inferred: CrashInferred, a: str, b: str, pairs: list[ContactMention]) -> int:
    """Most plausible heading of b minus that of a, clockwise quarters, by adding up evidence."""
    score = dict.fromkeys(QUARTERS, 0.0)
    score[180] += 0.1
    _add_relations(score, crash, a, b)
    _add_maneuvers(score, crash, inferred, a, b)
    mention = next((x for x in pairs if {a, b} == {x.actor, x.other}), None)
    if mention:
        score[0] += (
            0.5 if is_sideswipe(mention) else 0.0
        )  # five in six sideswipes are of vehicles that drive the same way
        if not (_on_foot(crash, a, b) and {mention.actor_area, mention.other_area} <= {"front", None}):
            follows = (
                crash.roster.counted and {end_of(x) for x in (mention.actor_area, mention.other_area)} == _REAR_END
            )
            if follows:  # into the rear of one that turns as well: it comes up behind it
                score[0] += 1.5
            else:
                _add_contact(score, inferred, a, b, mention)  # a front meets people whichever way they walk
    return max(QUARTERS, key=lambda q: score[q])


def _on_foot(crash: CrashTold, a: str, b: str) -> bool:
    return any(actor_kind(v.kind).walks for v in crash.roster.vehicles if v.id in (a, b))


def contact_prefers(inferred: CrashInferred, a: str, b: str, pairs: list[ContactMention], turn: int) -> bool:
    """Whether the sides that touched fit a turn (clockwise degrees) from a to b better than the opposite one."""
    mention = next((x for x in pairs if {a, b} == {x.actor, x.other}), None)
    score = dict.fromkeys(QUARTERS, 0.0)
    if mention:
        _add_contact(score, inferred, a, b, mention)
    return score.get(turn % 360, 0.0) > score.get((turn + 180) % 360, 0.0)


def _add_relations(score: dict[int, float], crash: CrashTold, a: str, b: str) -> None:
    for me, you in ((a, b), (b, a)):
        for weight, relation, other, words in crash.motions[me].relations:
            if other == you and not (words == "behind" and _on_foot(crash, a, b)):  # "ran from behind V2"
                for q in {"same": (0,), "opposite": (180,), "crossing": (90, 270)}[relation]:
                    score[q] += weight  # more than what the sides that touched suggest
    on = [crash.motions[v].street for v in (a, b)]
    if all(on):
        for q in (0, 180) if on[0] == on[1] else (90, 270):
            score[q] += _STREET
    for me, sign in ((a, 1), (b, -1)):
        side = crash.motions[me].from_side
        if side:
            quarter = 270 if (side == "left") == (sign == 1) else 90
            score[quarter] += 3.0


def _add_maneuvers(score: dict[int, float], crash: CrashTold, inferred: CrashInferred, a: str, b: str) -> None:
    for me in (a, b):
        motion, maneuver = crash.motions[me], inferred.maneuvers[me]
        if maneuver == "parked" and not _on_foot(crash, a, b):
            score[0] += 2.5
            score[180] += 2.0
        if motion.has_cue("leaving_parking", 3) and motion.origin is None and not _on_foot(crash, a, b):
            score[0] += 2.0  # it stood at the curb of the lane that it drives into
        if maneuver == "crossing_centerline":
            score[180] += 1.5
        if motion.origin == RAMP or maneuver in ("lane_change_left", "lane_change_right", "merge"):
            score[0] += 2.0 if motion.origin == RAMP else 1.6  # a ramp runs beside the road before it joins
        source = inferred.sources.get(f"{me} maneuver")
        if source and source.rule == INTO_LANE_OF and rule("deeds.change_word").search(source.words):
            score[0] += 1.0  # lanes are changed among those of one direction
        if motion.origin in DRIVES:
            score[90] += 1.0
            score[270] += 1.0
        if motion.target and maneuver == "turn_left":
            score[180] += 0.5
    for off, turn in (("departing_road_left", 180), ("departing_road_right", 0)):
        if {"parked", off} == {inferred.maneuvers[a], inferred.maneuvers[b]}:
            score[turn] += 2.0  # on either side vehicles are parked along the traffic there
    _add_kinds(score, crash, inferred, a, b)
    into = {"code:into_opposite": 90, "code:into_same": 270}
    for me, sign in ((a, 1), (b, -1)):
        for code, quarter in into.items():
            if crash.motions[me].has_cue(code):
                turning_right = inferred.maneuvers[me] == "turn_right"
                score[(sign * (90 if turning_right else quarter)) % 360] += 1.5


def _add_kinds(score: dict[int, float], crash: CrashTold, inferred: CrashInferred, a: str, b: str) -> None:
    """How riders and people on foot come where nothing tells it."""
    kinds = {v.id: actor_kind(v.kind) for v in crash.roster.vehicles}
    for me, you in ((a, b), (b, a)):
        if inferred.maneuvers[me] == "turn_right" and kinds[you].keeps_right and not kinds[me].keeps_right:
            score[0] += 1.0  # a right turn cuts off a cyclist beside it, seldom an oncoming one
    for me, sign in ((a, 1), (b, -1)):
        if kinds[me].walks:  # a pedestrian without a told path steps off the curb on the right
            score[90 if sign == 1 else 270] += 0.4


def _add_contact(score: dict[int, float], inferred: CrashInferred, a: str, b: str, mention: ContactMention) -> None:
    """What the sides that touched say about the headings before any turn."""
    area = {mention.actor: mention.actor_area, mention.other: mention.other_area}
    one, two = _met_sides(inferred, (a, b), (area[a], area[b]))
    leads = [inferred.maneuvers[v] == "backing" and zone == "back" for v, zone in ((a, one), (b, two))]
    expected = contact_turn("front" if leads[0] else one, "front" if leads[1] else two)
    if expected is None:
        return
    expected += 180 * sum(leads)  # a backing vehicle leads with its back, and heads the other way
    bent = expected + bend_deg(inferred.maneuvers[a], one, two) - bend_deg(inferred.maneuvers[b], two, one)
    for q in QUARTERS:
        score[q] += (1.5 if one and two else 1.2) * (1 - apart(q, bent) / 90)


def _met_sides(
    inferred: CrashInferred, pair: tuple[str, str], zones: tuple[Zone | None, Zone | None]
) -> tuple[Area | None, Area | None]:
    """The sides of two that touch, corners decided: two rear corners touch with their flanks where neither backs."""
    ends = end_of(zones[0]), end_of(zones[1])
    rear = ends == ("back", "back") and not any(inferred.maneuvers[v] == "backing" for v in pair)
    return (side_met(zones[0]), side_met(zones[1])) if rear else ends


def contact_turn(area_a: Area | None, area_b: Area | None) -> float | None:
    """Heading of b minus that of a at contact, clockwise degrees; None if the sides say nothing."""
    if area_a is None and area_b is None:
        return None
    if area_b in (None, "front") and area_a:
        return HIT_FROM[area_a]
    if area_a in (None, "front") and area_b:
        return -HIT_FROM[area_b] % 360
    return 0.0 if {area_a, area_b} == {"left", "right"} or "back" in (area_a, area_b) else 180.0
