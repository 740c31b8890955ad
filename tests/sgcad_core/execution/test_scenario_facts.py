"""What written values rest on: a sentence, a model, or nothing."""

from sgcad_core.case.records import Generation
from sgcad_core.execution.scenario_facts import Grounds
from sgcad_core.reading.reading import read

TOLD = {f.field: f for f in read("V1 was traveling north at 30 mph on a four-lane road.").facts}


def test_a_told_value_keeps_its_sentence_and_one_that_follows_from_it_is_inferred():
    grounds = Grounds(TOLD)
    same = grounds.fact("vehicles.V1.start_speed_mph", 30, "", ("vehicles.V1.speed_mph",), "planner")
    other = grounds.fact("vehicles.V1.start_speed_mph", 24.0, "", ("vehicles.V1.speed_mph",), "planner")
    assert (same.basis, same.status, same.start) == ("text", "stated", 0)
    assert (other.basis, other.status, other.start) == ("text", "inferred", 0)
    assert other.confidence < same.confidence


def test_a_value_that_nobody_tells_is_a_default_without_a_place():
    fact = Grounds(TOLD).fact("vehicles.V1.start_lane", 2, "", ("vehicles.V1.lane",), "planner: a free lane")
    assert (fact.basis, fact.status, fact.start, fact.rule) == ("default", "default", None, "planner: a free lane")


def test_a_default_of_the_reading_stays_one():
    fact = Grounds(TOLD).fact("vehicles.V1.kind", "car", "", ("vehicles.V1.kind",), "a car")
    assert fact.basis == "default"


def test_a_models_answer_has_its_grounding_and_what_goes_against_the_report_is_not_stated():
    grounds = Grounds(TOLD, Generation(text="{}", grounding={"actors[0].lane": 1.25, "actors[0].road": -0.5}))
    lane = grounds.fact("vehicles.V1.start_lane", 2, "actors[0].lane", ("vehicles.V1.lane",), "planner")
    road = grounds.fact("vehicles.V1.start_road", "N", "actors[0].road", (), "planner")
    exit_ = grounds.fact("vehicles.V1.exit_road", "S", "actors[0].exit_road", (), "planner")
    assert (lane.basis, lane.nats, lane.rule, lane.status) == ("model", 1.25, "grounding", "stated")
    assert road.status == "inferred"
    assert (exit_.basis, exit_.nats, exit_.rule) == ("model", None, "answer")


def test_what_the_evidence_carries_and_no_sentence_tells_is_from_the_drawing():
    answer = Generation(text="{}", grounding={"lane": 1.0, "speed": 1.0, "road": -1.0})
    seen, blind = Grounds(TOLD, answer, drawn=True), Grounds(TOLD, answer)
    lane, speed = ("vehicles.V1.lane",), ("vehicles.V1.speed_mph",)
    assert seen.fact("vehicles.V1.start_lane", 2, "lane", lane, "planner").basis == "diagram"
    assert blind.fact("vehicles.V1.start_lane", 2, "lane", lane, "planner").basis == "model"
    assert seen.fact("vehicles.V1.start_speed_mph", 30, "speed", speed, "planner").basis == "model"
    assert seen.fact("vehicles.V1.start_road", "N", "road", (), "planner").basis == "model"


def test_what_a_model_left_open_is_the_planners_choice():
    grounds = Grounds(TOLD, Generation(text="{}"))
    assert grounds.fact("vehicles.V1.start_lane", 1, "", ("vehicles.V1.lane",), "planner").basis == "default"
