"""Records of the traffic rules: thresholds with their sources, findings, and what a rule is given.

Knows actors, trajectories and the lane graph; no rule.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, get_args

import numpy as np

from sgcad_core.case.records import ActorInfo, Record, Trajectory, sizes_of
from sgcad_core.geometry.plane import Floats, Size
from sgcad_core.metrics.displacement import velocities
from sgcad_core.metrics.drivability import STEP_S, first_touches
from sgcad_core.metrics.lane_places import LaneSteps, lane_steps
from sgcad_core.metrics.swept_cells import Track
from sgcad_core.roads.lane_graph import Connection, LaneGraph
from sgcad_core.rules.lights import Lights, Shown

Rule = Literal[
    "red_light", "stop_sign", "right_of_way", "wrong_side", "passing", "lane_change", "speed_limit",
    "following_distance", "off_road",
]  # fmt: skip
RULES: tuple[Rule, ...] = get_args(Rule)
WORDS: Mapping[Rule, str] = {
    "red_light": "ran a red light", "stop_sign": "did not stop at a stop sign", "right_of_way": "did not yield",
    "wrong_side": "drove on the wrong side", "passing": "passed where it may not",
    "lane_change": "changed lanes without room", "speed_limit": "exceeded the speed limit",
    "following_distance": "followed too closely", "off_road": "drove off the lanes",
}  # fmt: skip
_TOWARD: Mapping[Rule, str] = {
    "right_of_way": "to", "following_distance": "behind", "passing": "of", "lane_change": "before",
}  # fmt: skip
"""How a rule's words go on to the other actor."""
Status = Literal["broken", "kept", "unknown"]


class RuleLimits(Record):
    """Thresholds of the rules, SI units. Those without a source are ours."""

    red_grace_s: float = 0.1
    """Red for so long, two samples, before a crossing counts. Ours: positions are exact to a sample."""
    stands_mps: float = 0.3
    """Slower is a stop. UVC 1-202 wants complete cessation; a vehicle that brakes to a standstill for one instant at
    6 m/s2 shows 0.3 m/s at 20 Hz."""
    stop_before_m: float = 6.0
    """The front stands at most so far before the stop line. MUTCD 2009 3B.16 has the line 4 to 30 ft (1.2 to 9.1 m)
    from the road that is crossed; ours is at the road."""
    stop_beyond_m: float = 1.0
    """The front stands at most so far beyond it; ours."""
    hazard_s: float = 1.5
    """Least time between one who must yield leaving a place and the other coming to it: an "immediate hazard" (UVC
    11-402 to 11-404). The threshold of PET of `Thresholds`."""
    hazard_braking_mps2: float = 3.4
    """Deceleration that is forced on the one with the right of way: AASHTO's Green Book (2011, 3.2.2) takes 11.2 ft/s2
    as comfortable for most drivers."""
    hazard_range_m: float = 40.0
    """Braking counts within this distance of the one who must yield; ours."""
    same_time_s: float = 1.0
    """Arrivals that are "at approximately the same time" (UVC 11-401); ours."""
    off_lane_s: float = 0.5
    """Shorter stays off the lanes are corners cut (`untold_places.MOST_S`)."""
    moving_mps: float = 0.5
    """Slower vehicles do not drive."""
    over_limit_share: float = 0.03
    over_limit_mps: float = 3.0 / 3.6
    """A speed counts from 3 km/h above the limit, beyond 100 km/h from 3 %: the tolerance of certified speed meters in
    German enforcement (PTB-A 12.01)."""
    over_limit_s: float = 0.5
    """For so long; ours."""
    headway_s: float = 1.0
    """Least headway from front to front. Vogel (2003, Accident Analysis and Prevention 35:427) gives 1 s as the value
    from which Swedish police consider fines; 2 s and more are advised."""
    headway_lasts_s: float = 2.0
    """For so long: less is a cut-in, or closing in on a vehicle that brakes. Ours."""
    headway_from_mps: float = 5.0
    """Both drive at least so fast: queues are no following. Ours."""
    pass_oncoming_m: float = 61.0
    """One who passes on the other side has to be back before coming so near to one that comes towards it: 200 ft (UVC
    11-305)."""
    pass_junction_m: float = 30.5
    """No passing on the other side so near before a junction, nor in it: 100 ft (UVC 11-306 (a) 2)."""
    enters_m: float = 0.3
    """A body that reaches so far over a lane line is in that lane; lines are 0.1 to 0.15 m wide. Ours."""
    change_reacts_s: float = 0.4
    change_braking_mps2: float = 3.0
    change_headway_s: float = 1.0
    """A change of lane is critical where the one behind in the new lane, 0.4 s after it began, has to brake with more
    than 3 m/s2 to keep a distance of 1 s: UN R79 (03 series), 5.6.4.7."""


LIMITS = RuleLimits()


