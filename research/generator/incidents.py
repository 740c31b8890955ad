"""Made incident reports: an unnumbered subject, the actor that it met or nearly met, and the gist of it.

A situation (the maneuvers of both, the sides that could meet) is drawn from a table and told in words of
`phrases/incidents.yaml`, in one of three manners: a company's report of its automated vehicle, a form's, or a study's
of what a driver's camera saw. No road is made: the gist asks for none but whether there was a junction. Knows no tokens
and no model.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from random import Random

from research.generator.crash.vehicles import by_kind
from research.generator.grammar import clause_of, fill, sentence
from research.generator.records import Group, read, records
from research.rows.partial_labels import Told
from sgcad_core.reading.language import values, words
from sgcad_core.reading.text.area_phrases import area_of

_LISTS = read("incidents")
_MOTION: Mapping[str, Group] = _LISTS["MOTION"]
_NEAR: Mapping[str, Group] = _LISTS["NEAR"]


@dataclass(frozen=True)
class Situation:
    """Maneuvers of both, sides that may touch, kinds of the other actor, how often it comes, and as a near crash."""

    subject: str
    other: str
    sides: tuple[tuple[str, str], ...]
    weight: float
    near: str = ""
    met: str = "vehicle"
    active: bool = False
    """Whether the subject's words come first: it struck."""


BICYCLE, WALKER = "bicycle", "pedestrian"
_FLANKS = (("left", "right"), ("right", "left"))
SITUATIONS: tuple[Situation, ...] = (
    Situation("stopped", "straight", (("back", "front"),), 16, "behind"),
    Situation("slowing", "straight", (("back", "front"),), 5, "behind"),
    Situation("straight", "straight", (("back", "front"),), 4, "behind"),
    Situation("straight", "stopped", (("front", "back"),), 5, "rear", active=True),
    Situation("straight", "slowing", (("front", "back"),), 6, "rear", active=True),
    Situation("straight", "straight", (("front", "back"),), 3, "rear", active=True),
    Situation("stopped", "overtaking", _FLANKS, 5, "side"),
    Situation("straight", "overtaking", _FLANKS, 4, "side"),
    Situation("parked", "straight", (("left", "right"), ("left", "front"), ("back", "front")), 5),
    Situation("parked", "overtaking", (("left", "right"),), 2),
    Situation("straight", "lane_change_left", (("right", "left"), ("front", "left"), ("front", "back")), 6, "side"),
    Situation("straight", "lane_change_right", (("left", "right"), ("front", "right"), ("front", "back")), 6, "side"),
    Situation("lane_change_left", "straight", (("left", "right"), ("left", "front")), 4, "side", active=True),
    Situation("lane_change_right", "straight", (("right", "left"), ("right", "front")), 4, "side", active=True),
    Situation("stopped", "backing", (("front", "back"), ("right", "back"), ("left", "back")), 7, "front"),
    Situation("parked", "backing", (("front", "back"), ("left", "back"), ("right", "back")), 4),
    Situation("straight", "backing", (("right", "back"), ("front", "back")), 2, "front"),
    Situation("backing", "stopped", (("back", "front"), ("back", "left")), 2, active=True),
    Situation("straight", "turn_left", (("front", "right"), ("front", "front"), ("left", "front")), 5, "front"),
    Situation("turn_left", "straight", (("right", "front"), ("front", "front"), ("front", "left")), 4, "front"),
    Situation("straight", "turn_right", (("front", "left"), ("right", "left"), ("front", "back")), 4, "front"),
    Situation("stopped", "turn_left", (("front", "left"), ("left", "left"), ("left", "front")), 3, "side"),
    Situation("stopped", "turn_right", (("right", "left"), ("left", "right"), ("front", "left")), 2, "side"),
    Situation("turn_right", "straight", (("left", "front"), ("back", "front"), ("front", "right")), 3, "side"),
    Situation("straight", "u_turn", (("front", "left"), ("front", "right")), 1, "front"),
    Situation("straight", "straight", (("front", "right"), ("left", "front"), ("right", "front")), 5, "front"),
    Situation("straight", "crossing_centerline", (("left", "left"), ("front", "front"), ("left", "front")), 3, "side"),
    Situation("stopped", "crossing_centerline", (("left", "left"), ("front", "front")), 2, "side"),
    Situation("overtaking", "stopped", (("right", "left"), ("left", "right")), 2, "side", active=True),
    Situation("straight", "parked", (("right", "left"), ("front", "back"), ("right", "front")), 4, "side", active=True),
    Situation("straight", "straight", (("front", "front"), ("front", "left"), ("left", "front")), 2, "front", BICYCLE),
    Situation("stopped", "straight", (("back", "front"), ("right", "front"), ("left", "left")), 2, "behind", BICYCLE),
    Situation("turn_right", "straight", (("right", "front"), ("right", "left")), 1, "side", BICYCLE),
    Situation("straight", "walking", (("front", "left"), ("front", "right"), ("left", "front")), 2, "front", WALKER),
    Situation("turn_left", "walking", (("front", "right"), ("front", "left")), 1, "front", WALKER),
    Situation("straight", "lying", (("front", "front"), ("right", "left"), ("left", "right")), 3, "front", "object"),
    Situation("backing", "lying", (("back", "front"),), 1, "", "object"),
    Situation("turn_right", "lying", (("right", "left"), ("front", "front")), 1, "", "object"),
    Situation("departing_road_right", "lying", (("front", "front"), ("right", "left")), 1, "front", "object"),
    Situation("straight", "animal", (("front", "left"), ("front", "right"), ("right", "front")), 2, "front", "animal"),
)  # fmt: skip
NEAR_SHARE = 0.35
SURE, GUESS = 1.0, 0.3
"""Weights of what a report tells and of what it leaves to the situation."""
AT_JUNCTION = re.compile(
    r"\b(?:intersection|crosswalk|red light|green light|stop sign|driveway|signal|light to change)\b"
)
_KIND_WEIGHTS = {"car": 10, "suv": 7, "pickup": 3, "van": 3, "truck": 4, "bus": 2, "motorcycle": 2}
_MET: Mapping[str, Group] = _LISTS["MET"]
_SLOTS: Mapping[str, Group] = _LISTS["SLOT"]
_ENDS = ("front", "back")


