"""OpenSCENARIO in Python, piece by piece; every function runs as it stands and its body is shown to a model.

A docstring's first line is the title, the rest other words for the same thing. Knows nothing of the project.
"""

from __future__ import annotations

from scenariogeneration import xosc


def vehicle_with_bounding_box() -> xosc.Entities:
    """Declare a car with its size, axles and performance

    entity vehicle dimensions length width height bounding box axle add scenario object
    """
    box = xosc.BoundingBox(width=1.8, length=4.7, height=1.5, x_center=1.35, y_center=0, z_center=0.75)
    front = xosc.Axle(maxsteer=0.5, wheeldia=0.65, track_width=1.6, xpos=2.7, zpos=0.325)
    rear = xosc.Axle(maxsteer=0.0, wheeldia=0.65, track_width=1.6, xpos=0.0, zpos=0.325)
    car = xosc.Vehicle("V1", xosc.VehicleCategory.car, box, front, rear, 60, 10, 10)
    entities = xosc.Entities()
    entities.add_scenario_object("V1", car)
    return entities


def pedestrian_and_fixed_object() -> xosc.Entities:
    """Declare a pedestrian and a fixed object such as a tree, pole or barrier

    walker person on foot obstacle guardrail misc object
    """
    entities = xosc.Entities()
    body = xosc.BoundingBox(0.6, 0.5, 1.75, 0, 0, 0.875)
    entities.add_scenario_object("P1", xosc.Pedestrian("P1", 75, xosc.PedestrianCategory.pedestrian, body))
    trunk = xosc.BoundingBox(0.5, 0.5, 8, 0, 0, 4)
    entities.add_scenario_object("O1", xosc.MiscObject("O1", 500, xosc.MiscObjectCategory.tree, trunk))
    return entities


def truck_and_motorcycle() -> xosc.Entities:
    """Declare a heavy truck and a motorcycle

    vehicle category semi tractor bike rider bus trailer
    """
    entities = xosc.Entities()
    box = xosc.BoundingBox(2.5, 9.0, 3.2, 3.0, 0, 1.6)
    axle = xosc.Axle(0.5, 1.0, 2.0, 5.0, 0.5)
    rear = xosc.Axle(0.0, 1.0, 2.0, 0.0, 0.5)
    entities.add_scenario_object("V1", xosc.Vehicle("V1", xosc.VehicleCategory.truck, box, axle, rear, 35, 3, 7))
    box = xosc.BoundingBox(0.8, 2.2, 1.5, 0.7, 0, 0.75)
    axle, rear = xosc.Axle(0.7, 0.6, 0.1, 1.4, 0.3), xosc.Axle(0.0, 0.6, 0.1, 0.0, 0.3)
    bike = xosc.Vehicle("V2", xosc.VehicleCategory.motorbike, box, axle, rear, 60, 6, 9)
    entities.add_scenario_object("V2", bike)
    return entities


def initial_position_and_speed() -> xosc.Init:
    """Place an actor on a lane and set its initial (starting) speed

    init teleport start position lane position road id lane id s offset speed in m/s
    """
    at_once = xosc.TransitionDynamics(xosc.DynamicsShapes.step, xosc.DynamicsDimension.time, 0)
    init = xosc.Init()
    init.add_init_action("V1", xosc.TeleportAction(xosc.LanePosition(s=40, offset=0, lane_id="-1", road_id="1")))
    init.add_init_action("V1", xosc.AbsoluteSpeedAction(15.6, at_once))
    return init


def world_position_heading() -> xosc.TeleportAction:
    """Place an actor at world coordinates with a heading

    absolute x y position heading radians counter-clockwise from east
    """
    return xosc.TeleportAction(xosc.WorldPosition(x=-62.5, y=-1.6, z=0, h=0.0, p=0, r=0))


