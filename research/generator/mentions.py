"""How one report names its vehicles: V1, Vehicle #1, the Ford, V1 (the Ford Taurus) ..., mixed as investigators mix."""

from __future__ import annotations

from random import Random

from research.generator.clauses.clause_words import OBJECT, PERSON
from research.generator.crash.vehicles import COLORS, YEARS, body_text, model_text
from research.generator.crash.world import Actor, Crash
from research.generator.words import NUMBERS
from sgcad_core.kinds import actor_kind

STYLES = {
    "V{n}": 44, "Vehicle #{n}": 16, "Vehicle {w}": 10, "Vehicle {n}": 9, "Vehicle # {n}": 5, "vehicle {w}": 4,
    "Vehicle-{n}": 2, "V {n}": 1, "Vehicle {w} (V{n})": 6, "Unit {n}": 1,
}  # fmt: skip


def _numbered(style: str, number: int) -> str:
    return style.format(n=number, w=NUMBERS[number])


class Mentions:
    """Names of the actors in one report; the first mention introduces year, make and model."""

    def __init__(self, rng: Random, crash: Crash, ciren: bool) -> None:
        self.rng, self.crash, self.ciren = rng, crash, ciren
        self.style = "V{n}" if ciren else rng.choices(list(STYLES), list(STYLES.values()))[0]
        self.mixed = not ciren and rng.random() < 0.6
        self.second = rng.choices(list(STYLES), list(STYLES.values()))[0]
        """Another way to write numbers in a report that mixes them, as more than half of the long ones do."""
        self.introduced: set[int] = set()
        self.years = {i: rng.choice(YEARS) for i in range(len(crash.actors))}
        for actor in crash.actors:
            actor.model = model_text(rng, actor.kind) if actor.vehicle else self._other(actor)

    def _other(self, actor: Actor) -> str:
        if actor_kind(actor.kind).thing:
            return self.rng.choice(OBJECT.side(False)).format(d=self.rng.randint(10, 90))
        on_foot = PERSON["pedestrian"].side(False)
        age = self.rng.randint(8, 80)
        names = {"pedestrian": self.rng.choice(on_foot), "bicycle": self.rng.choice(PERSON["bicycle"].side(False))}
        return names[actor.kind].format(age=age)

    def name(self, index: int) -> str:
        """A later mention."""
        actor = self.crash.actors[index]
        if not actor.vehicle:
            return (
                actor.model.replace("a ", "the ", 1)
                if index in self.introduced and actor.model.startswith("a ")
                else actor.model
            )
        number = int(actor.id[1:])
        plain = _numbered(self.style, number)
        if not self.ciren and "(V" in plain and index in self.introduced and self.rng.random() < 0.7:
            plain = f"V{number}"
        if self.mixed and self.rng.random() < 0.2:
            return _numbered(self.second, number)
        if self.mixed and self.rng.random() < 0.3:
            make = actor.model.split(" ")[0]
            own = [f"the {name}" if self._only(name) else plain for name in (make, actor.model)]
            return self.rng.choice((*own, f"the {make} ({plain})", f"{plain}, the {make},", f"V{number}"))
        return plain

    def _only(self, name: str) -> bool:
        """Whether a make or a model is that of one vehicle."""
        return sum(f"{actor.model} ".startswith(f"{name} ") for actor in self.crash.actors) == 1

    def full(self, index: int, body_odds: float = 0.6) -> tuple[str, bool]:
        """The first mention, and whether it tells what kind of vehicle it is."""
        actor = self.crash.actors[index]
        if not actor.vehicle:
            self.introduced.add(index)
            return actor.model, True
        if index in self.introduced:
            return self.name(index), False
        self.introduced.add(index)
        number = int(actor.id[1:])
        text = self._year_model(index, actor, 0.95 if self.ciren else body_odds)
        if self.ciren:
            case = " - case vehicle" if number == 1 or self.rng.random() < 0.1 else ""
            return f"Vehicle {NUMBERS[number]} (V{number}{case}), {text},".replace(",,", ","), True
        plain = _numbered(self.style, number)
        forms = [f"{plain}, {text},", f"{plain}, {text},", f"{plain} ({text})", f"{plain}, {text}", f"{text} ({plain})"]
        person = f"{self.rng.randint(16, 88)}-year{self.rng.choice('- ')}old {self.rng.choice(('male', 'female'))}"
        forms += [f"{plain}, {text}, driven by a {person},", f"{plain}, {text} driven by a {person},"]
        return self.rng.choices(forms, [4, 4, 4, 4, 4, 1, 1])[0], True

    def presented(self, index: int) -> tuple[str, bool]:
        """`V1 was a 1999 Ford Taurus sedan`, which motion follows without another verb."""
        actor = self.crash.actors[index]
        self.introduced.add(index)
        return f"{_numbered(self.style, int(actor.id[1:]))} was {self._year_model(index, actor, 0.7)}", True

    def _year_model(self, index: int, actor: Actor, body_odds: float) -> str:
        color = f"{self.rng.choice(COLORS)} " if not self.ciren and self.rng.random() < 0.15 else ""
        needs_body = not actor_kind(actor.kind).usual
        body = body_text(self.rng, actor.kind) if needs_body or self.rng.random() < body_odds else ""
        comma = "," if self.ciren else ""
        return f"a {color}{self.years[index]} {actor.model}" + (f"{comma} {body}" if body else "")
