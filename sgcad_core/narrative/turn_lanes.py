"""Turn lanes in other words than "left-turn lane", put into those that the lane reader knows."""

from __future__ import annotations

import re

from sgcad_core.narrative.text import NUM

_IN_EACH = re.compile(
    rf"\b({NUM})[ -](?:(?:through|travel|traffic)[ -])?lanes? (?:and|plus|with) (?:an?|one) (left|right)[ -]turn[ -]"
    r"lane (?:in|for|on) (?:each|both|either) (?:direction|way|side|approach)s?\b", re.I)  # fmt: skip
_KEPT_FOR = (
    r"(?:(?:which|that) (?:is|was|are|were) )?(?:(?:reserved|designated|dedicated|used|meant|marked|intended|"
    r"set aside) (?:only |solely |exclusively )?|only |solely |exclusively )"
)
_TURNING = r"for (left|right)[ -]turn(?:s|ing)?(?: (?:traffic|vehicles?|movements?|drivers?))?"
_FOR_TURNS = tuple(
    re.compile(rf"\b{lane}\b(?: only\b)?(?! (?:and|or) (?:through|straight|right|left))", re.I)
    for lane in (
        rf"(?:lane|bay|pocket)(s?) {_KEPT_FOR}{_TURNING}",
        rf"(?:bay|pocket)(s?) {_TURNING}",
        r"lane(s?) for (left|right)[ -]turns",
    )
)
"""Not "in the lane for left-turning traffic": somebody may wait there."""
_ONLY = re.compile(r"\b(left|right)[ -]only (lanes?)\b", re.I)


def spelled_out(text: str) -> str:
    """Normalized text with its turn lanes in plain words: "a lane for left turns" is a left-turn lane, and of "two
    lanes and a left turn lane in each direction" both are told for each direction."""
    for lane in _FOR_TURNS:
        text = lane.sub(r"\2-turn lane\1", text)
    text = _ONLY.sub(r"\1-turn \2", text)
    return _IN_EACH.sub(r"\1 lanes in each direction with a \2-turn lane in each direction", text)
