"""The legs that a part of a sentence refers to: legs, directions of travel, roads by name, "every leg"."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from sgcad_core.reading.junctions.approach_items import ApproachToken
from sgcad_core.reading.language import rule
from sgcad_core.reading.roads.road_mentions import axis_of
from sgcad_core.reading.text.compass import COMPASS, compass_of, turned
from sgcad_core.records.specs import Compass

ALL, STEM, MAIN = "all", "stem", "main"
APART = (ALL, STEM, MAIN)
"""Keys that name no bearing."""
ROADS = ("axis", "named", "other", "main")
"""Kinds of parts that name a road, both of its legs."""
KINDS = ("legs", "ways", "every", "each", "stem", "place", "unknown", *ROADS)
"""Kinds of parts that name the legs of told lanes."""


@dataclass
class LegReference:
    """Legs: keys are bearings, "axis N", "all" or "stem"; `toward`: told by directions of travel."""

    keys: tuple[str, ...] = ()
    toward: bool = False

    @property
    def axis(self) -> Compass | None:
        """The one axis of the legs; None of several."""
        axes = {axis_of(bearing_of(key)) for key in self.keys if key not in APART}
        return next(iter(axes)) if len(axes) == 1 else None


def bearing_of(key: str) -> Compass:
    """The bearing in a key: "N" of "N" and of "axis N"."""
    return next(c for c in COMPASS if c == key.removeprefix("axis "))


@dataclass
class LegReferences:
    """The mark that holds while a text is read. `names`: roads by name, with their axes."""

    names: Mapping[str, Compass]
    mark: LegReference = field(default_factory=LegReference)
    scope: Compass | None = None
    """The axis that was told last."""

    def of(self, part: ApproachToken) -> LegReference | None:
        """The mark that a part makes; None where it makes none."""
        found = self._legs(part) or self._road(part) or (LegReference((ALL,)) if part.kind in _SOME else None)
        if found is not None:
            self.scope = found.axis or self.scope
        return found

    def _legs(self, part: ApproachToken) -> LegReference | None:
        words = part.match.groupdict()
        if part.kind in ("legs", "place"):
            return LegReference(tuple(points(words["list"])))
        if part.kind == "ways":
            return LegReference(tuple(turned(w, 180) for w in points(words["list"] or words["list2"])), toward=True)
        if part.kind == "leading":
            return LegReference(tuple(turned(w, 180) for w in points(words["way"])), toward=True)
        if part.kind in (STEM, MAIN):
            return LegReference((part.kind,))
        return LegReference() if part.kind == "unknown" else None

    def _road(self, part: ApproachToken) -> LegReference | None:
        axis: Compass | None = None
        if part.kind == "axis":
            axis = _axis(part)
        elif part.kind == "named":
            axis = self.names[part.match[0]]
        elif part.kind == "other" and self.scope:
            axis = axis_of(turned(self.scope, 90))
        elif part.kind == "each":
            words = part.match.groupdict()
            name = self._known(words.get("of")) or self._known(words.get("name"))
            if name is None and self.mark.keys == (MAIN,):
                return LegReference((MAIN,))
            axis = self.names[name] if name else self.mark.axis or self.scope
        return LegReference((f"axis {axis}",)) if axis else None

    def _known(self, words: str | None) -> str | None:
        return next((name for name in _forms(words) if name in self.names), None) if words else None


_SOME = ("every", "each", "each_way")


def _axis(part: ApproachToken) -> Compass | None:
    one, two = compass_of(part.match["one"]), compass_of(part.match["two"])
    return axis_of(one) if one and two and axis_of(one) == axis_of(two) and one != two else None


def points(words: str) -> list[Compass]:
    """The compass points that words name, in their order."""
    return [way for m in rule("approaches.point").finditer(words) if (way := compass_of(m["way"]))]


def road_names(texts: Sequence[str]) -> dict[str, Compass]:
    """Names of roads with the axis on which they lie; of two roads the other lies square to the one that is told."""
    found: dict[str, Compass] = {}
    for text in texts:
        for m in rule("approaches.name").finditer(text):
            words = {key.rstrip("2345"): value for key, value in m.groupdict().items() if value}
            way = points(words["way"]) if "way" in words else [bearing_of(words["letters"].split("-")[0])]
            for name in _forms(words["name"]):
                if way:
                    found.setdefault(name, axis_of(way[0]))
    axes = {*found.values()}
    if len(axes) == 1:
        across = axis_of(turned(next(iter(axes)), 90))
        others = {m[0] for text in texts for m in rule("approaches.all_names").finditer(text)}
        if len({name.split()[0] for name in others} - {*found}) == 1:
            found |= {form: across for name in others for form in _forms(name) if form not in found}
    return found


def _forms(name: str) -> set[str]:
    """A name in full and its first word, where that is one of its own."""
    return {form for form in (name, name.split()[0]) if rule("approaches.own_name").search(form)}
