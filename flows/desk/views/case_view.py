"""Contents of a case's page beside the map: the report in sentences, facts by thing, the account.

A *thing* is a group of elements that is highlighted together: "V1", "road:main" (a road of the report), "leg:N" (a
road as drawn), "contact", "junction", "conditions".
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from flows.desk.views.attempts import Attempt, attempts_of
from flows.desk.views.field_words import name_of, shown
from flows.desk.views.folder_files import FILES, diagrams_of, is_there, odd_files, text_of
from flows.desk.views.list_rows import account_counts, contact_of, disagreements, doubts_of, notes_of
from flows.player.player_page import told_in
from flows.player.sentence_marks import MARK_WORDS, ToldSentence, sentence_at
from sgcad_core.case.verdict_told import verdict_sentence


@dataclass(frozen=True)
class Piece:
    """A part of the narrative; if it is a sentence with facts, its number and the things it tells of."""

    text: str
    number: int = -1
    things: tuple[str, ...] = ()
    mark: str = ""
    """What the account says against it (`sentence_marks.MARKS`); "read" for nothing."""

    @property
    def marked(self) -> str:
        """The mark in words."""
        return MARK_WORDS.get(self.mark, "")


@dataclass(frozen=True)
class FactRow:
    """One fact as a line. `sentence`: its piece's number or -1; `others`: values of other readers."""

    field: str
    name: str
    value: str
    basis: str
    status: str
    confidence: float
    sentence: int = -1
    others: tuple[tuple[str, str], ...] = ()
    findings: tuple[str, ...] = ()
    edit: str = ""
    """How it can be changed, as JSON for the page's script; "" where it cannot."""


@dataclass(frozen=True)
class Group:
    """The facts of one thing. `remove`: the field that takes it out of the scenario, "" where none does."""

    thing: str
    title: str
    facts: tuple[FactRow, ...]
    remove: str = ""
    findings: tuple[str, ...] = ()
    """Findings of the thing as a whole."""


@dataclass(frozen=True)
class AccountLine:
    """One item of the account: its words, why, the thing and the sentence."""

    text: str
    reason: str
    thing: str
    field: str
    sentence: int


@dataclass(frozen=True)
class CasePage:
    """Everything on the page but map and mending."""

    pieces: tuple[Piece, ...]
    groups: tuple[Group, ...]
    counts: Mapping[str, int]
    account: Mapping[str, Sequence[AccountLine]]
    notes: tuple[AccountLine, ...]
    attempts: tuple[Attempt, ...]
    diagrams: int
    files: tuple[tuple[str, str], ...]
    player: bool
    verdict: str
    accounted: bool
    """Whether the result has an account; results of older versions have none."""
    odd: tuple[str, ...]
    """What lies in the folder and is not shown, with the reason."""
    result: Mapping[str, Any] = field(repr=False)


def page_of(folder: Path, result: Mapping[str, Any]) -> CasePage:
    """Read a case's folder. What is missing in it is left out."""
    facts = list(result.get("facts") or ())
    told = told_in(text_of(folder, "player.html"), result)
    pieces, sentences = pieces_of(text_of(folder, "report.txt"), told)
    return CasePage(
        pieces=pieces, groups=tuple(groups_of(facts, sentences, doubts_of(result))), counts=account_counts(result),
        account=account_of(result, sentences), notes=tuple(_note(note, sentences) for note in notes_of(result)),
        attempts=tuple(attempts_of(folder)), diagrams=len(diagrams_of(folder)),
        files=tuple((name, about) for name, about in FILES.items() if is_there(folder, name)),
        player=is_there(folder, "player.html"), verdict=verdict_of(result),
        accounted=bool(result.get("account")), odd=tuple(odd_files(folder)), result=result,
    )  # fmt: skip


def verdict_of(result: Mapping[str, Any]) -> str:
    """The result in a line: the reason, the verdict of its account, or of an older result the contact."""
    if result["status"] != "generated":
        return str(result.get("reason") or result["status"])
    if said := verdict_sentence(result):
        return f"{said[0].upper()}{said[1:]}"
    collision, near = result.get("collision") or {}, result.get("near_crash")
    if near:
        return f"near crash, {'as declared' if near['realised'] else 'not as declared'}"
    if not collision.get("declared"):
        return "no contact is declared"
    seen = contact_of(result) or "no contact"
    return f"{seen}, {'as declared' if collision['realised'] else 'not as declared'}"


