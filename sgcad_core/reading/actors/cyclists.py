"""Cyclists to whom a report that numbers its one vehicle gives no number. Knows no deed."""

from __future__ import annotations

from sgcad_core.reading.actors.references import Numbering, numbered
from sgcad_core.reading.actors.unnumbered_actors import Actor, NamedActors, Phrase
from sgcad_core.reading.language import rule
from sgcad_core.reading.text.traced_text import TracedText


def number_cyclists(text: TracedText) -> TracedText:
    """A text that numbers V1 alone with everybody on a bicycle numbered from V2 on; all others stay as they are.

    Of several numbered vehicles the words alone do not tell whom a cyclist met: those texts stay as well.
    """
    if {m.group() for m in rule("common.vehicle").finditer(text.text)} != {"V1"}:
        return text
    v1 = Actor(1, "vehicle", set(), subject=True)
    return numbered(text, _Cyclists(NamedActors([v1], automated=True)))


class _Cyclists(Numbering):
    """Numbers cyclists alone, and marks them as numbered here; no phrase of a vehicle means V1 or anybody else."""

    def is_nobody(self, phrase: Phrase) -> bool:
        return phrase.kind != "bicycle" or not phrase.match["user"] or super().is_nobody(phrase)

    def introduced(self, words: str, number: str) -> str:
        return f"{'An' if words[0].isupper() else 'an'} unnumbered {words.partition(' ')[2]} {number}"
