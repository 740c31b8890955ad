"""`ego.xosc`: a crash in which one vehicle has a start, a route and no motion, and the others meet it.

The others begin when the ego's time to the conflict is that of the report, or its body comes near, never by the clock
alone unless the ego stands at first. The scenario ends with a contact of the ego, with its standstill behind the
time of the conflict, or in time. Knows a staging; no file.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass

from sgcad_core.case.driver_io import STEP_S
from sgcad_core.case.traffic import Background
from sgcad_core.formats.openscenario.roads.road_network import roads_of
from sgcad_core.formats.openscenario.writing.entities import center_ahead_m, environment
from sgcad_core.formats.openscenario.writing.header import Source, comments, file_header
from sgcad_core.formats.openscenario.writing.versions import DEFAULT_VERSION, Version
from sgcad_core.formats.openscenario.writing.writer import library_version
from sgcad_core.handover.ego_file import ego as me
from sgcad_core.handover.ego_file.cue import Cue, cue_of
from sgcad_core.handover.ego_file.elements import node, of_entity, of_time, position, private, speed, trigger
from sgcad_core.handover.ego_file.others import INDENT, Other, background_of, others_of
from sgcad_core.handover.script import Staging
from sgcad_core.records.specs import BehaviorSpec

TIME, CLEARANCE = "TimeToConflict", "ClearanceToStart"
END, STANDS, LATE, FRICTION = "EndTime", "StandstillTime", "StandstillFrom", "Friction"
PATIENCE_S = 30.0
"""The file ends so long behind the scripted conflict."""
STANDS_S = 5.0


@dataclass(frozen=True)
class EgoFile:
    """What an ego's file is made of beside the staging."""

    source: Source
    behavior: BehaviorSpec | None = None
    """Light, weather and surface."""
    xodr: str | None = None
    version: Version = DEFAULT_VERSION
    road_file: str = "road.xodr"
    background: Background = ()
    """Traffic, which begins with the others; the cue does not depend on it."""


def write_ego(staging: Staging, about: EgoFile) -> str:
    """The .xosc of a staging, in which the staging's ego waits for its driver.

    Lengths in metres, times in seconds; places are those of entity origins. Raises InvalidOutput for a map that
    cannot be read.
    """
    minor = int(about.version[-1])
    roads = roads_of(about.xodr) if about.xodr else None
    cue = cue_of(staging, center_ahead_m(staging.script.info(staging.ego)))
    others, move = others_of(staging, cue.contact_s, cue.lead_rows), me.ego_motion(staging, cue.contact_s)
    others = (*others, *background_of(staging.script, about.background, cue))
    with library_version(minor):
        around = environment(about.behavior, minor)
        surroundings = None if around is None else around.get_element()
        entities = [
            me.scenario_object(staging.script.info(staging.ego), minor, True),
            *(me.scenario_object(other.info, minor, False) for other in others),
        ]
    declared = _parameters(staging, cue, others, surroundings)
    starts = [me.start_actions(move, roads, minor), *(_waits(other, roads, minor) for other in others)]
    first = [] if surroundings is None else [node("GlobalAction", node("EnvironmentAction", surroundings))]
    board = node(
        "Storyboard",
        node("Init", node("Actions", *first, *starts)),
        _story(staging.ego, cue, others, roads, minor),
        _end(staging.ego, cue, others, minor),
    )
    root = node(
        "OpenSCENARIO", file_header(about.source, minor), declared, node("CatalogLocations"),
        node("RoadNetwork", node("LogicFile", filepath=about.road_file)), node("Entities", *entities), board,
    )  # fmt: skip
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    for other in others:
        text = text.replace(other.mark, f"{other.vertices}\n{INDENT[:-2]}", 1)
    said = comments(about.source, (*_said(staging, cue), *_left_out(staging)))
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{said}{text}\n'


def _parameters(staging: Staging, cue: Cue, others: Sequence[Other], surroundings: ET.Element | None) -> ET.Element:
    told: dict[str, object] = {me.SPEED: round(float(staging.way.speed_mps[0]), 3)}
    told |= {END: round(cue.contact_s + PATIENCE_S, 2), STANDS: STANDS_S, LATE: round(cue.contact_s + STANDS_S, 2)}
    if cue.to_conflict_s is not None:
        told[TIME] = cue.to_conflict_s
    if cue.clearance_m is not None:
        told[CLEARANCE] = cue.clearance_m
    for other in others:
        if other.rows:
            told |= {f"{other.clock}_TimeScale": 1.0, f"{other.clock}_TimeOffset": 0.0}
    road = None if surroundings is None else surroundings.find("RoadCondition")
    if road is not None:
        told[FRICTION] = float(road.get("frictionScaleFactor", "1"))
        road.set("frictionScaleFactor", f"${FRICTION}")
    rows = [node("ParameterDeclaration", name=n, parameterType="double", value=v) for n, v in told.items()]
    controller = node("ParameterDeclaration", name=me.CONTROLLER, parameterType="string", value=me.EXTERNAL)
    return node("ParameterDeclarations", *rows, controller)


