"""Clauses about the scene: opening, roads, conditions. Written for this project; the forms follow counts.

Slots: {jn} junction, {road} / {road2} main and other road, {lim} / {lim2} their limits, {tcd} control,
{light} {wx} {surf} conditions, {day} {tod} noise, {xb} {dir} of the first vehicle, {curve}.
"""

from __future__ import annotations

from research.generator.records import Group, read

_LISTS = read("scene")

OPENING_JUNCTION: Group = _LISTS["OPENING_JUNCTION"]
OPENING_DRIVEWAY: Group = _LISTS["OPENING_DRIVEWAY"]
OPENING_PLAIN: Group = _LISTS["OPENING_PLAIN"]
OPENING_MERGE: Group = _LISTS["OPENING_MERGE"]
ROAD: Group = _LISTS["ROAD"]
ROAD2: Group = _LISTS["ROAD2"]
ROAD_LANES: Group = _LISTS["ROAD_LANES"]
CURVE: Group = _LISTS["CURVE"]
CONTROL: dict[str, Group] = _LISTS["CONTROL"]
CONDITIONS: Group = _LISTS["CONDITIONS"]
LIGHT: dict[str, Group] = _LISTS["LIGHT"]
WEATHER: dict[str, Group] = _LISTS["WEATHER"]
SURFACE: dict[str, Group] = _LISTS["SURFACE"]
