"""How a report names a road: how many lanes, which way, divided by what; a part of the writer."""

from __future__ import annotations

from random import Random

from research.generator import phrase_labels, phrase_notes, words
from research.generator.clauses import clause_words, road_clauses
from research.generator.clauses.lane_lists import split
from research.generator.crash.compass_ties import AXIS, FLOW, ROAD_HINT, VAGUE
from research.generator.crash.world import Crash, Leg
from research.generator.grammar import StatedFacts, clause_of
from research.generator.phrase_labels import has, plain
from research.generator.records import Group, slots_of
from sgcad_core.kinds import DRIVEWAY, INTERSECTIONS, RAMP, ROAD

UNCOUNTED = 0.5
"""Share of one-way roads whose lanes nobody counts: in real reports most often there is one."""


class RoadsMixin:
    """Noun phrases for roads; needs the writer's fields."""

    rng: Random
    crash: Crash
    held_out: bool
    ciren: bool
    stated: StatedFacts
    worded: set[str]
    roads_left: bool
    spoken_of: int | None
    counted: list[int]
    totals: dict[int, int]

    def _legs_on(self, axis: int) -> list[Leg]:
        return [leg for leg in self.crash.legs if leg.bearing % 4 == axis % 4]

    @property
    def _first(self) -> int:
        """Axis of the road that the scene is told of first: the main one, unless all are on the one that crosses it."""
        crossing = self.crash.layout in INTERSECTIONS and not any(self.crash.is_main(a.leg) for a in self.crash.actors)
        return (self.crash.main + 2 * crossing) % 4

    def _road(self, axis: int, bare: bool = False) -> str:
        """A noun phrase for a road; tells its lanes unless they were told or the report keeps them back."""
        rng, legs = self.rng, self._legs_on(axis)
        self.stated.add(f"{ROAD_HINT}.{axis % 4}")
        leg = legs[0] if legs else self.crash.legs[0]
        if leg.kind != ROAD and len(legs) == 1:
            self.stated |= {"layout"}
            driveway = clause_of(rng, clause_words.ACCESS[DRIVEWAY], False)
            return driveway if leg.kind == DRIVEWAY else clause_words.ACCESS[RAMP].side(False)[0]
        key = f"lanes.{axis % 4}"
        if not bare and (key in self.worded or not self.roads_left):
            if not self.held_out and self._differs(leg) and rng.random() < 0.7:
                self.spoken_of = axis % 4
                again = road_clauses.TWO_WAY_AGAIN if leg.two_way else road_clauses.ONE_WAY_AGAIN
                return plain(self._uncounted(leg, again, clause_of(rng, road_clauses.ROAD_WORD, False)))
            return self._again(axis % 4)
        self.worded.add(key)
        self.spoken_of = axis % 4
        text, told = self._lanes_text(leg, legs)
        self.stated |= {key} if told else set()
        median = f"median.{axis % 4}"
        if leg.median == "none" or has(text, "by_what"):
            self.stated.add(median)
        elif has(text, "divided"):
            self.stated |= {median, f"{VAGUE}.{median}"}
        text = plain(text)
        if not (bare or self.held_out or axis % 4 == self._first or rng.random() < 0.75):
            others = ("intersecting", "intersecting", "crossing", "other" if leg.two_way else "crossing")
            text = f"the {rng.choice(others)} {text.removeprefix('a ').removeprefix('an ')}"
        return text if bare else self._noted(text, leg, legs, told)

    def _noted(self, text: str, leg: Leg, legs: list[Leg], told: bool) -> str:
        """A phrase for a road with its note; `told`: whether it tells the lanes for sure."""
        axis = leg.bearing % 4
        if axis not in self.counted:
            self.counted.append(axis)
        ways = {lanes for lanes in (leg.lanes_in, leg.lanes_out) if lanes}
        even = told and len(ways) == 1 and not any(side.turns_in for side in legs)
        return phrase_notes.road(text, self.counted.index(axis), axis, max(ways) if even else 0, not leg.two_way)

    def _again(self, axis: int) -> str:
        """A road of which no more is told: "the same road" is the one that was named last."""
        rng, last, self.spoken_of = self.rng, self.spoken_of, axis
        if axis != self._first:
            return clause_of(rng, clause_words.AGAIN["other"], False)
        if last not in (axis, None):
            self.stated.add(f"{AXIS}.{axis}")
            run = words.axis(rng, axis)
            return clause_of(rng, clause_words.AGAIN["axis"], False).format(axis=run)
        return clause_of(rng, clause_words.AGAIN["same" if last == axis else "first"], False)

    def _lanes_text(self, leg: Leg, legs: list[Leg]) -> tuple[str, bool]:
        """`a four-lane, two-way urban road (...)` with its labels and whether that tells the lanes for sure."""
        rng = self.rng
        kind = rng.choice((self.crash.area_word, "", "", "residential", "asphalt")).replace("highway", "limited access")
        turns = any(side.turns_in for side in legs)
        simple = not turns and not (leg.twltl and leg.lanes_in != leg.lanes_out)
        if not leg.two_way and not self.held_out and rng.random() < UNCOUNTED:
            noun = f"{kind} {clause_of(rng, road_clauses.ROAD_WORD, False)}".strip()
            return self._uncounted(leg, road_clauses.UNCOUNTED, noun), False
        if simple and not self.held_out and rng.random() < words.MORE:
            return self._further(leg, f"{kind} {clause_of(rng, road_clauses.ROAD_WORD, False)}".strip()), True
        return self._counted_lanes(leg, legs, kind, turns)

    def _counted_lanes(self, leg: Leg, legs: list[Leg], kind: str, turns: bool) -> tuple[str, bool]:
        """The same in words that follow counts of real reports."""
        rng, even = self.rng, leg.lanes_in == leg.lanes_out and not leg.turns_in and not leg.twltl
        bracket = rng.random() < (0.75 if not even else 0.25 * self.ciren)
        total = self._total(leg, legs, bracket)
        word = f"{kind} {clause_of(rng, clause_words.ROAD_NOUN, False)}".strip()
        n = rng.choice((words.NUMBERS[total], words.NUMBERS[total], str(total))) + rng.choice(
            ("-lane", "-lane", " lane")
        )
        if not leg.two_way:
            return self._one_way(leg, n, word), not turns
        divided = f" {clause_words.DIVIDER[leg.median].side(False)[0]}" if leg.median in clause_words.DIVIDER else ""
        if not turns and not leg.twltl and not self.held_out and rng.random() < 0.3:
            return self._ways_text(leg, even, total, word) + divided, True
        if even and leg.lanes_in > 1 and not bracket and rng.random() < 0.35 and not turns:
            before = clause_of(rng, clause_words.BESIDE["parted" if divided else "open"], False)
            return f"a {before}{word} with {words.NUMBERS[leg.lanes_in]} lanes in each direction{divided}", True
        painted = leg.median == "painted" and not self.held_out
        ways = clause_words.WAYS["painted" if painted else "parted" if divided else "open"]
        text = self._counted(n, clause_of(rng, ways, False), word)
        told = (even and not turns) or (leg.twltl and total in (3, 5))
        if bracket:
            named = phrase_labels.mark("by_what") * (leg.median in clause_words.IN_BRACKETS)
            text, told = f"{text} {self._bracket(leg, legs)}{named}", True
            self.stated.add(f"turns.{leg.bearing % 4}")
        elif divided and rng.random() < 0.5:
            text += divided
        elif leg.twltl and rng.random() < 0.5:
            text += " with a center turn lane"
        return text, told

    def _total(self, leg: Leg, legs: list[Leg], bracket: bool) -> int:
        """Lanes of a road as they are counted; investigators often count the lanes that go on only, while a drawing
        shows the others."""
        other = legs[1].lanes_in if bracket and len(legs) > 1 else leg.lanes_out
        total = min(leg.lanes_in + other + leg.twltl, len(words.NUMBERS) - 1)
        extra = sum(use in ("left", "right") for use in leg.turns_in)
        if not bracket and extra and leg.lanes_in > extra and self.rng.random() < 0.4:
            total -= extra
        if bracket:
            self.totals[leg.bearing % 4] = total
        elif not self.held_out:
            total = self.totals.setdefault(leg.bearing % 4, total)
        return total

    def _further(self, leg: Leg, noun: str) -> str:
        """A phrase of `road_clauses` for a road without turn lanes at the junction, whatever its lanes."""
        rng, axis = self.rng, leg.bearing % 4
        total = words.NUMBERS[min(leg.lanes_in + leg.lanes_out + leg.twltl, len(words.NUMBERS) - 1)]
        to, fro = words.bound(rng, leg.bearing + 4), words.bound(rng, leg.bearing)
        if not leg.two_way:
            xb, count = (to, leg.lanes_in) if leg.lanes_in else (fro, leg.lanes_out)
            clause = clause_of(rng, road_clauses.ONE_WAY, False)
            self._flowing(leg, clause)
            return road_clauses.put(clause, noun=noun, n=total, lanes=words.lanes(count), xb=xb)
        if leg.lanes_in != leg.lanes_out:
            self.stated.add(f"{AXIS}.{axis}")
            a, b = self._sides(leg, to, fro)
            a, b = (a, b) if rng.random() < 0.5 else (b, a)
            return road_clauses.phrase(rng, road_clauses.SIDES, noun=noun, a=a, b=b)
        by_median = road_clauses.EVEN if leg.median == "none" else road_clauses.DIVIDED
        options = road_clauses.CENTER_TURN if leg.twltl else by_median
        median = road_clauses.phrase(rng, road_clauses.MEDIAN[leg.median]) if leg.median in road_clauses.MEDIAN else ""
        return road_clauses.phrase(rng, options, noun=noun, n=total, each=words.lanes(leg.lanes_in), median=median)

    @staticmethod
    def _sides(leg: Leg, to: str, fro: str) -> list[str]:
        """`two northbound lanes` and `one southbound lane`: the lanes into the hub and out of it by a leg."""
        back = (leg.bearing + 4) % 8
        return [
            phrase_notes.item(words.lanes(leg.lanes_in, to), leg.bearing, "through", leg.lanes_in),
            phrase_notes.item(words.lanes(leg.lanes_out, fro), back, "through", leg.lanes_out),
        ]

    def _counted(self, n: str, ways: str, word: str) -> str:
        """`a four-lane, two-way road`, `a level two lane undivided roadway`, `a two-way, two-lane street`."""
        rng, looks = self.rng, ""
        if not self.ciren and not self.held_out and rng.random() < 0.2:
            looks = f"{clause_of(rng, clause_words.LOOKS, False)} "
        comma = rng.choice((",", ",", ""))
        if not self.held_out and rng.random() < 0.15:
            return f"a {looks}{ways}{comma} {n} {word}"
        return f"a {looks}{n}{comma} {ways} {word}"

    def _one_way(self, leg: Leg, n: str, word: str) -> str:
        """`a one-lane, one-way street`, `a northbound one-way roadway with two lanes of travel`."""
        rng, lanes = self.rng, max(leg.lanes_in, leg.lanes_out)
        xb = words.bound(rng, leg.flow)
        travel = "" if self.held_out else clause_of(rng, clause_words.TRAVEL, False)
        clause = clause_of(rng, clause_words.ONE_WAY, self.held_out)
        self._flowing(leg, clause)
        return clause.format(n=n, noun=word, xb=xb, travel=travel, count=words.lanes(lanes))

    def _flowing(self, leg: Leg, clause: str) -> None:
        """Note of a phrase for a one-way street that tells the way that its traffic goes, if it does."""
        self.stated |= {f"{hint}.{leg.bearing % 4}" for hint in (AXIS, FLOW)} if "xb" in slots_of(clause) else set()

    def _differs(self, leg: Leg) -> bool:
        """Whether one of two roads is one-way: this or the other."""
        ways = {side.bearing % 4: side.two_way for side in self.crash.legs if side.kind == ROAD}
        return list(ways.values()).count(False) == 1 and (not leg.two_way or len(ways) > 1)

    def _uncounted(self, leg: Leg, options: Group, noun: str) -> str:
        """A phrase that says whether a road is one-way and leaves open how many lanes it has."""
        xb = words.bound(self.rng, leg.flow)
        self.stated.add(f"ways.{leg.bearing % 4}")
        clause = clause_of(self.rng, options, False)
        self._flowing(leg, clause)
        return road_clauses.put(clause, noun=noun, xb=xb)

    def _ways_text(self, leg: Leg, even: bool, total: int, word: str) -> str:
        """`a road with two northbound lanes and one southbound lane` and the like."""
        rng = self.rng
        kind = clause_of(rng, clause_words.BEFORE["open" if leg.median == "none" else "parted"], False)
        if even and rng.random() < 0.6:
            way = clause_of(rng, clause_words.EACH_DIRECTION, False)
            each = {"each": words.lanes(leg.lanes_in), "half": words.NUMBERS[leg.lanes_in], "way": way}
            text = clause_of(rng, clause_words.EVEN, False)
            return text.format(kind=kind, noun=word, total=words.NUMBERS[total], **each)
        to, fro = words.bound(rng, leg.bearing + 4), words.bound(rng, leg.bearing)
        lanes = self._sides(leg, to, fro)
        rng.shuffle(lanes)
        self.stated.add(f"{AXIS}.{leg.bearing % 4}")
        return clause_of(rng, clause_words.SIDES, False).format(kind=kind, noun=word, a=lanes[0], b=lanes[1])

    def _bracket(self, leg: Leg, legs: list[Leg]) -> str:
        back = legs[1] if len(legs) > 1 else Leg((leg.bearing + 4) % 8, leg.lanes_out, leg.lanes_in)
        rng = self.rng
        self.stated.add(f"{AXIS}.{leg.bearing % 4}")
        return split(rng, leg, back, words.bound(rng, leg.bearing + 4), words.bound(rng, leg.bearing), self.held_out)

    def _axis_of(self, slot: str) -> int:
        """Axis of the road whose limit a slot names."""
        return (self._first + 2 * (slot == "lim2")) % 4

    def _limit_of(self, slot: str) -> int | None:
        """The limit of the road that a slot names; None where none is set."""
        return next((leg.limit for leg in self._legs_on(self._axis_of(slot)) if leg.limit), None)

    def _limit(self, slot: str) -> str:
        axis, limit = self._axis_of(slot), self._limit_of(slot)
        self.spoken_of = axis
        self.stated |= {f"limit.{axis}", *({f"{ROAD_HINT}.{axis}"} if slot == "lim2" else ())}  # "the side street"
        assert limit is not None  # noqa: S101 - clauses are chosen so
        return words.limit(self.rng, limit, self.held_out)
