# ruff: noqa: E501 - lists of words
"""The event sentences of a report: errors, evasions, contacts, places of rest.

A part of the writer.
"""

from __future__ import annotations

from collections.abc import Sequence
from random import Random
from typing import Any

from research.generator import words
from research.generator.clauses import contact_clauses, error_clauses, motion_clauses, roads_fit
from research.generator.clauses.error_clauses import CRITICAL
from research.generator.crash.impacts import TRIES, ImpactsMixin
from research.generator.crash.world import OPPOSITE, Actor, Crash
from research.generator.grammar import StatedFacts, clause_of, fill
from research.generator.phrase_labels import has, plain
from research.generator.records import Group, slots_of
from sgcad_core.kinds import DRIVEWAY, INTERSECTIONS, ROAD

STATES = ("stopped", "slowing")
"""What clauses of an error may say of the other vehicle, as labels and as maneuvers."""
BOUND = 0.12
"""Share of those who turn of whom it is told which way they meant to go on."""
STRAYING = 0.2
"""Share of those who come into the next lane who lose control, or come from beside the road."""
YIELDING = 0.25
"""Share of those who stand or slow for a turn of whom the traffic that they wait for is told, with its heading."""


class EventsMixin(ImpactsMixin):
    """Sentences about the collision; needs the writer's fields."""

    rng: Random
    crash: Crash
    held_out: bool
    ciren: bool
    stated: StatedFacts
    who: tuple[int, int]
    waited: bool

    say: Any
    id_of: Any

    # -------------------------------------------------------------- events
    def culprit(self) -> tuple[int, int]:
        """Indices of the actor that errs and of the other."""
        plain = ("straight", "negotiating_curve", "stopped", "parked", "slowing")
        actors = self.crash.actors
        first = self.crash.contacts[0]
        if self.crash.config in ("crossing", "rear_end", "pedestrian", "parked"):
            return first.striker, first.struck
        if self.crash.config == "overtaking":
            found = next((i for i, a in enumerate(actors) if a.maneuver == "overtaking"), first.striker)
        else:
            found = next((i for i, a in enumerate(actors) if a.maneuver not in plain), first.striker)
        return found, first.struck if found == first.striker else first.striker

    def events(self) -> list[str]:
        """The sentences of what happened: error, avoidance, impacts, rest."""
        rng, (v, w) = self.rng, self.who
        config = self.crash.config
        key = {"left_lateral": "turn_left", "right_into": "turn_right"}.get(config, config)
        out = []
        if self.waited or (rng.random() < 0.85 and not (config == "crossing" and rng.random() < 0.4)):
            bent = self.crash.actors[v].maneuver == "negotiating_curve"
            if config != "parked" and not bent:  # whether it kept its lane until then, or in a bend, no clause tells
                self.stated.add(f"man.{self.id_of(v)}")
            if config not in ("parked", "backing"):  # nor which way one that backs out would have gone
                self.stated.add(f"exit.{self.id_of(v)}")
            goes_on = self.crash.actors[w].maneuver == "straight" and config in ("crossing", "head_on")
            clause = self._true_of(w, self._error(key))
            if self.crash.actors[v].maneuver == "departing_road_right" and self._drifts(clause):
                self.stated |= {f"man.{self.id_of(v)}", f"exit.{self.id_of(v)}"}
            self.stated |= {f"man.{self.id_of(w)}"} if goes_on and "W" in slots_of(clause) else set()
            out.append(self.say([self.spoken(clause)], v, w, turn=(side := self._turn(v)), aside=OPPOSITE[side]))
        if rng.random() < (0.12 if self.ciren else 0.4):
            avoids = self._avoids(self.crash.actors[w])
            out += [self.say(avoids, v, w)] if avoids else []
        for number, contact in enumerate(self.crash.contacts):
            out.append(self.impact(number, contact))
        if config == "rear_end" and rng.random() < 0.06 and len(out) > 1:
            out = out[1:]
        rest = contact_clauses.REST.without(self.held_out, self._untrue_rest())
        return out + [self._rests(rest) for _ in range(int(rng.random() < 0.7) + (rng.random() < 0.3))]

    def _avoids(self, other: Actor) -> Sequence[str]:
        """Clauses of avoidance; of one that is alone those that speak of no second vehicle."""
        single = not self.held_out and (self.crash.alone or other.maneuver == "parked")
        unnamed = self.crash.alone and not single
        return contact_clauses.AVOID.without(self.held_out, ["two"] * single, ["W"] * unnamed)

    def _untrue_rest(self) -> list[str]:
        """Labels of clauses of rest that need what is not there."""
        if self.held_out:
            return []
        untrue = ["median"] * all(leg.median == "none" for leg in self.crash.legs)
        untrue += ["two"] * self.crash.alone  # a tree or a pedestrian does not slap sides
        return untrue + ["junction"] * (self.crash.layout not in INTERSECTIONS)

    def _rests(self, options: Sequence[str]) -> str:
        """Where they come to rest, with the struck as the one that is pushed."""
        v, w = self.who
        if self.held_out:
            return str(self.say(options, v, w))
        clause, first = clause_of(self.rng, options, False), self.crash.contacts[0]
        while self.crash.alone and (has(clause, "moved_v") or has(clause, "moved_w")):
            clause = clause_of(self.rng, options, False)
        if has(clause, "moved_v"):
            v, w = first.struck, first.striker
        elif has(clause, "moved_w"):
            v, w = first.striker, first.struck
        return str(self.say([clause], v, w))

    def _error(self, key: str) -> Group | Sequence[str]:
        """Clauses of the error; of an actor that has waited, half of the time, that it goes."""
        if self.held_out:
            return CRITICAL[key]
        if self.crash.layout == DRIVEWAY and key == "left_opposite" and self.rng.random() < 0.5:
            return error_clauses.INTO
        turns = key in ("turn_left", "turn_right") or (key == "left_opposite" and self.crash.layout != DRIVEWAY)
        if turns and self.rng.random() < BOUND:
            return error_clauses.ONWARD
        if key == "lane_change" and self.rng.random() < STRAYING:
            at_edge = self._at_edge(self.crash.actors[self.who[0]])
            return error_clauses.STRAYS.without(False, [] if at_edge else ["shoulder"])
        if self.waited and self.rng.random() < 0.5:
            return error_clauses.PROCEEDS["cross" if key == "crossing" else "turn"]
        return CRITICAL[key]

    def _at_edge(self, actor: Actor) -> bool:
        """Whether one that changes lanes comes from the lane beside the shoulder behind it."""
        leg = self.crash.leg(actor.leg)
        return leg is not None and actor.lane == (1 if actor.maneuver.endswith("left") else leg.lanes_in)

    def _true_of(self, index: int, options: Group | Sequence[str]) -> str:
        """A clause that says of the other vehicle only what it does: that it slowed, that it had stopped; of a good many
        that are not true the last."""
        does, erring = self.crash.actors[index].maneuver, self.crash.actors[self.who[0]]
        clause = ""
        for _ in range(TRIES):
            clause = self.fitting(options, erring)
            strays = erring.maneuver != "departing_road_right" and self._drifts(clause)
            states = [word for word in STATES if word != does]
            if not strays and not any(has(clause, word) for word in [*states, "barred"]):
                break
        return clause

    def _drifts(self, clause: str) -> bool:
        """Whether a clause says of one that hits a parked vehicle that it left its lane."""
        return self.crash.config == "parked" and not self.held_out and has(clause, "drifts")

    def reason(self, key: str, actor: Actor) -> str:
        """What an actor stands or slows for; half of the turns off a road into a driveway are told."""
        leaves = self.crash.layout == DRIVEWAY and not self.crash.is_main(actor.leg)
        others = [] if self.held_out or not key.startswith("turn_") else self._others(actor, key == "turn_left")
        if others and self.rng.random() < YIELDING:
            slots = {"other": words.bound(self.rng, self.rng.choice(others)), "turn": key.removeprefix("turn_")}
            return fill(clause_of(self.rng, error_clauses.YIELDS, False), slots.__getitem__)
        if key in error_clauses.INTO_WHY and self.crash.layout == DRIVEWAY and not leaves and not self.held_out:
            options = error_clauses.INTO_WHY[key] if self.rng.random() < 0.5 else motion_clauses.WHY[key]
            return plain(self.spoken(self.fitting(options, actor)))
        if key in ("sign", "light"):
            self.stated |= roads_fit.met(key, self.crash)
            return plain(self.spoken(clause_of(self.rng, motion_clauses.WHY[key], self.held_out)))
        return plain(self.spoken(self.fitting(motion_clauses.WHY[key], actor, into=not leaves)))

    def _others(self, actor: Actor, left: bool) -> list[int]:
        """Headings of traffic that a turning actor may have to wait for: to the left the oncoming, on a side road any; to
        the right what comes from the left, on the lane that it turns into."""
        only = (actor.leg + (4 if left else 2)) % 8
        others = [leg for leg in self.crash.legs if leg.bearing == only]
        if left and not others:
            others = [leg for leg in self.crash.legs if leg.bearing != actor.leg]
        return [(leg.bearing + 4) % 8 for leg in others if leg.kind == ROAD and leg.lanes_in]

    def spoken(self, text: str) -> str:
        """A clause or phrase that is written; notes what it tells of driveways, signals and signs."""
        self.stated |= roads_fit.facts_of_words(text, self.crash)
        return text

    def fitting(self, options: Group | Sequence[str], actor: Actor, into: bool = True) -> str:
        """A clause or phrase, its choices made, that suits the roads: of a driveway or a signal only where there is one,
        of a stop sign only where the actor that it speaks of meets one.

        `into`: whether the driveway may be one that an actor turns into.
        """
        clause = clause_of(self.rng, options, self.held_out)
        if self.held_out:
            return clause
        for _ in range(TRIES):
            if roads_fit.fits_roads(clause, self.crash, actor) and (into or not has(clause, DRIVEWAY)):
                break
            clause = clause_of(self.rng, options, self.held_out)
        return clause

    def _turn(self, index: int) -> str:
        maneuver = self.crash.actors[index].maneuver
        return "left" if maneuver.endswith("left") else "right"
