"""A logical scenario: a written timed .xosc with parameters in place of numbers, and files that distribute them.

The scenario's trajectories run at `<actor>_pace`, `<actor>_late_s` later, `<actor>_aside_m` beside their line; boxes
are `<actor>_length` and `<actor>_width` times as large; the road has `friction`. Lanes are a second offset beside the
line, a delayed reaction moves the times of vertices, the light chooses among suns (a time of day would contradict it
and is left out). Behind the contact the file moves on as the one that it was made of; give it motion that no contact
disturbs, since contacts come at other times.
OpenSCENARIO 1.2: parameters with constraint groups, expressions `${...}`; ParameterValueDistribution, deterministic
(listed sets) and stochastic. Knows lxml and numbers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from lxml import etree

from sgcad_core.errors import InvalidOutput
from sgcad_core.geometry.plane import Floats

_HEADER = {"revMajor": "1", "revMinor": "2", "date": "2000-01-01T00:00:00+00:00", "author": "SG-CADVLM"}
_XSI = "http://www.w3.org/2001/XMLSchema-instance"


class ParameterRange(NamedTuple):
    """A parameter of the file: its distribution and limits. `spread` 0: uniform over the limits, or over `values`."""

    name: str
    nominal: float
    low: float
    high: float
    mean: float
    spread: float
    values: tuple[float, ...] = ()
    shares: tuple[float, ...] = ()
    """Of a choice: its values and their probabilities."""


class TimeShift(NamedTuple):
    """Times of vertices that move with a parameter d: t + d * (linear + d * (square + d * cube)), over (n,) times."""

    name: str
    t_s: Floats
    linear: Floats
    square: Floats
    cube: Floats


class ParameterizedActor(NamedTuple):
    """An actor whose motion has parameters, and when its line's own clock comes to the contact."""

    actor: str
    own_s: float
    lanes: tuple[str, ...] = ()
    """Parameters that are metres to the left, beside `<actor>_aside_m`."""
    further: tuple[tuple[str, float], ...] = ()
    """(parameter, seconds): so much later on its line's clock the contact comes for each unit of the parameter."""
    warp: TimeShift | None = None


def logical_xosc(
    xosc: str, ranges: Sequence[ParameterRange], meets: Sequence[ParameterizedActor], contact_s: float
) -> str:
    """A timed scenario with its parameters. `contact_s`: when the pair meets on the file's clock at nominal values.

    Raises InvalidOutput for a file without timed trajectories.
    """
    root = etree.fromstring(xosc.encode("utf-8"))
    known = {r.name for r in ranges}
    _declare(root, ranges)
    for one in meets:
        _move(root, one, contact_s, known)
        _resize(root, one.actor, known)
    for road in root.iter("RoadCondition"):
        if "friction" in known:
            road.set("frictionScaleFactor", "$friction")
    return _text(root)


def _declare(root: etree._Element, ranges: Sequence[ParameterRange]) -> None:
    holder = root.find("ParameterDeclarations")
    if holder is None:
        raise InvalidOutput("the scenario has no ParameterDeclarations: write it anew")
    for r in ranges:
        declared = etree.SubElement(
            holder, "ParameterDeclaration", name=r.name, parameterType="double", value=_number(r.nominal)
        )
        group = etree.SubElement(declared, "ConstraintGroup")
        etree.SubElement(group, "ValueConstraint", rule="greaterOrEqual", value=_number(r.low))
        etree.SubElement(group, "ValueConstraint", rule="lessOrEqual", value=_number(r.high))


def _move(root: etree._Element, one: ParameterizedActor, contact_s: float, known: set[str]) -> None:
    """Time and place of an actor's trajectory: t' = t / pace + offset with the contact kept where it is."""
    actor = one.actor
    group = next((g for g in root.iter("ManeuverGroup") if _acts(g, actor)), None)
    timing = None if group is None else next(group.iter("Timing"), None)
    if group is None or timing is None:
        raise InvalidOutput(f"{actor} has no timed trajectory in the scenario: write it in the encoding `timed`")
    pace = f"${actor}_pace" if f"{actor}_pace" in known else "1"
    late = f"${actor}_late_s" if f"{actor}_late_s" in known else "0"
    own = " + ".join([_number(one.own_s), *(f"{_number(k)} * ${name}" for name, k in one.further if name in known)])
    own = f"({own})" if "+" in own else own
    timing.set("scale", f"${{1 / {pace}}}")
    timing.set("offset", f"${{{_number(contact_s)} + {late} - {own} / {pace}}}")
    if one.warp is not None and one.warp.name in known:
        _delay(group, one.warp)
    aside = [f"${name}" for name in (f"{actor}_aside_m", *one.lanes) if name in known]
    for place in [*group.iter("WorldPosition"), *_initial(root, actor)] if aside else ():
        _beside(place, aside[0] if len(aside) == 1 else f"({' + '.join(aside)})")


def _delay(group: etree._Element, warp: TimeShift) -> None:
    """Vertices of a trajectory at times that move with a parameter."""
    for vertex in group.iter("Vertex"):
        t = float(vertex.get("time", "0"))
        d, rows = f"${warp.name}", (warp.linear, warp.square, warp.cube)
        linear, square, cube = (_number(float(np.interp(t, warp.t_s, row))) for row in rows)
        vertex.set("time", f"${{{_number(t)} + {d} * ({linear} + {d} * ({square} + {d} * {cube}))}}")


