"""Contradictions within a road spec, before it is compiled. Knows no file format."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator

from sgcad_core.case.records import Finding
from sgcad_core.findings import FindingFactory
from sgcad_core.records.specs import Road, RoadSpec

SOURCE = "road_spec"
_finding = FindingFactory(SOURCE)


def spec_findings(spec: RoadSpec) -> list[Finding]:
    """Faults that leave nothing to compile: double ids, unknown nodes, loops, roads without lanes."""
    return [*_doubles(spec), *(f for i, road in enumerate(spec.roads) for f in _road_faults(spec, i, road))]


def _doubles(spec: RoadSpec) -> Iterator[Finding]:
    for kind, ids in (("nodes", [n.id for n in spec.nodes]), ("roads", [r.id for r in spec.roads])):
        for name, count in Counter(ids).items():
            if count > 1:
                what = f"{count} {kind} have one id"
                yield Finding(source=SOURCE, what=what, where=kind, value=name, remedy="give each an id of its own")


def _road_faults(spec: RoadSpec, index: int, road: Road) -> Iterator[Finding]:
    known = sorted({node.id for node in spec.nodes})
    for end in ("from_node", "to_node"):
        if (node := getattr(road, end)) not in known:
            yield _finding("no such node", f"roads[{index}].{end}", node, f"use one of {', '.join(known)}, or add it")
    if road.from_node == road.to_node:
        remedy = "let it end at another node; cut a loop into two roads"
        yield _finding("the road ends where it begins", f"roads[{index}]", road.from_node, remedy)
    for node in road.crosswalks:
        if node not in (road.from_node, road.to_node):
            remedy = f"use {road.from_node} or {road.to_node}"
            yield _finding("the road does not end there", f"roads[{index}].crosswalks", node, remedy)
    for way in ("forward", "backward"):
        closed, lanes = getattr(road, f"closed_{way}"), getattr(road, f"lanes_{way}")
        if closed and (max(closed) > lanes or len(set(closed)) >= lanes):
            remedy = f"close lanes from 1 to {lanes}, and leave one open"
            yield _finding("no such lanes can be closed", f"roads[{index}].closed_{way}", str(closed), remedy)
    if not road.lanes_forward and not road.lanes_backward:
        yield _finding("the road has no lanes", f"roads[{index}]", "0 and 0", "give one direction a lane")


def turn_findings(spec: RoadSpec) -> list[Finding]:
    """Lists of turns that do not have one entry a lane (they are passed over when the road is drawn)."""
    found = []
    for i, road in enumerate(spec.roads):
        for way in ("forward", "backward"):
            turns, lanes = getattr(road, f"turns_{way}"), getattr(road, f"lanes_{way}")
            if turns and len(turns) != lanes:
                what = f"turns_{way} does not have one entry for each of lanes_{way}"
                remedy = "count the lanes again: turn lanes are lanes; make both agree or leave the turns empty"
                found.append(_finding(what, f"roads[{i}].turns_{way}", f"{len(turns)} turns, {lanes} lanes", remedy))
    return found
