"""Factors between the units of reports and SI."""

from __future__ import annotations

MPS_PER_MPH = 0.44704
"""Exact: 1,609.344 m in 3,600 s."""
