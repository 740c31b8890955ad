"""What controls a junction, and which of its legs have the stop or yield sign.

Reads resolved sentences. Brake lights, street lights, turn signals and police cars control nothing. Knows no
junction shape.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Literal

from sgcad_core.narrative.clauses import Told
from sgcad_core.narrative.compass import DIRECTION, compass_of, turned
from sgcad_core.narrative.facts import VehicleFacts
from sgcad_core.narrative.mentions import axis_in, axis_of
from sgcad_core.narrative.road_merge import GatheredRoad
from sgcad_core.narrative.roles import CRASH_ROLES
from sgcad_core.specs import Compass

Control = Literal["none", "signal", "flashing", "stop", "all_way_stop", "yield"]

_SIGNAL = re.compile(
    r"\btraffic[ -](?:control[ -])?(?:signal|light)s?\b|\bstop ?lights?\b|\bsignali[sz]ed\b|\bsignal(?:led|"
    r"ed)? intersection|"
    r"\b(?:signal|traffic light|light)[ -]controlled|\b(?:red|green|yellow|amber)(?: \w+){0,2} (?:light|signal|arrow|"
    r"phase)\b(?! lines?)|"
    r"\b(?:the|a|his|her|their|its|control) (?:light|signal) (?:was|is|turned|changed|had|at|ahead|to (?:turn|change))|"
    r"\btri-?light|\bfor (?:the|a) (?:light|signal)\b|"
    r"\b(?:ran|run|running|on|against|had|has|having) (?:the|a) (?:red|green|yellow)\b|\bred (?:light|signal)|"
    r"\bcontrol signals?\b|"
    r"\bsignals? controls?\b|\bpost \w* ?signal|"
    r"\b(?:approach\w*|stop\w* (?:at|for)) (?:the|a) (?:light|signal)\b", re.I)  # fmt: skip
_SIGNAL_OUT = re.compile(
    r"\b(?:signal|light)s?\b[^.;]{0,40}\b(?:not (?:function\w*|work\w*|operat\w*)|inoperative|out of (?:order|"
    r"service)|dark\b)",
    re.I,
)
_NOT_SIGNAL = re.compile(
    r"\b(?:no|without|nor|not (?:any|have)|uncontrolled|were no|was no)\b(?: \w+){0,6}? (?:signals?|lights?|"
    r"controls?|devices?|signs?)\b(?:,? (?:or|and|nor)(?: \w+){0,3} (?:signals?|signs?|lights?|devices?))*|"
    r"\b(?:brake|tail|head|street|turn|dome|overhead|flashing|emergency|artificial|natural|turn) ?-?(?:signal|"
    r"light)s?|\bturn signal\w*|\bday ?light|"
    r"\bsignals? (?:not|absent)|\bunsignali[sz]ed", re.I)  # fmt: skip
_STOP = re.compile(
    r"\bstop[ -]signs?\b|\bstop[ -](?:controlled|sign-controlled)|\ball-way stop|\b(?:four|three|two)-way stop", re.I
)
_ALL_STOP = re.compile(
    r"\b(?:four|4|all|three|3)[ -]way stop|\bstop signs? (?:in|for|on|at) (?:all|each|every)|"
    r"\ball(?: \w+)? (?:directions|approaches|traffic)[^.;]{0,30}stop sign",
    re.I,
)
_YIELD = re.compile(r"\byield(?: right[ -]of[ -]way)? signs?\b", re.I)
_FLASHING = re.compile(
    r"\b(?:flashing|blinking)(?: \w+){0,3} (?:lights?|signals?|beacons?|yellow|red|amber)|\b(?:flashing|"
    r"blinking) (?:red|yellow|amber)|\bbeacon\b",
    re.I,
)
_NOT_CONTROL = re.compile(
    r"\b(?:no|without|not|were no|lack\w*|absence)\b[^.;,]{0,40}?(?:stop signs?|signs?|yield)", re.I
)
_CONSTRUCTION = re.compile(
    r"\bconstruction|\bwork zone|\bflag(?:ger|man)|school bus\b.{0,40}flashing|police (?:car|vehicle)|"
    r"overhead lights",
    re.I,
)


def control_of(told: Sequence[Told]) -> Control:
    """Signal, stop, yield or flashing: the crash's sentences first, then what drivers said."""
    said = [t for t in told if t.role not in ("codes", "factors")]
    for story in (True, False):
        texts = [t.text for t in said if (t.role in CRASH_ROLES or t.role == "other") == story]
        bare = [_NOT_CONTROL.sub(" ", _NOT_SIGNAL.sub(" ", text)) for text in texts]
        found = _first_control(texts, bare)
        if found != "none":
            return found
    return "none"


def _first_control(texts: Sequence[str], bare: Sequence[str]) -> Control:
    out = any(_SIGNAL_OUT.search(text) for text in texts)
    if any(_ALL_STOP.search(text) for text in bare):
        return "all_way_stop"
    if any(_FLASHING.search(text) and not _CONSTRUCTION.search(text) for text in texts):
        return "flashing"
    if not out and any(_SIGNAL.search(text) and not _CONSTRUCTION.search(text) for text in bare):
        return "signal"
    if any(_STOP.search(text) and not _CONSTRUCTION.search(text) for text in bare):
        return "stop"
    return "yield" if any(_YIELD.search(text) for text in bare) else "none"


