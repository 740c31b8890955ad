"""MLflow: a parent an arm with means, a run a case, resumed without loss, from several processes at a time."""

import json
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest

from plugins.tracker import mlflow_arm
from plugins.tracker.figures import means
from plugins.tracker.mlflow import MlflowTracker
from plugins.tracker.mlflow_store import KIND, NOTE
from sgcad_core.errors import ConfigError
from sgcad_core.settings import ROOT
from tests.plugins.tracker.mlflow_cases import PARAMS, REFUSED, RESULT, arm, log, runs_of


def test_an_arm_has_a_parent_with_its_data_plugins_commit_and_hardware_and_the_means_of_its_cases(out, tracker):
    made = tracker()
    made.begin(arm(out))
    (_, (parent,), _) = runs_of(made)
    assert parent.info.status == "RUNNING"
    log(made, out, "c1")
    log(made, out, "c2", REFUSED)
    log(made, out, "c3", {"status": "failed"})
    made.end(arm(out), finished=True)
    client, (parent,), children = runs_of(made)
    assert parent.info.status == "FINISHED"
    assert {name: run.info.status for name, run in children.items()} == {
        "c1": "FINISHED", "c2": "FINISHED", "c3": "FAILED"
    }  # fmt: skip
    assert {run.data.tags["mlflow.parentRunId"] for run in children.values()} == {parent.info.run_id}
    assert parent.data.metrics["collision_realised"] == pytest.approx(1 / 3)
    assert parent.data.metrics["attempts/road"] == 2.0
    assert [parent.data.metrics[f"cases{s}"] for s in ("", "_generated", "_refused", "_failed")] == [3, 1, 1, 1]
    ((used,),) = [[i.dataset for i in parent.inputs.dataset_inputs]]
    assert (used.name, used.digest, json.loads(used.profile)["cases"]) == ("cases", "ab" * 8, 4)
    tags = parent.data.tags
    assert tags["plugin.retriever"].endswith("kb-v1-aa")
    assert (tags["hardware.processor"], tags["hardware.gpus"]) == ("a CPU", "none")
    assert {r.data.tags["mlflow.source.git.commit"] for r in (parent, *children.values())} == {"c0ffee"}
    history = client.get_metric_history(children["c1"].info.run_id, "attempt/road_findings")
    assert [(m.step, m.value) for m in history] == [(1, 2.0), (2, 0.0)]
    assert {f.path for f in client.list_artifacts(children["c1"].info.run_id)} == {"player.html", "attempts"}


def test_a_case_counts_as_logged_only_where_the_database_is_still_at_its_place(out, tracker, tmp_path):
    made = tracker(database=tmp_path / "mlflow.db")
    log(made, out, "c1")
    for file in tmp_path.glob("mlflow.db*"):
        file.rename(tmp_path / f"moved-{file.name}")
    with pytest.raises(FileNotFoundError, match="moved or deleted meanwhile; the next command logs the cases again"):
        log(made, out, "c2")
    assert made.identity(tmp_path) == ""


def test_search_needs_no_renaming(out, tracker):
    made = tracker()
    log(made, out, "c1")
    log(made, out, "c2", REFUSED)
    for text in (
        "metrics.collision_realised > 0.9",
        "params.decoder = 'cad' and params.`decoder.alpha` = '0.7' and metrics.generated = 1",
        "tags.`sgcad.level` = 'case' and tags.`sgcad.status` = 'generated'",
    ):
        assert list(runs_of(made, text)[2]) == ["c1"], text


def test_a_resumed_arm_goes_on_in_its_run_and_a_case_done_again_takes_its_place(out, tracker):
    killed = tracker()
    killed.begin(arm(out))
    log(killed, out, "c1")
    log(killed, out, "c2")
    resumed = tracker()
    resumed.begin(arm(out))
    log(resumed, out, "c2", REFUSED)
    log(resumed, out, "c3")
    resumed.end(arm(out), finished=True)
    _, (parent,), children = runs_of(resumed)
    assert parent.info.status == "FINISHED"
    assert {name: run.data.tags["sgcad.status"] for name, run in children.items()} == {
        "c1": "generated", "c2": "refused", "c3": "generated"
    }  # fmt: skip
    assert parent.data.metrics["cases"] == 3
    assert parent.data.metrics["generated"] == pytest.approx(2 / 3)


