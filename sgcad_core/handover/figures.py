"""What a scripted crash's contact was like and what could have been done against it: figures beside the metrics.

Stand in metrics.json under `exact`. By actor where they are one vehicle's.
"""

from __future__ import annotations

from typing import Any

from sgcad_core.handover.avoidance import avoidance
from sgcad_core.handover.script import DRIVEN, Script, staged
from sgcad_core.handover.severity import severity
from sgcad_core.records import ObservedContact

_ASKED_S = 2.0
"""How long before the contact the least deceleration is asked: `required_2_s_before_mps2`."""


def contact_figures(script: Script, contact: ObservedContact | None) -> dict[str, Any]:
    """Delta-v, energy, risk, and the last moments to brake and to move aside; empty without a contact."""
    if contact is None:
        return {}
    hard = severity(contact, script.trajectories, {a.id: a for a in script.actors})
    risks = [s.risk for s in (hard.first, hard.second) if s.risk is not None]
    figures: dict[str, Any] = {
        "delta_v_mps": {s.actor: round(s.delta_v_mps, 3) for s in (hard.first, hard.second)},
        "delta_v_worst_mps": round(hard.worst_delta_v_mps, 3),
        "contact_energy_j": round(hard.energy_j, 1),
        "fatality_risk": round(max(risks), 6) if risks else None,
        "brake_by_s": {}, "brake_by_m": {}, "steer_by_s": {}, "required_2_s_before_mps2": {},
    }  # fmt: skip
    for name in (contact.actor, contact.other):
        if script.info(name).type in DRIVEN and (could := avoidance(staged(script, name), (_ASKED_S,))) is not None:
            figures["brake_by_s"][name], figures["brake_by_m"][name] = could.brake_by_s, could.brake_by_m
            figures["steer_by_s"][name] = could.steer_by_s
            figures["required_2_s_before_mps2"][name] = could.required_mps2.get(f"{_ASKED_S:g}")
    return figures
