"""A reading with what a writer says of the vehicles beside their maneuvers, so that plan and checks follow it."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

from sgcad_core.records.acts import courses_with
from sgcad_core.records.specs import BehaviorSpec

if TYPE_CHECKING:
    from sgcad_core.reading.reading import Reading


def with_acts(reading: Reading, behavior: BehaviorSpec | None) -> Reading:
    """The reading as the behavior has it; the same one where it says nothing of acts."""
    said = behavior.acts if behavior else {}
    if not said:
        return reading
    from_stop = {who: acts.from_rest for who, acts in said.items() if acts.from_rest is not None}
    vehicles = tuple(replace(v, from_stop=from_stop.get(v.id, v.from_stop)) for v in reading.crash.vehicles)
    shown = {who: acts.signal for who, acts in said.items() if acts.signal}
    return replace(
        reading,
        crash=replace(reading.crash, vehicles=vehicles, courses=courses_with(reading.crash.courses, said)),
        signals={**reading.signals, **shown},
        lost_control=reading.lost_control or any(acts.lost_control for acts in said.values()),
    )
