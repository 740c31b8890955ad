"""What a writer says about a crash before any file format: layout, roads, behavior.

These pydantic classes are also the JSON schemas that a model answers in, so field order is answer
order and every description is prompt text. Knows no SUMO, OpenDRIVE or OpenSCENARIO.

Frames: x east, y north, metres. Speeds stand in mph because reports state them so and a model should
copy rather than compute; everything behind the specs is SI.
"""

from __future__ import annotations

from typing import Annotated, Literal, NamedTuple

from pydantic import Field, StringConstraints

from sgcad_core.kinds import DRIVEWAY, ActorRecord, actor_kind
from sgcad_core.kinds import Maneuver as Maneuver
from sgcad_core.kinds import RoadKind as RoadKind
from sgcad_core.records.actor_kind import ActorKind as ActorKind
from sgcad_core.records.acts import Acts
from sgcad_core.records.answer_schema import TRAINED, added
from sgcad_core.records.answer_schema import Spec as Spec
from sgcad_core.records.words import Area as Area
from sgcad_core.records.words import Compass as Compass
from sgcad_core.records.words import EvasiveManeuver as EvasiveManeuver
from sgcad_core.records.words import LaneNumber

Id = Annotated[str, StringConstraints(pattern=r"^[A-Za-z][A-Za-z0-9_]{0,23}$")]
_TRAINED_ID = {"pattern": "^[VPBTO][0-9]{1,2}$"}
ActorId = Annotated[
    str, StringConstraints(pattern=r"^[VNPBTOA][0-9]{1,2}$"), Field(json_schema_extra={TRAINED: _TRAINED_ID})
]
NodeControl = Literal["none", "signal", "flashing", "stop", "all_way_stop", "yield"]
Turn = Literal["left", "through", "right", "left_through", "through_right", "left_right", "any"]
Median = Literal["none", "painted", "raised", "grass", "barrier"]
RoadArea = Literal["", "rural", "town", "motorway"]
CenterLine = Literal["", "double_yellow", "solid_yellow", "broken_yellow"]
Beside = Literal["bike_lane", "parking", "shoulder", "sidewalk"]
"""What lies beside the lanes of a road, in this order from the lanes outwards."""
Ground = Literal["curb", "ditch", "embankment"]
"""What a vehicle drives over beside the pavement."""
Light = Literal["day", "dusk", "dawn", "dark", "dark_lit"]
Weather = Literal["clear", "cloudy", "rain", "snow", "sleet", "fog"]
Surface = Literal["dry", "wet", "snow", "ice"]
SpeedMph = Annotated[int, Field(ge=0, le=120)]
SpeedLimitMph = Annotated[int, Field(ge=5, le=85)]
Lanes = Annotated[int, Field(ge=0, le=8)]
CLEARANCE_M = 0.6
"""How near two bodies come in a near crash whose report does not tell it, metres: "nearly hit" is less than a door's
width. A convention of ours, marked `default` wherever it stands."""


# ------------------------------------------------------------------ road, in full
class Point(Spec):
    """A place on the ground, metres; x east, y north."""

    x_m: Annotated[float, Field(ge=-3000, le=3000)]
    y_m: Annotated[float, Field(ge=-3000, le=3000)]


class Node(Point):
    """A place where roads meet or end."""

    id: Id
    control: NodeControl = Field("none", description="stop / yield: the minor roads stop / yield")
    opening: bool = added(False, "an opening in the median, by which one turns round")


class Road(Spec):
    """A road between two nodes; forward is from from_node to to_node, traffic keeps to the right."""

    id: Id
    from_node: Id
    to_node: Id
    lanes_forward: Lanes = Field(description="lanes at the widest section, turn lanes counted; 0 = no such direction")
    lanes_backward: Lanes
    turns_forward: tuple[Turn, ...] = Field((), description="use of each lane at to_node, from the right curb")
    turns_backward: tuple[Turn, ...] = Field((), description="use of each lane at from_node, from the right curb")
    center_turn_lane: bool = Field(False, description="two-way left-turn lane; not counted in the lanes")
    median: Median = "none"
    via: tuple[Point, ...] = Field((), description="inner points of a curved road, in order")
    kind: RoadKind = "road"
    minor: bool = Field(False, description="has the stop or yield sign where it meets a node so controlled")
    speed_limit_mph: SpeedLimitMph | None = None
    circle: bool = added(False, "a piece of a roundabout: one-way forward, counterclockwise from node to node")
    beside: tuple[Beside, ...] = added(
        (), "on both sides of the lanes, from the lanes outwards; parking: along the curb"
    )
    alley: bool = added(False, "an alley: a narrow driveway without markings")
    closed_forward: tuple[LaneNumber, ...] = added((), "its lanes that a work zone closes, 1 = at the right curb")
    closed_backward: tuple[LaneNumber, ...] = added((), "the same of the other direction")
    crosswalks: tuple[Id, ...] = added((), "its ends (from_node, to_node) at which a crosswalk leads over it")


