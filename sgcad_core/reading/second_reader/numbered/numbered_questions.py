"""What is asked of a numbered report, vehicle by vehicle, with the words around it and what the rules say.

    maneuver.V1     what it does up to its contact (a key of `numbered_answers.MANEUVERS`)
    area.V1         its side in the crash's first contact
    met.V1          what its first contact is with: vehicle, person, animal, thing, none
    junction        "yes" where roads meet
    turned.V2       how far clockwise V2 heads from V1's way: 0, 90, 180, 270
    lanes.V1        lanes of its road: "own2" of its direction, "both4" of both

A question has features, no weights. In its words the vehicle that it is about is SELF, the one that it meets OTH, any
other one THIRD; compass words are turned so that the first one about SELF is D0. So nothing depends on numbers and
directions. Knows no weights and no codes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from sgcad_core.reading.contacts.contact_records import ContactFacts
from sgcad_core.reading.crash_facts import VehicleFacts
from sgcad_core.reading.layout.layout_facts import layout_of_facts
from sgcad_core.reading.second_reader.learned_reader_features import Account
from sgcad_core.reading.second_reader.numbered.numbered_answers import (
    answer_of,
    first_contact,
    lanes_of,
    relative,
    side_of,
)
from sgcad_core.reading.second_reader.numbered.numbered_words import (
    FEW,
    Voice,
    first_way,
    grams,
    pairs,
    said_of,
    tokens,
)
from sgcad_core.reading.text.compass import COMPASS
from sgcad_core.records.facts import Fact, Status

TOLD: Mapping[Status | None, float] = {"stated": 1.0, "inferred": 0.5, "default": 0.0, None: 0.0}
"""How much the text tells of a value of the rules."""
_ABOUT, _LAST = 14, 10
"""Words of a stretch about a vehicle, and of the last one before the contact, that count."""


class Question(NamedTuple):
    """One question: its features, the rules' own answer ("+" between what is the same), and how far it is told."""

    field: str
    words: frozenset[str]
    readings: frozenset[str]
    rule: str | None
    told: float
    sentences: Mapping[int, frozenset[str]]
    """Words by the number of their sentence."""
    may: tuple[str, ...] | None = None
    """Answers that are open; None: all."""


def questions(account: Account) -> tuple[Question, ...]:
    """Every question of a report that can be asked, by what the rules found in it."""
    return tuple(_Asker(account).all()) if not account.reading.crash.unnumbered else ()


