"""One case in words: its first contact, what of the report the scenario lacks, and what was assumed.

Pure functions on the content of result.json; knows no file.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from sgcad_core.account import Disagreement
from sgcad_core.account.records import is_of_map
from sgcad_core.case.verdict_told import verdict_sentence
from sgcad_core.result import as_declared, counts_of

MAX_LINES = 12
"""Of notes, and of what is lacking or assumed; all of it stands in result.json."""
_BESIDE = (("unread", "unread"), ("contradicts itself", "contradicts"), ("guessed", "guessed"))


def lines(results: Sequence[Mapping[str, Any]]) -> list[str]:
    """Lines about the case of a batch of one; empty for larger batches."""
    if len(results) != 1 or results[0]["status"] != "generated":
        return []
    result = results[0]
    told = [contact(result)] if result["collision"]["declared"] or result["collision"]["observed"] else []
    near = [approach(result["near_crash"])] if result.get("near_crash") else []
    return [
        *told,
        *near,
        *account_lines(result),
        *disagreement_lines(result),
        *([result["place"]["sentence"]] if result.get("place") else []),
        *traffic_lines(result),
        *(f"note: {note['text']}" for note in [n for n in result["notes"] if n["kind"] != "place"][:MAX_LINES]),
    ]


def account_lines(result: Mapping[str, Any]) -> list[str]:
    """Lines on what the scenario has and lacks of what the report tells, and what was assumed."""
    account = counts_of(result)
    if account is None:
        return []
    found = [said] if (said := verdict_sentence(result)) else []
    found += [
        f"told {account['told']}, has {account['has']}, lacking {account['lacking']}, assumed {account['assumed']}"
    ]
    found += [f"lacking: {line}" for line in _lines(account, "lacks")[:MAX_LINES]]
    found += [f"{name}: {line}" for name, kind in _BESIDE for line in _lines(account, kind)[:MAX_LINES]]
    against = [item for item in account["items"] if item["kind"] == "contradicts" and is_of_map(item["field"])]
    found += [f"against the map: {item['text']} ({item['reason']})" for item in against]
    assumed = _lines(account, "assumed")
    more = f"; and {len(assumed) - MAX_LINES} more" if len(assumed) > MAX_LINES else ""
    return found + ([f"assumed: {'; '.join(assumed[:MAX_LINES])}{more}"] if assumed else [])


def disagreement_lines(result: Mapping[str, Any]) -> list[str]:
    """Lines on what two readers of the report read differently."""
    found = result.get("disagreements") or ()
    lines = [f"readers differ: {Disagreement.model_validate(one).line()}" for one in found[:MAX_LINES]]
    return lines + ([f"readers differ about {len(found) - MAX_LINES} more"] if len(found) > MAX_LINES else [])


def traffic_lines(result: Mapping[str, Any]) -> list[str]:
    """A line on the traffic around the crash: how many vehicles, and why others were left out; none without traffic."""
    told = result.get("traffic")
    if not told:
        return []
    if lacks := told.get("lacks"):
        return [f"traffic: none ({lacks})"]
    beside = [f"{count} {why}" for why, count in told["removed"].items()]
    more = [f"left out: {', '.join(beside)}"] if beside else []
    more += [f"{told['moved']} began elsewhere to keep clear"] if told["moved"] else []
    placed = (
        f"traffic: {len(told['vehicles'])} vehicles, {told['density']} ({told['per_km_and_lane']:g} per km and lane)"
    )
    return ["; ".join([placed, *more, *told["notes"]])]


def lacking_counted(account: Mapping[str, Any] | None) -> str:
    """How many of the things told lack; "" if none does."""
    return f"{account['lacking']} of {account['told']} told lacking" if account and account["lacking"] else ""


def lacking_in_words(account: Mapping[str, Any], most: int) -> str:
    """The first things that the scenario lacks, in one line."""
    lines = _lines(account, "lacks")
    return "; ".join(lines[:most]) + (f"; and {len(lines) - most} more" if len(lines) > most else "")


def _lines(account: Mapping[str, Any], kind: str) -> list[str]:
    items = [item for item in account["items"] if item["kind"] == kind]
    items = [item for item in items if kind != "contradicts" or not is_of_map(item["field"])]
    if kind == "assumed":
        return [item["text"] for item in items]
    return [f"{item['text']} ({item['reason']})" if item["reason"] else item["text"] for item in items]


def contact(result: Mapping[str, Any]) -> str:
    """The observed first contact, compared with the declared one."""
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
    """The closest approach of a near crash, compared with the declared one."""
    seen, declared = near["observed"], near["declared"]
    if not seen:
        return "a near crash is told; no other actor is near"
    basis = "as the report tells" if declared["clearance_basis"] == "told" else "the usual distance of a near crash"
    wanted = basis if near["realised"] else f"{declared['clearance_m']:.1f} m was wanted"
    return f"no contact: {seen['actor']} and {seen['other']} come to {seen['clearance_m']:.1f} m, {wanted}"


def _declared(told: Mapping[str, Any]) -> str:
    return f"the {told['striker_area']} of {told['striker']} hits the {told['struck_area']} of {told['struck']}"


def state_words(result: Mapping[str, Any]) -> str:
    """The status of a result, and whether its contact is the declared one."""
    if result["status"] != "generated":
        return f"{result['status']} ({result['reason']})"
    if (declared := as_declared(result)) is None:
        return "generated but there is neither a contact nor a near crash"
    return "generated as declared" if declared else "generated but not as declared"
