"""Facts with their sentences of the course of a crash: evasion, spin and rest of every vehicle, later impacts.

Fields: `vehicles.<id>.evasion.brakes`, `.evasion.steers`, `.evasion.none`, `.lost_control`, `.spin`, `.spin_deg`,
`.rolls`, `.rest.facing_deg`, `.rest.where`, `.rest.side`, `.rest.attitude`, `.rest.against`, and `impacts.<n>.actor`,
`.other`, `.actor_area`, `.other_area`.
"""

from __future__ import annotations

from collections.abc import Iterator

from sgcad_core.reading.inference.inference_state import Draft
from sgcad_core.reading.provenance.crash_provenance import Telling
from sgcad_core.records.course import CourseTold
from sgcad_core.records.facts import Fact, Value

_REST = ("facing_deg", "where", "side", "attitude", "against")
_PLAIN = ("lost_control", "spin", "spin_deg", "rolls")


def course_provenance(telling: Telling, draft: Draft) -> Iterator[Fact]:
    """Facts of every vehicle's course, then of what else was hit, in order."""
    for vehicle, course in draft.course.courses.items():
        for name, value, source in _told(course):
            cue = draft.course.sources.get(f"{vehicle} {source}")
            yield telling.stated(f"vehicles.{vehicle}.{name}", value, cue)
    for number, (impact, cue) in enumerate(draft.impacts):
        for name in ("actor", "other", "actor_area", "other_area"):
            if (told := getattr(impact, name)) is not None:
                yield telling.stated(f"impacts.{number}.{name}", told, cue)


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
