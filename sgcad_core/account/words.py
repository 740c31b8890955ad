"""Names of fields and values for display. Knows field names; no report and no scenario."""

from __future__ import annotations

from sgcad_core.kinds import JUNCTIONS
from sgcad_core.records.facts import Value

FIELDS = {
    "start_speed_mph": "speed", "exit_road": "leaves by", "start_lane": "lane", "start_road": "starts on",
    "final_speed_mph": "last speed", "lane_word": "lane", "speed_mph": "speed", "speed_limit_mph": "speed limit",
    "meant_maneuver": "means to", "exit_heading": "turns to", "heading": "heads", "maneuver": "maneuver",
    "where": "", "lane_way": "in a lane toward", "stem": "leg that ends there", "lanes_total": "lanes in all",
    "striker_area": "striking side", "struck_area": "struck side",
}  # fmt: skip
"""Display names of fields; other fields are shown by their own names."""
JUNCTION_WORDS: dict[str, str] = {record.kind: record.called.removeprefix("a ") for record in JUNCTIONS}
"""Kinds of junctions for people, without an article."""
UNITS = {"mph": " mph", "deg": " degrees", "m": " m"}


def named(field: str) -> tuple[str, str]:
    """Subject and display name of a field: "vehicles.V1.rest.where" -> ("V1", "rest")."""
    kind, *rest = field.split(".")
    if kind in ("vehicles", "others") and rest:
        return rest[0], _called(rest[1:])
    if kind == "roads" and rest:
        return f"road {rest[0]}", _called(rest[1:])
    if kind in ("contacts", "impacts") and rest:
        which = "contact" if kind == "contacts" else "later impact"
        return f"{which} {int(rest[0]) + 1}" if rest[0].isdigit() else which, _called(rest[1:])
    return kind, _called(rest)


def _called(names: list[str]) -> str:
    words = (FIELDS.get(name, name.replace("_", " ").removesuffix(" mph").removesuffix(" deg")) for name in names)
    return " ".join(filter(None, words))


def shown(field: str, value: Value) -> str:
    """A value with its unit."""
    if value is True:
        return "yes"
    if value is None:
        return "none"
    if field == "junction.kind" and value in JUNCTION_WORDS:
        return JUNCTION_WORDS[str(value)]
    text = ", ".join(value) if isinstance(value, tuple | list) else str(value).replace("_", " ")
    return text + UNITS.get(field.rpartition("_")[2], "") if "_" in field.rpartition(".")[2] else text


def phrase(field: str, value: Value) -> str:
    """A field and its value in words: "V2 speed 35 mph"."""
    about, name = named(field)
    told = "" if value is True else shown(field, value)
    return " ".join(filter(None, [about.replace("_", " "), name, told]))
