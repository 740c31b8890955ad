"""The speed of free traffic where a report tells no number: the limit, or what words say of it. Knows no actor."""

from __future__ import annotations

from sgcad_core.records.course import Pace
from sgcad_core.units import MPS_PER_MPH

MOST_MPS = 26.0
"""That nobody drives faster than untold, whatever the limit."""
OVER_LIMIT_MPS = 10.0 * MPS_PER_MPH
"""How far "at a high rate of speed" is above the limit: much of free traffic drives 5 mph over it, and a report remarks
on what stands out from that."""
SLOW_SHARE = 1.0 / 3.0
"""Share of the limit at which one drives "slowly": 10 mph in a town, 20 mph where the others drive 60."""
BACKS_MPS: dict[Pace | None, float] = {None: 2.5, "fast": 5.0, "slow": 1.25}
"""Speed of one that backs, untold and as told."""


def free_speed(pace: Pace | None, limit_mps: float, own_mps: float | None) -> float:
    """Metres per second that an actor drives unhindered; `own_mps`: the usual speed of its kind, of one that no limit
    holds back."""
    usual = min(limit_mps, MOST_MPS) if own_mps is None else own_mps
    if pace == "slow":
        return usual * (SLOW_SHARE if own_mps is None else 0.5)
    return usual if pace is None else max(usual, limit_mps) + OVER_LIMIT_MPS if own_mps is None else 1.5 * usual
