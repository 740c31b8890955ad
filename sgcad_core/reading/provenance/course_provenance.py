"""Facts with their sentences of the course of a crash: evasion, spin and rest of every vehicle, later impacts.

Fields: `vehicles.<id>.evasion.brakes`, `.evasion.steers`, `.evasion.none`, `.lost_control`, `.spin`, `.spin_deg`,
`.rolls`, `.rest.facing_deg`, `.rest.where`, `.rest.side`, `.rest.attitude`, `.rest.against`, and `impacts.<n>.actor`,
`.other`, `.actor_area`, `.other_area`.
"""

from __future__ import annotations

from collections.abc import Iterator

from sgcad_core.reading.inference.inference_state import CrashTold
from sgcad_core.reading.provenance.crash_provenance import FactBuilder
from sgcad_core.records.course import CourseTold
from sgcad_core.records.facts import Fact, Value

_REST = ("facing_deg", "where", "side", "attitude", "against")
_PLAIN = ("lost_control", "spin", "spin_deg", "rolls")


def course_provenance(builder: FactBuilder, crash_told: CrashTold) -> Iterator[Fact]:
    """Facts of every vehicle's course, then of what else was hit, in order."""
    for vehicle, course in crash_told.course.courses.items():
        for name, value, told_as in _told(course):
            source = crash_told.course.sources.get(f"{vehicle} {told_as}")
            yield builder.stated(f"vehicles.{vehicle}.{name}", value, source)
    for number, (impact, source) in enumerate(crash_told.impacts):
        for name in ("actor", "other", "actor_area", "other_area"):
            if (told := getattr(impact, name)) is not None:
                yield builder.stated(f"impacts.{number}.{name}", told, source)


def _told(course: CourseTold) -> Iterator[tuple[str, Value, str]]:
    """(field, value, where its source stands) of what is told."""
    if course.brakes:
        yield "evasion.brakes", True, "brakes"
    if course.steers:
        yield "evasion.steers", course.steers, "steers"
    if course.no_evasion and not (course.brakes or course.steers):
        yield "evasion.none", True, "no_evasion"
    for name in _PLAIN:
        if value := getattr(course, name):
            yield name, value, name
    for name in _REST:
        if (value := getattr(course.rest, name)) is not None:
            yield f"rest.{name}", value, f"rest.{name}"