def test_an_interrupted_arm_says_so_until_it_is_resumed(out, tracker):
    made = tracker()
    made.begin(arm(out))
    log(made, out, "c1")
    made.end(arm(out), finished=False)
    assert runs_of(made)[1][0].info.status == "KILLED"
    made.begin(arm(out))
    assert runs_of(made)[1][0].info.status == "RUNNING"
    made.end(arm(out), finished=True)
    assert runs_of(made)[1][0].info.status == "FINISHED"


def test_an_arm_that_a_fault_ended_has_failed(out, tracker):
    made = tracker()
    made.begin(arm(out))
    made.end(arm(out, fault="MissingTool: no netconvert"), finished=False)
    assert runs_of(made)[1][0].info.status == "FAILED"


def test_the_headline_comes_first_and_is_explained_on_every_page(out, tracker):
    made = tracker()
    prefect = "http://127.0.0.1:4200/runs/flow-run/1"
    (out / "kit" / "c1" / "links.json").write_text(json.dumps({"prefect": prefect, "prefect_case": "/runs/task-run/2"}))
    made.begin(arm(out))
    account = {"verdict": "lacking", "told": 3, "has": 2, "lacking": 1, "assumed": 0, "items": [
        {"kind": "lacks", "text": "a *stop* sign", "reason": ""}]}  # fmt: skip
    log(made, out, "c1", RESULT | {"account": account})
    made.end(arm(out), finished=True)
    client, (parent,), children = runs_of(made)
    first = sorted(parent.data.metrics)[0]
    assert first == "0_headline/01_collision_realised"
    assert parent.data.metrics[first] == parent.data.metrics["collision_realised"] == 1
    assert "| `account/lacking` | 1 | things told that the scenario lacks" in parent.data.tags[NOTE]
    note, page = children["c1"].data.tags[NOTE], made.page("kit", "c1")
    assert "told 3, in the scenario 2, lacking 1, assumed 0" in note
    assert r"- lacking: a \*stop\* sign" in note
    assert f"[report page]({page[1:]}/artifacts/player.html) · [Prefect flow run]({prefect})" in note
    assert "/runs/task-run/2" not in note
    assert children["c1"].data.tags["sgcad.prefect"] == prefect
    experiment = client.get_experiment(parent.info.experiment_id)
    assert "`0_headline`" in experiment.tags[NOTE]
    assert f"](#/experiments/{experiment.experiment_id}/runs?workflowType=machine_learning)" in experiment.tags[NOTE]
    assert experiment.tags[KIND] == "custom_model_development"


def test_a_description_that_people_wrote_stays(out, tracker):
    made = tracker()
    store = made._store(out)
    store.client.set_experiment_tag(store.experiment_id, NOTE, "ours")
    made.begin(arm(out))
    made.end(arm(out), finished=True)
    assert store.client.get_experiment(store.experiment_id).tags[NOTE] == "ours"


def test_other_parameters_are_another_arm(out, tracker):
    made = tracker()
    log(made, out, "c1")
    made.log_case("kit", PARAMS | {"seed": 7}, out / "kit" / "c1", RESULT)
    assert {r.data.params["seed"] for r in runs_of(made)[1]} == {"42", "7"}


def test_the_machine_is_watched_while_an_arm_runs(out, tracker):
    made = tracker(system_metrics_s=0.05)
    made.begin(arm(out))
    log(made, out, "c1")
    named = "system/cpu_utilization_percentage"
    deadline = time.monotonic() + 120
    while named not in runs_of(made)[1][0].data.metrics and time.monotonic() < deadline:
        made._begun["kit"]._monitor.mlflow_logger.flush()
    made.end(arm(out), finished=True)
    assert named in runs_of(made)[1][0].data.metrics


def test_the_machine_is_not_watched_while_cases_are_logged_later(out, tracker):
    made = tracker(system_metrics_s=0.05)
    made.begin(arm(out, live=False))
    log(made, out, "c1")
    assert made._begun["kit"]._monitor is None
    made.end(arm(out), finished=True)


