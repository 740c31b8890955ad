"""Training logs in MLflow: each line once, however often and by whichever process it is told."""

from tests.plugins.tracker.mlflow_cases import runs_of

LINES = [
    {"event": "begun with", "folder": "weights", "tensors": 128},
    {"step": 20, "seconds": 23.5, "loss": 0.5, "right": 0.8},
    {"step": 40, "seconds": 40.25, "loss": 0.25, "right": 0.9},
]


def test_a_training_log_is_logged_once_however_often_it_is_told(tracker):
    made = tracker()
    assert made.log_training("mini", {"seed": 0}, LINES[:1]) == 0
    assert made.log_training("mini", {"seed": 0}, LINES[:2]) == 2
    assert made.log_training("mini", {"seed": 0}, LINES[:2]) == 0
    again = tracker()
    assert again.log_training("mini", {"seed": 0, "size": "tiny"}, LINES) == 1
    client, (run,), _ = runs_of(again)
    history = client.get_metric_history(run.info.run_id, "loss")
    assert [(m.step, m.value, m.timestamp - run.info.start_time) for m in history] == [
        (20, 0.5, 23_500), (40, 0.25, 40_250)
    ]  # fmt: skip
    assert run.data.params == {"seed": "0", "size": "tiny"}
    assert run.data.tags["event.0"] == "begun with: folder weights, tensors 128"


def test_lines_that_a_killed_import_had_written_are_kept_once(tracker):
    made = tracker()
    made.log_training("mini", {}, LINES)
    client, (run,), _ = runs_of(made)
    client.set_tag(run.info.run_id, "sgcad.lines", "1")
    made.log_training("mini", {}, LINES)
    assert [m.step for m in client.get_metric_history(run.info.run_id, "loss")] == [20, 40]


def test_a_log_begun_anew_is_another_run(tracker):
    made = tracker()
    made.log_training("mini", {}, LINES)
    made.log_training("mini", {}, [LINES[1] | {"loss": 0.75}])
    assert sorted(r.data.metrics["loss"] for r in runs_of(made)[1]) == [0.25, 0.75]
