"""Actors and surroundings as scenariogeneration says them. Knows no trajectory and no storyboard.

Every entity's origin is the center of its box (BoundingBox Center 0, 0, height / 2), so a played pose is
the box center whatever a player thinks of headings between vertices.
"""

from __future__ import annotations

from scenariogeneration import xosc

from sgcad_core.records import ActorInfo
from sgcad_core.specs import ActorKind, BehaviorSpec, Light, Surface, Weather

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
_TIME: dict[Light, tuple[int, int]] = {
    "day": (12, 0), "dusk": (20, 45), "dawn": (5, 15), "dark": (23, 0), "dark_lit": (23, 0),
}  # fmt: skip
_SUN: dict[Light, tuple[float, float, float]] = {
    "day": (100000.0, 3.14159, 1.2), "dusk": (400.0, 5.0, 0.02), "dawn": (400.0, 1.2, 0.02),
    "dark": (0.1, 0.0, -0.5), "dark_lit": (15.0, 0.0, -0.5),
}  # fmt: skip
_CLOUD: dict[Weather, str] = {
    "clear": "zeroOktas", "cloudy": "sevenOktas", "rain": "eightOktas", "snow": "eightOktas", "sleet": "eightOktas",
    "fog": "eightOktas",
}  # fmt: skip
_FALL: dict[Weather, tuple[str, float]] = {"rain": ("rain", 4.0), "snow": ("snow", 2.0), "sleet": ("snow", 1.0)}
_FRICTION: dict[Surface, float] = {"dry": 1.0, "wet": 0.7, "snow": 0.3, "ice": 0.15}
_WETNESS: dict[Surface, str] = {"dry": "dry", "wet": "wetWithPuddles"}


def entity(actor: ActorInfo) -> xosc.Vehicle | xosc.Pedestrian | xosc.MiscObject:
    """One actor with its true box, metres."""
    height, mass = HEIGHT_M[actor.type], MASS_KG[actor.type]
    box = xosc.BoundingBox(actor.width_m, actor.length_m, height, 0.0, 0.0, height / 2)
    if actor.type == "pedestrian":
        return xosc.Pedestrian(actor.type, mass, xosc.PedestrianCategory.pedestrian, box)
    if actor.type == "object":
        return xosc.MiscObject(actor.type, mass, xosc.MiscObjectCategory.obstacle, box)
    reach, wheel = 0.3 * actor.length_m, 0.65
    front = xosc.Axle(0.6, wheel, 0.8 * actor.width_m, reach, wheel / 2)
    rear = xosc.Axle(0.0, wheel, 0.8 * actor.width_m, -reach, wheel / 2)
    category = getattr(xosc.VehicleCategory, _CATEGORY[actor.type])
    return xosc.Vehicle(actor.type, category, box, front, rear, 70.0, 12.0, 12.0, mass)


def environment(behavior: BehaviorSpec | None) -> xosc.Environment | None:
    """Light, weather and surface as far as the behavior states them; None where it states none."""
    if behavior is None or not (behavior.light or behavior.weather or behavior.surface):
        return None
    stated = [part for part in (behavior.light, behavior.weather, behavior.surface) if part]
    return xosc.Environment(
        "_".join(stated), _time_of_day(behavior.light), _weather(behavior), _road_condition(behavior.surface)
    )


def _time_of_day(light: Light | None) -> xosc.TimeOfDay | None:
    return None if light is None else xosc.TimeOfDay(False, 2005, 6, 21, *_TIME[light], 0)


def _weather(behavior: BehaviorSpec) -> xosc.Weather | None:
    if not (behavior.weather or behavior.light):
        return None
    intensity, azimuth, elevation = _SUN.get(behavior.light or "day", _SUN["day"])
    sun = xosc.Sun(intensity, azimuth, elevation) if behavior.light else None
    if behavior.weather is None:
        return xosc.Weather(sun=sun)
    kind, rate = _FALL.get(behavior.weather, ("dry", 0.0))
    return xosc.Weather(
        getattr(xosc.FractionalCloudCover, _CLOUD[behavior.weather]),
        sun=sun,
        fog=xosc.Fog(100 if behavior.weather == "fog" else 10000),
        precipitation=xosc.Precipitation(getattr(xosc.PrecipitationType, kind), rate),
    )


def _road_condition(surface: Surface | None) -> xosc.RoadCondition | None:
    if surface is None:
        return None
    wetness = getattr(xosc.Wetness, _WETNESS[surface]) if surface in _WETNESS else None
    return xosc.RoadCondition(_FRICTION[surface], wetness=wetness)
