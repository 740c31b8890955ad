"""What a vehicle did: turned, meant to turn, stopped, moved on, drifted, changed lanes, backed.

Each deed is a word found in one segment, with its weight; `sgcad_core.narrative.maneuvers` decides.
"""

from __future__ import annotations

import re

from sgcad_core.narrative.compass import DIRECTION, compass_of, turned
from sgcad_core.narrative.motion import Deed, Motion

_SIDE = r"(?P<side>left|right)"
_WANT = (
    r"(?:intend\w*|wait\w*|want\w*|plan\w*|prepar\w*|about|ready|signal\w*|going|allow\w*|due|order|looking|"
    r"need\w*|blinker|gap)"
)
_TURN = (rf"(?:turn(?:ed|ing|s)?(?: to(?:wards?)?)?(?: (?:the|her|his|its))? {_SIDE}\b(?! lane)|"
         rf"(?:a|an|its|his|her|their|the|initiated|intended|illegal|sharp|"
         rf"wide) (?:\w+ )?{_SIDE.replace('side', 'side2')}[ -](?:hand )?turn(?! lane|-lane|ing| only| signal|"
         rf" arrow| bay)|"
         rf"{_SIDE.replace('side', 'side3')} turn (?:across|in front|onto|into|at)|"
         rf"(?:a|attempting|attempted|making) {_SIDE.replace('side', 'side4')} (?:onto|into|at|on|from|in|when|"
         rf"and|to)\b|"
         rf"{_SIDE.replace('side', 'side5')}[ -]turn(?:ing)?(?= (?:vehicle|maneuver)))")  # fmt: skip
_TURNING = re.compile(_TURN, re.I)
_LATER = re.compile(
    rf"\b{_WANT}\b(?:\W+[\w'-]+){{0,6}}?\W*$|\b(?:before|prior to|until)\b(?:\W+[\w'-]+){{0,3}}\W*$", re.I
)
_TRY = re.compile(
    r"\b(?:attempt\w*|began|begin\w*|start\w*|initiat\w*|tried|trying|proceed\w*|was making|made|"
    r"making|commenc\w*)\b",
    re.I,
)
_EVASIVE = re.compile(
    r"\b(?:depress\w+|brak(?:ed|es|ing)|swerv\w+|evasive|in an (?:attempt|effort) to avoid)\b(?! "
    r"for)",
    re.I,
)
_NOT = re.compile(
    r"\b(?:not|never|without|instead of|rather than|no)\b(?:\W+(?!and\b|but\b|then\b)[\w'-]+){0,3}\W*$", re.I
)

