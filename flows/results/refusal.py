"""Refusal precision and recall over robustness levels."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator

from flows.results.levels import SHOULD_REFUSE, base_of
from flows.results.measures import Measure
from flows.results.reading import Arm, Study

MEASURES = (
    Measure("refusal_precision", "refusal precision", "ratio", "%", "high", ("rightly", "refusals")),
    Measure("refusal_recall", "refusal recall", "ratio", "%", "high", ("rightly", "due")),
    Measure("wrongly_refused", "refused though evidence carries", "ratio", "%", "low", ("wrongly", "carried")),
)
NOTE = (
    "Precision: of the refused runs, those at levels that should end in a refusal "
    f"({', '.join(sorted(SHOULD_REFUSE)).replace('_', ' ')}). Recall: of the runs at those levels, the refused ones. "
    "Exhausted and failed runs are no refusals. Intervals draw whole cases, with all their levels."
)


def systems(study: Study) -> Iterator[tuple[str, list[Arm]]]:
    """Arms that differ only in their level, by system; systems with one level are left out."""
    found = defaultdict(list)
    for arm in study.arms:
        if arm.level:
            found[base_of(arm.config, arm.factors, arm.overrides)].append(arm)
    for base, arms in found.items():
        if len({arm.level for arm in arms}) > 1:
            yield " ".join(base) or arms[0].label, arms


def counts(refused_at: Iterable[tuple[str, float]]) -> dict[str, float]:
    """One case's sums over its levels, from (level, 1 if refused)."""
    found = dict.fromkeys(("rightly", "wrongly", "refusals", "due", "carried"), 0.0)
    for level, refused in refused_at:
        due = level in SHOULD_REFUSE
        found["due" if due else "carried"] += 1
        found["refusals"] += refused
        found["rightly" if due else "wrongly"] += refused
    return found
