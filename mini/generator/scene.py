# ruff: noqa: E501 - lists of words
"""The scene sentences of a report: opening, roads, control, conditions; a part of the writer."""

from __future__ import annotations

from random import Random
from typing import Any

from mini.generator import clauses_scene as scene
from mini.generator import words
from mini.generator.grammar import Told, choose, families
from mini.generator.world import WORDS, Crash, Leg

DAYS = ("weekday", "weekday", "weekend", "Saturday", "Friday")
TIMES = ("morning", "early morning", "afternoon", "late afternoon", "evening", "early evening", "mid-morning", "night")
ROAD_WORDS = ("road", "road", "roadway", "roadway", "street", "highway", "trafficway")
MEDIAN_WORDS = {
    "grass": "divided by a grass median", "barrier": "divided by a concrete barrier", "raised": "divided by a raised median",
    "painted": "divided by a painted median",
}  # fmt: skip


class SceneMixin:
    """Slots and sentences about the place; needs the writer's fields."""

    rng: Random
    crash: Crash
    held_out: bool
    ciren: bool
    told: Told
    stated: set[str]
    roads_left: bool

    say: Any

    def _scene_slot(self, slot: str, v: int) -> str:
        crash, rng = self.crash, self.rng
        mine = crash.actors[v].leg % 4
        if slot == "road":
            return self._road(mine)
        if slot in ("Road", "Jn", "Cxb", "Surf"):
            text = self._scene_slot(slot.lower(), v)
            return text[:1].upper() + text[1:]
        simple = {"day": DAYS, "tod": TIMES}
        if slot in simple:
            return rng.choice(simple[slot])
        if slot == "jn":
            return self.scene_junction()
        if slot in ("light", "wx", "surf"):
            return self._condition(slot)
        if slot in ("axis", "axis2"):
            return words.axis(rng, crash.main + 2 * (slot == "axis2"))
        if slot in ("lim", "lim2"):
            return self._limit(slot)
        if slot == "curve":
            self.told.add("curve")
            return self._leg_of(v).curve if self._leg_of(v).curve != "none" else "left"
        return self._scene_slot2(slot)

    def _scene_slot2(self, slot: str) -> str:
        crash, rng = self.crash, self.rng
        if slot == "radius":
            return str(rng.randint(60, 900))
        if slot == "stemdir":
            stem = next(leg for leg in crash.legs if not crash.is_main(leg.bearing))
            self.told.add("layout")
            return WORDS[stem.bearing]
        if slot == "tcd":
            return self._tcd()
        if slot in ("cxb", "caxis"):
            return self._controlled(slot)
        if slot in ("roadbare", "road2bare", "road2full", "road2"):
            axis = crash.main % 4 if slot == "roadbare" else (crash.main + 2) % 4
            return self._road(axis, bare=slot.endswith("bare"))
        raise KeyError(slot)

    def _leg_of(self, v: int) -> Leg:
        return self.crash.leg(self.crash.actors[v].leg)  # type: ignore[return-value]

    def scene_junction(self) -> str:
        """The junction's name; the plain word is what a crossing of two roads is called, seldom a T."""
        layout, control = self.crash.layout, self._control_kind()
        if layout not in ("four", "t"):
            return "a driveway"
        self.told |= {"layout"} if layout == "four" else set()
        if self.rng.random() < (0.6 if layout == "four" else 0.93):
            self.told |= {"layout"}
            text = words.junction(self.rng, self.crash)
            if control == "none" and self.ciren and self.rng.random() < 0.2:
                self.told.add("control")
                text = text.replace("a ", "an uncontrolled ", 1)
            return text
        if control == "signal" and self.rng.random() < 0.25:
            self.told.add("control")
            return "a signalized intersection"
        return self.rng.choice(("an intersection", "the intersection"))

    # -------------------------------------------------------------- roads
    def _legs_on(self, axis: int) -> list[Leg]:
        return [leg for leg in self.crash.legs if leg.bearing % 4 == axis % 4]

    def _road(self, axis: int, bare: bool = False) -> str:
        """A noun phrase for a road; tells its lanes unless they were told or the report keeps them back."""
        rng, legs = self.rng, self._legs_on(axis)
        leg = legs[0] if legs else self.crash.legs[0]
        if leg.kind != "road" and len(legs) == 1:
            self.told |= {"layout"}
            return {
                "driveway": rng.choice(("a private driveway", "a driveway", "a parking lot driveway")),
                "ramp": "an entrance ramp",
            }[leg.kind]
        key = f"lanes.{axis % 4}"
        if not bare and (key in self.stated or not self.roads_left):
            same = axis % 4 == self.crash.main % 4
            return rng.choice(
                ("the same road", "the same roadway", "the roadway")
                if same
                else ("the intersecting road", "the intersecting roadway", "the side street")
            )
        self.stated.add(key)
        text, told = self._lanes_text(leg, legs)
        self.told |= {key, f"median.{axis % 4}"} if told else set()
        if bare or self.held_out or axis % 4 == self.crash.main % 4 or rng.random() < 0.5:
            return text if bare or text.startswith("a ") else "a " + text
        return f"the {rng.choice(('intersecting', 'intersecting', 'crossing', 'other'))} {text.removeprefix('a ')}"

    def _lanes_text(self, leg: Leg, legs: list[Leg]) -> tuple[str, bool]:
        """`a four-lane, two-way urban road (...)` and whether that tells the lanes for sure."""
        rng = self.rng
        even = leg.lanes_in == leg.lanes_out and not leg.turns_in and not leg.twltl
        plain = not any(side.turns_in for side in legs) and not leg.twltl and leg.lanes_in * leg.lanes_out
        bracket = rng.random() < (0.75 if not even else 0.25 * self.ciren)
        other = legs[1].lanes_in if bracket and len(legs) > 1 else leg.lanes_out
        total = min(leg.lanes_in + other + leg.twltl, len(words.NUMBERS) - 1)
        extra = sum(use in ("left", "right") for use in leg.turns_in)
        if not bracket and extra and leg.lanes_in > extra and rng.random() < 0.4:
            total -= extra  # investigators often count the lanes that go on only; the drawing shows the others
        kind = rng.choice((self.crash.area_word, "", "", "residential", "asphalt")).replace("highway", "limited access")
        word = f"{kind} {rng.choice(ROAD_WORDS)}".strip()
        n = rng.choice((words.NUMBERS[total], words.NUMBERS[total], str(total))) + rng.choice(
            ("-lane", "-lane", " lane")
        )
        if leg.lanes_in * leg.lanes_out == 0:
            return f"a {n}, one-way {word}" if rng.random() < 0.5 else f"a one-way, {n} {word}", True
        divided = MEDIAN_WORDS.get(leg.median, "")
        if plain and not self.held_out and rng.random() < 0.3:
            return self._ways_text(leg, even, total, word) + (f" {divided}" if divided else ""), True
        if even and leg.lanes_in > 1 and not bracket and rng.random() < 0.35:
            text = f"a {rng.choice(('two-way ', 'divided ', '') if divided else ('two-way ', 'undivided ', ''))}{word} with {words.NUMBERS[leg.lanes_in]} lanes in each direction"
            return text + (f" {divided}" if divided else ""), True
        ways = (
            ("divided", "two-way, divided", "physically divided")
            if divided
            else ("two-way", "two-way", "undivided", "two-way, undivided", "not physically divided")
        )
        text = f"a {n}, {rng.choice(ways)} {word}" if rng.random() < 0.7 else f"a {n} {rng.choice(ways)} {word}"
        told = even or (leg.twltl and total in (3, 5))
        if bracket:
            text, told = f"{text} {self._bracket(leg, legs)}", True
            self.told.add(f"turns.{leg.bearing % 4}")
        elif divided and rng.random() < 0.5:
            text += f" {divided}"
        elif leg.twltl and rng.random() < 0.5:
            text += " with a center turn lane"
        return text, told

    def _ways_text(self, leg: Leg, even: bool, total: int, word: str) -> str:
        """`a road with two northbound lanes and one southbound lane` and the like."""
        rng, kind = self.rng, self.rng.choice(("two-way ", "", "undivided " if leg.median == "none" else "divided "))
        if even and rng.random() < 0.6:
            each = words.NUMBERS[leg.lanes_in] + (" lane" if leg.lanes_in == 1 else " lanes")
            way = rng.choice(("in each direction", "each way", "for each direction", "per direction"))
            return rng.choice(
                (
                    f"a {kind}{word} with {each} {way}",
                    f"a {kind}{word} that had {each} {way}",
                    f"a {kind}{word} consisting of {words.NUMBERS[total]} lanes, {words.NUMBERS[leg.lanes_in]} {way}",
                    f"a {kind}{word} of {words.NUMBERS[total]} lanes, {words.NUMBERS[leg.lanes_in]} {way}",
                )
            )
        sides = [(leg.lanes_in, words.bound(rng, leg.bearing + 4)), (leg.lanes_out, words.bound(rng, leg.bearing))]
        rng.shuffle(sides)
        lanes = [f"{words.NUMBERS[n]} {xb} lane{'s' * (n > 1)}" for n, xb in sides]
        return f"a {kind}{word} {rng.choice(('with', 'that had', 'of', 'which has'))} {lanes[0]} and {lanes[1]}"

    def _bracket(self, leg: Leg, legs: list[Leg]) -> str:
        back = legs[1] if len(legs) > 1 else Leg((leg.bearing + 4) % 8, leg.lanes_out, leg.lanes_in)
        rng = self.rng
        return words.split(rng, leg, back, words.bound(rng, leg.bearing + 4), words.bound(rng, leg.bearing))

    def _limit(self, slot: str) -> str:
        axis = (self.crash.main + 2 * (slot == "lim2")) % 4
        legs = [leg for leg in self._legs_on(axis) if leg.limit]
        if not legs:
            return words.limit(self.rng, 25)
        self.told.add(f"limit.{axis}")
        return words.limit(self.rng, legs[0].limit or 25)

    # -------------------------------------------------------------- control
    def _control_kind(self) -> str:
        kinds = [leg.control for leg in self.crash.legs]
        if all(k == "stop" for k in kinds):
            return "all"
        return next((k for k in ("signal", "flashing", "stop", "yield") if k in kinds), "none")

    def _tcd(self) -> str:
        kind = self._control_kind()
        if kind in ("signal", "none"):
            self.told.add("control")
            return {"signal": "controlled by a traffic control signal", "none": "that was uncontrolled"}[kind]
        return ""

    def _controlled(self, slot: str) -> str:
        axis = next((leg.bearing for leg in self.crash.legs if leg.control in ("stop", "yield")), 0)
        legs = [leg for leg in self.crash.legs if leg.control in ("stop", "yield")]
        rng = self.rng
        if slot == "caxis":
            return words.axis(rng, axis)
        names = [words.bound(rng, leg.bearing + 4) for leg in legs]
        return " and ".join(names)

    def _control_sentence(self, odds: float) -> list[str]:
        if self.crash.layout not in ("four", "t") or self.rng.random() > odds:
            return []
        self.told.add("control")
        return [self.say(scene.CONTROL[self._control_kind()])]

    # -------------------------------------------------------------- sentences
    def _opening(self) -> list[str]:
        kinds = {
            "four": scene.OPENING_JUNCTION,
            "t": scene.OPENING_JUNCTION,
            "driveway": scene.OPENING_DRIVEWAY,
            "merge": scene.OPENING_MERGE,
        }
        if self.crash.layout in ("driveway", "merge", "four"):
            self.told.add("layout")
        first = next(i for i, a in enumerate(self.crash.actors) if self.crash.is_main(a.leg) or True)
        main = next((i for i, a in enumerate(self.crash.actors) if self.crash.is_main(a.leg)), first)
        options = kinds.get(self.crash.layout, scene.OPENING_PLAIN)
        if self.crash.layout == "t" and self.rng.random() < 0.85:
            options = [clause for clause in options if "{jn}" in clause.lower()]
        return [self.say(options, main)]

    def _road_sentences(self) -> list[str]:
        rng, out = self.rng, []
        main = next((i for i, a in enumerate(self.crash.actors) if self.crash.is_main(a.leg)), 0)
        for _ in range(rng.choice((0, 1, 1, 2))):
            out.append(self.say(scene.ROAD, main))
        if self.crash.layout in ("four", "t") and rng.random() < 0.4:
            out.append(self.say(scene.ROAD2, main))
        if not self.held_out and rng.random() < 0.3:
            out += self._each_way()
        curved = self._leg_of(main).curve != "none"
        if curved and rng.random() < 0.7:
            out.append(self.say(scene.CURVE, main))
        if self.crash.accesses and rng.random() < 0.8:
            out.append(self._access())
        rng.shuffle(out)
        return out

    def _each_way(self) -> list[str]:
        """What lanes either direction of a road has."""
        rng = self.rng
        axis = rng.choice([leg.bearing % 4 for leg in self.crash.legs if leg.kind == "road"])
        legs = self._legs_on(axis)
        if not self.roads_left or not legs[0].lanes_in * legs[0].lanes_out:
            return []
        back = legs[1] if len(legs) > 1 else Leg((legs[0].bearing + 4) % 8, legs[0].lanes_out, legs[0].lanes_in)
        one, other = rng.sample((legs[0], back), 2)
        ab, bb = (words.bound(rng, leg.bearing + 4) for leg in (one, other))
        self.told |= {f"lanes.{axis}", f"turns.{axis}"}
        self.stated.add(f"lanes.{axis}")
        lists = {"alist": words.lane_phrase(rng, one), "blist": words.lane_phrase(rng, other)}
        capital = ab[:1].upper() + ab[1:]
        return [self.say(scene.ROAD_LANES, ab=ab, bb=bb, Ab=capital, axis0=words.axis(rng, axis), **lists)]

    def _access(self) -> str:
        access = self.crash.accesses[0]
        self.told.add("access")
        side = (access.leg + 4 + (2 if access.side == "right" else -2)) % 8
        kind = "driveway" if access.kind == "driveway" else "side street"
        return self.say(["There [was|is] a {acc} on the {accdir} side of the road[way|] {accleg} of the [crash|intersection|impact]"],
                        acc=kind, accdir=WORDS[side], accleg=WORDS[access.leg])  # fmt: skip

    def _conditions(self, odds: float) -> list[str]:
        return [self.say(scene.CONDITIONS)] if self.rng.random() < odds else []

    def _condition(self, slot: str) -> str:
        key, table = {
            "light": ("light", scene.LIGHT),
            "wx": ("weather", scene.WEATHER),
            "surf": ("surface", scene.SURFACE),
        }[slot]
        self.told.add(key)
        options = table[getattr(self.crash, key)].split("|")
        return choose(self.rng, self.rng.choice(families(options, self.held_out)))
