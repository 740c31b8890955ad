"""Facts of a report on the course of a crash, beside its contacts: evasion, loss of control, rest.

Records that no field of a spec holds: specs are answers, these are read by rules. Compass angles are clockwise degrees
from north. Knows no text, no network and no motion.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

from sgcad_core.records.words import Area, Compass, RoadSide

Where = Literal["road", "intersection", "shoulder", "median", "off_road"]
Attitude = Literal["wheels", "roof", "left", "right"]
"""The part that a vehicle rests on: wheels, roof, left or right side."""
Spin = Literal["clockwise", "counterclockwise"]
Hand = Literal["left", "right"]
HANDS: tuple[Hand, Hand] = ("left", "right")
Steering = Literal["left", "right", "either"]
ComesTo = Literal["drives_up", "moves_up", "moves_off"]
"""How a vehicle comes to the stop at which it is struck: it drives there, or it moves up from another stop; or it has
stood there and has just begun to move."""
Pace = Literal["fast", "slow"]
"""A speed that is told in words alone: above the limit, or far below it."""
RestLane = Literal["own", "left", "right", "middle", "left_turn", "right_turn", "center_turn"]
"""A lane at rest by its word; own: the one in which the vehicle began."""
DepartureSide = RoadSide | Literal["either"]
"""Where a vehicle leaves the road: a compass word, a hand as seen in its direction of travel; either: not told."""
MoveKind = Literal["departs", "returns", "steers", "crosses", "yaws"]
"""Leaves the road; comes back on it, or into its lane; steers aside; crosses the center line; turns in a skid."""

AT_IMPACT_M = 2.5
"""Distance from the place of the contact that stands for a rest "at the point of impact": up to twice as far counts."""


def sense_of(spin: Spin | None) -> int:
    """1 counter-clockwise, -1 clockwise, 0 where none is told: the sign of an angle that grows to the left."""
    return {"counterclockwise": 1, "clockwise": -1}.get(spin or "", 0)


@dataclass(frozen=True)
class Move:
    """One of several moves before the first contact. `side`: of the road, or the sense of a yaw; None: none is told."""

    kind: MoveKind
    side: DepartureSide | Spin | None = None

    @property
    def words(self) -> str:
        """For people and facts: "departs right", "returns"."""
        return f"{self.kind} {self.side}" if self.side not in (None, "either") else self.kind


@dataclass(frozen=True)
class RestTold:
    """Place and attitude of a vehicle at rest; None: not stated."""

    facing_deg: float | None = None
    where: Where | None = None
    side: RoadSide | None = None
    """Of the road or the intersection: a compass word, or a hand as seen in its direction of travel."""
    attitude: Attitude | None = None
    against: str | None = None
    """What it leaned against, in the report's word."""
    distance_m: float | None = None
    """From the place of its first contact."""
    lane: int | RestLane | None = None
    """1 = at the right curb; where counted from the left -1 = the leftmost."""
    lane_way: Compass | None = None
    """The direction of travel of the lane, or of the lanes, in which it stands."""

    @property
    def in_lane(self) -> bool:
        """Whether a lane, or the lanes of a direction, are stated."""
        return self.lane is not None or self.lane_way is not None

    @property
    def empty(self) -> bool:
        """Whether nothing is stated."""
        return self == RestTold()


@dataclass(frozen=True)
class CourseTold:
    """Stated acts of one vehicle beside its maneuver."""

    from_rest: bool = False
    """Stands, then moves on into its first contact."""
    straddles: Hand | None = None
    """The hand on which the lane lies over whose line it stands at its first contact."""
    comes: ComesTo | None = None
    """How it comes to the stop at which it stands at its first contact; None: it is only told to stand."""
    slight: bool = False
    """Whether all that is told of the contact speaks of a slight one."""
    corner: tuple[Area, Area] | None = None
    """The end and the flank of the corner at which it touches first: it does so at that part of either."""
    pace: Pace | None = None
    """How fast it drives before its first contact, where that is told in words."""
    offset: bool = False
    """Meets what comes against it with one side of its front only: the left one, as both drive on the right."""
    signal_turned: bool = False
    """The state of its traffic signal is that to which it is told to have turned just before."""
    inside: bool = False
    """Drives into a junction before its first contact."""
    brakes: bool = False
    """Before its first contact."""
    stops: bool = False
    """Has come to a stop in its maneuver, in the way of others, and stands at its first contact."""
    speed_at_impact: bool = False
    """Its told speed is that at its first contact."""
    steers: Steering | None = None
    """Before its first contact, to avoid it."""
    no_evasion: bool = False
    """The report says that it did nothing."""
    lost_control: bool = False
    yaws: Spin | None = None
    """How it turns out of control before its first contact."""
    departs: DepartureSide | None = None
    """Leaves the road before its first contact, or before it rolls over where it has none."""
    beyond: bool = False
    """Passes a junction before it leaves the road."""
    moves: tuple[Move, ...] = ()
    """The moves before that contact in order, where they lead to more than one side: off the road, back, across."""
    leaves: bool = False
    """Drives away after its contacts."""
    spin: Spin | None = None
    """How it turned after its first contact."""
    spin_deg: float | None = None
    rolls: bool = False
    roll_quarters: int | None = None
    """Quarter turns of its rollover."""
    rolls_to: Hand | None = None
    """The side that leads when it rolls over."""
    rolls_after: int = 1
    """Contacts of its own that are told before it rolls over."""
    rest: RestTold = RestTold()

    @property
    def empty(self) -> bool:
        """Whether nothing is stated."""
        return self == CourseTold()


@dataclass(frozen=True)
class ImpactTold:
    """A contact behind the first one: of a vehicle with another one, or with a thing that has no number."""

    actor: str
    other: str
    """A vehicle's id, or the report's word for the thing."""
    actor_area: Area | None = None
    other_area: Area | None = None
    after: int = 1
    """Number of contacts of two vehicles that are told before it; alone with things, the first thing is one."""

    @property
    def before(self) -> bool:
        """Whether it comes before the first contact of two vehicles."""
        return self.after == 0


Courses = Mapping[str, CourseTold]
"""By vehicle id."""
NOTHING_TOLD: Courses = MappingProxyType({})
