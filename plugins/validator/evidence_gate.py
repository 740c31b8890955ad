"""Refuses an answer that the evidence does not support, and names what the report would have to tell.

For a group of fields the grounding is summed: S = sum log p(y|c,x) - log p(y|x), in nats, the logarithm of the
factor by which the report makes that part of the answer more likely than the model believed anyway. Below the
group's threshold the model has guessed. Only generations with both rows have a grounding (decoder cad, adacad
or vcd, or backbone.always_ground); others, and writers that ask no model, are skipped.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal

from pydantic import Field

from sgcad_core.case.records import Evidence, Finding, RoadNetwork, Scenario
from sgcad_core.interfaces import Validator


@dataclass(frozen=True)
class Group:
    """Fields that are judged together, and what a report must tell to support them."""

    name: str
    paths: re.Pattern[str]
    remedy: str

    @property
    def field(self) -> str:
        """The group's key in the YAML."""
        return self.name.replace(" ", "_")


ROAD = (
    Group(
        "road layout",
        re.compile(r"legs\[\]|legs\[\d+\]\.bearing|roads\[\]|nodes\[\]|roads\[\d+\]\.(from_node|to_node)"),
        "the report must say how many roads meet and where they lead",
    ),
    Group(
        "lanes",
        re.compile(r"(legs|roads)\[\d+\]\.lanes_(in|out|forward|backward)"),
        "the report or its diagram must show the lanes of each road",
    ),
)
SCENARIO = (
    Group(
        "actors",
        re.compile(r"actors\[\]|actors\[\d+\]\.(kind|road|direction|maneuver)"),
        "the report must say who was involved, on which road, in which direction and doing what",
    ),
    Group(
        "first contact",
        re.compile(r"contacts\[0\]\.(striker|struck|striker_area|struck_area)"),
        "the report must say who struck whom, and with which sides",
    ),
)


GROUPS: dict[str, tuple[Group, ...]] = {"road": ROAD, "scenario": SCENARIO}
"""The groups judged in each stage; a group's threshold is the field of its name."""


class EvidenceGate(Validator):
    """Refuses an answer whose fields the report makes hardly more likely: a threshold in nats for each group of fields.

    null leaves a group out; `at` names the stage or both. The defaults only find answers that the report makes no more
    likely at all; `python -m research.benchmarks.decoding.gate` finds a model's own thresholds.
    """

    at: Literal["road", "scenario", "both"] = "both"
    road_layout: float | None = Field(0.5, description="road stage, nats; null = not required")
    lanes: float | None = Field(0.5, description="road stage, nats; null = not required")
    actors: float | None = Field(0.5, description="scenario stage, nats; null = not required")
    first_contact: float | None = Field(0.5, description="scenario stage, nats; null = not required")

    @property
    def stage(self) -> str:  # type: ignore[override]
        """The stage named by `at`: this validator may judge either stage or both."""
        return self.at

    def findings(self, artifact: RoadNetwork | Scenario, evidence: Evidence) -> list[Finding]:
        """A refusal for each group below its threshold, weakest first; [] if the answer has no grounding."""
        ground = evidence.generation.grounding if evidence.generation else {}
        judged = GROUPS["road" if isinstance(artifact, RoadNetwork) else "scenario"]
        wanted = ((group, self.threshold(group)) for group in judged)
        sums = [(group, limit, nats_of(group, ground)) for group, limit in wanted if limit is not None]
        weak = [(nats, group, limit) for group, limit, nats in sums if nats is not None and nats < limit]
        return [_not_carried(group, nats, limit) for nats, group, limit in sorted(weak, key=lambda w: w[0] - w[2])]

    def threshold(self, group: Group) -> float | None:
        """The group's threshold, nats; None: it is not required."""
        found: float | None = getattr(self, group.field)
        return found


def nats_of(group: Group, grounding: Mapping[str, float]) -> float | None:
    """A group's summed grounding; None if the answer has none of its fields."""
    found = [nats for path, nats in grounding.items() if group.paths.fullmatch(path)]
    return sum(found) if found else None


def _not_carried(group: Group, nats: float, limit: float) -> Finding:
    return Finding(
        source="evidence_gate",
        severity="refuse",
        what=f"the evidence does not carry the {group.name}: it adds {nats:.2f} nats, at least {limit:g} are wanted",
        value=group.name,
        remedy=group.remedy,
    )
