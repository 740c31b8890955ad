"""A batch in worker processes: what one case dies of, the others survive."""

import threading
from concurrent.futures import CancelledError

import pytest

from flows.batch.plan_batch import Interrupted, JobRunner, batch_of
from flows.case_files.find_cases import cases_in
from sgcad_core.asking.refine import run_at_once
from sgcad_core.errors import ConfigError, MissingTool


@pytest.fixture
def batch(tmp_path, config_file, reports):
    """A batch over reports holding these words."""

    def make(jobs=2, fresh=False, config=None, **words):
        folder = tmp_path / "cases"
        found = cases_in([folder if folder.exists() else reports(**words)])
        return batch_of(found, [config or config_file()], tmp_path / "out", jobs=jobs, fresh=fresh)

    return make


def work(batch):
    """Statuses of all cases, worked off without Prefect."""
    plan, runner = batch.plan(), JobRunner(batch)
    runner.begin(plan)
    endings = {job.case.id: runner.finish(job, run_at_once) for job in plan}
    runner.close()
    return endings


@pytest.mark.slow
def test_a_case_that_kills_its_process_fails_alone(batch):
    endings = work(batch(a="", b="DIE", c="", d="RAISE", e="REFUSE"))
    assert {name: e.result["status"] for name, e in endings.items()} == {
        "a": "generated", "b": "failed", "c": "generated", "d": "failed", "e": "refused",
    }  # fmt: skip
    assert "the worker process ended with exit code 3" in endings["b"].result["reason"]


def test_a_process_killed_from_outside_costs_no_case(batch, tmp_path):
    endings = work(batch(a=f"DIE ONCE {tmp_path / 'killed'}"))
    assert (tmp_path / "killed").exists()
    assert endings["a"].result["status"] == "generated"


@pytest.mark.slow
def test_running_again_skips_what_is_done_and_tries_failures_again(batch):
    work(batch(a="", b="RAISE", c="REFUSE"))
    again = work(batch())
    assert {name: e.reused for name, e in again.items()} == {"a": True, "b": False, "c": True}
    assert again["a"].result["status"] == "generated"
    fresh = work(batch(fresh=True))
    assert not any(e.reused for e in fresh.values())


def test_a_stopped_batch_leaves_no_failed_case(batch, tmp_path):
    made = batch(a="SLOW", b="SLOW", c="")
    plan, runner = made.plan(), JobRunner(made)
    runner.begin(plan)
    runner.stop()
    with pytest.raises((Interrupted, CancelledError)):
        runner.finish(plan[0], run_at_once)
    assert not list((tmp_path / "out" / "kit").glob("[abc]"))


def test_all_faults_of_all_configs_are_told_at_once(batch, config_file, tmp_path):
    found = cases_in([batch(a="").cases[0].source])
    bad = [config_file("one", simulator="nothing"), config_file("two", seed=-1)]
    with pytest.raises(ConfigError, match=r"(?s)one.yaml.*unknown simulator 'nothing'.*two.yaml.*seed"):
        batch_of(found, bad, tmp_path / "elsewhere")
    assert not (tmp_path / "elsewhere").exists()


def test_two_configs_of_one_name_are_refused(batch, config_file, tmp_path):
    first = config_file()
    second = tmp_path / "other" / "kit.yaml"
    second.parent.mkdir()
    second.write_text(first.read_text())
    with pytest.raises(ConfigError, match="two configs are called 'kit'"):
        batch_of(cases_in([batch(a="").cases[0].source]), [first, second], tmp_path / "out")


def test_no_jobs_is_no_number_of_jobs(batch):
    with pytest.raises(ConfigError, match="--jobs 0: at least 1 is needed"):
        batch(jobs=0, a="")


def test_a_model_is_asked_in_this_process(batch, config_file):
    config = config_file(
        road_writer="testkit_asking", decoder="greedy", backbone={"name": "scripted", "answers": ["no", "ok"]}
    )
    made = batch(config=config, a="")
    plan, runner = made.plan(), JobRunner(made)
    runner.begin(plan)
    names = []

    def note(name, turn):
        names.append(name)
        return turn()

    assert not runner.began(plan[0])
    assert runner.finish(plan[0], note).result["status"] == "generated"
    assert names == ["road[1]", "road[2]", "scenario[1]"]


@pytest.mark.parametrize("fault", [None, MissingTool("no weights")])
def test_a_model_is_loaded_while_the_server_starts_and_a_fault_is_left_to_its_first_question(
    batch, config_file, monkeypatch, fault
):
    loaded = threading.Event()

    def load(model):
        loaded.set()
        if fault:
            raise fault

    asked = {"name": "scripted", "answers": ["ok"]}
    made = batch(config=config_file(road_writer="testkit_asking", decoder="greedy", backbone=asked), a="")
    plan, runner = made.plan(), JobRunner(made)
    monkeypatch.setattr(type(plan[0].config.backbone), "load", load)
    runner.begin(plan)
    assert loaded.wait(10)
    assert runner.finish(plan[0], run_at_once).result["status"] == "generated"
    loaded.clear()
    JobRunner(made).begin(plan)  # nothing is left to ask
    assert not loaded.wait(0.2)