def timed_trajectory() -> xosc.FollowTrajectoryAction:
    """Follow a trajectory of timed world positions: the same motion in every player

    polyline vertices times follow path exact timing replay absolute time reference
    """
    times = [0.0, 0.5, 1.0, 1.5]
    places = [xosc.WorldPosition(x=15.6 * t, y=-1.6, z=0, h=0, p=0, r=0) for t in times]
    path = xosc.Trajectory("V1_path", closed=False)
    path.add_shape(xosc.Polyline(times, places))
    return xosc.FollowTrajectoryAction(path, xosc.FollowingMode.position, xosc.ReferenceContext.absolute, 1, 0)


def start_at_time() -> xosc.ValueTrigger:
    """Start something at a simulation time

    after some seconds delay begin event trigger when time is greater than start condition edge none
    """
    condition = xosc.SimulationTimeCondition(2.0, xosc.Rule.greaterOrEqual)
    return xosc.ValueTrigger("start", 0, xosc.ConditionEdge.none, condition)


def event_in_maneuver() -> xosc.Maneuver:
    """Put an action and its trigger into an event, the event into a maneuver

    add event add action add trigger priority override
    """
    brake = xosc.AbsoluteSpeedAction(
        0, xosc.TransitionDynamics(xosc.DynamicsShapes.linear, xosc.DynamicsDimension.rate, 6)
    )
    event = xosc.Event("brake_event", xosc.Priority.override)
    time = xosc.SimulationTimeCondition(3.0, xosc.Rule.greaterThan)
    event.add_trigger(xosc.ValueTrigger("brake_start", 0, xosc.ConditionEdge.none, time))
    event.add_action("brake", brake)
    maneuver = xosc.Maneuver("V1_maneuver")
    maneuver.add_event(event)
    return maneuver


def storyboard_nesting() -> xosc.StoryBoard:
    """Nest storyboard, story, act, maneuver group and maneuver

    structure hierarchy of a scenario init story act group actor stop trigger end of the simulation
    """
    group = xosc.ManeuverGroup("V1_group")
    group.add_actor("V1")
    group.add_maneuver(event_in_maneuver())
    start = xosc.ValueTrigger(
        "start", 0, xosc.ConditionEdge.none, xosc.SimulationTimeCondition(0, xosc.Rule.greaterOrEqual)
    )
    act = xosc.Act("act", start)
    act.add_maneuver_group(group)
    story = xosc.Story("crash")
    story.add_act(act)
    end = xosc.SimulationTimeCondition(20, xosc.Rule.greaterThan)
    stop = xosc.ValueTrigger("end", 0, xosc.ConditionEdge.none, end, triggeringpoint="stop")
    board = xosc.StoryBoard(initial_position_and_speed(), stop)
    board.add_story(story)
    return board


def lane_change() -> xosc.AbsoluteLaneChangeAction:
    """Change to another lane within a time

    make vehicle change lane left right target lane id sinusoidal duration
    """
    dynamics = xosc.TransitionDynamics(xosc.DynamicsShapes.sinusoidal, xosc.DynamicsDimension.time, 3)
    return xosc.AbsoluteLaneChangeAction(-1, dynamics)


def drift_off_the_lane() -> xosc.AbsoluteLaneOffsetAction:
    """Drift sideways out of the lane, as when crossing the centerline or leaving the road

    lane offset run off road departure swerve lateral
    """
    return xosc.AbsoluteLaneOffsetAction(3.5, xosc.DynamicsShapes.sinusoidal, maxlatacc=2.0)


def brake_when_close() -> xosc.Event:
    """Brake when the distance to another actor falls below a limit

    decelerate relative distance condition vehicle ahead slow down hard small gap freespace entity trigger
    """
    near = xosc.RelativeDistanceCondition(12, xosc.Rule.lessThan, xosc.RelativeDistanceType.longitudinal, "V2")
    event = xosc.Event("brake", xosc.Priority.override)
    event.add_trigger(xosc.EntityTrigger("near", 0, xosc.ConditionEdge.none, near, "V1"))
    stop = xosc.TransitionDynamics(xosc.DynamicsShapes.linear, xosc.DynamicsDimension.rate, 7)
    event.add_action("stop", xosc.AbsoluteSpeedAction(0, stop))
    return event


