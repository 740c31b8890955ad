"""One line of the list of cases, from the content of a result.json of any version."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Literal

from sgcad_core.kinds import ACTORS, JUNCTIONS, kind_of_letter
from sgcad_core.result import as_declared

Trust = Literal["broken", "lacking", "doubtful", "refused", "whole"]
"""State of a case: no usable scenario; something told is missing; complete, with doubts; the report carries no
scenario; no known fault."""
TRUSTS: tuple[Trust, ...] = ("broken", "lacking", "doubtful", "refused", "whole")
"""In the order in which a person should look."""
UNREADABLE = "unreadable"
"""Status of a case whose result.json cannot be read (half written, or foreign)."""
READERS = ("text", "diagram", "coded", "model", "person")
"""Bases of facts that can disagree with each other; `default` never tells anything."""
_WALKERS = {"P": "pedestrian", "B": "cyclist", "A": "animal", "O": "object"}
_PLACES = {record.kind: record.called for record in JUNCTIONS}
_TURNS = ("turn_left", "turn_right", "u_turn")


@dataclass(frozen=True, slots=True)
class Row:
    """One case in the list. `key`: its folder, relative to the results folder. Counts are of result.json's account."""

    key: str
    config: str
    case: str
    status: str
    trust: Trust
    kind: str = ""
    place: str = ""
    confidence: float | None = None
    """Mean confidence of the facts that were taken, of [0, 1]; None where there is none."""
    told: int = 0
    lacking: int = 0
    assumed: int = 0
    doubts: int = 0
    disagreeing: int = 0
    """Fields of which two readers (text, drawing, coded fields, model) say different things."""
    accounted: bool = False
    """Whether the result has an account; results of older versions have none."""
    mended: int = 0
    """Facts that a person gave."""
    contact: str = ""
    reason: str = ""
    seconds: float = 0.0


def row_of(key: str, result: Mapping[str, Any]) -> Row:
    """The row of a result. Raises TypeError, ValueError, KeyError, AttributeError for what is no result."""
    facts, account = list(result.get("facts") or ()), account_counts(result)
    disagreeing = len({*disagreements(facts), *(one["field"] for one in result.get("disagreements") or ())})
    doubts = len(doubts_of(result))
    status = str(result["status"])
    return Row(
        key=key, config=key.rpartition("/")[0] or str(result.get("config") or ""),
        case=str(result.get("case") or key.rpartition("/")[2]), status=status,
        trust=_trust(result, account["lacking"], disagreeing + doubts), kind=kind_of(result),
        place=place_of(facts, result), confidence=confidence_of(facts), told=account["told"],
        lacking=account["lacking"], assumed=account["assumed"], accounted=bool(result.get("account")), doubts=doubts,
        disagreeing=disagreeing, mended=len({f["field"] for f in facts if f.get("basis") == "person"}),
        contact=contact_of(result), reason=str(result.get("reason") or ""),
        seconds=float(sum((result.get("seconds") or {}).values())),
    )  # fmt: skip


def unreadable(key: str, why: str) -> Row:
    """The row of a case whose result cannot be read."""
    config, _, case = key.rpartition("/")
    return Row(key=key, config=config, case=case, status=UNREADABLE, trust="broken", reason=why)


def _trust(result: Mapping[str, Any], lacking: int, doubts: int) -> Trust:
    if result["status"] == "refused":
        return "refused"
    if result["status"] != "generated":
        return "broken"
    if lacking or as_declared(result) is False:
        return "lacking"
    whole = (result.get("account") or {}).get("verdict") == "whole"
    return "whole" if whole and not doubts else "doubtful"


# ------------------------------------------------------------------ parts of a result
_OPEN = "no posted speed limit is told"
"""Words of the road writers' note on roads without a told limit; the assumed limit stands in the account."""


def account_counts(result: Mapping[str, Any]) -> dict[str, int]:
    """told, has, lacking, assumed; of results without an account facts are counted, and what lacks is not known."""
    if account := result.get("account"):
        return {name: int(account[name]) for name in ("told", "has", "lacking", "assumed")}
    last = {fact["field"]: fact for fact in result.get("facts") or ()}.values()
    told = sum(fact["status"] == "stated" for fact in last)
    return {"told": told, "has": 0, "lacking": 0, "assumed": sum(fact["basis"] == "default" for fact in last)}


