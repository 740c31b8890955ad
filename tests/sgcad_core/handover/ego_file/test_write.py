"""The ego's file: valid in every version, waits for its driver, and meets the crash where it is driven as told."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sgcad_core.errors import ConfigError
from sgcad_core.execution.contact import first_with
from sgcad_core.formats.openscenario.check import xosc_findings
from sgcad_core.formats.openscenario.playing.player import play_scenario
from sgcad_core.formats.openscenario.reading.elements import read_root
from sgcad_core.formats.openscenario.writing.header import Source
from sgcad_core.formats.openscenario.writing.versions import VERSIONS
from sgcad_core.formats.xml import parse_xml
from sgcad_core.handover.ego_file.cue import cue_of
from sgcad_core.handover.ego_file.ego import ego_motion
from sgcad_core.handover.ego_file.others import AFTER_S, motion_of
from sgcad_core.handover.ego_file.write import EgoFile, write_ego
from sgcad_core.handover.script import staging_for
from sgcad_core.records.specs import BehaviorSpec
from tests.sgcad_core.handover.scenes import crossing, rear_end

SOURCE = Source("made", "V1 front strikes V2 left", ("V1 speed = 10 -- a guess",))
WET = BehaviorSpec.model_validate(
    {
        "actors": [{"id": "V1", "kind": "car", "maneuver": "straight", "road": "A", "direction": "forward"}],
        "contacts": [],
        "surface": "wet",
        "light": "day",
    }
)


def parsed(xml):
    return parse_xml(xml, "made")


def text(made, ego, **more):
    return write_ego(staging_for(made, ego), EgoFile(SOURCE, **more))


def driven(made, ego, pace=1.0, late_s=0.0):
    """Tracks of the ego's file, the ego driven along its way from outside: as one more maneuver."""
    staging = staging_for(made, ego)
    move = ego_motion(staging, staging.contact_s)
    t = np.arange(0.0, 30.0, 0.05)
    at = np.clip((t - late_s) * pace, 0, move.t_s[-1])
    rows = zip(t, *(np.interp(at, move.t_s, v) for v in (move.x_m, move.y_m, move.heading_rad)), strict=True)
    vertices = "".join(
        f'<Vertex time="{a:.2f}"><Position><WorldPosition x="{x:.6f}" y="{y:.6f}" h="{h:.8f}"/></Position></Vertex>'
        for a, x, y, h in rows
    )
    group = f"""<ManeuverGroup name="driver" maximumExecutionCount="1"><Actors selectTriggeringEntities="false">
      <EntityRef entityRef="{ego}"/></Actors><Maneuver name="m"><Event name="e" priority="override"><Action name="a">
      <PrivateAction><RoutingAction><FollowTrajectoryAction><TrajectoryRef><Trajectory name="t" closed="false"><Shape>
      <Polyline>{vertices}</Polyline></Shape></Trajectory></TrajectoryRef><TimeReference><Timing
      domainAbsoluteRelative="absolute" scale="1" offset="0"/></TimeReference><TrajectoryFollowingMode
      followingMode="position"/></FollowTrajectoryAction></RoutingAction></PrivateAction></Action><StartTrigger>
      <ConditionGroup><Condition name="c" delay="0" conditionEdge="none"><ByValueCondition><SimulationTimeCondition
      value="0" rule="greaterOrEqual"/></ByValueCondition></Condition></ConditionGroup></StartTrigger></Event>
      </Maneuver></ManeuverGroup>"""
    whole = text(made, ego).replace("<ManeuverGroup name=", group + "<ManeuverGroup name=", 1)
    return {t.actor: t for t in play_scenario(read_root(whole), None).trajectories}


def met(made, ego, **how):
    tracks = driven(made, ego, **how)
    return first_with(tracks[ego], [t for name, t in tracks.items() if name != ego], made.sizes)


@pytest.mark.parametrize("version", VERSIONS)
@pytest.mark.parametrize("ego", ["V1", "V2"])
def test_file_is_valid_and_plays_in_every_version(version, ego):
    assert xosc_findings(text(crossing(), ego, version=version, behavior=WET), None) == []


