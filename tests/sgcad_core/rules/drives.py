"""Small drives for the rules, built as those of the labelled benchmark."""

from __future__ import annotations

from typing import Any

import yaml

from research.benchmarks.handover.rule_drives import DRIVES, graph_of, scene_of
from sgcad_core.roads.lane_graph import LaneGraph
from sgcad_core.rules.judge import judge
from sgcad_core.rules.records import Rule, RuleFinding, RuleScene

MAPS: dict[str, Any] = yaml.safe_load(DRIVES.read_text(encoding="utf-8"))["maps"]
LINE_M = 0.3
"""The stop line's far edge before the end of the lane."""


def lanes(name: str) -> LaneGraph:
    return graph_of(yaml.safe_dump(MAPS[name]))


def scene(name: str, **row: Any) -> RuleScene:
    return scene_of(lanes(name), row)


def found(made: RuleScene, rule: Rule, actor: str = "V1") -> list[RuleFinding]:
    return [f for f in judge(made) if f.rule == rule and f.actor == actor]


def status(made: RuleScene, rule: Rule, actor: str = "V1") -> str:
    """The gravest status of a rule; "" where it does not apply."""
    said = {f.status for f in found(made, rule, actor)}
    return next((s for s in ("broken", "unknown", "kept") if s in said), "")
