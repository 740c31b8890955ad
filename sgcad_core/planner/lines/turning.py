"""Lines of a turn: as the road has it, cut, swung wide, or from beside the lane.

Costs as in `sgcad_core.planner.encounter.maneuver_choices`. Knows one actor.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sgcad_core.planner.actor_plan import Drift, Role, along_with
from sgcad_core.planner.lines.actor_course import Passage

_CORNER_RUN_M = 10.0
"""Length before and behind a junction on which a cut corner is beside the lane."""
_STARTED_RUN_M = 3.0
"""The same of one that stands at the line first, square in its lane."""

WIDE = "swings wide in its turn, as the told sides imply"
_WIDE_M, _WIDE_STEP_M, _WIDE_COST = 1.2, 0.8, (0.3, 0.01)
"""Least way over its lane of a turn that swings wide, and between two such; their cost, and that of each metre."""
_WIDE_FROM_M, _WIDE_TO_M, _WIDE_MORE_M = 2.0, 4.0, 1.0
"""From the start of the swing to the junction, and from the junction to its end; how far beyond the line of the other
one it may lead."""


def wide_lines(role: Role) -> list[Drift]:
    """Right turns that swing over the lanes of oncoming traffic in the road which they enter, the least first: from the
    lane as told, and no earlier than they turn."""
    turn = role.course.turn
    if turn is None or role.actor.maneuver != "turn_right":
        return []
    most = max(role.course.left_edge_m, role.place.aside_m + _WIDE_MORE_M)
    ends = ((turn.entry_m + turn.exit_m) / 2, turn.exit_m, turn.exit_m + _WIDE_TO_M)
    begins = turn.entry_m - _WIDE_FROM_M
    return [
        Drift(_WIDE_COST[0] + _WIDE_COST[1] * left, left, end - begins, end, note=WIDE)
        for left in np.arange(_WIDE_M, most, _WIDE_STEP_M).tolist()
        for end in ends
    ]


def corner_lines(role: Role) -> list[Drift]:
    """Lines that cut a corner, swing wide or come from beside the lane."""
    turn = role.course.turn
    if turn is None:
        return []
    run_m = _STARTED_RUN_M if role.told.from_rest else _CORNER_RUN_M
    middle, half = (turn.entry_m + turn.exit_m) / 2, max(turn.exit_m - turn.entry_m, 6.0) / 2 + run_m
    cut = [Drift(0.15, left, half, middle, True) for left in (1.2, -1.2, -2.2)]
    if role.actor.maneuver == "turn_right":
        return [*cut, *_from_the_left(role, turn)]
    return [*cut, *_from_the_right(role, turn)] if role.actor.maneuver in ("turn_left", "u_turn") else cut


def _from_the_right(role: Role, turn: Passage) -> list[Drift]:
    """A left turn from the next lane to the right, and from the right edge of the road; none out of a told lane."""
    if role.actor.lane is not None and role.course.right_edge_m > role.course.lane_width_m:
        return []
    lane, edge = role.course.lane_width_m, role.course.right_edge_m - role.size[1] / 2
    return _from_beside_it(role, turn, [-lane, -edge] if edge > 1.4 * lane else [-lane] if edge > lane else [-edge])


def _from_the_left(role: Role, turn: Passage) -> list[Drift]:
    """A right turn from further left in its lane, and from the next lane to the left where there is one and none is
    told."""
    lane = role.course.lane_width_m
    in_lane = max((lane - role.size[1]) / 2, 0.3)
    beside = role.course.own_left_m > lane and role.actor.lane is None
    return _from_beside_it(role, turn, [in_lane, lane] if beside else [in_lane])


def _from_beside_it(role: Role, turn: Passage, asides_m: Sequence[float]) -> list[Drift]:
    """A turn from given offsets to the left of its lane, back on its line at the end of the junction."""
    length, cost = turn.exit_m - turn.entry_m + 6.0, 0.15 if along_with(role) else 0.3
    return [
        Drift(cost, -aside, length, turn.exit_m, before_m=aside,
              note=f"turns from further to the {'left' if aside > 0 else 'right'}")
        for aside in asides_m
    ]  # fmt: skip
