"""What bodies do after they touch: a planar momentum exchange, then sliding to rest.

A plastic impact at one point with Coulomb friction (J. Brach, R. M. Brach, Vehicle Accident Analysis and
Reconstruction Methods, ch. 6: planar impact mechanics, restitution 0), then constant deceleration. Knows no
roads and no driver. SI units.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from sgcad_core.geometry.plane import SIDES, Floats, Size
from sgcad_core.specs import SIZE_M, ActorKind, Area

MASS_KG: dict[ActorKind, float] = {
    "car": 1450.0, "suv": 1900.0, "pickup": 2100.0, "van": 2000.0, "truck": 9000.0, "bus": 13000.0,
    "motorcycle": 280.0, "bicycle": 90.0, "pedestrian": 75.0, "trailer": 5000.0, "object": 1e9,
}  # fmt: skip
_TRAILER_KG_PER_M = {"truck": 900.0, "car": 150.0}
"""Of a vehicle longer than its kind: the rest is what it tows (a car's trailer stands for all light ones)."""
FRICTION = 0.5
SLIDING_MPS2 = 4.5
ROLLING_MPS2 = 2.2
"""Of a vehicle that is to reach something else."""
REST_S = 3.6
"""Everything stands still this long after its last impact."""
_MOST_SPIN = 4.0


def mass_kg(kind: ActorKind, size: Size) -> float:
    """The mass of an actor of that length and width (m) with what it tows."""
    more = max(size[0] - SIZE_M[kind][0] - 2.0, 0.0)
    return MASS_KG[kind] + more * _TRAILER_KG_PER_M["truck" if kind in ("truck", "bus") else "car"]


class Body(NamedTuple):
    """A box at one moment: pose (3,), velocity (2,), yaw rate and mass."""

    pose: Floats
    velocity: Floats
    spin_radps: float
    size: Size
    mass_kg: float

    @property
    def inertia(self) -> float:
        """Yaw inertia of a homogeneous box, kg m2."""
        return self.mass_kg * (self.size[0] ** 2 + self.size[1] ** 2) / 12

    def pushed(self, impulse: Floats, arm: Floats) -> Body:
        """The same body after an impulse (N s) at a point `arm` from its center."""
        spin = self.spin_radps + (arm[0] * impulse[1] - arm[1] * impulse[0]) / self.inertia
        spin = min(max(spin, -_MOST_SPIN), _MOST_SPIN)
        return self._replace(velocity=self.velocity + impulse / self.mass_kg, spin_radps=spin)


def collide(first: Body, second: Body, point: Floats, normal: Floats) -> tuple[Body, Body]:
    """Both bodies after a plastic impact at `point`; `normal` is a unit vector from first to second.

    The points in touch end up with one velocity, unless that takes more friction than there is.
    """
    arm_a, arm_b = point - first.pose[:2], point - second.pose[:2]
    slip = _velocity_at(first, arm_a) - _velocity_at(second, arm_b)
    if slip @ normal <= 0:
        return first, second
    give = _compliance(first, arm_a) + _compliance(second, arm_b)
    impulse = np.asarray(np.linalg.solve(give, slip), dtype=np.float64)
    tangent = np.array([-normal[1], normal[0]])
    if abs(impulse @ tangent) > FRICTION * (impulse @ normal):
        push = normal + math.copysign(FRICTION, slip @ tangent) * tangent
        impulse = push * (slip @ normal) / max(float(normal @ give @ push), 1e-9)
    return first.pushed(-impulse, arm_a), second.pushed(impulse, arm_b)


def contact_normal(first: Floats, first_side: Area, second: Floats, second_side: Area) -> Floats:
    """Unit vector from the first to the second box, between the outward normals of the touching sides."""
    a = first[2] + SIDES.index(first_side) * math.pi / 2
    b = second[2] + SIDES.index(second_side) * math.pi / 2
    normal = np.array([math.cos(a) - math.cos(b), math.sin(a) - math.sin(b)])
    if np.hypot(*normal) < 0.5:
        normal = second[:2] - first[:2]
    unit: Floats = normal / max(float(np.hypot(*normal)), 1e-9)
    return unit


def slide(body: Body, times_s: Floats, braking_mps2: float = SLIDING_MPS2) -> Floats:
    """(n, 3) poses at times after now: straight on, spinning, all at rest within REST_S."""
    speed = float(np.hypot(*body.velocity))
    braking = max(braking_mps2, speed / REST_S)
    distance = _stopping(times_s, speed, braking)
    turned = _stopping(times_s, abs(body.spin_radps), max(abs(body.spin_radps) / 1.6, 1.2))
    ahead = body.velocity / max(speed, 1e-9)
    xy = body.pose[:2] + distance[:, None] * ahead
    return np.column_stack((xy, body.pose[2] + math.copysign(1.0, body.spin_radps) * turned))


def _stopping(times_s: Floats, rate: float, braking: float) -> Floats:
    moving = np.minimum(times_s, rate / braking)
    way: Floats = rate * moving - braking * moving**2 / 2
    return way


def _velocity_at(body: Body, arm: Floats) -> Floats:
    return body.velocity + body.spin_radps * np.array([-arm[1], arm[0]])


def _compliance(body: Body, arm: Floats) -> Floats:
    """(2, 2) velocity gained at a point per impulse there."""
    across = np.array([-arm[1], arm[0]])
    give: Floats = np.eye(2) / body.mass_kg + np.outer(across, across) / body.inertia
    return give
