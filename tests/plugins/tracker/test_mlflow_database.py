"""MLflow's database is there whole or not at all, whoever is interrupted and whoever else begins."""

import signal
import sqlite3
import subprocess
import sys
import threading
import time

import pytest

from plugins.tracker import mlflow_store
from plugins.tracker.mlflow import MlflowTracker
from plugins.tracker.mlflow_database import make_database
from plugins.tracker.mlflow_store import Store
from sgcad_core.errors import ConfigError

MAKE = """
import sys
from plugins.tracker.mlflow_store import Store

Store("sqlite:///" + sys.argv[1], "study/x").experiment_id
"""
HOLD = """
import sys, time
from filelock import FileLock

FileLock(sys.argv[1]).acquire()
print("held", flush=True)
time.sleep(600)
"""


def _start(file):
    return subprocess.Popen(
        [sys.executable, "-c", MAKE, str(file)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )


@pytest.mark.slow
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGKILL])
def test_who_is_interrupted_while_making_it_leaves_none(tmp_path, end):
    file, partial = tmp_path / "mlflow.db", tmp_path / ".mlflow.db.partial"
    process = _start(file)
    deadline = time.monotonic() + 120
    while not (partial.exists() and partial.stat().st_size) and time.monotonic() < deadline:
        time.sleep(0.005)
    process.send_signal(end)
    process.wait(60)
    assert not file.exists()
    assert Store(f"sqlite:///{file}", "x").client.get_experiment("0").name == "Default"
    assert {f.name for f in tmp_path.iterdir() if not f.name.endswith(("-wal", "-shm"))} == {"mlflow.db"}


@pytest.mark.slow
def test_two_who_begin_together_use_one(tmp_path):
    file = tmp_path / "mlflow.db"
    assert [process.wait(120) for process in [_start(file), _start(file)]] == [0, 0]
    assert not (tmp_path / ".mlflow.db.partial").exists()


def test_what_is_there_is_left_alone(tmp_path):
    file = tmp_path / "mlflow.db"
    file.write_text("mine")
    make_database(file)
    assert file.read_text() == "mine"


def test_a_folder_in_its_place_is_told_at_once(tmp_path):
    (tmp_path / "mlflow.db").mkdir()
    started = time.monotonic()
    with pytest.raises(ConfigError, match=r"mlflow\.db: is a folder.*move it away"):
        _ = Store(f"sqlite:///{tmp_path / 'mlflow.db'}", "x").client
    assert time.monotonic() - started < 30


@pytest.mark.slow
def test_a_database_made_anew_has_another_identity(tmp_path):
    tracker = MlflowTracker(experiment="study/x", system_metrics_s=0)
    assert tracker.identity(tmp_path) == ""
    assert _start(tmp_path / "mlflow.db").wait(120) == 0
    first = tracker.identity(tmp_path)
    assert first == tracker.identity(tmp_path) != ""
    (tmp_path / "mlflow.db").rename(tmp_path / "away.db")
    assert tracker.identity(tmp_path) == ""
    assert _start(tmp_path / "mlflow.db").wait(120) == 0
    assert tracker.identity(tmp_path) not in ("", first)


def test_a_broken_database_has_no_identity(tmp_path):
    file = tmp_path / "mlflow.db"
    file.write_text("no database")
    assert Store(f"sqlite:///{file}", "x").identity() == ""
    file.unlink()
    sqlite3.connect(file).close()
    assert Store(f"sqlite:///{file}", "x").identity() == ""


def test_waiting_for_the_lock_ends_with_its_holder(tmp_path):
    holder = subprocess.Popen([sys.executable, "-c", HOLD, str(tmp_path / ".mlflow.db.lock")], stdout=subprocess.PIPE)
    holder.stdout.readline()
    waiting = threading.Thread(target=lambda: make_database(tmp_path / "mlflow.db"))
    waiting.start()
    time.sleep(0.2)
    assert waiting.is_alive()
    holder.kill()
    holder.wait(60)
    holder.stdout.close()
    waiting.join(120)
    assert (tmp_path / "mlflow.db").exists()


def test_a_full_disk_is_told_as_such(tmp_path, monkeypatch):
    from sqlalchemy.exc import OperationalError

    def full(file):
        raise OperationalError("INSERT", {}, sqlite3.OperationalError("database or disk is full"))

    monkeypatch.setattr(mlflow_store, "make_database", full)
    store = Store(f"sqlite:///{tmp_path / 'mlflow.db'}", "sgcad")
    with pytest.raises(ConfigError, match=r"mlflow\.db: there is no room left on the disk; make room, or log"):
        _ = store.client
