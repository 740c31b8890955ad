"""Actors and surroundings as scenariogeneration says them. Knows no trajectory and no storyboard.

Origins are those of the standard: a vehicle's is the center of its rear axle on the ground (RearAxle positionX 0,
BoundingBox.Center and FrontAxle from there), a pedestrian's and an object's the center of its box on the ground.
"""

from __future__ import annotations

from typing import NamedTuple

from scenariogeneration import xosc

from sgcad_core.case.records import ActorInfo
from sgcad_core.records.specs import ActorKind, BehaviorSpec, Light, Surface, Weather

HEIGHT_M: dict[ActorKind, float] = {
    "car": 1.5, "suv": 1.8, "pickup": 1.8, "van": 2.0, "truck": 3.5, "bus": 3.2, "motorcycle": 1.4,
    "bicycle": 1.7, "pedestrian": 1.75, "trailer": 3.5, "object": 1.0,
}  # fmt: skip
MASS_KG: dict[ActorKind, float] = {
    "car": 1500, "suv": 1900, "pickup": 2100, "van": 2000, "truck": 9000, "bus": 12000, "motorcycle": 250,
    "bicycle": 90, "pedestrian": 75, "trailer": 6000, "object": 100,
}  # fmt: skip
_CATEGORY = {
    "car": "car", "suv": "car", "pickup": "car", "van": "van", "truck": "truck", "bus": "bus",
    "motorcycle": "motorbike", "bicycle": "bicycle", "trailer": "trailer",
}  # fmt: skip


class Overhang(NamedTuple):
    """From a bumper to the nearest axle: share of the length, and the most metres that it grows to."""

    share: float
    most_m: float

    def of(self, length_m: float) -> float:
        """Metres on a body of this length."""
        return min(self.share * length_m, self.most_m)


OVERHANGS: dict[ActorKind, tuple[Overhang, Overhang]] = {
    "car": (Overhang(0.20, 1.0), Overhang(0.21, 1.2)), "suv": (Overhang(0.19, 1.0), Overhang(0.21, 1.2)),
    "pickup": (Overhang(0.17, 1.0), Overhang(0.21, 1.4)), "van": (Overhang(0.18, 1.0), Overhang(0.21, 1.4)),
    "truck": (Overhang(0.15, 1.4), Overhang(0.22, 2.5)), "bus": (Overhang(0.22, 2.7), Overhang(0.27, 3.4)),
    "motorcycle": (Overhang(0.15, 0.4), Overhang(0.17, 0.45)), "bicycle": (Overhang(0.19, 0.4), Overhang(0.19, 0.4)),
    "trailer": (Overhang(0.08, 1.0), Overhang(0.22, 2.8)),
}  # fmt: skip
"""In front and behind, per kind with axles, as on common models: a car of 4.7 m stands on 2.8 m of wheelbase, its
center 1.36 m before the rear axle. A trailer's front "axle" is its kingpin. A long truck is a combination on one
box: its last axle is the trailer's, whose overhang does not grow with the length."""
INTERPOLATION = ("plineInterpolation", "segment")
"""A property that esmini reads: headings along the whole segment. Its own default for followingMode "position"
turns about the vertices, which puts the heading at every vertex half a step behind."""
_WHEEL_M: dict[ActorKind, float] = {"truck": 1.0, "bus": 1.0, "trailer": 1.0}
_TIME: dict[Light, tuple[int, int]] = {
    "day": (12, 0), "dusk": (20, 45), "dawn": (5, 15), "dark": (23, 0), "dark_lit": (23, 0),
}  # fmt: skip
SUNS: dict[Light, tuple[float, float, float]] = {
    "day": (100000.0, 3.14159, 1.2), "dusk": (400.0, 5.0, 0.02), "dawn": (400.0, 1.2, 0.02),
    "dark": (0.1, 0.0, -0.5), "dark_lit": (15.0, 0.0, -0.5),
}  # fmt: skip
"""Illuminance (lux), azimuth and elevation (rad) of the sun."""
_CLOUD: dict[Weather, str] = {
    "clear": "zeroOktas", "cloudy": "sevenOktas", "rain": "eightOktas", "snow": "eightOktas", "sleet": "eightOktas",
    "fog": "eightOktas",
}  # fmt: skip
_STATE: dict[Weather, str] = {
    "clear": "free", "cloudy": "cloudy", "rain": "rainy", "snow": "overcast", "sleet": "overcast", "fog": "overcast",
}  # fmt: skip
"""What clouds were called before 1.2."""
_FALL: dict[Weather, tuple[str, float]] = {"rain": ("rain", 4.0), "snow": ("snow", 2.0), "sleet": ("snow", 1.0)}
_FRICTION: dict[Surface, float] = {"dry": 1.0, "wet": 0.7, "snow": 0.3, "ice": 0.15}
_WETNESS: dict[Surface, str] = {"dry": "dry", "wet": "wetWithPuddles"}


