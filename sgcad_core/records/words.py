"""Words that several specs and records share: compass, sides of a vehicle, evasive maneuvers, counts of lanes."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

Compass = Literal["N", "NE", "E", "SE", "S", "SW", "W", "NW"]
RoadSide = Literal["N", "NE", "E", "SE", "S", "SW", "W", "NW", "left", "right"]
"""A side of a road: by compass, or as seen in a vehicle's direction of travel."""
Area = Literal["front", "back", "left", "right"]
EvasiveManeuver = Literal[
    "none", "braking", "steering", "steering_left", "steering_right", "braking_and_steering",
    "braking_and_steering_left", "braking_and_steering_right", "accelerating",
]  # fmt: skip
LaneNumber = Annotated[int, Field(ge=1, le=8)]
SignalState = Literal["green", "yellow", "red"]
