"""A reading with what a writer or a person says of the vehicles beside their maneuvers, so that all follow it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from sgcad_core.reading.crash_facts import CrashFacts
from sgcad_core.records.acts import Acts, courses_with
from sgcad_core.records.specs import BehaviorSpec

if TYPE_CHECKING:
    from sgcad_core.reading.reading import Reading


def with_acts(reading: Reading, behavior: BehaviorSpec | None) -> Reading:
    """The reading as the behavior has it; the same one where it says nothing of acts."""
    said = behavior.acts if behavior else {}
    return saying(replace(reading, crash=crash_saying(reading.crash, said)), said) if said else reading


def crash_saying(crash: CrashFacts, said: Mapping[str, Acts]) -> CrashFacts:
    """The crash with the acts that are said of some vehicles."""
    from_stop = {who: acts.from_rest for who, acts in said.items() if acts.from_rest is not None}
    vehicles = tuple(replace(v, from_stop=from_stop.get(v.id, v.from_stop)) for v in crash.vehicles)
    return replace(crash, vehicles=vehicles, courses=courses_with(crash.courses, said))


def saying(reading: Reading, said: Mapping[str, Acts]) -> Reading:
    """The reading with what such acts say beside its crash: signals, and a loss of control of any vehicle."""
    shown = {who: acts.signal for who, acts in said.items() if acts.signal}
    lost = reading.lost_control or any(acts.lost_control for acts in said.values())
    return replace(reading, signals={**reading.signals, **shown}, lost_control=lost)
