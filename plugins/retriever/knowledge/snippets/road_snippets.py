"""OpenDRIVE in Python, piece by piece; every function runs as it stands and its body is shown to a model.

A docstring's first line is the title, the rest other words for the same thing. Knows nothing of the project.
"""

from __future__ import annotations

from scenariogeneration import xodr


def straight_road() -> xodr.OpenDrive:
    """Make a straight two-way road

    line geometry one lane each way create road length
    """
    road = xodr.create_road(xodr.Line(200), id=1, left_lanes=1, right_lanes=1, lane_width=3.5)
    drive = xodr.OpenDrive("straight")
    drive.add_road(road)
    drive.adjust_roads_and_lanes()
    return drive


def curved_road() -> xodr.OpenDrive:
    """Make a curved road with easy ends

    bend curve spiral clothoid arc curvature radius
    """
    curvature = 1 / 180
    pieces = [
        xodr.Line(80), xodr.Spiral(1e-9, curvature, 30), xodr.Arc(curvature, length=90),
        xodr.Spiral(curvature, 1e-9, 30), xodr.Line(80),
    ]  # fmt: skip
    drive = xodr.OpenDrive("curve")
    drive.add_road(xodr.create_road(pieces, id=1, left_lanes=1, right_lanes=1))
    drive.adjust_roads_and_lanes()
    return drive


def one_way_road() -> xodr.OpenDrive:
    """Make a one-way road with two lanes

    no lanes in the opposite direction left lanes zero
    """
    drive = xodr.OpenDrive("one_way")
    drive.add_road(xodr.create_road(xodr.Line(150), id=1, left_lanes=0, right_lanes=2))
    drive.adjust_roads_and_lanes()
    return drive


def four_leg_junction() -> xodr.OpenDrive:
    """Make a four-leg junction of two-lane roads

    intersection crossing cross roads junction creator circular geometry connection
    """
    roads = [xodr.create_road(xodr.Line(100), id=i, left_lanes=1, right_lanes=1) for i in range(4)]
    junction = xodr.CommonJunctionCreator(id=100, name="hub", startnum=200)
    for number, road in enumerate(roads):
        junction.add_incoming_road_circular_geometry(road, 20, number * 3.14159265 / 2, "successor")
    for one in range(4):
        for two in range(one + 1, 4):
            junction.add_connection(road_one_id=one, road_two_id=two)
    drive = xodr.OpenDrive("four_legs")
    for road in roads:
        drive.add_road(road)
    drive.add_junction_creator(junction)
    drive.adjust_roads_and_lanes()
    return drive


def t_junction() -> xodr.OpenDrive:
    """Make a T-junction: a side road ends at a through road

    three legs T-intersection junction creator side street
    """
    angles = (0.0, 3.14159265, 4.71238898)
    roads = [xodr.create_road(xodr.Line(100), id=i, left_lanes=1, right_lanes=1) for i in range(3)]
    junction = xodr.CommonJunctionCreator(id=100, name="hub", startnum=200)
    for road, angle in zip(roads, angles, strict=True):
        junction.add_incoming_road_circular_geometry(road, 20, angle, "successor")
    for one, two in ((0, 1), (0, 2), (1, 2)):
        junction.add_connection(road_one_id=one, road_two_id=two)
    drive = xodr.OpenDrive("t_junction")
    for road in roads:
        drive.add_road(road)
    drive.add_junction_creator(junction)
    drive.adjust_roads_and_lanes()
    return drive


def added_turn_lane() -> xodr.OpenDrive:
    """Add a lane along the way, such as a turn lane

    lane widening left turn bay pocket split merge LaneDef number of lanes changes
    """
    right = [xodr.LaneDef(s_start=60, s_end=90, n_lanes_start=1, n_lanes_end=2, sub_lane=-1)]
    drive = xodr.OpenDrive("turn_lane")
    drive.add_road(xodr.create_road(xodr.Line(150), id=1, left_lanes=1, right_lanes=right))
    drive.adjust_roads_and_lanes()
    return drive


def speed_limit() -> xodr.OpenDrive:
    """Give a road its type and speed limit

    mph posted limit road type town rural motorway
    """
    road = xodr.create_road(xodr.Line(200), id=1, left_lanes=2, right_lanes=2)
    road.add_type(xodr.RoadType.town, 0, "US", speed=35, speed_unit="mph")
    drive = xodr.OpenDrive("limit")
    drive.add_road(road)
    drive.adjust_roads_and_lanes()
    return drive


def stop_sign_and_object() -> xodr.OpenDrive:
    """Place a sign and an object beside a road

    stop sign traffic light signal pole guardrail barrier object orientation
    """
    road = xodr.create_road(xodr.Line(120), id=1, left_lanes=1, right_lanes=1)
    road.add_signal(xodr.Signal(s=115, t=-4.5, country="US", Type="R1-1", id="1", name="stop"))
    road.add_object(xodr.Object(s=60, t=-6, Type=xodr.ObjectType.pole, id="2", height=8, radius=0.2))
    drive = xodr.OpenDrive("signs")
    drive.add_road(road)
    drive.adjust_roads_and_lanes()
    return drive


def linked_roads() -> xodr.OpenDrive:
    """Join two roads end to end

    predecessor successor link chain of roads continue
    """
    first = xodr.create_road(xodr.Line(100), id=1)
    second = xodr.create_road(xodr.Arc(0.01, length=60), id=2)
    first.add_successor(xodr.ElementType.road, 2, xodr.ContactPoint.start)
    second.add_predecessor(xodr.ElementType.road, 1, xodr.ContactPoint.end)
    drive = xodr.OpenDrive("linked")
    drive.add_road(first)
    drive.add_road(second)
    drive.adjust_roads_and_lanes()
    return drive
