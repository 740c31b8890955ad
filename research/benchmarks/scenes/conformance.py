"""Which elements of OpenSCENARIO are written, read and refused: the page docs/conformance.md, made from the code.

What is read comes from the families that compile elements, what there is from ASAM's schema 1.3.1 (it comes with
scenariogeneration), what is written from a file of ours with every kind of actor and every surrounding.
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import distribution
from typing import Any

import numpy as np
from lxml import etree

from sgcad_core.case.records import ActorInfo, ObservedContact, Trajectory
from sgcad_core.formats.openscenario.actions import GLOBAL, PRIVATE
from sgcad_core.formats.openscenario.actions.lateral import LATERAL
from sgcad_core.formats.openscenario.actions.routing import ROUTING
from sgcad_core.formats.openscenario.actions.speed import LONGITUDINAL
from sgcad_core.formats.openscenario.conditions import BY_ENTITY, BY_VALUE
from sgcad_core.formats.openscenario.playing.families import Family
from sgcad_core.formats.openscenario.playing.positions import POSITIONS
from sgcad_core.formats.openscenario.reading.variation import STOCHASTIC
from sgcad_core.formats.openscenario.roads.shapes import SHAPES
from sgcad_core.formats.openscenario.writing.events import EventOptions
from sgcad_core.formats.openscenario.writing.writer import write_xosc
from sgcad_core.kinds import ACTORS
from sgcad_core.records.specs import BehaviorSpec

FAMILIES: dict[str, tuple[Family[Any], str]] = {
    "Private actions": (PRIVATE, "PrivateAction"),
    "Longitudinal actions": (LONGITUDINAL, "LongitudinalAction"),
    "Lateral actions": (LATERAL, "LateralAction"),
    "Routing actions": (ROUTING, "RoutingAction"),
    "Global actions": (GLOBAL, "GlobalAction"),
    "Conditions by entity": (BY_ENTITY, "EntityCondition"),
    "Conditions by value": (BY_VALUE, "ByValueCondition"),
    "Positions": (POSITIONS, "Position"),
    "Shapes of trajectories": (SHAPES, "Shape"),
    "Stochastic distributions": (STOCHASTIC, "StochasticDistribution"),
}
"""Families by heading, and the schema's type that holds one of them."""
_KINDS = tuple({r.category: r.id for r in reversed(ACTORS.values())}.values())[::-1]
"""One of each category."""
_XSD = "{http://www.w3.org/2001/XMLSchema}"
_HEAD = """# What is written, read and refused of OpenSCENARIO

Made by `python docs/draw_conformance.py` from the code; a test holds both together. Elements are those of ASAM
OpenSCENARIO XML 1.3.1, and those of versions 1.0 to 1.2 that have been renamed since.

- **read**: our player (`sgcad play FILE.xosc`, and every check of ours) plays it.
- **noted**: accepted without effect on the motion; a note stands in played.json and in player.html.
- **refused**: the file is not played. The error names the element, its line, its file and what would help.
- **written**: our own scenario files hold it.

Also read: catalogs of vehicles, pedestrians, objects, maneuvers, routes, trajectories, environments; parameters with
assignments and `${...}` expressions; variables; entity selections; trailers; controllers' phases of traffic signals;
deterministic and stochastic parameter distributions (each set is played); maps in OpenDRIVE 1.4 to 1.8 with lines,
arcs, spirals, poly3, paramPoly3, several lane sections, lane offsets, borders, junctions, left- and right-hand traffic.
Motion is plane: elevation, pitch and roll are left out.

In third-party files, what other players accept gives a note: a place beyond a road's end (the end is taken), a signed
rate, a box without size, an entity without a place, an undeclared parameter in a condition, an empty action. In own
files the same are faults.
"""


_LANES = (
    """<lanes><laneSection s="0"><center><lane id="0" type="none"/></center><right>{}</right></laneSection></lanes>"""
)
_LANE = """<lane id="{0}" type="driving"><link><predecessor id="{0}"/><successor id="{0}"/></link>
<width sOffset="0" a="4" b="0" c="0" d="0"/></lane>"""


