"""How one vehicle heads relative to another, where no two headings are told.

Evidence is added up: relation words, critical events, maneuvers, and which sides touched. Knows no text.
"""

from __future__ import annotations

from sgcad_core.kinds import RAMP, actor_kind
from sgcad_core.reading.contacts.contact_telling import Blow
from sgcad_core.reading.inference.inference_state import HIT_FROM, Draft, Settled, apart, bend_deg, end_of, is_sideswipe
from sgcad_core.reading.motion.motion_record import DRIVES
from sgcad_core.records.specs import Area

QUARTERS = (0, 90, 180, 270)


def relative(draft: Draft, out: Settled, a: str, b: str, pairs: list[Blow]) -> int:
    """Most plausible heading of b minus that of a, clockwise quarters, by adding up evidence."""
    score = dict.fromkeys(QUARTERS, 0.0)
    score[180] += 0.1
    _add_kin(score, draft, a, b)
    _add_maneuvers(score, draft, out, a, b)
    blow = next((x for x in pairs if {a, b} == {x.actor, x.other}), None)
    if blow:
        score[0] += 0.5 if is_sideswipe(blow) else 0.0  # five in six sideswipes are of two who drive the same way
        if not (_on_foot(draft, a, b) and {blow.actor_area, blow.other_area} <= {"front", None}):
            _add_contact(score, out, a, b, blow)  # a front meets people whichever way they walk
    return max(QUARTERS, key=lambda q: score[q])


def _on_foot(draft: Draft, a: str, b: str) -> bool:
    return any(actor_kind(v.kind).walks for v in draft.who.vehicles if v.id in (a, b))


def contact_prefers(out: Settled, a: str, b: str, pairs: list[Blow], turn: int) -> bool:
    """Whether the sides that touched fit a turn (clockwise degrees) from a to b better than the opposite one."""
    blow = next((x for x in pairs if {a, b} == {x.actor, x.other}), None)
    score = dict.fromkeys(QUARTERS, 0.0)
    if blow:
        _add_contact(score, out, a, b, blow)
    return score.get(turn % 360, 0.0) > score.get((turn + 180) % 360, 0.0)


def _add_kin(score: dict[int, float], draft: Draft, a: str, b: str) -> None:
    for me, you in ((a, b), (b, a)):
        for weight, kin, other, words in draft.motions[me].kin:
            if other == you and not (words == "behind" and _on_foot(draft, a, b)):  # "ran from behind V2"
                for q in {"same": (0,), "opposite": (180,), "crossing": (90, 270)}[kin]:
                    score[q] += 0.6 * weight
    for me, sign in ((a, 1), (b, -1)):
        side = draft.motions[me].from_side
        if side:
            quarter = 270 if (side == "left") == (sign == 1) else 90
            score[quarter] += 1.5


def _add_maneuvers(score: dict[int, float], draft: Draft, out: Settled, a: str, b: str) -> None:
    for me in (a, b):
        motion, maneuver = draft.motions[me], out.maneuvers[me]
        if maneuver == "parked" and not _on_foot(draft, a, b):
            score[0] += 2.5
            score[180] += 2.0
        if maneuver == "crossing_centerline":
            score[180] += 1.5
        if motion.origin == RAMP or maneuver in ("lane_change_left", "lane_change_right", "merge"):
            score[0] += 2.0 if motion.origin == RAMP else 1.4  # a ramp runs beside the road before it joins
        if motion.origin in DRIVES:
            score[90] += 1.0
            score[270] += 1.0
        if motion.target and maneuver == "turn_left":
            score[180] += 0.5
    _add_kinds(score, draft, out, a, b)
    into = {"code:into_opposite": 90, "code:into_same": 270}
    for me, sign in ((a, 1), (b, -1)):
        for code, quarter in into.items():
            if draft.motions[me].did(code):
                turning_right = out.maneuvers[me] == "turn_right"
                score[(sign * (90 if turning_right else quarter)) % 360] += 1.5


def _add_kinds(score: dict[int, float], draft: Draft, out: Settled, a: str, b: str) -> None:
    """How riders and people on foot come where nothing tells it."""
    kinds = {v.id: actor_kind(v.kind) for v in draft.who.vehicles}
    for me, you in ((a, b), (b, a)):
        if out.maneuvers[me] == "turn_right" and kinds[you].keeps_right and not kinds[me].keeps_right:
            score[0] += 1.0  # a right turn cuts off who rides beside it, seldom who comes the other way
    for me, sign in ((a, 1), (b, -1)):
        if kinds[me].walks:  # who is told nothing else steps off the curb on the right
            score[90 if sign == 1 else 270] += 0.4


def _add_contact(score: dict[int, float], out: Settled, a: str, b: str, blow: Blow) -> None:
    """What the sides that touched say about the headings before any turn."""
    area = {blow.actor: blow.actor_area, blow.other: blow.other_area}
    one, two = end_of(area[a]), end_of(area[b])
    leads = [out.maneuvers[v] == "backing" and zone == "back" for v, zone in ((a, one), (b, two))]
    expected = contact_turn("front" if leads[0] else one, "front" if leads[1] else two)
    if expected is None:
        return
    expected += 180 * sum(leads)  # who backs leads with its back, and heads the other way
    bent = expected + bend_deg(out.maneuvers[a], one, two) - bend_deg(out.maneuvers[b], two, one)
    for q in QUARTERS:
        score[q] += (1.5 if one and two else 1.2) * (1 - apart(q, bent) / 90)


def contact_turn(area_a: Area | None, area_b: Area | None) -> float | None:
    """Heading of b minus that of a at contact, clockwise degrees; None if the sides say nothing."""
    if area_a is None and area_b is None:
        return None
    if area_b in (None, "front") and area_a:
        return HIT_FROM[area_a]
    if area_a in (None, "front") and area_b:
        return -HIT_FROM[area_b] % 360
    return 0.0 if {area_a, area_b} == {"left", "right"} or "back" in (area_a, area_b) else 180.0
