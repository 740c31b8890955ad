"""The course of an actor by its maneuver: along lanes, out of a stall, in reverse, through a gore, at the road's edge.

Knows the lane graph and one actor; no time.
"""

from __future__ import annotations

from typing import cast

from sgcad_core.planner.lines.actor_course import Course, find_course
from sgcad_core.planner.lines.gore_lines import through_gore
from sgcad_core.planner.lines.stalls import out_of_stall
from sgcad_core.planner.lines.walkers import at_the_edge
from sgcad_core.records.specs import Actor, size_m
from sgcad_core.roads.lane_graph import LaneGraph


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
    keeps_right = actor.record.keeps_right and actor.lane in (None, 1) and actor.maneuver not in ("turn_left", "u_turn")
    return at_the_edge(course) if keeps_right else course