# ------------------------------------------------------------------ questions
class _Asker:
    """A report's questions."""

    def __init__(self, account: Account) -> None:
        self.account, self.crash = account, account.reading.crash
        self.said = said_of(account.statements)
        self.facts: Mapping[str, Fact] = {fact.field: fact for fact in account.reading.facts}
        self.layout = layout_of_facts(account.reading.roads)
        self.common = frozenset(self._common())

    def all(self) -> Iterator[Question]:
        """Those of every vehicle, then those of the whole."""
        first = first_contact(self.crash)
        for v in self.crash.vehicles:
            by_sentence, read = self._vehicle_words(v), frozenset(self._readings(v, first))
            yield self._asked(f"maneuver.{v.id}", by_sentence, read, self._told(f"vehicles.{v.id}.maneuver"))
            if side_of(self.crash, v.id) is not None:
                role = "striker" if first and v.id == first.striker else "struck"
                yield self._asked(f"area.{v.id}", by_sentence, read, self._told(f"contacts.0.{role}_area"))
            yield self._asked(f"met.{v.id}", by_sentence, read, 1.0)
            if lanes_of(v, self.layout) is not None:
                asked = self._asked(f"lanes.{v.id}", self._lane_words(v), read, self._lanes_told(v))
                yield asked._replace(may=self._counts(v))
        yield from self._whole()

    def _whole(self) -> Iterator[Question]:
        everybody = dict.fromkeys((v.id for v in self.crash.vehicles), "VEH")
        said = self._words(Voice(everybody, first_way(self.said)), 3)
        yield self._asked("junction", said, self.common, self._told("junction.kind"))
        if self.crash.vehicle("V1") and self.crash.vehicle("V2"):
            said = self._words(Voice({"V1": "ONE", "V2": "TWO"}, first_way(s for s in self.said if s.about("V1"))), 3)
            told = min(self._told(f"vehicles.{v}.heading") for v in ("V1", "V2"))
            yield self._asked("turned.V2", said, self.common, told)

    def _asked(
        self, field: str, by_sentence: Mapping[int, frozenset[str]], read: frozenset[str], told: float
    ) -> Question:
        own = answer_of(field, self.crash, self.layout)
        words = frozenset().union(*by_sentence.values())
        return Question(field, words, read | {f"own={own}", f"own={own}&{told}"}, own, told, by_sentence)

    def _told(self, field: str) -> float:
        fact = self.facts.get(field)
        return TOLD[fact.status if fact else None]

    # -------------------------------------------------------------- words
    def _names(self, v: VehicleFacts) -> dict[str, str]:
        partners = [
            mate
            for c in self.crash.contacts
            if v.id in (c.striker, c.struck)
            for mate in (c.striker, c.struck)
            if mate != v.id
        ]
        rest = [other.id for other in self.crash.vehicles if other is not v]
        mate = next((one for one in partners if one in rest), rest[0] if len(rest) == 1 else None)
        return {v.id: "SELF"} | ({mate: "OTH"} if mate else {})

    def _vehicle_words(self, v: VehicleFacts) -> dict[int, frozenset[str]]:
        voice = Voice(self._names(v), first_way(s for s in self.said if s.about(v.id)))
        hit = self._contact_at(v.id)
        found: dict[int, set[str]] = {}
        for one in self.said:
            shown = voice.shown(one.tokens)
            some = found.setdefault(one.number, set())
            if not one.about(v.id):
                some |= {f"N:{g}" for g in grams(shown, 2)}
                continue
            some |= {f"M:{g}" for g in grams(shown, 3)} | {f"P{_place(one.number, hit)}:{g}" for g in grams(shown, 2)}
            some |= {f"K:{g}" for g in pairs(shown)} if one.number == hit else set()
        self._stretches(v, voice, hit, found)
        return {number: frozenset(some) for number, some in found.items()}

    def _stretches(self, v: VehicleFacts, voice: Voice, hit: int | None, found: dict[int, set[str]]) -> None:
        """Adds the words of the stretches about a vehicle."""
        about = [s for s in self.account.segments if s.role != "formal" and v.id in s.subjects]
        for one in about:
            shown = voice.shown(tokens(one.text)[:_ABOUT])
            found.setdefault(one.number, set()).update(f"S:{g}" for g in grams(shown, 3))
        if before := [s for s in about if hit is None or s.number <= hit]:
            shown = voice.shown(tokens(before[-1].text)[:_LAST])
            found.setdefault(before[-1].number, set()).update(f"L:{g}" for g in grams(shown, 2))

    def _lane_words(self, v: VehicleFacts) -> dict[int, frozenset[str]]:
        """Numbers with the words around them; those of sentences about others apart."""
        voice = Voice(self._names(v), first_way(s for s in self.said if s.about(v.id)), counts=True)
        found = {}
        for one in self.said:
            tag, shown = "M" if one.about(v.id) else "N", voice.shown(one.tokens)
            runs = (g for g in (*grams(shown, 4), *pairs(shown)) if "#" in g)
            found[one.number] = frozenset({f"{tag}:{g}" for g in runs} | {f"{tag}:{w}" for w in shown})
        return found

    def _counts(self, v: VehicleFacts) -> tuple[str, ...]:
        """Lanes that numbers in sentences about a vehicle may mean: so many, each way, or of both halves."""
        numbers = {int(t.text) for one in self.said if one.about(v.id) for t in one.tokens if t.kind == "number"}
        counts = sorted({n for told in numbers if told < FEW for n in (told, 2 * told, told // 2) if n})
        return tuple(f"{scope}{n}" for scope in ("own", "both") for n in counts)

    def _words(self, voice: Voice, most: int) -> dict[int, frozenset[str]]:
        hit = self._contact_at(None)
        found = {}
        for one in self.said:
            shown = voice.shown(one.tokens)
            found[one.number] = frozenset(
                {f"U:{g}" for g in grams(shown, most)} | {f"P{_place(one.number, hit)}:{g}" for g in shown}
            )
        return found

    def _contact_at(self, vehicle: str | None) -> int | None:
        told = self.account.crash_told.contact_mentions
        mine = [m.number for m in told if vehicle is None or vehicle in (m.actor, m.other)]
        return min(mine, default=None)

    # -------------------------------------------------------------- what the rules say
    def _common(self) -> Iterator[str]:
        junction, vehicles = self.account.reading.roads.junction, self.crash.vehicles
        yield f"vehicles={min(len(vehicles), 4)}"
        yield f"junction={junction.kind}&{self._told('junction.kind')}"
        yield f"legs={len(self.layout.legs)}"
        for v in vehicles[:2]:
            yield f"{v.id}={v.maneuver}"
            yield f"{v.id}~{v.origin}~{v.target}"
        if len(vehicles) > 1:
            yield f"turned={relative(*vehicles[:2])}"
            yield f"turned={relative(*vehicles[:2])}&{vehicles[0].maneuver}&{vehicles[1].maneuver}"
        first = first_contact(self.crash)
        yield f"areas={first and (first.striker[0], first.striker_area, first.struck[0], first.struck_area)}"

    def _readings(self, v: VehicleFacts, first: ContactFacts | None) -> Iterator[str]:
        yield from (f"all {one}" for one in self.common)
        for name in (
            "maneuver",
            "heading",
            "exit_heading",
            "origin",
            "target",
            "from_stop",
            "meant_maneuver",
            "lane_word",
        ):
            if (fact := self.facts.get(f"vehicles.{v.id}.{name}")) is not None:
                value = "" if name in ("heading", "exit_heading") else fact.value
                yield f"{name}={value}:{fact.rule}"
                yield f"{name}={value}:{fact.status}"
        motion = self.account.crash_told.motions.get(v.id)
        cues = [cue.kind for cue in motion.cues] if motion else []
        yield from (f"deed={kind}" for kind in cues)
        yield from (f"last={kind}" for kind in cues[-1:])
        yield f"deeds={'>'.join(cues[-3:])}"
        yield from self._contact_readings(v, first)

    def _contact_readings(self, v: VehicleFacts, first: ContactFacts | None) -> Iterator[str]:
        mine = self.crash.first_contact(v.id)
        yield f"first={mine is first}&{mine is None}"
        if mine is not None:
            hits = v.id == mine.striker
            own, theirs = (mine.striker_area, mine.struck_area) if hits else (mine.struck_area, mine.striker_area)
            other = self.crash.vehicle(mine.struck if hits else mine.striker)
            yield f"side={own}"
            yield f"sides={own}&{theirs}&{hits}"
            yield f"sides={own}&{theirs}&{v.maneuver}&{other.maneuver if other else None}"
            yield f"with={other.maneuver if other else None}&{v.maneuver}"
            if other is not None:
                yield f"way={relative(v, other)}&{own}&{theirs}"
                yield f"way={relative(v, other)}&{v.maneuver}"
        for mention in [m for m in self.account.crash_told.contact_mentions if v.id in (m.actor, m.other)][:2]:
            own_zone, other_zone = mention.areas_of(v.id)
            yield f"told {own_zone}&{other_zone}&{mention.actor == v.id}&{mention.passive}&{mention.mutual}"
            yield f"told {own_zone}"

    def _lanes_told(self, v: VehicleFacts) -> float:
        axis = COMPASS[COMPASS.index(v.heading) % 4] if v.heading else None
        road = next((r for r in self.account.reading.roads.streets if r.axis == axis), None)
        return float(
            road is not None and bool(road.lanes.total or road.lanes.each_way or road.lanes.toward or road.lanes.own)
        )


def _place(number: int, hit: int | None) -> str:
    if hit is None:
        return "n"
    return "b" if number < hit else "c" if number == hit else "a"
