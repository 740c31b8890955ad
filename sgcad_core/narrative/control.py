"""What controls a junction, and which of its legs have the stop or yield sign.

Reads resolved sentences. Brake lights, street lights, turn signals and police cars control nothing. Knows no
junction shape.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Literal

from sgcad_core.language import rule
from sgcad_core.narrative.clauses import Told
from sgcad_core.narrative.compass import compass_of, turned
from sgcad_core.narrative.facts import VehicleFacts
from sgcad_core.narrative.mentions import axis_in, axis_of
from sgcad_core.narrative.road_merge import GatheredRoad
from sgcad_core.narrative.roles import CRASH_ROLES
from sgcad_core.specs import Compass

Control = Literal["none", "signal", "flashing", "stop", "all_way_stop", "yield"]

_SIGNAL = rule("control.signal")
_SIGNAL_OUT = rule("control.signal_out")
_NOT_SIGNAL = rule("control.not_signal")
_STOP = rule("control.stop")
_ALL_STOP = rule("control.all_stop")
_YIELD = rule("control.yield")
_FLASHING = rule("control.flashing")
_NOT_CONTROL = rule("control.not_control")
_CONSTRUCTION = rule("control.construction")


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
_SIGN = rule("control.sign")
_WAY = rule("control.way")
_FOR = rule("control.for")
_SUBJECT = rule("control.subject")
_SIDE_ROAD = rule("control.side_road")


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
    clause = rule("control.contrast").split(before)[-1]
    owner = [m for v in vehicles for m in rule("common.named_vehicle").given(vehicle=v.id).finditer(clause)]
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


_ROAD_HAS = rule("control.road_has")


def _legs_of_words(words: str) -> list[Compass]:
    axis = axis_in(words)
    if axis:
        return [axis, turned(axis, 180)]
    return [turned(way, 180) for m in _WAY.finditer(words) if (way := compass_of(m["way"]))]