def _road(name: int, x_m: float, length_m: float, junction: int, link: str) -> str:
    """A straight road eastward with two lanes, whose lines lie at y = 0 and y = -4."""
    line = f'<geometry s="0" x="{x_m}" y="2" hdg="0" length="{length_m}"><line/></geometry>'
    lanes = _LANES.format(_LANE.format(-1) + _LANE.format(-2))
    attributes = f'id="{name}" length="{length_m}" junction="{junction}"'
    return f"<road {attributes}><link>{link}</link><planView>{line}</planView>{lanes}</road>"


_END, _START = (
    'elementType="road" elementId="1" contactPoint="end"',
    'elementType="road" elementId="3" contactPoint="start"',
)
_MAP = (
    '<OpenDRIVE><header revMajor="1" revMinor="6"/>'
    + _road(1, -20, 100, -1, '<successor elementType="junction" elementId="9"/>')
    + _road(2, 80, 10, 9, f"<predecessor {_END}/><successor {_START}/>")
    + _road(3, 90, 300, -1, '<predecessor elementType="junction" elementId="9"/>')
    + '<junction id="9"><connection id="0" incomingRoad="1" connectingRoad="2" contactPoint="start">'
    '<laneLink from="-1" to="-1"/><laneLink from="-2" to="-2"/></connection></junction></OpenDRIVE>'
)
"""A road with a junction under the actors that are written to see what is written."""


_APART = """
## Where our player and esmini differ

On public files that both play, most entities are within 0.3 m of each other to the end (`python -m
research.benchmarks.scenes.foreign FOLDER --judge ESMINI`, steps of 0.01 s, controllers off). These are the causes where
they are not, as far as they were found by reading the files one by one:

| element | difference |
|---|---|
"""
DIFFERENCES: dict[str, str] = {
    "`AddEntityAction` in Init": "esmini leaves one that is placed relative to another added before it at the world's "
    "origin; ours places them in the order of the file",
    "`SpeedAction`, linear": "ours moves by the mean of the speeds at both ends of a step, which is exact; esmini by "
    "the new speed: 0.05 m for a change by 10 m/s at steps of 0.01 s, more where a distance triggers what follows",
    "`SpeedProfileAction`, mode follow": "the standard names a limit of jerk and no profile; esmini rounds corners of "
    "the speed with it, ours drives the pieces as they stand (noted)",
    "`LateralDistanceAction`": "how the distance is reached is left open; esmini steers there along arcs or by a "
    "spring, ours at the rate that maxSpeed allows",
    "`TeleportAction` in the story": "esmini holds an entity still in the step of its teleport; ours goes on at once: "
    "one step of motion, 0.6 m at 56 m/s and steps of 0.01 s",
    "`SynchronizeAction`": "esmini takes its own and the master's speed along the road's reference line, also where "
    "an entity crosses the road; ours along the way that is gone. Where the speed of the moment leads there by no even "
    "change, esmini begins at another speed at once; ours changes it evenly in two phases",
    "`TimeHeadwayCondition`, alongRoute": "esmini measures as the crow flies, between boxes or origins; ours along the "
    "road, as version 1.0 says: what follows begins some steps earlier or later in a bend or beside another lane",
    "`Nurbs`, times of control points": "the standard calls them the time dimension of the point, so in ours the time "
    "is a coordinate of the curve like x and y; esmini draws the same curve and tells times evenly between the places "
    "where each control point counts most: some tenths of a second apart on the way, none at both ends",
    "`RoutePosition` with `Orientation`": "esmini heeds it only before `InRoutePosition`, though the schema leaves the "
    "order open, and cuts `t` of `FromRoadCoordinates` to whole metres; ours reads both as they stand",
    "Behind the end of a trajectory": "the standard's default is to keep lane and speed: ours faces along the lane and "
    "keeps the offset; esmini keeps the angle to the road too, and drives on askew. What starts there is turned so far",
    "A junction without a route": "left open: both take the connection that turns least; where two turn alike (the "
    "stem of a T), esmini draws one at random, ours takes the first",
    "An entity off all roads, without a map": "esmini stops it when its trajectory ends; ours goes straight on at its "
    "speed",
    "Superelevation": "motion is plane in ours: on a banked bend a lane lies up to some metres beside esmini's",
    "Lanes that slant or widen": "ours counts the distance along the lane's line, esmini along the reference line; "
    "where a lane narrows to nothing, ours stays on its line and esmini takes the lane beside it at once",
}
"""Where our player and esmini part on public files, by element, and what the standard says of it."""


