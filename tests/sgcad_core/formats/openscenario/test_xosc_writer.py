"""Written scenario files: valid, deterministic, and played exactly as they were planned."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.openscenario.check import xosc_findings
from sgcad_core.formats.openscenario.entities import center_ahead_m
from sgcad_core.formats.openscenario.player import entity_boxes, play
from sgcad_core.formats.openscenario.writer import write_xosc
from sgcad_core.formats.xml import parse_xml
from sgcad_core.geometry.plane import wrap_angle
from sgcad_core.specs import SIZE_M
from tests.sgcad_core.formats.xosc_samples import CROSSING, actor, trajectory

K = np.arange(60)


def moving(name, turn=0.1):
    heading = turn * K * 0.05
    return trajectory(name, np.cumsum(0.5 * np.cos(heading)), np.cumsum(0.5 * np.sin(heading)), heading)


@pytest.mark.parametrize("kind", SIZE_M)
def test_every_kind_of_actor_has_its_true_box(kind):
    text = write_xosc([actor("V1", kind, (3.21, 1.23))], [moving("V1")], None)
    assert xosc_findings(text, None) == []
    ahead = center_ahead_m(actor("V1", kind, (3.21, 1.23)))
    assert tuple(entity_boxes(text)["V1"]) == pytest.approx((3.21, 1.23, ahead, 0.0), abs=1e-6)


@pytest.mark.parametrize("kind", SIZE_M)
def test_a_vehicles_origin_is_its_rear_axle_and_others_stand_on_their_centers(kind):
    length = SIZE_M[kind][0]
    root = parse_xml(write_xosc([actor("V1", kind, SIZE_M[kind])], [moving("V1")], None), "xosc")
    center = float(root.find(".//BoundingBox/Center").get("x"))
    axles = {axle.tag: float(axle.get("positionX")) for axle in root.iterfind(".//Axles/*")}
    if kind in ("pedestrian", "object"):
        assert (center, axles) == (0.0, {})
        return
    assert axles["RearAxle"] == 0.0
    assert 0.45 * length < axles["FrontAxle"] < 0.75 * length
    assert 0.2 * length < center < 0.35 * length
    assert center + length / 2 > axles["FrontAxle"]  # the front bumper lies ahead of the front axle


def test_a_combination_on_one_box_stands_on_its_last_axle():
    assert center_ahead_m(actor("V1", "truck", (20.0, 2.5))) == pytest.approx(10.0 - 2.5)


def test_the_file_holds_the_poses_of_the_rear_axle():
    wanted, car = moving("V1", 1.0), actor("V1", "car", (4.7, 1.8))
    root = parse_xml(write_xosc([car], [wanted], None), "xosc")
    places = list(root.iterfind(".//Vertex/Position/WorldPosition"))
    x, y, h = (np.array([float(p.get(name)) for p in places]) for name in "xyh")
    ahead = center_ahead_m(car)
    np.testing.assert_allclose(x + ahead * np.cos(h), wanted.x_m, atol=1e-5)
    np.testing.assert_allclose(y + ahead * np.sin(h), wanted.y_m, atol=1e-5)
    start = root.find(".//TeleportAction/Position/WorldPosition")
    assert (float(start.get("x")), float(start.get("y"))) == (x[0], y[0])


@pytest.mark.parametrize("light", [None, "day", "dusk", "dawn", "dark", "dark_lit"])
@pytest.mark.parametrize("weather", [None, "clear", "cloudy", "rain", "snow", "sleet", "fog"])
def test_surroundings_are_valid_however_much_is_stated(light, weather):
    for surface in (None, "dry", "wet", "snow", "ice"):
        behavior = CROSSING.model_copy(update={"light": light, "weather": weather, "surface": surface})
        text = write_xosc([actor("V1")], [moving("V1")], behavior)
        assert xosc_findings(text, None) == []
        assert ("TimeOfDay" in text, "RoadCondition" in text) == (light is not None, surface is not None)
        assert ("fractionalCloudCover" in text) == (weather is not None)
        assert ("EnvironmentAction" in text) == any((light, weather, surface))


def test_surroundings_say_what_the_behavior_says():
    text = write_xosc([actor("V1")], [moving("V1")], CROSSING)
    assert 'dateTime="2005-06-21T23:00:00"' in text
    assert 'precipitationType="rain"' in text
    assert 'frictionScaleFactor="0.7" wetness="wetWithPuddles"' in text


def test_equal_scenarios_are_equal_files():
    assert write_xosc([actor("V1")], [moving("V1")], CROSSING) == write_xosc([actor("V1")], [moving("V1")], CROSSING)


def test_what_players_disagree_about_is_not_written():
    text = write_xosc([actor("V1")], [moving("V1")], None)
    assert text.count('conditionEdge="none"') == text.count("conditionEdge")
    assert 'domainAbsoluteRelative="absolute" scale="1.0" offset="0.0"' in text
    assert 'followingMode="position"' in text
    assert "LanePosition" not in text
    assert text.count("<Vertex ") == len(K)


def test_a_name_that_xml_cannot_hold_is_made_safe():
    text = write_xosc([actor("V1")], [moving("V1")], None, name='a\x00<"&\x0bz')
    assert 'description="a?&lt;&quot;&amp;?z"' in text
    assert xosc_findings(text, None) == []


SPEEDS = st.lists(st.floats(-40, 40), min_size=2, max_size=40)


@settings(max_examples=60, deadline=None)
@given(
    start=st.tuples(st.floats(-900, 900), st.floats(-900, 900), st.floats(-7, 7)),
    along=SPEEDS,
    turn=st.floats(-3, 3),
    still=st.booleans(),
)
def test_a_played_file_is_what_was_written(start, along, turn, still):
    heading = start[2] + np.cumsum(np.full(len(along), turn * 0.05))
    step = np.array(along) * 0.05 * (not still)
    x = start[0] + np.concatenate(([0.0], np.cumsum(step * np.cos(heading))))
    y = start[1] + np.concatenate(([0.0], np.cumsum(step * np.sin(heading))))
    wanted = trajectory("V1", x, y, np.append(heading, heading[-1]))
    other = trajectory("V2", -x, y)
    first, second = play(write_xosc([actor("V1"), actor("V2")], [wanted, other], None))
    for played, given_ in ((first, wanted), (second, other)):
        assert played.actor == given_.actor
        np.testing.assert_allclose(played.t_s, given_.t_s, atol=1e-9)
        np.testing.assert_allclose(played.x_m, given_.x_m, atol=1e-5)
        np.testing.assert_allclose(played.y_m, given_.y_m, atol=1e-5)
        np.testing.assert_allclose(wrap_angle(played.heading_rad - given_.heading_rad), 0, atol=1e-7)
        np.testing.assert_allclose(played.speed_mps, given_.speed_mps, atol=1e-3)


@pytest.mark.parametrize(
    ("actors", "moves", "message"),
    [
        (["V1", "V2"], ["V1"], "give each actor one"),
        (["V1"], ["V1", "V1"], "give each actor one"),
        ([], [], "give each actor one"),
        (["V1", "V1"], ["V1"], "give each actor one"),
    ],
)
def test_actors_and_trajectories_must_pair(actors, moves, message):
    with pytest.raises(InvalidOutput, match=message):
        write_xosc([actor(n) for n in actors], [moving(n) for n in moves], None)


@pytest.mark.parametrize("change", [{"x_m": np.full(60, np.nan)}, {"t_s": np.zeros(60)}, {"t_s": K * 0.05 - 1.0}])
def test_a_trajectory_that_no_player_follows_is_not_written(change):
    with pytest.raises(InvalidOutput, match="finite rows with rising times"):
        write_xosc([actor("V1")], [moving("V1").model_copy(update=change)], None)
