"""Maneuver cues of a vehicle: turned, meant to turn, stopped, moved on, drifted, changed lanes, backed.

Each cue is a word found in one segment, with its weight; `sgcad_core.reading.motion.maneuvers` decides.
"""

from __future__ import annotations

import re
from typing import NamedTuple

from sgcad_core.reading.language import Rule, of_role, rule
from sgcad_core.reading.motion.heading_lane_cues import way_told
from sgcad_core.reading.motion.motion_record import ManeuverCue, VehicleMotion
from sgcad_core.reading.text.compass import between, compass_of, turned

_TURNING = rule("deeds.turning")
_LATER = rule("deeds.later")
_NOT = rule("deeds.not")
_HOPED = ("overtaking", "lane_change", "lane_change_left", "lane_change_right", "merge")
"""What a vehicle may wait or prepare to do and never does."""
_SIDES = ("side", "side2", "side3", "side4", "side5", "side6", "side7", "side8")
_FROM = ("fromside", "wayside", "streetside", "roadside", "nearside")
_TURNS = ("turn_left", "turn_right")
_BY_ANGLE = {90: "right", 135: "right", 225: "left", 270: "left"}
"""The hand of a turn by its change of heading, clockwise degrees."""
_ONWARD = ("straight", "moved_on", "came_on", "backing", "leaving_parking")
"""Ways of moving that are no maneuver of their own, and may be waited for."""
_BEFORE = ("came_on", "moved_on")
"""What may be told behind what it came before: "stopped after passing the crosswalk"."""


class _Segment(NamedTuple):
    """A segment of one vehicle: its text, weight, sentence, and where in the sentence it begins."""

    motion: VehicleMotion
    text: str
    weight: int
    number: int
    at: int

    def add(self, kind: str, m: re.Match[str], rule_id: str) -> None:
        """Add a cue to the vehicle's motion."""
        self.motion.cues.append(ManeuverCue(kind, self.weight, self.number, m.group(), rule_id, self.at + m.end()))

    def before(self, m: re.Match[str]) -> str:
        """The last characters before a match."""
        return self.text[max(0, m.start() - 60) : m.start()]


def read_maneuver_cues(motion: VehicleMotion, text: str, weight: int, number: int, at: int = 0) -> None:
    """Add what one segment tells; `at`: where in its sentence it begins."""
    segment = _Segment(motion, text, weight, number, at)
    for m in _TURNING.finditer(text):
        told = next((k for k in _SIDES if m.groupdict().get(k)), None)
        side = m[told].lower() if told else "left"
        before = segment.before(m)
        if (
            _NOT.search(before)
            or rule("deeds.evasive").search(text[: m.start()])
            or rule("deeds.steering").search(before)
            or rule("deeds.turned_aside").match(text[m.end() :])
            or (not motion.ordered and rule("deeds.turned_then").match(text[m.end() :]))
        ):
            continue
        led = before + text[m.start() : m.start(told) if told else m.start()]
        begun = rule("deeds.try").search(before[-14:]) or rule("deeds.begins").search(led)
        later = rule("deeds.not_yet_begun").search(before) or (_LATER.search(before) and not begun)
        later = later or (motion.ordered and rule("deeds.stands_turning").search(before))
        segment.add(("want_" if later else "") + f"turn_{side}", m, _TURNING.id)
    _read_turn_to(segment)
    told_now = of_role("deed_now") if motion.ordered else ()
    for cue in (*of_role("deed"), *told_now):
        for m in cue.finditer(text):
            before = segment.before(m)
            undone = motion.ordered and _undone(cue.yields["deed"], before, m.group())
            if not _NOT.search(before[-30:]) and not undone:
                _note_cue(segment, cue, m)
    if motion.ordered:
        _read_turn_on(segment)
        _read_from_onto(segment)


def _undone(kind: str, before: str, words: str) -> bool:
    """Whether the words before a cue make it a hope, a plan, an earlier act, or an act of people on foot."""
    if kind in _HOPED and any(
        hoped.search(before) for hoped in (_LATER, rule("deeds.meant"), rule("deeds.stands_turning"))
    ):
        return not (rule("deeds.done").match(words) or rule("deeds.begins").search(before))
    if kind in _BEFORE and rule("deeds.earlier").search(before):
        return True
    unmoved = rule("deeds.unmoved").search(before) or rule("deeds.by_people").search(before)
    return kind in _ONWARD and bool(unmoved or rule("deeds.not_yet").search(before + words))


def _read_turn_on(segment: _Segment) -> None:
    """A turn that goes on, to the hand to which the vehicle was told to turn or to mean to turn."""
    for m in rule("deeds.turn_on").finditer(segment.text):
        sides = [d.kind.removeprefix("want_") for d in segment.motion.cues if d.kind.removeprefix("want_") in _TURNS]
        before = segment.before(m)
        if sides and not _NOT.search(before) and not _LATER.search(before):
            segment.add(sides[-1], m, "deeds.turn_on")


def _read_from_onto(segment: _Segment) -> None:
    """ "From westbound Elm Street onto southbound Oak Avenue": a turn by its two directions, where no word tells it."""
    for m in rule("deeds.from_onto").finditer(segment.text):
        start, end = compass_of(m["from"]), compass_of(m["onto"])
        side = _BY_ANGLE.get(between(start, end)) if start and end else None
        told = any(d.number == segment.number and d.kind.endswith(f"turn_{side}") for d in segment.motion.cues)
        stands = any(d.kind == "stopped" and d.number == segment.number for d in segment.motion.cues)
        if side and not told:
            segment.add(f"{'want_' if stands else ''}turn_{side}", m, "deeds.from_onto")


def _read_turn_to(segment: _Segment) -> None:
    """Turns that no other word tells: "turned toward the north" of an eastbound vehicle, "wanted to go left"."""
    motion, text = segment.motion, segment.text
    if any(d.number == segment.number and d.kind.removeprefix("want_") in _TURNS for d in motion.cues):
        return
    for told in (rule("deeds.turn_to"), rule("deeds.meant_way")):
        for m in told.finditer(text):
            start = motion.headings[0].value if motion.headings else None
            end = compass_of(way_told(m))
            side = _BY_ANGLE.get(between(start, end)) if start and end else None
            if side and not _NOT.search(text[: m.start()]):
                meant = told.id == "deeds.meant_way" or _LATER.search(text[: m.start()])
                segment.add(f"{'want_' if meant else ''}turn_{side}", m, told.id)
    for m in rule("deeds.go_turn").finditer(text):
        want = "want_" if m["go"].lower() == "go" else ""
        if not _NOT.search(text[: m.start()]):
            segment.add(f"{want}turn_{m['hand'].lower()}", m, "deeds.go_turn")


def _note_cue(segment: _Segment, cue: Rule, m: re.Match[str]) -> None:
    kind, motion = cue.yields["deed"], segment.motion
    if kind == "from_side":
        told = next(m[side] for side in _FROM if m[side])
        motion.from_side = "left" if told.lower() == "left" else "right"
    elif kind == "into_lane":
        entered = compass_of(m.group("bound"))
        own = motion.headings[0].value if motion.headings else None
        motion.entered = motion.entered or (entered if entered != own else None)
        if entered and own and turned(entered, 180) == own:
            segment.add("crossing_centerline", m, cue.id)
    else:
        segment.add(kind, m, cue.id)
