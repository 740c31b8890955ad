"""Area phrases: "left front corner", "V1's driver side door", brought to one form and to an area. Knows no verb."""

from __future__ import annotations

import re

from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.language import of_role, rule
from sgcad_core.reading.motion.clauses import Statement, subject_starts
from sgcad_core.records.specs import Area

Zone = str
"""An area of a vehicle ("left") or a corner ("front/left": the end, then the flank)."""


def area_of(words: str) -> Zone | None:
    """What an area phrase means: "left door" -> "left", "left front" -> "front/left"; None if it names no side.

    A corner keeps both: the end it belongs to and the flank, since reports use it for either; both flanks where it is
    not told which corner.
    """
    text = words.lower().replace("-", " ")
    if both := rule("zones.end_and_side").search(text):
        return "back" if both["back"] else "front"
    flank: Area | None = next((side.yields["area"] for side in of_role("flank") if side.search(text)), None)
    front = bool(rule("zones.front").search(text))
    back = bool(rule("zones.back").search(text))
    if flank and (front or back) and (not rule("zones.flankparts").search(text) or rule("zones.cornered").search(text)):
        return f"front/{flank}" if front else f"back/{flank}"
    if rule("zones.corner").search(text) and (front or back) and not flank:
        return "front/left/right" if front else "back/left/right"
    return flank or ("front" if front else "back" if back else None)


# ------------------------------------------------------------------ one form
def plain(statement: Statement, roster: Roster) -> str:
    """The sentence with possessives turned round: "V1's left side" -> "the left side of V1"."""
    text = rule("zones.plural_number").sub(r"V\1's", statement.text)
    text = rule("zones.bracketed").sub(r"the \g<area> of \g<v>", text)
    text = rule("zones.trailer_of_number").sub(r"\1", text)
    text = rule("zones.towed_by").sub(lambda m: m["v"] or m["towing"], text)
    text = rule("zones.of_trailer").sub(r"of \1", text)
    towing = [v.id for v in roster.vehicles if v.trailer]
    text = rule("zones.the_trailer").sub(f"of {towing[0]}", text) if len(towing) == 1 else text
    text = rule("zones.opened_door").sub(r"\g<told>the \g<door> of \g<v>", text)
    text = rule("zones.possessive").sub(lambda m: f"the {m['area']} of {m['v']}", text)
    text = rule("zones.apposed").sub(r"the \g<area> of \g<v>", text)
    text = rule("zones.bare_possessive").sub(r"the \g<area> of \g<v>", text)
    text = rule("zones.frontal_of").sub("front", text)
    text = rule("zones.front_of_none").sub(r"the \g<area> of \g<v>", text)
    text = rule("zones.part_of_side").sub(lambda m: m["side"] or m["plane"], text)
    text = rule("zones.two_sides").sub(r"\g<first>", text)
    text = rule("zones.side_first").sub(r"the \g<first> of \g<v>", text)
    if statement.subject:
        text = rule("zones.of_the_vehicle").sub(rf"the \g<area> of {statement.subject}", text)
        text = rule("zones.area_of_the_vehicle").sub(rf"\g<area> of {statement.subject}", text)
    return rule("zones.its_area").sub(lambda m: _its(m, statement, text, roster), text)


def _its(match: re.Match[str], statement: Statement, text: str, roster: Roster) -> str:
    starts = [
        subjects for at, _, subjects in subject_starts(statement._replace(text=text), roster) if at < match.start()
    ]
    owner = starts[-1][0] if starts and starts[-1] else statement.subject
    return f"the {match['area']} of {owner}" if owner else match.group()


def area_if_told(words: str | None) -> Zone | None:
    """The area of a phrase; None without one."""
    return area_of(words) if words else None


def area_by(scope: str) -> Zone | None:
    """The area in "by the front", behind a verb of hitting."""
    found = rule("contact.by_area").search(scope)
    return area_of(found["area"]) if found else None
