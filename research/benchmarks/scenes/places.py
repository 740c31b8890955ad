"""Do random places realise what they declare, on the ground and in the crash?

    python -m research.benchmarks.scenes.places [--count 200] [--first 0] [--list 20]

Every place of `random_places` is drawn and held to all that roads pass: netconvert, SUMO, topology, OpenDRIVE, both
files alike, the way back through sgcad's reader. It is drawn as declared where every leg has its lanes, edges and
crosswalk, a roundabout its circle, and the junctions are as many as told; the crash is realised where the first contact
is the declared one on the declared sides, by ordinary driving (oddity below 1). One row a kind; then the faults.
"""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterator, Sequence
from typing import NamedTuple

from plugins.validator.sumo_load import SumoLoad
from plugins.validator.topology import Topology
from research.benchmarks.scenes.random_places import KINDS, Place, random_place
from research.benchmarks.scenes.reimport import differences
from sgcad_core.case.records import CrashReport, Evidence, RoadNetwork
from sgcad_core.formats.agreement import network_disagreements
from sgcad_core.formats.opendrive.checks.check_file import xodr_findings
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import BESIDE, plain_xml
from sgcad_core.planner.plan import plan
from sgcad_core.records.specs import Leg
from sgcad_core.roads.lane_graph import ROAD_WORKS, LaneGraph, network_figures
from sgcad_core.roads.layout import OUTER, road_spec
from sgcad_core.roads.road_geometry import ORDER

ODD = 1.0
WIDTHS = "widths"
"""A lane beside a median that widens is drawn a little wider across than along: no fault of the way back."""


class Verdict(NamedTuple):
    """What is wrong with one place: as a road, in what it declares, in its crash."""

    kind: str
    seed: int
    road: tuple[str, ...]
    drawn: tuple[str, ...]
    crash: tuple[str, ...]


def judged(seed: int) -> Verdict:
    """Draw, check and plan one place."""
    place = random_place(seed)
    spec = road_spec(place.layout)
    net = compile_network(plain_xml(spec), spec)
    if not net.net_xml or not net.xodr:
        return Verdict(place.kind, seed, (net.log,), ("not drawn",), ("not drawn",))
    graph = parse_net(net.net_xml)
    return Verdict(place.kind, seed, tuple(_faults(net, graph)), tuple(_lacks(place, graph)), _missed(place, graph))


def _faults(net: RoadNetwork, graph: LaneGraph) -> Iterator[str]:
    evidence = Evidence(report=CrashReport(case="place", narrative=""))
    xodr = net.xodr or ""
    found = [f for check in (SumoLoad(), Topology()) for f in check.findings(net, evidence)]
    found += [*xodr_findings(xodr), *network_disagreements(graph, xodr)]
    yield from (f.line() for f in found if f.severity != "note")
    for lost in differences(net.net_xml or "", xodr, "sgcad"):
        if lost.aspect != WIDTHS:
            yield f"way back: {lost.aspect} {lost.where}: {lost.before} -> {lost.after}"


# ------------------------------------------------------------------ what is declared
def _lacks(place: Place, graph: LaneGraph) -> Iterator[str]:
    layout = place.layout
    for leg in layout.legs:
        yield from _leg_lacks(leg, graph)
    wanted = int(len(layout.legs) > 2) + len(layout.accesses)
    if (found := network_figures(graph).intersections) != wanted:
        yield f"{found} intersections, {wanted} declared"
    if bool(layout.circle_lanes) != bool(graph.circles):
        yield f"{layout.circle_lanes} lanes around declared, {len(graph.circles)} circles"
    if layout.opening != bool(graph.openings):
        yield f"{len(graph.openings)} openings in medians"
    around = {len(edge.car_lanes) for edge in graph.edges.values() if graph.is_around(edge)}
    if around not in (set(), {layout.circle_lanes}):
        yield f"{around} lanes around, {layout.circle_lanes} declared"


def _leg_lacks(leg: Leg, graph: LaneGraph) -> Iterator[str]:
    types = [BESIDE[what].type for what in ORDER if what in leg.beside][::-1]
    for edge, lanes in ((leg.bearing, leg.lanes_in), (f"-{leg.bearing}", leg.lanes_out)):
        found = graph.edges.get(edge)
        if (len(found.laid_lanes) if found else 0) != lanes:
            yield f"edge {edge} has other lanes than the {lanes} declared"
        elif found and [lane.type for lane in found.lanes if lane.type not in ("", ROAD_WORKS)] != types:
            yield f"edge {edge} has other edges than {types}"
        closed = [i + 1 for i, lane in enumerate(found.laid_lanes) if lane.type == ROAD_WORKS] if found else []
        if closed != list(leg.closed_out if edge.startswith("-") else ()):
            yield f"edge {edge} has closed lanes {closed}, {leg.closed_out} are declared"
    over = any(leg.bearing in crossing.edges or f"-{leg.bearing}" in crossing.edges for crossing in graph.crossings)
    if over != leg.crosswalk:
        yield f"crosswalk on {leg.bearing}: {over}, declared {leg.crosswalk}"
    if leg.bearing + OUTER in graph.edges and leg.bearing not in graph.edges:
        yield f"leg {leg.bearing} does not reach the hub"


def _missed(place: Place, graph: LaneGraph) -> tuple[str, ...]:
    made = plan(place.behavior, graph)
    if not made.realised:
        return (f"not realised: {made.contact}; {'; '.join(made.notes)}",)
    return (f"oddity {made.oddity}: {'; '.join(made.notes)}",) if made.oddity >= ODD else ()


# ------------------------------------------------------------------ the table
def main(arguments: Sequence[str] | None = None) -> int:
    """Print the table; 1 where less than 99 % of the places realise what they declare."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=200)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--list", type=int, default=20, help="faults to name")
    options = parser.parse_args(arguments)
    found = [judged(seed) for seed in range(options.first, options.first + options.count)]
    sys.stdout.write(table(found, options.list))
    return int(sum(map(_whole, found)) < 0.99 * len(found))


def _whole(verdict: Verdict) -> bool:
    return not (verdict.road or verdict.drawn or verdict.crash)


def table(found: Sequence[Verdict], most: int) -> str:
    """Places without fault, kind by kind, then the first faults."""
    rows = [f"{'kind':22}{'places':>8}{'as roads':>10}{'as drawn':>10}{'crash':>8}{'all':>8}"]
    for kind in (*KINDS, ""):
        here = [v for v in found if kind in ("", v.kind)]
        counts = (
            sum(not part for part in parts) for parts in zip(*((v.road, v.drawn, v.crash) for v in here), strict=True)
        )
        roads, drawn, crash = tuple(counts) or (0, 0, 0)
        whole = sum(map(_whole, here))
        rows.append(f"{kind or 'all':22}{len(here):>8}{roads:>10}{drawn:>10}{crash:>8}{whole:>8}")
    named = [f"{v.kind} {v.seed}: {fault}" for v in found for fault in (*v.road, *v.drawn, *v.crash)]
    return "\n".join([*rows, *named[:most], ""])


if __name__ == "__main__":
    sys.exit(main())
