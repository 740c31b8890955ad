"""Clauses about avoidance, contact and rest. {S} strikes {T}; {sa} and {ta} are the areas that meet.

{V} {W} mention a vehicle, {anyside} and {any8} are noise.
"""

from __future__ import annotations

from research.generator.records import Group, read

_LISTS = read("contact")

AVOID: Group = _LISTS["AVOID"]
IMPACT: Group = _LISTS["IMPACT"]
IMPACT_REAR: Group = _LISTS["IMPACT_REAR"]
IMPACT_BARE: Group = _LISTS["IMPACT_BARE"]
SWIPE: Group = _LISTS["SWIPE"]
LEADS: Group = _LISTS["LEADS"]
TAILS: Group = _LISTS["TAILS"]
"""What may stand before and behind what a clause tells of a contact; never in held-out narratives."""
THEN: Group = _LISTS["THEN"]
THEN_REAR: Group = _LISTS["THEN_REAR"]
AREA: dict[str, Group] = _LISTS["AREA"]
REST: Group = _LISTS["REST"]
FIXED: Group = _LISTS["FIXED"]
"""Of those that are no vehicles."""
