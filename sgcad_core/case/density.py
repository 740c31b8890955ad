"""How dense traffic may be. Apart from its records, so that the command line can check the word quickly."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Literal, get_args

Density = Literal["light", "dense"]
DENSITIES: tuple[Density, ...] = get_args(Density)
PER_KM: Mapping[Density, float] = {"light": 5.0, "dense": 20.0}
"""Vehicles per kilometre and lane: 8 and 32 per mile, inside levels of service A (up to 11) and D (26 to 35) of the
Highway Capacity Manual, whose levels of freeways and multilane highways go by density (6th edition, exhibit 12-15)."""
NO_TRAFFIC: Literal["none"] = "none"
