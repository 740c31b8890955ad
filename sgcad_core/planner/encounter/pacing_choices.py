"""The choices of speed of an actor within its maneuver, each with a cost as in `maneuver_choices`. Knows no lines."""

from __future__ import annotations

from sgcad_core.planner.actor_plan import Pacing, Role, along_with, usual_speed
from sgcad_core.planner.encounter.meeting_place import TURNING

_TOLD_SPEED = 0.25
"""Cost of another speed than stated where it could give the stated rotation."""
_THROUGH_BEND = 0.35
"""Share of the usual speed when joining from another road, behind the bend."""
_SLOWER, _FASTER = "drives slower than stated", "drives faster than stated"
ROLLS_IN = "does not stop where it is told to have stood"
_ROLLS = 0.6
"""Cost of rolling into the encounter where a start from rest is stated."""
_FROM_REST = ((0.0, 1.0), (0.1, 0.6), (0.15, 0.4))
"""Costs of a start from rest, with the factor on the usual speed that is then reached."""
_UNDER_WAY = 0.3
"""Cost of one that backs all the time: it has stood before."""


def pacings(role: Role) -> list[Pacing]:
    """Speeds: the usual one, catching up or falling behind, slower, faster, and from a stop."""
    if role.actor.record.walks:
        return [Pacing(0.0), Pacing(0.1, 1.6), Pacing(0.2, 0.7)]
    if role.course.stalls and role.actor.maneuver == "backing":
        return [Pacing(cost, factor, True) for cost, factor in ((0.0, 1.0), (0.1, 1.5), (0.15, 0.6))]
    if role.actor.maneuver == "backing" and not role.actor.speed_mph:
        return [Pacing(0.0, 1.0, True), Pacing(0.1, 1.5, True), Pacing(_UNDER_WAY), Pacing(_UNDER_WAY + 0.1, 0.5)]
    if role.pushed:
        return [Pacing(0.0, 1.0, True)]
    if role.told.from_rest:
        started = [Pacing(cost, factor, True) for cost, factor in _FROM_REST]
        return [*started, Pacing(_ROLLS, 0.6, note=ROLLS_IN), Pacing(_ROLLS + 0.1, 0.3, note=ROLLS_IN)]
    told = _TOLD_SPEED if (role.spins or role.other_spins) and role.actor.speed_mph else 0.0
    found = [Pacing(0.0), *_following(role), Pacing(0.2 + told, 0.75, note=_SLOWER)]
    found += [Pacing(0.3 + told, 1.3, note=_FASTER), Pacing(0.4 + told, 0.5, note=_SLOWER)]
    if role.actor.maneuver in TURNING or (role.course.passages and role.actor.maneuver != "slowing"):
        found.append(Pacing(0.25 + told, 1.0, True, "starts from a stop"))
    return found


def _following(role: Role) -> list[Pacing]:
    """Speeds at which the rear one of two in one direction catches up."""
    if not along_with(role) or "back" not in (role.side, role.other_side):
        return []
    own, other = usual_speed(role), role.other_mps
    if role.side != "back" and own < other + 3.0:
        return [Pacing(0.25, (other + 5.0) / own, note=_FASTER)]
    if role.side == "back" and own > other - 3.0:
        slower = [Pacing(0.15, max(other - 5.0, 0.4 * other, 1.0) / own, note=_SLOWER)]
        if from_another_road(role):
            slower.append(Pacing(0.2, max(_THROUGH_BEND * other, 1.0) / own, note=_SLOWER))
        return slower
    return []


def from_another_road(role: Role) -> bool:
    """Whether it starts on another road than the other actor."""
    return role.other_road not in (None, role.actor.road)