@dataclass
class _Telling:
    """One report while it is written."""

    rng: Random
    study: bool
    past: bool
    held_out: bool
    names: Mapping[str, str]
    introduced: bool = False

    def say(self, options: Group, **slots: str) -> str:
        """A sentence of a list."""
        clause = clause_of(self.rng, options, self.held_out)
        return sentence(fill(clause, lambda slot: slots.get(slot) or self._slot(slot)))

    def other(self) -> str:
        """The other one: "a sedan" at first, "the sedan" later."""
        first, self.introduced = not self.introduced, True
        return self.names["b"] if first else _the(self.names["b"])

    def _slot(self, slot: str) -> str:
        rng = self.rng
        if slot == "B":
            return self.other()
        if slot == "b":
            self.introduced = True
            return self.names["b"]
        verbs = {"was": ("is", "was"), "has": ("has", "had")}
        if slot in verbs:
            return verbs[slot][self.past]
        made = {
            "A": self.names["A"], "Subject": self.names["A"], "Subject0": self.names["A"].split(" ", 1)[-1],
            "dir": self._one("dir"), "street": self._one("street"), "lane": self._one("lane"),
            "mph": str(rng.randint(3, 60)), "side": rng.choice(words("hand")),
            "date": self._one("date"), "town": self._one("town"),
        }  # fmt: skip
        return made[slot]

    def _one(self, slot: str) -> str:
        return self.rng.choice(_SLOTS[slot].side(False))


