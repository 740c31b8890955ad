"""Traffic-rule oracles against drives that were written and labelled by hand (rule_drives.yaml).

    python -m research.benchmarks.handover.rule_drives [--all]

Prints how many of the drives get exactly their label: every rule that is broken and by which actor, every rule of which
nothing is known, and nothing else. `--all` prints each drive. Labels say what a person would say of the sentence beside
them; they were written before the oracles ran on them. Distances of a drive are those of its front from the end of its
lane, negative before it, metres; between two places the acceleration is constant.
"""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from sgcad_core.case.records import ActorInfo, Trajectory
from sgcad_core.errors import BadInput
from sgcad_core.formats.opendrive.signals import shown_in_turn
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.geometry.plane import Floats, arc_lengths, distinct, headings, offset_polyline, prolonged, resample
from sgcad_core.kinds import actor_kind, kind_of_letter
from sgcad_core.metrics.drivability import STEP_S
from sgcad_core.records.specs import Leg, RoadLayout, ToldRoad
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.roads.layout import road_spec
from sgcad_core.rules.judge import judge
from sgcad_core.rules.lights import Lights, Turn
from sgcad_core.rules.records import RuleFinding, RuleScene

DRIVES = Path(__file__).with_suffix(".yaml")
_FAR_M = 400.0


class Labelled(NamedTuple):
    """A drive with its label: (actor, rule) -> broken or unknown; what it does not name is kept or does not apply."""

    name: str
    rule: str
    why: str
    scene: RuleScene
    label: Mapping[tuple[str, str], str]


class Verdict(NamedTuple):
    """What the oracles say of a drive, in the form of its label."""

    drive: Labelled
    said: Mapping[tuple[str, str], str]
    findings: tuple[RuleFinding, ...]

    @property
    def agrees(self) -> bool:
        """Whether both are the same."""
        return dict(self.said) == dict(self.drive.label)


def labelled(file: Path = DRIVES) -> Iterator[Labelled]:
    """All drives of a file. Raises BadInput for one that cannot be built."""
    told = yaml.safe_load(file.read_text(encoding="utf-8"))
    for row in told["drives"]:
        try:
            graph = graph_of(yaml.safe_dump(told["maps"][row["map"]]))
            yield Labelled(row["name"], row["rule"], row["why"], scene_of(graph, row), _label(row.get("label", {})))
        except (KeyError, ValueError, StopIteration) as fault:
            raise BadInput(f"{file.name}: drive {row.get('name')!r}: {fault!r}; see the other rows") from fault


def verdicts(drives: Iterator[Labelled]) -> Iterator[Verdict]:
    """The oracles' verdicts."""
    for drive in drives:
        found = judge(drive.scene)
        said = {(f.actor, f.rule): f.status for f in found if f.status == "unknown"}
        said |= {(f.actor, f.rule): f.status for f in found if f.status == "broken"}
        yield Verdict(drive, said, found)


def _label(told: Mapping[str, Mapping[str, str]]) -> dict[tuple[str, str], str]:
    return {(actor, rule): status for actor, rules in told.items() for rule, status in rules.items()}


# ------------------------------------------------------------------ maps, signals, motion
@cache
def graph_of(told: str) -> LaneGraph:
    """The map of some legs, given as YAML; `center_line` of a leg: the marking between its directions, as told."""
    rows = [{"lanes_in": 1, "lanes_out": 1, **leg} for leg in yaml.safe_load(told)]
    lines = {leg["bearing"]: ToldRoad(center_line=leg.pop("center_line", "")) for leg in rows}
    spec = road_spec(RoadLayout(legs=tuple(map(Leg.model_validate, rows))))
    made = compile_network(plain_xml(spec, lines), spec)
    if made.net_xml is None:
        raise ValueError(made.log)
    return parse_net(made.net_xml)


def scene_of(graph: LaneGraph, row: Mapping[str, Any]) -> RuleScene:
    """The drive of a row."""
    actors = {name: told for name, told in row.items() if name[0] in "VPB" and name[1:].isdigit()}
    infos = tuple(_info(name, told) for name, told in actors.items())
    tracks = [_walk(name, told) if "to" in told else _drive(graph, name, told) for name, told in actors.items()]
    count = min(len(t) for t in tracks)
    motions = tuple(_trajectory(i.id, t[:count]) for i, t in zip(infos, tracks, strict=True))
    return RuleScene(graph, motions, infos, _lights(graph, row["signal"]) if "signal" in row else None)


def _info(name: str, told: Mapping[str, Any]) -> ActorInfo:
    kind = told.get("kind", kind_of_letter(name[0]))
    length, width = actor_kind(kind).size
    return ActorInfo(id=name, type=kind, length_m=length, width_m=width, maneuver=told.get("maneuver", "straight"))


def _lights(graph: LaneGraph, told: Mapping[str, str]) -> Lights:
    """Signals by the legs of an axis: {"NS": "green 5 yellow 3 red 30"}."""
    turns = {}
    for legs, text in told.items():
        words = text.split()
        phases = tuple((float(s), state) for state, s in zip(words[::2], words[1::2], strict=True))
        for link in graph.connections:
            if link.from_edge in legs:
                turns[link.light, shown_in_turn(graph, link)] = Turn(phases)
    return Lights(turns, graph)


