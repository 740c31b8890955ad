"""Metrics of the last seconds before the first contact, which distinguish crashes.

At the contact every time to collision is 0; a second before it is not. Exact boxes, constant velocity, the pair that
touches first. SI units; None where the value is not defined.

TTC at 0.5, 1 and 2 s before the contact: the time left if both kept speed and direction. Time exposed (TET) and its
integral (TIT): of TTC under a threshold; TIT sums threshold - TTC (M. M. Minderhoud, P. H. L. Bovy, Accident Analysis
and Prevention 33 (2001) 89). DRAC: (v1 - v2)^2 / (2 gap) in line (D. F. Cooper, N. Ferguson, 1976); in the plane
|v_rel| / (2 TTC). Onset of braking: the first step from which a vehicle decelerates by more than 2 m/s2 until the
contact, with the TTC then.
"""

from __future__ import annotations

import math
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from sgcad_core.case.records import Floats
from sgcad_core.metrics import conflict
from sgcad_core.metrics.swept_cells import Track

BEFORE_S = (0.5, 1.0, 2.0)
THRESHOLD_S = 1.5
"""Of TET and TIT: the usual one of conflicts."""
HARD_MPS2 = 3.35
"""DRAC beyond which a conflict counts (J. Archer, 2005)."""
BRAKING_MPS2 = 2.0


class Pair(NamedTuple):
    """Two actors that touch, up to (and without) the step of their first overlap."""

    first: str
    second: str
    a: Track
    b: Track
    contact_s: float


def first_pair(tracks: dict[str, Track]) -> Pair | None:
    """The pair that overlaps first, neither from the start on; of several in one step the first by name."""
    found: tuple[int, str, str] | None = None
    for a, b in combinations(sorted(tracks), 2):
        hit = conflict.first_overlap(tracks[a], tracks[b])
        if hit is not None and hit > 1 and (found is None or hit < found[0]):
            found = hit, a, b
    if found is None:
        return None
    k, a, b = found
    return Pair(a, b, _until(tracks[a], k), _until(tracks[b], k), float(tracks[a].t_s[k]))


def _until(track: Track, k: int) -> Track:
    """The part before a step, with velocities from earlier steps only (without the effect of the contact)."""
    velocity = np.gradient(track.pose[:k, :2], track.t_s[:k], axis=0) if k > 1 else track.velocity[:k]
    return Track(track.t_s[:k], track.pose[:k], velocity, track.size)


def precontact_figures(tracks: dict[str, Track]) -> dict[str, Any]:
    """The figures by name; empty without a contact."""
    pair = first_pair(tracks)
    if pair is None:
        return {}
    ttc = conflict.time_to_collision(pair.a, pair.b)
    drac = conflict.required_deceleration(pair.a, pair.b, ttc)
    figures: dict[str, Any] = {}
    for before in BEFORE_S:
        k = _step(pair, before)
        name = f"{before:g}".replace(".", "_")
        figures[f"ttc_{name}_s_before_s"] = None if k is None else _finite(float(ttc[k]))
        figures[f"drac_{name}_s_before_mps2"] = None if k is None else _finite(float(drac[k]))
    step = float(pair.a.t_s[1] - pair.a.t_s[0])
    short = np.maximum(THRESHOLD_S - ttc, 0.0)
    figures["time_exposed_ttc_s"] = round(float((short > 0).sum()) * step, 3)
    figures["time_integrated_ttc_s2"] = round(float(short.sum()) * step, 4)
    figures["time_exposed_drac_s"] = round(float((drac > HARD_MPS2).sum()) * step, 3)
    return figures | _braking(pair, ttc)


def _step(pair: Pair, before_s: float) -> int | None:
    """The step at a time before the contact; None where the clock begins later."""
    at = pair.contact_s - before_s
    return None if at < pair.a.t_s[0] - 1e-9 else int(np.abs(pair.a.t_s - at).argmin())


def _braking(pair: Pair, ttc: Floats) -> dict[str, Any]:
    """The first of the two to brake: time before the contact and TTC."""
    onsets = [k for track in (pair.a, pair.b) if (k := _onset(track)) is not None]
    if not onsets:
        return {"braking_s_before_s": None, "ttc_at_braking_s": None}
    k = min(onsets)
    return {
        "braking_s_before_s": round(pair.contact_s - float(pair.a.t_s[k]), 3),
        "ttc_at_braking_s": _finite(float(ttc[k])),
    }


def _onset(track: Track) -> int | None:
    """The step from which on it brakes until the end."""
    speed = np.hypot(*track.velocity.T)
    if len(speed) < 3:
        return None
    braking = np.diff(speed) / np.diff(track.t_s) < -BRAKING_MPS2
    lasting = np.flatnonzero(~braking[: len(braking)])
    first = int(lasting[-1]) + 1 if len(lasting) else 0
    return first if first < len(braking) - 1 else None


def _finite(value: float) -> float | None:
    return round(value, 4) if math.isfinite(value) else None
