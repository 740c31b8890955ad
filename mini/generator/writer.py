"""One crash to a narrative: which sentences, in which order, with which words, and which facts they tell.

`Writer.write()` returns the text; `told` then holds keys such as "heading.V1", "lanes.0" (road of bearings 0
and 4), "limit.2", "areas.0", "light". Facts are told where a slot that holds them was really used.
"""

from __future__ import annotations

from random import Random

from mini.generator import clauses_motion as motion
from mini.generator import words
from mini.generator.blocks import BlocksMixin
from mini.generator.events import EventsMixin
from mini.generator.grammar import HINT, MARK, SLOTS, Told, Written, clause_of, fill, sentence, unmark
from mini.generator.mentions import Mentions
from mini.generator.noise import join, slips
from mini.generator.notes import Slots, noted
from mini.generator.scene import SceneMixin
from mini.generator.settled import FROM_LEFT
from mini.generator.world import WORDS, Actor, Crash

CIREN_ORDER = (
    "approach",
    "conditions",
    "critical",
    "avoid",
    "impact",
    "rest",
    "tow",
    "occupant",
    "occupant",
    "interview",
)
PRONOUNS = ("he", "He", "his", "His")
"""Slots of words for the driver of the one whom a clause is about."""


class Writer(SceneMixin, EventsMixin, BlocksMixin):
    """State of one report while it is written."""

    def __init__(self, rng: Random, crash: Crash, held_out: bool, length: float) -> None:
        self.rng, self.crash, self.held_out, self.length = rng, crash, held_out, length
        self.ciren = rng.random() < 0.45
        self.mentions = Mentions(rng, crash, self.ciren)
        self.told = Told()
        self.sentences: list[frozenset[str]] = []
        """Facts of every sentence that was written, by the number of its mark."""
        self.stated: set[str] = set()
        self.who = self.culprit()
        self.people: dict[int, dict[str, str]] = {}
        """Age, sex and pronouns of the drivers, by actor."""
        self.lately: set[int] = set()
        """Who was named since the block on a vehicle began: pronouns of its driver say whom they mean."""
        self.waited = False
        """Whether the one who errs stood or slowed before it crossed or turned."""
        self.roads_left = rng.random() < 0.85
        """Whether the report tells lanes at all."""

    # -------------------------------------------------------------- text
    def write(self) -> str:
        """The narrative."""
        sentences, breaks = self._ciren() if self.ciren else self._nmvccs()
        text = join(self.rng, sentences, breaks, squeeze=not self.ciren and self.rng.random() < 0.06)
        return slips(self.rng, text, self.rng.choice((0.0, 0.0, 0.002, 0.006)))

    def _ciren(self) -> tuple[list[str], list[int]]:
        out = self._approaches()
        if self.rng.random() < 0.6:
            out += self._control_sentence(0.5)
        out += self._conditions(0.94)
        out += self.events()
        out += (
            self._noise("tow", 1.0)
            + self._noise("occupant", 3.5)
            + self._noise("interview", 0.4)
            + self._noise("police", 0.2)
        )
        return out, [len(out) // 2] if self.rng.random() < 0.15 else []

    def _nmvccs(self) -> tuple[list[str], list[int]]:
        rng = self.rng
        opening = self._opening() if rng.random() < 0.96 else []
        scene = self._road_sentences() + self._control_sentence(0.6)
        conditions = self._conditions(0.77)
        head = opening + (scene + conditions if rng.random() < 0.7 else conditions + scene)
        breaks = [len(head)]
        approaches = self._approaches()
        head = [*head, *self._noise("noncontact", 0.15), *approaches, *self.events()]
        for index in range(min(len(self.crash.actors), 2)):
            breaks.append(len(head))
            head += self._about(index)
        if rng.random() < 0.1:
            head = head[1:] if not opening else head
        return head, breaks

    def finish(self, text: str) -> Written:
        """The plain text and what it tells where."""
        plain, marks, notes = unmark(text)
        return Written(plain, [(end, self.sentences[number]) for end, number in marks], notes)

    # -------------------------------------------------------------- parts, for depleted reports
    def aftermath(self) -> list[str]:
        """Only what came after: towing, occupants, interviews, codes."""
        groups = ("tow", "occupant", "occupant", "health", "codes", "police", "tow", "interview")
        return [text for group in groups for text in self._noise(group, 1.0)] or self._noise(
            "tow", 2.0 / max(self.length, 0.1)
        )

    def place(self) -> list[str]:
        """Only the place and the conditions."""
        return self._opening() + self._road_sentences() + self._conditions(0.7)

    def scene_and_approach(self) -> list[str]:
        """Place and approaches."""
        return (self._opening() if not self.ciren else []) + self._approaches()

    # -------------------------------------------------------------- slots
    def say(
        self, options: list[str], v: int = 0, w: int | None = None, touching: dict[str, str] | None = None, **extra: str
    ) -> str:
        """One sentence of a role about actors v and w; `touching`: the sides that its slots `sa` and `ta` name."""
        clause = clause_of(self.rng, options, self.held_out)
        other = w if w is not None else next((i for i in range(len(self.crash.actors)) if i != v), v)
        self.told |= self._hints(clause, v, other)
        slots = Slots(clause, self.crash.actors[v], self.crash.actors[other], touching or {}, extra)

        def filled(slot: str) -> str:
            text = self._slot(slot, v, other, extra)
            meant = [f"id={self.id_of(v)}"] if slot in PRONOUNS and v in self.lately else []
            return noted(text, slots.next(slot) + meant)

        text = sentence(fill(clause, filled))
        self.sentences.append(self.told.take())
        return text + chr(MARK + len(self.sentences) - 1)

    def _hints(self, clause: str, v: int, w: int) -> set[str]:
        """How a clause is built, which is no fact of the crash but what its facts are read from: who is named first and
        second, and whether an impact is told from the one who strikes (active) or from the one who is struck."""
        named = [slot for slot in SLOTS.findall(clause) if slot in "VWST"]
        order = list(dict.fromkeys(v if slot in "VS" else w for slot in named))
        hints = {f"{HINT}named{place}.{self.id_of(index)}" for place, index in enumerate(order[:2])}
        if "S" in named and "T" in named:
            hints.add(f"{HINT}voice.{'active' if named[0] == 'S' else 'passive'}")
        return hints

    def _slot(self, slot: str, v: int, w: int, extra: dict[str, str]) -> str:
        if slot in extra:
            return extra[slot]
        if slot in ("Vf", "Vi"):
            self.lately.add(v)
            text, kind = self.mentions.full(v) if slot == "Vf" else self.mentions.presented(v)
            self.told |= {f"kind.{self.id_of(v)}"} if kind else set()
            return text
        if slot in ("V", "W", "S", "T"):
            return self._mention(v if slot in ("V", "S") else w)
        if slot in ("dir", "xb", "opp", "from", "lane", "W0", "side0", "surf0"):
            return self._motion_slot(slot, v, w)
        if slot in ("any4", "any8", "any8b", "anyside", "deg", "m", "k", "kk", "spd"):
            return self._noise_slot(slot, v)
        return self._scene_slot(slot, v)

    def _mention(self, index: int) -> str:
        self.lately.add(index)
        if index not in self.mentions.introduced and self.rng.random() < 0.5:
            text, kind = self.mentions.full(index)
            self.told |= {f"kind.{self.id_of(index)}"} if kind else set()
            return text
        self.told |= {f"kind.{self.id_of(index)}"} if not self.id_of(index).startswith("V") else set()
        return self.mentions.name(index)

    def _motion_slot(self, slot: str, v: int, w: int) -> str:
        actor = self.crash.actors[v]
        if slot in ("dir", "xb", "from"):
            self.told.add(f"heading.{actor.id}")
        if slot == "dir":
            return words.direction(self.rng, actor.heading, self.held_out)
        if slot == "from":
            return WORDS[actor.leg]
        if slot == "lane":
            leg = self.crash.leg(actor.leg)
            xb = words.bound(self.rng, actor.heading)
            name, from_left = words.lane(self.rng, leg, actor.lane, xb, self.held_out)  # type: ignore[arg-type]
            self.told |= {f"lane.{actor.id}"} | ({f"{FROM_LEFT}.{actor.id}"} if from_left else set())
            return name  # the leg is there: actors stand on legs
        bearing = {"xb": actor.heading, "opp": actor.leg}.get(slot)
        if bearing is not None:
            return words.bound(self.rng, bearing)
        return {
            "W0": "vehicle",
            "side0": self.rng.choice(("left", "right")),
            "surf0": {"ice": "icy", "snow": "snowy"}.get(self.crash.surface, self.crash.surface),
        }[slot]

    def id_of(self, index: int) -> str:
        return self.crash.actors[index].id

    # -------------------------------------------------------------- approach
    def _approaches(self) -> list[str]:
        actors = self.crash.actors
        order = [i for i, a in enumerate(actors) if a.id.startswith("V")]
        if self.rng.random() < 0.12:
            self.rng.shuffle(order)
        if not self.ciren and len(order) > 1 and self.rng.random() < 0.04:
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
            "stopped": motion.APPROACH_STOPPED,
            "parked": motion.APPROACH_PARKED,
            "slowing": motion.APPROACH_SLOWING,
        }.get(actor.maneuver)
        presented = not self.ciren and index not in self.mentions.introduced and self.rng.random() < 0.22
        if options:
            why = self._why(actor)
            self.told |= {f"man.{actor.id}"} | ({f"exit.{actor.id}"} if why or not actor.meant else set())
            if presented and actor.maneuver in motion.PRESENTED:
                options = motion.PRESENTED[actor.maneuver]
            return self.say(options, index, ahead, why=why)
        if how := self._pauses(index):
            options = motion.APPROACH_SLOWING if how == "slowing" else motion.APPROACH_WAITING
            return self.say(motion.PRESENTED[how] if presented else options, index, ahead, why=self._why_waiting(actor))
        order = self._behind(index, ahead)
        if order is not None and self.rng.random() < 0.6:
            self.told |= {f"heading.{actor.id}"} | ({f"man.{actor.id}"} if actor.maneuver == "straight" else set())
            return self.say(motion.SAME if order else motion.AHEAD, index, ahead)
        if self.crash.leg(actor.leg).curve != "none" and self.rng.random() < 0.6:  # type: ignore[union-attr]
            self.told |= {"curve"} | ({f"man.{actor.id}"} if actor.maneuver == "negotiating_curve" else set())
            return self.say(motion.APPROACH_CURVE, index, ahead)
        options = motion.PRESENTED["moving"] if presented else motion.APPROACH
        return self.say(options, index, ahead, appr=self._approaching(index, bool(before)))

    def _pauses(self, index: int) -> str:
        """ "waiting" or "slowing" where one who is about to cross or turn is said to have done so; else "".

        Then the error must be told. Of turning vehicles in real narratives two in five had stopped, one in six slowed.
        """
        if index != self.who[0] or self.crash.config not in ("crossing", "left_opposite", "left_lateral", "right_into"):
            return ""
        chance, turns = self.rng.random(), self.crash.config != "crossing"
        waits, slows = (0.15, 0.15) if self.held_out else (0.4, 0.54) if turns else (0.25, 0.25)
        how = "waiting" if chance < waits else "slowing" if chance < slows else ""
        self.waited = bool(how)
        return how

    def _why_waiting(self, actor: Actor) -> str:
        """What for: a sign, a light, a gap in traffic, a turn."""
        control = self.crash.leg(actor.leg).control  # type: ignore[union-attr]
        keys = ["sign" if control == "stop" else "light" if control == "signal" and not self.held_out else "traffic"]
        keys += [actor.maneuver] * 2 if actor.maneuver in motion.WHY else []
        key = self.rng.choice(keys)
        if key.startswith("turn"):
            self.told |= {f"man.{actor.id}", f"exit.{actor.id}"}
        return " " + self.reason(key, actor) if key != "traffic" else ""

    def _behind(self, index: int, other: int | None) -> bool | None:
        """Whether one drives behind the other in a rear-end crash: the striker does."""
        for contact in self.crash.contacts if self.crash.config == "rear_end" else ():
            if {contact.striker, contact.struck} == {index, other}:
                return contact.striker == index
        return None

    def _why(self, actor: Actor) -> str:
        if not actor.purpose or self.rng.random() < 0.15:
            return ""
        return " " + self.reason(actor.purpose, actor)

    def _approaching(self, index: int, later: bool) -> str:
        """What the vehicle comes to and means to do."""
        rng, actor = self.rng, self.crash.actors[index]
        text = ""
        beside = self.crash.config in ("head_on", "rear_end", "lane_change")
        if self.crash.layout in ("four", "t") and rng.random() < (0.9 if self.ciren and not beside else 0.4):
            place = "the same intersection" if later else self.scene_junction()
            text = " " + rng.choice((f"and was approaching {place}", f"approaching {place}", f"and approached {place}"))
        if actor.maneuver in motion.INTENT and rng.random() < 0.3:
            self.told |= {f"man.{actor.id}", f"exit.{actor.id}"}
            text += (", " if text else " ") + self.fitting(motion.INTENT[actor.maneuver])
        return text
