"""Tags: what a place in the evidence tells, as labels that train the reading itself.

Answers alone teach slowly: one value of a long answer must find, through all layers, the one clause or the one
spot of the drawing that tells it. While training, small heads that are thrown away afterwards also ask at the
end of every sentence which facts it told, behind every noted phrase (`notes`) what it tells by itself, and at
every token of a drawing what is drawn there. Knows reports; knows no tokens and no model.
"""

from __future__ import annotations

from collections.abc import Set
from typing import Any

from research.generator.crash.compass_ties import FROM_LEFT, STEM, VAGUE, driven, lanes_beside, led_to
from research.generator.crash.world import Actor, Crash, Leg
from research.generator.grammar import HINT
from research.generator.phrase_notes import IDS
from research.model.answer_grammar import AREAS, CONTROLS, KINDS, LIGHTS, MANEUVERS, MEDIANS, SURFACES, TURNS, WEATHERS
from sgcad_core.kinds import FOUR, PLAIN, ROADS

BEARINGS = range(8)
LANES = range(6)
POSES = ("before", "contact", "after")
CURVES = ("left", "right")


def _text_tags() -> dict[str, int]:
    names = [f"{i}.heading={b}" for i in IDS for b in BEARINGS]
    names += [f"{i}.maneuver={m}" for i in IDS for m in MANEUVERS]
    names += [f"{i}.lane={n}" for i in IDS for n in range(1, 6)]
    names += [f"{i}.kind={k}" for i in IDS for k in KINDS]
    names += [f"{i}.speed={s}" for i in IDS for s in range(0, 100, 5)]
    names += [f"leg={b}" for b in BEARINGS]
    names += [f"leg{b}.{way}={n}" for b in BEARINGS for way in ("in", "out") for n in LANES]
    names += [f"leg{b}.use={t}" for b in BEARINGS for t in TURNS]
    names += [f"leg{b}.control={c}" for b in BEARINGS for c in CONTROLS]
    names += [f"leg{b}.curve={c}" for b in BEARINGS for c in CURVES]
    names += [f"axis{a}.median={m}" for a in range(4) for m in MEDIANS]
    names += [f"axis{a}.limit={n}" for a in range(4) for n in range(5, 90, 5)]
    names += [f"axis{a}.center" for a in range(4)]
    names += [f"contact{k}.{who}={i}" for k in (0, 1) for who in ("striker", "struck") for i in IDS]
    names += [f"contact{k}.{who}_area={a}" for k in (0, 1) for who in ("striker", "struck") for a in AREAS]
    conditions = {"light": LIGHTS, "weather": WEATHERS, "surface": SURFACES}
    names += [f"{key}={value}" for key, values in conditions.items() for value in values]
    names += [f"access.leg={b}" for b in BEARINGS] + [f"access.side={s}" for s in ("left", "right", "both")]
    names += [f"~named{place}={i}" for place in (0, 1) for i in IDS] + [f"~voice={v}" for v in ("active", "passive")]
    return {name: i for i, name in enumerate(names)}


_OF_DRAWN = (
    *(f"{key}={b}" for key in ("heading", "faces") for b in BEARINGS),
    *(f"maneuver={m}" for m in MANEUVERS),
    "striker",
    "struck",
    *(f"area={a}" for a in AREAS),
)
"""What is asked of a drawn vehicle by its name: two that touch mostly share a token, and without names it stays open
whose side or heading is meant."""


def _picture_tags() -> dict[str, int]:
    names = [f"leg={b}" for b in BEARINGS] + [f"{way}={n}" for way in ("in", "out") for n in LANES]
    names += [f"median={m}" for m in MEDIANS] + ["center"] + [f"use={t}" for t in TURNS]
    names += [f"control={c}" for c in CONTROLS] + [f"curve={c}" for c in CURVES]
    names += [f"kind={k}" for k in ROADS] + [f"north={b}" for b in BEARINGS] + ["access"]
    names += [f"id={i}" for i in IDS] + [f"heading={b}" for b in BEARINGS] + [f"faces={b}" for b in BEARINGS]
    names += [f"pose={p}" for p in POSES] + [f"maneuver={m}" for m in MANEUVERS] + [f"lane={n}" for n in range(1, 6)]
    names += [f"type={k}" for k in KINDS] + ["striker", "struck"] + [f"area={a}" for a in AREAS]
    names += [f"{i}.{name}" for i in IDS for name in _OF_DRAWN]
    return {name: i for i, name in enumerate(names)}


