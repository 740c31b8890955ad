"""How strangers' actions move entities where the standard leaves it open, and where players agree."""

from __future__ import annotations

import numpy as np
import pytest

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.opendrive.geometry import Pose
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.formats.openscenario.playing.timed_motion import TimedMotion
from sgcad_core.formats.openscenario.reading.files import play_file, variations
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads
from tests.sgcad_core.formats.xosc_samples import (
    at,
    crossroads,
    event,
    follow,
    lane,
    row,
    scenario,
    speed_action,
    timing,
    v1,
    when,
    world,
)

SOUTH_LANE = lane("3", -1, 20)


def keep_distance(limits):
    return (
        '<LongitudinalAction><LongitudinalDistanceAction entityRef="V2" distance="10" freespace="false" '
        f'continuous="true">{limits}</LongitudinalDistanceAction></LongitudinalAction>'
    )


def chase(limits):
    """V1 is 60 m behind V2, both at 10 m/s, and is to come nearer."""
    places = {"V1": world(0, 0), "V2": world(60, 0)}
    return v1(scenario(places, event("e", keep_distance(limits), at(0)), {"V1": 10, "V2": 10}))


def test_a_kept_distance_obeys_the_entity_too():
    """The entity can do 12 m/s², the action allows 40."""
    motion = chase('<DynamicConstraints maxAcceleration="40" maxDeceleration="40" maxSpeed="50"/>')
    assert np.diff(motion.speed_mps).max() / 0.05 == pytest.approx(12.0, abs=1e-6)


def test_a_kept_distance_obeys_limits_of_jerk():
    motion = chase(
        '<DynamicConstraints maxAcceleration="5" maxDeceleration="5" maxSpeed="50" maxAccelerationRate="2" '
        'maxDecelerationRate="2"/>'
    )
    change = np.diff(motion.speed_mps) / 0.05
    assert np.diff(change[:20]).max() / 0.05 == pytest.approx(2.0, abs=1e-6)
    assert change.max() <= 5.0 + 1e-9


def offset(value, lateral=3.0):
    return (
        '<LateralAction><LaneOffsetAction continuous="false">'
        f'<LaneOffsetActionDynamics dynamicsShape="sinusoidal" maxLateralAcc="{lateral}"/><LaneOffsetTarget>'
        f'<AbsoluteTargetLaneOffset value="{value}"/></LaneOffsetTarget></LaneOffsetAction></LateralAction>'
    )


def test_the_speed_counts_along_the_lane_while_the_offset_changes():
    motion = v1(scenario({"V1": SOUTH_LANE}, event("e", offset(3), at(0)), {"V1": 10}), crossroads().xodr)
    assert abs(row(motion, 3)[1] - row(motion, 0)[1]) == pytest.approx(30.0, abs=0.02)
    assert abs(row(motion, 3)[0] - row(motion, 0)[0]) == pytest.approx(3.0, abs=0.02)


def test_an_action_across_the_road_needs_a_lane_in_our_files_and_is_left_out_of_strangers(tmp_path):
    text = scenario({"V1": world(500, 500)}, event("e", offset(1), at(1)), {"V1": 10})
    with pytest.raises(InvalidOutput, match="the entity is in no lane"):
        play(text, crossroads().xodr)
    (tmp_path / "road.xodr").write_text(crossroads().xodr)
    (tmp_path / "foreign.xosc").write_text(text)
    played, _ = play_file(variations(tmp_path / "foreign.xosc")[0], [], 0.05, 10.0)
    assert any(note.what == "the entity is in no lane" for note in played.notes)
    assert np.ptp(played.trajectories[0].y_m) == pytest.approx(0.0)


def test_who_is_beside_has_no_headway():
    """V2 stands beside V1 (0 m ahead), then V1 drives away from it: never ahead, so never so many seconds away."""
    headway = '<TimeHeadwayCondition entityRef="V2" value="0.1" freespace="false" rule="greaterThan"/>'
    text = scenario({"V1": world(0, 0), "V2": world(0, 3)}, event("e", speed_action(0), when(headway)), {"V1": 10})
    assert v1(text).speed_mps.min() == pytest.approx(10.0)


def test_timed_vertices_in_mode_follow_are_met_at_even_accelerations():
    """From 10 m/s to a place 5 m ahead in 1 s: evenly braked to a stand there."""
    path = follow([(0, 0, 0, 0), (1, 5, 0, 0), (2, 5, 0, 0)], timing()).replace(
        'followingMode="position"', 'followingMode="follow"'
    )
    motion = v1(scenario({"V1": world(0, 0)}, event("e", path, at(0)), {"V1": 10}))
    assert row(motion, 0.5)[0] == pytest.approx(3.75, abs=0.02)
    assert row(motion, 1.0)[0] == pytest.approx(5.0, abs=1e-6)


