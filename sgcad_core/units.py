"""Factors between the units of reports and SI."""

from __future__ import annotations

MPS_PER_MPH = 0.44704
"""Exact: 1,609.344 m in 3,600 s."""
METERS: dict[str, float] = {
    **dict.fromkeys(("foot", "feet", "ft"), 0.3048),
    **dict.fromkeys(("yard", "yards", "yd", "yds"), 0.9144),
    **dict.fromkeys(("m", "meter", "meters", "metre", "metres"), 1.0),
    **dict.fromkeys(("mile", "miles"), 1609.344),
}
"""By the word of a unit of length; exact (international foot, yard and mile)."""
