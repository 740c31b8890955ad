"""People on foot: vehicles yield to them in a marked crosswalk (UVC 11-502), they yield elsewhere (UVC 11-503), and
walk with the signal (UVC 11-203 and 11-501).

Against the signal: they step into a crosswalk while traffic on the road that it crosses has green or yellow. Crosswalks
are those drawn on the map; unmarked ones are unknown to it, so at a junction without a drawn one a person who crosses
gives `unknown`. Measured: the least time between one leaving a place and the other coming to it.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from sgcad_core.geometry.distances import distance_to
from sgcad_core.metrics.lane_places import PLACES
from sgcad_core.roads.lane_graph import Crossing
from sgcad_core.rules.passages import junction_words
from sgcad_core.rules.records import Mover, RuleFinding, RuleScene, Status
from sgcad_core.rules.right_of_way import meeting

_BESIDE_M = 0.6
"""By which a person may walk beside the markings."""
_UNMARKED_M = 8.0
"""From a junction's area: nearer, a crosswalk may be there unmarked."""


class Walk(NamedTuple):
    """A person who crosses: the crosswalk (None: without), and the samples on the road."""

    person: Mover
    crossing: Crossing | None
    first: int
    last: int


def walks(scene: RuleScene) -> Iterator[Walk]:
    """All people on foot who step onto lanes for cars."""
    for person in scene.movers:
        if person.info.record.sort != "person":
            continue
        on = np.isin(person.steps.codes, [PLACES.index(p) for p in ("lane", "center_lane", "junction", "opposing")])
        for crossing in scene.graph.crossings:
            on |= _in(crossing, person)
        at = np.flatnonzero(on & (person.speed_mps > 0.1))
        if len(at):
            used = next((c for c in scene.graph.crossings if _in(c, person)[at].mean() > 0.5), None)
            yield Walk(person, used, int(at[0]), int(at[-1]))


def against_signal(scene: RuleScene) -> Iterator[RuleFinding]:
    """One finding for each person in a crosswalk under a signal."""
    for walk in walks(scene):
        states = _crossed_traffic(scene, walk)
        if states is None:
            continue
        status: Status = "unknown" if not states else "broken" if states & {"green", "yellow"} else "kept"
        note = f"traffic has {' and '.join(sorted(states))}" if states else "the map tells no plan of the signals"
        yield walk.person.found("red_light", status, (walk.first, walk.first), _where(walk), None, None, "s", note)


def at_crosswalks(scene: RuleScene) -> Iterator[RuleFinding]:
    """One finding for each vehicle and person who come near: about the one that must yield."""
    for walk in walks(scene):
        states = _crossed_traffic(scene, walk)
        for mover in scene.movers:
            if mover.lanes_bound and (found := _pair(scene, walk, states, mover)) is not None:
                yield found


def _pair(scene: RuleScene, walk: Walk, states: set[str] | None, mover: Mover) -> RuleFinding | None:
    unlawful = walk.crossing is None or bool(states and states & {"green", "yellow"})
    unknown = (walk.crossing is None and _near_junction(scene, walk)) or (states is not None and not states)
    one, other = (walk.person, mover) if unlawful else (mover, walk.person)
    span = (walk.first, walk.last) if one is walk.person else (0, len(mover.pose) - 1)
    met = meeting(one, span, other)
    if met.apart_s > 2 * scene.limits.hazard_s or float(mover.speed_mps.max()) < scene.limits.moving_mps:
        return None
    hazard = met.first and met.gap_s < scene.limits.hazard_s
    status: Status = "unknown" if unknown else "broken" if hazard else "kept"
    note = "the map tells no crosswalk or signal here" if unknown else ""
    gap = met.gap_s if met.first and np.isfinite(met.gap_s) else met.apart_s
    at = (walk.first, walk.last)
    return one.found("right_of_way", status, at, _where(walk), gap, scene.limits.hazard_s, "s", note, other.id)


def _where(walk: Walk) -> str:
    return f"crosswalk at {junction_words(walk.crossing.node)}" if walk.crossing else "on the road, no crosswalk"


def _in(crossing: Crossing, person: Mover) -> NDArray[np.bool_]:
    """(n,) whether the person is within the markings."""
    near: NDArray[np.bool_] = distance_to(crossing.shape, person.pose[:, :2]) <= crossing.width_m / 2 + _BESIDE_M
    return near


def _near_junction(scene: RuleScene, walk: Walk) -> bool:
    points = walk.person.pose[walk.first : walk.last + 1, :2]
    ways = [c.via_shape for c in scene.graph.connections if len(c.via_shape) > 1]
    return any(float(distance_to(way, points).min()) < _UNMARKED_M for way in ways)


def _crossed_traffic(scene: RuleScene, walk: Walk) -> set[str] | None:
    """What the signals of the crossed road show as the person steps into a crosswalk; None where none stand there,
    empty where the plan is not told."""
    if walk.crossing is None:
        return None
    graph, node = scene.graph, walk.crossing.node
    into = [e for e in walk.crossing.edges if graph.edges[e].to_node == node]
    links = [c for e in into for c in graph.leaving(e) if c.light and c.direction == "through"]
    links = links or [c for e in into for c in graph.leaving(e) if c.light]
    if not links:
        return None
    shown = [scene.shown(c, walk.first) for c in links]
    return {one.state for one in shown if one is not None}
