"""What controls a junction, and which of its legs have the stop or yield sign.

Reads resolved sentences. Brake lights, street lights, turn signals and police cars control nothing. Knows no
junction shape.
"""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Literal

from sgcad_core.reading.crash_facts import VehicleFacts
from sgcad_core.reading.language import Rule, rule
from sgcad_core.reading.motion.clauses import Statement
from sgcad_core.reading.motion.motion_record import Source
from sgcad_core.reading.roads.road_mentions import axis_in, axis_of
from sgcad_core.reading.roads.road_merge import MergedRoad
from sgcad_core.reading.roads.street_names import StreetNames, street_names
from sgcad_core.reading.text.compass import compass_of, turned
from sgcad_core.reading.text.sentence_roles import CRASH_ROLES, STORY_ROLES
from sgcad_core.records.specs import Compass

Control = Literal["none", "signal", "flashing", "stop", "all_way_stop", "yield"]
_SIGNAL = rule("control.signal")
_NOT_SIGNAL = rule("control.not_signal")
_STOP = rule("control.stop")
_YIELD = rule("control.yield")
_NOT_CONTROL = rule("control.not_control")
_CONSTRUCTION = rule("control.construction")
_ALL_STOP, _FLASHING = rule("control.all_stop"), rule("control.flashing")
_CONTROLS: tuple[tuple[Control, Rule], ...] = (
    ("all_way_stop", _ALL_STOP), ("flashing", _FLASHING), ("signal", _SIGNAL), ("stop", _STOP), ("yield", _YIELD),
)  # fmt: skip
"""The first that any sentence tells stands."""
_ANYWHERE = ("all_way_stop", "yield")
"""Told of no works zone and no police car."""


def control_of(statements: Sequence[Statement]) -> tuple[Control, Source | None]:
    """Signal, stop, yield or flashing, and where it is told: the crash's sentences first, then what drivers said."""
    said = [t for t in statements if t.role not in ("codes", "factors")]
    for story in (True, False):
        found = _first_control([t for t in said if (t.role in STORY_ROLES) == story])
        if found:
            return found
    return "none", None


def _first_control(said: Sequence[Statement]) -> tuple[Control, Source] | None:
    out = any(rule("control.signal_out").search(t.text) for t in said)
    bare = [t._replace(text=_NOT_CONTROL.sub(" ", _NOT_SIGNAL.sub(" ", t.text))) for t in said]
    for control, by in _CONTROLS:
        if control == "signal" and out:
            continue
        for t in said if control == "flashing" else bare:
            match = by.search(t.text)
            if match and (control in _ANYWHERE or not _CONSTRUCTION.search(t.text)):
                return control, Source(t.number, match[0], by.id)
    return None


def controlled(story: Sequence[Statement]) -> bool:
    """Whether a signal, stop or yield sign of a junction stands in the story."""
    for t in story:
        text = _NOT_CONTROL.sub(" ", _NOT_SIGNAL.sub(" ", t.text))
        if any(one.search(text) for one in (_SIGNAL, _STOP, _YIELD)) and not _CONSTRUCTION.search(text):
            return True
    return False


# ------------------------------------------------------------------ which legs
_WAY = rule("control.way")
_SIDE_ROAD = rule("control.side_road")
_NEAR = 40
"""Characters behind a sign in which a direction may be told."""


def signed_legs(
    statements: Sequence[Statement], vehicles: Sequence[VehicleFacts], roads: Sequence[MergedRoad], four_leg: bool
) -> tuple[Compass, ...]:
    """Bearings of the legs under a stop or yield sign: one axis, both its ends where the road crosses."""
    names = street_names(statements, {v.id: v.heading for v in vehicles if v.heading})
    votes: Counter[Compass] = Counter()
    for t in statements:
        if t.role not in ("codes", "factors"):
            weight = 6 if t.role in CRASH_ROLES else 2
            for legs in _signed(t, vehicles, roads, names):
                for leg in legs:
                    votes[leg] += weight // len(legs)
    if not votes:
        return ()
    axes: Counter[Compass] = Counter()
    for leg, count in votes.items():
        axes[axis_of(leg)] += count
    axis = max(axes, key=lambda a: axes[a])
    return (axis, turned(axis, 180)) if four_leg else tuple(leg for leg in votes if axis_of(leg) == axis)


