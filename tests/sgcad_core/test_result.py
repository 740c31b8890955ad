"""result.json: statuses, collision, figures of the network."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from sgcad_core.case.records import (
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
from sgcad_core.execution.contact import realised
from sgcad_core.reading.reading import read
from sgcad_core.records.specs import Contact, Evasion, NearCrash
from sgcad_core.result import CaseRecord, as_declared, result_of

KEYS = {
    "case", "config", "status", "reason", "missing", "attempts", "network", "actors", "collision", "grounding",
    "seconds", "notes", "facts", "sentences", "near_crash", "account", "redactions", "disagreements", "timeline",
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
    assert [(n["kind"], n["subject"], n["text"]) for n in result["notes"]] == [("plan", "V3", "V3 is out of sight")]
    assert result["near_crash"] is None
    assert as_declared(result) is True
    json.dumps(result, allow_nan=False)


def passing(apart_m: float, observed=None, clearance_m=None) -> CaseRecord:
    """V1 passes V2, `apart_m` between their boxes; a near crash is declared."""
    record, n = executed(observed), np.zeros(3)
    infos = [ActorInfo(id=v, type="car", length_m=4.7, width_m=1.8, maneuver="straight") for v in ("V1", "V2")]
    tracks = [
        Trajectory(actor=v, t_s=np.arange(3) * 0.05, x_m=x, y_m=y, heading_rad=n, speed_mps=n)
        for v, x, y in (("V1", np.array([-9.0, 0, 9]), n), ("V2", n, n + 1.8 + apart_m))
    ]
    evasion = Evasion(actor="V1", maneuver="steering_right")
    near = NearCrash(conflict=DECLARED, evasions=(evasion,), clearance_m=clearance_m)
    scenario = Scenario(xosc="<x/>", actors=tuple(infos), near_crash=near)
    done = Execution(simulator="kinematic", trajectories=tuple(tracks), contact=observed)
    outcomes = {**record.outcomes, "scenario": outcome("scenario", artifact=scenario)}
    return CaseRecord("c1", "template", outcomes, done)


def test_a_near_crash_has_a_closest_approach_instead_of_a_contact():
    result = result_of(passing(0.62))
    assert result["collision"] == {"declared": None, "realised": False, "observed": None}
    assert result["near_crash"] == {
        "declared": {
            "conflict": result_of(executed())["collision"]["declared"],
            "evasions": [{"actor": "V1", "maneuver": "steering_right"}],
            "clearance_m": 0.6,
            "clearance_basis": "default",
        },
        "realised": True,
        "observed": {"actor": "V1", "other": "V2", "clearance_m": 0.62, "t_s": 0.05},
    }
    assert as_declared(result) is True
    json.dumps(result, allow_nan=False)


@pytest.mark.parametrize(("apart_m", "clearance_m", "observed", "realised"), [
    (1.5, 1.5, None, True), (1.5, None, None, True), (1.8, None, None, False), (0.6, None, contact(), False),
])  # fmt: skip
def test_a_near_crash_is_realised_where_nobody_touches_and_both_come_as_near_as_told(
    apart_m, clearance_m, observed, realised
):
    near = result_of(passing(apart_m, observed, clearance_m))["near_crash"]
    assert near["realised"] is realised
    assert near["declared"]["clearance_basis"] == ("told" if clearance_m else "default")


@pytest.mark.parametrize(("observed", "status"), [(None, "generated"), (contact(), "exhausted")])
def test_a_subject_that_nobody_touches_is_right_in_a_near_crash_alone(observed, status):
    text = "The subject vehicle was traveling north when a car turned left in front of it. The subject nearly hit it."
    record = replace(passing(0.6, observed), reading=read(text))
    assert result_of(record)["status"] == status
    hit = read("A passenger car struck the Waymo AV in the rear. The Waymo AV was stopped.")
    crash = replace(record, reading=hit, outcomes={**record.outcomes, "scenario": executed().outcomes["scenario"]})
    assert result_of(replace(crash, execution=passing(0.6).execution))["status"] == "exhausted"


def test_what_was_not_generated_or_declares_nothing_is_neither_right_nor_wrong():
    assert as_declared({"status": "exhausted", "collision": {"declared": {}, "realised": False}}) is None
    assert as_declared({"status": "generated", "collision": {"declared": None}, "near_crash": None}) is None


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
    assert [(n["kind"], n["text"]) for n in result["notes"]] == [
        ("reader", "cut"),
        ("finding", "[xodr] a lane is narrow"),
    ]