_DEEDS: tuple[tuple[str, str], ...] = (
    ("parked", r"\bparked\b(?! (?:cars?|vehicles?|van|truck|trailer|tractor|along|on (?:both|either)))|"
               r"\b(?:was|were|is) (?:legally )?parked along\b|legally parked|unoccupied|\bdisabled\b"),
    ("stopped", r"\b(?:was|were|is|been|sat|sitting|being|and|had|already|came to an?|com(?:e|es|ing) to an?|"
                r"made an?|initially|the) "
                r"(?:\w+ )?(?:stop(?:ped)?|stationary|standing|stand still)\b(?! (?:sign|at (?:a|"
                r"the) stop sign and)|ping)|^,? ?stopped|"
                r"\b(?:waiting|waited) (?:for|to|at|in|behind)|\bat a (?:complete )?stop(?! sign)|\bat a stand ?still|"
                r"(?<!a )(?<!the )(?<!other )(?<!any )\bstopped\b(?! (?:to avoid|vehicles?|cars?|bus|trucks?|vans?|"
                r"traffic|school))|\bstopped in\b|"
                r"\bsitting (?:at|in|still)\b|\bidling\b|\bstalled\b"),
    ("slowing", r"\b(?:slow(?:ed|ing|s)|decelerat\w+|slowed down|braking for|reduc\w+ speed)\b"),
    ("moved_on", r"\b(?:proceeded|entered|pulled (?:out|into|onto|away|forward|from)|started (?:to|across|"
                 r"through|into|moving|forward)|"
                 r"accelerat(?:ed|ing)|crossed|went (?:through|into|straight)|began (?:to|his|her|their|its)|"
                 r"drove (?:into|through)|initiat\w+ (?:a|the|its|his|her|their) (?:\w+ )?turn|"
                 r"moved (?:forward|into)|continued|attempted to (?:cross|enter|proceed)|entering|"
                 r"(?<!the )(?<!a )crossing|proceeding|pulling (?:out|into|onto)|"
                 r"traversing|inched|edged|started|exited|exiting|ran (?:the|a|through))\b"),
    ("straight", r"\b(?:going|continu\w+|proceed\w*|travel\w*|went|intending (?:on|to) (?:going|continuing|go|"
                 r"continue|travel\w*)) "
                 r"(?:straight|through)\b|\bgo straight|straight through\b"),
    ("u_turn", r"\bu-turn"),
    ("crossing_centerline", r"\b(?:cross(?:ed|ing|es)?|over|went|drift(?:ed|ing|s)|veer(?:ed|ing)|skidd(?:ed|"
                            r"ing)|slid|drove|swerv\w+|encroach\w*|travel\w*|came|mov\w+) "
                            r"(?:[\w'-]+ ){0,6}?(?:(?:over|across|past|left of) )?(?:the |its |"
                            r"a )?(?:\w+ )?(?:double )?(?:solid )?(?:yellow )?"
                            r"(?:center ?lines?|center dividing line|(?:yellow |lane |solid )+lines?|center turn lane|"
                            r"center of the road\w*|painted median|"
                            r"grass median|median|dividing line)\b|"
                            r"\b(?:into|in|entered|entering|facing) (?:the )?(?:path of )?(?:oncoming|opposing|"
                            r"opposite)(?: \w+)? (?:lane|traffic|travel)|"
                            r"\bleft of center\b|\bwrong (?:side|way)\b|\b(?:over|across) the left (?:lane )?line"),
    ("into_lane", rf"\b(?:drift\w*|veer\w*|skidd?\w*|slid|spun|went|cross\w*|enter\w*|swerv\w*|steer\w*|rotat\w*|"
                  rf"slid\w*) (?:[\w'-]+ ){{0,10}}?"
                  rf"(?:in(?:to)?) (?:the )?(?:\w+ )?(?P<bound>(?:{DIRECTION})bound) (?:\w+ )?(?:lanes?|traffic|"
                  rf"roadway)"),
    ("into_lane", rf"\b(?:travel\w*|driv\w*|going|head\w*) (?:{DIRECTION})(?:bound)?\b[^.;,]{{0,25}}? in the "
                  rf"(?:\w+ )?(?P<bound>(?:{DIRECTION})bound) (?:\w+ )?lanes?"),
    ("lane_change_left", r"\bchang\w+ (?:\w+ )?lanes? (?:(?!left|right)\w+ ){0,6}left|"
                         r"\blane change (?:to the |into the )?left|"
                         r"(?:moved?|moving|merged?|steered|swerved) (?:\w+ ){0,3}(?:in)?to the left(?:-|"
                         r" )?(?:hand )?(?:through |travel )?lane|"
                         r"\bleft lane change|\b(?:mov|chang)\w+ from the right lane (?:in)?to the left\b"),
    ("lane_change_right", r"\bchang\w+ (?:\w+ )?lanes? (?:(?!left|right)\w+ ){0,6}right|\blane change (?:to the |"
                          r"into the )?right|(?:moved?|moving|merged?|steered|"
                          r"swerved) (?:\w+ ){0,3}(?:in)?to the right(?:-| )?(?:hand )?(?:through |travel )?lane|"
                          r"\bright lane change|\b(?:mov|chang)\w+ from the left lane (?:in)?to the right\b"),
    ("lane_change", r"\bchang(?:ed|ing) lanes?\b|\blane change\b|\bswitch\w+ lanes?\b"),
    ("overtaking", r"\b(?:pass(?:ed|ing)?(?! by\b)|overtak\w+|overtook|go around|went around|"
                   r"going around) (?:\w+ ){0,3}?(?:v\d+|vehicles?|(?:a|the|another|slower|"
                   r"stopped)\b.{0,20}(?:car|truck|vehicle|van|bus|tractor))|"
                   r"(?<!vehicle )(?<!vehicles )(?<!traffic )(?<!cars )\bto pass\b|\bpassing maneuver|"
                   r"\b(?:attempt\w*|began|trying|tried) to overtake\b"),
    ("merge", r"\bmerg(?:e|ed|ing|es)\b"),
    ("negotiating_curve", r"\b(?:negotiat\w+|round(?:ed|ing)|through|exit(?:ed|ing)|enter(?:ed|ing)|on|in|"
                          r"around) (?:a|the|an) (?:[\w-]+ ){0,3}?(?:curve|bend)\b|\bnegotiating\b"),
    ("departing_road_right", r"\b(?:off|departed|left|leaving|exited|"
                             r"ran off) (?:of )?(?:the )?(?:\w+ )?(?:right (?:side|edge|shoulder|road\w* edge|"
                             r"roadside)|road\w* (?:on|to) the right)"),
    ("departing_road_left", r"\b(?:off|departed|left|leaving|exited|"
                            r"ran off) (?:of )?(?:the )?(?:\w+ )?(?:left (?:side|edge|shoulder|road\w* edge|"
                            r"roadside)|road\w* (?:on|to) the left)"),
    ("departing_road_right", r"\b(?:drift|steer|veer|swerv|slid|pull)\w* (?:to the )?right\b[^.;]{0,30}\b(?:departed|"
                             r"left|exited|(?:ran|went|drove) off) (?:of )?the (?:road\w*|pavement|highway|street)\b"),
    ("departing_road_left", r"\b(?:drift|steer|veer|swerv|slid|pull)\w* (?:to the )?left\b[^.;]{0,30}\b(?:departed|"
                            r"left|exited|(?:ran|went|drove) off) (?:of )?the (?:road\w*|pavement|highway|street)\b"),
    ("lost_control", r"\b(?:los[et]|losing) control\b|\bhydroplan\w+|\bfishtail\w*|\bskidd?(?:ed|ing)\b|\bslid\b|"
                     r"\byaw\b"),
    ("backing", r"(?<!traffic )(?<!traffic had )(?<!traffic was )(?<!vehicles )"
                r"\b(?:backing|backed|revers(?:ed|ing)|in reverse)\b(?! up traffic)"),
    ("leaving_parking", r"\bpull(?:ed|ing) (?:out|away) (?:of|from) (?:a |the |its |his |"
                        r"her )?(?:parking (?:space|spot|position)|curb)|leaving (?:a )?park"),
    ("from_side", r"\b(?:approach\w*|com\w+|enter\w*|emerg\w*|pull\w*|cross\w*|"
                  r"travel\w*) (?:\w+ ){0,4}?from (?:v\d+'s |the |his |her |its )(?P<fromside>left|right)\b"),
)  # fmt: skip
_DEED_PATTERNS = tuple((kind, re.compile(pattern, re.I)) for kind, pattern in _DEEDS)


