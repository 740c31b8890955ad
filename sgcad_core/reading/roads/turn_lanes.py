"""Turn lanes in other words than "left-turn lane", put into those that the lane reader knows."""

from __future__ import annotations

from sgcad_core.reading.language import of_role, rule

_IN_EACH = rule("turn_lanes.in_each")
"""Not "in the lane for left-turning traffic": somebody may wait there."""


def spelled_out(text: str) -> str:
    """Normalized text with its turn lanes in plain words: "a lane for left turns" is a left-turn lane, and of "two
    lanes and a left turn lane in each direction" both are told for each direction."""
    for lane in of_role("lane_for_turns"):
        text = lane.sub(r"\2-turn lane\1", text)
    text = rule("turn_lanes.only").sub(r"\1-turn \2", text)
    return _IN_EACH.sub(r"\1 lanes in each direction with a \2-turn lane in each direction", text)
