"""Whatever a stranger's file says, nothing but our own errors leaves the player, in bounded time and memory."""

from __future__ import annotations

import contextlib
import re
import time
import tracemalloc

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.errors import InvalidOutput, SgcadError
from sgcad_core.formats.opendrive.checks.road_index import lane_index
from sgcad_core.formats.openscenario.playing.player import play, play_scenario
from sgcad_core.formats.openscenario.reading.elements import MAX_VALUE_CHARACTERS, read_root
from sgcad_core.formats.openscenario.reading.file_context import FileContext
from sgcad_core.formats.openscenario.reading.variation import ParameterSets
from sgcad_core.formats.openscenario.roads.road_network import XodrRoads
from tests.sgcad_core.formats.xosc_samples import at, crossroads, event, lane, scenario, when, world

EDGES = lane_index(crossroads().xodr)
WEST = EDGES.by_edge("W").id
PLACE = lane(WEST, -1, 60)
ROUTE = f'<Route name="r" closed="false"><Waypoint routeStrategy="shortest">{lane(WEST, -1, 5)}</Waypoint></Route>'
ACTIONS = [
    '<LongitudinalAction><SpeedProfileAction followingMode="position"><SpeedProfileEntry time="1" speed="9"/>'
    '<SpeedProfileEntry speed="4"/></SpeedProfileAction></LongitudinalAction>',
    '<LongitudinalAction><LongitudinalDistanceAction entityRef="V2" distance="9" continuous="true" freespace="true"/>'
    "</LongitudinalAction>",
    '<LateralAction><LaneOffsetAction continuous="false"><LaneOffsetActionDynamics dynamicsShape="sinusoidal" '
    'maxLateralAcc="2"/><LaneOffsetTarget><AbsoluteTargetLaneOffset value="0.5"/></LaneOffsetTarget>'
    "</LaneOffsetAction></LateralAction>",
    f'<SynchronizeAction masterEntityRef="V2"><TargetPositionMaster>{PLACE[10:-11]}</TargetPositionMaster>'
    f'<TargetPosition>{PLACE[10:-11]}</TargetPosition><FinalSpeed><AbsoluteSpeed value="5"/></FinalSpeed>'
    "</SynchronizeAction>",
    f"<RoutingAction><AssignRouteAction>{ROUTE}</AssignRouteAction></RoutingAction>",
    '<RoutingAction><FollowTrajectoryAction><TrajectoryRef><Trajectory name="t" closed="false"><Shape>'
    f'<Clothoid curvature="0.01" curvatureDot="0.001" length="30">{world(0, 0)}</Clothoid></Shape></Trajectory>'
    '</TrajectoryRef><TimeReference><None/></TimeReference><TrajectoryFollowingMode followingMode="follow"/>'
    "</FollowTrajectoryAction></RoutingAction>",
    '<RoutingAction><FollowTrajectoryAction><TrajectoryRef><Trajectory name="n" closed="false"><Shape>'
    f'<Nurbs order="2"><ControlPoint weight="1">{world(0, 0)}</ControlPoint><ControlPoint>{world(9, 0)}</ControlPoint>'
    '<Knot value="0"/><Knot value="0"/><Knot value="1"/><Knot value="1"/></Nurbs></Shape></Trajectory></TrajectoryRef>'
    "<TimeReference><None/></TimeReference></FollowTrajectoryAction></RoutingAction>",
]
CONDITIONS = [
    '<TimeHeadwayCondition entityRef="V2" value="9" freespace="false" rule="lessThan" coordinateSystem="road" '
    'relativeDistanceType="longitudinal"/>',
    '<TimeToCollisionCondition value="3" freespace="true" rule="lessThan"><TimeToCollisionConditionTarget>'
    '<EntityRef entityRef="V2"/></TimeToCollisionConditionTarget></TimeToCollisionCondition>',
    '<AccelerationCondition value="1" rule="greaterThan" direction="total"/>',
    '<EndOfRoadCondition duration="0.1"/>',
    '<OffroadCondition duration="0.1"/>',
    '<RelativeClearanceCondition oppositeLanes="true" distanceForward="30" distanceBackward="9" freeSpace="true"/>',
    '<AngleCondition angleType="heading" angle="0" angleTolerance="0.1" coordinateSystem="road"/>',
]
EVENTS = "".join(event(f"a{i}", action, at(i / 4), "parallel") for i, action in enumerate(ACTIONS)) + "".join(
    event(f"c{i}", "<VisibilityAction/>", when(inner), "parallel", 2) for i, inner in enumerate(CONDITIONS)
)
RICH = scenario({"V1": lane(WEST, -1, 20), "V2": lane(WEST, -1, 40)}, EVENTS, {"V1": 8, "V2": 6}, at(3))
ROADS = XodrRoads(crossroads().xodr)
ODD = [
    "", "nan", "-INF", "1e400", "-1", "0", "1e9", "1e308", "-1e-9", "$", "${}", "${9**9**9}", "V9", "é", "1e8", "3.7",
]  # fmt: skip
VALUES = re.compile(r'="([^"]*)"')
TAG = re.compile(r"<[A-Z]\w*[^<>]*/>")


