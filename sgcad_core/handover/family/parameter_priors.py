"""Distributions of what a report leaves open: narrow where it states a value, wide where it does not.

Each parameter has the fact that it rests on (or its lack) and the reason of its width. Values vary about those of the
script and never leave a stated fact: the distribution ends at the rounding of reports. Knows scripts and facts; draws
no samples.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

from sgcad_core.handover.family.discrete_parameters import lanes, light, reactions
from sgcad_core.handover.family.parameter import Facts, Parameter, field_at, told_of
from sgcad_core.handover.family.shifted_evasion import Delay
from sgcad_core.handover.script import Script

_WANDER_M = 0.375
"""Vehicles wander by this much within their lane (UN R157, Annex 4, Appendix 3): taken as two standard deviations."""
_GRIP: Mapping[str | None, tuple[float, float]] = {
    "dry": (0.8, 0.9), "wet": (0.5, 0.7), "snow": (0.15, 0.25), "ice": (0.07, 0.15), None: (0.5, 0.9),
}  # fmt: skip
"""Peak friction (J. Y. Wong, Theory of Ground Vehicles, table 1.3); of an untold surface dry to wet."""


def open_parameters(
    script: Script, facts: Sequence[Mapping[str, Any]], delays: Mapping[str, Delay] | None = None
) -> tuple[Parameter, ...]:
    """The parameters of a script whose first contact is declared, in a fixed order.

    `delays`: by actor, the possible delay of its braking before the contact (`delay_of`).
    """
    known = {f["field"]: f for f in facts}
    pair = (script.declared.striker, script.declared.struck) if script.declared else ()
    found: list[Parameter] = []
    for actor in pair:
        if _moves(script, actor):
            found += [_pace(known, actor), _aside(known, actor)]
        found += _size(script, known, actor)
    if len(pair) == 2 and all(_moves(script, a) for a in pair):
        found.append(_late(pair[1]))
    found += lanes(script, known, pair)
    found += reactions(script, known, pair, delays or {})
    return (*found, _friction(script, known), *light(known))


def _moves(script: Script, actor: str) -> bool:
    track = next(t for t in script.trajectories if t.actor == actor)
    return math.hypot(track.x_m[1] - track.x_m[0], track.y_m[1] - track.y_m[0]) > 1e-3 or track.speed_mps.max() > 0.5


def _pace(known: Facts, actor: str) -> Parameter:
    """Speed over the script's."""
    field = field_at(actor, "speed_mph")
    told = told_of(known, field)
    if told == "stated":
        speed = max(float(known[field]["value"] or 1), 5.0)
        half = min(5.0 / speed, 0.5)
        why = "a speed is stated; reports round to 5 or 10 mph, so half of 10 mph to either side"
        return Parameter(name=f"{actor}_pace", kind="normal", mean=1.0, spread=half / 2, low=1 - half, high=1 + half,
                         nominal=1.0, told=told, field=field, reason=why)  # fmt: skip
    why = "no speed is told: the script's is the usual one of the road and the maneuver; wide about it (ours)"
    return Parameter(name=f"{actor}_pace", kind="normal", mean=1.0, spread=0.2, low=0.6, high=1.4, nominal=1.0,
                     told=told, field="", reason=why)  # fmt: skip


def _aside(known: Facts, actor: str) -> Parameter:
    """To the left of the script's line, metres."""
    field = next((f for f in (field_at(actor, "lane"), field_at(actor, "lane_word")) if f in known), "")
    why = "vehicles wander in their lane by up to 0.375 m (UN R157); which lane is a parameter of its own"
    return Parameter(name=f"{actor}_aside_m", kind="normal", mean=0.0, spread=_WANDER_M / 2, low=-0.6, high=0.6,
                     nominal=0.0, told=told_of(known, field), field=field, reason=why)  # fmt: skip


def _size(script: Script, known: Facts, actor: str) -> list[Parameter]:
    """Length and width over the script's."""
    info, field = script.info(actor), field_at(actor, "kind")
    if info.record.thing:
        return []
    told = told_of(known, field)
    spread = 0.05 if told == "stated" else 0.1
    kind = (
        "the kind is stated: sizes within it" if told == "stated" else "the kind is not stated: sizes of cars and more"
    )
    return [
        Parameter(name=f"{actor}_{what}", kind="normal", mean=1.0, spread=spread * share, low=1 - 2 * spread * share,
                  high=1 + 2 * spread * share, nominal=1.0, told=told, field=field if told != "default" else "",
                  reason=kind)
        for what, share in (("length", 1.0), ("width", 0.5))
    ]  # fmt: skip


def _late(actor: str) -> Parameter:
    """Delay of the struck actor, seconds."""
    why = "reports tell no times; so much still meets, and what touches other sides is drawn again"
    return Parameter(name=f"{actor}_late_s", kind="uniform", mean=0.0, spread=0.0, low=-0.4, high=0.4, nominal=0.0,
                     told="default", field="", reason=why)  # fmt: skip


def _friction(script: Script, known: Facts) -> Parameter:
    low, high = _GRIP[script.surface]
    field = "conditions.surface" if script.surface else ""
    why = f"peak friction of a {script.surface} road" if script.surface else "no surface is told: dry to wet"
    return Parameter(name="friction", kind="uniform", mean=(low + high) / 2, spread=0.0, low=low, high=high,
                     nominal=(low + high) / 2, told=told_of(known, field), field=field, reason=why)  # fmt: skip