def _waits(other: Other, roads: object, minor: int) -> ET.Element:
    """An actor at its start, without speed until its cue."""
    actions = [node("TeleportAction", position(other.start, roads)), speed(0.0)]  # type: ignore[arg-type]
    if minor == 0 and other.info.record.axles:
        actions.append(me.carla_controller())
    return private(other.info.id, actions)


# ------------------------------------------------------------------ the story
def _story(ego: str, cue: Cue, others: Sequence[Other], roads: object, minor: int) -> ET.Element:
    groups = [_group(other, ego, cue, roads, minor) for other in others if other.rows] or [_nothing(ego, minor)]
    act = node("Act", *groups, trigger("StartTrigger", [[of_time("begins", 0.0, minor)]]), name="encounter")
    return node("Story", *([] if minor else [node("ParameterDeclarations")]), act, name="crash")


def _group(other: Other, ego: str, cue: Cue, roads: object, minor: int) -> ET.Element:
    name = other.info.id
    action = node("Action", node("PrivateAction", other.follow(minor)), name=f"{name}_follows")
    starts = trigger("StartTrigger", _cues(name, ego, cue, roads, minor))
    priority = "overwrite" if minor < 2 else "override"
    event = node("Event", action, starts, name=f"{name}_comes", priority=priority)
    actors = node("Actors", node("EntityRef", entityRef=name), selectTriggeringEntities=False)
    maneuver = node("Maneuver", event, name=f"{name}_maneuver")
    return node("ManeuverGroup", actors, maneuver, name=f"{name}_group", maximumExecutionCount=1)


def _nothing(ego: str, minor: int) -> ET.Element:
    """The group of a story in which the others stand."""
    actors = node("Actors", selectTriggeringEntities=False)
    return node("ManeuverGroup", actors, name=f"{ego}_alone", maximumExecutionCount=1)


def _cues(name: str, ego: str, cue: Cue, roads: object, minor: int) -> list[list[ET.Element]]:
    """What starts an actor: any of these."""
    if cue.to_conflict_s is None:
        return [[of_time(f"{name}_at_once", 0.0, minor)]]
    where = node("TimeToCollisionConditionTarget", position(cue.place, roads))  # type: ignore[arg-type]
    told = {"value": f"${TIME}", "freespace": False, "rule": "lessThan"}
    how: dict[str, object] = {"alongRoute": False}
    if minor:
        how = {"coordinateSystem": "entity", "relativeDistanceType": "euclidianDistance"}
    known = of_time(f"{name}_driver_known", cue.lead_rows * STEP_S - (0 if minor else 1e-3), minor)
    found = [[of_entity(f"{name}_in_time", ego, node("TimeToCollisionCondition", where, **told, **how)), known]]
    if cue.clearance_m is not None:
        kind = "euclidianDistance" if minor else "cartesianDistance"
        near = node(
            "RelativeDistanceCondition", entityRef=cue.other, relativeDistanceType=kind, value=f"${CLEARANCE}",
            freespace=True, rule="lessThan", **({"coordinateSystem": "entity"} if minor else {}),
        )  # fmt: skip
        found.append([of_entity(f"{name}_near", ego, near)])
    return found


def _end(ego: str, cue: Cue, others: Sequence[Other], minor: int) -> ET.Element:
    touches = [
        [of_entity(f"touches_{o.info.id}", ego, node("CollisionCondition", node("EntityRef", entityRef=o.info.id)))]
        for o in others
    ]
    stands = of_entity("stands", ego, node("StandStillCondition", duration=f"${STANDS}"))
    late = of_time("behind_the_conflict", f"${LATE}", minor)
    return trigger("StopTrigger", [*touches, [stands, late], [of_time("in_time", f"${END}", minor)]])


# ------------------------------------------------------------------ in words
def _said(staging: Staging, cue: Cue) -> list[str]:
    role = staging.script.roles.get(staging.ego, "bystander")
    said = [f"{staging.ego} ({role}) is the ego: it has a start, a speed and a route, and no motion of its own."]
    if cue.to_conflict_s is None:
        said.append("It stands at first, so the others begin with the scenario.")
    else:
        near = "" if cue.clearance_m is None else f", or it comes within {cue.clearance_m:g} m of {cue.other}"
        said.append(f"The others wait until its time to the conflict is {cue.to_conflict_s:g} s{near}.")
    met = staging.contact
    if met is None:
        said.append(f"In the report nothing touches it; {cue.other or 'nothing'} comes nearest.")
    else:
        said.append(
            f"Driven as in the report it touches {cue.other} after {met.t_s:.2f} s: {met.actor} {met.actor_area}, "
            f"{met.other} {met.other_area}."
        )
    return said


def _left_out(staging: Staging) -> list[str]:
    named = ", ".join(sorted(staging.coupled))
    return [f"Left out, since it is coupled to the ego: {named}."] if named else []
