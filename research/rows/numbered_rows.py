"""Coded narratives of numbered reports as rows for the learned reader: hashes of features, the rules' answers, what the
codes allow.

A line of a pool has a `text` and codes: `network`, `vehicles`, `events` (research/benchmarks/texts/coded_cases.py holds
them against a reading). Rows hold no word of a text.
"""

from __future__ import annotations

import gzip
import json
import random
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from research.rows.coded_incidents import by_hash
from sgcad_core.reading.reading import Reading
from sgcad_core.reading.second_reader.field_claims import kind_of
from sgcad_core.reading.second_reader.learned_reader import hashed
from sgcad_core.reading.second_reader.learned_reader_features import Account, account_of
from sgcad_core.reading.second_reader.numbered.numbered_answers import first_contact, same
from sgcad_core.reading.second_reader.numbered.numbered_questions import Question, questions

APART_OF = 10
"""Of so many reports that are not blind one teaches the judge alone."""
_SHIFTS = ("lane_change_left", "lane_change_right")
_DRIVES = ("straight", *_SHIFTS)
_MANEUVERS: Mapping[str, tuple[str, ...]] = {
    "straight": _DRIVES, "negotiating_curve": (*_DRIVES, "turn_left", "turn_right"), "stopped": ("stopped",),
    "parked": ("stopped",), "turn_left": ("turn_left",), "turn_right": ("turn_right",), "backing": ("backing",),
    "u_turn": ("u_turn", "turn_left"), "lane_change": _SHIFTS, "lane_change_left": _SHIFTS[:1],
    "lane_change_right": _SHIFTS[1:], "crossing_centreline": _SHIFTS[:1],
}  # fmt: skip
"""Code -> answers that fit it, the one to be taught first."""
_NO_THING = {"rollover", "jackknife", "noncollision", "ground", "fell_out", "own_trailer", "occupant", None}
_TERRAIN = {"curb", "ditch", "embankment"}
_SIDES = {"front", "back", "left", "right"}
_PEOPLE = {"pedestrian", "bicycle", "nonmotorist"}


class Row(NamedTuple):
    """A question with the answers that the codes allow; `part`: taught, apart or blind."""

    id: str
    part: str
    field: str
    words: NDArray[np.uint32]
    readings: NDArray[np.uint32]
    rule: str | None
    told: float
    allowed: tuple[str, ...]
    may: tuple[str, ...] | None = None

    @property
    def target(self) -> tuple[str, ...]:
        """What is to be taught: the rules' own answer where the text tells it and codes allow it, else the code's."""
        own = tuple(answer for answer in self.allowed if same(answer, self.rule))
        return own if own and self.told == 1.0 else self.allowed if kind_of(self.field) == "lanes" else self.allowed[:1]

    def right(self, answer: str) -> bool:
        """Whether an answer is one that the codes allow."""
        return answer in self.allowed

    @property
    def rules_right(self) -> bool:
        """Whether the rules' own answer is."""
        return any(same(answer, self.rule) for answer in self.allowed)


def lines_of(pool: Path) -> Iterator[dict[str, Any]]:
    """The lines of a pool."""
    opened = gzip.open if pool.suffix == ".gz" else open
    with opened(pool, "rt", encoding="utf-8") as file:
        yield from (json.loads(line) for line in file if line.strip())


def drawn_lines(pool: Path, limit: int | None) -> list[dict[str, Any]]:
    """The lines of a pool, or so many drawn from all of its parts."""
    lines = list(lines_of(pool))
    return lines if limit is None or limit >= len(lines) else random.Random(0).sample(lines, limit)


def part_of(case: Mapping[str, Any]) -> str:
    """Which part a line belongs to."""
    if case.get("blind"):
        return "blind"
    return "taught" if by_hash(f"apart {case['id']}") % APART_OF else "apart"


def rows_of(case: Mapping[str, Any]) -> list[Row]:
    """The questions of a line that its codes answer."""
    return rows_of_account(case, account_of(case["text"]))


def rows_of_account(case: Mapping[str, Any], account: Account) -> list[Row]:
    """The same where its text has been read."""
    codes = codes_of(case, account.reading)
    return [_row(case, one, codes[one.field]) for one in questions(account) if one.field in codes]