def make_incident(seed: int, held_out: bool = False) -> Told:
    """The report of a seed and its gist."""
    rng = Random(f"{seed} incident {held_out}")
    situation = rng.choices(SITUATIONS, [s.weight for s in SITUATIONS])[0]
    near = bool(situation.near) and rng.random() < NEAR_SHARE
    study = rng.random() < (0.7 if near else 0.15)
    kind, word = _met(rng, situation.met)
    subject = rng.choice(_LISTS["DRIVER" if study else "SUBJECT"].side(False))
    telling = _Telling(rng, study, not study or rng.random() < 0.3, held_out, {"A": subject, "b": word})
    mine, theirs = rng.choice(situation.sides)
    sides = _part(rng, mine), _part(rng, theirs)
    text = " ".join(_sentences(telling, situation, near, sides))
    known = {"touched": (not near,), "met": (kind,), "subject": (situation.subject,)}
    if situation.other in _MOTION and situation.met in ("vehicle", "bicycle"):
        known["other"] = (situation.other,)
    told = {"subject_area": sides[0][1], "other_area": sides[1][1]}
    if near:
        told = {"subject_area": (mine,), "other_area": (theirs,)}
    if situation.met in ("object", "animal", "pedestrian"):
        del told["other_area"]
    weight = {"junction": SURE if AT_JUNCTION.search(text) else GUESS}
    if near:
        weight |= {key: GUESS for key in ("subject_area", "other_area") if situation.near in ("side", "front")}
    return Told(f"made-{seed}", text, known | told | {"junction": (bool(AT_JUNCTION.search(text)),)}, weight)


def _met(rng: Random, met: str) -> tuple[str, str]:
    """The kind of the other one and what it is called."""
    if met == "vehicle":
        kind = rng.choices(list(_KIND_WEIGHTS), list(_KIND_WEIGHTS.values()))[0]
        return kind, rng.choice(_vehicles()[kind])
    return "object" if met == "animal" else met, rng.choice(_MET[met].side(False))


@cache
def _vehicles() -> Mapping[str, tuple[str, ...]]:
    """Kind -> what vehicles of it are called."""
    return by_kind(records("incidents")["MET.vehicle"]["counted"])


@cache
def _parts() -> Mapping[str, tuple[str, ...]]:
    """Area -> words for it."""
    found: dict[str, tuple[str, ...]] = {}
    for text in _LISTS["PART"].side(False):
        area = str(area_of(text))
        found[area] = (*found.get(area, ()), text)
    return found


def _part(rng: Random, area: str) -> tuple[str, tuple[str, ...]]:
    """Words for a side, and the sides that they allow: of a corner both."""
    if rng.random() < 0.3:
        end, side = (area, rng.choice(words("hand"))) if area in _ENDS else (rng.choice(_ENDS), area)
        word = next(word for word, meaning in values("end_word").items() if meaning == end)
        names = (f"{word} {side} corner", f"{side} {word}", f"{word} {side}", f"{side} {word} bumper")
        return rng.choice(names), (end, side)
    return rng.choice(_parts()[area]), (area,)


def _sentences(
    telling: _Telling, situation: Situation, near: bool, sides: tuple[tuple[str, tuple[str, ...]], ...]
) -> list[str]:
    """The report's sentences: opening, what both did, what came of it, the rest."""
    rng, (sa, oa) = telling.rng, (sides[0][0], sides[1][0])
    opening = _LISTS["NEAR_OPENING" if telling.study else "OPENING"]
    out = [telling.say(opening)] if rng.random() < 0.75 else []
    motions = [_motion(telling, situation.subject, True), _motion(telling, situation.other, False)]
    out += motions if rng.random() < 0.7 else motions[::-1]
    if near:
        out.append(telling.say(_NEAR[situation.near], sa=sa, oa=oa))
    elif situation.met in ("object", "animal", "pedestrian"):
        out.append(telling.say(_LISTS["TOUCH_THING"], sa=sa))
    else:
        out.append(telling.say(_LISTS["TOUCH_ACTIVE" if situation.active else "TOUCH"], sa=sa, oa=oa))
    noise = _LISTS["NEAR_NOISE" if telling.study else "NOISE"]
    return out + [telling.say(noise) for _ in range(rng.randint(0, 1 if telling.study else 4))]


def _motion(telling: _Telling, maneuver: str, subject: bool) -> str:
    """What one of both did; of a thing that it was there."""
    me = telling.names["A"]
    if maneuver == "lying":
        telling.introduced = True
        return telling.say(_MOTION[maneuver], x=telling.names["b"])
    if subject:
        return telling.say(_MOTION[maneuver], X=me, Y=_the(telling.names["b"]))
    return telling.say(_MOTION[maneuver], X=telling.other(), Y=me)


def _the(name: str) -> str:
    """A later mention."""
    return re.sub(r"^an? (?:other )?|^another ", "the ", name) if name.startswith(("a ", "an ", "another ")) else name
