"""The blocks on single vehicles: noise, and what is coded and stated of the crash, which is true.

A part of the writer. In NMVCCS reports every vehicle has a critical event, and the vehicle that turned or crossed
the line is often told there, or by a driver, more plainly than among the events.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache
from random import Random

from research.generator import phrase_labels, words
from research.generator.clauses import code_clauses
from research.generator.clauses.noise_clauses import GROUPS, SPEED
from research.generator.crash.world import WORDS, Actor, Contact, Crash
from research.generator.grammar import StatedFacts, clause_of, fill
from research.generator.phrase_labels import has, plain
from research.generator.records import Group, slots_of
from sgcad_core.kinds import DRIVEWAY

BY_MANEUVER = {
    "turn_left": "turn_left",
    "turn_right": "turn_right",
    "lane_change_left": "over_left",
    "lane_change_right": "over_right",
    "crossing_centerline": "over_left",
    "overtaking": "over_left",
    "merge": "over_left",
    "departing_road_left": "off_left",
    "departing_road_right": "off_right",
    "u_turn": "turn_around",
    "backing": "backing",
}
"""Critical event of the one who errs."""
TELLS = ("turn_left", "turn_right", "u_turn", "backing", "crossing_centerline", "departing_road_left",
         "departing_road_right")  # fmt: skip
"""Maneuvers that their critical event tells; a crossed lane line may be several things."""
ON_FOOT = {"pedestrian", "person_on_foot", "walking_person", "walker"}
"""Slots of words for one whom a vehicle hits, as they are said of one on foot."""
TELLING = {"spd", "dir", "lane", "doing", "code", "move"}
"""Slots that tell something of the one whom a clause is about."""


def event_of(crash: Crash, index: int, who: tuple[int, int]) -> str | None:
    """Key of the critical event of an actor, as `code_clauses.EVENT` has it; None where nothing is coded."""
    if index == who[0]:
        return _own_event(crash, crash.actors[index], crash.actors[who[1]])
    if index == who[1] and crash.actors[index].vehicle:
        return _encroachment(crash, crash.actors[who[0]], crash.actors[index])
    return None


def _own_event(crash: Crash, actor: Actor, other: Actor) -> str | None:
    if crash.config == "rear_end":
        return {"stopped": "into_stopped", "slowing": "into_slowing"}.get(other.maneuver, "into_slower")
    if crash.config in ("crossing", "pedestrian"):
        return crash.config
    return BY_MANEUVER.get(actor.maneuver)


def _encroachment(crash: Crash, culprit: Actor, actor: Actor) -> str | None:
    if crash.config in ("left_lateral", "right_into"):
        leg = crash.leg(culprit.leg)
        if leg is not None and leg.kind == DRIVEWAY:
            return "from_driveway"
        return "from_side_left" if crash.config == "left_lateral" else "from_side_right"
    if crash.config == "overtaking":
        return "from_opposite" if culprit.leg != actor.leg else None
    return {
        "crossing": "from_crossing",
        "left_opposite": "from_opposite",
        "head_on": "from_opposite",
        "rear_end": "from_behind",
        "merge": "from_right_lane",
        "backing": "from_driveway",
        "lane_change": "from_left_lane" if culprit.maneuver.endswith("right") else "from_right_lane",
    }.get(crash.config)


@cache
def clear(clauses: Sequence[str], stands: bool, named: bool) -> list[str]:
    """Of clauses on one vehicle those that tell no speed of one that stands and, until the vehicle is named, those that
    name it or tell nothing of it."""
    moves = [clause for clause in clauses if not (stands and "spd" in slots_of(clause))]
    return [clause for clause in moves if named or "V" in slots_of(clause) or not TELLING & set(slots_of(clause))]


class BlocksMixin:
    """The sentences on one vehicle, noise and truths; needs the writer's fields."""

    rng: Random
    crash: Crash
    held_out: bool
    length: float
    stated: StatedFacts
    who: tuple[int, int]
    waited: bool
    people: dict[int, dict[str, str]]
    lately: set[int]

    say: Callable[..., str]
    id_of: Callable[..., str]
    _slot: Callable[..., str]
    impact: Callable[..., str]

    def _about(self, index: int) -> list[str]:
        """The block on one vehicle: driver, interview, health, codes."""
        self.lately.clear()
        actor = self.crash.actors[index]
        if not actor.vehicle or actor.maneuver == "parked":  # nobody who could be asked
            return self._noise("tow", 0.6, index) + self._coded(index) + self._noise("police", 0.5, index)
        speed = self.rng.random() < 0.3
        out = self._noise("occupant", 1.2, index)
        if speed and (found := self._clear(SPEED, index)):
            out.append(self.say(found, index, **self._person(index)))
        out += self._noise("interview", 1.1, index) + self._statements(index)
        out += self._noise("tow", 0.6, index) + self._noise("health", 1.0, index)
        return out + self._coded(index) + self._noise("codes", 1.7, index) + self._noise("police", 0.5, index)

    def _person(self, index: int) -> dict[str, str]:
        """The driver of an actor, the same throughout a report; slips of investigators apart."""
        if index not in self.people or self.rng.random() < 0.03:
            self.people[index] = words.person(self.rng)
        return self.people[index]

    def _clear(self, options: Group, index: int, untrue: Sequence[str] = ()) -> list[str]:
        """Clauses of its side of the split without some labels, of which it is clear which vehicle they are about.

        "He was driving 30 mph" says whose speed that is only behind a sentence of the block that names the vehicle.
        """
        stands = self.crash.actors[index].maneuver in ("stopped", "parked")
        named = index in self.lately or self.crash.alone
        return clear(options.without(self.held_out, untrue), stands, named)

    def _noise(self, group: str, mean: float, index: int | None = None) -> list[str]:
        """About mean * length sentences of a noise group."""
        wanted = mean * self.length
        count = int(wanted) + (self.rng.random() < wanted % 1)
        vehicles = [i for i, a in enumerate(self.crash.actors) if a.vehicle]
        signals = any(leg.control == "signal" for leg in self.crash.legs)
        alone = self.crash.alone and group != "noncontact"
        out = []
        for _ in range(count):
            v = index if index in vehicles else self.rng.choice(vehicles)
            others = [i for i in vehicles if i != v]
            w = self.rng.choice(others) if others else v
            if index is None:  # they stand in no block and in any order
                self.lately.clear()
            single = not others if self.held_out else alone
            untrue = ["two"] * single + ["signals"] * (not self.held_out and not signals)
            if found := self._clear(GROUPS[group], v, untrue):
                out.append(self.say(found, v, w, **self._person(v)))
        return out

    def _noise_slot(self, slot: str, v: int) -> str:
        rng = self.rng
        if slot == "spd":
            actor = self.crash.actors[v]
            waited = self.waited and v == self.who[0]  # and drove as fast as its road allows only before that
            if not actor.speed or f"speed.{actor.id}" in self.stated or waited:
                slowly: tuple[str, ...] = (
                    () if f"speed.{actor.id}" in self.stated and not self.held_out else ("slowly",)
                )
                return rng.choice((*slowly, "at an unknown speed", "at normal speed"))
            text, actor.speed = words.driver_speed(rng, actor.speed)
            self.stated.add(f"speed.{actor.id}")
            return text
        return {
            "any4": rng.choice(WORDS[::2]),
            "any8": rng.choice(WORDS),
            "any8b": rng.choice(WORDS),
            "anyside": rng.choice(("left", "right")),
            "deg": str(rng.choice((45, 90, 180, 270, 30, 80))),
            "m": str(rng.randint(5, 60)),
            "k": rng.choice(("two", "three", "2", "3", "four")),
            "kk": str(rng.randint(5, 60)),
        }[slot]

    def _coded(self, index: int) -> list[str]:
        """Critical event, movement before it, crash type: as often as reports have them, of vehicles."""
        rng = self.rng
        out: list[str] = []
        if not self.crash.actors[index].vehicle:
            return out
        share = min(1.0, self.length)
        key = event_of(self.crash, index, self.who)
        if key and rng.random() < 0.9 * share:
            out.append(self._event(index, key))
        maneuver = self.crash.actors[index].maneuver
        if maneuver in code_clauses.MOVEMENT and rng.random() < 0.2 * share:
            move = self._phrase(code_clauses.MOVEMENT[maneuver])
            if not maneuver.startswith("lane_change") or has(move, "side"):
                self.stated |= {f"man.{self.id_of(index)}"}
            out.append(self.say(self._clear(code_clauses.MOVEMENT_FRAMES, index), index, move=plain(move)))
        if self.crash.config in code_clauses.CRASH_TYPE and rng.random() < 0.06 * share:
            kind = self._phrase(code_clauses.CRASH_TYPE[self.crash.config])
            if index == self.who[0] or not has(kind, "turner"):
                out.append(self.say(code_clauses.TYPE_FRAMES, index, kind=plain(kind)))
        return out

    def _event(self, index: int, key: str) -> str:
        other = self.who[1] if index == self.who[0] else self.who[0]
        erring = self.crash.actors[self.who[0]]
        if key in ("into_stopped", "into_slowing"):
            self.stated |= {f"man.{self.id_of(other)}"}
        elif key == "crossing" or (index == self.who[0] and erring.maneuver in TELLS):
            self.stated |= {f"man.{erring.id}"}
        elif index == self.who[1] and self.crash.config in ("head_on", "lane_change"):  # from where, over what
            self.stated |= {f"man.{erring.id}"}
            self.stated |= {f"heading.{erring.id}"} if f"heading.{self.id_of(index)}" in self.stated else set()
        same = erring.out == self.crash.actors[index].heading and not self.held_out
        onto = {"onto": "same" if same else "opposite"}
        frames, code = (
            self._clear(code_clauses.EVENT_FRAMES, index),
            self._phrase(code_clauses.EVENT[key], index, other, onto),
        )
        return self.say(frames, index, other, code=plain(code))

    def _on_foot(self, slot: str) -> str:
        """Words of a code for the person that a vehicle hits: as the slot says, but a cyclist is no pedestrian."""
        rides = any(actor.kind == "bicycle" for actor in self.crash.actors)
        return "bicyclist" if rides else slot.replace("_", " ")

    def _statements(self, index: int) -> list[str]:
        """What a driver says of the own maneuver and of the other's, and the impact told once more."""
        rng, out, share = self.rng, [], min(1.0, self.length)
        actor, other = self.crash.actors[index], self._opponent(index)
        person, does = self._person(index), actor.maneuver in code_clauses.DOING
        if does and rng.random() < 0.3 * share and (frames := self._clear(code_clauses.SELF_FRAMES, index)):
            self.stated |= {f"man.{actor.id}"}
            doing = self._phrase(code_clauses.DOING[actor.maneuver], index, other, person)
            out.append(self.say(frames, index, other, doing=plain(doing), **person))
        key = None if other is None else self._seen(other)
        if key and rng.random() < 0.25 * share and (frames := self._clear(code_clauses.OTHER_FRAMES, index)):
            self.stated |= {f"man.{self.id_of(other)}"}
            did = self._phrase(code_clauses.DID[key], index, other, person)
            out.append(self.say(frames, index, other, did=plain(did), **person))
        if rng.random() < 0.1 * share:
            contact: Contact = self.crash.contacts[0]
            if index in (contact.striker, contact.struck):
                out.append(self.impact(0, contact))
        return out

    def _opponent(self, index: int) -> int | None:
        found = [i for i in self.who if i != index and self.crash.actors[i].vehicle]
        return found[0] if index in self.who and found else None

    def _seen(self, index: int) -> str | None:
        """What another driver says that an actor did."""
        if self.crash.config == "crossing":
            return "crossing"
        maneuver = self.crash.actors[index].maneuver
        return maneuver if maneuver in code_clauses.DID else None

    def _phrase(self, options: Group, v: int = 0, w: int | None = None, extra: dict[str, str] | None = None) -> str:
        """One phrase of its side of the split, with its slots filled, and behind it its labels."""
        chosen, given = clause_of(self.rng, options, self.held_out), extra or {}
        if set(slots_of(chosen)) & ON_FOOT:
            given = given | {slot: self._on_foot(slot) for slot in ON_FOOT}
        text = fill(chosen, lambda slot: self._slot(slot, v, v if w is None else w, given))
        return phrase_labels.marked(text, tuple(phrase_labels.labels_of(chosen)))
