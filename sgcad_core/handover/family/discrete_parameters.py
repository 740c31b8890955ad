"""Open parameters with a few values (lane, light), and the beginning of a stated evasion.

The lane varies where the road has several parallel to that of the script, and the report names none. Two actors in one
direction change it together. Light changes no motion; it is part of the environment of a scenario. Knows scripts and
facts; draws no samples.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

import numpy as np

from sgcad_core.geometry.plane import Floats
from sgcad_core.handover.family.parameter import Facts, Parameter, Told, field_at, told_of
from sgcad_core.handover.family.shifted_evasion import Delay
from sgcad_core.handover.parallel_lanes import lane_offsets
from sgcad_core.handover.script import Script
from sgcad_core.records.specs import Light

PAIR = "pair"
"""Name of the common lane parameter of a pair."""
_SAME_WAY_RAD, _ACROSS_RAD = math.radians(30), math.radians(45)
_SCRIPTS_SHARE = 0.5
"""Probability of the script's own lane; the others share the rest (our choice: the usual lane is as likely as all
others)."""
LIGHTS: tuple[Light, ...] = ("day", "dusk", "dawn", "dark", "dark_lit")
_LIGHT_SHARES = (0.68, 0.03, 0.02, 0.1, 0.17)
"""About as in national crash records, where two of three crashes are by day and two of three dark ones under lamps."""
_LANE_FIELDS = ("lane", "lane_word", "start_lane")


def lanes(script: Script, known: Facts, pair: Sequence[str]) -> list[Parameter]:
    """The lane parameters of the pair, as metres to the left of the script's lane."""
    found = [] if len(pair) != 2 else _of_pair(script, pair)
    return [_lane(who, offsets) for who, of, offsets in found if offsets and not _stated(known, of)]


def _stated(known: Facts, actors: Sequence[str]) -> bool:
    return any(told_of(known, field_at(a, name)) != "default" for a in actors for name in _LANE_FIELDS)


def _of_pair(script: Script, pair: Sequence[str]) -> list[tuple[str, Sequence[str], list[float]]]:
    """(whose, of which actors, metres to the left) of every lane that may be another."""
    poses = [_until_contact(script, a) for a in pair]
    aside = [lane_offsets(script.graph, p) for p in poses]
    turned = abs(math.remainder(float(poses[0][-1, 2] - poses[1][-1, 2]), 2 * math.pi))
    if turned < _SAME_WAY_RAD:
        both = sorted(set(aside[0]) & set(aside[1]))
        return [(PAIR, pair, [(aside[0][d] + aside[1][d]) / 2 for d in both])]
    if abs(turned - math.pi / 2) > _ACROSS_RAD:  # head-on: another lane of one would be another encroachment
        return []
    return [(a, (a,), list(found.values())) for a, found in zip(pair, aside, strict=True)]


def _until_contact(script: Script, actor: str) -> Floats:
    track = next(t for t in script.trajectories if t.actor == actor)
    contact = script.contact_of(actor)
    last = len(track.t_s) if contact is None else max(int(np.searchsorted(track.t_s, contact.t_s - 1e-6)), 2)
    return track.pose[:last]


def _lane(who: str, offsets: Sequence[float]) -> Parameter:
    values = tuple(sorted([0.0, *(round(v, 3) for v in offsets)]))
    rest = (1 - _SCRIPTS_SHARE) / len(offsets)
    shares = tuple(_SCRIPTS_SHARE if v == 0.0 else rest for v in values)
    why = "no lane is told, and the road has others beside the script's all the way; " + (
        "both come in it, the crash is the same one lane over"
        if who == PAIR
        else "the other comes as much later or sooner"
    )
    words = tuple(_lane_word(v, values) for v in values)
    return _choice(f"{who}_lane_m", values, shares, words, 0.0, "default", "", why)


def _lane_word(value: float, values: Sequence[float]) -> str:
    beyond = abs(values.index(value) - values.index(0.0))
    return "the script's lane" if not beyond else f"{beyond} to the {'left' if value > 0 else 'right'}"


def _choice(
    name: str, values: tuple[float, ...], shares: tuple[float, ...], words: tuple[str, ...], nominal: float,
    told: Told, field: str, reason: str,
) -> Parameter:  # fmt: skip
    mean = sum(v * s for v, s in zip(values, shares, strict=True))
    return Parameter(name=name, kind="choice", mean=mean, spread=0.0, low=values[0], high=values[-1], nominal=nominal,
                     told=told, field=field, reason=reason, values=values, shares=shares, words=words)  # fmt: skip


# ------------------------------------------------------------------ reaction
def reactions(script: Script, known: Facts, pair: Sequence[str], delays: Mapping[str, Delay]) -> list[Parameter]:
    """Delay of the responder's stated braking, seconds."""
    found = []
    for actor in pair:
        field = field_at(actor, "evasion.brakes")
        if actor in delays and script.roles.get(actor) == "responder" and told_of(known, field) == "stated":
            found.append(_reaction(actor, delays[actor], field))
    return found


def _reaction(actor: str, delay: Delay, field: str) -> Parameter:
    why = (
        "braking is told, not when it began: 0.4 s sooner to 0.8 s later than a usual reaction (Green 2000), "
        "as far as it still brakes and still comes to the contact"
    )
    low, high = round(delay.low_s, 3), round(delay.high_s, 3)
    return Parameter(name=f"{actor}_reaction_s", kind="uniform", mean=(low + high) / 2, spread=0.0, low=low, high=high,
                     nominal=0.0, told="stated", field=field, reason=why)  # fmt: skip


# ------------------------------------------------------------------ light
def light(known: Facts) -> list[Parameter]:
    """The light, by its index in `LIGHTS`; empty where it is stated or inferred."""
    field = "conditions.light"
    if told_of(known, field) != "default":
        return []
    why = "no light is told; shares about those of crash records; it changes no motion and stands in the environment"
    values = tuple(float(k) for k in range(len(LIGHTS)))
    return [_choice("light", values, _LIGHT_SHARES, LIGHTS, 0.0, "default", "", why)]


def light_of(values: Mapping[str, float]) -> Light | None:
    """The light of a member's values; None where light is no parameter."""
    return LIGHTS[round(values["light"])] if "light" in values else None


# ------------------------------------------------------------------ what stays as it is
def unvaried(script: Script, facts: Sequence[Mapping[str, object]], parameters: Sequence[Parameter]) -> dict[str, str]:
    """Lane, reaction and light where they are no parameters of a family, with the reason."""
    known: Facts = {str(f["field"]): f for f in facts}
    names = {p.name for p in parameters}
    pair = (script.declared.striker, script.declared.struck) if script.declared else ()
    found: dict[str, str] = {}
    if not any(name.endswith("_lane_m") for name in names):
        told = _stated(known, pair)
        found["lane"] = "told" if told else "the road has no other lane that runs beside the script's all the way"
    if not any(name.endswith("_reaction_s") for name in names):
        found["reaction"] = "no braking of the responder is told; a driver's reaction is his own (`sgcad drive`)"
    if "light" not in names:
        found["light"] = "told, or it follows from what is told"
    return found
