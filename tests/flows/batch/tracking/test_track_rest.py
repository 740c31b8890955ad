"""Finished cases are logged by a process of its own, also those that a killed one or a locked database has left."""

import json
import sqlite3
import subprocess
import sys
import time
from pathlib import Path

import mlflow
import pytest
from filelock import FileLock

from flows.batch import config_folder
from flows.batch.tracking import track_rest
from flows.case_files import case_links
from sgcad_core.config import load
from sgcad_core.settings import ROOT

RESULT = {"status": "generated", "collision": {"realised": True}, "seconds": {"read": 0.1}}
WAIT_S = 120.0


def finish(out, case, config="template"):
    """A finished case, as a command leaves it."""
    folder = out / config / case
    folder.mkdir(parents=True)
    (folder / "report.txt").write_text("V1 hit V2.")
    (folder / ".source").write_text(str(ROOT / "docs" / "demo" / "left-turn-at-signal"))
    (folder / "result.json").write_text(json.dumps(RESULT))


@pytest.fixture
def out(tmp_path):
    """An output folder of one config, with a finished case."""
    config_folder.write(tmp_path / "template", load("template.yaml", ("tracker.system_metrics_s=0",)))
    finish(tmp_path, "c1")
    return tmp_path


def log_all(out):
    """What the process does, and its exit code; its messages stand in the log as from `start`."""
    with (out / track_rest.LOG).open("ab") as log:
        command = [sys.executable, "-m", "flows.batch.tracking.track_rest", str(out)]
        return subprocess.run(command, cwd=ROOT, stdout=log, stderr=log, check=False).returncode


def logged(out):
    client = mlflow.MlflowClient(tracking_uri=f"sqlite:///{out / 'mlflow.db'}")
    runs = client.search_runs([client.get_experiment_by_name("sgcad").experiment_id])
    return sorted(run.info.run_name for run in runs if run.data.tags["sgcad.level"] == "case")


def wait_until(holds):
    deadline = time.monotonic() + WAIT_S
    while not holds() and time.monotonic() < deadline:
        time.sleep(0.1)
    assert holds()


@pytest.mark.slow
def test_a_started_process_logs_every_case_of_the_folder_and_ends(out):
    finish(out, "c2")
    track_rest.start(out)
    wait_until(lambda: "2 cases" in (out / track_rest.LOG).read_text())
    wait_until(lambda: not (out / track_rest.LOCK).exists())
    assert logged(out) == ["c1", "c2"]
    assert case_links.kept(out / "template" / "c1")["mlflow"].startswith("/#/experiments/")
    (out / track_rest.LOG).unlink()
    track_rest.start(out)
    assert not (out / track_rest.LOG).exists()


@pytest.mark.slow
def test_a_case_is_logged_once_and_one_that_came_later_is_added(out):
    assert log_all(out) == 0
    finish(out, "c2")
    assert log_all(out) == 0
    assert logged(out) == ["c1", "c2"]


@pytest.mark.slow
def test_what_a_killed_process_left_the_next_one_logs(out):
    for number in range(2, 40):
        finish(out, f"c{number}")
    track_rest.start(out)
    wait_until(lambda: list(out.glob("template/*/.tracked")))
    lock = out / track_rest.LOCK
    (pid,) = subprocess.run(["pgrep", "-f", f"track_rest {out}"], capture_output=True, text=True).stdout.split()
    subprocess.run(["kill", "-9", pid], check=True)
    assert len(list(out.glob("template/*/.tracked"))) < 39
    assert lock.exists()
    assert log_all(out) == 0
    assert len(logged(out)) == 39


def test_a_second_process_leaves_the_folder_to_the_first(out):
    with FileLock(out / track_rest.LOCK):
        assert log_all(out) == 0
    assert not (out / "mlflow.db").exists()


@pytest.mark.slow
def test_a_database_that_cannot_be_written_is_told_in_the_log_and_by_the_next_command(out, caplog):
    assert log_all(out) == 0
    finish(out, "c2")
    with sqlite3.connect(out / "mlflow.db", isolation_level=None) as holder:
        holder.execute("BEGIN EXCLUSIVE")
        assert log_all(out) == 1
        holder.execute("ROLLBACK")
    assert "keeps the tracker's database locked" in track_rest.last_fault(out)
    track_rest.start(out)
    assert "cases before were not tracked (another program keeps the tracker's database locked" in caplog.text
    wait_until(lambda: logged(out) == ["c1", "c2"])


def test_no_process_starts_without_a_tracker(out, monkeypatch):
    monkeypatch.setattr(subprocess, "Popen", lambda *_, **__: pytest.fail("a process was started"))
    config_folder.write(out / "template", load("template.yaml", ("tracker=none",)))
    track_rest.start(out)
    track_rest.start(out / "nothing")


def test_start_does_not_import_the_trackers_library(out):
    code = (
        "import subprocess, sys; from pathlib import Path; from flows.batch.tracking import track_rest\n"
        "subprocess.Popen = lambda *given, **more: print('started')\n"
        "track_rest.start(Path(sys.argv[1])); print('mlflow' in sys.modules)\n"
    )
    said = subprocess.run([sys.executable, "-c", code, str(out)], cwd=ROOT, capture_output=True, text=True, check=True)
    assert said.stdout.split() == ["started", "False"]


def test_a_login_reaches_the_process_by_its_environment_alone(out, monkeypatch):
    started = []
    monkeypatch.setattr(subprocess, "Popen", lambda command, **more: started.append((command, more["env"])))
    config = load("template.yaml", ("tracker.uri=http://me:secret@127.0.0.1:1",))
    config_folder.write(out / "template", config)
    track_rest.start(out, [config])
    ((command, environment),) = started
    assert not any("secret" in word for word in command)
    assert json.loads(environment[track_rest.LOGINS]) == {"template": "http://me:secret@127.0.0.1:1"}
    assert "secret" not in Path(out / "template" / "config.yaml").read_text()
