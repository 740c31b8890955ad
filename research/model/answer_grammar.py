"""The two answers as walks: one definition of their JSON serves to write targets and to decode freely.

A walk is a generator. It yields `Force(text)` where the JSON leaves no choice and `Pick(options, path)` where
it does, and is sent the option taken. Joined, the texts are the compact JSON of `RoadLayout`, `BehaviorSpec`
or `Refusal` with every key in field order. Knows no tokens, no model and no pydantic.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Generator
from dataclasses import dataclass
from typing import Any

from sgcad_core.kinds import MANEUVERS as MANEUVERS
from sgcad_core.kinds import ROADS, learned_actors

Path = tuple[Any, ...]

COMPASS = ("N", "NE", "E", "SE", "S", "SW", "W", "NW")
TURNS = ("left", "through", "right", "left_through", "through_right", "left_right", "any")
MEDIANS = ("none", "painted", "raised", "grass", "barrier")
KINDS = learned_actors()
AREAS = ("front", "back", "left", "right")
LIGHTS = ("day", "dusk", "dawn", "dark", "dark_lit")
WEATHERS = ("clear", "cloudy", "rain", "snow", "sleet", "fog")
SURFACES = ("dry", "wet", "snow", "ice")
CONTROLS = ("none", "signal", "flashing", "stop", "yield")
ACTOR_IDS = ("V1", "V2", "V3", "V4", "V5", "P1", "B1", "T1", "O1", "O2")
REASONS = (
    "the evidence does not tell the road",
    "the evidence does not tell the crash",
    "the evidence contradicts itself",
)
MISSING = ("road layout", "lanes", "directions of travel", "first contact")
MAX_LEGS, MAX_ACCESSES, MAX_ACTORS, MAX_CONTACTS = 6, 2, 5, 3


@dataclass(frozen=True)
class Force:
    """Text without a choice."""

    text: str


@dataclass(frozen=True)
class Pick:
    """A choice among JSON texts, at a path of the answer."""

    options: tuple[str, ...]
    path: Path


Walk = Generator[Force | Pick, str | None, None]


def quoted(words: tuple[str, ...]) -> tuple[str, ...]:
    """JSON strings."""
    return tuple(f'"{word}"' for word in words)


def numbers(low: int, high: int) -> tuple[str, ...]:
    """JSON integers."""
    return tuple(str(n) for n in range(low, high + 1))


NULL = ("null",)
BOOL = ("false", "true")


def field(key: str, options: tuple[str, ...], path: Path) -> Walk:
    """`,"key":` and its value."""
    yield Force(f',"{key}":')
    yield Pick(options, (*path, key))


def road_walk() -> Walk:
    """RoadLayout, or a refusal."""
    first = yield Pick(('{"legs":[{"bearing":', '{"refuse":'), ("refuse",))
    if first == '{"refuse":':
        yield from refusal_walk()
        return
    for index in range(MAX_LEGS):
        path = ("legs", index)
        yield Pick(quoted(COMPASS), (*path, "bearing"))
        yield from _leg_walk(path)
        more, end = '},{"bearing":', '}],"accesses":['
        options = (more,) if index == 0 else (end,) if index == MAX_LEGS - 1 else (more, end)
        if (yield Pick(options, (*path, "more"))) == end:
            break
    for index in range(MAX_ACCESSES + 1):
        more, end = (',{"leg":' if index else '{"leg":'), "]}"
        options = (more, end) if index < MAX_ACCESSES else (end,)
        if (yield Pick(options, ("accesses", index, "more"))) == end:
            break
        yield from _access_walk(("accesses", index))


def _leg_walk(path: Path) -> Walk:
    yield from field("lanes_in", numbers(0, 8), path)
    yield from field("lanes_out", numbers(0, 8), path)
    yield Force(',"turns_in":[')
    yield from _turns_walk((*path, "turns_in"))
    yield Pick(BOOL, (*path, "center_turn_lane"))
    yield from field("median", quoted(MEDIANS), path)
    yield from field("kind", quoted(ROADS), path)
    yield from field("control", quoted(CONTROLS), path)
    yield from field("curve", quoted(("none", "left", "right")), path)
    yield from field("speed_limit_mph", NULL + numbers(5, 85), path)


def _turns_walk(path: Path) -> Walk:
    end = '],"center_turn_lane":'
    first = yield Pick((*quoted(TURNS), end), (*path, 0))
    index = 1
    while first != end:
        if (yield Pick((",", end) if index < 8 else (end,), (*path, index, "more"))) == end:
            return
        yield Pick(quoted(TURNS), (*path, index))
        index += 1


def _access_walk(path: Path) -> Walk:
    yield Pick(quoted(COMPASS), (*path, "leg"))
    yield from field("side", quoted(("left", "right", "both")), path)
    yield from field("distance_m", tuple(f"{n}.0" for n in (20, 30, 40, 60, 80)), path)
    yield from field("kind", quoted(ROADS), path)
    yield from field("lanes_in", numbers(0, 8), path)
    yield from field("lanes_out", numbers(0, 8), path)
    yield from field("control", quoted(("none", "signal", "stop", "yield")), path)
    yield Force("}")


def behavior_walk(road_ids: tuple[str, ...]) -> Walk:
    """BehaviorSpec on the roads of a layout, or a refusal."""
    first = yield Pick(('{"actors":[{"id":', '{"refuse":'), ("refuse",))
    if first == '{"refuse":':
        yield from refusal_walk()
        return
    ids: list[str] = []
    for index in range(MAX_ACTORS):
        path = ("actors", index)
        ids.append((yield Pick(tuple(o for o in quoted(ACTOR_IDS) if o not in ids), (*path, "id"))) or "")
        yield from _actor_walk(path, road_ids)
        more, end = '},{"id":', '}],"contacts":['
        if (yield Pick((more, end) if index < MAX_ACTORS - 1 else (end,), (*path, "more"))) == end:
            break
    yield from _contacts_walk(tuple(ids))
    yield Pick(NULL + quoted(LIGHTS), ("light",))
    yield from field("weather", NULL + quoted(WEATHERS), ())
    yield from field("surface", NULL + quoted(SURFACES), ())
    yield Force("}")


def _actor_walk(path: Path, road_ids: tuple[str, ...]) -> Walk:
    yield from field("kind", quoted(KINDS), path)
    yield from field("road", quoted(road_ids), path)
    yield from field("direction", quoted(("forward", "backward")), path)
    yield from field("lane", NULL + numbers(1, 8), path)
    yield from field("exit_road", NULL + quoted(road_ids), path)
    yield from field("maneuver", quoted(MANEUVERS), path)
    yield from field("speed_mph", NULL + numbers(0, 99), path)
    yield from field("length_m", NULL, path)
    yield from field("width_m", NULL, path)


def _contacts_walk(ids: tuple[str, ...]) -> Walk:
    for index in range(MAX_CONTACTS + 1):
        path = ("contacts", index)
        more, end = ('},{"striker":', '}],"light":') if index else ('{"striker":', '],"light":')
        possible = index < MAX_CONTACTS and len(ids) > 1
        if (yield Pick((more, end) if possible else (end,), (*path, "more"))) == end:
            return
        striker = yield Pick(ids, (*path, "striker"))
        yield from field("struck", tuple(i for i in ids if i != striker), path)
        yield from field("striker_area", quoted(AREAS), path)
        yield from field("struck_area", quoted(AREAS), path)


def refusal_walk() -> Walk:
    """Refusal behind its opening."""
    yield Pick(quoted(REASONS), ("reason",))
    yield Force(',"missing":[')
    index = 0
    for index in range(len(MISSING)):
        if (yield Pick((*quoted(MISSING), "]}") if not index else (",", "]}"), ("missing", index, "more"))) == "]}":
            return
        if index:
            yield Pick(quoted(MISSING), ("missing", index))
    yield Force("]}")


# ------------------------------------------------------------------ driving a walk
Piece = tuple[str, Pick | None]


def drive(walk: Walk, choose: Callable[[Pick], str]) -> list[Piece]:
    """Run a walk to its end; pieces of text, with the pick where there was one."""
    pieces: list[Piece] = []
    sent: str | None = None
    while True:
        try:
            step = walk.send(sent)
        except StopIteration:
            return pieces
        if isinstance(step, Force):
            pieces.append((step.text, None))
            sent = None
        else:
            sent = choose(step)
            pieces.append((sent, step))


def write(walk: Walk, answer: Any) -> list[Piece]:
    """The pieces of a given answer (plain JSON data with all keys). Raises ValueError if it does not fit."""
    text = json.dumps(answer, separators=(",", ":"))
    pieces: list[Piece] = []
    sent, at = None, 0
    while True:
        try:
            step = walk.send(sent)
        except StopIteration:
            break
        sent = None if isinstance(step, Force) else _fitting(step, text, at)
        pieces.append((sent, step) if isinstance(step, Pick) and sent is not None else (step.text, None))  # type: ignore[union-attr]
        at += len(pieces[-1][0])
    if "".join(p for p, _ in pieces) != text:
        raise ValueError(f"answer and walk differ: {text[:80]!r}")
    return pieces


def _fitting(pick: Pick, text: str, at: int) -> str:
    fits = [option for option in pick.options if text.startswith(option, at)]
    if not fits:
        raise ValueError(f"answer does not fit at {pick.path}: {text[at : at + 40]!r}; options {pick.options[:6]}")
    return max(fits, key=len)
