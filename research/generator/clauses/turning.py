"""Clauses about errors of those who cross, turn or back: what {V} does in the way of {W}.

{axis} {axis} a road's run, {opp} the heading of oncoming traffic.
"""

from __future__ import annotations

from research.generator.records import Group, read

_LISTS = read("turning")

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
