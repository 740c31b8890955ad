"""One crash to a narrative: which sentences, in which order, with which words, and which facts they tell.

`Writer.write()` returns the text; `told` then holds keys such as "heading.V1", "lanes.0" (road of bearings 0
and 4), "limit.2", "areas.0", "light". Facts are told where a slot that holds them was really used.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from random import Random

from research.generator import words
from research.generator.clauses.noise_blocks import BlocksMixin
from research.generator.crash.approaches import ApproachMixin
from research.generator.crash.compass_ties import AXIS, FROM_LEFT
from research.generator.crash.scene import SceneMixin
from research.generator.crash.world import WORDS, Crash
from research.generator.events import EventsMixin
from research.generator.grammar import HINT, MARK, StatedFacts, Written, clause_of, fill, sentence, unmark
from research.generator.mentions import Mentions
from research.generator.noise import join, slips
from research.generator.phrase_labels import has
from research.generator.phrase_notes import Slots, noted
from research.generator.records import Group, slots_of

Words = str | Callable[[], str]
PRONOUNS = ("he", "He", "his", "His")
"""Slots of words for the driver of the one whom a clause is about."""


class Writer(SceneMixin, ApproachMixin, EventsMixin, BlocksMixin):
    """State of one report while it is written."""

    def __init__(self, rng: Random, crash: Crash, held_out: bool, length: float) -> None:
        self.rng, self.crash, self.held_out, self.length = rng, crash, held_out, length
        self.ciren = rng.random() < 0.45
        self.mentions = Mentions(rng, crash, self.ciren)
        self.stated = StatedFacts()
        self.sentences: list[frozenset[str]] = []
        """Facts of every sentence that was written, by the number of its mark."""
        self.worded: set[str] = set()
        self.who = self.culprit()
        self.people: dict[int, dict[str, str]] = {}
        """Age, sex and pronouns of the drivers, by actor."""
        self.lately: set[int] = set()
        """Who was named since the block on a vehicle began: pronouns of its driver say whom they mean."""
        self.spoken_of: int | None = None
        """Axis of the road that was named last."""
        self.counted: list[int] = []
        """Axes of the roads that phrases described, in the order of the text; bare phrases stand beside an axis."""
        self.totals: dict[int, int] = {}
        """Lanes of the road of an axis as they are counted throughout the report: with those for turns or without."""
        self.of_road = False
        """Whether the sentence is of the road: then a direction is that of its traffic, and of no vehicle."""
        self.waited = self.junction_named = False
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
        self,
        options: Group | Sequence[str],
        v: int = 0,
        w: int | None = None,
        touching: dict[str, str] | None = None,
        **extra: Words,
    ) -> str:
        """One sentence of a role about actors v and w; `touching`: the sides that its slots `sa` and `ta` name.

        `extra`: words for further slots, or what makes them and tells their facts where the clause has such a slot.
        """
        clause = clause_of(self.rng, options, self.held_out)
        other = w if w is not None else next((i for i in range(len(self.crash.actors)) if i != v), v)
        self.stated |= self._hints(clause, v, other)
        slots = Slots(clause, self.crash.actors[v], self.crash.actors[other], touching or {}, extra)
        others = has(clause, "third")

        def filled(slot: str) -> str:
            text = self._slot(slot, v, other, extra)
            meant = [f"id={self.id_of(v)}"] if slot in PRONOUNS and not others and v in self.lately else []
            return noted(text, slots.next(slot) + meant)

        text = sentence(fill(clause, filled))
        if others:  # and whoever "he" is after that
            self.lately.discard(v)
        self.sentences.append(self.stated.take())
        return text + chr(MARK + len(self.sentences) - 1)

    def _hints(self, clause: str, v: int, w: int) -> set[str]:
        """How a clause is built, which is no fact of the crash but what its facts are read from: the actors named
        first and second, and whether an impact is told from the striker (active) or from the struck one."""
        named = [slot for slot in slots_of(clause) if slot in "VWST"]
        order = list(dict.fromkeys(v if slot in "VS" else w for slot in named))
        hints = {f"{HINT}named{place}.{self.id_of(index)}" for place, index in enumerate(order[:2])}
        if "S" in named and "T" in named:
            hints.add(f"{HINT}voice.{'active' if named[0] == 'S' else 'passive'}")
        return hints

    def _slot(self, slot: str, v: int, w: int, extra: Mapping[str, Words]) -> str:
        if slot in extra:
            given = extra[slot]
            return given if isinstance(given, str) else given()
        if slot in ("Vf", "Vi"):
            self.lately.add(v)
            text, kind = self.mentions.full(v) if slot == "Vf" else self.mentions.presented(v)
            self.stated |= {f"kind.{self.id_of(v)}"} if kind else set()
            return text
        if slot in ("V", "W", "S", "T"):
            return self._mention(v if slot in ("V", "S") else w)
        if slot in ("dir", "xb", "opp", "from", "lane", "outdir", "outxb", "W0", "side0", "surf0"):
            return self._motion_slot(slot, v, w)
        if slot in ("any4", "any8", "any8b", "anyside", "deg", "m", "k", "kk", "spd"):
            return self._noise_slot(slot, v)
        return self._scene_slot(slot, v)

    def _mention(self, index: int) -> str:
        self.lately.add(index)
        if index not in self.mentions.introduced and self.rng.random() < 0.5:
            text, kind = self.mentions.full(index)
            self.stated |= {f"kind.{self.id_of(index)}"} if kind else set()
            return text
        self.stated |= {f"kind.{self.id_of(index)}"} if not self.crash.actors[index].vehicle else set()
        return self.mentions.name(index)

    def _motion_slot(self, slot: str, v: int, w: int) -> str:
        actor = self.crash.actors[v]
        if slot in ("dir", "xb", "from"):
            self.stated.add(f"{AXIS}.{actor.leg % 4}" if self.of_road else f"heading.{actor.id}")
        if slot == "dir":
            return words.direction(self.rng, actor.heading, self.held_out)
        if slot == "from":
            return WORDS[actor.leg]
        if slot in ("outdir", "outxb"):  # of one that turns: with the turn, where it goes tells where it came from
            self.stated |= {f"{fact}.{actor.id}" for fact in ("heading", "man", "exit")}
            assert actor.out is not None  # noqa: S101 - who turns takes a leg
            return WORDS[actor.out] if slot == "outdir" else words.bound(self.rng, actor.out)
        if slot == "lane":
            leg = self.crash.leg(actor.leg)
            xb = words.bound(self.rng, actor.heading)
            name = words.lane(self.rng, leg, actor.lane, xb, self.held_out)  # type: ignore[arg-type]
            self.stated |= {f"heading.{actor.id}"} if name.headed else set()
            self.stated |= {f"lane.{actor.id}"} | ({f"{FROM_LEFT}.{actor.id}"} if name.from_left else set())
            return name.text  # the leg is there: actors stand on legs
        bearing = {"xb": actor.heading, "opp": actor.leg}.get(slot)
        if bearing is not None:
            return words.bound(self.rng, bearing)
        if slot == "surf0":
            self.stated.add("surface")
        return {
            "W0": "vehicle",
            "side0": self.rng.choice(("left", "right")),
            "surf0": {"ice": "icy", "snow": "snowy"}.get(self.crash.surface, self.crash.surface),
        }[slot]

    def id_of(self, index: int) -> str:
        return self.crash.actors[index].id
