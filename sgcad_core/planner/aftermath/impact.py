"""Momentum exchange of two bodies in contact: planar, with restitution and friction.

Planar impact mechanics (R. M. Brach, R. M. Brach, Vehicle Accident Analysis and Reconstruction Methods, ch. 6): one
point in common, a normal, a coefficient of restitution, Coulomb friction along the tangent. Plain floats, since a crash
is stepped through thousands of times. Knows no roads, no driver and no clock. SI units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

from sgcad_core.geometry.plane import Size

FRICTION = 0.5
"""Between two bodies; Brach finds 0.3 to 0.6 for vehicles that lock into each other."""
RESTITUTION = 0.1
"""Of vehicles that crush; Brach: near 0 at speed, up to 0.3 at walking pace."""


class Impact(NamedTuple):
    """What is free in the blow of two vehicles. `glance_rad`: the slant of fronts that meet in part; 0 where these lock
    into each other."""

    friction: float = FRICTION
    restitution: float = RESTITUTION
    glance_rad: float = 0.0


USUAL = Impact()
IMPACTS = (
    Impact(0.5, 0.1), Impact(0.1, 0.1), Impact(0.3, 0.0), Impact(0.6, 0.3),
    Impact(0.1, 0.1, math.radians(25.0)), Impact(0.1, 0.1, math.radians(45.0)),
)  # fmt: skip
"""Impacts to try, within what Brach finds for vehicles: little friction and restitution for a graze, more friction
where they lock; a slant of the crushed fronts up to that of a corner."""

_LEAST_LENGTH_M = 1.7
"""Least length for the moment of inertia: a person is 0.5 m deep, but not so easily turned."""


@dataclass(slots=True)
class Body:
    """A box at one moment. Fixed bodies have neither inverse mass nor inverse inertia."""

    x: float
    y: float
    heading: float
    size: Size
    inverse_mass: float
    inverse_inertia: float
    vx: float = 0.0
    vy: float = 0.0
    spin: float = 0.0
    radius: float = field(init=False)
    """From the center to a corner."""

    def __post_init__(self) -> None:
        self.radius = math.hypot(*self.size) / 2

    @property
    def stands(self) -> bool:
        """Whether it neither moves nor turns."""
        return self.vx == self.vy == self.spin == 0.0

    @property
    def speed(self) -> float:
        """Of the center, m/s."""
        return math.hypot(self.vx, self.vy)

    @property
    def energy(self) -> float:
        """Of motion and spin, J; 0 of a fixed body."""
        moving = self.speed**2 / (2 * self.inverse_mass) if self.inverse_mass else 0.0
        return moving + (self.spin**2 / (2 * self.inverse_inertia) if self.inverse_inertia else 0.0)

    def velocity_at(self, x: float, y: float) -> tuple[float, float]:
        """Of the body's point at a place, m/s."""
        return self.vx - self.spin * (y - self.y), self.vy + self.spin * (x - self.x)

    def push(self, jx: float, jy: float, x: float, y: float) -> None:
        """Take an impulse (N s) at a place."""
        self.vx += jx * self.inverse_mass
        self.vy += jy * self.inverse_mass
        self.spin += ((x - self.x) * jy - (y - self.y) * jx) * self.inverse_inertia


def body(pose: tuple[float, float, float], size: Size, mass: float | None) -> Body:
    """A homogeneous box at rest; no mass: fixed to the ground."""
    if mass is None:
        return Body(*pose, size, 0.0, 0.0)
    inertia = mass * (max(size[0], _LEAST_LENGTH_M) ** 2 + size[1] ** 2) / 12
    return Body(*pose, size, 1 / mass, 1 / inertia)


Point = tuple[float, float]
Matrix = tuple[float, float, float]


def compliance(first: Body, second: Body, at: Point) -> Matrix:
    """Relative velocity gained at a point per impulse there: the symmetric matrix as xx, xy, yy (1/kg)."""
    xx = yy = first.inverse_mass + second.inverse_mass
    xy = 0.0
    for one in (first, second):
        ax, ay = at[0] - one.x, at[1] - one.y
        xx += ay * ay * one.inverse_inertia
        yy += ax * ax * one.inverse_inertia
        xy -= ax * ay * one.inverse_inertia
    return xx, xy, yy


