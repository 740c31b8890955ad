"""Timing of the traffic signals of a map, so that they show at the crash what the report states.

Phases and their durations are those of the map's own program; the report only determines its offset. Where no phase
shows all stated states, none is written and a note says so. Knows maps and motions.
"""

from __future__ import annotations

import math
import re
from bisect import bisect_right
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import accumulate
from typing import NamedTuple

import numpy as np

from sgcad_core.case.records import RoadNetwork, Trajectory
from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.opendrive.signals import HEAD, Control, Controller, Signal, control_of
from sgcad_core.formats.opendrive.streets import streets
from sgcad_core.formats.openscenario.roads.lane_motion import driven_way
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads, roads_of
from sgcad_core.formats.openscenario.roads.way import LanePlace, Way
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.geometry.plane import arc_lengths

SHOWN_S = 0.5
"""Least time from the beginning of the phase to the first stated vehicle at its signal."""
TURNED_S = 2.0
"""Time for which a signal shows the state to which it is told to have turned, before the crash or the first passing."""
_TURN_RAD = 0.6
_DIRECTIONS = re.compile(r"\((.*)\)")


class SignalTimes(NamedTuple):
    """Controllers whose first phase begins at the start of the scenario, and notes on stated states that cannot be
    shown."""

    controllers: tuple[Controller, ...] = ()
    notes: tuple[str, ...] = ()


class _Approach(NamedTuple):
    """The approach of a vehicle to a signal head: its id, the head, the time of passing (s), the stated state, and
    whether the signal has turned to it just before."""

    actor: str
    head: str
    at_s: float
    state: str
    turned: bool = False


def signal_times(
    network: RoadNetwork,
    motions: Sequence[Trajectory],
    told: Mapping[str, str],
    crash_s: float | None,
    turned: Collection[str] = (),
) -> SignalTimes:
    """The programs that show the stated states at the crash (without one: when the first vehicle passes).

    `turned`: vehicles whose signals have turned to that state just before.
    `motions`: of entities' origins. Nothing on a map without signals. Raises InvalidOutput where it is no map.
    """
    graph = parse_net(network.net_xml or "<net/>")
    if not graph.programs or network.xodr is None:
        return SignalTimes()
    control, roads = control_of(graph, streets(graph)), roads_of(network.xodr)
    if not (wanted := {move.actor: told[move.actor] for move in motions if move.actor in told}):
        return SignalTimes((), ("what the traffic signals showed is not told: the scenario has no phases",))
    found = {
        move.actor: _approach(move, control, roads, (told[move.actor], move.actor in turned))
        for move in motions if move.actor in wanted
    }  # fmt: skip
    missed = [f"{name} had {told[name]}, but no signal stands on its way" for name, seen in found.items() if not seen]
    times = [_timed(part, crash_s) for part in _programs(control, [a for a in found.values() if a])]
    return SignalTimes(
        tuple(c for part in times for c in part.controllers),
        (*missed, *(note for part in times for note in part.notes)),
    )


# ------------------------------------------------------------------ approaches to signals
def _approach(move: Trajectory, control: Control, roads: XodrRoads, told: tuple[str, bool]) -> _Approach | None:
    """The first head on a vehicle's way."""
    place = roads.nearest(Pose(float(move.x_m[0]), float(move.y_m[0]), float(move.heading_rad[0])))
    if place is None:
        return None
    way = _way(move, roads, place)
    along, gone = arc_lengths(way.points), arc_lengths(move.points)
    for number, (road, lane, _) in enumerate(way.lanes):
        heads = [s for s in control.signals if s.type == HEAD and s.road == road and lane in s.lanes]
        if heads:
            end_m = float(along[np.flatnonzero(way.which == number)[-1]])
            row = min(int(np.searchsorted(gone, end_m)), len(gone) - 1)
            return _Approach(move.actor, _for_turn(heads, move).id, float(move.t_s[row]), *told)
    return None


def _way(move: Trajectory, roads: XodrRoads, place: LanePlace) -> Way:
    """The lanes of a motion; those straight on where its end (in a spin, off the roads) is off the lanes."""
    try:
        return driven_way(move, roads, place)
    except ValueError:
        return roads.drive(place, roads.sense(place, float(move.heading_rad[0])))


def _for_turn(heads: Sequence[Signal], move: Trajectory) -> Signal:
    """The head for the turn of a motion, of several heads of one lane."""
    turned = float(move.heading_rad[-1] - move.heading_rad[0])
    way = "through" if abs(math.remainder(turned, 2 * math.pi)) < _TURN_RAD else "left" if turned > 0 else "right"
    named = {head.id: _DIRECTIONS.search(head.name) for head in heads}
    return next((h for h in heads if (m := named[h.id]) and way in m[1].split(", ")), heads[0])


def _programs(control: Control, approaches: Sequence[_Approach]) -> Iterator[tuple[list[Controller], list[_Approach]]]:
    """The controllers of each program with a stated state, and the approaches to it."""
    for program in dict.fromkeys(c.program for c in control.controllers):
        controllers = [c for c in control.controllers if c.program == program]
        heads = {head for c in controllers for head in c.signals}
        if told := [a for a in approaches if a.head in heads]:
            yield controllers, told


# ------------------------------------------------------------------ offset of the program
def _timed(part: tuple[list[Controller], list[_Approach]], crash_s: float | None) -> SignalTimes:
    controllers, told = part
    first_s = min(a.at_s for a in told)
    at_s = first_s if crash_s is None else crash_s
    states = [_states(controllers, number) for number in range(len(controllers[0].phases))]
    fits = [number for number, shown in enumerate(states) if all(shown.get(a.head) == a.state for a in told)]
    if not fits:
        words = " and ".join(f"{a.actor} {a.state}" for a in told)
        return SignalTimes((), (f"no phase of the signals shows {words} at once: the scenario has no phases",))
    turns = [k for k in fits if all(states[k - 1].get(a.head) != a.state for a in told if a.turned)]
    number = max(turns or fits, key=lambda k: controllers[0].phases[k].duration_s)
    into = _into(controllers[0].phases[number].duration_s, at_s - min(first_s, at_s))
    if turns and any(a.turned for a in told):
        into = min(at_s - min(first_s, at_s) + TURNED_S, max(controllers[0].phases[number].duration_s - SHOWN_S, into))
    return SignalTimes(tuple(_turned(c, number, at_s - into) for c in controllers))


def _states(controllers: Sequence[Controller], number: int) -> dict[str, str]:
    return {head: state for c in controllers for head, state in c.phases[number].states.items()}


def _into(duration_s: float, since_s: float) -> float:
    """Time in the phase before the crash: half of it, or since before the first vehicle passed."""
    return min(max(duration_s / 2, since_s + SHOWN_S), max(duration_s - SHOWN_S, duration_s / 2))


def _turned(controller: Controller, number: int, begin_s: float) -> Controller:
    """The phases in turn from time 0, with phase `number` beginning at `begin_s`.

    The phase at the start is split: its rest comes first, its beginning last.
    """
    phases = controller.phases
    starts = [0.0, *accumulate(p.duration_s for p in phases)]
    at = (starts[number] - begin_s) % starts[-1]
    first = min(bisect_right(starts, at) - 1, len(phases) - 1)
    gone = round(at - starts[first], 3)
    turn = [*phases[first:], *phases[:first]]
    if gone <= 0:
        return controller._replace(phases=tuple(turn))
    rest, cut = (turn[0]._replace(duration_s=seconds) for seconds in (turn[0].duration_s - gone, gone))
    return controller._replace(phases=(rest, *turn[1:], cut))
