"""Courses through the gore of a ramp: for standing actors and objects, and for vehicles that cross it late.

Knows the lane graph and the courses of ordinary driving; no time, no other actor.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.planner.encounter.meeting_place import STANDING
from sgcad_core.planner.lines.actor_course import Course, Passage
from sgcad_core.planner.lines.path import bezier, draw
from sgcad_core.records.specs import Actor, BehaviorSpec
from sgcad_core.roads.areas.gores import Gore, gores
from sgcad_core.roads.lane_graph import LaneGraph, road_of

NO_GORE = "the road has no gore that it could be in"
_BEFORE_M, _CROSSED_M = 3.0, 26.0
"""From the node along the road that is left, and the length of the crossing to the other one."""
_LED_M = 60.0


def through_gore(graph: LaneGraph, actor: Actor, course: Course, find: Callable[[Actor], Course]) -> Course:
    """The course of an actor in a gore; unchanged with a note where its road has none.

    `find`: the course of ordinary driving of an actor.
    """
    names = {name for name, _, _ in course.roads} | {actor.road, actor.exit_road}
    gore = next((g for g in gores(graph) if names & {road_of(g.road)[0], road_of(g.ramp)[0]}), None)
    if gore is None:
        return replace(course, notes=(*course.notes, f"{actor.id}: {NO_GORE}"))
    if actor.maneuver in STANDING or actor.record.laneless:
        return _standing(gore, course)
    road, ramp = road_of(gore.road)[0], road_of(gore.ramp)[0]
    if gore.leaves:
        other = road if actor.exit_road == ramp else ramp
        return _crossing_over(find(actor.model_copy(update={"exit_road": other})), course, leaves=True)
    other, way = (gore.road, gore.ramp)[:: 1 if actor.road == ramp else -1]
    name, direction = road_of(other)
    if actor.road != road_of(way)[0]:
        return replace(course, notes=(*course.notes, f"{actor.id}: {NO_GORE}"))
    beside = find(actor.model_copy(update={"road": name, "direction": direction}))
    return _crossing_over(course, beside, leaves=False)


def into_gores(behavior: BehaviorSpec) -> BehaviorSpec:
    """The behavior with the striker of an object in a gore driving into the gore."""
    things = {a.id for a in behavior.actors if a.gore and a.record.thing}
    by = {c.striker for c in behavior.contacts[:1] if c.struck in things}
    if not by:
        return behavior
    return behavior.model_copy(
        update={"actors": tuple(a.model_copy(update={"gore": True}) if a.id in by else a for a in behavior.actors)}
    )


def middle_of(gore: Gore) -> Floats:
    """(2, 2): the middle of a gore at its tip and at its base, in driving direction."""
    half = len(gore.corners) // 2
    tip, base = ((gore.corners[i] + gore.corners[-1 - i]) / 2 for i in (0, half - 1))
    return np.array([tip, base] if gore.leaves else [base, tip])


def _standing(gore: Gore, course: Course) -> Course:
    """Along the middle of the gore, which is its own part of the course."""
    start, end = middle_of(gore)
    ahead = (end - start) / max(float(np.hypot(*(end - start))), 1e-9)
    path = draw(np.array([start - _LED_M * ahead, start, end, end + _LED_M * ahead]))
    return replace(
        course, path=path, start_m=_LED_M, end_m=_LED_M + float(np.hypot(*(end - start))), passages=(), turn=None,
        roads=(), crosswalks=(), beside_m={},
    )  # fmt: skip


def _crossing_over(first: Course, second: Course, *, leaves: bool) -> Course:
    """Along one course, then across the gore onto another one."""
    node = _node(first), _node(second)
    if leaves:
        begins, ends = node[0].exit_m + _BEFORE_M, node[1].exit_m + _BEFORE_M + _CROSSED_M
    else:
        begins, ends = node[0].entry_m - _BEFORE_M - _CROSSED_M, node[1].entry_m - _BEFORE_M
    a, b = first.path.poses(np.array([begins, ends]))[0], second.path.poses(np.array([begins, ends]))[1]
    across = bezier(a[:2], float(a[2]), b[:2], float(b[2]))
    before = first.path.points[(first.path.s_m >= 0.0) & (first.path.s_m < begins - 1.0)]
    behind = second.path.points[(second.path.s_m > ends + 1.0) & (second.path.s_m < second.end_m)]
    path = draw(np.vstack((before, across, behind)))
    crossed = begins + float(np.hypot(*np.diff(across, axis=0).T).sum())
    return replace(
        first if leaves else second, path=path, start_m=first.start_m, end_m=crossed + second.end_m - ends, turn=None,
        passages=(Passage(node[0].node, begins, crossed, True),), crosswalks=(),
        roads=_driven(first, second, begins),
        notes=first.notes, astray=False, lane_width_m=first.lane_width_m,
    )  # fmt: skip


def _node(course: Course) -> Passage:
    """The junction that a course leads over."""
    return next((p for p in course.passages if p.is_junction and p.entry_m >= course.start_m), course.passages[-1])


def _driven(first: Course, second: Course, until_m: float) -> tuple[tuple[str, float, float], ...]:
    """Roads of the first course up to a station, then those of the second that it does not know."""
    own = tuple(road for road in first.roads if road[1] < until_m)
    known = {name for name, _, _ in own}
    return (*own, *(road for road in second.roads if road[0] not in known))
