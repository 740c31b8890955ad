"""Area phrases: "left front corner", "V1's driver side door", brought to one form and to an area. Knows no verb."""

from __future__ import annotations

import re

from sgcad_core.narrative.clauses import Told, subject_starts
from sgcad_core.narrative.vehicles import Roster
from sgcad_core.specs import Area

Zone = str
"""An area of a vehicle ("left") or a corner ("front/left": the end, then the flank)."""

PART = (
    r"(?:left|right|front(?:al|s)?|rears?|back|driver'?s?|passenger'?s?|side|sides|corner|end|bumper|fender|quarter|"
    r"panel|doors?|wheels?|"
    r"tires?|portion|part|center|middle|area|hand|end|plane|axle|section|half|grille|hood|tailgate|trunk|mirror|"
    r"compartment|"
    r"passenger|driver|forward|lower|upper|trailer|semi-trailer|cab|tractor|hatch|window|pillar|plow|bed|tongue|"
    r"headlight|taillight|most|most-|leading|trailing|edge)"
)  # fmt: skip
AREA = rf"{PART}(?:(?:[ -]|, | and | \(|/){PART}\)?)*"
_POSSESSIVE = re.compile(rf"\b(?P<v>V\d+)(?:'s?|s) (?:vehicle'?s? )?(?P<area>{AREA})\b", re.I)
_FLANKPARTS = re.compile(r"\bsides?\b|\bdoors?\b|\bfender|\bwheel|\bquarter|\btire|\baxle|\bpillar|\bmirror")
_SIDES: tuple[tuple[Area, str], ...] = (
    ("left", r"\bleft\b|\bdriver'?s?(?: door| side|-side)"), ("right",
    r"\bright\b|\bpassenger'?s?(?: door| side|-side)"),
)  # fmt: skip


_ITS_AREA = re.compile(
    rf"(?<!with )\b(?:its|his|her|their) (?P<area>{AREA})(?= (?:was|were|struck|impacted|contacted|hit|made|came|being|"
    rf"collided)\b)",
    re.I)  # fmt: skip


def area_of(words: str) -> Zone | None:
    """What an area phrase means: "left door" -> "left", "left front" -> "front/left"; None if it names no side.

    A corner keeps both: the end it belongs to and the flank, since reports use it for either.
    """
    text = words.lower().replace("-", " ")
    flank = next((area for area, pattern in _SIDES if re.search(pattern, text)), None)
    front = bool(re.search(r"\bfront|\bleading|\bgrille|\bhood|\bheadlight|\bforward", text))
    back = bool(re.search(r"\brear|\btrailing|\bback\b|\btailgate|\btrunk|\bhatch|\btaillight", text))
    if flank and (front or back) and not _FLANKPARTS.search(text):
        return f"front/{flank}" if front else f"back/{flank}"
    return flank or ("front" if front else "back" if back else None)


# ------------------------------------------------------------------ one form
def plain(told: Told, who: Roster) -> str:
    """The sentence with possessives turned round: "V1's left side" -> "the left side of V1"."""
    text = re.sub(r"\bV(\d+)s(?= (?:front|rear|left|right|back|side|trailer|path|lane))", r"V\1's", told.text)
    text = re.sub(r"\b(V\d+)'s (?:[\w-]+ ){0,2}?(?:semi-?)?trailer\b", r"\1", text)
    text = re.sub(r"\bof the (?:[\w-]+ )?(?:semi-?)?trailer of (V\d+)", r"of \1", text)
    text = _POSSESSIVE.sub(lambda m: f"the {m['area']} of {m['v']}", text)
    text = re.sub(
        rf"\b(?P<area>{AREA}) of the (?:vehicle|car|truck|van)\b(?! (?:that|which))",
        _of_subject(told),
        text,
        flags=re.I,
    )
    return _ITS_AREA.sub(lambda m: _its(m, told, text, who), text)


def _of_subject(told: Told) -> str:
    return rf"\g<area> of {told.subject}" if told.subject else r"\g<0>"


def _its(match: re.Match[str], told: Told, text: str, who: Roster) -> str:
    starts = [subjects for at, _, subjects in subject_starts(told._replace(text=text), who) if at < match.start()]
    owner = starts[-1][0] if starts else told.subject
    return f"the {match['area']} of {owner}" if owner else match.group()
