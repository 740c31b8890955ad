"""The stage `drive` of a config, from report to metrics.json, and what a tracker is told of it."""

import json

from flows.batch.tracking.track_cases import params_of
from flows.case.run_case import run_case
from flows.case_files.find_cases import Case
from plugins.tracker.figures import case_figures
from sgcad_core.config import load

STAGE = {"drivers": ["script", {"name": "combined", "of": ["reference", "aeb"]}], "role_of": {"V1": "initiator"}}


def go(tmp_path, config_file, reports, **changes):
    config = load(config_file(drive=STAGE, **changes))
    ending = run_case(config, Case(reports(c1="") / "c1", "c1"), tmp_path / "out", "d1")
    return config, ending.result, tmp_path / "out" / "kit" / "c1"


def test_an_executed_case_is_handed_over_and_its_result_is_the_scripts(tmp_path, config_file, reports):
    config, result, folder = go(tmp_path, config_file, reports)
    assert result["status"] == "generated"
    assert (folder / "drive" / "script" / "V1" / "drive.html").is_file()
    told = json.loads((folder / "metrics.json").read_text())["drive"]
    assert set(told) == {"script", "combined"}
    assert told["script"]["initiator"]["unchanged"] == 1
    assert sum(told["combined"]["initiator"][o] for o in ("avoided", "mitigated", "unchanged", "worse", "lost")) == 1
    assert "drive" not in result
    assert params_of(config)["drive"]["drivers"][1]["of"] == ["reference", "aeb"]


def test_result_json_tells_what_the_contact_changed_and_where_both_come_to_rest(tmp_path, config_file, reports):
    _, result, folder = go(tmp_path, config_file, reports)
    impact = json.loads((folder / "result.json").read_text())["impact"]
    assert impact == result["impact"]
    seen = result["collision"]["observed"]
    assert {a["id"] for a in impact["actors"]} == {seen["actor"], seen["other"]}
    exact = json.loads((folder / "metrics.json").read_text())["exact"]
    assert {a["id"]: a["delta_v_mps"] for a in impact["actors"]} == exact["delta_v_mps"]
    last = {row.split(",")[1]: row.split(",") for row in (folder / "trajectories.csv").read_text().split()[1:]}
    for actor in impact["actors"]:
        assert [actor["rest"]["x_m"], actor["rest"]["y_m"]] == [round(float(v), 3) for v in last[actor["id"]][2:4]]


def test_trackers_get_every_outcome_as_a_figure(tmp_path, config_file, reports):
    _, result, folder = go(tmp_path, config_file, reports)
    figures = case_figures(folder, result)
    assert figures["drive/script_initiator_unchanged"] == 1.0
    assert figures["drive/script_initiator_lost"] == 0.0


def test_the_rules_that_the_script_breaks_stand_in_result_and_metrics(tmp_path, config_file, reports):
    _, result, folder = go(tmp_path, config_file, reports)
    counts = json.loads((folder / "metrics.json").read_text())["rules"]
    assert result["rules"]
    assert {f["rule"] for f in result["rules"]} <= set(counts)
    broken = {(f["actor"], f["rule"]) for f in result["rules"] if f["status"] == "broken"}
    assert counts["broken"] == len(broken)
    figures = case_figures(folder, result)
    assert figures["rules/broken"] == counts["broken"]
    assert {"drive/script_initiator_rules_broken", "drive/script_initiator_broke_red_light"} <= set(figures)


def test_a_refused_case_is_not_driven(tmp_path, config_file, reports):
    config = load(config_file(drive="script"))
    ending = run_case(config, Case(reports(c1="REFUSE") / "c1", "c1"), tmp_path / "out", "d1")
    assert ending.result["status"] == "refused"
    assert not (tmp_path / "out" / "kit" / "c1" / "drive").exists()
    assert ending.result["impact"] is None
    assert ending.result["rules"] == []