def survives(text, strict):
    started = time.perf_counter()
    with contextlib.suppress(SgcadError):
        played = play_scenario(read_root(text, book=FileContext("file.xosc", strict=strict)), ROADS, until_s=5.0)
        for motion in played.trajectories:
            assert all(np.isfinite(v).all() for v in (motion.x_m, motion.y_m, motion.heading_rad, motion.speed_mps))
    assert time.perf_counter() - started < 60


def test_the_sample_plays_whole():
    played = play_scenario(read_root(RICH, book=FileContext("file.xosc")), ROADS, until_s=5.0)
    assert len(played.trajectories[0].t_s) == 61
    assert any("followingMode 'follow'" in note.what for note in played.notes)


@settings(max_examples=120, deadline=None)
@given(st.lists(st.tuples(st.integers(0, 10_000), st.sampled_from(ODD)), min_size=1, max_size=3), st.booleans())
def test_odd_attribute_values_are_no_crash(changes, strict):
    text = RICH
    for at_, odd in changes:
        spots = list(VALUES.finditer(text))
        spot = spots[at_ % len(spots)]
        text = f'{text[: spot.start()]}="{odd}"{text[spot.end() :]}'
    survives(text, strict)


@settings(max_examples=80, deadline=None)
@given(st.integers(0, 10_000), st.integers(0, 10_000), st.booleans())
def test_missing_and_moved_elements_are_no_crash(first, second, strict):
    tags = list(TAG.finditer(RICH))
    gone, place = tags[first % len(tags)], tags[second % len(tags)]
    survives(RICH[: place.end()] + gone.group() + RICH[place.end() :], strict)
    survives(RICH[: gone.start()] + RICH[gone.end() :], strict)


@settings(max_examples=60, deadline=None)
@given(st.integers(0, 100_000), st.sampled_from(ODD))
def test_odd_maps_are_no_crash(at_, odd):
    text = crossroads().xodr
    spots = list(VALUES.finditer(text))
    spot = spots[at_ % len(spots)]
    with contextlib.suppress(SgcadError):
        play_scenario(read_root(RICH), XodrRoads(f'{text[: spot.start()]}="{odd}"{text[spot.end() :]}'), until_s=5.0)


# ------------------------------------------------------------------ bombs
@pytest.mark.parametrize("doubled", ["$p{0}$p{0}", "$p{0}$p{0}$p{0}$p{0}$p{0}$p{0}$p{0}$p{0}"])
def test_parameters_that_double_take_no_memory(doubled):
    declared = '<ParameterDeclaration name="p0" parameterType="string" value="xxxxxxxxxx"/>' + "".join(
        f'<ParameterDeclaration name="p{i}" parameterType="string" value="{doubled.format(i - 1)}"/>'
        for i in range(1, 40)
    )
    tracemalloc.start()
    with pytest.raises(InvalidOutput, match=rf"longer than {MAX_VALUE_CHARACTERS} characters .*<ParameterDeclaration"):
        play(scenario({"V1": world(0, 0)}, parameters=declared))
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert peak < 20e6


def test_one_attribute_of_many_parameters_is_bounded_too():
    declared = f'<ParameterDeclaration name="p" parameterType="string" value="{"x" * 5000}"/>'
    with pytest.raises(InvalidOutput, match="longer than 10000 characters"):
        play(scenario({"V1": world(0, 0)}, speeds={"V1": "$p" * 10_000}, parameters=declared))


def test_a_range_of_billions_is_refused():
    inner = (
        '<OpenSCENARIO><ParameterValueDistribution><ScenarioFile filepath="x"/><Deterministic>'
        '<DeterministicSingleParameterDistribution parameterName="v"><DistributionRange stepWidth="1e-9">'
        '<Range lowerLimit="0" upperLimit="1e9"/></DistributionRange></DeterministicSingleParameterDistribution>'
        "</Deterministic></ParameterValueDistribution></OpenSCENARIO>"
    )
    with pytest.raises(InvalidOutput, match="needs 1 to 10000 values"):
        ParameterSets(read_root(inner))
