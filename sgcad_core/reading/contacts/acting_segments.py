"""Sentences cut into segments, each with the vehicles that act in it.

"The impact caused V1 to rotate" is what V1 did. Knows no contact and no order of events.
"""

from __future__ import annotations

import re
from collections.abc import Sequence

from sgcad_core.reading.actors.vehicles import Roster
from sgcad_core.reading.language import rule
from sgcad_core.reading.motion.clauses import Segment, Statement, segments


def acting_segments(statements: Sequence[Statement], roster: Roster) -> list[Segment]:
    """Segments of all sentences, each with the vehicles that act in it."""
    return [part for t in statements for part in _cut(_of_the_impact(t), roster)]


def _cut(statement: Statement, roster: Roster) -> list[Segment]:
    """One sentence; one that begins "Then rotated" goes on with the last one's subject."""
    found = _with_own_acts(segments([statement], roster), statement)
    goes_on = rule("course_rest.then").match(statement.text)
    if not goes_on or not statement.subject:
        return found
    end = len(statement.text) - sum(len(part.text) for part in found)
    return [
        Segment((statement.subject,), statement.text[goes_on.end() : end].lower(), statement.role, statement.number),
        *found,
    ]


def _of_the_impact(statement: Statement) -> Statement:
    """ "The impact caused V1 to rotate" and "V1's front struck a pole" with V1 as subject; "V1 after striking V2
    rotated" with V1 alone."""
    text = rule("course_rest.caused").sub(_caused, statement.text)
    text = rule("course_rest.own_side").sub(r"\g<who>", text)
    text = rule("course_rest.after_striking").sub(r"\g<who>", text)
    return statement if text == statement.text else statement._replace(text=text)


def _caused(m: re.Match[str]) -> str:
    verb = "made to" if m["to"] else m["verb"]
    return f"{m['who']} {'were' if m['who'].startswith('both') else 'was'} {verb}"


def _with_own_acts(segments: Sequence[Segment], statement: Statement) -> list[Segment]:
    """Segments of one sentence, with an onlooker's own acts given back to it.

    "V2 noticed V1 turning into her path and steered right": V2 steered, as it did in "avoided V2 by steering left".
    """
    found: list[Segment] = []
    for segment in segments:
        before = found[-1] if found else None
        onlooker = before.subjects if before and rule("course_evasion.perceives").search(before.text) else ()
        onlooker = onlooker or (
            (statement.subject,) if statement.subject and statement.subject not in segment.subjects else ()
        )
        back = rule("course_evasion.back_to_subject").search(segment.text)
        if onlooker and segment.text.startswith("by "):
            found.append(segment._replace(subjects=onlooker))
        elif onlooker and back:
            found.append(segment._replace(text=segment.text[: back.start()]))
            found.append(segment._replace(subjects=onlooker, text=segment.text[back.start() :]))
        else:
            found.append(segment)
    return found
