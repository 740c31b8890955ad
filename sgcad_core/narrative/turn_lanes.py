"""Turn lanes in other words than "left-turn lane", put into those that the lane reader knows."""

from __future__ import annotations

import re

from sgcad_core.narrative.text import NUMBERS

NUM = rf"(?:\d{{1,2}}|{'|'.join(NUMBERS)}|a single|single)"
_IN_EACH = re.compile(
    rf"\b({NUM})[ -](?:(?:through|travel|traffic)[ -])?lanes? (?:and|plus|with) (?:an?|one) (left|right)[ -]turn[ -]"
    r"lane (?:in|for|on) (?:each|both|either) (?:direction|way|side|approach)s?\b", re.I)  # fmt: skip
_KEPT_FOR = (
    r"(?:(?:which|that) (?:is|was|are|were) )?(?:(?:reserved|designated|dedicated|used|meant|marked|intended|"
    r"set aside) (?:only |solely |exclusively )?|only |solely |exclusively )"
)
_TURNERS = r" (?:traffic|vehicles?|movements?|drivers?)"
_FOR_TURNS = re.compile(
    rf"\b(?:(?:lane|bay|pocket)(?P<s1>s?) {_KEPT_FOR}for (?P<side1>left|right)[ -]turn(?:s|ing)?(?:{_TURNERS})?|"
    rf"(?:bay|pocket)(?P<s2>s?) for (?P<side2>left|right)[ -]turn(?:s|ing)?(?:{_TURNERS})?|"
    r"lane(?P<s3>s?) for (?P<side3>left|right)[ -]turns)\b(?: only\b)?(?! (?:and|or) (?:through|straight|right|left))",
    re.I)  # fmt: skip
"""Not "in the lane for left-turning traffic": somebody may wait there."""
_ONLY = re.compile(r"\b(left|right)[ -]only (lanes?)\b", re.I)


def spelled_out(text: str) -> str:
    """Normalized text with its turn lanes in plain words: "a lane for left turns" is a left-turn lane, and of "two
    lanes and a left turn lane in each direction" both are told for each direction."""
    text = _FOR_TURNS.sub(_plain, text)
    text = _ONLY.sub(r"\1-turn \2", text)
    return _IN_EACH.sub(r"\1 lanes in each direction with a \2-turn lane in each direction", text)


def _plain(match: re.Match[str]) -> str:
    side, many = (next(filter(None, (match[f"{name}{i}"] for i in (1, 2, 3))), "") for name in ("side", "s"))
    return f"{side}-turn lane{many}"
