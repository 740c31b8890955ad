"""One case from report to folder, however it ends."""

import csv
import json

import pytest

from flows.batch import config_folder
from flows.case import revise_case
from flows.case.chain import CaseRun
from flows.case.run_case import run_case
from flows.case_files import case_folder
from flows.case_files.find_cases import Case
from plugins.backbone.scripted import Scripted
from sgcad_core import settings
from sgcad_core.config import load
from sgcad_core.errors import ConfigError, MissingTool

ALWAYS = {"report.txt", "attempts", "result.json", "specs.json", "steps.json", ".digest", ".source"}
EXECUTED = ALWAYS | {
    "road.net.xml", "road.xodr", "scenario.xosc", "trajectories.csv", "metrics.json", "player.html", "picture.png",
    "ego.xosc", "ego_carla.xosc", "run_esmini.sh", "run_carla.py",
}  # fmt: skip
MODEL = {"road_writer": "testkit_asking", "decoder": "greedy"}


@pytest.fixture
def run(tmp_path, config_file, reports):
    """Runs one report holding a word under a changed config: (ending, case folder)."""

    def go(word="", source=None, **changes):
        source = source or reports(c1=word) / "c1"
        out = tmp_path / "out"
        return run_case(load(config_file(**changes)), Case(source, "c1"), out, "d1"), out / "kit" / "c1"

    return go


def names(folder):
    return {p.name for p in folder.iterdir()}


def test_an_executed_case_leaves_every_promised_file(run):
    ending, folder = run()
    assert ending.result["status"] == "generated"
    assert names(folder) == EXECUTED
    assert json.loads((folder / "result.json").read_text()) == ending.result
    assert sorted(p.name for p in (folder / "attempts").iterdir()) == ["road-01", "scenario-01"]
    assert json.loads((folder / "metrics.json").read_text())["exact"]["collision"] is True
    rows = list(csv.DictReader((folder / "trajectories.csv").open()))
    assert {r["actor"] for r in rows} == {"V1", "V2"}


def test_a_realised_collision_is_told_with_time_and_areas(run):
    collision = run()[0].result["collision"]
    assert collision["realised"] is True
    assert collision["observed"] == {
        "actor": "V1", "other": "V2", "actor_area": "front", "other_area": "back", "t_s": 4.65,
    }  # fmt: skip


def test_a_refused_case_names_what_is_missing_and_is_done(run):
    ending, folder = run("REFUSE")
    assert (ending.result["status"], ending.result["missing"]) == ("refused", ["number of lanes"])
    assert names(folder) == ALWAYS
    assert (folder / ".digest").read_text() == "d1"


def test_a_finding_that_nobody_can_repair_exhausts_the_case(run):
    ending, folder = run("REPAIR")
    assert ending.result["status"] == "exhausted"
    assert "[testkit] a road is missing at road a (found 1) -> add one" in ending.result["reason"]
    assert names(folder) == ALWAYS


def test_a_bug_in_a_plugin_costs_one_case_and_leaves_its_trace(run):
    ending, folder = run("RAISE")
    assert ending.result["status"] == "failed"
    assert "road_writer 'testkit' (sgcad_testkit:KitRoad): write raised ZeroDivisionError" in ending.result["reason"]
    assert "sgcad_testkit.py" in (folder / "error.txt").read_text()
    assert names(folder) == ALWAYS | {"error.txt"}


def test_a_dead_simulator_keeps_road_and_scenario(run):
    ending, folder = run(simulator={"name": "testkit", "fails": True})
    assert (ending.result["status"], ending.result["reason"]) == ("failed", "the simulator died of SIGSEGV")
    assert names(folder) == ALWAYS | {"road.net.xml", "road.xodr", "scenario.xosc"}


def test_a_failed_case_is_tried_again_by_the_next_run(run):
    _, folder = run("RAISE")
    assert (folder / ".digest").read_text() == ""


@pytest.mark.parametrize(
    ("content", "reason"),
    [(b"", "report.txt"), (b"\x00\x01\x02" * 500, "binary data"), (b"x" * 11_000_000, "cut the file")],
    ids=["empty", "binary", "huge"],
)
def test_a_report_that_cannot_be_read_fails_its_case_alone(run, tmp_path, content, reason):
    (tmp_path / "bad").mkdir()
    (tmp_path / "bad" / "report.txt").write_bytes(content)
    ending, folder = run(source=tmp_path / "bad")
    assert ending.result["status"] == "failed"
    assert reason in ending.result["reason"]
    assert names(folder) == ALWAYS
    assert (folder / "report.txt").read_text() == ""


def test_a_missing_tool_ends_everything(run):
    with pytest.raises(MissingTool, match="netconvert is not installed"):
        run("TOOLLESS")


