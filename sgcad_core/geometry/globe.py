"""A plane that touches the globe: latitude and longitude (WGS84, degrees) to metres and back, and its name in PROJ."""

from __future__ import annotations

import math
from typing import NamedTuple

_RADIUS_M, _FLATNESS = 6_378_137.0, 1 / 298.257223563
"""WGS84."""
Spot = tuple[float, float]
"""Latitude and longitude, degrees."""


class Plane(NamedTuple):
    """The plane that touches WGS84's ellipsoid at an origin: x east, y north, metres. Within 1 km exact to 0.1 m.

    Scales by the radii of curvature of the ellipsoid in the meridian and across it (Snyder, Map Projections, 1987,
    equations 4-18 and 4-20).
    """

    latitude: float
    longitude: float

    def metres(self, spot: Spot) -> tuple[float, float]:
        """A place in the plane."""
        north, east = self._metres_a_degree
        return (spot[1] - self.longitude) * east, (spot[0] - self.latitude) * north

    def spot(self, x_m: float, y_m: float) -> Spot:
        """Latitude and longitude of a point of the plane."""
        north, east = self._metres_a_degree
        return self.latitude + y_m / north, self.longitude + x_m / east

    @property
    def proj(self) -> str:
        """The plane as a transverse Mercator projection, in PROJ's words."""
        latitude, longitude = (f"{round(value, 7):.7f}".rstrip("0").rstrip(".") for value in self)
        return f"+proj=tmerc +lat_0={latitude} +lon_0={longitude} {_METRIC}"

    @property
    def _metres_a_degree(self) -> tuple[float, float]:
        """Of latitude and of longitude."""
        sine, e2 = math.sin(math.radians(self.latitude)), _FLATNESS * (2 - _FLATNESS)
        w = math.sqrt(1 - e2 * sine * sine)
        north, east = _RADIUS_M * (1 - e2) / w**3, _RADIUS_M / w * math.cos(math.radians(self.latitude))
        return math.radians(north), math.radians(east)


_METRIC = "+k=1 +x_0=0 +y_0=0 +ellps=WGS84 +units=m"
