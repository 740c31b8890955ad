"""People and cyclists to whom a report that numbers its one vehicle gives no number. Knows no deed."""

from __future__ import annotations

from sgcad_core.language import rule
from sgcad_core.narrative.references import People, numbered
from sgcad_core.narrative.traced import Traced


def number_people(text: Traced) -> Traced:
    """A text that numbers V1 alone with everybody on foot or on a bicycle numbered from V2 on; others stay as they are.

    Of several numbered vehicles nobody can say by the words alone whom a person met: those texts stay as well.
    """
    if {m.group() for m in rule("common.vehicle").finditer(text.text)} != {"V1"}:
        return text
    return numbered(text, People.beside_v1())