def center_ahead_m(actor: ActorInfo) -> float:
    """How far the box center lies ahead of the entity's origin, metres; 0 without axles."""
    if actor.type not in OVERHANGS:
        return 0.0
    return actor.length_m / 2 - OVERHANGS[actor.type][1].of(actor.length_m)


def entity(actor: ActorInfo, minor: int) -> xosc.Vehicle | xosc.Pedestrian | xosc.MiscObject:
    """One actor with its true box and axles, metres from its origin, for version 1.`minor`."""
    height, mass = HEIGHT_M[actor.type], MASS_KG[actor.type]
    ahead = round(center_ahead_m(actor), 6)
    box = xosc.BoundingBox(actor.width_m, actor.length_m, height, ahead, 0.0, height / 2)
    if actor.type == "pedestrian":
        model = actor.type if minor == 0 else None  # the schema of 1.0 wants one
        made = xosc.Pedestrian(actor.type, mass, xosc.PedestrianCategory.pedestrian, box, model)
    elif actor.type == "object":
        made = xosc.MiscObject(actor.type, mass, xosc.MiscObjectCategory.obstacle, box)
    else:
        category = getattr(xosc.VehicleCategory, _CATEGORY[actor.type])
        made = xosc.Vehicle(actor.type, category, box, *_axles(actor), 70.0, 12.0, 12.0, mass if minor else None)
    made.add_property(*INTERPOLATION)
    return made


def _axles(actor: ActorInfo) -> tuple[xosc.Axle, xosc.Axle]:
    """Front and rear; the rear one is the origin."""
    front, rear = (overhang.of(actor.length_m) for overhang in OVERHANGS[actor.type])
    wheel, track = _WHEEL_M.get(actor.type, 0.65), 0.8 * actor.width_m
    wheelbase = round(actor.length_m - front - rear, 6)
    return xosc.Axle(0.6, wheel, track, wheelbase, wheel / 2), xosc.Axle(0.0, wheel, track, 0.0, wheel / 2)


def environment(behavior: BehaviorSpec | None, minor: int) -> xosc.Environment | None:
    """Light, weather and surface as far as the behavior states them; None where it states none.

    Version 1.0 knows whole surroundings only: what is open stands there as noon, clear and dry.
    """
    if behavior is None or not (behavior.light or behavior.weather or behavior.surface):
        return None
    stated = [part for part in (behavior.light, behavior.weather, behavior.surface) if part]
    light, weather, surface = behavior.light, behavior.weather, behavior.surface
    if minor == 0:
        light, weather, surface = light or "day", weather or "clear", surface or "dry"
    parts = _time_of_day(light), _weather(light, weather, minor), _road_condition(surface, minor)
    return xosc.Environment("_".join(stated), *parts)


def _time_of_day(light: Light | None) -> xosc.TimeOfDay | None:
    return None if light is None else xosc.TimeOfDay(False, 2005, 6, 21, *_TIME[light], 0)


def _weather(light: Light | None, weather: Weather | None, minor: int) -> xosc.Weather | None:
    if not (weather or light):
        return None
    sun = xosc.Sun(*SUNS[light]) if light else None
    if weather is None:
        return xosc.Weather(sun=sun)
    kind, rate = _FALL.get(weather, ("dry", 0.0))
    cover = (xosc.CloudState, _STATE[weather]) if minor < 2 else (xosc.FractionalCloudCover, _CLOUD[weather])
    return xosc.Weather(
        getattr(*cover),
        sun=sun,
        fog=xosc.Fog(100 if weather == "fog" else 10000),
        precipitation=xosc.Precipitation(getattr(xosc.PrecipitationType, kind), rate),
    )


def _road_condition(surface: Surface | None, minor: int) -> xosc.RoadCondition | None:
    if surface is None:
        return None
    wetness = getattr(xosc.Wetness, _WETNESS[surface]) if surface in _WETNESS and minor >= 2 else None
    return xosc.RoadCondition(_FRICTION[surface], wetness=wetness)
