"""What is to be answered to a report, given which facts its text and its drawing tell.

Untold facts are null where the answer allows it; otherwise the true value stands in the target with
a small weight, so that a model learns how often it is so. Weights go by the path of the answer.
"""

from __future__ import annotations

from collections.abc import Set
from typing import Any

from research.generator.crash.world import COMPASS, Access, Actor, Crash, Leg
from sgcad_core.kinds import PLAIN, actor_kind

Json = dict[str, Any]
GUESS = 0.25
"""Weight of a value that the evidence does not tell and that has no null."""
LIKELY = 0.6
"""Of the lanes of a one-way street that a narrative alone does not count: mostly there is one."""
SURE = 1.0
RARE = 2.0
"""Of a value that is told and learned late: a curve, a speed or its limit, light and weather, and kinds that are
seldom seen. Not of maneuvers: a model that leans to the rare ones reads them into reports that tell the usual one."""
CONTACT = 6.0
THIRD_LEG = 3.0
"""Of the places of three legs: in words a turn and a heading, told apart, mostly tell where the third one lies."""


class Targets:
    """Both answers to one report and the weights of their values."""

    def __init__(self, crash: Crash, known: set[str], doubtful: Set[str] = frozenset(), alone: bool = False) -> None:
        """`doubtful`: what is known in part, or of no known leg; it stands in the answer with the weight of a guess.

        `alone`: of a narrative without a drawing.
        """
        self.alone = alone
        self.crash, self.known, self.sure = crash, known, known - doubtful
        self.weights: dict[tuple[Any, ...], float] = {}
        self.flat: float | None = None
        """One weight for every value, whatever it is: of rows that learn how answers are distributed."""
        self.road = self._road()
        self.behavior = self._behavior()

    def weight(self, path: tuple[Any, ...]) -> float:
        """Weight of a pick; paths not named are sure. Lists of turn lanes weigh as a whole."""
        path = path[:3] if "turns_in" in path else path
        return self.weights.get(path, SURE) if self.flat is None else self.flat

    # -------------------------------------------------------------- road
    def _road(self) -> Json:
        legs = [self._leg(i, leg) for i, leg in enumerate(self.crash.legs)]
        told = "access" in self.known
        found = sorted(self.crash.accesses, key=lambda access: access.leg) if told else []
        return {"legs": legs, "accesses": [self._access(i, access) for i, access in enumerate(found)]}

    def _leg(self, index: int, leg: Leg) -> Json:
        axis, path = leg.bearing % 4, ("legs", index)
        lanes, turns = f"lanes.{axis}" in self.known, f"turns.{axis}" in self.known
        if "legs" not in self.sure and self.crash.layout != PLAIN:
            self._unsure(path, "bearing", "more", "kind")
        elif len(self.crash.legs) == 3:
            self.weights[(*path, "bearing")] = THIRD_LEG
        one_way = f"ways.{axis}" in self.sure and not leg.two_way
        if f"lanes.{axis}" not in self.sure or (leg.turns_in and not turns):
            counts = (("lanes_in", leg.lanes_in), ("lanes_out", leg.lanes_out))
            self._unsure(path, *(key for key, n in counts if n or not one_way))
            if one_way and self.alone and not lanes:
                self.weights |= {(*path, key): LIKELY for key, n in counts if n}
        median = leg.median if f"median.{axis}" in self.known else "none"
        bent = [actor for actor in self.crash.actors if actor.maneuver == "negotiating_curve" and actor.leg % 4 == axis]
        if "curve" not in self.known and any(f"man.{actor.id}" in self.known for actor in bent):
            self._unsure(path, "curve")
        if leg.curve != "none" and "curve" in self.known:
            self.weights[(*path, "curve")] = RARE
        self._unsure(path, *(("median",) if f"median.{axis}" not in self.sure else ()))
        self._unsure(path, *(() if one_way or f"lanes.{axis}" in self.sure else ("center_turn_lane",)))
        named = any(f"lane.{a.id}" in self.known and self._turning(leg, a) for a in self.crash.actors)
        part = f"turns.{axis}" in self.known - self.sure or (named and not turns)
        self._unsure(path, *(("turns_in",) if part else ()))
        self._unsure(path, *(("speed_limit_mph",) if f"limit.{axis}" in self.known - self.sure else ()))
        if f"limit.{axis}" in self.sure and leg.limit:
            self.weights[(*path, "speed_limit_mph")] = RARE
        return {
            "bearing": COMPASS[leg.bearing],
            "lanes_in": leg.lanes_in,
            "lanes_out": leg.lanes_out,
            "turns_in": leg.turns_in if turns else [],
            "center_turn_lane": leg.twltl and lanes,
            "median": median,
            "kind": leg.kind,
            "control": self._control(leg, path),
            "curve": leg.curve if "curve" in self.known else "none",
            "speed_limit_mph": leg.limit if f"limit.{axis}" in self.known else None,
        }

    @staticmethod
    def _turning(leg: Leg, actor: Actor) -> bool:
        """Whether an actor came to a leg in a lane that is for turning only, which its name tells most often."""
        uses = leg.turns_in if actor.leg == leg.bearing and actor.lane else []
        return bool(uses) and uses[(actor.lane or 1) - 1] in ("left", "right")

    def _control(self, leg: Leg, path: tuple[Any, ...]) -> str:
        if "control" not in self.sure:
            self._unsure(path, "control")
        return leg.control if "control" in self.known else "none"

    def _access(self, index: int, access: Access) -> Json:
        wide = 1
        if self.alone or access.mouth is not None:  # no text tells how far it lies
            self._unsure(("accesses", index), "distance_m")
        return {
            "leg": COMPASS[access.leg],
            "side": access.side,
            "distance_m": float(access.distance_m),
            "kind": access.kind,
            "lanes_in": wide,
            "lanes_out": wide,
            "control": "none",
        }

    def _unsure(self, path: tuple[Any, ...], *keys: str) -> None:
        for key in keys:
            self.weights[(*path, key)] = GUESS

    # -------------------------------------------------------------- behavior
    def _behavior(self) -> Json:
        crash = self.crash
        actors = [self._actor(i, actor) for i, actor in enumerate(crash.actors)]
        contacts = [self._contact(i) for i in range(len(crash.contacts))]
        conditions = {
            key: getattr(crash, key) if key in self.known else None for key in ("light", "weather", "surface")
        }
        self.weights |= {(key,): RARE for key, value in conditions.items() if value is not None}
        return {"actors": actors, "contacts": contacts, **conditions}

    def _actor(self, index: int, actor: Actor) -> Json:
        path, known = ("actors", index), self.known
        sure = f"man.{actor.id}" in known or actor.maneuver == "straight"
        self._unsure(path, *(("kind",) if f"kind.{actor.id}" not in known else ()))
        self._unsure(path, *(("road",) if f"heading.{actor.id}" not in known and actor.vehicle else ()))
        self._unsure(path, *(("maneuver",) if not sure else ()))
        open_end = actor.meant and f"exit.{actor.id}" not in known  # the same words as of one that means to go on
        self._unsure(path, *(("exit_road",) if not sure or open_end or f"heading.{actor.id}" not in known else ()))
        named = f"lane.{actor.id}"
        beside = self._changes and named not in known and self._lane(actor) is None
        self._unsure(path, *(("lane",) if named in known - self.sure or beside else ()))
        if f"kind.{actor.id}" in known and not actor_kind(actor.kind).usual:
            self.weights[(*path, "kind")] = RARE
        for key in ("direction", "length_m", "width_m"):
            self.weights[(*path, key)] = 0.1
        if actor.speed and f"speed.{actor.id}" in known:
            self.weights[(*path, "speed_mph")] = RARE
        out = actor.exit_of(known) if f"heading.{actor.id}" in known else None
        return {
            "id": actor.id,
            "kind": actor.kind,
            "road": COMPASS[actor.leg],
            "direction": "forward",
            "lane": self._lane(actor) if actor.vehicle else None,
            "exit_road": COMPASS[out] if out is not None else None,
            "maneuver": actor.maneuver,
            "speed_mph": self._speed(actor, sure),
            "length_m": None,
            "width_m": None,
        }

    def _lane(self, actor: Actor) -> int | None:
        leg = self.crash.leg(actor.leg)
        counted = leg is not None and {f"lanes.{leg.bearing % 4}", f"heading.{actor.id}"} <= self.known
        lanes = leg.lanes_in if counted and leg is not None else 0
        only = (lanes == 1 and actor.maneuver != "parked") or (lanes == 2 and self._changes)
        return actor.lane if only or f"lane.{actor.id}" in self.known else None

    @property
    def _changes(self) -> bool:
        """Whether it is known of two side by side which way one of them came into the other's lane."""
        changers = [actor for actor in self.crash.actors if actor.maneuver.startswith("lane_change")]
        return self.crash.config == "lane_change" and any(f"man.{actor.id}" in self.known for actor in changers)

    def _speed(self, actor: Actor, sure: bool) -> int | None:
        if not actor.vehicle:
            return None
        if actor.maneuver in ("stopped", "parked"):
            return 0 if sure else None
        return actor.speed if f"speed.{actor.id}" in self.known else None

    def _contact(self, index: int) -> Json:
        contact, path = self.crash.contacts[index], ("contacts", index)
        sure = f"contact.{index}" in self.known
        for key in ("striker", "struck", "striker_area", "struck_area"):
            areas = key.endswith("area")
            known = f"areas.{index}" in self.known or (key == "striker_area" and f"side.{index}" in self.known)
            told = known if areas else sure
            self.weights[(*path, key)] = CONTACT if told else GUESS
        ids = [actor.id for actor in self.crash.actors]
        return {
            "striker": ids[contact.striker],
            "struck": ids[contact.struck],
            "striker_area": contact.striker_area,
            "struck_area": contact.struck_area,
        }