class RoadSpec(Spec):
    """A road network, any shape: several junctions, merges, ramps, one-way and divided roads."""

    nodes: Annotated[tuple[Node, ...], Field(min_length=2, max_length=40)]
    roads: Annotated[tuple[Road, ...], Field(min_length=1, max_length=60)]


def centers(spec: RoadSpec) -> dict[str, str]:
    """Node of a roundabout -> the name that stands for all of its nodes; empty where there is none."""
    found: dict[str, str] = {}
    pieces = [road for road in spec.roads if road.circle]
    for _ in pieces:
        for road in pieces:
            name = min(found.get(road.from_node, road.from_node), found.get(road.to_node, road.to_node))
            found[road.from_node] = found[road.to_node] = name
    return found


class ToldRoad(NamedTuple):
    """What a report tells of a drawn road that no field of a spec holds (specs are answers; this is read by rules)."""

    posted: bool = True
    """Whether its speed limit is told; else it is a usual one."""
    area: RoadArea = ""
    center_line: CenterLine = ""
    ground: tuple[Ground, ...] = ()
    """Ground beside it."""
    ground_side: Compass | Literal[""] = ""
    """The side on which ditches and embankments lie; "" both."""


# ------------------------------------------------------------------ road, as a small model or a template says it
class Leg(Spec):
    """A road that ends at the hub. Ids are bearings, so a layout has at most one leg a bearing."""

    bearing: Compass = Field(description="where the leg lies, seen from the hub")
    lanes_in: Lanes = Field(description="lanes towards the hub, turn lanes counted")
    lanes_out: Lanes
    turns_in: tuple[Turn, ...] = Field((), description="use of each lane towards the hub, from the right curb")
    center_turn_lane: bool = False
    median: Median = "none"
    kind: RoadKind = "road"
    control: Literal["none", "signal", "flashing", "stop", "yield"] = "none"
    curve: Literal["none", "left", "right"] = Field("none", description="as one drives towards the hub")
    speed_limit_mph: SpeedLimitMph | None = None
    beside: tuple[Beside, ...] = added(
        (), "on both sides of the lanes, from the lanes outwards; parking: along the curb"
    )
    crosswalk: bool = added(False, "whether a marked crosswalk leads over this leg at the hub")
    alley: bool = added(False, "an alley: a narrow driveway without markings")
    closed_out: tuple[LaneNumber, ...] = added(
        (), "lanes away from the hub that a work zone closes, from the right curb"
    )
    skew_deg: Annotated[int, Field(ge=-40, le=40)] = added(0, "how far it lies clockwise of its bearing, degrees")


class Access(Spec):
    """A driveway or side road that joins a leg away from the hub: a junction of its own."""

    leg: Compass
    side: Literal["left", "right", "both"] = Field(description="as one drives towards the hub")
    distance_m: Annotated[float, Field(ge=15, le=150)] = 40.0
    kind: RoadKind = DRIVEWAY
    lanes_in: Lanes = 1
    lanes_out: Lanes = 1
    control: Literal["none", "signal", "stop", "yield"] = "none"


class RoadLayout(Spec):
    """One hub and its legs: three or more legs make a junction, two a plain (or curved) road.

    `sgcad_core.roads.layout.road_spec` compiles it. Road ids there: the leg's bearing ("N"; forward runs towards
    the hub), behind an access the outer piece "N_outer", the access itself "N_access_left|right"
    (forward towards the leg), node ids "hub", "N_end", "N_joint", "N_access_left_end".
    """

    legs: Annotated[tuple[Leg, ...], Field(min_length=2, max_length=8)]
    accesses: Annotated[tuple[Access, ...], Field(max_length=4)] = ()
    circle_lanes: Annotated[int, Field(ge=0, le=2)] = added(
        0, "lanes around, where the hub is a roundabout (every leg yields); 0: it is none"
    )
    opening: bool = added(False, "an opening in the median at the hub of two legs, by which one turns round")


