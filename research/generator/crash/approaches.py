"""The sentences that bring every vehicle to the crash: which way, in which lane, standing or slowing for what.

A part of the writer.
"""

from __future__ import annotations

from collections.abc import Callable
from random import Random

from research.generator.clauses import motion_clauses
from research.generator.clauses.clause_words import NEARING
from research.generator.crash.compass_ties import STEM
from research.generator.crash.world import Actor, Crash
from research.generator.grammar import StatedFacts
from research.generator.mentions import Mentions
from research.generator.phrase_labels import plain
from sgcad_core.kinds import INTERSECTIONS

LEAVES = ("turn_", "u_turn", "lane_change", "merge", "backing", "overtaking")
"""How maneuvers begin of one that does not stay where it drives."""

UNSAID = 0.25
"""Share of those on the leg that ends at a junction of whom no word says which way they drove."""


class ApproachMixin:
    """Sentences on single vehicles before the crash; needs the writer's fields."""

    rng: Random
    crash: Crash
    held_out: bool
    ciren: bool
    stated: StatedFacts
    mentions: Mentions
    who: tuple[int, int]
    waited: bool

    say: Callable[..., str]
    fitting: Callable[..., str]
    spoken: Callable[..., str]
    reason: Callable[..., str]
    scene_junction: Callable[..., str]
    junction_named: bool

    def _approaches(self) -> list[str]:
        actors = self.crash.actors
        order = [i for i, a in enumerate(actors) if a.vehicle]
        if self.rng.random() < 0.12:
            self.rng.shuffle(order)
        if not self.ciren and len(order) > 1 and self.rng.random() < (0.04 if self.held_out else 0.08):
            order.pop()
        out: list[str] = []
        if not self.ciren and not self.held_out and self.rng.random() < 0.08:
            out += [self.say(["{Vi}"], index) for index in order]
        for place, index in enumerate(order):
            out.append(self._approach(index, order[:place]))
        if len(order) == 2 and self.rng.random() < 0.06:
            out = [" ".join(out)]
        return out

    def _approach(self, index: int, before: list[int]) -> str:
        actor = self.crash.actors[index]
        ahead = next((i for i in before if self.crash.actors[i].leg == actor.leg), None)
        options = {
            "stopped": motion_clauses.APPROACH_STOPPED,
            "parked": motion_clauses.APPROACH_PARKED,
            "slowing": motion_clauses.APPROACH_SLOWING,
        }.get(actor.maneuver)
        presented = not self.ciren and index not in self.mentions.introduced and self.rng.random() < 0.22
        if options:
            self.stated |= {f"man.{actor.id}"} | (set() if actor.meant else {f"exit.{actor.id}"})
            if presented and actor.maneuver in motion_clauses.PRESENTED:
                options = motion_clauses.PRESENTED[actor.maneuver]
            return self.say(options, index, ahead, why=lambda: self._why(actor))
        if how := self._pauses(index):
            options = motion_clauses.APPROACH_SLOWING if how == "slowing" else motion_clauses.APPROACH_WAITING
            options = motion_clauses.PRESENTED[how] if presented else options
            return self.say(options, index, ahead, why=lambda: self._why_waiting(actor))
        order = self._drives_behind(index, ahead)
        if order is not None and self.rng.random() < 0.6:
            self.stated |= {f"heading.{actor.id}"} | ({f"man.{actor.id}"} if actor.maneuver == "straight" else set())
            return self.say(motion_clauses.SAME if order else motion_clauses.AHEAD, index, ahead)
        if self.crash.leg(actor.leg).curve != "none" and self.rng.random() < 0.6:  # type: ignore[union-attr]
            self.stated |= {"curve"} | ({f"man.{actor.id}"} if actor.maneuver == "negotiating_curve" else set())
            return self.say(motion_clauses.APPROACH_CURVE, index, ahead)
        alone = self.crash.layout in motion_clauses.FROM_STEM and [leg.bearing for leg in self.crash.stems] == [
            actor.leg
        ]
        if alone and actor.maneuver != "backing" and not self.held_out and self.rng.random() < UNSAID:
            return self._from_stem(actor, index, ahead, before)
        leaves = not self.held_out and actor.maneuver.startswith(LEAVES)
        moving = motion_clauses.PRESENTED["moving"] if presented else motion_clauses.APPROACH
        clauses = moving.without(self.held_out, ["goes_on"] * leaves)
        return self.say(clauses, index, ahead, appr=lambda: self._approaching(index, bool(before)))

    def _from_stem(self, actor: Actor, index: int, ahead: int | None, before: list[int]) -> str:
        """One on the leg that ends at the junction, without a word of the compass."""
        clause = self.fitting(motion_clauses.FROM_STEM[self.crash.layout], actor)
        self.stated |= {f"heading.{actor.id}"} if STEM in self.stated else set()
        return self.say([self.spoken(clause)], index, ahead, appr=lambda: self._approaching(index, bool(before)))

    def _pauses(self, index: int) -> str:
        """ "waiting" or "slowing" where an actor about to cross or turn is said to have done so; else "".

        Then the error must be told. Of turning vehicles in real narratives two in five had stopped, one in six slowed.
        """
        if index != self.who[0] or self.crash.config not in ("crossing", "left_opposite", "left_lateral", "right_into"):
            return ""
        chance, turns = self.rng.random(), self.crash.config != "crossing"
        waits, slows = (0.15, 0.15) if self.held_out else (0.4, 0.54) if turns else (0.25, 0.25)
        how = "waiting" if chance < waits else "slowing" if chance < slows else ""
        if not turns and not self.held_out and self._has_way(self.crash.actors[index]):
            how = ""
        self.waited = bool(how)
        return how

    def _has_way(self, actor: Actor) -> bool:
        """Whether the others have a sign at which they give way to one that has none."""
        own = self.crash.leg(actor.leg)
        free = own is not None and own.control == "none"
        return free and any(leg.control in ("stop", "yield") for leg in self.crash.legs)

    def _why_waiting(self, actor: Actor) -> str:
        """What for: a sign, a light, a gap in traffic, a turn."""
        control = self.crash.leg(actor.leg).control  # type: ignore[union-attr]
        keys = ["sign" if control == "stop" else "light" if control == "signal" and not self.held_out else "traffic"]
        keys += [actor.maneuver] * 2 if actor.maneuver in motion_clauses.WHY else []
        key = self.rng.choice(keys)
        if key.startswith("turn"):
            self.stated |= {f"man.{actor.id}", f"exit.{actor.id}"}
        return " " + self.reason(key, actor) if key != "traffic" else ""

    def _drives_behind(self, index: int, other: int | None) -> bool | None:
        """Whether one drives behind the other in a rear-end crash: the striker does."""
        for contact in self.crash.contacts if self.crash.config == "rear_end" else ():
            if {contact.striker, contact.struck} == {index, other}:
                return contact.striker == index
        return None

    def _why(self, actor: Actor) -> str:
        if not actor.purpose or self.rng.random() < 0.15:
            return ""
        self.stated.add(f"exit.{actor.id}")
        return " " + self.reason(actor.purpose, actor)

    def _approaching(self, index: int, later: bool) -> str:
        """What the vehicle comes to and means to do."""
        rng, actor = self.rng, self.crash.actors[index]
        text = ""
        beside = self.crash.config in ("head_on", "rear_end", "lane_change")
        if self.crash.layout in INTERSECTIONS and rng.random() < (0.9 if self.ciren and not beside else 0.4):
            same = later and (self.junction_named or self.held_out)
            place = "the same intersection" if same else self.scene_junction()
            text = " " + rng.choice(NEARING.side(False)).format(place=place)
        if actor.maneuver in motion_clauses.INTENT and rng.random() < 0.3:
            self.stated |= {f"man.{actor.id}", f"exit.{actor.id}"}
            text += (", " if text else " ") + plain(
                self.spoken(self.fitting(motion_clauses.INTENT[actor.maneuver], actor))
            )
        return text
