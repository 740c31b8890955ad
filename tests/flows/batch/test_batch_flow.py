"""What Prefect has of a batch: tasks with true states, retries and parents, however it is run."""

import json
import time

import httpx
import pytest

from flows.batch import run_batch
from flows.batch.plan_batch import batch_of
from flows.case_files.find_cases import cases_in

pytestmark = [pytest.mark.slow, pytest.mark.usefixtures("under_server")]
ASKED = {"road_writer": "testkit_asking", "decoder": "greedy", "backbone": {"name": "scripted", "answers": ["ok"] * 20}}


@pytest.fixture
def work(tmp_path, reports, under_server):
    """Runs a config over reports under the server; endings, and the task runs of the flow run, by name."""

    def run(config, detail="stage", workers="auto", **words):
        made = batch_of(cases_in([reports(**words)]), [config], tmp_path / "out", jobs=2).shown(detail, workers)
        endings = {}
        run_batch.evaluate(made, lambda job, ending, _: endings.update({job.case.id: ending.result}))
        links = json.loads((tmp_path / "out" / "kit" / next(iter(endings)) / "links.json").read_text())
        return endings, task_runs(under_server, links["prefect"].rsplit("/", 1)[-1])

    return run


def task_runs(server, flow_run, seconds=60):
    """Task runs of a flow run by name, each a list, once two looks see the same: a server writes them once a second."""
    body = {"flow_runs": {"id": {"any_": [flow_run]}}}
    deadline, before = time.monotonic() + seconds, None
    while time.monotonic() < deadline:
        time.sleep(1.5)
        runs = httpx.post(f"{server.address}/task_runs/filter", json=body, timeout=30).json()
        seen = sorted((run["id"], run["state_type"], run["run_count"]) for run in runs)
        if seen == before and not {"PENDING", "SCHEDULED", "RUNNING"} & {run["state_type"] for run in runs}:
            break
        before = seen
    found = {}
    for run in runs:
        found.setdefault(run["name"], []).append(run)
    return found


def test_a_simulator_that_is_killed_is_retried_and_shows_it(work, config_file, tmp_path):
    config = config_file(simulator={"name": "testkit", "died": str(tmp_path / "died")})
    endings, runs = work(config, a="")
    assert endings["a"]["status"] == "generated"
    (simulated,) = runs["simulate"]
    assert (simulated["state_name"], simulated["run_count"]) == ("Completed", 2)
    assert simulated["tags"] == ["simulator"]


def test_a_process_that_dies_leaves_a_crashed_task_and_no_other_case(work, config_file, tmp_path):
    endings, runs = work(config_file(), a="", b="DIE", c=f"DIE ONCE {tmp_path / 'killed'}", d="REFUSE")
    assert {name: result["status"] for name, result in endings.items()} == {
        "a": "generated", "b": "failed", "c": "generated", "d": "refused",
    }  # fmt: skip
    states = {name: {run["state_name"] for run in those} for name, those in runs.items()}
    assert states["kit/b"] == {"Crashed"}
    assert "Lacking" in states["kit/c"]
    assert states["kit/d"] == {"Refused"}
    assert states["road[1]"] >= {"Accepted", "Refused"}
    assert not {run["state_type"] for those in runs.values() for run in those} & {"PENDING", "SCHEDULED"}


@pytest.mark.parametrize("workers", ["auto", "threads", "processes"])
def test_a_case_is_the_same_wherever_it_runs(work, config_file, workers):
    endings, runs = work(config_file(**ASKED), workers=workers, a="", b="")
    assert {result["status"] for result in endings.values()} == {"generated"}
    assert len(runs["road[1]"]) == 2
    assert {run["tags"][0] for run in runs["road[1]"]} == {"gpu"}


def test_prefect_keeps_nothing_of_a_case_that_is_tracked(tmp_path, reports, config_file):
    from prefect.context import FlowRunContext

    made = batch_of(cases_in([reports(a="", b="", c="")]), [config_file()], tmp_path / "out", jobs=2)
    kept = []

    def look(*_):
        around = FlowRunContext.get()
        kept.append((len(around.run_results), len(around.task_run_assets)))

    run_batch.evaluate(made.shown("stage", "processes"), look)
    assert kept == [(0, 0)] * 3


def test_a_batch_in_less_detail_has_one_task_a_case(work, config_file):
    endings, runs = work(config_file(), detail="case", a="", b="REPAIR")
    assert {name: result["status"] for name, result in endings.items()} == {"a": "generated", "b": "exhausted"}
    assert {name: [run["state_name"] for run in those] for name, those in runs.items()} == {
        "kit/a": ["Lacking"], "kit/b": ["Exhausted"],
    }  # fmt: skip
