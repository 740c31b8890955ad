"""Which way a vehicle was heading, and to where it turned. Compass words only; knows no road."""

from __future__ import annotations

import re

from sgcad_core.kinds import ALLEY, CHANGES, DRIVEWAY, RAMP
from sgcad_core.reading.actors.vehicles import MENTION, Roster
from sgcad_core.reading.language import of_role, rule, values
from sgcad_core.reading.motion.motion_record import Access, VehicleMotion
from sgcad_core.reading.roads.lanes import MOST_ONE_WAY
from sgcad_core.reading.text.compass import between, compass_of, turned
from sgcad_core.reading.text.normalise import NUMBERS
from sgcad_core.records.specs import Compass

_FROM = rule("headings.from")
_CAME_WAY = rule("headings.came_way")
_EXIT = rule("headings.exit")
_TURN_BEFORE = rule("headings.turn_before")
_TURNING_WAY = rule("deeds.turn_to")
TURNING_WAY = _TURNING_WAY.id
"""The rule of turns of an untold hand."""
_TURNS = (rule("headings.turned_to"), rule("headings.turned_onto"), rule("headings.turned_for"), _TURNING_WAY)
TURNS_TO = tuple(turn.id for turn in _TURNS)
"""Rules of turns whose way at the end is plainly told."""
_WAYS = ("dir", "dir2", "dir3", "dir4", "onto", "onto2")
"""Groups of the way in alternatives of a rule."""


def read_heading(motion: VehicleMotion, text: str, weight: int) -> None:
    """Adds the headings and exits of a segment."""
    for turn in _TURNS:
        for m in turn.finditer(text):
            _note_exit(motion, way_told(m), turn.id)
    text = rule("headings.turned_to").sub(lambda m: " " * len(m[0]), text)
    told = [(m, by) for by in (rule("headings.heading"), rule("headings.heading_bare")) for m in by.finditer(text)]
    for m, by in sorted(told, key=lambda found: found[0].start()):
        words = m.groupdict()
        gap = words.get("gap") or words.get("gap2") or ""
        faces = rule("headings.facing").search(m.group()) and not MENTION.search(gap.upper())
        if (faces or not rule("headings.gap_stops").search(gap)) and not _TURN_BEFORE.search(text[: m.start()]):
            _note_heading(motion, way_told(m), weight, by.id)
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
        rule("headings.on_bound"),
        rule("headings.in_bound_lane"),
    ):
        for m in by.finditer(text):
            _note_heading(motion, m.group("dir"), weight, by.id)
    for m in _FROM.finditer(text):
        _note_origin(motion, text, m, weight, _FROM.id)
    for m in rule("headings.from_to").finditer(text):
        if _turns_between(text, m):
            _note_heading(motion, m["dir"], weight + 1, "headings.from_to")
        else:
            _note_origin(motion, text, m, weight, "headings.from_to")
    for m in _EXIT.finditer(text):
        _note_exit(motion, m["dir"], _EXIT.id)


def way_told(m: re.Match[str]) -> str:
    """The word for the way in a match of a rule with alternatives; "" for none."""
    return next(filter(None, map(m.groupdict().get, _WAYS)), "")


def _note_exit(motion: VehicleMotion, word: str, by: str) -> None:
    heading = compass_of(word)
    if heading and heading not in motion.exits:
        motion.exits.append(heading)
        motion.read(f"exit {heading}", word, by)


def _turns_between(text: str, told: re.Match[str]) -> bool:
    """Whether "from north to west" names two headings: a turn from one to the other is told behind it."""
    turn = rule("headings.turn_behind").match(text[told.end() :])
    start, end = compass_of(told["dir"]), compass_of(told["dir2"])
    return bool(turn and start and end and between(start, end) == {"left": 270, "right": 90}[turn["hand"].lower()])


def _note_origin(motion: VehicleMotion, text: str, told: re.Match[str], weight: int, by: str) -> None:
    """Notes the heading of a vehicle that comes from a side, behind a verb of coming or first in the text."""
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
        many = _MANY.get((m["many"] or m["number"] or m["many3"] or "").lower(), len(found))
        for motion in found.values() if many == len(found) else ():
            _note_heading(motion, m["dir"] or m["dir2"] or m["dir3"], weight, "headings.bound_all")


def _note_heading(motion: VehicleMotion, word: str, weight: int, by: str) -> None:
    heading = compass_of(word)
    if heading:
        motion.add_value(motion.headings, weight, heading, word, by)


# ------------------------------------------------------------------ relation to the other vehicle


def read_relations(motion: VehicleMotion, text: str, weight: int, vehicle: str, roster: Roster) -> None:
    """Adds the directions relative to the other vehicle: same, opposite, crossing."""
    for told in of_role("kin"):
        relation, word = told.yields["kin"], told.yields.get("word", "")
        for m in told.finditer(text):
            named = rule("surroundings.named").match(text[m.end() :])
            stranger = rule("surroundings.stranger").match(text[m.end() :])
            other = named.group(1).upper() if named else None
            if other in roster.bystanders:
                continue
            if other not in roster.ids or other == vehicle:
                other = None
            if relation != "same" or not word or other or not stranger:
                met = other or roster.other(vehicle)
                motion.relations.append((weight, relation, met, word))
                motion.read(f"{relation} {met}", m[0], told.id)


# ------------------------------------------------------------------ lane, access
_LANE = rule("surroundings.lane")