def approach(first: Body, second: Body, at: Point, normal: Point) -> float:
    """Closing speed of the two at a point along the normal (from first to second), m/s."""
    x, y = at
    along = (first.vx - first.spin * (y - first.y)) - (second.vx - second.spin * (y - second.y))
    across = (first.vy + first.spin * (x - first.x)) - (second.vy + second.spin * (x - second.x))
    return along * normal[0] + across * normal[1]


def collide(
    first: Body, second: Body, at: Point, normal: Point, restitution: float = 0.0, friction: float = FRICTION
) -> bool:
    """Exchange momentum at a point; `normal`: unit vector from first to second. False where they do not approach.

    Afterwards the points part at `restitution` times the speed of approach and do not slide on each other, unless that
    takes more friction than there is. Where friction and restitution together would give energy (a known fault of
    Newton's restitution; T. R. Kane, D. A. Levinson, Dynamics, 1985), the impact is taken as plastic and smooth.
    """
    closing = approach(first, second, at, normal)
    if closing <= 0.0:
        return False
    give = compliance(first, second, at)
    impulse = _impulse(first, second, (at, normal), give, restitution, friction)
    if _work(first, second, at, give, impulse) > 0.0:
        along = _through(give, normal, normal)
        impulse = (normal[0] * closing / along, normal[1] * closing / along)
    first.push(-impulse[0], -impulse[1], *at)
    second.push(*impulse, *at)
    return True


def slow_parting(first: Body, second: Body, at: Point, normal: Point, by_mps: float) -> None:
    """Reduces the speed of separation at a point along a normal (from first to second): hooked bodies."""
    size = by_mps / _through(compliance(first, second, at), normal, normal)
    first.push(normal[0] * size, normal[1] * size, *at)
    second.push(-normal[0] * size, -normal[1] * size, *at)


def _impulse(
    first: Body, second: Body, touch: tuple[Point, Point], give: Matrix, restitution: float, friction: float
) -> Point:
    """The impulse on the second body that stops all sliding, within the friction cone. `touch`: place and normal."""
    at, normal = touch
    (ax, ay), (bx, by) = first.velocity_at(*at), second.velocity_at(*at)
    closing = (ax - bx) * normal[0] + (ay - by) * normal[1]
    wanted = (ax - bx + restitution * closing * normal[0], ay - by + restitution * closing * normal[1])
    jx, jy = solve(give, wanted)
    tangent = (-normal[1], normal[0])
    along, across = jx * normal[0] + jy * normal[1], jx * tangent[0] + jy * tangent[1]
    if abs(across) <= friction * along:
        return jx, jy
    slide = math.copysign(friction, (ax - bx) * tangent[0] + (ay - by) * tangent[1])
    way = (normal[0] + slide * tangent[0], normal[1] + slide * tangent[1])
    size = (1 + restitution) * closing / max(_through(give, normal, way), 1e-12)
    return way[0] * size, way[1] * size


def _work(first: Body, second: Body, at: Point, give: Matrix, impulse: Point) -> float:
    """Energy that an impulse adds to both bodies: mean relative velocity times impulse, J."""
    (ax, ay), (bx, by) = first.velocity_at(*at), second.velocity_at(*at)
    slip = (bx - ax) * impulse[0] + (by - ay) * impulse[1]
    return slip + _through(give, impulse, impulse) / 2


def _through(give: Matrix, a: Point, b: Point) -> float:
    xx, xy, yy = give
    return a[0] * (xx * b[0] + xy * b[1]) + a[1] * (xy * b[0] + yy * b[1])


def solve(give: Matrix, wanted: Point) -> Point:
    """The impulse that changes the relative velocity at a point as wanted."""
    xx, xy, yy = give
    det = xx * yy - xy * xy
    return (yy * wanted[0] - xy * wanted[1]) / det, (xx * wanted[1] - xy * wanted[0]) / det
