"""The motion of the ego: along its way without steering, as a kinematic bicycle with steering.

The bicycle (R. Rajamani, Vehicle Dynamics and Control, ch. 2.2): the rear axle goes where the vehicle points, the yaw
rate is v tan(steering) / wheelbase. Acceleration and lateral acceleration stay within the friction circle. Knows a way;
no other road user.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from sgcad_core.case.driver_io import STEP_S, Command, Way
from sgcad_core.metrics.drivability import REAR_AXLE

WHEELBASE = 2 * REAR_AXLE
"""As a share of the length: the axles lie symmetrically."""
FASTEST_MPS = 70.0
MOST_STEERING_RAD = 0.7
"""Of the front wheels: 40 degrees, at which a car of 2.8 m of wheelbase turns within 3.4 m, tighter than any."""


@dataclass
class Ego:
    """State of the ego: box center, heading, speed, and station on its way."""

    x_m: float
    y_m: float
    heading_rad: float
    speed_mps: float
    station_m: float
    free: bool = False
    """Whether it has been steered and so left its way."""
    backing: bool = False

    @staticmethod
    def at_start(way: Way, factor: float = 1.0) -> Ego:
        """At the beginning of a way, at the scripted speed times a factor."""
        x, y, heading = way.pose_at(0.0)
        ahead = way.pose_at(1.0)
        course = math.atan2(ahead[1] - y, ahead[0] - x) if way.s_m[-1] > 0.1 else heading
        backing = math.cos(course - heading) < 0
        return Ego(x, y, heading, float(way.speed_mps[0]) * factor, 0.0, backing=backing)

    def move(self, command: Command, way: Way, length_m: float, friction_mps2: float) -> float:
        """Moves the ego by one step. Returns the actual acceleration."""
        if command.pose is not None:
            return self._put(command.pose, way)
        asked = min(max(command.acceleration_mps2, -friction_mps2), friction_mps2)
        speed = min(max(self.speed_mps + asked * STEP_S, 0.0), FASTEST_MPS)
        taken = (speed - self.speed_mps) / STEP_S
        travel = (self.speed_mps + speed) / 2 * STEP_S
        if command.steering_rad is None and not self.free:
            self.station_m = min(self.station_m + travel, float(way.s_m[-1]))
            self.x_m, self.y_m, self.heading_rad = way.pose_at(self.station_m)
        else:
            self._steer(command.steering_rad, travel, length_m, friction_mps2, taken)
            self._locate(way, travel)
        self.speed_mps = speed
        return taken

    def _put(self, pose: tuple[float, float, float, float], way: Way) -> float:
        x, y, heading, speed = pose
        travel = math.hypot(x - self.x_m, y - self.y_m)
        taken = (speed - self.speed_mps) / STEP_S
        self.x_m, self.y_m, self.heading_rad, self.speed_mps, self.free = x, y, heading, speed, True
        self._locate(way, travel)
        return taken

    def _steer(
        self, steering: float | None, travel: float, length_m: float, friction_mps2: float, taken: float
    ) -> None:
        """Moves the rear axle; a vehicle off its way without steering goes straight on."""
        self.free = True
        base, sign = WHEELBASE * length_m, -1.0 if self.backing else 1.0
        left = math.sqrt(max(friction_mps2**2 - taken**2, 0.0))
        tightest = left / max(self.speed_mps, 1.0) ** 2
        bend = math.tan(min(max(steering or 0.0, -MOST_STEERING_RAD), MOST_STEERING_RAD)) / base
        bend = min(max(bend, -tightest), tightest)
        behind = REAR_AXLE * length_m
        x, y = self.x_m - behind * math.cos(self.heading_rad), self.y_m - behind * math.sin(self.heading_rad)
        turned = self.heading_rad + sign * travel * bend
        middle = (self.heading_rad + turned) / 2
        x, y = x + sign * travel * math.cos(middle), y + sign * travel * math.sin(middle)
        self.heading_rad = turned
        self.x_m, self.y_m = x + behind * math.cos(turned), y + behind * math.sin(turned)

    def _locate(self, way: Way, travel: float) -> None:
        """Finds the nearest station on the way, near the expected one."""
        around = [self.station_m + travel * k for k in (0.0, 0.5, 0.8, 1.0, 1.2, 1.5)]
        self.station_m = min(around, key=lambda s: _away(way, s, self.x_m, self.y_m))


def _away(way: Way, station_m: float, x_m: float, y_m: float) -> float:
    x, y, _ = way.pose_at(station_m)
    return (x - x_m) ** 2 + (y - y_m) ** 2
