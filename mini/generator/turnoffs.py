# ruff: noqa: E501 - one clause a line
"""What turning vehicles leave, enter or obey, a street, a driveway, a signal: words that suit a crash's roads."""

from __future__ import annotations

import re

from mini.generator.grammar import clauses, tables
from mini.generator.settled import VAGUE
from mini.generator.world import Actor, Crash

_BUSINESS = (
    r"lot|lots|gas station|station|store|stores|shopping center|business|restaurant|school|church|bank|market|mall|motel"
    r"|apartment complex|car wash|drive-through|alley|farm lane|private drive|drive"
)
DRIVEWAY = re.compile(rf"driveway|parking|shopping|business|\b(?:{_BUSINESS})\b", re.IGNORECASE)
"""Words that may be of a driveway."""
_TOLD = re.compile(
    rf"driveway|private drive|parking lot|\b(?:into|out of|from|left|leaving|enter|exit\w*|reach) (?:a|an|the|its|his|her)"
    rf" (?:\w+ )?(?:{_BUSINESS})\b",
    re.IGNORECASE,
)
STREET = re.compile(
    r"intersection|(?:side|cross|crossing|intersecting|minor|main) (?:street|road)|\b(?:a|the) (?:street|road) on"
    r"|onto a street|stop (?:sign|line|bar)",
    re.IGNORECASE,
)
SIGNAL = re.compile(
    r"\b(?:green|red|yellow|amber|traffic|stop) ?(?:light|signal|arrow)|\b(?:on|against|ran|through|for) (?:a |the )?"
    r"(?:green|red|yellow|light|signal)\b(?! turn)|\b(?:light|signal) (?:changed|turned|favored|cycle|phase)"
    r"|on green\b|on red\b|disregarded the .*signal",
    re.IGNORECASE,
)
STOP = re.compile(r"stop (?:sign|line|bar)", re.IGNORECASE)
SIGN = re.compile(r"stop sign|\bat (?:the|its) sign", re.IGNORECASE)


def suits(text: str, crash: Crash, actor: Actor) -> bool:
    """Whether what the words say of driveways, streets, signs and signals may be said of these roads and of one who
    comes to them."""
    controls, met = {leg.control for leg in crash.legs}, crash.leg(actor.leg)
    if SIGNAL.search(text) and "signal" not in controls:
        return False
    if SIGN.search(text) and (met is None or met.control != "stop"):
        return False
    if crash.layout != "four" and "straight across" in text:
        return False
    if crash.layout == "driveway":
        return not STREET.search(text)
    if crash.layout not in ("four", "t"):
        return True
    return not DRIVEWAY.search(text) and (not STOP.search(text) or bool(controls & {"stop", "flashing", "signal"}))


def told(text: str, crash: Crash) -> set[str]:
    """Facts of the roads that the words tell beside their own: that there is a driveway, a signal or a stop sign."""
    found = {"layout"} if crash.layout == "driveway" and _TOLD.search(text) else set()
    if SIGN.search(text) and any(leg.control == "stop" for leg in crash.legs):
        found |= met("sign", crash)
    return found | (met("light", crash) if SIGNAL.search(text) else set())


def met(key: str, crash: Crash) -> set[str]:
    """Facts that one tells who stands for a "light", or for a "sign", which others may have or not."""
    if key == "sign":
        return {"control", f"{VAGUE}.control"}
    return {"control"} if all(leg.control == "signal" for leg in crash.legs if leg.lanes_in) else set()


INTO = clauses("""
{V} turned left into a [driveway|parking lot|private drive|gas station|store lot] [in front of|across the path of|into the path of] {W}
{V} [attempted|began|started] [a left turn|to turn left|a left-hand turn] into [a|the] [driveway|parking lot|business driveway][ in front of {W}|]
The driver of {V} [attempted|wanted|tried] to turn left into [a|the] [driveway|gas station|shopping center|restaurant lot|school driveway][ and did not see {W}|]
{V} was turning left into [a|the] [driveway|parking lot|business entrance|private drive] when {W} [approached|came along|arrived]
{V} was [partially|partly|half way] into the driveway, turning left, when {W} [arrived|came along|reached it]
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

YIELDS = clauses("""
to allow [several|a few|some|two] {other} [vehicles|cars] to pass before [turning {turn}|making an intended {turn} turn|its {turn} turn]
to let {other} traffic [go by|clear|pass] before [turning {turn}|making its {turn} turn]
for {other} traffic [to clear |]before turning {turn}
as [a line of |several |]{other} [vehicles|cars] [passed|went by] before it could turn {turn}
waiting for {other} [traffic|vehicles|cars] to [pass|clear] [so that it could turn|before turning|in order to turn] {turn}
yielding to {other} [traffic|vehicles|cars] before [turning|a turn to the] {turn}
because {other} traffic [kept|was keeping] it from turning {turn}
until the {other} [vehicles|traffic|cars] had passed, [meaning|intending|in order] to turn {turn}
while {other} traffic [cleared|went past], in order to turn {turn}
to wait for [a gap|a break|an opening] in {other} traffic in order to turn {turn}
"""
)  # fmt: skip
"""What one waits for who is about to turn: traffic of another heading than its own; trains only."""
