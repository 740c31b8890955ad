"""Critical precrash events, as reports quote them: "this vehicle ...", "other vehicle encroachment ..."."""

from __future__ import annotations

import re

from sgcad_core.narrative.clauses import Told
from sgcad_core.narrative.motion import Deed, Motion
from sgcad_core.narrative.vehicles import MENTION, Roster

_CODES: tuple[tuple[str, str], ...] = (
    ("turn_left", r"turn(?:ing|ed) left|left[ -]turn"), ("turn_right", r"turn(?:ing|ed) right|right[ -]turn"),
    ("u_turn", r"u-turn"),
    ("straight", r"passing through|crossing over|crossing (?:through )?(?:the )?intersection|pass(?:ing)? through"),
    ("over_right", r"over (?:the )?(?:lane line|line)?[\w ]*\bright\b|right side of (?:the )?travel"),
    ("over_left", r"over (?:the )?(?:lane line|line|left|centerline)(?![\w ]*\bright\b)|left side of (?:the )?travel"),
    ("departing_road_left", r"off the (?:edge of the )?road\w*[\w ]*left"),
    ("departing_road_right", r"off the (?:edge of the )?road\w*[\w ]*right"),
    ("lost_control", r"control loss|loss of control|poor road conditions|too fast for conditions"),
    ("slowing", r"decelerat\w+"),
)  # fmt: skip
_OTHERS_CODES: tuple[tuple[str, str], ...] = (
    ("kin:opposite", r"(?:from|in) (?:the )?opposite direction|opposite direction\W+over|oncoming"),
    ("kin:crossing", r"crossing street|from (?:a )?(?:driveway|crossing|alley|side street)"),
    ("kin:same", r"same direction|adjacent lane|higher speed|lower (?:steady )?speed|steady speed|"
                 r"other (?:motor )?(?:vehicle )?(?:was )?stopped"),
    ("other:stopped", r"(?:other )?(?:vehicle|motor) (?:was )?stopped|stopped vehicle|in lane,? stopped"),
    ("other:slowing", r"decelerat\w+|lower (?:steady )?speed"),
    ("self:hit_from_behind", r"higher speed"),
    ("other:into_opposite", r"turn\w* into (?:the )?opp\w*"), ("other:into_same", r"turn\w* into (?:the )?same"),
    ("other:straight", r"across (?:its |the )?path|passing through"),
    ("other:turn_left", r"turning left"), ("other:turn_right", r"turning right"),
)  # fmt: skip


_UNCODED = re.compile(
    r"(?:the |a |no |neither )*(?:critical reason|reason for|critical (?:precrash |crash )?event\b.{0,40}\bnot coded|"
    r"no critical (?:precrash |crash )?event)", re.I)  # fmt: skip


def read_code(found: dict[str, Motion], told: Told, who: Roster) -> None:
    text = told.text.lower()
    if not re.search(r"critical (?:precrash |crash )?event|this vehicle|other (?:motor )?vehicle|encroach", text):
        return
    named = [v for v in MENTION.findall(told.text) if v in who.ids]
    owner = named[0] if named else told.subject
    if owner not in found or _UNCODED.match(text):
        return
    if re.search(r"\bother (?:motor )?vehicle|encroach\w*|other motor", text):
        _other_code(found, owner, text, told.number, who)
    else:
        for kind, pattern in _CODES:
            if code := re.search(pattern, text):
                found[owner].deeds.append(Deed(f"code:{kind}", 2, told.number, code.group()))


def _other_code(found: dict[str, Motion], owner: str, text: str, number: int, who: Roster) -> None:
    other = who.other(owner)
    for kind, pattern in _OTHERS_CODES:
        if not (code := re.search(pattern, text)):
            continue
        whom, what = kind.split(":")
        if whom == "kin":
            for me, you in ((owner, other), (other, owner)) if other else ((owner, other),):
                if me:
                    found[me].kin.append((1, what, you, "code"))  # type: ignore[arg-type]
        elif whom == "self":
            found[owner].deeds.append(Deed(f"code:{what}", 2, number, code.group()))
        elif other:
            found[other].deeds.append(Deed(f"code:{what}", 2, number, code.group()))
