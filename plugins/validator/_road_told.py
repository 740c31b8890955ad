"""The facts of a narrative on which a finding about its roads may rest. Knows facts by name; no network."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from plugins.validator._told import as_question
from sgcad_core.case.records import Finding
from sgcad_core.reading.layout.legs_used import turns_off
from sgcad_core.reading.provenance.road_provenance import road_names
from sgcad_core.reading.reading import Reading
from sgcad_core.reading.roads.road_facts import RoadFact, RoadFacts
from sgcad_core.reading.text.compass import COMPASS, NAMES, turned
from sgcad_core.records.specs import Compass, RoadSpec

Asked = tuple[Finding, tuple[str, ...]]
"""A finding, and the facts that it may rest on, the likeliest first."""
KIND = ("junction.kind",)


def asked_of(found: Finding, fields: tuple[str, ...], reading: Reading) -> Finding:
    """The finding as a question about what a sentence states; a doubt stays one."""
    asked = as_question(found, reading, fields)
    return found if found.severity == "doubt" else asked


def used_by(legs: Sequence[Compass], facts: RoadFacts) -> tuple[str, ...]:
    """The motion of the vehicles that come from these legs or turn into them."""
    ways = [(v.id, v.heading) for v in facts.crash.vehicles if v.heading]
    come = [f"vehicles.{name}.heading" for name, heading in ways if turned(heading, 180) in legs]
    turning = [f"vehicles.{v.id}.{name}" for v in facts.crash.vehicles if turns_off(v)
               for name in ("exit_heading", "maneuver", "heading")]  # fmt: skip
    return (*come, *turning, "junction.stem", *KIND)


def lane_fields(road: RoadFact, facts: RoadFacts, first: str) -> tuple[str, ...]:
    """What may be told of a road's lanes, the named field first."""
    name = next((n for n, r in zip(road_names(facts), facts.roads, strict=True) if r is road), "main")
    ways = (f"lanes_{NAMES[way]}bound" for way in COMPASS)
    return tuple(f"roads.{name}.{at}" for at in (first, "lanes_total", "lanes_each_way", "one_way", *ways))


def asked_control(facts: RoadFacts, spec: RoadSpec | None) -> Iterator[Asked]:
    """A question if the told control of the junction stands at no node of the network."""
    told = facts.junction.control
    if spec is None or told == "none" or not facts.junction.stated:
        return
    drawn = {node.control for node in spec.nodes} - {"none"}
    if told not in drawn:
        found = Finding(
            source="road_narrative", what=f"the junction's control is {told} in the report", where="junction.control",
            value=", ".join(sorted(drawn)) or "none", remedy=f"set the control of its node to {told}",
        )  # fmt: skip
        yield found, ("junction.control",)
