"""Whether a report tells that somebody lost control: skidded, slid, spun or could not hold the road.

One answer for the whole text: who it was is often left to the reader.
"""

from __future__ import annotations

from sgcad_core.language import rule

_LOST = rule("meeting.lost")


def tells_lost_control(narrative: str) -> bool:
    """Whether somebody did not drive in the ordinary way."""
    return bool(_LOST.search(narrative))
