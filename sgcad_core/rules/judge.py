"""All traffic rules over a scene, and what is counted of them.

`judge` gives every finding, `broken` those that count; `figures` are the numbers of metrics.json: by rule how many
actors broke it, and by actor which rules. Unknown is counted apart and never as kept.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from sgcad_core.rules.crosswalks import against_signal, at_crosswalks
from sgcad_core.rules.following import following_distance
from sgcad_core.rules.lane_change import lane_change
from sgcad_core.rules.lane_keeping import off_road, wrong_side
from sgcad_core.rules.passages import Passage, passages
from sgcad_core.rules.passing import passing
from sgcad_core.rules.records import RULES, RuleFinding, RuleScene
from sgcad_core.rules.red_light import red_light
from sgcad_core.rules.right_of_way import right_of_way
from sgcad_core.rules.speed_limit import speed_limit
from sgcad_core.rules.stop_sign import stop_sign


def judge(scene: RuleScene) -> tuple[RuleFinding, ...]:
    """Every finding of every rule, in the order of the rules, then of the actors."""
    crossed: list[Passage] = [p for m in scene.movers if m.lanes_bound for p in passages(scene.graph, m)]
    found = [
        *red_light(scene, crossed), *against_signal(scene), *stop_sign(scene, crossed), *right_of_way(scene, crossed),
        *at_crosswalks(scene), *wrong_side(scene), *passing(scene), *lane_change(scene),
        *speed_limit(scene), *following_distance(scene), *off_road(scene),
    ]  # fmt: skip
    order = {t.actor: k for k, t in enumerate(scene.trajectories)}
    return tuple(sorted(found, key=lambda f: (RULES.index(f.rule), order[f.actor], f.from_s)))


def broken(found: Iterable[RuleFinding], actor: str = "") -> tuple[RuleFinding, ...]:
    """Findings that a rule was broken, of one actor or of all."""
    return tuple(f for f in found if f.status == "broken" and actor in ("", f.actor))


def figures(found: Iterable[RuleFinding], actor: str = "") -> dict[str, Any]:
    """Counts for metrics: rule -> actors that broke it, and how many rules are broken and unknown in all."""
    told = [f for f in found if actor in ("", f.actor)]
    pairs = {status: {(f.actor, f.rule) for f in told if f.status == status} for status in ("broken", "unknown")}
    counts: dict[str, int] = {rule: sum(r == rule for _, r in pairs["broken"]) for rule in RULES}
    return {**counts, "broken": len(pairs["broken"]), "unknown": len(pairs["unknown"] - pairs["broken"])}