def drawn_facts(crash: Crash, control: bool, arrows: bool, access: bool) -> set[str]:
    """What a drawing of a crash tells: all but words, speeds, kinds of cars and the weather.

    It does not tell that an actor slowed, where a standing or slowing one means to turn, that one on the wrong side of
    a road meant to pass, if the passed one is not there, which of two that touch with the same side struck the other,
    or how a pedestrian stood.
    """
    facts = {"layout", "legs", "curve"} | ({"control"} if control else set()) | ({"access"} if access else set())
    for leg in crash.legs:
        facts |= {f"{key}.{leg.bearing % 4}" for key in ("lanes", "median", *(("turns",) if arrows else ()))}
    for actor in crash.actors:
        facts |= {f"{key}.{actor.id}" for key in ("heading", "exit", "lane")}
        passes = actor.maneuver == "overtaking" and sum(other.leg == actor.leg for other in crash.actors) < 2
        facts -= {f"exit.{actor.id}"} if actor.meant else set()
        facts |= {f"man.{actor.id}"} if actor.maneuver != "slowing" and not passes else set()
        if not actor_kind(actor.kind).usual:
            facts.add(f"kind.{actor.id}")
    for index, contact in enumerate(crash.contacts):
        facts |= {f"contact.{index}"} if contact.striker_area != contact.struck_area else set()
        facts |= {f"areas.{index}"} if not actor_kind(crash.actors[contact.struck].kind).walks else set()
    return facts
