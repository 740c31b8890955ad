"""Where a sentence names a road: the noun phrases around "roadway", "street", "ramp", "two-lane T-intersection".

Knows where such phrases begin and end, not what they mean.
"""

from __future__ import annotations

from collections.abc import Iterator

from sgcad_core.reading.language import rule

_STOP = frozenset({
    "a", "an", "the", "this", "that", "these", "another", "each", "both", "all", "of", "on", "in", "at", "into",
    "onto", "from", "to", "along", "near", "by", "for", "was", "is", "were", "are", "had", "has", "with", "where",
    "which", "when", "toward", "towards", "between", "approaching", "entered", "entering", "entire", "down", "up",
    "upon", "across", "over", "through", "past", "it", "its", "his", "her", "their", "as", "before", "after", "off",
    "around", "than", "driver", "s", "crossed", "exited", "exiting", "two-vehicle", "while", "but", "there",
})  # fmt: skip
_DETERMINERS = ("a", "an", "the", "this", "that", "another", "each", "both", "all", "these")


def noun_phrases(text: str) -> Iterator[tuple[int, int, int]]:
    """(start, start of the road word, end) of each road's noun phrase; of "freeway entrance ramp" the last word."""
    held: tuple[int, int, int] | None = None
    for head in rule("road_phrases.head").finditer(text):
        start = _phrase_start(text, head.start())
        if "intersection" in head[0].lower() and "-lane" not in text[start : head.start()]:
            continue
        if held and _in_brackets(text[held[2] : head.start()]):
            continue
        if held and start >= held[2]:
            yield held
        held = (min(start, held[0]) if held and start < held[2] else start, head.start(), head.end())
    if held:
        yield held


def _in_brackets(between: str) -> bool:
    return between.count("(") > between.count(")")


def _phrase_start(text: str, at: int) -> int:
    """Back over the modifiers to the determiner, or to the word that cannot stand in a noun phrase."""
    start = at
    for word in reversed(list(rule("road_phrases.word").finditer(text[:at]))[-16:]):
        token = word[0].strip(",()\"'").lower()
        if word[0][-1] in ".;:)" or rule("road_phrases.vehicle").fullmatch(token):
            break
        if token in _STOP and not _within_pair(text, word.start(), token):
            return word.start() if token in _DETERMINERS else start
        start = word.start()
    return start


def _within_pair(text: str, at: int, token: str) -> bool:
    """The "to" of "east to west"."""
    before = rule("road_phrases.direction_before").search(text[:at])
    return token in ("to", "/") and bool(before and rule("road_phrases.direction_behind").match(text[at:]))
