"""Clauses that say nothing of the scene: occupants, injuries, interviews, health, codes, police.

They hold vehicle names, directions and verbs on purpose: half of a real report is like this. {V} {W} mention
vehicles, {He} {he} {his} the driver, {sex} {age}; {kn} a rest of numbers, {mph} a driver's speed.
"""

from __future__ import annotations

from research.generator.records import Group, read

_LISTS = read("noise")

TOW: Group = _LISTS["TOW"]
OCCUPANT: Group = _LISTS["OCCUPANT"]
INTERVIEW: Group = _LISTS["INTERVIEW"]
HEALTH: Group = _LISTS["HEALTH"]
CODES: Group = _LISTS["CODES"]
POLICE: Group = _LISTS["POLICE"]
NONCONTACT: Group = _LISTS["NONCONTACT"]
SPEED: Group = _LISTS["SPEED"]

GROUPS = {
    "tow": TOW,
    "occupant": OCCUPANT,
    "interview": INTERVIEW,
    "health": HEALTH,
    "codes": CODES,
    "police": POLICE,
    "noncontact": NONCONTACT,
}