def read_lane(motion: VehicleMotion, text: str, from_median: bool = False) -> None:
    """Sets the first told lane, by number or by word; `from_median`: "the number 1 lane" is the leftmost one."""
    if motion.lane or motion.lane_word:
        return
    for m in _LANE.finditer(text):
        if rule("surroundings.other_lane").search(text[: m.start()]) and not rule("surroundings.in_lane").search(
            text[: m.start()]
        ):
            continue
        if rule("surroundings.lane_of_passed").search(text[: m.start()]):
            continue
        if m.group("turn") and rule("surroundings.lane_of_road").search(text[: m.start()]):
            continue
        center = _center_lane(text, m)
        if center is not None and not rule("surroundings.in_lane").search(text[: center.start()]):
            continue  # of the road: "a five-lane road with a center turn lane"
        motion.lane = _counted(m, from_median)
        if motion.lane is None:
            motion.lane_word = "center_turn" if center else _lane_word(m)
        elif m.group("use"):
            motion.lane_word = f"{m.group('use').lower()}_turn"
        motion.read("lane", m.group(), _LANE.id)
        return


def read_lane_change(motion: VehicleMotion, text: str, from_median: bool = False) -> None:
    """Sets the first told lane that a change of lanes leads into, by number or by word; turn lanes are none."""
    for m in _LANE.finditer(text) if motion.to_lane is None else ():
        if not m.group("turn") and rule("surroundings.into_lane").search(text[: m.start()]):
            counted = _counted(m, from_median)
            if counted is not None and abs(counted) > MOST_ONE_WAY:
                continue
            motion.to_lane = _lane_word(m) if counted is None else counted
            motion.read("to_lane", m.group(), _LANE.id)
            return


def _counted(m: re.Match[str], from_median: bool) -> int | None:
    """The number of a lane, from the right curb, or from the left if negative; None where a word tells it."""
    number, nth = m.group("n") or m.group("num"), m.group("nth") or m.group("nth2")
    if nth:
        counted = int(values("ordinal").get(nth.lower(), 2))
        return counted if (m.group("from") or m.group("from2")).lower() == "right" else -counted
    if number:
        told = NUMBERS.get(number.lower()) or (int(number) if number.isdigit() else None)
        return -told if from_median and m.group("num") and told else told
    if m.group("use"):  # the lanes for turns to a hand are the outermost ones on that hand
        many = NUMBERS.get(m.group("of").lower()) or (int(m.group("of")) if m.group("of").isdigit() else 1)
        place = 1 if m.group("end").lower() == m.group("use").lower() else many
        return place if m.group("use").lower() == "right" else -place
    if m.group("beside") or m.group("curb"):
        return -1 if (m.group("beside") or "").lower() == "left" else 1
    if m.group("inner"):
        return -1
    return int(values("ordinal")[m.group("ord").lower()]) if m.group("ord") else None


_LEFT_WORDS = ("far left", "left-most", "leftmost", "left", "inside", "passing", "inner")


def _center_lane(text: str, m: re.Match[str]) -> re.Match[str] | None:
    """The words of a two-way left-turn lane of which those of a lane are part."""
    found = rule("lanes.center_turn").finditer(text)
    return next((c for c in found if c.start() < m.end() and m.start() < c.end()), None)


def _lane_word(m: re.Match[str]) -> str:
    """left, right, middle, left_turn or right_turn; of a two-way left-turn lane `_center_lane` knows."""
    word = (m.group("word") or m.group("place")).lower()
    if m.group("turn") and word in ("left", "right", "center"):
        return "left_turn" if word != "right" else "right_turn"
    if word in ("middle", "center"):
        return "middle"
    return "left" if word in _LEFT_WORDS else "right"


_FROM_RIGHT = {"right_turn": 0, "right": 1, "middle": 10, "left": 20, "left_turn": 21, "center_turn": 22}
"""Places of lanes by their words, from the right curb; those that are counted from the left lie before the leftmost."""


def read_straddle(motion: VehicleMotion, text: str, from_median: bool = False) -> None:
    """Sets the hand on which the other one of its two lanes lies of a vehicle that stands over a line: away from its
    own lane, or the way in which it changed lanes."""
    told = rule("surroundings.straddles").search(text)
    if told is None or motion.straddles:
        return
    lanes = [m for name in ("one", "two") if (m := _LANE.search(told[name]))]
    places = [_place_across(_counted(m, from_median), m) for m in lanes]
    own = _place_across(motion.lane, motion.lane_word) if motion.lane or motion.lane_word else None
    hands = {cue.kind.removeprefix("lane_change_") for cue in motion.cues if cue.kind in CHANGES}
    if len(places) == 2 and own in places and places[0] != places[1]:
        other = next(place for place in places if place != own)
        motion.straddles = "left" if other > own else "right"
    elif len(hands) == 1:
        motion.straddles = "left" if hands == {"left"} else "right"
    if motion.straddles:
        motion.read("straddles", told[0], "surroundings.straddles")


def _place_across(number: int | None, word: re.Match[str] | str | None) -> int:
    """Where a lane lies across its direction, from the right curb."""
    if number is not None:
        return number if number > 0 else _FROM_RIGHT["left"] + 1 + number
    name = word if isinstance(word, str) else _lane_word(word) if word is not None else "right"
    return _FROM_RIGHT[name]


_ORIGIN = rule("surroundings.origin")
_TARGET = rule("surroundings.target")
_ON_DRIVE = rule("surroundings.on_drive")
_OUT_OF_ALLEY = rule("surroundings.out_of_alley")
_RAMP = rule("surroundings.ramp")
_SHOULDER = rule("surroundings.shoulder")


def read_origin_and_target(motion: VehicleMotion, text: str, after: bool = False) -> None:
    """Sets the driveway, lot, ramp or shoulder that the vehicle came from or turned into.

    Behind the impact (`after`) a shoulder that it goes to is no origin.
    """
    if after:
        text = rule("surroundings.pulled_over").sub(" ", text)
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