def notes_of(result: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Notes of all steps: {"kind", "field", "subject", "text", ...}; also plain lines of older results."""
    return [dict(note) if isinstance(note, Mapping) else {"kind": "plan", "field": "", "subject": "", "text": str(note)}
            for note in result.get("notes") or ()]  # fmt: skip


def doubts_of(result: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Notes that ask for a look: what a validator remarked, what was held back or lies beyond what is read.

    What the account lists as assumed is no doubt: the player calls such a case right as far as told, too.
    """
    kinds = ("finding", "held", "judge", "limit")
    return [note for note in notes_of(result) if note["kind"] in kinds and _OPEN not in str(note["text"])]


def disagreements(facts: Iterable[Mapping[str, Any]]) -> dict[str, dict[str, Any]]:
    """Fields of which two readers say different things: field -> basis -> value."""
    said: dict[str, dict[str, Any]] = {}
    for fact in facts:
        if fact.get("basis") in READERS:
            said.setdefault(fact["field"], {})[fact["basis"]] = fact["value"]
    return {field: by for field, by in said.items() if len({repr(value) for value in by.values()}) > 1}


def confidence_of(facts: Iterable[Mapping[str, Any]]) -> float | None:
    """Mean confidence of the facts that stand (the last of each field), of [0, 1]."""
    found = [float(fact["confidence"]) for fact in {fact["field"]: fact for fact in facts}.values()]
    return sum(found) / len(found) if found else None


def kind_of(result: Mapping[str, Any]) -> str:
    """Kind of the declared crash in a word or two; "" where none is declared."""
    if near := result.get("near_crash"):
        return f"near crash, {_pair(near['declared']['conflict'], {}, _types(result))}"
    declared = (result.get("collision") or {}).get("declared")
    return _pair(declared, _maneuvers(result), _types(result)) if declared else ""


def _types(result: Mapping[str, Any]) -> dict[str, str]:
    return {actor["id"]: str(actor.get("type", "")) for actor in result.get("actors") or ()}


def _maneuvers(result: Mapping[str, Any]) -> dict[str, str]:
    return {actor["id"]: str(actor["maneuver"]) for actor in result.get("actors") or ()}


def _walker(name: str, kind: str) -> str:
    """The name of an actor without a vehicle: its kind where that is not the usual one of the id's letter."""
    record = ACTORS.get(kind)
    if record is not None and record.letter == name[0] and kind != kind_of_letter(name[0]):
        return record.called.partition(" ")[2]
    return _WALKERS[name[0]]


def _pair(contact: Mapping[str, Any], maneuvers: Mapping[str, str], kinds: Mapping[str, str]) -> str:
    pair = contact["striker"], contact["struck"]
    for name in pair:
        if name[:1] in _WALKERS:
            return _walker(name, kinds.get(name, ""))
    sides = {contact["striker_area"], contact["struck_area"]}
    if sides == {"front", "back"}:
        return "rear-end"
    if sides == {"front"}:
        return "head-on"
    if "front" not in sides:
        return "sideswipe" if sides <= {"left", "right"} else "backing"
    return "angle, turning" if any(maneuvers.get(name) in _TURNS for name in pair) else "angle"


def place_of(facts: Iterable[Mapping[str, Any]], result: Mapping[str, Any]) -> str:
    """Kind of junction as read, else as written; "" without a network."""
    told = [fact["value"] for fact in facts if fact["field"] == "junction.kind"]
    if told:
        return _PLACES.get(told[-1], str(told[-1]).replace("_", " ")).removeprefix("a ")
    network = result.get("network")
    if not network:
        return ""
    return "junction" if network["intersections"] else "road without a junction"


def contact_of(result: Mapping[str, Any]) -> str:
    """The observed first contact, actors and sides, the striker first; "" without contact."""
    collision = result.get("collision") or {}
    seen, declared = collision.get("observed"), collision.get("declared") or {}
    if not seen:
        return ""
    pair = [f"{seen['actor']} {seen['actor_area']}", f"{seen['other']} {seen['other_area']}"]
    return " → ".join(reversed(pair) if declared.get("striker") == seen["other"] else pair)
