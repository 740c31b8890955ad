"""Turn lanes in other words than "left-turn lane", put into those that the lane reader knows."""

from __future__ import annotations

import re

from sgcad_core.narrative.text import NUMBERS

_NUM = rf"(?:\d{{1,2}}|{'|'.join(NUMBERS)}|a single|single)"
_IN_EACH = re.compile(
    rf"\b({_NUM})[ -](?:(?:through|travel|traffic)[ -])?lanes? (?:and|plus|with) (?:an?|one) (left|right)[ -]turn[ -]"
    r"lane (?:in|for|on) (?:each|both|either) (?:direction|way|side|approach)s?\b", re.I)  # fmt: skip
_FOR_TURNS = re.compile(
    r"\b(?:lane|bay|pocket)(s?) (?:(?:(?:which|that) (?:is|was|are|were) )?"
    r"(?:reserved|designated|dedicated|used|meant|marked|intended|set aside) )?(?:only |solely |exclusively )?"
    r"for (left|right)[ -]turn(?:s|ing)?(?: (?:traffic|vehicles?|movements?|drivers?))?(?: only)?\b", re.I)  # fmt: skip
_ONLY = re.compile(r"\b(left|right)[ -]only (lanes?)\b", re.I)


def spelled_out(text: str) -> str:
    """Normalized text with its turn lanes in plain words: "a lane for left turns" is a left-turn lane, and of "two
    lanes and a left turn lane in each direction" both are told for each direction."""
    text = _FOR_TURNS.sub(r"\2-turn lane\1", text)
    text = _ONLY.sub(r"\1-turn \2", text)
    return _IN_EACH.sub(r"\1 lanes in each direction with a \2-turn lane in each direction", text)
