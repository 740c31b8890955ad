"""What investigators code and drivers state of the crash itself: true of it, unlike the noise around them.

Keys are what a vehicle did or met (`research.generator.clauses.noise_blocks.event_of`); {code} is a phrase of EVENT,
{move} one of MOVEMENT, {kind} one of CRASH_TYPE. {V} is coded or speaks, {W} is the other.
"""

from __future__ import annotations

from research.generator.records import Group, read

_LISTS = read("codes")

EVENT_FRAMES: Group = _LISTS["EVENT_FRAMES"]
EVENT: dict[str, Group] = _LISTS["EVENT"]
MOVEMENT_FRAMES: Group = _LISTS["MOVEMENT_FRAMES"]
MOVEMENT: dict[str, Group] = _LISTS["MOVEMENT"]
"""Of maneuvers that are also what is coded; who left a lane or the road had been going straight or around a curve."""
TYPE_FRAMES: Group = _LISTS["TYPE_FRAMES"]
CRASH_TYPE: dict[str, Group] = _LISTS["CRASH_TYPE"]
SELF_FRAMES: Group = _LISTS["SELF_FRAMES"]
DOING: dict[str, Group] = _LISTS["DOING"]
OTHER_FRAMES: Group = _LISTS["OTHER_FRAMES"]
DID: dict[str, Group] = _LISTS["DID"]