def _drive(graph: LaneGraph, name: str, told: Mapping[str, Any]) -> Floats:
    """(n, 4) rows of a vehicle that goes from one edge to another."""
    start, end = told["way"].split()
    lane = told.get("lane", next(a.index for a in graph.edges[start].lanes if a.allows_cars))
    line, zero = _way(graph, start, lane, end)
    gone = arc_lengths(line)
    if "aside" in told:  # [front, metres to the left]
        at, left = np.array(told["aside"], dtype=float).T
        dense = resample(line, np.arange(0.0, float(gone[-1]), 1.0))
        line = offset_polyline(dense, np.interp(arc_lengths(dense) - zero, at, left))
        gone = arc_lengths(line)
    front = _paced(told["at"], told.get("stands", {}))
    half = _info(name, told).length_m / 2
    spot = zero + front[:, 0] - half
    x, y = resample(line, spot).T
    # the heading of the box is that of the line between its ends
    course = resample(line, spot + half) - resample(line, spot - half)
    return np.column_stack((x, y, np.unwrap(np.arctan2(course[:, 1], course[:, 0])), front[:, 1]))


def _way(graph: LaneGraph, start: str, lane: int, end: str) -> tuple[Floats, float]:
    """The line of lanes and the station of the end of the first one."""
    links = [c for c in graph.connections if (c.from_edge, c.to_edge) == (start, end)]
    link = next((c for c in links if c.from_lane == lane), links[0])
    first = next(a for a in graph.edges[start].lanes if a.index == lane)
    second = next(a for a in graph.edges[end].lanes if a.index == link.to_lane)
    line = prolonged(distinct(np.vstack((first.shape, link.via_shape, second.shape)), 0.05), _FAR_M)
    return line, _FAR_M + float(arc_lengths(first.shape)[-1])


def _paced(table: list[list[float]], stands: Mapping[float, float]) -> Floats:
    """(n, 2) place and speed every 0.05 s, from [place, speed] and how long it stands at a place."""
    times, places, speeds = [0.0], [float(table[0][0])], [float(table[0][1])]
    for (_, v), (b, w) in pairwise(table):
        if (wait := float(stands.get(places[-1], 0.0))) > 0:
            times, places, speeds = [*times, times[-1] + wait], [*places, places[-1]], [*speeds, 0.0]
        step = b - places[-1]
        times.append(times[-1] + 2 * step / max(v + w, 1e-6))
        places.append(float(b))
        speeds.append(float(w))
    t = np.arange(0.0, times[-1] + STEP_S / 2, STEP_S)
    k = np.clip(np.searchsorted(times, t, side="right") - 1, 0, len(times) - 2)
    since, span = t - np.array(times)[k], np.diff(times)[k]
    rate = np.diff(speeds)[k] / np.maximum(span, 1e-9)
    v = np.array(speeds)[k]
    return np.column_stack((np.array(places)[k] + v * since + rate * since**2 / 2, v + rate * since))


def _walk(name: str, told: Mapping[str, Any]) -> Floats:
    """(n, 4) rows of a person who walks straight from a place to another, and stands there."""
    a, b, pace = np.array(told["from"], float), np.array(told["to"], float), float(told.get("mps", 1.4))
    length = float(np.hypot(*(b - a)))
    t = np.arange(0.0, 30.0, STEP_S)
    s = np.clip((t - told.get("start_s", 0.0)) * pace, 0.0, length)
    moving = (s > 0) & (s < length)
    heading = headings(np.vstack((a, b)))[0]
    x, y = (a + s[:, None] / length * (b - a)).T
    return np.column_stack((x, y, np.full(len(t), heading), np.where(moving, pace, 0.0)))


def _trajectory(name: str, rows: Floats) -> Trajectory:
    t = np.round(np.arange(len(rows)) * STEP_S, 3)
    x, y, heading, speed = rows.T.copy()
    return Trajectory(actor=name, t_s=t, x_m=x, y_m=y, heading_rad=heading, speed_mps=speed)


# ------------------------------------------------------------------ told
def main(arguments: Sequence[str] | None = None) -> int:
    """Print the agreement; 1 where it is below 0.95."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--all", action="store_true", help="each drive, also where label and oracle agree")
    asked = parser.parse_args(arguments)
    found = list(verdicts(labelled()))
    for one in found:
        if not one.agrees or asked.all:
            print(f"{'agrees' if one.agrees else 'DIFFERS'}  {one.drive.name}: {one.drive.why}")  # noqa: T201
            if not one.agrees:
                print(f"    label {dict(one.drive.label)}\n    said  {dict(one.said)}")  # noqa: T201
                print("".join(f"    {f.words()}\n" for f in one.findings), end="")  # noqa: T201
    for rule in dict.fromkeys(one.drive.rule for one in found):
        part = [one.agrees for one in found if one.drive.rule == rule]
        print(f"{rule:20} {sum(part):3} of {len(part)}")  # noqa: T201
    share = sum(one.agrees for one in found) / len(found)
    print(f"{'agreement':20} {sum(one.agrees for one in found):3} of {len(found)} ({share:.3f})")  # noqa: T201
    return int(share < 0.95)


if __name__ == "__main__":
    raise SystemExit(main())