# ------------------------------------------------------------------ behavior
_TRAINED_ACTOR = "V<n> as the report numbers it, P pedestrian, B cyclist, T trailer, O object"


class Actor(Spec):
    """A road user or object and its pre-crash motion."""

    id: ActorId = Field(
        description="V<n> as the report numbers it, N vehicle without number, P person, B cyclist, A animal, "
        "T trailer, O object",
        json_schema_extra={TRAINED: {**_TRAINED_ID, "description": _TRAINED_ACTOR}},
    )
    kind: ActorKind
    road: Id = Field(description="road on which it starts")
    direction: Literal["forward", "backward"] = Field(description="forward: from the road's from_node to its to_node")
    lane: Annotated[int, Field(ge=1, le=8)] | None = Field(None, description="1 = at the right curb")
    exit_road: Id | None = Field(None, description="road it takes, or means to take, behind the junction")
    maneuver: Maneuver
    speed_mph: SpeedMph | None = None
    length_m: Annotated[float, Field(gt=0.1, le=30)] | None = None
    width_m: Annotated[float, Field(gt=0.1, le=20, json_schema_extra={TRAINED: {"maximum": 5}})] | None = None
    gore: bool = added(False, "in the gore of a ramp: what stands there, or who crosses it into exit_road")
    firm: bool = added(False, "a thing that stays where it stands: what drives on has glanced off it")
    loose: bool = added(False, "a piece that lies in the way: what strikes it drives on over it")
    flat: bool = added(False, "a thing on or in the ground (a curb, a ditch): what strikes it drives over it, it stays")
    acts: Acts | None = added(None, "what it did beside its maneuver, of a vehicle; null where nothing of it is told")

    @property
    def record(self) -> ActorRecord:
        """What is known of its kind."""
        return actor_kind(self.kind)

    @property
    def stays(self) -> bool:
        """Whether it stays where it stands when a vehicle strikes it and goes on."""
        return self.firm or self.flat


class Contact(Spec):
    """One collision: striker hits struck; areas are the sides of each that touch."""

    striker: ActorId
    struck: ActorId
    striker_area: Area
    struck_area: Area


class Evasion(Spec):
    """What one of both did so that they would not touch; a side that is left open is the planner's choice."""

    actor: ActorId
    maneuver: EvasiveManeuver


class NearCrash(Spec):
    """A conflict in which nobody touches: what would have touched, who evaded how, how near they came."""

    conflict: Contact = Field(description="the contact that would have come about without any evasion")
    evasions: Annotated[tuple[Evasion, ...], Field(max_length=2)] = ()
    clearance_m: Annotated[float, Field(ge=0.1, le=10)] | None = Field(
        None, description="between the bodies at the closest, metres; null where it is not told"
    )

    @property
    def closest_m(self) -> float:
        """The declared clearance, as told or the usual one."""
        return CLEARANCE_M if self.clearance_m is None else self.clearance_m


class BehaviorSpec(Spec):
    """Who moves where and who strikes whom, contacts in order: the first is the first harmful event."""

    actors: Annotated[tuple[Actor, ...], Field(min_length=1, max_length=12)]
    contacts: Annotated[tuple[Contact, ...], Field(max_length=8)] = ()
    light: Light | None = None
    weather: Weather | None = None
    surface: Surface | None = None
    near_crash: NearCrash | None = added(None, "what was avoided where nobody touches; contacts is then empty")

    @property
    def acts(self) -> dict[str, Acts]:
        """What is said of actors beside their maneuvers, by id."""
        return {actor.id: actor.acts for actor in self.actors if actor.acts is not None}

    @property
    def first_meeting(self) -> Contact | None:
        """The first contact, else the one that was avoided; None where nobody meets."""
        if self.contacts:
            return self.contacts[0]
        return self.near_crash.conflict if self.near_crash else None


class Refusal(Spec):
    """The answer of a writer that finds the evidence too thin or contradictory."""

    refuse: Annotated[str, StringConstraints(min_length=1, max_length=400)]
    missing: Annotated[tuple[str, ...], Field(max_length=12)] = ()


def is_aisle(road: Road | Leg) -> bool:
    """Whether it is an aisle of a parking lot: a driveway with room to park beside it."""
    return road.kind == DRIVEWAY and "parking" in road.beside


def size_m(actor: Actor) -> tuple[float, float]:
    """Length and width of an actor's box in metres: as stated, else typical of its kind."""
    length, width = actor.record.size
    return actor.length_m or length, actor.width_m or width
