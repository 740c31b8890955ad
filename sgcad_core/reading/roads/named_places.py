"""Places that a narrative names, as a map may know them: streets with their spans, coordinates, a distance.

Reads the narrative as it was written, forms and headings too. Knows no map; how a street runs is read elsewhere
(`street_names`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from sgcad_core.reading.language import rule
from sgcad_core.reading.text.compass import WORDS
from sgcad_core.records.specs import Compass
from sgcad_core.units import METERS

_NUMBERS = {"one": 1.0, "half": 0.5}
_BESIDE = 40
"""Characters between a distance and the name of its street."""


@dataclass(frozen=True)
class NamedStreet:
    """A street as the text calls it. `sure`: with a word for a street or a number; else a capital word behind "on"."""

    text: str
    start: int
    end: int
    sure: bool = True
    ways: tuple[Compass, ...] = ()
    """Directions in which something is told to go along it, at any mention of that spelling."""


@dataclass(frozen=True)
class Away:
    """The crash was so far from a street, on that side of it."""

    metres: float
    way: Compass
    street: str


@dataclass(frozen=True)
class NamedPlaces:
    """All that a narrative says of where it was; streets in order of their first mention, each spelling once."""

    streets: tuple[NamedStreet, ...] = ()
    latitude: float | None = None
    longitude: float | None = None
    away: Away | None = None

    @property
    def some(self) -> bool:
        """Whether it names anything that a map may know."""
        return bool(self.streets) or self.latitude is not None


def named_places(narrative: str) -> NamedPlaces:
    """The named places of a narrative; all empty where it names none."""
    text = _in_small_letters(narrative)
    spans: list[NamedStreet] = []
    for street in sorted(_streets(text), key=lambda s: (not s.sure, s.start - s.end)):
        if not any(street.start < other.end and other.start < street.end for other in spans):
            spans.append(street)
    spans.sort(key=lambda street: street.start)
    ways = {s.text.lower(): tuple(dict.fromkeys(_ways(text, s.text.lower(), spans))) for s in spans}
    first = {s.text.lower(): replace(s, ways=ways[s.text.lower()]) for s in reversed(spans)}
    latitude, longitude = _coordinates(text)
    ordered = tuple(sorted(first.values(), key=lambda street: street.start))
    return NamedPlaces(ordered, latitude, longitude, _away(text, spans))


def _streets(text: str) -> Iterator[NamedStreet]:
    for known in (rule("street_places.named"), rule("street_names.numbered")):
        for m in known.finditer(text):
            yield NamedStreet(m[0], m.start(), m.end())
    for m in rule("street_places.meeting").finditer(text):
        for group in ("first", "second"):
            yield NamedStreet(m[group].rstrip("."), m.start(group), m.end(group), sure=False)
    for m in rule("street_names.behind_on").finditer(text):
        yield NamedStreet(m["name"], m.start("name"), m.end("name"), sure=False)


def _ways(text: str, name: str, spans: list[NamedStreet]) -> Iterator[Compass]:
    """Directions of travel told right before the mentions of a name."""
    for at, street in enumerate(spans):
        start = spans[at - 1].end if at else 0
        if street.text.lower() == name and (m := rule("street_names.along").match(text[start : street.start])):
            yield WORDS[m["way"].lower().removesuffix("bound")]


def _coordinates(text: str) -> tuple[float | None, float | None]:
    """Latitude and longitude in degrees, north and east positive."""
    m = rule("street_places.decimal").search(text)
    if m is None:
        return None, None
    latitude, longitude = float(m["lat"]), float(m["lon"])
    latitude = -abs(latitude) if (m["ns"] or "").lower() == "s" else latitude
    longitude = -abs(longitude) if (m["ew"] or "").lower() == "w" else longitude
    return (latitude, longitude) if abs(latitude) <= 90 and abs(longitude) <= 180 else (None, None)


def _away(text: str, spans: list[NamedStreet]) -> Away | None:
    for m in rule("street_places.away").finditer(text):
        street = next((s for s in spans if m.end() <= s.start <= m.end() + _BESIDE), None)
        if street:
            number = _NUMBERS.get(m["number"].lower()) or float(m["number"])
            return Away(number * METERS[m["unit"].lower()], WORDS[m["way"].lower()], street.text)
    return None


def _in_small_letters(text: str) -> str:
    """A text in capitals with small letters behind the first of each word; places stay."""
    if any(letter.islower() for letter in text):
        return text
    before = " " + text[:-1]
    text = "".join(c.lower() if p.isalnum() or p in "'’" else c for p, c in zip(before, text, strict=True))
    for word in ("And", "At", "Of", "On", "In", "The", "With", "Near"):
        text = text.replace(f" {word} ", f" {word.lower()} ")
    return text
