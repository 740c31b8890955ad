"""Which way a vehicle was heading, and to where it turned. Compass words only; knows no road."""

from __future__ import annotations

import re

from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.motion_record import VehicleMotion
from sgcad_core.reading.text.compass import compass_of, turned
from sgcad_core.reading.text.normalise import NUMBERS
from sgcad_core.records.specs import Compass

_FROM = rule("headings.from")
_CAME_WAY = rule("headings.came_way")
_EXIT = rule("headings.exit")
_TURN_BEFORE = rule("headings.turn_before")
_WAYS = ("dir", "dir2", "dir3", "dir4")
"""Groups of the way in alternatives of a rule."""


def read_heading(motion: VehicleMotion, text: str, weight: int) -> None:
    told = [(m, by) for by in (rule("headings.heading"), rule("headings.heading_bare")) for m in by.finditer(text)]
    for m, by in sorted(told, key=lambda found: found[0].start()):
        words = m.groupdict()
        gap = words.get("gap") or words.get("gap2") or ""
        if not rule("headings.gap_stops").search(gap) and not _TURN_BEFORE.search(text[: m.start()]):
            _note_heading(motion, next(filter(None, map(words.get, _WAYS)), ""), weight, by.id)
            if way := compass_of(words.get("dir") or ""):
                _note_sense(motion, m, way)
    for m in _CAME_WAY.finditer(text):
        if not _TURN_BEFORE.search(text[: m.start()]) and not rule("headings.came_way_not").search(text[: m.start()]):
            _note_heading(motion, m.group("dir"), weight, _CAME_WAY.id)
    for by in (
        rule("headings.from_bound"),
        rule("headings.bound_aside"),
        rule("headings.following"),
        rule("headings.on_course"),
    ):
        for m in by.finditer(text):
            _note_heading(motion, m.group("dir"), weight, by.id)
    for m in _FROM.finditer(text):
        _note_origin(motion, text, m, weight, _FROM.id)
    for m in rule("headings.from_to").finditer(text):
        _note_origin(motion, text, m, weight, "headings.from_to")
    for m in _EXIT.finditer(text):
        heading = compass_of(m.group("dir"))
        if heading:
            motion.exits.append(heading)
            motion.read(f"exit {heading}", m.group("dir"), _EXIT.id)


def _note_origin(motion: VehicleMotion, text: str, told: re.Match[str], weight: int, by: str) -> None:
    """Note the way of who comes from a side, where a verb of coming stands before it or nothing does."""
    came = compass_of(told["dir"])
    if came and (not text[: told.start()].strip() or rule("headings.came").search(text[: told.start()])):
        motion.add_value(motion.headings, max(1, weight - 1), turned(came, 180), told["dir"], by)


def _note_sense(motion: VehicleMotion, told: re.Match[str], way: Compass) -> None:
    """Note that a vehicle is told to face that way, or to go there backward."""
    for sense, words in (("faces", rule("headings.facing")), ("backs", rule("headings.tail_first"))):
        if words.search(told.group()):
            motion.read(f"{sense} {way}", told["dir"], words.id)


_MANY = {"both": 2} | NUMBERS
_BOUND_VEHICLE = rule("headings.bound_vehicle")


def note_headings_of_mentions(found: dict[str, VehicleMotion], text: str, weight: int) -> None:
    """ "the northbound V2" tells a heading wherever it stands."""
    for m in _BOUND_VEHICLE.finditer(text):
        vehicle = m["v"] or m["v2"] or m["v3"]
        if vehicle in found:
            _note_heading(found[vehicle], m["dir"] or m["dir2"] or m["dir3"], weight, _BOUND_VEHICLE.id)
    for m in rule("headings.bound_all").finditer(text):
        many = _MANY.get((m["many"] or m["number"] or "").lower(), len(found))
        for motion in found.values() if many == len(found) else ():
            _note_heading(motion, m["dir"] or m["dir2"], weight, "headings.bound_all")


def _note_heading(motion: VehicleMotion, word: str, weight: int, by: str) -> None:
    heading = compass_of(word)
    if heading:
        motion.add_value(motion.headings, weight, heading, word, by)
