"""How long before the first contact a scene begins: until what is told of the time before it can be seen.

Knows the options and motions of the pair, or of those that touch nothing; no scene.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from sgcad_core.planner.actor_plan import Role
from sgcad_core.planner.encounter.motion_options import Option, options
from sgcad_core.planner.maneuver_visible import seen_s
from sgcad_core.planner.motion import LEAD_S, Motion

WAITS_S = 1.5
"""Time for which a vehicle that starts from rest is seen standing."""
MOVES_S = 16.0
"""Time before the first contact where several moves are told, at most."""
_LEAST_LEAD_S = 3.0
"""Where a fast vehicle's road is too short for the usual time before the contact, it starts where the road does."""
_STILL_S, _LATE_S = 1.0, 0.9
"""Time on the undisturbed course before a maneuver begins; how late one that touches nothing may be on its road."""


def lead_of(pair: Sequence[tuple[Option, Motion, float]]) -> float:
    """Time before the first contact of a pair, seconds. `pair`: options, motions, own times at the contact."""
    lead = max((own - m.time_at(m.begins_m) for _, m, own in pair if not m.standing), default=0.0) + _STILL_S
    lead = max([lead, *(seen_s(option.role, m, own) for option, m, own in pair)])
    rest_s = [own - m.starts_s for _, m, own in pair if m.starts_s is not None]
    lead = max([lead, *(since + WAITS_S for since in rest_s)])
    driven = ((o, m, own) for o, m, own in pair if not m.standing and m.starts_s is None)
    room = min((own - m.time_at(o.role.course.first_m) for o, m, own in driven), default=LEAD_S[1])
    least = min(LEAD_S[0], max(room, _LEAST_LEAD_S))
    most = MOVES_S if any(option.drift.earlier for option, *_ in pair) else LEAD_S[1]
    return min(max(min(lead, room), least), most)


def lead_alone(alone: Iterable[Role]) -> float:
    """Time before a rollover or the like of those that touch nothing: until their told moves begin."""
    found = [LEAD_S[0]]
    for role in alone:
        motion = options(role)[0].motion
        begins, enters = (-motion.time_at(at) for at in (motion.begins_m, role.course.first_m))
        found.append(min(begins + _STILL_S, enters - _LATE_S, MOVES_S))
    return max(found)
