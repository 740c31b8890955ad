"""Figures of the contact of a script and of the chances to avoid it, beside the metrics.

They are part of metrics.json (`exact`), by actor where they belong to one vehicle.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from sgcad_core.case.driver_io import STEP_S
from sgcad_core.case.records import ObservedContact, Trajectory
from sgcad_core.handover.avoidance import avoidance
from sgcad_core.handover.script import Script, staging_for
from sgcad_core.handover.severity import executed_severity

_STANDS_M = 1e-4
"""An actor that moves (m) or turns (rad) less in a sample stands."""
_ASKED_S = 2.0
"""Time before the contact for which the least deceleration is computed: `required_2_s_before_mps2`."""


def contact_figures(script: Script, contact: ObservedContact | None) -> dict[str, Any]:
    """Delta-v, energy, risk, and the last moments to brake and to move aside; empty without a contact."""
    if contact is None:
        return {}
    hard = executed_severity(contact, script.trajectories, {a.id: a for a in script.actors})
    risks = [s.risk for s in (hard.first, hard.second) if s.risk is not None]
    figures: dict[str, Any] = {
        "delta_v_mps": {s.actor: round(s.delta_v_mps, 3) for s in (hard.first, hard.second)},
        "delta_v_worst_mps": round(hard.worst_delta_v_mps, 3),
        "contact_energy_j": round(hard.energy_j, 1),
        "fatality_risk": round(max(risks), 6) if risks else None,
        "brake_by_s": {}, "brake_by_m": {}, "steer_by_s": {}, "required_2_s_before_mps2": {},
    }  # fmt: skip
    for name in (contact.actor, contact.other):
        if script.info(name).record.driven and (could := avoidance(staging_for(script, name), (_ASKED_S,))) is not None:
            figures["brake_by_s"][name], figures["brake_by_m"][name] = could.brake_by_s, could.brake_by_m
            figures["steer_by_s"][name] = could.steer_by_s
            figures["required_2_s_before_mps2"][name] = could.required_mps2.get(f"{_ASKED_S:g}")
    return figures


def impact_summary(script: Script, contact: ObservedContact | None) -> dict[str, Any] | None:
    """The first contact for result.json: change of velocity and rest of both actors.

    `delta_v_mps`: of the center; `ahead`: its part along the heading, negative where slowed. `rest`: box center and
    heading, from when it stands (null: it still moves at the end), how far it went and turned since the contact
    (counter-clockwise). None without a contact.
    """
    if contact is None:
        return None
    hard = executed_severity(contact, script.trajectories, {a.id: a for a in script.actors})
    track = {t.actor: t for t in script.trajectories}
    return {
        "t_s": contact.t_s, "closing_mps": round(hard.closing_mps, 3), "energy_j": round(hard.energy_j, 1),
        "actors": [
            {"id": s.actor, "delta_v_mps": round(s.delta_v_mps, 3), "ahead_mps": round(s.delta_v_ahead_mps, 3),
             "rest": _rest(track[s.actor], contact.t_s)}
            for s in (hard.first, hard.second)
        ],
    }  # fmt: skip


def _rest(track: Trajectory, contact_s: float) -> dict[str, Any]:
    """The last pose, and distance and rotation since the contact."""
    k = min(max(round(contact_s / STEP_S), 0), len(track.t_s) - 1)
    x, y, heading = track.x_m, track.y_m, np.unwrap(track.heading_rad)
    steps = np.hypot(np.diff(x), np.diff(y))
    moving = np.flatnonzero((steps > _STANDS_M) | (np.abs(np.diff(heading)) > _STANDS_M))
    last = int(moving[-1]) + 1 if len(moving) else 0
    return {
        "x_m": round(float(x[-1]), 3), "y_m": round(float(y[-1]), 3),
        "heading_rad": round(math.remainder(float(heading[-1]), 2 * math.pi), 4),
        "from_s": round(float(track.t_s[last]), 3) if last < len(track.t_s) - 1 else None,
        "went_m": round(float(steps[k:].sum()), 3), "turned_rad": round(float(heading[-1] - heading[k]), 4),
    }  # fmt: skip
