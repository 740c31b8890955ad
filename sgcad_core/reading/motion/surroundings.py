"""What stands around a vehicle in its own sentences: the other vehicle, its lane, driveways and ramps."""

from __future__ import annotations

import re

from sgcad_core.kinds import ALLEY, DRIVEWAY, RAMP
from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.language import of_role, rule, values
from sgcad_core.reading.motion.motion_record import Access, VehicleMotion
from sgcad_core.reading.text.normalise import NUMBERS

# ------------------------------------------------------------------ relation to the other vehicle


def read_relations(motion: VehicleMotion, text: str, weight: int, vehicle: str, roster: Roster) -> None:
    for told in of_role("kin"):
        relation, word = told.yields["kin"], told.yields.get("word", "")
        for m in told.finditer(text):
            named = rule("surroundings.named").match(text[m.end() :])
            stranger = rule("surroundings.stranger").match(text[m.end() :])
            other = named.group(1).upper() if named else None
            if other not in roster.ids or other == vehicle:
                other = None
            if relation != "same" or not word or other or not stranger:
                motion.relations.append((weight, relation, other or roster.other(vehicle), word))


# ------------------------------------------------------------------ lane, access
_LANE = rule("surroundings.lane")


def read_lane(motion: VehicleMotion, text: str) -> None:
    if motion.lane or motion.lane_word:
        return
    for m in _LANE.finditer(text):
        if rule("surroundings.other_lane").search(text[: m.start()]) and not rule("surroundings.in_lane").search(
            text[: m.start()]
        ):
            continue
        number = m.group("n") or m.group("num")
        nth = m.group("nth") or m.group("nth2")
        if nth:
            counted = values("ordinal").get(nth.lower(), 2)
            motion.lane = counted if (m.group("from") or m.group("from2")).lower() == "right" else -counted
        elif number:
            motion.lane = NUMBERS.get(number.lower()) or (int(number) if number.isdigit() else None)
        elif m.group("beside") or m.group("curb"):
            motion.lane = -1 if (m.group("beside") or "").lower() == "left" else 1
        elif m.group("inner"):
            motion.lane = -1
        elif m.group("ord"):
            motion.lane = values("ordinal")[m.group("ord").lower()]
        else:
            motion.lane_word = _lane_word(m)
        motion.read("lane", m.group(), _LANE.id)
        return


def _lane_word(m: re.Match[str]) -> str:
    """left, right, middle, left_turn or right_turn."""
    word = m.group("word").lower()
    if m.group("turn") and word in ("left", "right", "center"):
        return "left_turn" if word != "right" else "right_turn"
    if word in ("middle", "center"):
        return "middle"
    return "left" if word in ("far left", "left-most", "leftmost", "left", "inside", "passing", "inner") else "right"


_ORIGIN = rule("surroundings.origin")
_TARGET = rule("surroundings.target")
_ON_DRIVE = rule("surroundings.on_drive")
_OUT_OF_ALLEY = rule("surroundings.out_of_alley")
_RAMP = rule("surroundings.ramp")
_SHOULDER = rule("surroundings.shoulder")


def read_origin_and_target(motion: VehicleMotion, text: str) -> None:
    origin = _ORIGIN.search(text)
    if motion.origin is None and (found := _came_from(text, origin)):
        motion.origin, words, by = found
        motion.read("origin", words, by)
    target = next((m for m in _TARGET.finditer(text) if rule("surroundings.turning_in").search(text[: m.end()])), None)
    if target and motion.target is None and not (origin and origin.start() < target.start() <= origin.end()):
        motion.target = _place(target.group("place"))
        motion.read("target", target.group("place"), _TARGET.id)


def _came_from(text: str, origin: re.Match[str] | None) -> tuple[Access, str, str] | None:
    """Where a vehicle came from, the words that tell it, and by which rule."""
    if origin:
        return _place(origin.group("place")), origin.group("place"), _ORIGIN.id
    if alley := _OUT_OF_ALLEY.search(text):
        return ALLEY, alley.group(), _OUT_OF_ALLEY.id
    drive, ramp, shoulder = (pattern.search(text) for pattern in (_ON_DRIVE, _RAMP, _SHOULDER))
    if drive and not rule("surroundings.approaching_driveway").search(text):
        return DRIVEWAY, drive.group(), _ON_DRIVE.id
    if ramp:
        return RAMP, ramp.group(), _RAMP.id
    return ("shoulder", shoulder.group(), _SHOULDER.id) if shoulder else None


def _place(word: str) -> Access:
    if rule("surroundings.alley").search(word):
        return ALLEY
    return DRIVEWAY if rule("surroundings.driveway").search(word) else "parking_lot"
