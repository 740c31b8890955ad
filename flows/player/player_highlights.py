"""Links between things in the player (vehicles, roads, the contact) and the sentences that tell of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from flows.player.road_shapes import Strip
from sgcad_core.case.records import CrashReport
from sgcad_core.reading.text.compass import WORDS, angle_of
from sgcad_core.reading.text.traced_text import placed, shown

ALONG_DEG = 20.0
"""A lane within this of a road's axis is taken for that road's."""
MARKS = ("contradicts", "unread", "lacks")
"""How a sentence was not read as it stands, the gravest first: the report says something else as well; something of it
was not read; the scenario lacks something that it tells."""
MARK_WORDS = {"contradicts": "contradicted", "unread": "not read", "lacks": "not in the scenario"}
"""The same in words, which stand beside the color."""
_COMPASS = {point: angle_of(point) for point in WORDS.values()}
Row = Mapping[str, Any]


def thing_of(field: str) -> str:
    """The thing of a fact: "V1", "road main", "contact", or "" for conditions, junctions and roads as drawn."""
    kind, _, rest = field.partition(".")
    name = rest.split(".")[0]
    if kind in ("vehicles", "others"):
        return name
    if kind == "roads":
        return f"road {name}" if name[:1].islower() else ""
    return "contact" if kind == "contacts" else ""


def sentences_of(report: CrashReport, facts: Iterable[Row], items: Iterable[Row] = ()) -> list[dict[str, Any]]:
    """Sentences that tell facts or that the account names: [start, end) in the narrative as shown, the things that
    they tell of, and how they were read (`MARKS`; "read" where the account has nothing against them)."""
    text = placed(report.narrative, report.places)
    things: dict[tuple[int, int], dict[str, None]] = {}
    for fact in facts:
        if fact["start"] is not None and (thing := thing_of(fact["field"])):
            things.setdefault((fact["start"], fact["end"]), {})[thing] = None
    marks = _marks(items)
    for place in marks:
        if not any(start < place[1] and place[0] < end for start, end in things):
            things[place] = {}
    spans = [(shown(text, *place), place, list(told)) for place, told in sorted(things.items())]
    return [
        {"start": a, "end": b, "of": place[0], "things": told, "mark": _gravest(place, marks)}
        for (a, b), place, told in spans
        if b > a
    ]


def _marks(items: Iterable[Row]) -> dict[tuple[int, int], str]:
    """Places of the narrative with the gravest thing that the account says of them."""
    found: dict[tuple[int, int], str] = {}
    for item in items:
        if item["kind"] in MARKS and item["start"] is not None:
            place = item["start"], item["end"]
            found[place] = min(found.get(place, item["kind"]), item["kind"], key=MARKS.index)
    return found


def _gravest(place: tuple[int, int], marks: Mapping[tuple[int, int], str]) -> str:
    """The mark of a sentence: the gravest of those that lie in it."""
    within = [mark for (start, end), mark in marks.items() if start < place[1] and place[0] < end]
    return min(within, key=MARKS.index, default="read")


def facts_by_thing(facts: Iterable[Row]) -> dict[str, list[dict[str, Any]]]:
    """Facts of each thing, the last of a name: {"name", "value", "status", "of": start of its sentence}."""
    found: dict[str, dict[str, dict[str, Any]]] = {}
    for fact in facts:
        if thing := thing_of(fact["field"]):
            name = fact["field"].split(".", 2)[2]
            row = {"name": name, "value": fact["value"], "status": fact["status"], "of": fact["start"]}
            found.setdefault(thing, {})[name] = row
    return {thing: list(rows.values()) for thing, rows in found.items()}


def road_axes(facts: Iterable[Row]) -> dict[str, float]:
    """The roads of the report and how they run, radians counter-clockwise from east."""
    axes = (f for f in facts if f["field"].startswith("roads.") and f["field"].endswith(".axis"))
    return {thing_of(f["field"]): _COMPASS[f["value"]] for f in axes}


def road_along(strip: Strip, axes: Mapping[str, float]) -> str:
    """The road that a lane runs along; "" where it runs along none."""
    dx, dy = np.asarray(strip.points[-1]) - np.asarray(strip.points[0])
    heading = math.atan2(dy, dx)
    off = {name: abs(math.remainder(heading - axis, math.pi)) for name, axis in axes.items()}
    near = min(off, key=lambda name: off[name], default="")
    return near if near and math.degrees(off[near]) <= ALONG_DEG else ""
