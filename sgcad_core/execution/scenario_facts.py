"""Facts of the written scenario: roads; start, speed and exit of every actor; and their sources.

A value that the text states or suggests points to its sentence; one that a model answered has the model's grounding;
the rest is a default of a template or of the planner and is marked so. Knows records and the reading; no file.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from sgcad_core.case.records import Generation, RoadNetwork, Scenario, Trajectory
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.geometry.distances import distance_to
from sgcad_core.reading.provenance.crash_provenance import CONFIDENCE, default
from sgcad_core.reading.provenance.road_provenance import road_of_bearing
from sgcad_core.reading.reading import Reading
from sgcad_core.records.acts import ACT_FIELDS, act_of
from sgcad_core.records.facts import Basis, Fact, Status, Value
from sgcad_core.records.specs import Actor, Road
from sgcad_core.roads.lane_graph import LaneGraph, road_of
from sgcad_core.units import MPS_PER_MPH


@dataclass(frozen=True)
class Grounds:
    """Sources of the values of one stage: facts by name, and the answer of a model if there is one."""

    told: Mapping[str, Fact]
    answer: Generation | None = None
    drawn: bool = False
    """Whether the model saw a drawing too."""

    def fact(self, field: str, value: Value, path: str, sources: tuple[str, ...], otherwise: str) -> Fact:
        """A model's answer (at `path`), else what the first known of the told `sources` suggests, else a default."""
        if self.answer is not None and path:
            return self._answered(field, value, path, sources)
        known = self._known(sources)
        if known is None or known.status == "default":
            return default(field, value, otherwise)
        return Fact.model_validate(known.model_dump() | {"field": field, "value": value, **_followed(known, value)})

    def _known(self, sources: tuple[str, ...]) -> Fact | None:
        return next((self.told[name] for name in sources if name in self.told), None)

    def _answered(self, field: str, value: Value, path: str, sources: tuple[str, ...]) -> Fact:
        """Grounded values that no sentence states are from the drawing, where there is one."""
        nats = self.answer.grounding.get(path) if self.answer else None
        known = self._known(sources)
        silent = known is None or known.status == "default"
        basis: Basis = "diagram" if self.drawn and silent and nats is not None and nats > 0 else "model"
        status: Status = "stated" if nats is None or nats > 0 else "inferred"
        rule, sure = ("grounding" if nats is not None else "answer"), CONFIDENCE.model
        return Fact(field=field, value=value, basis=basis, status=status, rule=rule, confidence=sure, nats=nats)


def _followed(known: Fact, value: Value) -> dict[str, object]:
    """Changes of a fact whose value differs from the stated one: it is inferred."""
    if known.value == value:
        return {}
    return {"status": "inferred", "confidence": min(known.confidence, CONFIDENCE.inferred)}


def road_facts_written(
    network: RoadNetwork, reading: Reading, answer: Generation | None, drawn: bool = False
) -> Iterator[Fact]:
    """Lanes each way and limit of every road drawn from a spec, by the road's id; `drawn`: a model saw a drawing."""
    grounds = Grounds({f.field: f for f in reading.facts}, answer, drawn)
    for number, road in enumerate(network.spec.roads if network.spec else ()):
        at, leg = f"roads.{road.id}", _leg(network, road)
        told = road_of_bearing(reading.roads, road.id)
        for way, end in (("forward", "in"), ("backward", "out")):
            path = f"legs[{leg}].lanes_{end}" if leg is not None else f"roads[{number}].lanes_{way}"
            names = ("lanes_total", "lanes_each_way", "one_way")
            answered = f"{at}.lanes_{way}"  # of a second opinion, which names legs
            sources = (answered, *(f"roads.{told}.{name}" for name in names)) if told else (answered,)
            value = road.lanes_forward if way == "forward" else road.lanes_backward
            yield grounds.fact(f"{at}.lanes_{way}", value, path, sources, "one lane each way unless told")
        if road.speed_limit_mph is not None:
            path = f"legs[{leg}].speed_limit_mph" if leg is not None else f"roads[{number}].speed_limit_mph"
            sources = (f"roads.{told}.speed_limit_mph", f"roads.{told}.rural")
            yield grounds.fact(f"{at}.speed_limit_mph", road.speed_limit_mph, path, sources, "the usual limit")


