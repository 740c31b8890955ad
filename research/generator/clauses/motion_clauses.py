"""Clauses about motion before the crash. {V} {W} {U} mention a vehicle, {Vf} introduces it with year and model.

{dir} {xb} heading, {lane} lane, {road} the road with lanes, {appr} what it approaches, {turn} left or right.
"""

from __future__ import annotations

from research.generator.records import Group, read

_LISTS = read("motion")

APPROACH: Group = _LISTS["APPROACH"]
"""{appr} may be empty."""
FROM_STEM: dict[str, Group] = _LISTS["FROM_STEM"]
"""Of one on the leg that ends at the junction: where that leg is known, so is which way it drove. They only train."""
APPROACH_STOPPED: Group = _LISTS["APPROACH_STOPPED"]
APPROACH_WAITING: Group = _LISTS["APPROACH_WAITING"]
PRESENTED: dict[str, Group] = _LISTS["PRESENTED"]
"""After `V1 was a 2003 sedan`."""
APPROACH_SLOWING: Group = _LISTS["APPROACH_SLOWING"]
APPROACH_PARKED: Group = _LISTS["APPROACH_PARKED"]
APPROACH_CURVE: Group = _LISTS["APPROACH_CURVE"]
WHY: dict[str, Group] = _LISTS["WHY"]
SAME: Group = _LISTS["SAME"]
AHEAD: Group = _LISTS["AHEAD"]
INTENT: dict[str, Group] = _LISTS["INTENT"]
