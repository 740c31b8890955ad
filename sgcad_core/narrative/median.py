"""Whether a road is said to be divided, and by what. Painted lines do not divide a road, a painted median may.

Knows no lane.
"""

from __future__ import annotations

import re

from sgcad_core.specs import Median

_UNDIVIDED = re.compile(r"\bundivided\b|\bnot (?:\w+ ){0,2}divided\b|\bnon-?divided\b", re.I)
_DIVIDED = re.compile(
    r"\b(?:divided (?:[\w-]+,? ){0,3}(?:road|highway|street|interstate|freeway|trafficway|bridge|expressway|parkway|"
    r"arterial|boulevard)|(?:physically|is|was|are|were|and|lane,?|way,?)[ ,]+divided\b|divided by)|"
    r"\bdivided[,.]|\b(?:separated|divided) (?:from each other )?(?:by|with)", re.I)  # fmt: skip
_MEDIANS: tuple[tuple[Median, str], ...] = (
    ("barrier", r"\b(?:concrete|jersey|positive|protected|center|median|steel|metal|cable)[\w /-]{0,20}(?:barrier|wall|"
                r"guard ?rail|divider)|\bprotected median|barrier|guard ?rail(?= (?:median|divid))|center divider"),
    ("grass", r"(?:grass\w*|unprotected|depressed|dirt|earth\w*|vegetat\w*|tree-lined|wide)[\w ,/-]{0,20}median|"
              r"median strip|unprotected (?:median|divider)|median without"),
    ("painted", r"painted[\w -]{0,12}(?:median|island)|(?:median|island)[\w ]{0,8}painted|striped median"),
    ("raised", r"(?:raised|curb(?:ed)?|concrete|brick)[\w -]{0,15}(?:median|island|divider)|"
               r"\bmedian\b"),
)  # fmt: skip
_MEDIAN = tuple((kind, re.compile(pattern, re.I)) for kind, pattern in _MEDIANS)
_ELSEWHERE = re.compile(r"\b(?:no|without (?:a|any)|over|into|onto|through|toward|against|struck|crossed) (?:\w+ ){0,3}"
                        r"(?:median|barrier|guard ?rail|divider)", re.I)  # fmt: skip
_PAINTED_LINE = re.compile(
    r"(?:divided|separated) (?:from each other )?(?:by|with) (?:\w+ ){0,3}(?:yellow|solid|broken|dashed|painted|"
    r"double|center) ?"
                           r"(?:\w+ ){0,3}lines?", re.I)  # fmt: skip


def divided_and_median(text: str) -> tuple[bool | None, Median | None]:
    """Whether the road is said to be divided, and by what; painted lines alone do not divide."""
    if _UNDIVIDED.search(text):
        return False, None
    text = _ELSEWHERE.sub(" ", text)
    kind = next((kind for kind, pattern in _MEDIAN if pattern.search(text)), None)
    said = bool(_DIVIDED.search(_PAINTED_LINE.sub(" ", text)))
    if kind == "painted":
        return said or None, kind
    if said or (kind and re.search(r"\bmedian\b|divider", text, re.I)):
        return True, kind
    return None, None