def test_a_full_disk_ends_everything_and_leaves_no_half_case(run, monkeypatch, tmp_path):
    def full(folder, network):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(case_folder, "write_network", full)
    with pytest.raises(ConfigError, match=r"c1: cannot be written \(No space left on device\); make room"):
        run()
    assert list((tmp_path / "out" / "kit").iterdir()) == []


def test_what_cannot_be_drawn_costs_one_case(run, monkeypatch):
    monkeypatch.setattr("flows.player.overview_png.MARGIN_M", "no number")
    ending, folder = run()
    assert ending.result["status"] == "failed"
    assert ending.result["reason"].startswith("unexpected ")
    assert names(folder) == ALWAYS | {"error.txt"}


def test_a_model_is_asked_again_with_its_findings_and_every_answer_is_kept(run):
    script = {"name": "scripted", "answers": ["no", "never", "ok"]}
    ending, folder = run(**MODEL, backbone=script)
    assert ending.result["status"] == "generated"
    assert ending.result["attempts"] == {"road": 3, "scenario": 1}
    answers = [(folder / "attempts" / f"road-0{n}" / "answer.txt").read_text() for n in (1, 2, 3)]
    assert answers == ["no", "never", "ok"]
    second = folder / "attempts" / "road-02"
    assert "the answer is not ok (found no)" in (second / "prompt.txt").read_text()
    assert (second / "answer.txt").read_text() == "never"


def test_the_configured_number_of_attempts_is_the_limit(run):
    script = {"name": "scripted", "answers": ["no"] * 5}
    ending, _ = run(**MODEL, backbone=script, max_attempts=4)
    assert (ending.result["status"], ending.result["attempts"]["road"]) == ("exhausted", 4)


def test_first_attempts_are_drawn_at_their_own_temperature(run, monkeypatch):
    drawn, generate = [], Scripted.generate

    def noted(self, context, query, decoder, seed=0):
        drawn.append((query.attempt, decoder.temperature))
        return generate(self, context, query, decoder, seed)

    monkeypatch.setattr(Scripted, "generate", noted)
    sampled = {"name": "nucleus", "temperature": 0.3, "first_temperature": 0}
    run(**MODEL | {"decoder": sampled}, backbone={"name": "scripted", "answers": ["no", "never", "ok"]})
    assert drawn == [(1, 0.0), (2, 0.3), (3, 0.3)]


@pytest.mark.parametrize("shown", [True, False])
def test_findings_stand_in_the_next_prompt_unless_the_config_keeps_them_back(run, shown):
    backbone = {"name": "scripted", "answers": ["no", "ok"]}
    _, folder = run(**MODEL, backbone=backbone, show_findings=shown)
    first, second = ((folder / "attempts" / f"road-0{n}" / "prompt.txt").read_text() for n in (1, 2))
    assert "the answer is not ok" not in first
    assert ("the answer is not ok" in second) is shown


SECOND = {
    "touched": True, "met": "suv", "subject": "backing", "other": "straight", "subject_area": "back",
    "other_area": "front", "junction": False,
}  # fmt: skip


def test_a_second_opinion_is_asked_once_and_read_with_the_rules(run, monkeypatch, tmp_path):
    from sgcad_core.records.second_reader import Weights

    monkeypatch.setattr(
        "sgcad_core.asking.second_opinion.load_weights", lambda prompt: {"subject": Weights(differ=9.0)}
    )
    seen = []
    monkeypatch.setattr(
        "flows.case.run_case.result_of", lambda record: seen.append(record.reading) or {"status": "generated"}
    )
    backbone = {"name": "scripted", "answers": [SECOND]}
    source = tmp_path / "c1.txt"
    source.write_text("The AV was stopped at a light. An SUV struck the rear of the AV with its front.")
    ending, _ = run(source=source, backbone=backbone, decoder="greedy", second_opinion="mini_gist")
    assert ending.result["status"] == "generated"
    assert seen[0].crash.vehicles[0].maneuver == "backing"
    assert [(f.field, f.basis) for f in seen[0].facts if f.basis == "model"] == [("gist.subject", "model")]


def test_a_second_opinion_needs_a_model(config_file):
    with pytest.raises(ConfigError, match="backbone: missing, but second_opinion ask"):
        load(config_file("one", second_opinion="mini_gist"))


def second_reader_says(monkeypatch, other):
    """Lets the learned reader say what the other vehicle does, with much confidence."""
    from sgcad_core.records.second_reader import Heard, Opinion, Weights

    said = Opinion(heard={"other": Heard(value=other, p=0.9)}, weights={"other": Weights()})
    monkeypatch.setattr("sgcad_core.reading.second_reader.learned_reader.opinion", lambda narrative: said)


