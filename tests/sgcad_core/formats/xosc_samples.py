"""Networks, trajectories and hand-written scenario files for tests."""

from __future__ import annotations

import functools

import numpy as np

from sgcad_core.case.records import ActorInfo, RoadNetwork, Trajectory
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, Node, Road, RoadSpec

CROSSING = BehaviorSpec(
    actors=(
        Actor(id="V1", kind="car", road="S", direction="forward", maneuver="turn_left", exit_road="W"),
        Actor(id="V2", kind="truck", road="N", direction="forward", maneuver="straight"),
        Actor(id="P1", kind="pedestrian", road="E", direction="forward", maneuver="straight"),
    ),
    contacts=(Contact(striker="V2", struck="V1", striker_area="front", struck_area="right"),),
    light="dark_lit",
    weather="rain",
    surface="wet",
)


def road(name: str, lanes: tuple[int, int], **more: object) -> Road:
    """A road from its end to the hub."""
    ends = {"id": name, "from_node": f"{name}_end", "to_node": "hub"}
    return Road.model_validate({**ends, "lanes_forward": lanes[0], "lanes_backward": lanes[1], **more})


def network(places: dict[str, tuple[float, float]], *roads: Road) -> RoadNetwork:
    ends = tuple(Node(id=f"{name}_end", x_m=x, y_m=y) for name, (x, y) in places.items())
    spec = RoadSpec(nodes=(Node(id="hub", x_m=0, y_m=0), *ends), roads=roads)
    return compile_network(plain_xml(spec), spec)


@functools.cache
def crossroads() -> RoadNetwork:
    """Four legs of 120 m, two lanes each way, along the axes; the hub lies at 0, 0."""
    places = {"N": (0, 120), "E": (120, 0), "S": (0, -120), "W": (-120, 0)}
    return network(places, *(road(name, (2, 2)) for name in places))


@functools.cache
def bent_road() -> RoadNetwork:
    """Two legs, one of them curved."""
    via = [{"x_m": 12, "y_m": 80}, {"x_m": 4, "y_m": 40}]
    return network({"N": (30, 120), "SW": (-85, -85)}, road("N", (2, 1), via=via), road("SW", (1, 2)))


def actor(name: str, kind: str = "car", size: tuple[float, float] = (4.7, 1.8)) -> ActorInfo:
    return ActorInfo(id=name, type=kind, length_m=size[0], width_m=size[1], maneuver="straight")


def trajectory(name: str, x, y, heading=0.0, dt_s: float = 0.05) -> Trajectory:
    """Rows 0.05 s apart; speeds as the player derives them."""
    x = np.asarray(x, dtype=float)
    y, heading = np.broadcast_to(y, x.shape).astype(float), np.broadcast_to(heading, x.shape).astype(float)
    step = np.hypot(np.diff(x), np.diff(y)) / dt_s
    speed = np.concatenate((step[:1], (step[1:] + step[:-1]) / 2, step[-1:]))
    return Trajectory(actor=name, t_s=np.arange(len(x)) * dt_s, x_m=x, y_m=y, heading_rad=heading, speed_mps=speed)


# ------------------------------------------------------------------ scenario files by hand
def world(x: float, y: float, h: float = 0.0) -> str:
    return f'<Position><WorldPosition x="{x}" y="{y}" h="{h}"/></Position>'


def lane(road: str, lane_id: int | str, s: float, inner: str = "", **more: float) -> str:
    extra = "".join(f' {k}="{v}"' for k, v in more.items())
    place = f'roadId="{road}" laneId="{lane_id}" s="{s}"{extra}'
    return f"<Position><LanePosition {place}>{inner}</LanePosition></Position>"


def speed_action(value: str | float, shape: str = "step", dimension: str = "time", over: float = 0) -> str:
    return (
        "<LongitudinalAction><SpeedAction>"
        f'<SpeedActionDynamics dynamicsShape="{shape}" dynamicsDimension="{dimension}" value="{over}"/>'
        f'<SpeedActionTarget><AbsoluteTargetSpeed value="{value}"/></SpeedActionTarget>'
        "</SpeedAction></LongitudinalAction>"
    )


def lane_change(by: int, over: float, dimension: str = "time", shape: str = "sinusoidal") -> str:
    return (
        "<LateralAction><LaneChangeAction>"
        f'<LaneChangeActionDynamics dynamicsShape="{shape}" dynamicsDimension="{dimension}" value="{over}"/>'
        f'<LaneChangeTarget><RelativeTargetLane entityRef="V1" value="{by}"/></LaneChangeTarget>'
        "</LaneChangeAction></LateralAction>"
    )


def follow(vertices: list[tuple], timing: str = "<None/>", **more: str) -> str:
    """Vertices are (t | None, x, y, h | None)."""
    rows = "".join(_vertex(*row) for row in vertices)
    attributes = "".join(f' {k}="{v}"' for k, v in more.items())
    return (
        f"<RoutingAction><FollowTrajectoryAction{attributes}><TrajectoryRef>"
        f'<Trajectory name="path" closed="false"><Shape><Polyline>{rows}</Polyline></Shape></Trajectory>'
        "</TrajectoryRef>"
        f'<TimeReference>{timing}</TimeReference><TrajectoryFollowingMode followingMode="position"/>'
        "</FollowTrajectoryAction></RoutingAction>"
    )