def time_to_collision_trigger() -> xosc.EntityTrigger:
    """Trigger on time to collision with every attribute set, since players differ in their defaults

    TTC condition imminent crash reaction
    """
    condition = xosc.TimeToCollisionCondition(
        1.5, xosc.Rule.lessThan, alongroute=False, freespace=True, entity="V2",
        distance_type=xosc.RelativeDistanceType.euclidianDistance, coordinate_system=xosc.CoordinateSystem.entity,
        routing_algorithm=xosc.RoutingAlgorithm.undefined,
    )  # fmt: skip
    return xosc.EntityTrigger("ttc", 0, xosc.ConditionEdge.none, condition, "V1")


def stop_at_collision() -> xosc.EntityTrigger:
    """End the scenario when two actors collide

    collision condition contact stop trigger
    """
    return xosc.EntityTrigger(
        "crash", 0, xosc.ConditionEdge.none, xosc.CollisionCondition("V2"), "V1", triggeringpoint="stop"
    )


def start_after_another_event() -> xosc.ValueTrigger:
    """Start when another event has ended

    chain of events storyboard element state condition complete end transition sequence
    """
    state = xosc.StoryboardElementStateCondition(
        xosc.StoryboardElementType.event, "brake_event", xosc.StoryboardElementState.completeState
    )
    return xosc.ValueTrigger("after", 0, xosc.ConditionEdge.none, state)


def route_through_junction() -> xosc.AssignRouteAction:
    """Send an actor along a route through a junction

    turn left right waypoints assign route shortest
    """
    route = xosc.Route("left_turn", closed=False)
    route.add_waypoint(xosc.LanePosition(s=10, offset=0, lane_id="-1", road_id="1"), xosc.RouteStrategy.shortest)
    route.add_waypoint(xosc.LanePosition(s=30, offset=0, lane_id="-1", road_id="3"), xosc.RouteStrategy.shortest)
    return xosc.AssignRouteAction(route)


def rain_at_night() -> xosc.EnvironmentAction:
    """Set weather, time of day and a wet road

    environment rain snow fog night dark dusk light precipitation friction wetness surface
    """
    weather = xosc.Weather(
        xosc.FractionalCloudCover.eightOktas,
        sun=xosc.Sun(intensity=0, azimuth=0, elevation=-0.5),
        fog=xosc.Fog(2000),
        precipitation=xosc.Precipitation(xosc.PrecipitationType.rain, 4.0),
    )
    night = xosc.TimeOfDay(False, 2004, 11, 5, 22, 30, 0)
    wet = xosc.RoadCondition(0.6, wetness=xosc.Wetness.wetWithPuddles)
    return xosc.EnvironmentAction(xosc.Environment("night", night, weather, wet))


def keep_distance() -> xosc.LongitudinalDistanceAction:
    """Follow another vehicle at a time gap

    car following headway distance lead vehicle
    """
    return xosc.LongitudinalDistanceAction("V2", freespace=True, continuous=True, timeGap=1.8, max_deceleration=6)


def whole_scenario() -> xosc.Scenario:
    """Put entities, storyboard and road network together and write the file

    save xosc write xml complete scenario header author road file OpenSCENARIO version minor
    """
    return xosc.Scenario(
        "crash",
        "author",
        xosc.ParameterDeclarations(),
        vehicle_with_bounding_box(),
        storyboard_nesting(),
        xosc.RoadNetwork("road.xodr"),
        xosc.Catalog(),
        osc_minor_version=2,
    )  # fmt: skip; .write_xml("scenario.xosc") writes the file
