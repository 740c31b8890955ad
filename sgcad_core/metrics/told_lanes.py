"""Whether a vehicle is in the lane that its report tells: by number, by side, a turn lane, the center turn lane.

Compares the reading of one vehicle with the lanes that its motion is on (`lane_places`). Knows no file.
"""

from __future__ import annotations

from typing import NamedTuple

from sgcad_core.kinds import CHANGES
from sgcad_core.metrics.lane_places import LaneSteps
from sgcad_core.reading.crash_facts import VehicleFacts
from sgcad_core.reading.layout.lanes_used import CENTER
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.roads.lane_positions import Position, position

LANE_WORDS = ("left", "right", "middle", "left_turn", "right_turn", CENTER)
_OUTERMOST = {1: ("left", "left_turn", CENTER), -1: ("right", "right_turn")}
TURN_LANES = {"left_turn": "left", "right_turn": "right"}


class ToldLane(NamedTuple):
    """A told lane: a number (1 = at the right curb, -1 = the leftmost), or a word."""

    number: int | None
    word: str | None
    side: int = 0
    """Of a lane change into this lane: the side to which it leads (1: left); 0: the vehicle is in it before."""

    @classmethod
    def of(cls, value: object, side: int = 0) -> ToldLane:
        """A lane as a fact tells it, by number or word."""
        return (
            cls(value, None, side) if isinstance(value, int) else cls(None, None if value is None else str(value), side)
        )

    @property
    def center(self) -> bool:
        """Whether it is a two-way left-turn lane."""
        return self.word == CENTER

    def words(self) -> str:
        """For people."""
        if self.number is None:
            return f"the {(self.word or '').replace('_', ' ')} lane"
        side = "right" if self.number > 0 else "left"
        return f"lane {abs(self.number)} from the {side}"

    def taken(self, graph: LaneGraph, steps: LaneSteps) -> bool:
        """Whether the first lane that a motion is on is this one."""
        first = steps.first
        if first is None:
            return False
        if steps.places[first] == "center_lane":
            return self.center or self.word == "left_turn"
        at = position(graph, steps.lanes[first])
        if at is None or self.center or steps.places[first] == "opposing":
            return False
        leaves = self.side and at.lanes > 1  # of a lane with no other beside it one only departs
        beside = position(graph, steps.lanes[first], self.side) if leaves else at
        return beside is not None and self.is_at(beside)

    def is_at(self, at: Position) -> bool:
        """Whether a lane is the told one.

        Of sides turn lanes may be left out: "the left lane" is the leftmost of all or of those that lead straight on.
        """
        if self.number is not None:
            return at.place == (self.number if self.number > 0 else at.lanes + 1 + self.number)
        if self.word in TURN_LANES:
            side = TURN_LANES[self.word]
            end = at.lanes if side == "left" else 1
            return at.leads == {side} or (side not in at.all_lead and at.place == end)
        if self.word == "middle":
            return at.lanes < 3 or 1 < at.place < at.lanes
        ends = (at.lanes, at.last_through) if self.word == "left" else (1, at.first_through)
        return at.place in ends and (at.lanes > 1 or self.word == "right")


def told_lane(vehicle: VehicleFacts) -> ToldLane | None:
    """The lane that a report tells of a vehicle; None where it tells none.

    A lane that has none beside it on the side of a lane change is the one into which it leads.
    """
    if vehicle.lane is None and vehicle.lane_word is None:
        return None
    passes = vehicle.maneuver == "overtaking" and vehicle.lane_word == "left_turn"
    side = 1 if passes else CHANGES.get(vehicle.maneuver, 0)
    outermost = vehicle.lane == -side or (vehicle.lane is None and vehicle.lane_word in _OUTERMOST.get(side, ()))
    return ToldLane(vehicle.lane, vehicle.lane_word if vehicle.lane is None else None, side if outermost else 0)
