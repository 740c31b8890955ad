"""One maneuver a vehicle: what it was doing when the crash began, decided from all its deeds.

A turn that is told as an act beats a plan to turn; a standing vehicle stays standing unless it moved on.
"""

from __future__ import annotations

from sgcad_core.narrative.motion import Deed, Motion
from sgcad_core.specs import Area, Maneuver

_PLAIN: tuple[Maneuver, ...] = (
    "crossing_centerline", "lane_change_left", "lane_change_right", "overtaking", "merge", "departing_road_right",
    "departing_road_left",
)  # fmt: skip


def decide(motion: Motion, hit: tuple[Area | None, ...], same_way: Maneuver = "turn_right") -> tuple[Maneuver, bool]:
    """The maneuver and whether the text tells it.

    `hit`: sides of the vehicle that were struck, in order. `same_way`: the turn that a critical event
    "turning into same direction" means.
    """
    if motion.did("parked", 3):
        return "parked", True
    if motion.did("backing", 3):
        return "backing", True
    if motion.did("u_turn", 3) or motion.did("code:u_turn"):
        return "u_turn", True
    turn = None if changed_lanes_after_turn(motion) else _turn(motion, hit, same_way)
    if turn:
        return turn, True
    if _standing(motion, hit):
        return "stopped", True
    return _moving(motion, 2 if hit[:1] == ("back",) else 3)


def changed_lanes_after_turn(motion: Motion) -> bool:
    """Whether a turn was over before the lane change in which the vehicle crashed."""
    turns = [d.number for d in motion.deeds if d.kind in ("turn_left", "turn_right") and d.weight >= 3]
    changes = [d.number for d in motion.deeds if d.kind.startswith("lane_change") and d.weight >= 3]
    return bool(turns and changes) and min(changes) > max(turns)


def _turn(motion: Motion, hit: tuple[Area | None, ...], same_way: Maneuver) -> Maneuver | None:
    """A turn that was made or begun."""
    from_behind = bool(hit) and hit[0] == "back"
    for side in ("left", "right"):
        if motion.did(f"code:turn_{side}") and not (from_behind and _standing(motion, hit)):
            return "turn_left" if side == "left" else "turn_right"
    acts = [d for d in motion.deeds if d.kind in ("turn_left", "turn_right") and d.weight >= 2]
    if acts and not (from_behind and motion.did("stopped", 2)):
        return "turn_left" if max(acts, key=lambda d: d.weight).kind == "turn_left" else "turn_right"
    if motion.did("code:into_opposite"):
        return "turn_left"
    wants = [d for d in motion.deeds if d.kind.startswith("want_turn_") and d.weight >= 2]
    if motion.did("code:over_left") or motion.did("crossing_centerline", 3):
        wants = []
    if wants and not from_behind and (_moved_on(motion, wants[0]) or not motion.did("stopped", 2)):
        return "turn_left" if wants[0].kind == "want_turn_left" else "turn_right"
    return same_way if motion.did("code:into_same") else None


def _moved_on(motion: Motion, since: Deed) -> bool:
    return any(d.kind == "moved_on" and d.weight >= 2 and d.number >= since.number for d in motion.deeds)


def _standing(motion: Motion, hit: tuple[Area | None, ...]) -> bool:
    from_behind = bool(hit) and hit[0] == "back"
    stops = [
        d
        for d in motion.deeds
        if d.kind == "stopped" and d.weight >= (1 if from_behind and not motion.did("slowing", 3) else 3)
    ]
    if motion.did("code:stopped"):
        return from_behind or bool(stops) or not motion.did("moved_on", 3)
    if not stops:
        return False
    return from_behind or not _moved_on(motion, stops[0])


def meant_turn(motion: Motion) -> Maneuver | None:
    """The turn that a vehicle waited, slowed or wanted to make."""
    wants = [d for d in motion.deeds if d.kind.startswith("want_turn_")]
    if not wants:
        return None
    return "turn_left" if max(wants, key=lambda d: d.weight).kind == "want_turn_left" else "turn_right"


def started_from_stop(motion: Motion, maneuver: Maneuver) -> bool:
    """Whether a vehicle that goes on, turns or merges is told to have stood right before."""
    if maneuver not in ("straight", "merge", "turn_left", "turn_right", "u_turn"):
        return False
    onward = [d for d in motion.deeds if d.kind in ("moved_on", "straight", "turn_left", "turn_right", "u_turn")]
    return any(d.kind == "stopped" and _moved_behind(d, onward) for d in motion.deeds)


def _moved_behind(stop: Deed, onward: list[Deed]) -> bool:
    return any(stop.number <= d.number <= stop.number + 1 for d in onward)


def _over_the_line(motion: Motion, side: str) -> tuple[Maneuver, bool]:
    """Over a lane line: beside a vehicle that drives the same way it is a change of lane."""
    if any(kin == "same" and word == "code" for _, kin, _, word in motion.kin):
        return ("lane_change_left" if side == "left" else "lane_change_right"), True
    return ("crossing_centerline", True) if side == "left" else ("departing_road_right", True)


def _moving(motion: Motion, least: int) -> tuple[Maneuver, bool]:
    for kind in _PLAIN:
        if motion.did(kind, 3):
            return kind, True
    for side, over in (("left", "code:over_left"), ("right", "code:over_right")):
        if motion.did(over) and not motion.did("code:straight"):
            return _over_the_line(motion, side)
    if motion.did("lane_change", 3):
        return "lane_change_left", False
    if motion.did("negotiating_curve", 3):
        return "negotiating_curve", True
    if motion.did("slowing", least):
        return "slowing", True
    return "straight", motion.did("straight") or motion.did("code:straight")
