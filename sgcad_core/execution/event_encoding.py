"""Plans as maneuver events that were tested: parts that are played otherwise are written in plainer form.

Lanes, meetings and conditions make a scenario editable by people, but leave something to the player. So the file is
played; actors off the plan before the contact, or another contact, cost the meeting first, then the lanes of these
actors, then the conditions. Knows the writer and the player; no planner.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from sgcad_core.case.records import ActorInfo, ObservedContact, Trajectory, sizes_of
from sgcad_core.execution.contact import first_contact
from sgcad_core.formats.opendrive.signals import Controller
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.formats.openscenario.writing.events import EventOptions, Fallbacks
from sgcad_core.formats.openscenario.writing.versions import Version
from sgcad_core.formats.openscenario.writing.writer import Handles, write_xosc
from sgcad_core.records.specs import BehaviorSpec

ASTRAY_M = 0.3
"""Largest distance from the plan until the contact."""
LATE_S = 0.1
"""Largest difference in time of the contact."""


def write_editable(
    actors: Sequence[ActorInfo],
    trajectories: Sequence[Trajectory],
    behavior: BehaviorSpec | None,
    handover: EventOptions,
    version: Version,
    signals: Sequence[Controller] = (),
) -> str:
    """The .xosc of a plan as events, near the plan until the contact. Raises InvalidOutput as the writer does."""
    told = handover.plainly
    while True:
        way = replace(handover, plainly=told)
        text = write_xosc(
            actors, trajectories, behavior, version=version, handover=way, signals=signals, handles=Handles()
        )
        astray = _astray(actors, trajectories, handover.contact, play(text, handover.xodr))
        if not astray or (plainer := _plainer(told, astray, text)) == told:
            return text
        told = plainer


def _plainer(told: Fallbacks, astray: frozenset[str], text: str) -> Fallbacks:
    """The next plainer form for the actors off the plan; the same where there is none."""
    if not told.alone and "<SynchronizeAction" in text:
        return replace(told, alone=True)
    if astray - told.paths:
        return replace(told, alone=True, paths=told.paths | astray)
    return replace(told, clock=True)


def _astray(
    actors: Sequence[ActorInfo],
    planned: Sequence[Trajectory],
    contact: ObservedContact | None,
    played: Sequence[Trajectory],
) -> frozenset[str]:
    """Actors too far from the plan before the contact; both of the pair where it is another contact."""
    by_name = {t.actor: t for t in played}
    until_s = contact.t_s - 1e-6 if contact else float(planned[0].t_s[-1])
    astray = {t.actor for t in planned if _away_m(t, by_name[t.actor], until_s) > ASTRAY_M}
    seen = first_contact(played, sizes_of(actors))
    if contact and not _same(contact, seen):
        astray |= {contact.actor, contact.other}
    return frozenset(astray)


def _away_m(planned: Trajectory, played: Trajectory, until_s: float) -> float:
    n = min(int(np.searchsorted(planned.t_s, until_s)), len(played.t_s))
    gaps = np.hypot(planned.x_m[:n] - played.x_m[:n], planned.y_m[:n] - played.y_m[:n])
    return float(gaps.max(initial=0.0))


def _same(contact: ObservedContact, seen: ObservedContact | None) -> bool:
    """Whether it is the planned contact: pair, sides, and nearly the time."""
    if seen is None or abs(seen.t_s - contact.t_s) > LATE_S:
        return False
    return seen.model_copy(update={"t_s": contact.t_s}) == contact