def test_who_would_have_to_turn_back_brakes_and_waits():
    times, points = np.array([0.0, 4.0]), np.array([[0.0, 0.0], [5.0, 0.0]])
    eased = TimedMotion(times, points, np.zeros(2), (0, 0.05)).eased(10.0, 0.05)
    way = np.array([eased.pose(step).x_m for step in range(81)])
    assert (np.diff(way) >= -1e-12).all()
    assert way[20] == pytest.approx(5.0)  # braked over 5 m from 10 m/s: 1 s
    assert way[-1] == pytest.approx(5.0)


def test_vertices_without_headings_face_along_each_piece():
    path = follow([(0, 0, 0, None), (1, 10, 0, None), (2, 10, 10, None)], timing())
    motion = v1(scenario({"V1": world(0, 0)}, event("e", path, at(0))))
    assert row(motion, 0.9)[2] == pytest.approx(0.0, abs=1e-6)
    assert row(motion, 1.1)[2] == pytest.approx(np.pi / 2, abs=1e-6)


@pytest.mark.parametrize("beside", ["shoulder", "border", "sidewalk"])
def test_what_lies_beside_is_road_and_no_lane_to_drive_in(beside):
    lanes = "".join(
        f'<lane id="{number}" type="{kind}"><width sOffset="0" a="4" b="0" c="0" d="0"/></lane>'
        for number, kind in ((-1, "driving"), (-2, beside), (-3, "none"))
    )
    roads = XodrRoads(
        '<OpenDRIVE><header revMajor="1" revMinor="6"/><road id="1" length="100" junction="-1"><planView>'
        '<geometry s="0" x="0" y="0" hdg="0" length="100"><line/></geometry></planView><lanes><laneSection s="0">'
        f'<center><lane id="0" type="none"/></center><right>{lanes}</right></laneSection></lanes></road></OpenDRIVE>'
    )
    assert roads.on_road(Pose(50.0, -6.0, 0.0))
    assert not roads.covers(Pose(50.0, -6.0, 0.0))
    assert not roads.on_road(Pose(50.0, -10.0, 0.0))


def test_a_distance_without_limits_is_held_from_the_first_moment():
    motion = chase("")
    assert row(motion, 0)[0] == pytest.approx(row(v1(scenario({"V1": world(50, 0)})), 0)[0])
    assert row(motion, 2)[0] == pytest.approx(row(motion, 0)[0] + 20.0)


@pytest.mark.parametrize("number", [-1, 1])
def test_a_place_on_a_route_is_in_the_lane_that_is_named(number):
    """Also in one whose traffic comes against the route."""
    way = f"<Waypoint routeStrategy='shortest'>{lane('3', -1, 20)}</Waypoint>"
    way += f"<Waypoint routeStrategy='shortest'>{lane('3', -1, 80)}</Waypoint>"
    place = (
        f'<Position><RoutePosition><RouteRef><Route name="r" closed="false">{way}</Route></RouteRef>'
        f'<InRoutePosition><FromLaneCoordinates laneId="{number}" pathS="10"/></InRoutePosition>'
        "</RoutePosition></Position>"
    )
    motions = [v1(scenario({"V1": where}), crossroads().xodr) for where in (place, lane("3", number, 30))]
    assert row(motions[0], 0)[:3] == pytest.approx(row(motions[1], 0)[:3])


WIDENING = (
    '<OpenDRIVE><header revMajor="1" revMinor="6"/><road id="7" length="100" junction="-1"><planView>'
    '<geometry s="0" x="0" y="0" hdg="0" length="100"><line/></geometry></planView><lanes><laneSection s="0">'
    '<center><lane id="0" type="none"/></center><right><lane id="-1" type="driving">'
    '<width sOffset="0" a="2" b="1" c="0" d="0"/></lane></right></laneSection></lanes></road></OpenDRIVE>'
)
"""Its only lane widens by 1 m per metre: the lane's line slants by half of that."""


@pytest.mark.parametrize(
    ("start", "action"),
    [
        (world(0, -4), follow([(None, 0, -4, 0), (None, 10, -4, 0)])),
        (lane("7", -1, 10, offset=2), speed_action(10)),
        (lane("7", -1, 10, offset=2), offset(0)),
    ],
    ids=["behind a trajectory", "from the start", "into another offset"],
)
def test_nobody_jumps_into_a_lane_that_slants(start, action):
    """Beside the line of such a lane, the nearest point of the line lies not across the road but further on or back."""
    motion = v1(scenario({"V1": start}, event("e", action, at(0)), {"V1": 10}, end=at(2)), WIDENING)
    assert np.diff(motion.x_m) == pytest.approx(0.45, abs=0.06), "0.5 m, along the road or the slant"
    assert np.abs(np.diff(motion.y_m)).max() < 0.35
