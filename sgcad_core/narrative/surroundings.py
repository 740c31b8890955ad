"""What stands around a vehicle in its own sentences: the other vehicle, its lane and speed, driveways and ramps."""

from __future__ import annotations

import re

from sgcad_core.narrative.motion import Access, Kin, Motion
from sgcad_core.narrative.text import NUMBERS
from sgcad_core.narrative.vehicles import Roster

# ------------------------------------------------------------------ relation to the other vehicle
_KIN: tuple[tuple[Kin, str, str], ...] = (
    ("same", "behind", r"\b(?:directly |slightly |immediately |close )?behind\b(?! the (?:wheel|crash))|"
                       r"\bin back of|\bfollowing\b|\bfollowed\b|\bto the rear of\b|\brear of\b"),
    ("same", "ahead", r"\bahead of\b|\b(?:stopped|was|were|directly|traveling|slowed|slowing|parked|braked|"
                      r"lane) (?:\w+ )?in front of"),
    ("same", "", r"\bsame direction|\b(?:next to|alongside|beside|adjacent to)\b"),
    ("same", "passing", r"\b(?:pass|passing|overtake|overtaking)\b (?=v\d)"),
    ("opposite", "", r"\b(?:opposite direction|opposing direction|oncoming(?! traffic)|head-on)\b"),
    ("crossing", "", r"\b(?:on|of|from) (?:the |an? )?(?:intersecting|intersection|cross(?:ing)?|side|"
                     r"perpendicular|other|adjoining) (?:road\w*|street|traffic)"),
)  # fmt: skip
_KIN_PATTERNS = tuple((kin, word, re.compile(pattern, re.I)) for kin, word, pattern in _KIN)


def read_kin(motion: Motion, text: str, weight: int, vehicle: str, who: Roster) -> None:
    for kin, word, pattern in _KIN_PATTERNS:
        for m in pattern.finditer(text):
            named = re.match(r"[\s\w,-]{0,24}?\b(v\d+)\b", text[m.end() :])
            stranger = re.match(
                r"\s+(?:of )?(?:an?|the|another|some|several|two|traffic)\s+(?!same|other)\w+", text[m.end() :]
            )
            other = named.group(1).upper() if named else None
            if other not in who.ids or other == vehicle:
                other = None
            if kin != "same" or not word or other or not stranger:
                motion.kin.append((weight, kin, other or who.other(vehicle), word))


# ------------------------------------------------------------------ lane, speed, access
_ORDINAL = {"first": 1, "1st": 1, "second": 2, "2nd": 2, "third": 3, "3rd": 3, "fourth": 4, "4th": 4,
            "fifth": 5, "5th": 5, "sixth": 6, "6th": 6}  # fmt: skip
_LANE = re.compile(
    r"\blane (?:number |no\.? ?|# ?)?(?P<n>\d|one|two|three|four|five)\b|"
    r"(?:\bnumber |\bno\.? ?|# ?)(?P<num>\d|one|two|three|four|five) lane\b|"
    rf"\b(?P<ord>{'|'.join(_ORDINAL)}) (?:[\w-]+ ){{0,2}}?lane|"
    r"\b(?P<word>far right|far left|right-most|left-most|rightmost|leftmost|right|left|middle|center|curb|inside|"
    r"outside|passing|driving|inner|outer)"
    r"(?P<turn>[ -]turn(?:ing)?(?: only)?)?[ -](?:\(?(?:hand|most|through|travel|thru|only|eastbound|westbound|"
    r"northbound|southbound|of)\)? ?-?)*lane\b(?! line)", re.I)  # fmt: skip
_LANE_STOPS = re.compile(
    r"\b(?:in)?to (?:the )?$|\bonto (?:the )?$|\bfrom (?:the )?$|\bv\d+|\bcross\w*|\btwo|"
    r"\bone |\bedge|\bof the $",
    re.I,
)


def read_lane(motion: Motion, text: str) -> None:
    if motion.lane or motion.lane_word:
        return
    for m in _LANE.finditer(text):
        if re.search(
            r"\b(?:in|into|to|onto|from|toward|cross\w*|enter\w*|over|across|of)\W+(?:the )?$", text[: m.start()]
        ) and not re.search(r"\bin\W+(?:the )?(?:[\w-]+ )?$", text[: m.start()]):
            continue
        number = m.group("n") or m.group("num")
        if number:
            motion.lane = NUMBERS.get(number.lower()) or (int(number) if number.isdigit() else None)
        elif m.group("ord"):
            motion.lane = _ORDINAL[m.group("ord").lower()]
        else:
            motion.lane_word = _lane_word(m)
        motion.read("lane", m.group())
        return


def _lane_word(m: re.Match[str]) -> str:
    """left, right, middle, left_turn or right_turn."""
    word = m.group("word").lower()
    if m.group("turn") and word in ("left", "right", "center"):
        return "left_turn" if word != "right" else "right_turn"
    if word in ("middle", "center"):
        return "middle"
    return "left" if word in ("far left", "left-most", "leftmost", "left", "inside", "passing", "inner") else "right"


