"""Words for numbers, lanes, roads, junctions and speeds, as counts of real reports have them.

{word} is a direction ("north"), {initial} its letter, {mph} {k} a speed, {low} {high} {klow} {khigh} a range of
speeds, {number} {ordinal} {short} {digit} a lane counted from the right, {use} its turn, {xb} "northbound", {noun}
"urban road", {n} "four-lane", {each} {count} "two lanes", {half} {total} numbers of lanes, {way} a phrase of
EACH_DIRECTION, {kind} one of BEFORE, {a} {b} the lanes of either way, {travel} one of TRAVEL, {d} a diameter, {place} a
junction.
"""

from __future__ import annotations

from research.generator.records import Group, read

_LISTS = read("words")

DIRECTION: dict[str, Group] = _LISTS["DIRECTION"]
BOUND: Group = _LISTS["BOUND"]
AXIS: dict[str, Group] = _LISTS["AXIS"]
LIMIT: Group = _LISTS["LIMIT"]
SPEED: dict[str, Group] = _LISTS["SPEED"]
LANE: dict[str, Group] = _LISTS["LANE"]
JUNCTION: dict[str, Group] = _LISTS["JUNCTION"]
AGE: Group = _LISTS["AGE"]
ROAD_NOUN: Group = _LISTS["ROAD_NOUN"]
LOOKS: Group = _LISTS["LOOKS"]
"""Adjectives that may stand before the number of lanes and tell nothing that is asked for."""
DIVIDER: dict[str, Group] = _LISTS["DIVIDER"]
WAYS: dict[str, Group] = _LISTS["WAYS"]
BESIDE: dict[str, Group] = _LISTS["BESIDE"]
BEFORE: dict[str, Group] = _LISTS["BEFORE"]
"""Words before that for a road, of one with a median and of others, where the lanes of each way are told too."""
EACH_DIRECTION: Group = _LISTS["EACH_DIRECTION"]
EVEN: Group = _LISTS["EVEN"]
SIDES: Group = _LISTS["SIDES"]
ONE_WAY: Group = _LISTS["ONE_WAY"]
TRAVEL: Group = _LISTS["TRAVEL"]
ACCESS: dict[str, Group] = _LISTS["ACCESS"]
AGAIN: dict[str, Group] = _LISTS["AGAIN"]
"""Of a road of which no more is told."""
IN_BRACKETS: dict[str, Group] = _LISTS["IN_BRACKETS"]
"""What divides a road, as an item of the list of its lanes."""
OBJECT: Group = _LISTS["OBJECT"]
PERSON: dict[str, Group] = _LISTS["PERSON"]
"""Of those on foot and on bicycles."""
NEARING: Group = _LISTS["NEARING"]
