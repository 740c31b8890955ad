"""Actors and surroundings as scenariogeneration says them. Knows no trajectory and no storyboard.

Origins are those of the standard: a vehicle's is the center of its rear axle on the ground (RearAxle positionX 0,
BoundingBox.Center and FrontAxle from there), a pedestrian's and an object's the center of its box on the ground.
"""

from __future__ import annotations

from scenariogeneration import xosc

from sgcad_core.case.records import ActorInfo
from sgcad_core.kinds import ActorRecord, mass_kg
from sgcad_core.kinds.actors import Axles
from sgcad_core.records.specs import BehaviorSpec, Light, Surface, Weather

INTERPOLATION = ("plineInterpolation", "segment")
"""A property that esmini reads: headings along the whole segment. Its own default for followingMode "position"
turns about the vertices, which puts the heading at every vertex half a step behind."""
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
    axles = actor.record.axles
    return actor.length_m / 2 - axles.rear.of(actor.length_m) if axles else 0.0


def entity(actor: ActorInfo, minor: int) -> xosc.Vehicle | xosc.Pedestrian | xosc.MiscObject:
    """One actor with its true box and axles, metres from its origin, for version 1.`minor`."""
    record = actor.record
    ahead = round(center_ahead_m(actor), 6)
    box = xosc.BoundingBox(actor.width_m, actor.length_m, record.height_m, ahead, 0.0, record.height_m / 2)
    if record.axles is None:
        made = _without_axles(record, box, minor)
    else:
        bounds = record.max_speed_mps, record.max_acceleration_mps2, record.max_deceleration_mps2
        category = getattr(xosc.VehicleCategory, record.category)
        mass = mass_kg(record.id, actor.length_m) if minor else None
        made = xosc.Vehicle(record.id, category, box, *_axles(actor, record.axles), *bounds, mass)
    made.add_property(*INTERPOLATION)
    return made


def _without_axles(record: ActorRecord, box: xosc.BoundingBox, minor: int) -> xosc.Pedestrian | xosc.MiscObject:
    if record.thing:
        return xosc.MiscObject(record.id, record.mass_kg, getattr(xosc.MiscObjectCategory, record.category), box)
    model = record.id if minor == 0 else None  # the schema of 1.0 wants one
    return xosc.Pedestrian(record.id, record.mass_kg, getattr(xosc.PedestrianCategory, record.category), box, model)


def _axles(actor: ActorInfo, axles: Axles) -> tuple[xosc.Axle, xosc.Axle]:
    """Front and rear; the rear one is the origin."""
    front, rear = axles.front.of(actor.length_m), axles.rear.of(actor.length_m)
    wheel, track = axles.wheel_m, 0.8 * actor.width_m
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