TEXT = _text_tags()
PICTURE = _picture_tags()


def stated_tags(crash: Crash, facts: Set[str], before: Set[str] = frozenset()) -> list[int]:
    """Indices into `TEXT` of what a sentence that tells these facts says of a crash.

    `before`: what the sentences before it told; a turn leads to a leg once the heading is known.
    """
    names = [f"leg={bearing}" for bearing in _used(crash, facts, before | facts)]
    for fact in sorted(facts):
        key, _, rest = fact.partition(".")
        if key.startswith(HINT):
            names.append(f"{key}={rest}")
        elif _open(crash, fact, facts, before):
            continue
        elif key in ("layout", "control", "curve"):
            names += [name for leg in crash.legs for name in _of_leg(key, leg)]
        elif key in ("lanes", "turns", "median", "limit"):
            legs = [leg for leg in crash.legs if leg.bearing % 4 == int(rest)]
            names += [name for leg in legs for name in _of_leg(key, leg)]
            names += [f"leg={way}" for leg in legs if key == "turns" for way in led_to(leg)]
        elif key == "ways":
            names += [name for leg in crash.legs if leg.bearing % 4 == int(rest) for name in _closed(leg)]
        elif key == "side":
            names += _of_contact("areas", int(rest), crash)[:1]
        elif key in ("contact", "areas"):
            names += _of_contact(key, int(rest), crash)
        elif key in ("light", "weather", "surface"):
            names.append(f"{key}={getattr(crash, key)}")
        elif key == "access" and crash.accesses:
            names += [f"access.leg={crash.accesses[0].leg}", f"access.side={crash.accesses[0].side}"]
        else:
            names += [n for actor in crash.actors if actor.id == rest for n in _of_actor(key, actor)]
    return sorted({TEXT[name] for name in names if name in TEXT})


def _open(crash: Crash, fact: str, facts: Set[str], before: Set[str]) -> bool:
    """Whether a sentence that tells a fact leaves its value open by then."""
    key, _, rest = fact.partition(".")
    if key == "layout" and STEM not in facts:
        return crash.layout not in (PLAIN, FOUR)  # three legs, and no telling which
    if key == "lane" and f"{FROM_LEFT}.{rest}" in facts:
        return not _countable(crash, rest, before | facts)
    return f"{VAGUE}.{fact}" in facts


def _countable(crash: Crash, actor: str, known: Set[str]) -> bool:
    """Whether a lane that is named from the left can be numbered by then, wherever the road may lie."""
    return all(lanes_beside(crash, own) <= known for own in crash.actors if own.id == actor)


def _used(crash: Crash, facts: Set[str], known: Set[str]) -> set[int]:
    """Legs that the actors of a sentence come from or go to, as far as they are known by then."""
    moved = [a for a in crash.actors if any(f"{key}.{a.id}" in facts for key in ("heading", "man", "exit"))]
    return driven(moved, known)


def _of_leg(key: str, leg: Leg) -> list[str]:
    b, axis = leg.bearing, leg.bearing % 4
    return {
        "layout": [f"leg={b}"],
        "control": [f"leg{b}.control={leg.control}"],
        "curve": [f"leg{b}.curve={leg.curve}"],
        "lanes": [f"leg{b}.in={leg.lanes_in}", f"leg{b}.out={leg.lanes_out}"] + [f"axis{axis}.center"] * leg.twltl,
        "turns": [f"leg{b}.use={use}" for use in leg.turns_in],
        "median": [f"axis{axis}.median={leg.median}"],
        "limit": [f"axis{axis}.limit={leg.limit}"],
    }[key]


def _closed(leg: Leg) -> list[str]:
    """What "one-way" tells of a leg, without a count of lanes."""
    sides = {"in": leg.lanes_in, "out": leg.lanes_out}
    return [f"leg{leg.bearing}.{side}=0" for side, lanes in sides.items() if not lanes]


def _of_contact(key: str, number: int, crash: Crash) -> list[str]:
    if number >= len(crash.contacts):
        return []
    contact, start = crash.contacts[number], f"contact{number}"
    if key == "areas":
        return [f"{start}.striker_area={contact.striker_area}", f"{start}.struck_area={contact.struck_area}"]
    return [f"{start}.striker={crash.actors[contact.striker].id}", f"{start}.struck={crash.actors[contact.struck].id}"]


