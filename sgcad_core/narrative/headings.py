"""Which way a vehicle was heading, and to where it turned. Compass words only; knows no road."""

from __future__ import annotations

import re

from sgcad_core.narrative.compass import DIRECTION, compass_of, turned
from sgcad_core.narrative.motion import Motion

_DIR = rf"(?P<dir>(?:{DIRECTION})(?:bound|erly)?)\b(?!\s*/|-?(?:{DIRECTION})\b)"
_NOT_PLACE = (
    r"(?!\s+(?:traffic|vehicles?|of|traveled|by)\b)"
    r"(?:(?<=bound)|(?!\s+(?:side|corner|shoulder|leg|curb|edge|end|street|avenue|ave|portion|part|half|quadrant|"
    r"border|roadside|"
    r"approach|lawn|embankment|main|county|road side|ditch)\b))"
)
_GO = (
    r"travel\w*|head(?:ed|ing)|proceed\w*|driv(?:ing|es|en)|drove|going|went|moving|facing|stopped|parked|"
    r"stationary|"
    r"continu\w+|start\w*|approach\w*|slow\w*|waiting|sitting|standing|stop|halted|disabled|oriented|pointed|"
    r"positioned|"
    r"negotiating|accelerating|decelerating|idling|passing|coasting|stalled|enroute|cruising|braking|riding|"
    r"pulling|towing|backing"
)
_BOUND = rf"(?:{DIRECTION})bound"
_HEADING = re.compile(
    rf"(?<!to )\b(?:{_GO})\b(?P<gap>(?:[\s,-]+(?!{DIRECTION})[\w'#./%-]+){{0,14}}?)[\s,]+{_DIR}{_NOT_PLACE}",
    re.I)  # fmt: skip
_HEADING_BARE = re.compile(
    rf"(?:^|\b(?:was|were|is|are|"
    rf"been)\b)(?P<gap>(?:[\s,-]+(?!{DIRECTION})[\w'#./%-]+){{0,5}}?)[\s,]*(?P<dir>{_BOUND})\b(?!\s*/|-)"
    rf"{_NOT_PLACE}|\b(?:was|were|is|are)(?P<gap2> (?:also )?)(?P<dir2>{DIRECTION})\b(?!\s*/|-){_NOT_PLACE}",
    re.I)  # fmt: skip
_GAP_STOPS = re.compile(
    r"\b(?:into|onto|toward|towards|off(?! ?-?ramp)|turn\w*|across|cross\w*|enter\w*|exit\w*|to (?:go|travel|head|"
    r"proceed|"
    r"the|continue|allow)|"
    r"from the|allow\w*|for an?|another|several|pass\w* (?:in|a|the|two|several)|and (?:a|an|the|another)|v\d+|"
    r"behind an?|unknown|"
    r"non-?contact|oncoming|opposing|because|due to|while (?:a|the)|that (?:ran|runs|intersects)|with (?:the|a|"
    r"an)|where|"
    r"intersect\w*|via|against|gap)\b", re.I)  # fmt: skip
_FROM = re.compile(rf"\b(?:from|out of) (?:the )?(?:(?:\w+ ){{0,4}}(?:to|on|"
                   rf"of) the )?(?P<dir>{DIRECTION})(?:ern)?\b(?!bound|erly|/|\s*-\s*(?:{DIRECTION}))"
                   rf"(?!\s+(?:side of the (?:crash|median)|lane|roadway lane|to\b))", re.I)  # fmt: skip
_BOUND_ASIDE = re.compile(rf",\s*(?P<dir>(?:{DIRECTION})bound)(?=\s*(?:[.,;]|$))", re.I)
_FOLLOWING = re.compile(rf"\bfollow\w+ v\d+ (?P<dir>(?:{DIRECTION})(?:bound)?)\b", re.I)
_FROM_BOUND = re.compile(rf"\bfrom (?:the |a )?(?:\w+ ){{0,3}}?(?P<dir>(?:{DIRECTION})bound)\b", re.I)
_EXIT = re.compile(
    rf"(?:\b(?:turn\w*|onto|into|go|travel|head|proceed|continue)\b)(?:[\s,]+(?!{DIRECTION})[\w'-]+){{0,8}}?[\s,]+"
    rf"(?P<dir>(?:{DIRECTION})(?:bound|erly)?)\b(?!\s*/|-)", re.I)  # fmt: skip
_TURN_BEFORE = re.compile(
    r"\b(?:turned|turning|turns|made a|making a|makes a|began a|u-turn|completed|after (?:\w+ )?turn\w*|"
    r"pulled out|backed|"
    r"spun|rotated|crossed (?:over|the|into)|entered|lost control)\b", re.I)  # fmt: skip


def read_heading(motion: Motion, text: str, weight: int) -> None:
    for m in sorted([*_HEADING.finditer(text), *_HEADING_BARE.finditer(text)], key=lambda m: m.start()):
        words = m.groupdict()
        gap = words.get("gap") or words.get("gap2") or ""
        if not _GAP_STOPS.search(gap) and not _TURN_BEFORE.search(text[: m.start()]):
            _note_heading(motion, words.get("dir") or words.get("dir2") or "", weight)
    for m in (*_FROM_BOUND.finditer(text), *_BOUND_ASIDE.finditer(text), *_FOLLOWING.finditer(text)):
        _note_heading(motion, m.group("dir"), weight)
    for m in _FROM.finditer(text):
        came = compass_of(m.group("dir"))
        if came and re.search(
            r"\b(?:approach|enter|travel|com|cross|turn|pull|drov|proceed|merg|exit)\w*", text[: m.start()]
        ):
            motion.heard(motion.headings, max(1, weight - 1), turned(came, 180), m.group("dir"))
    for m in _EXIT.finditer(text):
        heading = compass_of(m.group("dir"))
        if heading:
            motion.exits.append(heading)
            motion.read(f"exit {heading}", m.group("dir"))


_BOUND_VEHICLE = re.compile(
    rf"\b(?P<dir>(?:{DIRECTION})bound) (?P<v>V\d+)\b|\b(?P<v2>V\d+) "
    rf"\((?P<dir2>(?:{DIRECTION})bound)\)",
    re.I,
)


def note_bound(found: dict[str, Motion], text: str, weight: int) -> None:
    """ "the northbound V2" tells a heading wherever it stands."""
    for m in _BOUND_VEHICLE.finditer(text):
        vehicle = m["v"] or m["v2"]
        if vehicle in found:
            _note_heading(found[vehicle], m["dir"] or m["dir2"], weight)


def _note_heading(motion: Motion, word: str, weight: int) -> None:
    heading = compass_of(word)
    if heading:
        motion.heard(motion.headings, weight, heading, word)