def read_deeds(motion: Motion, text: str, weight: int, number: int) -> None:
    for m in _TURNING.finditer(text):
        side = next(
            filter(None, (m.groupdict().get(k) for k in ("side", "side2", "side3", "side4", "side5"))), "left"
        ).lower()
        before = text[max(0, m.start() - 60) : m.start()]
        if (
            _NOT.search(before)
            or _EVASIVE.search(text[: m.start()])
            or re.search(r"\b(?:steer|swerv|wheel|look|head|veer)\w*\W+(?:\w+\W+)?$", before)
        ):
            continue
        later = _LATER.search(before) and not _TRY.search(before[-14:])
        motion.deeds.append(Deed(("want_" if later else "") + f"turn_{side}", weight, number, m.group()))
    for kind, pattern in _DEED_PATTERNS:
        for m in pattern.finditer(text):
            if not _NOT.search(text[max(0, m.start() - 30) : m.start()]):
                _note_deed(motion, kind, m, weight, number)


def _note_deed(motion: Motion, kind: str, m: re.Match[str], weight: int, number: int) -> None:
    if kind == "from_side":
        motion.from_side = "left" if m.group("fromside").lower() == "left" else "right"
    elif kind == "into_lane":
        entered = compass_of(m.group("bound"))
        own = motion.headings[0][1] if motion.headings else None
        if entered and own and turned(entered, 180) == own:
            motion.deeds.append(Deed("crossing_centerline", weight, number, m.group()))
    else:
        motion.deeds.append(Deed(kind, weight, number, m.group()))
