"""The timeline of a crash: states and acts of every road user in the order in which they were, each with its words.

Records only; knows no text and no network. A writer's gist (maneuver at the crash, start from a stop, rest) is read off
the acts that are marked so.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal

from sgcad_core.record_base import Record
from sgcad_core.records.facts import Basis, Fact, Value

Phase = Literal["before", "at", "after"]
"""Against the first contact (or, of a near crash, the moment of the conflict)."""
PHASES: tuple[Phase, ...] = ("before", "at", "after")
ActKind = Literal[
    "approach", "stopped", "parked", "starts", "straight", "slowing", "turn_left", "turn_right", "u_turn",
    "lane_change", "lane_change_left", "lane_change_right", "merge", "overtaking", "crossing_centerline",
    "departing_road_left", "departing_road_right", "negotiating_curve", "backing", "leaving_parking", "other",
    "brakes", "steers", "no_evasion", "loses_control", "contact", "spins", "rolls_over", "rests",
    "departs", "returns", "crosses", "yaws",
]  # fmt: skip
STANDING: tuple[ActKind, ...] = ("stopped", "parked")
MOVING: tuple[ActKind, ...] = (
    "starts", "straight", "turn_left", "turn_right", "u_turn", "lane_change", "lane_change_left", "lane_change_right",
    "merge", "overtaking", "crossing_centerline", "departing_road_left", "departing_road_right", "negotiating_curve",
    "backing", "leaving_parking",
)  # fmt: skip


class Act(Record):
    """One state or act of one road user.

    `value`: what the kind leaves open (the side of a swerve, the place of rest, the side of a contact). `heading`,
    `lane`, `road`, `speed_mph`: where they are told of it. `meant`: intended or waited for, not done. `decides`: the
    maneuver at the crash is taken from it. [start, end): its sentence in the narrative as it was written, None where no
    sentence tells it.
    """

    actor: str
    kind: ActKind
    phase: Phase
    other: str | None = None
    value: Value = None
    heading: str | None = None
    lane: str | None = None
    road: str | None = None
    speed_mph: int | None = None
    meant: bool = False
    decides: bool = False
    words: str = ""
    rule: str = ""
    basis: Basis = "text"
    confidence: float = 0.0
    start: int | None = None
    end: int | None = None

    def line(self) -> str:
        """The act in a few words, for people."""
        what = self.kind.replace("_", " ")
        told = [f"with {self.other}"] if self.other else []
        told += [str(self.value).replace("_", " ")] if self.value not in (None, True) else []
        told += [f"heading {self.heading}"] if self.heading else []
        told += [f"lane {self.lane}"] if self.lane else []
        told += [f"from the {self.road}"] if self.road else []
        told += [f"{self.speed_mph} mph"] if self.speed_mph is not None else []
        return f"{'means to ' if self.meant else ''}{what}{' ' if told else ''}{', '.join(told)}"


def of_actor(timeline: tuple[Act, ...], actor: str) -> tuple[Act, ...]:
    """The acts of one road user, in order; contacts of which it is the other one are left out."""
    return tuple(act for act in timeline if act.actor == actor)


def starts_from_rest(acts: tuple[Act, ...]) -> bool:
    """Whether the acts of one road user have it stand and then move on before the first contact."""
    before = [act for act in acts if act.phase == "before" and not act.meant]
    stood = [number for number, act in enumerate(before) if act.kind in STANDING]
    return bool(stood) and any(act.kind in MOVING for act in before[stood[-1] + 1 :])


def as_settled(timeline: Iterable[Act], facts: Iterable[Fact]) -> tuple[Act, ...]:
    """The timeline with the maneuvers that a model or a person gave instead of those read: the deciding act of that
    vehicle is replaced, or added before the contact where none was read."""
    acts = list(timeline)
    for fact in facts:
        group, _, rest = fact.field.partition(".")
        name, _, last = rest.partition(".")
        if group != "vehicles" or last != "maneuver" or fact.basis not in ("model", "diagram", "person"):
            continue
        own = [n for n, act in enumerate(acts) if act.actor == name and act.decides]
        if own and acts[own[-1]].kind == fact.value:
            continue
        given = Act(
            actor=name, kind=fact.value, phase="before", decides=True, rule=fact.rule, basis=fact.basis,
            confidence=fact.confidence, start=fact.start, end=fact.end,
        )  # fmt: skip
        if own:
            acts[own[-1]] = given
        else:
            acts.insert(sum(act.phase == "before" for act in acts), given)
    return tuple(acts)
