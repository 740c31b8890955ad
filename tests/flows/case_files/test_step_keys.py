"""Keys of steps: the same for the same inputs, another where anything that counts is another."""

import sys

import numpy as np
import pytest

from flows.case_files.step_keys import StepKeys, content_of, keys_of
from sgcad_core.asking.refine import Turn
from sgcad_core.case.records import Attempt, CrashReport, Diagram, Finding, RoadNetwork, Trajectory
from sgcad_core.config import load

ANSWERS = [{"attempt": 1, "answer": "no"}, {"attempt": 2, "answer": "no"}, {"attempt": 3, "answer": "ok"}]
ASKING = {"road_writer": "testkit_asking", "decoder": "greedy", "backbone": {"name": "scripted", "answers": ANSWERS}}


@pytest.mark.parametrize(
    ("changes", "same"),
    [
        ({"max_attempts": 3}, {"read", "road", "scenario", "simulate"}),
        ({"tracker": "jsonl"}, {"read", "road", "scenario", "simulate"}),
        ({"retriever": {"name": "lancedb"}}, {"read", "road", "scenario", "simulate"}),  # passages count by content
        ({"seed": 7}, {"read", "scenario", "simulate"}),
        ({"show_findings": False}, {"read", "scenario", "simulate"}),
        ({"decoder": "nucleus"}, {"read", "scenario", "simulate"}),
        ({"backbone": {"name": "scripted", "answers": ["ok"]}}, {"read", "scenario", "simulate"}),
        ({"validators": []}, {"read", "scenario", "simulate"}),
        ({"validators": ["testkit", "openscenario"]}, {"read", "road", "simulate"}),
        ({"road_writer": "testkit"}, {"read", "scenario", "simulate"}),
        ({"scenario_writer": "rules"}, {"read", "road", "simulate"}),
        ({"simulator": {"name": "testkit", "fails": True}}, {"read", "road", "scenario"}),
        ({"report_reader": {"name": "auto", "use_diagrams": False}}, {"road", "scenario", "simulate"}),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)  # fmt: skip
def test_a_step_is_the_same_if_what_it_depends_on_is(config_file, changes, same):
    before = keys_of(load(config_file("one", **ASKING)))
    after = keys_of(load(config_file("two", **(ASKING | changes))))
    unchanged = {step for step in vars(before) if getattr(before, step) == getattr(after, step)}
    assert unchanged == same | {"opinion"}, "nobody is asked for one"


@pytest.mark.parametrize(
    ("changes", "same"),
    [({"seed": 7}, False), ({"decoder": "nucleus"}, False), ({"scenario_writer": "rules"}, True)],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_a_second_opinion_is_another_with_another_model_or_seed(config_file, changes, same):
    seconded = ASKING | {"second_opinion": "mini_gist"}
    before, after = (keys_of(load(config_file(n, **(seconded | c)))) for n, c in (("one", {}), ("two", changes)))
    assert (before.opinion == after.opinion) is same
    assert before.opinion != keys_of(load(config_file("three", **ASKING))).opinion


def test_a_plugins_new_version_is_another_step(config_file, testkit, monkeypatch):
    before = keys_of(load(config_file("one", **ASKING)))
    monkeypatch.setattr(sys.modules["sgcad_testkit"].KitAskingRoad, "version", "2")
    after = keys_of(load(config_file("one", **ASKING)))
    assert before.road != after.road
    assert before.scenario == after.scenario


def test_content_is_what_counts():
    def report(text="a", png=b"1"):
        return CrashReport(case="c", narrative=text, diagrams=(Diagram(png=png, width_px=1, height_px=1),))

    def track(x):
        t = np.arange(2) * 0.05
        return Trajectory(actor="V1", t_s=t, x_m=np.array(x), y_m=t, heading_rad=t, speed_mps=t)

    assert content_of(report()) == content_of(report())
    assert content_of(track([0.0, 1.0])) == content_of(track([0.0, 1.0]))
    different = [
        report(),
        report("b"),
        report(png=b"2"),
        (report(),),
        track([0.0, 1.0]),
        track([0.0, 1.5]),
        None,
        "",
        b"",
        0,
        0.0,
    ]
    assert len({content_of(value) for value in different}) == len(different)


def test_an_attempt_depends_on_the_answers_and_findings_before_it(config_file):
    def turn(answer="a", seconds=1.0, **finding):
        found = (Finding(source="s", what="w", **finding),)
        return Turn(Attempt(stage="road", number=1, answer=answer, findings=found, seconds=seconds), RoadNetwork())

    keys = StepKeys(keys_of(load(config_file("one", **ASKING))), "c1", "digest")
    same = keys.key("road", "report", [turn()])
    assert keys.key("road", "report", [turn(seconds=2.0)]) == same
    others = [[turn("b")], [turn(value="3")], [turn(), turn()], []]
    assert len({same, *(keys.key("road", "report", turns) for turns in others)}) == 5
    assert StepKeys(keys.keys, "c2", "digest").key("road", "report", [turn()]) != same
