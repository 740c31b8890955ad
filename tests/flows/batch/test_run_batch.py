"""A batch without Prefect: what one case dies of, the others survive."""

import threading
from types import SimpleNamespace

import pytest

from flows.batch import run_batch
from sgcad_core.errors import MissingTool

ASKED = {"road_writer": "testkit_asking", "decoder": "greedy"}


def work(batch, on_step=None):
    """Endings of all cases."""
    endings = {}
    run_batch.evaluate_alone(batch, lambda job, ending, _: endings.setdefault(job.case.id, ending), on_step=on_step)
    return endings


def statuses(endings):
    return {name: ending.result["status"] for name, ending in sorted(endings.items())}


@pytest.mark.slow
def test_a_case_that_kills_its_process_fails_alone(batch):
    endings = work(batch(a="", b="DIE", c="", d="RAISE", e="REFUSE"))
    assert statuses(endings) == {
        "a": "generated", "b": "failed", "c": "generated", "d": "failed", "e": "refused",
    }  # fmt: skip
    assert "the process that ran it died, twice" in endings["b"].result["reason"]


@pytest.mark.slow
def test_a_process_killed_from_outside_costs_no_case(batch, tmp_path):
    endings = work(batch(a=f"DIE ONCE {tmp_path / 'killed'}", b=""))
    assert (tmp_path / "killed").exists()
    assert statuses(endings) == {"a": "generated", "b": "generated"}


@pytest.mark.slow
def test_running_again_skips_what_is_done_and_tries_failures_again(batch):
    work(batch(a="", b="RAISE", c="REFUSE"))
    again = work(batch())
    assert {name: e.reused for name, e in again.items()} == {"a": True, "b": False, "c": True}
    assert again["a"].result["status"] == "generated"
    fresh = work(batch(fresh=True))
    assert not any(e.reused for e in fresh.values())


def test_what_checks_and_plays_a_single_case_is_started_beforehand_and_a_fault_waits_for_its_call():
    started = []

    class Quick:
        def load(self):
            started.append(self)

    class Lacking:
        def load(self):
            raise MissingTool("no such program")

    config = SimpleNamespace(validators=(Lacking(), Quick()), simulator=Quick())
    run_batch._load_programs(SimpleNamespace(config=config))
    assert started == [config.validators[1], config.simulator]


def test_a_single_case_runs_in_this_process_and_tells_its_steps(batch):
    steps = []
    assert statuses(work(batch(a=""), on_step=lambda *told: steps.append(told))) == {"a": "generated"}
    assert steps[:3] == [("kit/a", "read"), ("kit/a", "retrieve[road]"), ("kit/a", "road[1]")]


@pytest.mark.slow
def test_a_missing_tool_ends_the_batch_with_its_remedy(batch):
    with pytest.raises(MissingTool, match="netconvert is not installed"):
        work(batch(a="TOOLLESS", b=""))


def test_a_model_is_asked_in_this_process(batch, config_file):
    steps = []
    answers = [{"attempt": 1, "answer": "no"}, {"attempt": 2, "answer": "ok"}]
    asking = config_file(**ASKED, backbone={"name": "scripted", "answers": answers})
    endings = work(batch(config=asking, a="", b=""), on_step=lambda job, step: steps.append((job, step)))
    assert statuses(endings) == {"a": "generated", "b": "generated"}
    assert [step for job, step in steps if job == "kit/a" and step.startswith("road")] == ["road[1]", "road[2]"]


@pytest.mark.parametrize("fault", [None, MissingTool("no weights")])
def test_a_model_is_loaded_at_once_and_a_fault_is_left_to_its_first_question(batch, config_file, monkeypatch, fault):
    loaded = threading.Event()

    def load(model):
        loaded.set()
        if fault:
            raise fault

    made = batch(config=config_file(**ASKED, backbone={"name": "scripted", "answers": ["ok"]}), a="")
    monkeypatch.setattr(type(made.configs[0].backbone), "load", load)
    assert statuses(work(made)) == {"a": "generated"}
    assert loaded.wait(10)
    loaded.clear()
    work(made)  # nothing is left to ask
    assert not loaded.wait(0.2)


def test_a_stopped_batch_leaves_no_failed_case(batch, tmp_path):
    def interrupt(job, step):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        work(batch(a="SLOW"), on_step=interrupt)
    assert not list((tmp_path / "out" / "kit").glob("a/*"))
