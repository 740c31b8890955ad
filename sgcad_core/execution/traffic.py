"""Traffic around an executed crash: vehicles are placed, driven by a simulator, and those that come too near left out.

What drives is given as a function, so this module knows no simulator. A vehicle that comes too near to an actor begins
half a spacing further back; if that does not help either, it is left out. The rest is driven again, since vehicles
follow each other, until all keep clear. What a vehicle does beyond the roads' ends: `traffic_ends`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np

from sgcad_core.case.density import Density
from sgcad_core.case.driver_io import STEP_S
from sgcad_core.case.records import ActorInfo, Floats, Trajectory, sizes_of
from sgcad_core.case.traffic import CrashScene, Driven, Entrant, Fixture, Traffic, TrafficOrder
from sgcad_core.errors import NoTraffic
from sgcad_core.execution.contact import first_contact
from sgcad_core.execution.traffic_demand import Seed, demand, nearest_to, open_lanes
from sgcad_core.execution.traffic_ends import Stretch, whole_motions
from sgcad_core.execution.traffic_signals import shown_to_traffic
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.geometry.plane import Size, gaps_where_near
from sgcad_core.kinds import Maneuver
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.rules.records import RuleScene

Drive = Callable[[TrafficOrder], tuple[Driven, ...]]
MOST = 60
"""Vehicles at most; of more those that begin nearest to the crash are taken."""
CLEAR_M = 0.5
"""Least clearance to actors of the crash: players differ by 0.1 m at most."""
ROUNDS = 12
NEAR, JAMMED, NO_ROOM = "too near to an actor of the crash", "touched another background vehicle", "found no room"
_MANEUVERS: Mapping[str, Maneuver] = {"left": "turn_left", "right": "turn_right"}


def traffic_around(scene: CrashScene, density: Density, seed: int, drive: Drive) -> Traffic:
    """The traffic of a density around a crash; equal inputs give equal traffic.

    Raises NoTraffic where no lane takes any, or no vehicle keeps clear; SimulationFailed as the simulator does.
    """
    graph = parse_net(scene.net_xml)
    if not open_lanes(graph):
        raise NoTraffic(
            f"{scene.case}: the network has no lane for traffic (lanes for cars of 15 m and more, no driveways and "
            "alleys); run it without: traffic none"
        )
    rows = len(scene.trajectories[0].t_s)
    chance = np.random.default_rng(seed)
    every = demand(graph, density, (rows - 1) * STEP_S, chance)
    seeds = nearest_to(every, _middle(scene), MOST)
    notes = [f"limited to the {MOST} vehicles that begin nearest to the crash"] if len(every) > MOST else []
    movers = RuleScene(graph, scene.trajectories, scene.actors).movers
    shown = shown_to_traffic(graph, scene.xosc, movers, rows)
    order = TrafficOrder(scene.net_xml, _fixtures(scene), (), shown.states, seed)
    found = _Search(graph, order, drive).clear(seeds)
    if not found.tracks:
        told = ", ".join(f"{count} {why}" for why, count in found.removed.items()) or "none was placed"
        raise NoTraffic(f"{scene.case}: no vehicle of {density} traffic keeps clear of the crash ({told}); run it "
                        "without: traffic none")  # fmt: skip
    return _named(graph, found, Traffic(
        density=density, seed=seed, wanted=len(every), moved=found.moved, removed=dict(found.removed),
        notes=(*notes, *shown.notes),
    ))  # fmt: skip


def _fixtures(scene: CrashScene) -> tuple[Fixture, ...]:
    infos = {actor.id: actor for actor in scene.actors}
    return tuple(
        Fixture(t.actor, infos[t.actor].length_m, infos[t.actor].width_m, np.column_stack((t.pose, t.speed_mps)))
        for t in scene.trajectories
    )


def _middle(scene: CrashScene) -> tuple[float, float]:
    """Where the crash is: the first contact, without one the middle of all paths."""
    sizes = sizes_of(scene.actors)
    contact = first_contact(scene.trajectories, sizes)
    if contact is None:
        points = np.vstack([t.points for t in scene.trajectories])
        x, y = (points.min(axis=0) + points.max(axis=0)) / 2
    else:
        track = next(t for t in scene.trajectories if t.actor == contact.actor)
        x, y = track.points[round(contact.t_s / STEP_S)]
    return float(x), float(y)


# ------------------------------------------------------------------ rounds
class _Search:
    """Rounds of driving and leaving out; the result is in the fields."""

    def __init__(self, graph: LaneGraph, order: TrafficOrder, drive: Drive) -> None:
        self._graph, self._order, self._drive = graph, order, drive
        self._rows = len(order.fixtures[0].poses)
        self.tracks: dict[str, Floats] = {}
        """By id (n, 4) poses of those that keep clear."""
        self.entrants: dict[str, Entrant] = {}
        self.removed: Counter[str] = Counter()
        self.moved = 0

    def clear(self, seeds: Sequence[Seed]) -> _Search:
        """Drive until all keep clear, at last without those that do not."""
        for turn in range(ROUNDS):
            order = self._order._replace(entrants=tuple(seed.entrant for seed in seeds))
            driven = self._driven(order)
            faults = dict(self._faults(order.entrants, driven))
            last = turn == ROUNDS - 1
            if not faults or last:
                for why in faults.values():
                    self.removed[why] += 1
                kept = [s.entrant for s in seeds if s.entrant.id not in faults]
                self.tracks = {entrant.id: driven[entrant.id] for entrant in kept}
                self.entrants = {entrant.id: entrant for entrant in kept}
                break
            seeds = list(self._next(seeds, faults))
        return self

    def _driven(self, order: TrafficOrder) -> dict[str, Floats]:
        """By id the whole motion of those that found room."""
        by_id = {entrant.id: entrant for entrant in order.entrants}
        found = {}
        for name, first, poses in self._drive(order):
            route = by_id[name].route
            entry = route[0], by_id[name].lane
            found[name] = Stretch(entry, _lane_left(self._graph, route[-1], poses[-1]), first, poses)
        return whole_motions(found, self._rows)

    def _next(self, seeds: Sequence[Seed], faults: Mapping[str, str]) -> Iterator[Seed]:
        """The seeds of the next round: those without fault, and each other one elsewhere, once."""
        for seed in seeds:
            name = seed.entrant.id
            if name not in faults:
                yield seed
            elif not name.endswith("'") and (other := seed.behind(f"{name}'")) is not None:
                self.moved += 1
                yield other
            else:
                self.removed[faults[name]] += 1
                self.moved -= name.endswith("'")

    def _faults(self, entrants: Sequence[Entrant], driven: Mapping[str, Floats]) -> Iterator[tuple[str, str]]:
        """Id and reason of those that cannot stay; of two that touch each other the later one."""
        kept = list[Entrant]()
        for entrant in entrants:
            if entrant.id not in driven:
                yield entrant.id, NO_ROOM
            elif any(_near(entrant, driven[entrant.id], f, CLEAR_M) for f in self._order.fixtures):
                yield entrant.id, NEAR
            elif any(_near(entrant, driven[entrant.id], _fixed(o, driven[o.id]), 0.0) for o in kept):
                yield entrant.id, JAMMED
            else:
                kept.append(entrant)


def _fixed(entrant: Entrant, poses: Floats) -> Fixture:
    return Fixture(entrant.id, entrant.length_m, entrant.width_m, poses)


def _near(entrant: Entrant, poses: Floats, other: Fixture, clear_m: float) -> bool:
    """Whether two bodies come nearer than a clearance; 0: whether they touch."""
    sizes: tuple[Size, Size] = (entrant.length_m, entrant.width_m), (other.length_m, other.width_m)
    gaps = gaps_where_near(poses[:, :3], sizes[0], other.poses[:, :3], sizes[1], clear_m)
    return bool((gaps <= clear_m).any())


def _lane_left(graph: LaneGraph, edge: str, pose: Floats) -> str:
    """The lane of an edge whose end is nearest to where a vehicle was last."""
    lanes = graph.edges[edge].lanes
    return min(lanes, key=lambda lane: float(np.hypot(*(lane.shape[-1] - pose[:2])))).id


# ------------------------------------------------------------------ records
def _named(graph: LaneGraph, found: _Search, traffic: Traffic) -> Traffic:
    """The vehicles under the names traffic1, traffic2, ..."""
    names = {old: f"traffic{number}" for number, old in enumerate(found.tracks, 1)}
    t_s = np.arange(len(next(iter(found.tracks.values())))) * STEP_S
    tracks = [
        Trajectory(actor=names[old], t_s=t_s, x_m=p[:, 0], y_m=p[:, 1], heading_rad=p[:, 2], speed_mps=p[:, 3])
        for old, p in found.tracks.items()
    ]
    entrants = [found.entrants[old]._replace(id=name) for old, name in names.items()]
    return traffic.model_copy(update={
        "vehicles": tuple(_info(graph, entrant) for entrant in entrants), "trajectories": tuple(tracks),
        "entrants": tuple(entrants),
    })  # fmt: skip


def _info(graph: LaneGraph, entrant: Entrant) -> ActorInfo:
    ways = [c.direction for a, b in zip(entrant.route, entrant.route[1:], strict=False) for c in graph.leaving(a)
            if c.to_edge == b]  # fmt: skip
    turn = next((_MANEUVERS[way] for way in ways if way in _MANEUVERS), "straight")
    size = entrant.length_m, entrant.width_m
    return ActorInfo(id=entrant.id, type=entrant.kind, length_m=size[0], width_m=size[1], maneuver=turn)