def controlled(story: Sequence[Told]) -> bool:
    """Whether a signal or stop sign of a junction stands in the story."""
    for t in story:
        text = _NOT_CONTROL.sub(" ", _NOT_SIGNAL.sub(" ", t.text))
        if (_SIGNAL.search(text) or _STOP.search(text)) and not _CONSTRUCTION.search(text):
            return True
    return False


# ------------------------------------------------------------------ which legs
_SIGN = re.compile(r"\bstop[ -]signs?|\byield signs?|\bstop[ -]controlled|\bflashing red", re.I)
_WAY = re.compile(rf"\b(?P<way>(?:{DIRECTION})(?:bound)?)\b", re.I)
_FOR = re.compile(
    rf"^(?:[\w ]{{0,30}}?\b(?:for|on|facing|in|regulating|controlling|"
    rf"controls?)\b)(?P<whom>[^.;]{{0,40}}?\b(?:{DIRECTION})(?:bound)?\b"
    rf"(?:(?:[ ,/]|and|or|the)*(?:{DIRECTION})(?:bound)?\b)*)", re.I)  # fmt: skip
_SUBJECT = re.compile(
    rf"\b(?P<whom>(?:{DIRECTION})(?:bound)?(?:(?:[ ,/-]|and|or)*(?:{DIRECTION})(?:bound)?)?)\b"
    r"(?=[^.;]{0,90}$)(?! (?:lanes? )?of (?:a|an|the)\b)", re.I)  # fmt: skip
_SIDE_ROAD = re.compile(
    r"\b(?:side|intersecting|minor|secondary|crossing|cross|one[ -]way|terminating|"
    r"residential)[ -](?:\w+ )?(?:street|road\w*|traffic)",
    re.I,
)


def signed_legs(
    told: Sequence[Told], vehicles: Sequence[VehicleFacts], roads: Sequence[GatheredRoad], four_leg: bool
) -> tuple[Compass, ...]:
    """Bearings of the legs under a stop or yield sign: one axis, both its ends where the road crosses."""
    votes: Counter[Compass] = Counter()
    for t in told:
        if t.role not in ("codes", "factors"):
            weight = 6 if t.role in CRASH_ROLES else 2
            for legs in _signed(t, vehicles, roads):
                for leg in legs:
                    votes[leg] += weight // len(legs)
    if not votes:
        return ()
    axes: Counter[Compass] = Counter()
    for leg, count in votes.items():
        axes[axis_of(leg)] += count
    axis = max(axes, key=lambda a: axes[a])
    return (axis, turned(axis, 180)) if four_leg else tuple(leg for leg in votes if axis_of(leg) == axis)


def _signed(told: Told, vehicles: Sequence[VehicleFacts], roads: Sequence[GatheredRoad]) -> Iterator[list[Compass]]:
    text = _NOT_CONTROL.sub(" ", told.text)
    last = 0
    for sign in _SIGN.finditer(text):
        before, behind = text[last : sign.start()], text[sign.end() :]
        yield _legs_of_sign(before, behind, told, vehicles, roads)
        last = sign.end()


def _legs_of_sign(
    before: str, behind: str, told: Told, vehicles: Sequence[VehicleFacts], roads: Sequence[GatheredRoad]
) -> list[Compass]:
    """ "stop sign for northbound traffic", else the vehicle or direction named last before the sign."""
    whom = _FOR.match(behind)
    if whom:
        return _legs_of_words(whom["whom"])
    clause = re.split(r"[;:]|\b(?:while|however|but)\b", before)[-1]
    owner = [m for v in vehicles for m in re.finditer(rf"\b{v.id}\b", clause)]
    subjects = list(_SUBJECT.finditer(clause))
    if subjects and told.role != "opening" and (not owner or _only_direction(clause, subjects[-1])):
        return _legs_of_words(subjects[-1]["whom"])
    if _SIDE_ROAD.search(clause):
        cross = [r.axis for r in roads if r.cross and r.axis]
        return [leg for axis in cross[:1] for leg in (axis, turned(axis, 180))]
    named = owner[-1].group() if owner else told.subject
    return [turned(v.heading, 180) for v in vehicles if v.id == named and v.heading]


def _only_direction(clause: str, subject: re.Match[str]) -> bool:
    """ "the northbound road was controlled by a": a road, not the vehicle's own motion."""
    return bool(_ROAD_HAS.match(clause[subject.end() :]))


_ROAD_HAS = re.compile(
    r"[ -](?:\w+ )?(?:road\w*|street|approach|traffic|entrance|lanes?)\b(?! of)[^.;]*"
    r"\b(?:control|regulat|had|has|with|by)",
    re.I)  # fmt: skip


def _legs_of_words(words: str) -> list[Compass]:
    axis = axis_in(words)
    if axis:
        return [axis, turned(axis, 180)]
    return [turned(way, 180) for m in _WAY.finditer(words) if (way := compass_of(m["way"]))]
