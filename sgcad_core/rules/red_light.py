"""Red lights: the front passes the stop line while the signal of its way shows red (UVC 11-202; entering on yellow is
lawful). A right turn on red after a stop is lawful; signs that forbid it are not on the map.

Unknown where the plan of the signals is not told. People on foot: see `crosswalks`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from sgcad_core.rules.passages import Passage
from sgcad_core.rules.records import RuleFinding, RuleLimits, RuleScene


def red_light(scene: RuleScene, crossed: Sequence[Passage]) -> Iterator[RuleFinding]:
    """One finding for each passage under a signal."""
    for one in crossed:
        if one.link.light:
            yield _judged(scene, one)


def _judged(scene: RuleScene, one: Passage) -> RuleFinding:
    shown = scene.shown(one.link, one.line)
    span = one.line, one.line
    if shown is None or shown.state not in ("red", "yellow", "green"):
        note = "the map tells no plan of the signals" if shown is None else f"the signal shows {shown.state}"
        return one.mover.found("red_light", "unknown", span, one.where, None, None, "s", note)
    red_s = shown.since_s if shown.state == "red" else 0.0
    limit = scene.limits.red_grace_s
    if red_s > limit and one.link.direction == "right" and stopped(one, scene.limits) is not None:
        return one.mover.found("red_light", "kept", span, one.where, red_s, limit, "s of red", "right after a stop")
    return one.mover.found(
        "red_light", "broken" if red_s > limit else "kept", span, one.where, red_s, limit, "s of red"
    )


def stopped(one: Passage, limits: RuleLimits) -> int | None:
    """The first sample at which it stands at the line; None: never. It may stop until its front is beyond the line by a
    little."""
    at = at_line(one, limits)
    at &= one.mover.speed_mps < limits.stands_mps
    hits = np.flatnonzero(at)
    return int(hits[0]) if len(hits) else None


def at_line(one: Passage, limits: RuleLimits) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """(n,) whether its front is at the line, up to the passage and a little beyond."""
    at = (one.before_m <= limits.stop_before_m) & (one.before_m >= -limits.stop_beyond_m)
    at[one.clear + 1 :] = False
    return at
