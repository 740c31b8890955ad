"""What a plan asks of single actors and contacts: their line, whom they face, whether a contact is the declared one.

Knows no scene.
"""

from __future__ import annotations

import math
from dataclasses import replace
from typing import cast

from sgcad_core.case.records import ObservedContact
from sgcad_core.planner.actor_plan import Role, speed_there, usual_speed
from sgcad_core.planner.lines.actor_course import Course, find_course
from sgcad_core.planner.lines.gore_lines import through_gore
from sgcad_core.planner.lines.stalls import out_of_stall
from sgcad_core.planner.lines.walkers import at_the_edge
from sgcad_core.planner.motion import Motion
from sgcad_core.records.specs import Actor, Area, Contact, size_m
from sgcad_core.roads.lane_graph import LaneGraph

_SPEED_SHOWS_S = 0.3


def course_of(graph: LaneGraph, actor: Actor, gentle: float) -> Course:
    """The course of an actor, made once: of other readings of a report most actors stay as they are."""
    if (known := graph.derived.get((actor, gentle))) is not None:
        return cast("Course", known)
    course = graph.derived[actor, gentle] = _course_of(graph, actor, gentle)
    return course


def _course_of(graph: LaneGraph, actor: Actor, gentle: float) -> Course:
    course = find_course(graph, actor, gentle)
    if actor.gore:
        return through_gore(graph, actor, course, lambda other: find_course(graph, other, gentle))
    if actor.maneuver == "backing" and course.stalls:
        return out_of_stall(course, size_m(actor)[0])
    if actor.maneuver == "backing" and actor.exit_road in (None, actor.road):
        return course.reversed()
    keeps_right = actor.record.keeps_right and actor.lane is None and actor.maneuver not in ("turn_left", "u_turn")
    return at_the_edge(course) if keeps_right else course


def facing_other(role: Role, other: Role) -> Role:
    return replace(
        role,
        other_mps=speed_there(other),
        other_width_m=other.size[1],
        other_side=other.side,
        other_road=other.actor.road,
        other_spins=bool(other.spins),
    )


def seen_s(role: Role, motion: Motion, contact_s: float) -> float:
    """How long before the contact the clock must begin to show a told speed; 0 where it is never driven."""
    if motion.standing or role.actor.speed_mph is None:
        return 0.0
    seen = contact_s - motion.seen_at(usual_speed(role), contact_s)
    return seen + _SPEED_SHOWS_S if math.isfinite(seen) else 0.0


def is_declared(seen: ObservedContact | None, declared: Contact | None) -> bool:
    if seen is None or declared is None:
        return seen is None and declared is None
    sides = {seen.actor: seen.actor_area, seen.other: seen.other_area}
    return sides == {declared.striker: declared.striker_area, declared.struck: declared.struck_area}


def pair_of(contact: Contact) -> frozenset[str]:
    return frozenset((contact.striker, contact.struck))


def other_of(contact: Contact, partner: str) -> tuple[str, tuple[Area, Area]]:
    """Whom a partner touches in a contact, and the sides of the partner and of the other one."""
    if partner == contact.striker:
        return contact.struck, (contact.striker_area, contact.struck_area)
    return contact.striker, (contact.struck_area, contact.striker_area)
