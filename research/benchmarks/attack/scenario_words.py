"""Pieces of OpenSCENARIO and OpenDRIVE files by hand, for hostile ones. Knows no reader."""

from __future__ import annotations

HEADER = '<FileHeader revMajor="1" revMinor="2" date="2026-11-27T00:00:00" description="" author=""/>'
VEHICLE = (
    '<Vehicle name="v" vehicleCategory="car"><BoundingBox><Center x="1.4" y="0" z="0.75"/><Dimensions width="1.8" '
    'length="4.5" height="1.5"/></BoundingBox><Performance maxSpeed="70" maxAcceleration="10" maxDeceleration="10"/>'
    '<Axles><FrontAxle maxSteering="0.5" wheelDiameter="0.6" trackWidth="1.6" positionX="2.8" positionZ="0.3"/>'
    '<RearAxle maxSteering="0" wheelDiameter="0.6" trackWidth="1.6" positionX="0" positionZ="0.3"/></Axles>'
    "<Properties/></Vehicle>"
)


def trigger(inner: str, edge: str = "none") -> str:
    """A start or stop trigger's group with one condition."""
    return f'<ConditionGroup><Condition name="c" delay="0" conditionEdge="{edge}">{inner}</Condition></ConditionGroup>'


def at(time_s: float | str, edge: str = "none") -> str:
    """A trigger at a time."""
    inner = f'<SimulationTimeCondition value="{time_s}" rule="greaterThan"/>'
    return trigger(f"<ByValueCondition>{inner}</ByValueCondition>", edge)


def of_entity(condition: str, edge: str = "none") -> str:
    """A trigger of V1."""
    names = '<TriggeringEntities triggeringEntitiesRule="any"><EntityRef entityRef="V1"/></TriggeringEntities>'
    inner = f"<ByEntityCondition>{names}<EntityCondition>{condition}</EntityCondition></ByEntityCondition>"
    return trigger(inner, edge)


def lane(road: object, s_m: object, lane_id: object = -1) -> str:
    """A place in a lane."""
    where = f'roadId="{road}" laneId="{lane_id}" s="{s_m}" offset="0"'
    return f"<Position><LanePosition {where}/></Position>"


def world(x_m: object, y_m: object) -> str:
    """A place in the world."""
    return f'<Position><WorldPosition x="{x_m}" y="{y_m}" h="0"/></Position>'


def event(action: str, start: str, count: int = 1, name: object = "e") -> str:
    """An event with one private action."""
    return (
        f'<Event name="{name}" priority="parallel" maximumExecutionCount="{count}"><Action name="a"><PrivateAction>'
        f"{action}</PrivateAction></Action><StartTrigger>{start}</StartTrigger></Event>"
    )


def follow(shape: str, reference: str = "<None/>", mode: str = "position") -> str:
    """A trajectory to follow."""
    return (
        '<RoutingAction><FollowTrajectoryAction><TrajectoryRef><Trajectory name="t" closed="false"><Shape>'
        f"{shape}</Shape></Trajectory></TrajectoryRef><TimeReference>{reference}</TimeReference>"
        f'<TrajectoryFollowingMode followingMode="{mode}"/></FollowTrajectoryAction></RoutingAction>'
    )


def scenario(
    events: str = "", places: tuple[str, ...] = (lane(1, 20), lane(1, 60)), *, parameters: str = "",
    catalogs: str = "", network: str = '<LogicFile filepath="m.xodr"/>', end: str = at(5), entities: str = "",
) -> str:  # fmt: skip
    """A scenario of V1, V2 and so on at places, 10 m/s each."""
    names = [f"V{k}" for k in range(1, len(places) + 1)]
    own = entities or "".join(f'<ScenarioObject name="{name}">{VEHICLE}</ScenarioObject>' for name in names)
    init = "".join(
        f'<Private entityRef="{name}"><PrivateAction><TeleportAction>{place}</TeleportAction></PrivateAction>'
        "<PrivateAction><LongitudinalAction><SpeedAction><SpeedActionDynamics dynamicsShape="
        '"step" dynamicsDimension="time" value="0"/><SpeedActionTarget><AbsoluteTargetSpeed value="10"/>'
        "</SpeedActionTarget></SpeedAction></LongitudinalAction></PrivateAction></Private>"
        for name, place in zip(names, places, strict=True)
    )
    return (
        f"<OpenSCENARIO>{HEADER}<ParameterDeclarations>{parameters}</ParameterDeclarations><CatalogLocations>{catalogs}"
        f"</CatalogLocations><RoadNetwork>{network}</RoadNetwork><Entities>{own}</Entities><Storyboard><Init><Actions>"
        f'{init}</Actions></Init><Story name="s"><Act name="a"><ManeuverGroup name="g" maximumExecutionCount="1">'
        '<Actors selectTriggeringEntities="false"><EntityRef entityRef="V1"/></Actors><Maneuver name="m">'
        f"{events}</Maneuver></ManeuverGroup><StartTrigger>{at(0)}</StartTrigger></Act></Story><StopTrigger>{end}"
        "</StopTrigger></Storyboard></OpenSCENARIO>"
    )


def catalog(entries: str) -> str:
    """A catalog file."""
    return f'<OpenSCENARIO>{HEADER}<Catalog name="c">{entries}</Catalog></OpenSCENARIO>'


def distribution(inner: str, file: str = "s.xosc") -> str:
    """A distribution file."""
    holder = f'<ParameterValueDistribution><ScenarioFile filepath="{file}"/>{inner}</ParameterValueDistribution>'
    return f"<OpenSCENARIO>{HEADER}{holder}</OpenSCENARIO>"


# ------------------------------------------------------------------ maps
def geometry(s_m: object, x_m: object, length: object, shape: str = "<line/>", y_m: object = 0) -> str:
    """A piece of a reference line to the east."""
    return f'<geometry s="{s_m}" x="{x_m}" y="{y_m}" hdg="0" length="{length}">{shape}</geometry>'


def road(name: object, plan: str, length: object, *, link: str = "", sections: str = "", junction: object = -1) -> str:
    """A road, with one lane to the right unless sections are given."""
    own = (
        sections
        or f'<laneSection s="0"><center><lane id="0" type="none"/></center><right>{width(-1)}</right></laneSection>'
    )
    return (
        f'<road id="{name}" length="{length}" junction="{junction}"><link>{link}</link><planView>{plan}</planView>'
        f"<lanes>{own}</lanes></road>"
    )


def width(lane_id: object, entries: str = '<width sOffset="0" a="3.5" b="0" c="0" d="0"/>') -> str:
    """A lane."""
    link = f'<link><predecessor id="{lane_id}"/><successor id="{lane_id}"/></link>'
    return f'<lane id="{lane_id}" type="driving" level="false">{link}{entries}</lane>'


def chained(k: int, count: int) -> str:
    """The links of road k in a row of so many, counted from 1."""
    before = f'<predecessor elementType="road" elementId="{k - 1}" contactPoint="end"/>' if k > 1 else ""
    behind = f'<successor elementType="road" elementId="{k + 1}" contactPoint="start"/>' if k < count else ""
    return before + behind


def network(roads: str) -> str:
    """A map."""
    return f'<OpenDRIVE><header revMajor="1" revMinor="6"/>{roads}</OpenDRIVE>'


PLAIN = network(road(1, geometry(0, 0, 500), 500))