def by_two_readers(folder, text):
    """The result of a report that the rules and the learned reader read."""
    source = folder / "c1.txt"
    source.write_text(text)
    config = load(settings.ROOT / "configs" / "template.yaml", ("second_opinion=learned", "tracker=jsonl"))
    return run_case(config, Case(source, "c1"), folder / "out", "d1").result


def test_a_second_opinion_that_leads_to_no_scenario_leaves_the_rules_reading(monkeypatch, tmp_path):
    second_reader_says(monkeypatch, "backing")
    real = CaseRun._both
    monkeypatch.setattr(CaseRun, "_both", lambda self, report: None if report.value.opinion else real(self, report))
    result = by_two_readers(
        tmp_path,
        "The AV was stopped at a red light on Main Street. An SUV behind it, traveling straight, struck the rear "
        "of the AV with its front bumper.",
    )
    assert result["status"] == "generated"
    assert result["collision"]["realised"]
    assert {a["id"]: a["maneuver"] for a in result["actors"]} == {"V1": "stopped", "V2": "straight"}
    assert any("the rules' reading stands" in str(note) for note in result["notes"])


def test_the_rules_reading_is_kept_where_the_scenario_of_both_readers_misses_more(monkeypatch, tmp_path):
    second_reader_says(monkeypatch, "turn_left")
    result = by_two_readers(
        tmp_path,
        "The AV was traveling north on Main Street. An SUV, traveling south in the opposite direction, struck the "
        "front of the AV with its front bumper.",
    )
    assert all(fact["basis"] != "model" for fact in result["facts"])
    assert any("the rules' reading is kept: its scenario misses" in str(note) for note in result["notes"])


def test_a_mended_case_holds_to_the_reading_that_was_kept(monkeypatch, tmp_path):
    second_reader_says(monkeypatch, "turn_left")
    by_two_readers(
        tmp_path,
        "The AV was traveling north on Main Street. An SUV, traveling south in the opposite direction, struck the "
        "front of the AV with its front bumper.",
    )
    folder = tmp_path / "out" / "template" / "c1"
    assert json.loads((folder / "specs.json").read_text())["read_by"] == "rules"
    config_folder.write(folder.parent, load(settings.ROOT / "configs" / "template.yaml", ("second_opinion=learned",)))
    revised = revise_case.revise(folder, {"V1.speed_mph": "30"}).result
    assert {a["id"]: a["maneuver"] for a in revised["actors"]} == {"V1": "straight", "V2": "straight"}
    assert all(fact["basis"] != "model" for fact in revised["facts"])
    assert not any("is kept: its scenario misses" in str(note) for note in revised["notes"])


def test_a_models_answers_to_the_whole_report_join_the_reading(monkeypatch, tmp_path):
    from sgcad_core.reading.second_reader.field_claims import KINDS
    from sgcad_core.records.second_reader import Answered, Opinion, Weights
    from sgcad_core.records.specs import Actor, BehaviorSpec, Contact, Leg, RoadLayout

    legs = (Leg(bearing="N", lanes_in=2, lanes_out=2), Leg(bearing="S", lanes_in=2, lanes_out=2))
    actors = tuple(
        Actor(id=name, kind=kind, road=road, direction="forward", maneuver="straight")
        for name, kind, road in (("V1", "truck", "S"), ("V2", "car", "N"))
    )
    contact = Contact(striker="V1", struck="V2", striker_area="front", struck_area="front")
    behavior = BehaviorSpec(actors=actors, contacts=(contact,))
    weights = {kind: Weights(differ=9.0) for kind in KINDS}
    said = Opinion(answered=Answered(layout=RoadLayout(legs=legs), behavior=behavior), weights=weights)
    monkeypatch.setattr(
        "flows.case.steps.with_model_opinion", lambda report, ask: report.model_copy(update={"opinion": said})
    )
    source = tmp_path / "c1.txt"
    source.write_text("V1 was northbound and V2 was southbound. The front of V1 struck the front of V2.")
    config = load(settings.ROOT / "configs" / "fused.yaml", ("tracker=jsonl",))
    result = run_case(config, Case(source, "c1"), tmp_path / "out", "d1").result
    assert result["status"] == "generated"
    taken = {fact["field"]: fact["value"] for fact in result["facts"] if fact["basis"] == "model"}
    assert taken["vehicles.V1.kind"] == "truck"
    assert taken["roads.N.lanes_forward"] == 2
    specs = json.loads(next((tmp_path / "out").rglob("specs.json")).read_text())
    assert {actor["id"]: actor["kind"] for actor in specs["behavior"]["actors"]} == {"V1": "truck", "V2": "car"}
    assert {road["lanes_forward"] for road in specs["road"]["roads"]} == {2}


def test_the_learned_second_reader_needs_no_model(config_file):
    assert load(config_file("one", second_opinion="learned")).backbone is None
