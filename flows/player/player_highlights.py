"""Links between things in the player (vehicles, roads, the contact) and the sentences that tell of them."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from flows.player.road_shapes import Strip
from flows.player.sentence_marks import told_sentences
from sgcad_core.case.records import CrashReport
from sgcad_core.reading.text.compass import WORDS, angle_of
from sgcad_core.reading.text.traced_text import placed, shown

ALONG_DEG = 20.0
"""A lane within this of a road's axis is taken for that road's."""
BENT_DEG = 30.0
"""A lane whose ends run off its axis by more goes around a circle, not along a road."""
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
    """Sentences that tell facts or that the account names: [start, end) in the narrative as shown, [of, upto) as
    written, the things that they tell of, and how they were read (`sentence_marks`)."""
    text = placed(report.narrative, report.places)
    return [
        {
            "start": told.start, "end": told.end, "of": told.of, "upto": told.upto, "mark": told.mark,
            "things": list(dict.fromkeys(thing for field in told.fields if (thing := thing_of(field)))),
        }
        for told in told_sentences(facts, items, lambda place: shown(text, *place))
    ]  # fmt: skip


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
    points = np.asarray(strip.points)
    heading, *ends = (math.atan2(b[1] - a[1], b[0] - a[0]) for a, b in (points[[0, -1]], points[:2], points[-2:]))
    if any(abs(math.remainder(end - heading, 2 * math.pi)) > math.radians(BENT_DEG) for end in ends):
        return ""
    off = {name: abs(math.remainder(heading - axis, math.pi)) for name, axis in axes.items()}
    near = min(off, key=lambda name: off[name], default="")
    return near if near and math.degrees(off[near]) <= ALONG_DEG else ""
