"""Written scenario files: valid, deterministic, and played exactly as they were planned."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scenariogeneration.xosc.enumerations import VersionBase

from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.openscenario.check import xosc_findings
from sgcad_core.formats.openscenario.playing.player import entity_boxes, play
from sgcad_core.formats.openscenario.playing.timed_motion import BLOW_MPS2
from sgcad_core.formats.openscenario.writing.entities import center_ahead_m
from sgcad_core.formats.openscenario.writing.writer import library_version, write_xosc
from sgcad_core.formats.xml import parse_xml
from sgcad_core.geometry.plane import wrap_angle
from sgcad_core.kinds import ACTORS
from tests.sgcad_core.formats.xosc_samples import CROSSING, actor, trajectory

K = np.arange(60)


def moving(name, turn=0.1):
    heading = turn * K * 0.05
    return trajectory(name, np.cumsum(0.5 * np.cos(heading)), np.cumsum(0.5 * np.sin(heading)), heading)


@pytest.mark.parametrize("kind", ACTORS)
def test_every_kind_of_actor_has_its_true_box(kind):
    text = write_xosc([actor("V1", kind, (3.21, 1.23))], [moving("V1")], None)
    assert xosc_findings(text, None) == []
    ahead = center_ahead_m(actor("V1", kind, (3.21, 1.23)))
    assert tuple(entity_boxes(text)["V1"]) == pytest.approx((3.21, 1.23, ahead, 0.0), abs=1e-6)


@pytest.mark.parametrize("kind", ACTORS)
def test_a_vehicles_origin_is_its_rear_axle_and_others_stand_on_their_centers(kind):
    length = ACTORS[kind].length_m
    root = parse_xml(write_xosc([actor("V1", kind, ACTORS[kind].size)], [moving("V1")], None), "xosc")
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


SPEEDS = st.lists(st.floats(2.5, 40), min_size=2, max_size=40)
STARTS = st.tuples(st.floats(-900, 900), st.floats(-900, 900), st.floats(-7, 7))


def driven(start, along, turn):
    """A trajectory from a start pose with speeds and a turn rate a step."""
    heading = start[2] + np.cumsum(np.full(len(along), turn * 0.05))
    step = np.array(along) * 0.05
    x = start[0] + np.concatenate(([0.0], np.cumsum(step * np.cos(heading))))
    y = start[1] + np.concatenate(([0.0], np.cumsum(step * np.sin(heading))))
    return trajectory("V1", x, y, np.append(heading, heading[-1]))


@settings(max_examples=60, deadline=None)
@given(start=STARTS, along=SPEEDS, turn=st.floats(-1, 1), way=st.sampled_from([-1, 0, 1]))
def test_a_played_file_is_what_was_written(start, along, turn, way):
    wanted = driven(start, np.array(along) * way, turn * abs(way))
    other = trajectory("V2", -wanted.x_m, wanted.y_m)
    first, second = play(write_xosc([actor("V1"), actor("V2")], [wanted, other], None))
    for played, given_ in ((first, wanted), (second, other)):
        assert played.actor == given_.actor
        np.testing.assert_allclose(played.t_s, given_.t_s, atol=1e-9)
        np.testing.assert_allclose(played.x_m, given_.x_m, atol=1e-5)
        np.testing.assert_allclose(played.y_m, given_.y_m, atol=1e-5)
        np.testing.assert_allclose(wrap_angle(played.heading_rad - given_.heading_rad), 0, atol=1e-7)
        steps = np.hypot(np.diff(given_.x_m), np.diff(given_.y_m)) / 0.05
        change = np.abs(np.diff(steps, prepend=steps[0], append=steps[-1]))
        smooth = change < 0.9 * BLOW_MPS2 * 0.05  # at a blow it is the speed before it
        np.testing.assert_allclose(played.speed_mps[smooth], given_.speed_mps[smooth], atol=1e-3)


@settings(max_examples=60, deadline=None)
@given(start=STARTS, along=st.lists(st.floats(-2.2, 2.2), min_size=2, max_size=60), turn=st.floats(-3, 3))
def test_what_is_left_out_of_slow_motion_moves_no_box_by_a_hand(start, along, turn):
    """Slow: up to 2.2 m/s, where rows are nearer than players keep; a step and what is merged are 0.11 m each."""
    wanted = driven(start, along, turn)
    (played,) = play(write_xosc([actor("V1")], [wanted], None))
    assert np.hypot(played.x_m - wanted.x_m, played.y_m - wanted.y_m).max() < 0.25


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


# ------------------------------------------------------------------ versions
VERSIONS = ("1.0", "1.1", "1.2", "1.3")
KINDS = {"V1": "car", "V2": "truck", "P1": "pedestrian", "B1": "bicycle", "T1": "trailer", "O1": "object"}


@pytest.mark.parametrize("surroundings", ["dark", "rain", "ice", "all", "none"])
@pytest.mark.parametrize("version", VERSIONS)
def test_every_version_passes_its_schema_and_plays_alike(version, surroundings):
    behavior = {
        "dark": CROSSING.model_copy(update={"light": "dark", "weather": None, "surface": None}),
        "rain": CROSSING.model_copy(update={"light": None, "weather": "rain", "surface": None}),
        "ice": CROSSING.model_copy(update={"light": None, "weather": None, "surface": "ice"}),
        "all": CROSSING,
        "none": None,
    }[surroundings]
    actors = [actor(name, kind) for name, kind in KINDS.items()]
    moves = [moving(name, 0.1 * k) for k, name in enumerate(KINDS)]
    text = write_xosc(actors, moves, behavior, version=version)
    assert f'revMinor="{version[-1]}"' in text
    assert xosc_findings(text, None) == []
    assert ("EnvironmentAction" in text) == (behavior is not None)
    for played, other in zip(play(text), play(write_xosc(actors, moves, None)), strict=True):
        assert played.actor == other.actor
        for column in ("t_s", "x_m", "y_m", "heading_rad", "speed_mps"):
            np.testing.assert_array_equal(getattr(played, column), getattr(other, column))


def test_the_oldest_version_completes_what_the_behavior_leaves_open():
    """Its schema has no room for an open light or surface."""
    only_ice = CROSSING.model_copy(update={"light": None, "weather": None, "surface": "ice"})
    text = write_xosc([actor("V1")], [moving("V1")], only_ice, version="1.0")
    assert 'dateTime="2005-06-21T12:00:00"' in text
    assert 'cloudState="free"' in text
    assert 'frictionScaleFactor="0.15"' in text


def test_versions_written_at_one_time_do_not_mix():
    def write(version):
        return write_xosc([actor("V1")], [moving("V1")], CROSSING, version=version)

    with ThreadPoolExecutor(8) as threads:
        for version, text in zip(VERSIONS * 8, threads.map(write, VERSIONS * 8), strict=True):
            assert text == write(version)


def test_the_end_is_a_parameter_of_the_file():
    text = write_xosc([actor("V1")], [moving("V1")], None)
    assert 'name="EndTime" parameterType="double" value="2.95"' in text
    short = text.replace('value="2.95"', 'value="1.5"')
    assert play(short)[0].t_s[-1] == pytest.approx(1.5)


def test_a_file_of_an_old_version_leaves_the_librarys_version_as_it_was():
    before = VersionBase.version_minor
    with library_version(0):
        assert VersionBase.version_minor == 0
    assert VersionBase.version_minor == before
    with pytest.raises(ZeroDivisionError), library_version(0):
        raise ZeroDivisionError
    assert VersionBase.version_minor == before
