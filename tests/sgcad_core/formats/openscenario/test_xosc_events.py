"""The second encoding of a plan: events that people edit play the same crash, near the plan until the contact."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.errors import InvalidOutput
from sgcad_core.execution.contact import realised
from sgcad_core.execution.event_encoding import ASTRAY_M
from sgcad_core.execution.playback import execution_of
from sgcad_core.execution.scenario import compile_scenario
from sgcad_core.formats.openscenario.check import xosc_findings
from sgcad_core.formats.openscenario.playing.player import play
from sgcad_core.formats.openscenario.writing.events import EventOptions
from sgcad_core.formats.openscenario.writing.pacing import NEAR_M, pieces
from sgcad_core.formats.openscenario.writing.writer import write_xosc
from sgcad_core.formats.xml import parse_xml
from sgcad_core.geometry.plane import arc_lengths
from sgcad_core.records.specs import Actor, BehaviorSpec, Contact
from tests.sgcad_core.formats.xosc_samples import CROSSING, actor, crossroads, trajectory

T_S = np.arange(81) * 0.05
REAR_END = BehaviorSpec(
    actors=(
        Actor(id="V1", kind="car", road="S", direction="forward", maneuver="straight", speed_mph=35),
        Actor(id="V2", kind="car", road="S", direction="forward", maneuver="stopped"),
    ),
    contacts=(Contact(striker="V1", struck="V2", striker_area="front", struck_area="back"),),
)
BACKING = BehaviorSpec(
    actors=(
        Actor(id="V1", kind="car", road="S", direction="forward", maneuver="backing", speed_mph=5),
        Actor(id="V2", kind="car", road="S", direction="forward", maneuver="stopped"),
    ),
    contacts=(Contact(striker="V1", struck="V2", striker_area="back", struck_area="front"),),
)


def away(scenario, played, until_s):
    """Largest distance of any box center from the plan until a time."""
    gaps = []
    for wanted, seen in zip(scenario.planned, played, strict=True):
        n = int(np.searchsorted(wanted.t_s, until_s + 1e-6))
        gaps.append(np.hypot(wanted.x_m[:n] - seen.x_m[:n], wanted.y_m[:n] - seen.y_m[:n]).max())
    return max(gaps)


@pytest.mark.parametrize("version", ["1.0", "1.1", "1.2", "1.3"])
@pytest.mark.parametrize("behavior", [CROSSING, REAR_END, BACKING], ids=["crossing", "rear_end", "backing"])
def test_both_encodings_give_the_declared_contact(behavior, version):
    for encoding in ("timed", "events"):
        scenario = compile_scenario(behavior, crossroads(), version, encoding)
        assert xosc_findings(scenario.xosc, crossroads().xodr) == []
        played = play(scenario.xosc, crossroads().xodr)
        seen = execution_of("player", scenario, played)
        assert realised(scenario.declared, seen.contact)
        assert away(scenario, played, seen.contact.t_s - 0.1) <= (ASTRAY_M if encoding == "events" else 1e-3)


def test_who_meets_brakes_and_comes_to_rest():
    scenario = compile_scenario(REAR_END, crossroads(), encoding="events")
    striker = play(scenario.xosc, crossroads().xodr)[0]
    contact_s = execution_of("player", scenario, play(scenario.xosc, crossroads().xodr)).contact.t_s
    at = int(np.searchsorted(striker.t_s, contact_s + 1e-6))
    assert striker.speed_mps[at - 2] > 2.0
    assert np.diff(striker.speed_mps[at + 1 :]).max() <= 1e-9  # slower and slower
    assert striker.speed_mps[min(at + 60, len(striker.t_s) - 1)] < striker.speed_mps[at]


def test_events_are_few_and_start_in_lanes():
    scenario = compile_scenario(CROSSING, crossroads(), encoding="events")
    root, timed = parse_xml(scenario.xosc, "xosc"), compile_scenario(CROSSING, crossroads()).xosc
    assert len(list(root.iterfind(".//Init//LanePosition"))) >= 2
    assert len(list(root.iterfind(".//Event"))) <= 8 * len(CROSSING.actors)
    assert scenario.xosc.count("<Vertex") < timed.count("<Vertex") / 3
    assert root.find(".//TimeReference/Timing") is None
    assert len(list(root.iterfind(".//CollisionCondition"))) == 2


def test_who_keeps_a_straight_lane_needs_no_path():
    s = T_S * 12
    car, move = actor("V1"), trajectory("V1", 1.8 + 0 * s, -110 + s, np.pi / 2)
    text = write_xosc([car], [move], None, handover=EventOptions(None, crossroads().xodr))
    assert "FollowTrajectoryAction" not in text
    assert "LanePosition" in text
    assert xosc_findings(text, crossroads().xodr) == []
    seen = play(text, crossroads().xodr)[0]
    n = min(len(seen.t_s), len(move.t_s))
    assert np.hypot(seen.x_m[:n] - move.x_m[:n], seen.y_m[:n] - move.y_m[:n]).max() < 0.05


def test_without_a_road_places_are_those_of_the_world():
    text = write_xosc([actor("V1")], [trajectory("V1", T_S * 10, 0.0)], None, handover=EventOptions())
    assert "LanePosition" not in text
    assert play(text)[0].x_m[-1] == pytest.approx(40.0, abs=0.1)


def test_everybody_may_stand():
    text = write_xosc([actor("V1")], [trajectory("V1", T_S * 0 + 3, 4.0)], None, handover=EventOptions())
    assert xosc_findings(text, None) == []
    np.testing.assert_allclose(play(text)[0].x_m, 3.0, atol=1e-5)


def test_what_the_timed_encoding_refuses_is_refused():
    with pytest.raises(InvalidOutput, match="rising times"):
        write_xosc([actor("V1")], [trajectory("V1", [0.0], 0.0)], None, handover=EventOptions())


@settings(max_examples=40, deadline=None)
@given(st.lists(st.floats(0, 30), min_size=2, max_size=6))
def test_pieces_of_speed_lead_where_the_motion_leads(speeds):
    """Speeds every 1 s, evenly between: as few pieces as there are, never backwards."""
    t_s = np.arange(20 * (len(speeds) - 1) + 1) * 0.05
    wanted = np.interp(t_s, np.arange(len(speeds)), speeds)
    along = np.concatenate(([0.0], np.cumsum((wanted[1:] + wanted[:-1]) / 2 * 0.05)))
    times, found = pieces(t_s, along)
    assert (found >= 0).all()
    assert len(times) <= 4 * len(speeds)
    speed = np.interp(t_s, times, found)
    gone = np.concatenate(([0.0], np.cumsum((speed[1:] + speed[:-1]) / 2 * 0.05)))
    assert np.abs(gone - along).max() <= NEAR_M + 1e-9


@settings(max_examples=25, deadline=None)
@given(st.lists(st.floats(3, 15), min_size=2, max_size=4), st.floats(-0.25, 0.25), st.floats(-3, 3))
def test_driven_lines_are_followed(speeds, turn, start):
    """Any ordinary motion: along arcs, at changing speeds."""
    speed = np.interp(T_S, np.linspace(0, T_S[-1], len(speeds)), speeds)
    heading = start + turn * T_S
    x, y = (np.concatenate(([0.0], np.cumsum((speed * f(heading))[:-1] * 0.05))) for f in (np.cos, np.sin))
    move = trajectory("V1", x, y, heading)
    seen = play(write_xosc([actor("V1")], [move], None, handover=EventOptions()))[0]
    n = min(len(seen.t_s), len(x))
    assert np.hypot(seen.x_m[:n] - x[:n], seen.y_m[:n] - y[:n]).max() < 0.15
    assert arc_lengths(np.column_stack((seen.x_m, seen.y_m)))[-1] > 5
