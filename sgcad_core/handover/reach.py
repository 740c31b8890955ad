"""What an ego can do within a step: a pose beyond it is a fault of its driver, never a crash avoided.

Every bound is computed: grip from the surface and the friction circle, acceleration and top speed from the record of
the ego's kind, turning from the kinematic bicycle that also moves the ego (`bicycle.py`). Only slack for rounding is
chosen. Knows no driver and no other road user.
"""

from __future__ import annotations

import math

from sgcad_core.case.driver_io import STEP_S, Command, RoadUser
from sgcad_core.handover.bicycle import MOST_STEERING_RAD, WHEELBASE
from sgcad_core.kinds import ActorRecord, actor_kind
from sgcad_core.metrics.drivability import REAR_AXLE

TOLERANCE = 1.1
"""Drivers know the grip by a rounded figure."""
ROUNDING_M = 0.005
"""By which a place may be rounded, or interpolated."""
ROUNDING_RAD = 0.01
_MOST = 1e6
"""Of any figure in a command: farther away than any road."""


class Reach:
    """The bounds of one ego during a drive; remembers its motion, since places change no faster than velocities can."""

    def __init__(self, ego: RoadUser, friction_mps2: float) -> None:
        self._grip = TOLERANCE * friction_mps2
        self._record: ActorRecord = actor_kind(ego.kind)
        self._base_m = WHEELBASE * ego.length_m
        self._axle_m = REAR_AXLE * ego.length_m
        self._fastest_mps = max(self._record.max_speed_mps, ego.speed_mps)
        self._before: RoadUser | None = None
        self._velocity = ego.velocity

    def check(self, ego: RoadUser, command: Command) -> None:
        """Raises ValueError, in words, for a command that is no motion of this ego; `ego`: as it is now."""
        if self._before is not None:
            moved = ego.x_m - self._before.x_m, ego.y_m - self._before.y_m
            self._velocity = moved[0] / STEP_S, moved[1] / STEP_S
        self._before = ego
        numbers = command.pose or (command.acceleration_mps2, command.steering_rad or 0.0)
        if not all(isinstance(v, int | float) and abs(v) <= _MOST for v in numbers):  # neither is a NaN
            raise ValueError(f"a figure that is none: {', '.join(f'{v!s:.20}' for v in numbers)}")
        if command.pose is not None:
            self._check_pose(ego, *command.pose)

    def pedalled(self, ego: RoadUser, command: Command) -> Command:
        """The command with an acceleration that the kind has; what the tires hold is the bicycle's."""
        if command.pose is not None:
            return command
        most = min(self._record.max_acceleration_mps2, max(self._fastest_mps - ego.speed_mps, 0.0) / STEP_S)
        asked = min(max(command.acceleration_mps2, -self._record.max_deceleration_mps2), most)
        return command._replace(acceleration_mps2=asked)

    def _check_pose(self, ego: RoadUser, x: float, y: float, heading: float, speed: float) -> None:
        self._check_speed(ego.speed_mps, speed)
        moved = x - ego.x_m, y - ego.y_m
        gone, rounding = math.hypot(*moved), 2 * ROUNDING_M
        expected = (abs(ego.speed_mps) + abs(speed)) / 2 * STEP_S
        if abs(gone - expected) > self._grip * STEP_S**2 + rounding:
            raise ValueError(f"impossible motion: {gone:.4g} m in a step at {speed:.4g} m/s")
        east, north = (m / STEP_S - v for m, v in zip(moved, self._velocity, strict=True))
        bent = math.hypot(east, north)
        if bent > self._grip * STEP_S + rounding / STEP_S + self._turned_mps(ego.speed_mps):
            raise ValueError(f"impossible motion: its velocity changes by {bent:.4g} m/s within {STEP_S} s")
        if self._record.wheeled:
            self._check_rolling(ego, moved, heading, max(abs(speed), abs(ego.speed_mps)))

    def _check_speed(self, before: float, speed: float) -> None:
        up = min(self._grip, TOLERANCE * self._record.max_acceleration_mps2)
        down = min(self._grip, TOLERANCE * self._record.max_deceleration_mps2)
        change = abs(speed) - abs(before)
        if change > up * STEP_S + 1e-3 or -change > down * STEP_S + 1e-3:
            raise ValueError(f"impossible motion: from {before:.4g} to {speed:.4g} m/s within {STEP_S} s")
        if abs(speed) > self._fastest_mps + 1e-3:
            raise ValueError(f"impossible motion: {speed:.4g} m/s, {self._record.called} has {self._fastest_mps:.4g}")

    def _bend(self, speed_mps: float) -> float:
        """The most curvature, 1/m: what the steering gives and the tires hold."""
        return min(math.tan(MOST_STEERING_RAD) / self._base_m, self._grip / max(speed_mps, 1e-3) ** 2)

    def _turned_mps(self, speed_mps: float) -> float:
        """By how much the center's velocity may turn at once when the front wheels go from one side to the other."""
        return 2 * speed_mps * math.sin(math.atan(self._axle_m * self._bend(speed_mps)))

    def _check_rolling(self, ego: RoadUser, moved: tuple[float, float], heading: float, speed_mps: float) -> None:
        """The rear axle goes where the vehicle points, ahead or back, and the heading turns as the way bends."""
        turn = math.remainder(heading - ego.heading_rad, math.tau)
        if abs(turn) > TOLERANCE * speed_mps * STEP_S * self._bend(speed_mps) + 2 * ROUNDING_RAD:
            raise ValueError(f"impossible motion: a turn by {abs(turn):.3g} rad within {STEP_S} s")
        rear = [
            m - self._axle_m * (f(heading) - f(ego.heading_rad))
            for m, f in zip(moved, (math.cos, math.sin), strict=True)
        ]
        middle = ego.heading_rad + turn / 2
        aside = abs(rear[1] * math.cos(middle) - rear[0] * math.sin(middle))
        if aside > 2 * ROUNDING_M + speed_mps * STEP_S * ROUNDING_RAD + self._axle_m * ROUNDING_RAD:
            raise ValueError(f"impossible motion: its rear wheels slide {aside:.3g} m sideways within {STEP_S} s")
