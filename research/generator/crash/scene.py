"""The scene sentences of a report: opening, roads, control, conditions; a part of the writer."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

from research.generator import words
from research.generator.clauses import road_clauses, scene_clauses
from research.generator.clauses.junction_phrases import JunctionMixin
from research.generator.clauses.lane_lists import lane_phrase
from research.generator.crash import conditions
from research.generator.crash.compass_ties import AXIS, FLOW, ROAD_HINT, STEM
from research.generator.crash.world import WORDS, Leg
from research.generator.grammar import choose, sided
from research.generator.phrase_labels import has, mark, plain
from research.generator.phrase_notes import placed
from research.generator.records import Group, slots_of
from sgcad_core.kinds import DRIVEWAY, FOUR, INTERSECTIONS, MERGE, ROAD, T

DAYS = ("weekday", "weekday", "weekend", "Saturday", "Friday")
_DARK = ("early morning", "evening", "evening", "night", "night", "late evening")
TIMES = {
    "day": ("morning", "morning", "early morning", "afternoon", "afternoon", "late afternoon", "mid-morning"),
    "dawn": ("morning", "early morning", "early morning"),
    "dusk": ("evening", "evening", "early evening"),
    "dark": _DARK,
    "dark_lit": _DARK,
}
"""Times of day that agree with the light."""
PASSED_OVER = 0.35
"""Share of openings that name the road and leave the driveway to those who turn there."""


class SceneMixin(JunctionMixin):
    """Slots and sentences about the place; needs the writer's fields."""

    say: Callable[..., str]
    of_road: bool

    def _scene_slot(self, slot: str, v: int) -> str:
        crash, rng = self.crash, self.rng
        mine = crash.actors[v].leg % 4
        if slot == "road":
            return self._road(mine)
        if slot in ("Road", "Jn", "Cxb", "Surf"):
            text = self._scene_slot(slot.lower(), v)
            return text[:1].upper() + text[1:]
        if slot in ("day", "tod"):
            return rng.choice(DAYS if slot == "day" else TIMES[crash.light])
        if slot == "jn":
            return self.scene_junction()
        if slot in ("light", "wx", "surf"):
            return self._condition(slot)
        if slot in ("axis", "axis2"):
            return self._run(self._first + 2 * (slot == "axis2"))
        if slot in ("through", "ending"):
            return self._run(crash.main + 2 * (slot == "ending"))
        if slot in ("lim", "lim2"):
            return self._limit(slot)
        if slot == "curve":
            self.stated.add("curve")
            return self._leg_of(v).curve if self._leg_of(v).curve != "none" else "left"
        return self._scene_slot2(slot)

    def _run(self, bearing: int) -> str:
        """How the road of a bearing runs: "north/south"."""
        self.spoken_of = bearing % 4
        self.stated.add(f"{AXIS}.{bearing % 4}")
        return words.axis(self.rng, bearing % 4)

    def _scene_slot2(self, slot: str) -> str:
        crash, rng = self.crash, self.rng
        if slot == "radius":
            return str(rng.randint(60, 900))
        if slot in ("stemdir", "opposite"):
            stem = crash.stems[0]
            self.stated |= {"layout", STEM}
            return WORDS[(stem.bearing + 4 * (slot == "opposite")) % 8]
        if slot == "tcd":
            return self._tcd()
        if slot in ("cxb", "caxis"):
            return self._controlled(slot)
        if slot in ("roadbare", "road2bare", "road2full", "road2"):
            axis = (self._first + 2 * (slot != "roadbare")) % 4
            return self._road(axis, bare=slot.endswith("bare"))
        raise KeyError(slot)

    def _leg_of(self, v: int) -> Leg:
        return self.crash.leg(self.crash.actors[v].leg)  # type: ignore[return-value]

    # -------------------------------------------------------------- sentences
    def _opening(self) -> list[str]:
        kinds = {
            FOUR: scene_clauses.OPENING_JUNCTION,
            T: scene_clauses.OPENING_JUNCTION,
            DRIVEWAY: scene_clauses.OPENING_DRIVEWAY,
            MERGE: scene_clauses.OPENING_MERGE,
        }
        main = next((i for i, a in enumerate(self.crash.actors) if self.crash.is_main(a.leg)), 0)
        if self.crash.layout == DRIVEWAY and not self.held_out and self.rng.random() < PASSED_OVER:
            return self._of_road(scene_clauses.OPENING_PLAIN, main)
        if self.crash.layout in (DRIVEWAY, MERGE, FOUR):
            self.stated.add("layout")
        group = kinds.get(self.crash.layout, scene_clauses.OPENING_PLAIN)
        options: Sequence[str] = group.without(self.held_out, ["two"] * self.crash.alone)
        if self.crash.layout == T and self.rng.random() < 0.85:
            options = [clause for clause in options if {"jn", "Jn"} & set(slots_of(clause))]
        return self._of_road(options, main)

    def _of_road(self, options: Group | Sequence[str], main: int) -> list[str]:
        """A sentence on the road of an actor, true of it: of limits that there are, of curves; none if no clause is."""
        untrue = self._untrue() + ["two"] * (self.crash.alone and not self.held_out)
        letters = [mark(label) for label in untrue]
        unset = {slot for slot in ("lim", "lim2") if self._limit_of(slot) is None}
        clauses = (c for c in sided(options, self.held_out) if not any(letter in c for letter in letters))
        true = [c for c in clauses if not unset.intersection(slots_of(c))]
        if options is scene_clauses.ROAD and self.spoken_of not in (None, self._first) and not self.held_out:
            true = [clause for clause in true if "axis" in slots_of(clause) or not has(clause, "last_road")]
        self.of_road = True
        text = [self.say(true, main)] if true else []
        self.of_road = False
        return text

    def _untrue(self) -> list[str]:
        """Labels of clauses on the road that say, beside their slots, what is not so."""
        untrue = ["unbent"] * any(leg.curve != "none" for leg in self.crash.legs)
        untrue += ["one_road"] * (len({actor.leg % 4 for actor in self.crash.actors if actor.vehicle}) > 1)
        elsewhere = ("head_on", "overtaking", "left_opposite")  # not in the lanes of the one who comes to mind first
        return untrue + ["own_lanes"] * (self.crash.config in elsewhere)

    def _road_sentences(self) -> list[str]:
        """What they say is made in the order of the text: "the same road" is the one that was named last."""
        rng = self.rng
        main = next((i for i, a in enumerate(self.crash.actors) if self.crash.is_main(a.leg)), 0)
        makers: list[Callable[[], list[str]]]
        makers = [partial(self._of_road, scene_clauses.ROAD, main) for _ in range(rng.choice((0, 1, 1, 2)))]
        if self.crash.layout in INTERSECTIONS and rng.random() < 0.4:
            makers.append(partial(self._of_road, scene_clauses.ROAD2, main))
        if not self.held_out:
            makers += self._more_of_roads(main)
        if self._leg_of(main).curve != "none" and rng.random() < 0.7:
            makers.append(partial(self._of_road, scene_clauses.CURVE, main))
        if self.crash.accesses and rng.random() < 0.8:
            makers.append(self._access)
        rng.shuffle(makers)
        return [text for make in makers for text in make()]

    def _more_of_roads(self, main: int) -> list[Callable[[], list[str]]]:
        """Sentences that only train."""
        rng, crossing = self.rng, self.crash.layout in INTERSECTIONS
        makers: list[Callable[[], list[str]]] = []
        if rng.random() < 0.3:
            makers.append(self._each_way)
        if crossing and rng.random() < 0.3:
            makers.append(rng.choice((self._pair, self._limits)))
        if self.roads_left and rng.random() < (0.15 if self._two_way() else 0.4):
            makers.append(self._alike_roads)
        if rng.random() < 0.25:
            makers.append(self._flows)
        if self.crash.layout in road_clauses.STEM and rng.random() < 0.3:
            makers.append(lambda: [self.say(road_clauses.STEM[self.crash.layout], main)])
        return makers

    def _each_way(self) -> list[str]:
        """What lanes either direction of a road has."""
        rng = self.rng
        axis = rng.choice([leg.bearing % 4 for leg in self.crash.legs if leg.kind == ROAD])
        legs = self._legs_on(axis)
        if not self.roads_left or not legs[0].two_way or legs[0].twltl:
            return []
        self.spoken_of = axis
        back = legs[1] if len(legs) > 1 else Leg((legs[0].bearing + 4) % 8, legs[0].lanes_out, legs[0].lanes_in)
        one, other = rng.sample((legs[0], back), 2)
        ab, bb = (words.bound(rng, leg.bearing + 4) for leg in (one, other))
        self.stated |= {f"lanes.{axis}", f"turns.{axis}", f"{AXIS}.{axis}"}
        self.worded.add(f"lanes.{axis}")
        if one.lanes_in == one.lanes_out and not (one.turns_in or back.turns_in) and rng.random() < 0.4:
            return [self._alike(one, axis, ab, bb)]
        lists = {"alist": lane_phrase(rng, one), "blist": lane_phrase(rng, other)}
        capital = ab[:1].upper() + ab[1:]
        text = self.say(scene_clauses.ROAD_LANES, ab=ab, bb=bb, Ab=capital, axis0=words.axis(rng, axis), **lists)
        return [placed(text, {one.bearing: ab, other.bearing: bb})]

    def _alike(self, leg: Leg, axis: int, ab: str, bb: str) -> str:
        """A road with as many lanes the one way as the other."""
        ways = {"w1": WORDS[leg.bearing], "w2": WORDS[(leg.bearing + 4) % 8], "b1": bb, "b2": ab}
        return self.say(road_clauses.EACH_WAY, each=words.lanes(leg.lanes_in), axis0=words.axis(self.rng, axis), **ways)

    def _pair(self) -> list[str]:
        """Both roads of a junction in one sentence."""
        first, second = self.rng.sample((self.crash.main % 4, (self.crash.main + 2) % 4), 2)
        one, other = self._road(first, bare=True), self._road(second, bare=True)
        self.stated |= {f"{AXIS}.{first}", f"{AXIS}.{second}"}
        axes = {"a1": words.axis(self.rng, first), "a2": words.axis(self.rng, second)}
        return [self.say(road_clauses.PAIR, one=one, other=other, Ione=one[:1].upper() + one[1:], **axes)]

    def _alike_roads(self) -> list[str]:
        """Lanes of both roads of a junction at once, where they have the same and no others."""
        legs = self.crash.legs
        found = {frozenset((leg.lanes_in, leg.lanes_out)) for leg in legs}
        odd = any(leg.turns_in or leg.twltl or leg.kind != ROAD for leg in legs)
        if self.crash.layout not in INTERSECTIONS or len(found) > 1 or odd:
            return []
        ways = found.pop()
        if len(ways - {0}) != 1:
            return []
        lanes, kind = max(ways), "one_way" if 0 in ways else "two_way"
        self.stated |= {f"{key}.{leg.bearing % 4}" for leg in legs for key in ("lanes", ROAD_HINT)}
        return [self.say(road_clauses.ALIKE[kind], each=words.lanes(lanes), total=words.NUMBERS[2 * lanes])]

    def _two_way(self) -> bool:
        """Whether any road is driven either way."""
        return any(leg.two_way for leg in self.crash.legs)

    def _flows(self) -> list[str]:
        """Which way a one-way road leads."""
        found = [leg for leg in self.crash.legs if leg.kind == ROAD and not leg.two_way]
        if not found:
            return []
        leg = self.rng.choice(found)
        axis = self.spoken_of = leg.bearing % 4
        self.stated |= {f"{fact}.{axis}" for fact in ("ways", ROAD_HINT, AXIS, FLOW)}
        xb = words.bound(self.rng, leg.flow)
        return [self.say(road_clauses.FLOWS, axis0=words.axis(self.rng, axis), xb=xb)]

    def _limits(self) -> list[str]:
        """One limit of both roads, where they have one."""
        found = {leg.limit for leg in self.crash.legs}
        limit = found.pop() if len(found) == 1 else None
        if not limit:
            return []
        self.stated |= {f"limit.{leg.bearing % 4}" for leg in self.crash.legs}
        return [self.say(road_clauses.LIMITS, lim=words.limit(self.rng, limit, False))]

    def _access(self) -> list[str]:
        access = self.crash.accesses[0]
        self.stated.add("access")
        side = (access.leg + 4 + (2 if access.side == "right" else -2)) % 8
        kind = DRIVEWAY if access.kind == DRIVEWAY else "side street"
        place = "[crash|intersection|impact]" if self.crash.layout in INTERSECTIONS else "[crash|impact]"
        clause = f"There [was|is] a {{acc}} on the {{accdir}} side of the road[way|] {{accleg}} of the {place}"
        return [self.say([clause], acc=kind, accdir=WORDS[side], accleg=WORDS[access.leg])]

    def _conditions(self, odds: float) -> list[str]:
        if self.rng.random() >= odds:
            return []
        alone = self.crash.alone and not self.held_out
        return [self.say(scene_clauses.CONDITIONS.without(self.held_out, ["two"] * alone))]

    def _condition(self, slot: str) -> str:
        key, table = {
            "light": ("light", scene_clauses.LIGHT),
            "wx": ("weather", scene_clauses.WEATHER),
            "surf": ("surface", scene_clauses.SURFACE),
        }[slot]
        untrue = [] if self.held_out else conditions.untrue(key, self.crash.light, self.crash.weather)
        text = choose(self.rng, self.rng.choice(table[getattr(self.crash, key)].without(self.held_out, untrue)))
        self.stated |= {key} if self.held_out else {key, *conditions.beside(key, text, self.crash)}
        return plain(text)
