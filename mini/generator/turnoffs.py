# ruff: noqa: E501 - one clause a line
"""What turning vehicles leave or enter, a street or a driveway: words that suit a crash's roads, and what they tell."""

from __future__ import annotations

import re

from mini.generator.grammar import clauses, tables
from mini.generator.world import Crash

DRIVEWAY = re.compile(
    r"driveway|\bdrive\b(?= of| out|,|$)|private drive|drive-through|parking|\blots?\b|\bstation\b|\bstore\b|shopping"
    r"|\bbusiness\b|restaurant|\bschool\b|church|\bbank\b|\bmarket\b|\bmall\b|motel|apartment|car wash|\balley\b|farm lane",
    re.IGNORECASE,
)
STREET = re.compile(
    r"intersection|(?:side|cross|crossing|intersecting|minor|main) (?:street|road)|\b(?:a|the) (?:street|road) on"
    r"|onto a street|stop (?:sign|line|bar)|\bsignal\b(?! left| right)|\blight\b",
    re.IGNORECASE,
)


def suits(text: str, crash: Crash) -> bool:
    """Whether the words for what one turns into or comes out of may be said of these roads."""
    if crash.layout == "driveway":
        return not STREET.search(text)
    return crash.layout not in ("four", "t") or not DRIVEWAY.search(text)


def tells_driveway(text: str, crash: Crash) -> bool:
    """Whether the words tell that there is a driveway, of a crash that has one."""
    return crash.layout == "driveway" and DRIVEWAY.search(text) is not None


INTO = clauses("""
{V} turned left into a [driveway|parking lot|private drive|gas station|store lot] [in front of|across the path of|into the path of] {W}
{V} [attempted|began|started] [a left turn|to turn left|a left-hand turn] into [a|the] [driveway|parking lot|business driveway][ in front of {W}|]
The driver of {V} [attempted|wanted|tried] to turn left into [a|the] [driveway|gas station|shopping center|restaurant lot|school driveway][ and did not see {W}|]
{V} was turning left into [a|the] [driveway|parking lot|business entrance|private drive] when {W} [approached|came along|arrived]
{V} was [partially|partly|half way] into the driveway when {W} [arrived|came along|reached it]
While turning left into [a|the] [driveway|parking lot|church lot|gas station], {V} [entered|crossed|blocked] the [path|lane] of {W}
As {V} [turned|was turning|made a turn] left into [a|the] [driveway|lot|shopping center], {W} was [going straight|approaching from the opposite direction]
{V} made a left turn [toward|into|to enter] a [driveway|parking lot|business|motel driveway] and [failed to yield|did not yield] to {W}
{V} [crossed|cut across] the {opp} lane[s|] to [enter|reach] a [driveway|parking lot|gas station|private drive][ in front of {W}|]
A left turn into [a|the] [driveway|parking lot|private drive|gas station] was [attempted|started|begun] by {V}[ as {W} approached|]
Intending to enter a [driveway|parking lot|store|market], {V} turned left [in front of|into the path of|ahead of] {W}
{V} turned left [toward|for] the [driveway|parking lot] [of a [store|bank|restaurant|house|church]|on the other side] and {W} was there
The driver of {V}, [going home|on an errand|looking for an address], turned left into a driveway in front of {W}
{V} then [began|proceeded|started] to turn left into [a|the] [driveway|parking lot|lot|business]
{V} waited for a gap and turned left into [a|the] [driveway|parking lot|business]
Turning left into a [driveway|parking lot|mall|car wash], {V} was in the [lane|path] of {W}
"""
)  # fmt: skip
"""A left turn off the road into a driveway; trains only."""

WHY = tables(
    turn_left="waiting to turn left into a [driveway|parking lot|private drive|gas station]|to turn left into [a|the] driveway|to make a left turn into a [business|store|restaurant|shopping center|parking lot]|preparing to turn left into [a|the] [driveway|private drive]|for a left turn into a [driveway|parking lot|school]|in order to turn left into a [driveway|market|bank|church lot]|before turning left into [its|her|his|a] driveway|as it waited to turn left into a [driveway|lot|motel]|intending to turn left into a [driveway|gas station|parking lot|business]|with a driveway on the left to turn into|to enter a [driveway|parking lot|business] on the left",
    turn_right="waiting to turn right into a [driveway|parking lot|private drive|gas station]|to turn right into [a|the] driveway|to make a right turn into a [business|store|restaurant|shopping center|parking lot]|preparing to turn right into [a|the] [driveway|private drive]|for a right turn into a [driveway|parking lot|school]|in order to turn right into a [driveway|market|bank|church lot]|before turning right into [its|her|his|a] driveway|intending to turn right into a [driveway|gas station|parking lot|business]|with a driveway on the right to turn into|to enter a [driveway|parking lot|business] on the right",
)
"""What one stood or slowed for on a road with a driveway; trains only."""
