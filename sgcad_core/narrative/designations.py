"""By which words a report that numbers its vehicles names them: "a Geo Metro, V2", "the Jimmy is V1".

A short name ("the Jimmy") brings the whole phrase with it that holds it anywhere in the text ("a GMC Jimmy"), as long
as it is the only one. Knows no motion and no contact.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from sgcad_core.language import rule
from sgcad_core.narrative.makes import BODY_WORDS, is_model
from sgcad_core.narrative.motion import Cue

_WHOLE = (rule("designations.before"), rule("designations.apposed"), rule("designations.late"))
_SHORT = (rule("designations.short_before"), rule("designations.short_after"))


def designations(told: Sequence[str]) -> dict[str, tuple[Cue, ...]]:
    """By number: the phrases that name its vehicle, in the order of the text."""
    found: dict[str, list[Cue]] = {}
    for n, text in enumerate(told):
        for pattern in _WHOLE:
            for m in pattern.finditer(text):
                found.setdefault(m["v"], []).append(Cue(n, m["words"]))
    taken = {v: " ".join(cue.words for cue in cues) for v, cues in found.items()}
    phrases = tuple(_phrases(told))
    for n, text in enumerate(told):
        for m in (m for pattern in _SHORT for m in pattern.finditer(text)):
            if m["v"] not in taken and (words := _meant(m["words"], phrases)):
                found.setdefault(m["v"], []).append(Cue(n, words))
    return {v: tuple(cues) for v, cues in found.items()}


def _phrases(told: Sequence[str]) -> Iterator[str]:
    for text in told:
        yield from (m["words"] for m in rule("designations.phrase").finditer(text))


def _meant(short: str, phrases: Sequence[str]) -> str | None:
    """The one phrase that holds a short name, or the only one of that kind of body; the body word itself else."""
    name = short.lower()
    holding = {p.lower(): p for p in phrases if rule("makes.whole_word").given(word=name).search(p.lower())}
    if len(holding) == 1:
        return next(iter(holding.values()))
    return short if not holding and (name in BODY_WORDS or is_model(name)) else None
