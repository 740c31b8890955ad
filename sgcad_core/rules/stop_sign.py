"""Stop signs: the front stands at the line before it passes (UVC 11-403 (b)); flashing red counts as a stop sign (UVC
11-205). Measured: the least speed there.

Approaches with a sign are those of the map (link states s and w). Unknown of a vehicle whose motion begins too late.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from sgcad_core.rules.passages import Passage
from sgcad_core.rules.records import RuleFinding, RuleScene, Status
from sgcad_core.rules.red_light import at_line, stopped


def stop_sign(scene: RuleScene, crossed: Sequence[Passage]) -> Iterator[RuleFinding]:
    """One finding for each passage of a stop sign."""
    for one in crossed:
        if one.link.state in ("s", "w"):
            yield _judged(scene, one)


def _judged(scene: RuleScene, one: Passage) -> RuleFinding:
    at = np.flatnonzero(at_line(one, scene.limits))
    slowest = float(one.mover.speed_mps[at].min()) if len(at) else float(one.mover.speed_mps[one.line])
    span = (int(at[0]), one.line) if len(at) else (one.line, one.line)
    stands = stopped(one, scene.limits) is not None
    late = not stands and one.before_m[0] < scene.limits.stop_before_m
    status: Status = "unknown" if late else "kept" if stands else "broken"
    note = "its motion begins at the line" if late else ""
    limit = scene.limits.stands_mps
    return one.mover.found("stop_sign", status, span, one.where, slowest, limit, "m/s at the line", note)