def page() -> str:
    """The page as text."""
    written, parts = written_elements(), [_HEAD]
    for heading, (family, holder) in FAMILIES.items():
        parts.append(f"\n## {heading}\n\n| element | reading | written | remark |\n|---|---|---|---|\n")
        parts += [f"| `{tag}` | {told} | {'yes' if tag in written else ''} | {remark} |\n"
                  for tag, told, remark in _rows(family, holder)]  # fmt: skip
    parts.append(_APART)
    parts += [f"| {element} | {reason} |\n" for element, reason in DIFFERENCES.items()]
    return "".join(parts)


def _rows(family: Family[Any], holder: str) -> Iterator[tuple[str, str, str]]:
    for tag in sorted({*family.entries, *_in_schema(holder)}):
        entry = family.entries.get(tag)
        if entry is None:
            yield tag, "refused", "not known to the player"
        else:
            yield tag, "read" if entry.status == "played" else entry.status, entry.remark


def _in_schema(holder: str) -> set[str]:
    """Elements that a type of the schema may hold."""
    file = distribution("scenariogeneration").locate_file("schemas/OpenSCENARIO_1_3_1.xsd")
    root = etree.parse(str(file), etree.XMLParser(no_network=True)).getroot()
    kind = root.find(f"{_XSD}complexType[@name='{holder}']")
    return set() if kind is None else {str(e.get("name")) for e in kind.iter(f"{_XSD}element")}


def written_elements() -> set[str]:
    """Names of all elements in files of ours, in both encodings."""
    actors = [
        ActorInfo(id=f"V{i}", type=kind, length_m=4.0, width_m=1.8, maneuver="straight")
        for i, kind in enumerate(_KINDS, 1)
    ]
    motions = [_motion(a.id, i) for i, a in enumerate(actors)]
    spoken = {"id": "V1", "kind": "car", "road": "S", "direction": "forward", "maneuver": "straight"}
    behavior = BehaviorSpec.model_validate({"actors": [spoken], "light": "dark", "weather": "rain", "surface": "wet"})
    touch = ObservedContact(actor="V1", other="V2", actor_area="front", other_area="back", t_s=5.0)
    texts = [write_xosc(actors, motions, behavior, handover=way) for way in (None, EventOptions(touch, _MAP))]
    return {str(e.tag) for text in texts for e in etree.fromstring(text.encode()).iter() if isinstance(e.tag, str)}


def _motion(name: str, number: int) -> Trajectory:
    """The first drives on over the junction, the second brakes ahead of it; then one changes its lane, one drifts in
    it, one brakes alone, the others keep to themselves off the roads."""
    t_s = np.arange(121) * 0.05
    share = np.clip((t_s - 1.0) / 3.0, 0.0, 1.0)
    smooth = share * share * (3 - 2 * share)
    speed = (18.0 if number == 0 else 15.0) - (2.0 * share if number in (1, 4) else 0.0)
    x_m = (80.0 if number == 2 else 15.0 * number) + np.concatenate(
        ([0.0], np.cumsum((speed * np.ones(121))[1:] * 0.05))
    )
    aside = (0.0 * t_s, 0.0 * t_s, -4.0 * smooth, 0.5 * smooth - 4.0, 0.0 * t_s - 4.0)
    y_m = aside[number] if number < len(aside) else 0.0 * t_s + 9.0 * number
    heading = np.arctan2(np.gradient(y_m), np.gradient(x_m))
    return Trajectory(actor=name, t_s=t_s, x_m=x_m, y_m=y_m, heading_rad=heading, speed_mps=speed * np.ones(121))
