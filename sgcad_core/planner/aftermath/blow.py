"""What a blow leaves behind once the bodies no longer hold each other: rotation and speed of the impact as a whole.

While two bodies crush they move as one, so that the sample of their touch shows it. Then they part with the velocities
that one impulse at the middle of the area in touch gives (R. M. Brach, Vehicle Accident Analysis and Reconstruction
Methods, ch. 6): struck off its center a body turns. Knows two bodies; no clock. SI units.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import NamedTuple

from sgcad_core.planner.aftermath.impact import Body, Impact, Point, approach, collide

_SOFT, _HARD, _PER_MPS = 0.45, 0.1, 0.16
"""Restitution of two vehicles that hardly crush and of two that crush deeply, and how fast it falls with the closing
speed: about 0.3 at 3 m/s, 0.1 at 9 m/s."""

Velocity = tuple[float, float, float]
"""Of a body: m/s east and north, rad/s."""


class Blow(NamedTuple):
    """The velocities with which two bodies part."""

    first: Velocity
    second: Velocity


def blow(bodies: tuple[Body, Body], touch: tuple[Point, Point], impact: Impact) -> Blow:
    """One impulse on two bodies that are as they come to touch; both stay as they are. `touch`: place and normal."""
    one, other = replace(bodies[0]), replace(bodies[1])
    collide(
        one, other, *touch, min(impact.restitution, most_restitution(approach(one, other, *touch))), impact.friction
    )
    return Blow(_velocity(one), _velocity(other))


def most_restitution(closing_mps: float) -> float:
    """The restitution that two bodies have at most at a closing speed: the deeper they crush, the less they give
    back."""
    return max(_SOFT * math.exp(-_PER_MPS * max(closing_mps, 0.0)), _HARD)


def lacking(wanted: Blow, first: Body, second: Body) -> Blow:
    """What two bodies that hold each other lack of the velocities with which they part."""
    return Blow(*(
        (v[0] - b.vx, v[1] - b.vy, v[2] - b.spin) for v, b in zip(wanted, (first, second), strict=True)
    ))  # fmt: skip


def part(change: Blow, first: Body, second: Body) -> None:
    """Gives two bodies what they lack."""
    for one, (vx, vy, spin) in ((first, change.first), (second, change.second)):
        one.vx, one.vy, one.spin = one.vx + vx, one.vy + vy, one.spin + spin


def _velocity(one: Body) -> Velocity:
    return one.vx, one.vy, one.spin
