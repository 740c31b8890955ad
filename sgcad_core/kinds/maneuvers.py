"""Pre-crash maneuvers, and the parts that actors have in a crash. Plain data."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, get_args

Maneuver = Literal[
    "straight", "turn_left", "turn_right", "u_turn", "stopped", "parked", "slowing", "negotiating_curve",
    "lane_change_left", "lane_change_right", "merge", "overtaking", "crossing_centerline",
    "departing_road_left", "departing_road_right", "backing", "other",
]  # fmt: skip
MANEUVERS: tuple[Maneuver, ...] = get_args(Maneuver)
CHANGES: Mapping[Maneuver, int] = {"lane_change_left": 1, "lane_change_right": -1}
"""Maneuvers into a lane beside the own one, and its side: 1 to the left."""
ACROSS_LANES: frozenset[Maneuver] = frozenset({*CHANGES, "merge", "overtaking"})
"""Maneuvers over the lanes of one direction."""
OVER_A_LINE: tuple[Maneuver, ...] = (
    "crossing_centerline", "departing_road_left", "departing_road_right", "lane_change_left", "lane_change_right",
)  # fmt: skip
"""Maneuvers over the line beside the own lane."""
CrashRole = Literal["initiator", "responder", "bystander"]
"""Part in a crash: made the conflict, was left to deal with it, took no part in the first contact."""
CRASH_ROLES: tuple[CrashRole, ...] = get_args(CrashRole)
