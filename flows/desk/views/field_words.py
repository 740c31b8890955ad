"""Labels of fields and values on the desk's pages."""

from __future__ import annotations

from typing import Any

from sgcad_core.account.words import JUNCTION_WORDS

_NAMES = {
    "kind": "is a", "start_speed_mph": "speed before", "final_speed_mph": "last speed", "start_road": "starts on",
    "start_lane": "starts in lane", "exit_road": "leaves by", "lane_word": "lane as told", "striker": "striker",
    "struck": "struck actor", "striker_area": "side of the striker", "struck_area": "side of the struck",
    "lanes_forward": "lanes towards the junction", "lanes_backward": "lanes away from it", "axis": "runs",
    "lanes_total": "lanes in all", "lanes_each_way": "lanes each way", "one_way": "one-way",
    "speed_limit_mph": "speed limit", "exit_heading": "heading behind", "present": "takes part",
    "start_direction": "direction on its road", "turns_forward": "lane uses towards the junction",
    "turns_backward": "lane uses at the other end", "clearance_m": "clearance", "speed_mph": "speed before",
    "stem": "leg that ends there", "minor": "has the sign", "near_crash": "near crash",
    "facing_deg": "faces at rest", "where": "rests", "lane_way": "rests in a lane toward", "distance_m": "rests after",
}  # fmt: skip
_UNITS = {"_mph": "mph", "_m": "m", "_deg": "°", "_s": "s"}


def name_of(field: str) -> str:
    """The last part of a field's name in words: "vehicles.V1.start_lane" is "starts in lane"."""
    last = field.rpartition(".")[2]
    if last in _NAMES:
        return _NAMES[last]
    end = next((end for end in _UNITS if last.endswith(end)), "")
    return last.removesuffix(end).replace("_", " ")


def unit_of(field: str) -> str:
    """The unit that a field's name ends with; "" without one."""
    return next((unit for end, unit in _UNITS.items() if field.endswith(end)), "")


def shown(field: str, value: Any) -> str:
    """A value for people, with its unit."""
    if value is None:
        return "open"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, list | tuple):
        return ", ".join(str(v).replace("_", " ") for v in value) or "none"
    if field.endswith("junction.kind"):
        return JUNCTION_WORDS.get(value, str(value).replace("_", " "))
    unit = unit_of(field)
    text = f"{value:g}" if isinstance(value, int | float) else str(value).replace("_", " ")
    return f"{text} {unit}" if unit and isinstance(value, int | float) else text