# ------------------------------------------------------------------ the report
def pieces_of(narrative: str, told: Iterable[ToldSentence]) -> tuple[tuple[Piece, ...], list[ToldSentence]]:
    """The narrative cut into its sentences and what stands between, and the sentences that are numbered so."""
    pieces, kept, at = list[Piece](), list[ToldSentence](), 0
    for one in (t for t in told if t.end <= len(narrative)):
        pieces += [Piece(narrative[at : one.start])] if one.start > at else []
        things = dict.fromkeys(thing for field in one.fields if (thing := thing_of(field)))
        pieces.append(Piece(narrative[one.start : one.end], len(kept), tuple(things), one.mark))
        kept.append(one)
        at = one.end
    return (*pieces, Piece(narrative[at:])), kept


# ------------------------------------------------------------------ facts
def thing_of(name: str) -> str:
    """The thing that a field tells of; "" of what lights nothing up."""
    group, _, rest = name.partition(".")
    owner = rest.split(".")[0]
    if group in ("vehicles", "others", "rest", "course"):
        return owner
    if group == "roads":
        return f"road:{owner}" if owner[:1].islower() else f"leg:{owner}"
    if group in ("contacts", "near_crash", "impacts"):
        return "contact"
    return group if group in ("junction", "conditions") else ""


def title_of(thing: str) -> str:
    """A thing's name for people."""
    kind, _, name = thing.partition(":")
    titles = {"road": f"Road told: {name}", "leg": f"Road {name}", "contact": "Contact", "": "Other"}
    return titles.get(kind, kind.capitalize() if kind[1:2].isalpha() else kind)


def order_of(thing: str) -> tuple[int, str]:
    """Sort key of a thing: contact, actors, junction, roads, the rest."""
    kind = thing.partition(":")[0]
    order = {"contact": 0, "junction": 2, "leg": 3, "road": 4, "conditions": 5, "": 6}
    return order.get(kind, 1), thing


def groups_of(
    facts: Sequence[Mapping[str, Any]], told: Sequence[ToldSentence], doubts: Sequence[Mapping[str, Any]] = ()
) -> Iterator[Group]:
    """Facts by thing, actors and contact first; of each field the last fact, with what other readers say of it."""
    disagree, found = disagreements(facts), dict[str, list[FactRow]]()
    for fact in {fact["field"]: fact for fact in facts}.values():
        row = _fact(fact, told, disagree.get(fact["field"], {}), doubts)
        found.setdefault(thing_of(fact["field"]), []).append(row)
    for thing in sorted(found, key=order_of):
        yield Group(thing, title_of(thing), tuple(found[thing]))


def _fact(
    fact: Mapping[str, Any], told: Sequence[ToldSentence], said: Mapping[str, Any], doubts: Sequence[Mapping[str, Any]]
) -> FactRow:
    name = str(fact["field"])
    others = ((basis, shown(name, value)) for basis, value in said.items() if basis != fact["basis"])
    return FactRow(
        field=name, name=name_of(name), value=shown(name, fact["value"]), basis=str(fact["basis"]),
        status=str(fact["status"]), confidence=float(fact["confidence"]), sentence=sentence_at(told, fact.get("start")),
        others=tuple(others), findings=tuple(str(d["text"]) for d in doubts if d.get("field") == name),
    )  # fmt: skip


# ------------------------------------------------------------------ account, notes
def account_of(result: Mapping[str, Any], told: Sequence[ToldSentence]) -> dict[str, list[AccountLine]]:
    """lacks, assumed, has: the account's items; of results without one, defaults are what is assumed."""
    kinds = "lacks", "unread", "contradicts", "guessed", "assumed", "has"
    found: dict[str, list[AccountLine]] = {kind: [] for kind in kinds}
    items = (result.get("account") or {}).get("items")
    for item in items if items is not None else _items_of_facts(result.get("facts") or ()):
        found.setdefault(item["kind"], []).append(_line(item, told))
    return found


def _items_of_facts(facts: Iterable[Mapping[str, Any]]) -> Iterator[dict[str, Any]]:
    for fact in {fact["field"]: fact for fact in facts}.values():
        if fact["basis"] == "default":
            owner = fact["field"].split(".")[1] if fact["field"].count(".") > 1 else ""
            text = f"{owner} {name_of(fact['field'])} {shown(fact['field'], fact['value'])}".strip()
            yield {"kind": "assumed", "field": fact["field"], "text": text, "reason": "not told", "start": None}


def _line(item: Mapping[str, Any], told: Sequence[ToldSentence]) -> AccountLine:
    return AccountLine(
        str(item["text"]), str(item.get("reason") or ""), thing_of(str(item.get("field") or "")),
        str(item.get("field") or ""), sentence_at(told, item.get("start")),
    )  # fmt: skip


def _note(note: Mapping[str, Any], told: Sequence[ToldSentence]) -> AccountLine:
    thing = thing_of(str(note.get("field") or "")) or str(note.get("subject") or "")
    return AccountLine(str(note["text"]), str(note["kind"]), thing, str(note.get("field") or ""),
                       sentence_at(told, note.get("start")))  # fmt: skip
