"""Clauses about the error that led to the crash, by configuration: {V} errs, {W} is the other.

{turn} left or right, {axis} a road's run, {opp} the heading of oncoming traffic; {anyside} is noise. Errors of vehicles
that cross, turn or back have groups of their own.
"""

from __future__ import annotations

from research.generator.records import Group, read

_LISTS = read("turning")

CRITICAL: dict[str, Group] = read("critical")["CRITICAL"]

PROCEEDS: dict[str, Group] = _LISTS["PROCEEDS"]
"""What one does that has stood or slowed: it goes. Trains only."""
ONWARD: Group = _LISTS["ONWARD"]
"""One that turns, and where it meant to go: with the turn that tells where it came from. They only train."""
STRAYS: Group = _LISTS["STRAYS"]
"""One that comes into the next lane without meaning to change lanes, or from beside the road. They only train."""
INTO: Group = _LISTS["INTO"]
"""A left turn off the road into a driveway; trains only."""
INTO_WHY: dict[str, Group] = _LISTS["INTO_WHY"]
"""What one stood or slowed for on a road with a driveway; trains only."""
YIELDS: Group = _LISTS["YIELDS"]
"""What one waits for who is about to turn: traffic of another heading than its own; trains only."""