class RuleFinding(Record):
    """One rule, one actor, one interval."""

    rule: Rule
    status: Status
    actor: str
    from_s: float
    to_s: float
    x_m: float
    y_m: float
    where: str
    """The lane, or the junction and its approach."""
    measured: float | None
    limit: float | None
    unit: str
    note: str = ""
    other: str = ""
    """The actor that it did not yield to, or that it followed."""

    def words(self) -> str:
        """For people: "V1 ran a red light at 3.2 s (W to hub): red for 1.4 s"."""
        verb = WORDS[self.rule] if self.status == "broken" else f"{self.rule.replace('_', ' ')} {self.status}"
        toward = f" {_TOWARD[self.rule]} {self.other}" if self.rule in _TOWARD and self.other else ""
        when = f"{self.from_s:.1f} s" if self.to_s - self.from_s < STEP_S else f"{self.from_s:.1f} to {self.to_s:.1f} s"
        figure = "" if self.measured is None else f", {self.measured:.2f} {self.unit}"
        figure += "" if self.limit is None else f" (limit {self.limit:.2f})"
        note = f"; {self.note}" if self.note else ""
        return f"{self.actor} {verb}{toward}, {when}{f', {self.where}' if self.where else ''}{figure}{note}"


@dataclass(frozen=True, eq=False)
class RuleScene:
    """What the rules look at. All trajectories have one clock; `lights`: None where the plan is not told.

    `plan_s`: (n,) time of the signal plan at every sample, where it is not that of the trajectories.
    """

    graph: LaneGraph
    trajectories: tuple[Trajectory, ...]
    actors: tuple[ActorInfo, ...]
    lights: Lights | None = None
    plan_s: Floats | None = None
    limits: RuleLimits = field(default_factory=RuleLimits)

    @cached_property
    def movers(self) -> tuple[Mover, ...]:
        """Actors with their motion up to their first contact with anything."""
        infos = {a.id: a for a in self.actors}
        known = [t for t in self.trajectories if t.actor in infos and len(t.t_s) > 1]
        sizes = sizes_of(self.actors)
        touches = first_touches(known, sizes, at_start=False)  # a truck overlaps with its trailer
        return tuple(Mover(self.graph, infos[t.actor], t, touches.get(t.actor)) for t in known)

    def plan_time(self, sample: int) -> float:
        """Time of the signal plan at a sample."""
        return sample * STEP_S if self.plan_s is None else float(self.plan_s[min(sample, len(self.plan_s) - 1)])

    def shown(self, link: Connection, sample: int) -> Shown | None:
        """What the signal of a connection shows at a sample; None where the plan is not told."""
        return self.lights.at(link, self.plan_time(sample)) if self.lights else None


@dataclass(frozen=True, eq=False)
class Mover:
    """An actor with its motion; `until`: the sample of its first contact, None without one."""

    graph: LaneGraph
    info: ActorInfo
    whole: Trajectory
    until: int | None

    @property
    def id(self) -> str:
        """Its id."""
        return self.info.id

    @property
    def size(self) -> Size:
        """Length and width, metres."""
        return self.info.length_m, self.info.width_m

    @cached_property
    def pose(self) -> Floats:
        """(n, 3) poses up to and with the first contact."""
        return self.whole.pose[: None if self.until is None else max(self.until + 1, 2)]

    @cached_property
    def speed_mps(self) -> Floats:
        """(n,) speeds of the same samples."""
        return self.whole.speed_mps[: len(self.pose)]

    @cached_property
    def front(self) -> Floats:
        """(n, 2) middle of the front."""
        heading = self.pose[:, 2]
        ahead = np.column_stack((np.cos(heading), np.sin(heading))) * self.info.length_m / 2
        found: Floats = self.pose[:, :2] + ahead
        return found

    @cached_property
    def steps(self) -> LaneSteps:
        """Its place at every sample."""
        return lane_steps(self.graph, self.pose)

    @property
    def lanes_bound(self) -> bool:
        """Whether it has to keep to lanes: a vehicle that drives by itself."""
        return self.info.record.drives

    def track(self, first: int, last: int) -> Track:
        """The motion between two samples."""
        part = slice(max(first, 0), max(last, first) + 1)
        v = velocities(self.whole)[: len(self.pose)]
        return Track(self.whole.t_s[: len(self.pose)][part], self.pose[part], v[part], self.size)

    def found(
        self, rule: Rule, status: Status, span: tuple[int, int], where: str, measured: float | None,
        limit: float | None, unit: str, note: str = "", other: str = "",
    ) -> RuleFinding:  # fmt: skip
        """A finding about it from one sample to another; its place is that of the box at the first of them."""
        first, last = (min(max(k, 0), len(self.pose) - 1) for k in span)
        return RuleFinding(
            rule=rule, status=status, actor=self.id, from_s=round(first * STEP_S, 2), to_s=round(last * STEP_S, 2),
            x_m=round(float(self.pose[first, 0]), 2), y_m=round(float(self.pose[first, 1]), 2), where=where,
            measured=None if measured is None else round(float(measured), 3),
            limit=None if limit is None else round(float(limit), 3), unit=unit, note=note, other=other,
        )  # fmt: skip


def lasts_s(span: tuple[int, int]) -> float:
    """Duration of a stretch from one sample to another, both within it."""
    return (span[1] - span[0] + 1) * STEP_S