def test_ego_has_start_speed_and_a_controller_slot_and_no_maneuver():
    root = parsed(text(crossing(), "V1"))
    slot = root.find("Entities/ScenarioObject[@name='V1']/ObjectController/Controller/Properties")
    assert {p.get("name"): p.get("value") for p in slot}["isEgo"] == "true"
    declared = {p.get("name"): p.get("value") for p in root.find("ParameterDeclarations")}
    assert float(declared["EgoSpeed"]) == pytest.approx(10.0)
    assert [e.get("entityRef") for e in root.findall("Storyboard/Story/Act/ManeuverGroup/Actors/EntityRef")] == ["V2"]


def test_nobody_moves_before_the_ego_does():
    undriven = {t.actor: t for t in play_scenario(read_root(text(crossing(), "V1")), None, until_s=3.0).trajectories}
    late = driven(crossing(), "V1", late_s=2.0)
    assert np.ptp(late["V2"].y_m[:38]) < 0.01
    assert undriven["V2"].y_m[-1] > undriven["V2"].y_m[0]  # an ego whose speed is set counts as driving


@pytest.mark.parametrize("ego", ["V1", "V2"])
def test_ego_driven_as_told_meets_the_crash_of_the_report(ego):
    made = crossing()
    seen = met(made, ego)
    assert seen.is_of(made.declared)
    assert seen.t_s == pytest.approx(staging_for(made, ego).contact.t_s, abs=0.1)


@settings(max_examples=15, deadline=None)
@given(late_s=st.floats(0.0, 6.0), own=st.floats(6.0, 20.0), other=st.floats(4.0, 20.0))
def test_crash_comes_later_where_the_ego_starts_later(late_s, own, other):
    made = crossing(own=own, other=other)
    seen = met(made, "V1", late_s=late_s)
    assert seen is not None
    assert seen.t_s == pytest.approx(staging_for(made, "V1").contact.t_s + late_s, abs=0.3)


def test_slower_ego_still_meets_the_crash_since_the_others_wait_for_its_time_to_the_conflict():
    assert met(crossing(), "V1", pace=0.7) is not None


def test_others_begin_at_once_where_the_ego_stands_at_first():
    cue = cue_of(staging_for(rear_end(), "V2"), 1.4)
    assert cue.to_conflict_s is None
    assert "TimeToCollisionCondition" not in text(rear_end(), "V2")


def test_time_to_conflict_is_the_way_over_the_speed():
    made = crossing(own=10.0, contact_s=6.0)
    cue = cue_of(staging_for(made, "V1"), 0.0)
    assert cue.to_conflict_s == pytest.approx(1.01 * (6.0 - 0.1) + 0.05, abs=0.06)


def test_line_has_the_instant_of_the_contact_itself():
    made = crossing()
    staging = staging_for(made, "V1")
    row = round(staging.contact.t_s / 0.05)
    track = next(t for t in made.trajectories if t.actor == "V2")
    assert motion_of(staging, "V2", staging.contact_s, AFTER_S).pose[row] == pytest.approx(track.pose[row])


def test_scenario_ends_with_contact_standstill_or_time():
    root = parsed(text(crossing(), "V1"))
    stop = root.find("Storyboard/StopTrigger")
    kinds = ["CollisionCondition", "StandStillCondition", "SimulationTimeCondition"]
    assert all(stop.iter(kind) and next(stop.iter(kind), None) is not None for kind in kinds)
    assert len(stop) == 3


def test_header_names_the_case_and_comments_what_is_assumed():
    written = text(crossing(), "V1")
    assert 'description="made: V1 front strikes V2 left"' in written
    assert "<!-- Assumed: V1 speed = 10 - a guess -->" in written  # a comment holds no double hyphen


def test_friction_is_a_parameter():
    root = parsed(text(crossing(), "V1", behavior=WET))
    assert root.find(".//RoadCondition").get("frictionScaleFactor") == "$Friction"


def test_actor_that_nobody_drives_is_no_ego():
    with pytest.raises(ConfigError, match="no actor 'V9'"):
        text(crossing(), "V9")