def _leg(network: RoadNetwork, road: Road) -> int | None:
    """The place of a road among the legs of an answered layout."""
    legs = network.layout.legs if network.layout else ()
    return next((i for i, leg in enumerate(legs) if leg.bearing == road.id), None)


def actor_facts_written(
    scenario: Scenario, network: RoadNetwork, reading: Reading, answer: Generation | None, drawn: bool = False
) -> Iterator[Fact]:
    """Start road, lane (1 at the right curb), planned speed (mph) and exit of every actor; what a model answered."""
    grounds = Grounds({f.field: f for f in reading.facts}, answer, drawn)
    graph = parse_net(network.net_xml or "<net/>")
    tracks = {track.actor: track for track in scenario.planned}
    for number, actor in enumerate(scenario.behavior.actors if scenario.behavior else ()):
        yield from _actor(actor, tracks.get(actor.id), graph, grounds, f"actors[{number}]")


def _actor(actor: Actor, track: Trajectory | None, graph: LaneGraph, grounds: Grounds, path: str) -> Iterator[Fact]:
    at = f"vehicles.{actor.id}" if actor.id.startswith("V") else f"others.{actor.id}"
    yield grounds.fact(f"{at}.start_road", actor.road, f"{path}.road", (f"{at}.heading",), "the likeliest road")
    lane = actor.lane or (_lane_at(track, actor, graph) if track else None)
    lane_path = f"{path}.lane" if actor.lane else ""
    yield grounds.fact(f"{at}.start_lane", lane, lane_path, (f"{at}.lane", f"{at}.lane_word"), "planner: a free lane")
    if track is not None and len(track.speed_mps):
        yield _speed(actor, float(track.speed_mps[0]) / MPS_PER_MPH, grounds, at, path)
    sources = (f"{at}.exit_heading", f"{at}.maneuver")
    exit_path = f"{path}.exit_road" if actor.exit_road else ""
    otherwise = "planner: straight on" if actor.exit_road else "it stays on its road"
    yield grounds.fact(f"{at}.exit_road", actor.exit_road, exit_path, sources if actor.exit_road else (), otherwise)
    if grounds.answer is not None:
        for name in ("kind", "maneuver"):
            yield grounds.fact(f"{at}.{name}", getattr(actor, name), f"{path}.{name}", (f"{at}.{name}",), "")
        for name in ACT_FIELDS:
            if (value := act_of(actor.acts, name)) is not None:
                yield grounds.fact(f"{at}.{name}", value, f"{path}.acts.{name}", (f"{at}.{name}",), "")


def _speed(actor: Actor, planned_mph: float, grounds: Grounds, at: str, path: str) -> Fact:
    """The planned start speed; only one that is told, or that a model gave, is not the planner's own."""
    speed_path = f"{path}.speed_mph" if actor.speed_mph is not None else ""
    sources = (f"{at}.speed_mph",) if actor.speed_mph else (f"{at}.maneuver",) if planned_mph < 0.1 else ()
    return grounds.fact(f"{at}.start_speed_mph", round(planned_mph, 1), speed_path, sources, "planner: usual speed")


def _lane_at(track: Trajectory, actor: Actor, graph: LaneGraph) -> int | None:
    """The lane of its start road that an actor's first place is nearest to, from the right curb."""
    at = np.array([[track.x_m[0], track.y_m[0]]])
    lanes = [
        (float(distance_to(lane.shape, at)[0]), place)
        for edge in graph.edges.values() if road_of(edge.id)[0] == actor.road
        for place, lane in enumerate(edge.laid_lanes, 1)
        if road_of(edge.id)[1] == actor.direction
    ]  # fmt: skip
    return min(lanes)[1] if lanes else None