def _vertex(t, x, y, h) -> str:
    time = "" if t is None else f' time="{t}"'
    heading = "" if h is None else f' h="{h}"'
    return f'<Vertex{time}><Position><WorldPosition x="{x}" y="{y}"{heading}/></Position></Vertex>'


def timing(domain: str = "absolute", scale: float = 1, offset: float = 0) -> str:
    return f'<Timing domainAbsoluteRelative="{domain}" scale="{scale}" offset="{offset}"/>'


def at(time: float | str, rule: str = "greaterOrEqual", edge: str = "none", delay: float = 0) -> str:
    inner = f'<ByValueCondition><SimulationTimeCondition value="{time}" rule="{rule}"/></ByValueCondition>'
    return condition(inner, edge, delay)


def when(inner: str, *names: str, edge: str = "none", rule: str = "any", delay: float = 0) -> str:
    refs = "".join(f'<EntityRef entityRef="{n}"/>' for n in names or ("V1",))
    return condition(
        f'<ByEntityCondition><TriggeringEntities triggeringEntitiesRule="{rule}">{refs}</TriggeringEntities>'
        f"<EntityCondition>{inner}</EntityCondition></ByEntityCondition>",
        edge,
        delay,
    )


def condition(inner: str, edge: str = "none", delay: float = 0) -> str:
    return f'<Condition name="c" delay="{delay}" conditionEdge="{edge}">{inner}</Condition>'


def event(name: str, action: str, start: str, priority: str = "override", count: int = 1) -> str:
    return (
        f'<Event name="{name}" priority="{priority}" maximumExecutionCount="{count}">'
        f'<Action name="{name}_action"><PrivateAction>{action}</PrivateAction></Action>'
        f"<StartTrigger><ConditionGroup>{start}</ConditionGroup></StartTrigger></Event>"
    )


def entity(name: str, center_x: float = 0.0) -> str:
    return (
        f'<ScenarioObject name="{name}"><Vehicle name="car" vehicleCategory="car"><BoundingBox>'
        f'<Center x="{center_x}" y="0" z="0.7"/><Dimensions width="1.8" length="4.6" height="1.4"/></BoundingBox>'
        '<Performance maxSpeed="60" maxAcceleration="12" maxDeceleration="12"/><Axles>'
        '<FrontAxle maxSteering="0.5" wheelDiameter="0.6" trackWidth="1.7" positionX="2.8" positionZ="0.3"/>'
        '<RearAxle maxSteering="0" wheelDiameter="0.6" trackWidth="1.7" positionX="0" positionZ="0.3"/>'
        "</Axles><Properties/></Vehicle></ScenarioObject>"
    )


def scenario(
    places: dict[str, str],
    events: str = "",
    speeds: dict[str, float | str] | None = None,
    end: str = "",
    entities: str | None = None,
    parameters: str = "",
) -> str:
    """A file with V1's events in one maneuver; it ends after 4 s unless told otherwise."""
    init = "".join(
        f'<Private entityRef="{name}"><PrivateAction><TeleportAction>{place}</TeleportAction></PrivateAction>'
        f"<PrivateAction>{speed_action((speeds or {}).get(name, 0))}</PrivateAction></Private>"
        for name, place in places.items()
    )
    story = (
        '<Story name="story"><Act name="act"><ManeuverGroup name="group" maximumExecutionCount="1">'
        '<Actors selectTriggeringEntities="false"><EntityRef entityRef="V1"/></Actors>'
        f'<Maneuver name="maneuver">{events}</Maneuver></ManeuverGroup>'
        f"<StartTrigger><ConditionGroup>{at(0)}</ConditionGroup></StartTrigger></Act></Story>"
    )
    return (
        '<?xml version="1.0" encoding="UTF-8"?>\n<OpenSCENARIO>'
        '<FileHeader revMajor="1" revMinor="2" date="2020-01-01T00:00:00" description="test" author="test"/>'
        f"<ParameterDeclarations>{parameters}</ParameterDeclarations><CatalogLocations/>"
        '<RoadNetwork><LogicFile filepath="road.xodr"/></RoadNetwork>'
        f"<Entities>{entities or ''.join(map(entity, places))}</Entities>"
        f"<Storyboard><Init><Actions>{init}</Actions></Init>{story if events else ''}"
        f"<StopTrigger><ConditionGroup>{end or at(4)}</ConditionGroup></StopTrigger></Storyboard></OpenSCENARIO>"
    )


def v1(text, xodr=None):
    """V1's trajectory."""
    return play(text, xodr)[0]


def row(motion, t_s):
    """x, y, heading and speed at a time."""
    k = round(t_s / 0.05)
    return motion.x_m[k], motion.y_m[k], motion.heading_rad[k], motion.speed_mps[k]