def _signed(
    statement: Statement, vehicles: Sequence[VehicleFacts], roads: Sequence[MergedRoad], names: StreetNames
) -> Iterator[list[Compass]]:
    text = _NOT_CONTROL.sub(" ", statement.text)
    last = 0
    for sign in rule("control.sign").finditer(text):
        before, behind = text[last : sign.start()], text[sign.end() :]
        axis = _street_of_sign(before, sign.group() + behind, sign.end() - sign.start(), names)
        yield [axis, turned(axis, 180)] if axis else _legs_of_sign(before, behind, statement, vehicles, roads)
        last = sign.end()


def _street_of_sign(before: str, behind: str, sign: int, names: StreetNames) -> Compass | None:
    """The axis of the street that is told by its name to have a sign; `behind` begins with the sign's own words."""
    if _WAY.search(behind[sign : sign + _NEAR]):
        return None
    first = next(iter(names.in_text(behind)), None)
    if first is not None and rule("control.signed_street").match(behind[sign : first.start]):
        return names.axes.get(first.name)
    for one in reversed(list(names.in_text(before))):
        if rule("control.street_has").fullmatch(before[one.end :]):
            return names.axes.get(one.name)
    return None


def _legs_of_sign(
    before: str, behind: str, statement: Statement, vehicles: Sequence[VehicleFacts], roads: Sequence[MergedRoad]
) -> list[Compass]:
    """ "stop sign for northbound traffic", "on the side street", else the vehicle or road named last."""
    whom = rule("control.for").match(behind)
    if whom:
        return _legs_of_words(whom[0])
    if rule("control.on_side_road").match(behind):
        across = [] if _SIDE_ROAD.search(before) else _crossing_legs(before, statement, vehicles)
        return across or _side_legs(roads)
    clause = rule("control.contrast").split(before)[-1]
    owner = [m for v in vehicles for m in rule("common.named_vehicle").given(vehicle=v.id).finditer(clause)]
    subjects = list(rule("control.subject").finditer(clause))
    if subjects and statement.role != "opening" and (not owner or _only_direction(clause, subjects[-1])):
        return _legs_of_words(subjects[-1]["whom"])
    if _SIDE_ROAD.search(clause):
        return _side_legs(roads)
    named = owner[-1].group() if owner else statement.subject
    return [turned(v.heading, 180) for v in vehicles if v.id == named and v.heading]


def _side_legs(roads: Sequence[MergedRoad]) -> list[Compass]:
    """Both legs of the road that is told to cross."""
    cross = [r.axis for r in roads if r.cross and r.axis]
    return [leg for axis in cross[:1] for leg in (axis, turned(axis, 180))]


def _crossing_legs(before: str, statement: Statement, vehicles: Sequence[VehicleFacts]) -> list[Compass]:
    """Legs of vehicles that cross the path of the named vehicle: the side street is not its own."""
    named = [v.id for v in vehicles if rule("common.named_vehicle").given(vehicle=v.id).search(before)]
    whose = named or [statement.subject or ""]
    own = {axis_of(v.heading) for v in vehicles if v.heading and v.id in whose}
    return [turned(v.heading, 180) for v in vehicles if v.heading and own and axis_of(v.heading) not in own]


def _only_direction(clause: str, subject: re.Match[str]) -> bool:
    """ "the northbound road was controlled by a": a road, not the vehicle's own motion."""
    return bool(rule("control.road_has").match(clause[subject.end() :]))


def _legs_of_words(words: str) -> list[Compass]:
    axis = axis_in(words)
    if axis:
        return [axis, turned(axis, 180)]
    if leg := rule("control.leg").search(words):
        return [way for m in _WAY.finditer(leg["from"] or leg["noun"]) if (way := compass_of(m["way"]))]
    return [turned(way, 180) for m in _WAY.finditer(words) if (way := compass_of(m["way"]))]
