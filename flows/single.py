"""One case in words: who hits whom on which sides and when, whether the report declares it so, and what was assumed.

Pure functions on the content of result.json; knows no file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

MAX_ASSUMED = 12
FIELDS = {"start_speed_mph": "speed", "exit_road": "leaves by", "start_lane": "lane", "final_speed_mph": "last speed"}
"""What some fields are called for people; the others by their own names."""
UNITS = {"start_speed_mph": " mph", "final_speed_mph": " mph", "speed_limit_mph": " mph"}


def lines(results: Sequence[Mapping[str, Any]]) -> list[str]:
    """What to tell of a batch of one case; nothing of others."""
    if len(results) != 1 or results[0]["status"] != "generated":
        return []
    result = results[0]
    told = [contact(result)] if result["collision"]["declared"] or result["collision"]["observed"] else []
    near = [approach(result["near_crash"])] if result.get("near_crash") else []
    return [*told, *near, *(f"note: {note}" for note in result["notes"][:MAX_ASSUMED]), *assumed(result["facts"])]


def contact(result: Mapping[str, Any]) -> str:
    """The first contact as observed, and how it stands to the declared one."""
    seen, told = result["collision"]["observed"], result["collision"]["declared"]
    if not seen:
        return f"no contact happens; the report tells that {_declared(told)}"
    if told and told["striker"] == seen["other"]:  # told from the striker's side, as the report does
        seen = {"actor": seen["other"], "actor_area": seen["other_area"], "other": seen["actor"],
                "other_area": seen["actor_area"], "t_s": seen["t_s"]}  # fmt: skip
    met = f"the {seen['actor_area']} of {seen['actor']} hits the {seen['other_area']} of {seen['other']}"
    told_so = ", as the report tells" if result["collision"]["realised"] else ""
    other = f"; the report tells that {_declared(told)}" if told and not told_so else ""
    return f"at {seen['t_s']:.1f} s {met}{told_so}{other}"


def approach(near: Mapping[str, Any]) -> str:
    """How near both come in a near crash, and whether that is what was declared."""
    seen, declared = near["observed"], near["declared"]
    if not seen:
        return "a near crash is told; nobody else is near"
    basis = "as the report tells" if declared["clearance_basis"] == "told" else "the usual distance of a near crash"
    wanted = basis if near["realised"] else f"{declared['clearance_m']:.1f} m was wanted"
    return f"nobody touches: {seen['actor']} and {seen['other']} come to {seen['clearance_m']:.1f} m, {wanted}"


def _declared(told: Mapping[str, Any]) -> str:
    return f"the {told['striker_area']} of {told['striker']} hits the {told['struck_area']} of {told['struck']}"


def assumed(facts: Sequence[Mapping[str, Any]]) -> list[str]:
    """What neither the text nor a drawing nor a model told: the values that were taken instead."""
    found = [_fact(fact) for fact in facts if fact["basis"] == "default"]
    if not found:
        return []
    more = f"; and {len(found) - MAX_ASSUMED} more" if len(found) > MAX_ASSUMED else ""
    return [f"assumed, since the report does not tell: {'; '.join(found[:MAX_ASSUMED])}{more}"]


def _fact(fact: Mapping[str, Any]) -> str:
    *owner, name = str(fact["field"]).split(".")
    about = owner[-1] if owner else ""
    value = str(fact["value"]).replace("_", " ")
    return " ".join(filter(None, [about, FIELDS.get(name, name.replace("_", " ")), value])) + UNITS.get(name, "")