_SPEED = re.compile(
    r"(?<!limit of )(?<!limit )(?<!\d)(?P<a>\d{1,3})(?:\s*(?:-|to|and)\s*(?P<b>\d{1,3}))?\s*mph\b", re.I)  # fmt: skip
_KMPH = re.compile(r"(?<!\d)(?P<a>\d{1,3})(?:\s*(?:-|to|and)\s*(?P<b>\d{1,3}))?\s*kmph\b", re.I)
_LIMIT = re.compile(r"\b(?:limit|posted|advisory|suggested|zone|lose|delta)\b", re.I)


def read_speed(motion: Motion, text: str, weight: int) -> None:
    if _LIMIT.search(text):
        return
    for pattern, factor in ((_SPEED, 1.0), (_KMPH, 0.621)):
        m = pattern.search(text)
        if m:
            low, high = float(m.group("a")), float(m.group("b") or m.group("a"))
            motion.heard(motion.speeds_mph, weight, round(min(120.0, (low + high) / 2 * factor)), m.group())
            return


_LOT = (r"(?:gas|service|filling) station|parking (?:lot|area|garage)|shopping (?:center|mall|plaza)|mall|plaza|"
        r"store|restaurant|school|church|deli|"
        r"business\w*|market|bank|car ?wash|apartment\w*|hospital|complex|lot|driveways?|"
        r"(?<!trauma )(?<!medical )center|alley\w*|"
        r"private (?:road|drive|residence)|"
        r"residence|house|entranceway|entrance(?! ramp)|strip mall|hotel|motel|facility|garage|drugstore|"
        r"pharmacy|station|daycare|donut shop|fast food\w*")  # fmt: skip
_ORIGIN = re.compile(
    rf"\b(?:exit(?:ed|ing|s)?|leaving|left(?= (?:the|an?|his|her|their|its)\b)|"
    rf"pull(?:ed|ing)?(?: out)?(?: of| from)|out of|from|coming down|"
    rf"departing|emerg\w+ from)\b "
    rf"(?:of |from )?(?:an? |the |its |his |her |their )?(?:[\w'-]+ ){{0,4}}?(?P<place>{_LOT})\b", re.I)  # fmt: skip
_TARGET = re.compile(
    rf"\b(?:into|enter(?:ing|ed)?|to|onto|in)\b (?:an? |the |its |his |"
    rf"her |their )?(?:[\w'-]+ ){{0,4}}?(?P<place>{_LOT})\b", re.I)  # fmt: skip
_ON_DRIVE = re.compile(
    r"\b(?:on|in|down|stopped at|at|end of) (?:an? |the |its |his |"
    r"her |their )?(?:[\w'-]+ ){0,3}?driveway\b",
    re.I,
)
_RAMP = re.compile(
    r"\bon (?:an? |the )?(?:[\w'-]+,? ){0,5}?ramp\b|"
    r"\b(?:negotiat\w+|curve of|along|down|up|descending) (?:an? |the |this )(?:[\w'-]+,? ){0,4}?ramp\b|"
    r"\b(?:exiting|from|off) (?:an? |"
    r"the )?(?:[\w'-]+ ){0,3}?ramp\b",
    re.I,
)
_SHOULDER = re.compile(
    r"\b(?:on|from) (?:an? |the )?(?:[\w'-]+ ){0,2}?shoulder\b|\boff the (?:right|"
    r"left) side of the road",
    re.I,
)


def read_access(motion: Motion, text: str) -> None:
    origin = _ORIGIN.search(text)
    if motion.origin is None and (found := _came_from(text, origin)):
        motion.origin = found[0]
        motion.read("origin", found[1])
    target = next((m for m in _TARGET.finditer(text) if re.search(r"\bturn|pull|enter|cross", text[: m.end()])), None)
    if target and motion.target is None and not (origin and origin.start() < target.start() <= origin.end()):
        motion.target = _place(target.group("place"))
        motion.read("target", target.group("place"))


def _came_from(text: str, origin: re.Match[str] | None) -> tuple[Access, str] | None:
    """Where a vehicle came from, and the words that tell it."""
    if origin:
        return _place(origin.group("place")), origin.group("place")
    drive, ramp, shoulder = (pattern.search(text) for pattern in (_ON_DRIVE, _RAMP, _SHOULDER))
    if drive and not re.search(r"\bapproach\w*\W+(?:\w+ )?driveway", text):
        return "driveway", drive.group()
    if ramp:
        return "ramp", ramp.group()
    return ("shoulder", shoulder.group()) if shoulder else None


def _place(word: str) -> Access:
    return "driveway" if re.search(r"driv|alley|residence|house|private", word, re.I) else "parking_lot"
