"""result.json: statuses, collision, figures of the network."""

import json

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from sgcad_core.execution.contact import realised
from sgcad_core.records import (
    ActorInfo,
    Attempt,
    Execution,
    Finding,
    Generation,
    ObservedContact,
    RoadNetwork,
    Scenario,
    StageOutcome,
    Trajectory,
)
from sgcad_core.result import CaseRecord, result_of
from sgcad_core.specs import Contact

KEYS = {
    "case", "config", "status", "reason", "missing", "attempts", "network", "actors", "collision", "grounding",
    "seconds", "notes", "facts", "sentences",
}  # fmt: skip
AREAS = st.sampled_from(["front", "back", "left", "right"])
DECLARED = Contact(striker="V1", struck="V2", striker_area="front", struck_area="left")
NET = """<net><edge id="a" from="w" to="e"><lane id="a_0" index="0" speed="13" length="100" shape="0,0 100,0"/>
<lane id="a_1" index="1" speed="13" length="100" shape="0,3 100,3"/></edge>
<junction id="w" type="dead_end" x="0" y="0"/><junction id="e" type="dead_end" x="100" y="0"/></net>"""


def contact(actor="V1", other="V2", actor_area="front", other_area="left"):
    return ObservedContact(actor=actor, other=other, actor_area=actor_area, other_area=other_area, t_s=4.2)


def attempt(stage, generation=None, findings=()):
    return Attempt(stage=stage, number=1, generation=generation, findings=findings)


def outcome(stage, status="written", artifact=None, **more):
    return StageOutcome(stage=stage, status=status, artifact=artifact, **{"attempts": (attempt(stage),), **more})


def executed(observed=None):
    info = ActorInfo(id="V1", type="car", length_m=4.7, width_m=1.8, maneuver="turn_left")
    zeros = np.zeros(2)
    track = Trajectory(actor="V1", t_s=zeros, x_m=zeros, y_m=zeros, heading_rad=zeros, speed_mps=zeros)
    scenario = Scenario(xosc="<x/>", actors=(info,), declared=DECLARED, notes=("V3 is out of sight",))
    return CaseRecord(
        case="c1",
        config="template",
        outcomes={
            "road": outcome("road", artifact=RoadNetwork(net_xml=NET)),
            "scenario": outcome("scenario", artifact=scenario),
        },
        execution=Execution(simulator="kinematic", trajectories=(track,), contact=observed),
        seconds={"read": 0.123456},
    )


def test_a_generated_case_has_every_promised_key():
    result = result_of(executed(contact()))
    assert set(result) == KEYS
    assert result["status"] == "generated"
    assert result["attempts"] == {"road": 1, "scenario": 1}
    assert result["network"] == {
        "source": "written",
        "intersections": 0,
        "components": 1,
        "mean_lanes": 2.0,
        "segments": [{"id": "a", "lanes_forward": 2, "lanes_backward": 0}],
    }
    assert result["actors"] == [{"id": "V1", "type": "car", "length_m": 4.7, "width_m": 1.8, "maneuver": "turn_left"}]
    assert result["collision"]["declared"] == {
        "striker": "V1", "struck": "V2", "striker_area": "front", "struck_area": "left",
    }  # fmt: skip
    assert result["collision"]["realised"] is True
    assert result["collision"]["observed"] == {
        "actor": "V1", "other": "V2", "actor_area": "front", "other_area": "left", "t_s": 4.2,
    }  # fmt: skip
    assert result["notes"] == ["V3 is out of sight"]
    json.dumps(result, allow_nan=False)


def test_a_contact_is_realised_in_either_order():
    assert realised(DECLARED, contact())
    assert realised(DECLARED, contact("V2", "V1", "left", "front"))


@given(st.sampled_from(["V1", "V2", "V3"]), st.sampled_from(["V1", "V2", "V3"]), AREAS, AREAS)
@hypothesis_settings(max_examples=100, deadline=None)
def test_only_the_declared_pair_with_the_declared_areas_is_realised(actor, other, actor_area, other_area):
    pairs = {(actor, actor_area), (other, other_area)}
    expected = pairs == {("V1", "front"), ("V2", "left")}
    assert realised(DECLARED, contact(actor, other, actor_area, other_area)) is expected


def test_nothing_declared_or_nothing_observed_is_not_realised():
    assert not realised(None, contact())
    assert not realised(DECLARED, None)
    assert result_of(executed())["collision"]["observed"] is None


@pytest.mark.parametrize("status", ["refused", "exhausted"])
@pytest.mark.parametrize("stage", ["road", "scenario"])
def test_a_stage_that_declines_gives_the_case_its_status(stage, status):
    outcomes = {"road": outcome("road", artifact=RoadNetwork(net_xml=NET))}
    outcomes[stage] = outcome(stage, status, reason="no lanes", missing=("lanes",))
    result = result_of(CaseRecord("c", "k", outcomes))
    assert (result["status"], result["reason"], result["missing"]) == (status, f"{stage}: no lanes", ["lanes"])
    assert set(result) == KEYS
    assert (result["network"] is None) == (stage == "road")


def test_the_best_attempt_of_an_exhausted_stage_is_not_passed_off_as_written():
    record = CaseRecord("c", "k", {"road": outcome("road", "exhausted", RoadNetwork(net_xml=NET), reason="r")})
    assert record.network is None
    assert result_of(record)["network"] is None


def test_a_failure_outranks_what_was_written_before_it():
    record = executed()
    failed = CaseRecord("c", "k", record.outcomes, failure="SUMO died of SIGSEGV")
    result = result_of(failed)
    assert (result["status"], result["reason"]) == ("failed", "SUMO died of SIGSEGV")
    assert result["network"] is not None


def test_a_case_that_never_came_to_a_stage_is_a_failure():
    assert result_of(CaseRecord("c", "k"))["status"] == "failed"
    assert "never executed" in result_of(CaseRecord("c", "k", executed().outcomes))["reason"]


def test_grounding_is_told_by_stage_and_path():
    generation = Generation(text="{}", grounding={"$.legs[0].lanes_in": 1.23456})
    road = outcome("road", "refused", attempts=(attempt("road"), attempt("road", generation)))
    assert result_of(CaseRecord("c", "k", {"road": road}))["grounding"] == {"road.$.legs[0].lanes_in": 1.2346}


def test_note_findings_stand_among_the_notes():
    note = Finding(source="xodr", severity="note", what="a lane is narrow")
    repair = Finding(source="xodr", what="a lane is missing")
    road = outcome("road", "exhausted", attempts=(attempt("road", findings=(repair, note)),), reason="r")
    result = result_of(CaseRecord("c", "k", {"road": road}, notes=("cut",)))
    assert result["notes"] == ["cut", "[xodr] a lane is narrow"]