def test_an_arm_keeps_its_config_and_a_table_of_its_cases(out, tracker, tmp_path):
    made = tracker()
    (out / "kit" / "config.yaml").write_text("seed: 42\n")
    made.begin(arm(out))
    log(made, out, "c2", REFUSED | {"reason": "no road is told"})
    log(made, out, "c1")
    made.end(arm(out), finished=True)
    client, (parent,), _ = runs_of(made)
    assert json.loads(parent.data.tags["mlflow.loggedArtifacts"]) == [{"path": "cases.json", "type": "table"}]
    table = json.loads(Path(client.download_artifacts(parent.info.run_id, "cases.json", str(tmp_path))).read_text())
    rows = [dict(zip(table["columns"], row, strict=True)) for row in table["data"]]
    assert [(r["case"], r["outcome"], r["seconds/total"], r["account/whole"]) for r in rows] == [
        ("c1", "generated: no contact", 1.5, 0.0), ("c2", "refused: no road is told", 0.1, 0.0)
    ]  # fmt: skip
    assert {f.path for f in client.list_artifacts(parent.info.run_id)} == {"cases.json", "config.yaml"}


def test_a_prompt_gets_a_new_version_only_where_its_text_changed(out, tracker):
    texts = {"draw_road": "Draw the {roads}.", "draw_crash": "Draw the crash."}
    for seed, changed in ((1, {}), (2, {}), (3, {"draw_road": "Draw all {roads}."})):
        made = tracker()
        given = arm(out, params=PARAMS | {"seed": seed}, prompts=texts | changed)
        made.begin(given)
        made.end(given, finished=True)
    client, parents, _ = runs_of(made)
    linked = [json.loads(run.data.tags["mlflow.linkedPrompts"]) for run in parents]
    assert [{p["name"]: p["version"] for p in of} for of in linked] == [
        {"draw_road": "1", "draw_crash": "1"}, {"draw_road": "1", "draw_crash": "1"},
        {"draw_road": "2", "draw_crash": "1"},
    ]  # fmt: skip
    assert client.load_prompt("draw_road", version="2").template == "Draw all {roads}."


@pytest.mark.slow
def test_processes_that_begin_together_share_one_parent(out, tracker):
    made = tracker(artifacts=False)
    made._store(None).experiment_id  # noqa: B018 - makes the experiment
    code = (
        "import json, sys; from pathlib import Path; from plugins.tracker.mlflow import MlflowTracker\n"
        "given = json.loads(sys.argv[1]); tracker = MlflowTracker.model_validate_json(given['tracker'])\n"
        "tracker.log_case('kit', given['params'], Path(given['folder']), given['result'])\n"
    )
    given = partial(dict, tracker=made.model_dump_json(), params=PARAMS, result=RESULT)
    commands = [
        [sys.executable, "-c", code, json.dumps(given(folder=str(out / "kit" / case)))] for case in ("c1", "c2", "c3")
    ]
    started = [subprocess.Popen(command, cwd=ROOT, stderr=subprocess.PIPE, text=True) for command in commands]
    ended = [(p.communicate()[1], p.returncode) for p in started]
    assert [code for _, code in ended] == [0] * 3, ended
    _, parents, children = runs_of(made)
    assert len(parents) == 1
    assert set(children) == {"c1", "c2", "c3"}


def test_a_database_that_is_none_is_refused_with_a_remedy(out, tmp_path):
    (tmp_path / "no.db").write_text("this is no database, and it is long enough not to look empty " * 20)
    with pytest.raises(ConfigError, match=r"no.db: this is no database of MLflow's.*tracker=jsonl"):
        MlflowTracker(database=tmp_path / "no.db").log_case("kit", PARAMS, out / "kit" / "c1", RESULT)


def test_means_are_read_page_by_page_and_a_case_done_again_counts_once(out, tracker, monkeypatch):
    """A batch of 10,000 cases must not hold all their runs at a time."""
    monkeypatch.setattr(mlflow_arm, "MAX_RUNS", 2)
    made = tracker()
    made.begin(arm(out))
    for case, result in (("c1", RESULT), ("c2", REFUSED), ("c3", RESULT), ("c4", RESULT), ("c1", REFUSED)):
        log(made, out, case, result)
        time.sleep(0.002)  # runs are in order of their starts
    made.end(arm(out), finished=True)
    _, (parent,), _ = runs_of(made)
    assert parent.data.metrics["cases"] == 4
    assert parent.data.metrics["generated"] == 0.5


def test_means_take_what_comes_once():
    assert means(iter([{"a": 1.0, "generated": 1.0, "attempt/road": 9.0}, {"a": 2.0}])) == {
        "a": 1.5, "generated": 1.0, "cases_generated": 1.0, "cases_refused": 0.0, "cases_exhausted": 0.0,
        "cases_failed": 0.0, "cases": 2.0,
    }  # fmt: skip