def _row(case: Mapping[str, Any], one: Question, allowed: tuple[str, ...]) -> Row:
    seen = hashed(one.words), hashed(one.readings)
    return Row(case["id"], part_of(case), one.field, *seen, one.rule, one.told, allowed, one.may)


def save(rows: Sequence[Row], file: Path) -> None:
    """Rows in a file of arrays."""
    about = [(one.id, one.part, one.field, one.rule, one.told, one.allowed, one.may) for one in rows]
    arrays = {"about": np.frombuffer(json.dumps(about).encode(), dtype=np.uint8)}
    for name in ("words", "readings"):
        some = [getattr(one, name) for one in rows]
        arrays |= {name: np.concatenate(some), f"{name}_ends": np.cumsum([len(one) for one in some])}
    with file.open("wb") as out:
        np.savez(out, **arrays)  # type: ignore[arg-type]


def load(file: Path) -> list[Row]:
    """The rows of a file."""
    with np.load(file) as kept:
        arrays = dict(kept)
    words, readings = (np.split(arrays[name], arrays[f"{name}_ends"][:-1]) for name in ("words", "readings"))
    about = json.loads(arrays["about"].tobytes())
    return [
        Row(id, part, field, said, seen, rule, told, tuple(allowed), None if may is None else tuple(may))
        for (id, part, field, rule, told, allowed, may), said, seen in zip(about, words, readings, strict=True)
    ]


# ------------------------------------------------------------------ codes
def codes_of(case: Mapping[str, Any], reading: Reading) -> dict[str, tuple[str, ...]]:
    """What the codes allow, by field; sides only where the rules' first contact is the coded one."""
    network = case["network"]
    found = {f"maneuver.{v['id']}": _MANEUVERS[v["manoeuvre_resolved"]] for v in case["vehicles"]
             if v["told"] and v["manoeuvre_resolved"] in _MANEUVERS}  # fmt: skip
    if network["intersections"] is not None and network["told"]["intersection"]:
        found["junction"] = ("yes" if network["intersections"] else "no",)
    turn = network["relative_heading_v2_minus_v1"]
    if turn is not None and not any("heading" in one for one in case.get("code_conflicts") or ()):
        found["turned.V2"] = (str(turn),)
    found |= {f"lanes.{road['vehicle']}": _lanes(road) for road in network["roads"] if lanes_told(road)}
    return found | dict(_events(case, reading))


def lanes_told(road: Mapping[str, Any]) -> bool:
    """Whether the text gives the road the coded number, or that of both halves of a divided one."""
    told, coded = road["lanes_from_text"], road["lanes_total"]
    return bool(told and coded) and (told == coded or (road["flow"].startswith("divided") and told == 2 * coded))


def _lanes(road: Mapping[str, Any]) -> tuple[str, ...]:
    scope = "both" if road["lanes_scope"] == "both_directions" else "own"
    without = [f"{scope}{road['lanes_total'] - 1}"] if road["twltl"] else []
    return (f"{scope}{road['lanes_total']}", *without)


def _events(case: Mapping[str, Any], reading: Reading) -> Iterator[tuple[str, tuple[str, ...]]]:
    told = [e for e in case["events"] if e["kind"] == "collision" and e["other"] not in _NO_THING | _TERRAIN]
    told = [e for e in told if e["other"] != e["actor"]]
    for v in case["vehicles"]:
        mine = next((e for e in told if v["id"] in (e["actor"], e["other"])), None)
        if v["told"]:
            yield f"met.{v['id']}", (_met(mine["other"]) if mine else "none",)
    first = first_contact(reading.crash)
    if not told or first is None:
        return
    sides = {told[0]["actor"]: told[0]["actor_area"], told[0]["other"]: told[0]["other_area"]}
    if {one for one in sides if one.startswith("V")} == {v for v in (first.striker, first.struck) if v.startswith("V")}:
        yield from ((f"area.{who}", (side,)) for who, side in sides.items() if side in _SIDES and who.startswith("V"))


def _met(other: str) -> str:
    if other.startswith("V"):
        return "vehicle"
    return "animal" if other == "animal" else "person" if other in _PEOPLE else "thing"
