"""How a report names a junction and what controls it; a part of the writer."""

from __future__ import annotations

from typing import Any

from research.generator import words
from research.generator.clauses import scene_clauses
from research.generator.clauses.road_phrases import RoadsMixin
from research.generator.crash.compass_ties import STEM, VAGUE
from sgcad_core.kinds import FOUR, INTERSECTIONS


class JunctionMixin(RoadsMixin):
    """Phrases for junctions, signs and signals; needs the writer's fields."""

    say: Any
    sentences: Any

    def scene_junction(self) -> str:
        """The junction's name; the plain word is what a crossing of two roads is called, seldom a T."""
        layout, control = self.crash.layout, self._control_kind()
        if layout not in INTERSECTIONS:
            return "a driveway"
        self.junction_named = True
        self.stated |= {"layout"} if layout == FOUR else set()
        if self.rng.random() < (0.6 if layout == FOUR else 0.93):
            self.stated |= {"layout"}
            text = words.junction(self.rng, self.crash, self.held_out)
            if control == "none" and self.ciren and self.rng.random() < 0.2:
                self.stated.add("control")
                text = text.replace("a ", "an uncontrolled ", 1)
            elif not self.ciren and not self.held_out and self.rng.random() < 0.1:
                text = self._wide(text)
            return text
        if control == "signal" and self.rng.random() < 0.25:
            self.stated.add("control")
            return "a signalized intersection"
        text = self.rng.choice(("an intersection", "the intersection"))
        if self.sentences or self.ciren or self.held_out or text.startswith("the") or self.rng.random() > 0.15:
            return text
        return self._wide(text)

    def _wide(self, junction: str) -> str:
        """`a five-lane T-intersection`, which counts the lanes of the main road, not which way they lead."""
        axis = self.crash.main % 4
        legs = self._legs_on(axis)
        leg = legs[0]
        if any(side.turns_in for side in legs) or not leg.two_way:
            return junction
        lanes = f"lanes.{axis}"
        self.stated |= {lanes} if leg.lanes_in == leg.lanes_out else {lanes, f"{VAGUE}.{lanes}"}
        self.worded.add(lanes)
        return f"a {words.NUMBERS[leg.lanes_in + leg.lanes_out + leg.twltl]}-lane {junction.partition(' ')[2]}"

    # -------------------------------------------------------------- control
    def _control_kind(self) -> str:
        kinds = [leg.control for leg in self.crash.legs if leg.lanes_in]
        if all(k == "stop" for k in kinds):
            return "all"
        return next((k for k in ("signal", "flashing", "stop", "yield") if k in kinds), "none")

    def _tcd(self) -> str:
        kind = self._control_kind()
        if kind in ("signal", "none"):
            self.stated.add("control")
            return {"signal": "controlled by a traffic control signal", "none": "that was uncontrolled"}[kind]
        return ""

    def _controlled(self, slot: str) -> str:
        signed = [leg for leg in self.crash.legs if leg.control in ("stop", "yield")]
        axis = signed[0].bearing if signed else 0
        rng = self.rng
        if slot == "caxis":
            self.spoken_of = axis % 4
            return words.axis(rng, axis)
        self.stated |= {STEM} if len(signed) == 1 and not self.crash.is_main(axis) else set()
        names = [words.bound(rng, leg.bearing + 4) for leg in signed]
        return " and ".join(names)

    def _control_sentence(self, odds: float) -> list[str]:
        if self.crash.layout not in INTERSECTIONS or self.rng.random() > odds:
            return []
        self.stated.add("control")
        return [self.say(scene_clauses.CONTROL[self._control_kind()])]
