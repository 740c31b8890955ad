"""Whether a vehicle that stands at its first contact is told to come to that stop, and from where.

Reads the acts of one vehicle; knows no road and no other vehicle.
"""

from __future__ import annotations

from collections.abc import Sequence

from sgcad_core.reading.language import rule
from sgcad_core.records.course import ComesTo
from sgcad_core.records.timeline import MOVING, STANDING, Act


def comes_to_stop(acts: Sequence[Act]) -> ComesTo | None:
    """How a vehicle comes to the stop at which it is struck.

    `moves_up`: it stood, moved on and stopped once more; `drives_up`: it drove there and stopped; `moves_off`: it stood
    and has begun to move again; None: it is only told to stand. Acts after the first contact and such as are only meant
    do not count.
    """
    before = [act for act in acts if act.phase == "before" and not act.meant]
    stops = [number for number, act in enumerate(before) if act.kind in STANDING]
    if not stops:
        return None
    if then := [act.kind for act in before[stops[-1] + 1 :] if act.kind in MOVING]:
        return "moves_off" if set(then) == {"starts"} else None
    moved = [number for number, act in enumerate(before[: stops[-1]]) if act.kind in MOVING]
    if moved and any(number < moved[-1] for number in stops):
        return "moves_up"
    last = before[moved[-1] + 1 if moved else 0 : stops[-1] + 1]
    stopping = (act.kind == "slowing" or _stops(act) for act in last)
    return "drives_up" if any(stopping) else None


def _stops(act: Act) -> bool:
    return act.kind == "stopped" and rule("deeds.comes_to_a_stop").match(act.words) is not None