def _of_actor(key: str, actor: Actor) -> list[str]:
    speed = 5 * round((actor.speed or 0) / 5)
    return {
        "heading": [f"{actor.id}.heading={actor.heading}"],
        "man": [f"{actor.id}.maneuver={actor.maneuver}"],
        "lane": [f"{actor.id}.lane={actor.lane}"],
        "kind": [f"{actor.id}.kind={actor.kind}"],
        "speed": [f"{actor.id}.speed={speed}"],
    }.get(key, [])


# ------------------------------------------------------------------ answers
_OF_LEG = {
    "lanes_in": "lanes", "lanes_out": "lanes", "center_turn_lane": "lanes", "median": "median",
    "speed_limit_mph": "limit",
}  # fmt: skip
_OF_ACTOR = {
    "kind": "kind", "road": "heading", "exit_road": "man", "maneuver": "man", "lane": "lane", "speed_mph": "speed",
}  # fmt: skip


def fact_of(path: tuple[Any, ...], crash: Crash) -> tuple[str, str]:
    """The fact that the value at a path of an answer states, and the tag in `PICTURE` of what shows it; "" for none."""
    key = str(path[-1])
    if path[0] == "legs" and len(path) > 2 and path[1] < len(crash.legs):
        bearing = crash.legs[path[1]].bearing
        if path[2] in ("control", "curve"):
            return path[2], f"leg={bearing}"
        if isinstance(path[2], int) or path[2] == "turns_in":
            return f"turns.{bearing % 4}", f"leg={bearing}"
        if path[2] == "bearing":
            return "legs", f"leg={_deciding(crash, bearing)}"
        name = _OF_LEG.get(path[2], "")
        return (f"{name}.{bearing % 4}", f"leg={bearing}") if name else ("", "")
    if path[0] == "actors" and len(path) > 2 and path[1] < len(crash.actors) and key in _OF_ACTOR:
        actor = crash.actors[path[1]].id
        return f"{_OF_ACTOR[key]}.{actor}", f"id={actor}"
    if path[0] == "contacts" and key in ("striker", "struck", "striker_area", "struck_area"):
        number = path[1]
        return f"{'areas' if key.endswith('area') else 'contact'}.{number}", "" if number else key.split("_")[0]
    return (key, "") if key in ("light", "weather", "surface") else ("", "")


def _deciding(crash: Crash, bearing: int) -> int:
    """The leg that decides which legs stand in an answer: of three the stem, whose place no other leg tells."""
    return crash.stems[0].bearing if len(crash.stems) == 1 else bearing


# ------------------------------------------------------------------ drawings
def drawn_leg(leg: Leg, control: bool, turns: bool) -> list[int]:
    """Indices into `PICTURE` of what the pavement of a leg shows."""
    names = [f"leg={leg.bearing}", f"in={leg.lanes_in}", f"out={leg.lanes_out}", f"median={leg.median}"]
    names += [f"kind={leg.kind}", f"curve={leg.curve}"] + ["center"] * leg.twltl
    names += [f"control={leg.control}"] * control + [f"use={use}" for use in leg.turns_in] * turns
    return [PICTURE[name] for name in names if name in PICTURE]


def drawn_actor(crash: Crash, actor: Actor, pose: str, faces: int, drawn: Set[str]) -> list[int]:
    """Indices into `PICTURE` of what a vehicle drawn at a pose shows; `faces` is the bearing of its nose, `drawn` what
    the drawing as a whole shows."""
    names = [f"id={actor.id}", f"type={actor.kind}", f"pose={pose}", f"faces={faces % 8}"]
    if actor.vehicle:
        names += [f"heading={actor.heading}", f"lane={actor.lane}"]
        names += [f"maneuver={actor.maneuver}"] * (f"man.{actor.id}" in drawn)
    for contact in crash.contacts[:1] if pose == "contact" else ():
        for who in ("striker", "struck"):
            if crash.actors[getattr(contact, who)] is actor:
                names += [who, f"area={getattr(contact, who + '_area')}"]
    names += [f"{actor.id}.{name}" for name in names]
    return [PICTURE[name] for name in names if name in PICTURE]