def with_sun_parameter(xosc: str, parameter: str, suns_of: Sequence[tuple[float, float, float]]) -> str:
    """A scenario whose sun (illuminance, azimuth, elevation) is one of several, by a parameter that counts them from 0.

    The time of day, which no expression can tell, is taken out. Raises InvalidOutput where there is no sun.
    """
    root = etree.fromstring(xosc.encode("utf-8"))
    sun = next(root.iter("Sun"), None)
    if sun is None:
        raise InvalidOutput("the scenario has no sun: write it with a light")
    for time in list(root.iter("TimeOfDay")):
        parent = time.getparent()
        if parent is not None:
            parent.remove(time)
    known = [name for name in ("illuminance", "intensity") if sun.get(name) is not None]
    for names, values in zip((known, ["azimuth"], ["elevation"]), zip(*suns_of, strict=True), strict=True):
        for name in names:
            sun.set(name, f"${{{_chosen(f'${parameter}', values)}}}")
    return _text(root)


def _chosen(parameter: str, values: Sequence[float]) -> str:
    """One of several values by number: a sum of spikes, since expressions know no choice."""
    spikes = (
        f"{_number(v)} * max(0, 1 - max({parameter} - {k}, {k} - {parameter}))" for k, v in enumerate(values) if v
    )
    return " + ".join(spikes) or "0"


def _acts(group: etree._Element, actor: str) -> bool:
    return any(ref.get("entityRef") == actor for ref in group.iter("EntityRef"))


def _initial(root: etree._Element, actor: str) -> list[etree._Element]:
    private = next((p for p in root.iter("Private") if p.get("entityRef") == actor), None)
    return [] if private is None else list(private.iter("WorldPosition"))


def _beside(place: etree._Element, parameter: str) -> None:
    heading = float(place.get("h", "0"))
    x, y = float(place.get("x", "0")), float(place.get("y", "0"))
    place.set("x", f"${{{_number(x)} + {_number(-math.sin(heading))} * {parameter}}}")
    place.set("y", f"${{{_number(y)} + {_number(math.cos(heading))} * {parameter}}}")


def _resize(root: etree._Element, actor: str, known: set[str]) -> None:
    thing = next((o for o in root.iter("ScenarioObject") if o.get("name") == actor), None)
    box = None if thing is None else next(thing.iter("Dimensions"), None)
    for what in ("length", "width") if box is not None else ():
        if box is not None and f"{actor}_{what}" in known:
            box.set(what, f"${{{box.get(what)} * ${actor}_{what}}}")


# ------------------------------------------------------------------ distributions
def deterministic_distribution(scenario: str, sets: Sequence[Mapping[str, float]]) -> str:
    """A file that lists parameter sets."""
    root, holder = _distribution(scenario)
    values = etree.SubElement(
        etree.SubElement(etree.SubElement(holder, "Deterministic"), "DeterministicMultiParameterDistribution"),
        "ValueSetDistribution",
    )
    for one in sets:
        entry = etree.SubElement(values, "ParameterValueSet")
        for name, value in one.items():
            etree.SubElement(entry, "ParameterAssignment", parameterRef=name, value=_number(value))
    return _text(root)


def stochastic_distribution(scenario: str, ranges: Sequence[ParameterRange], count: int, seed: int) -> str:
    """A file with the parameters' distributions (the player cuts normal ones to their limits)."""
    root, holder = _distribution(scenario)
    drawn = etree.SubElement(holder, "Stochastic", numberOfTestRuns=str(count), randomSeed=str(seed))
    for r in ranges:
        entry = etree.SubElement(drawn, "StochasticDistribution", parameterName=r.name)
        if r.values:
            chosen = etree.SubElement(entry, "ProbabilityDistributionSet")
            for value, share in zip(r.values, r.shares, strict=True):
                etree.SubElement(chosen, "Element", value=_number(value), weight=_number(share))
            continue
        if r.spread > 0:
            tag, values = "NormalDistribution", {"expectedValue": _number(r.mean), "variance": _number(r.spread**2)}
        else:
            tag, values = "UniformDistribution", {}
        limits = etree.SubElement(etree.SubElement(entry, tag, values), "Range")
        limits.set("lowerLimit", _number(r.low))
        limits.set("upperLimit", _number(r.high))
    return _text(root)


def _distribution(scenario: str) -> tuple[etree._Element, etree._Element]:
    root = etree.Element("OpenSCENARIO", nsmap={"xsi": _XSI})
    root.set(f"{{{_XSI}}}noNamespaceSchemaLocation", "OpenScenario.xsd")
    etree.SubElement(root, "FileHeader", {**_HEADER, "description": "family"})
    holder = etree.SubElement(root, "ParameterValueDistribution")
    etree.SubElement(holder, "ScenarioFile", filepath=scenario)
    return root, holder


def _number(value: float) -> str:
    return f"{value:.9g}" if abs(value) >= 1e-9 else "0"


def _text(root: etree._Element) -> str:
    etree.indent(root)
    return '<?xml version="1.0" encoding="UTF-8"?>\n' + etree.tostring(root, encoding="unicode") + "\n"
