"""What MLflow could not log to is found in seconds, named, and told what to do about."""

import errno
import socket
import sqlite3
import subprocess
import sys
import time

import pytest

from plugins.tracker import mlflow_database
from plugins.tracker.mlflow import MlflowTracker
from sgcad_core.errors import ConfigError


@pytest.fixture
def database(tmp_path):
    file = tmp_path / "mlflow.db"
    with sqlite3.connect(file) as made:
        made.execute("CREATE TABLE runs (id)")
    made.close()
    return file


def test_a_database_of_ones_own_and_none_yet_are_ready(database, tmp_path):
    MlflowTracker().ready(tmp_path)
    MlflowTracker().ready(tmp_path / "new")
    assert not (tmp_path / "new").exists()


def test_a_folder_in_its_place_is_named(tmp_path):
    (tmp_path / "mlflow.db").mkdir()
    with pytest.raises(
        ConfigError, match=r"mlflow.db: is a folder, where MLflow's database would be; move it away, or"
    ):
        MlflowTracker().ready(tmp_path)


def test_a_file_that_is_no_database_is_named(tmp_path):
    (tmp_path / "mlflow.db").write_text("a shopping list")
    with pytest.raises(ConfigError, match=r"this is no database of MLflow's; move it away"):
        MlflowTracker().ready(tmp_path)


def test_a_database_that_another_program_holds_is_named_in_time(database, tmp_path, monkeypatch):
    monkeypatch.setattr(mlflow_database, "LOCKED_S", 0.2)
    holder = sqlite3.connect(database, isolation_level=None)
    holder.execute("BEGIN EXCLUSIVE")
    started = time.monotonic()
    with pytest.raises(ConfigError, match=r"another program keeps MLflow's database locked .*; end that program"):
        MlflowTracker().ready(tmp_path)
    assert time.monotonic() - started < 5
    holder.close()


def test_a_database_that_may_not_be_written_is_named(database, tmp_path, monkeypatch):
    monkeypatch.setattr(mlflow_database.os, "access", lambda *_: False)  # root may write everywhere
    with pytest.raises(ConfigError, match=r"cannot be written; make it writable"):
        MlflowTracker().ready(tmp_path)


@pytest.mark.parametrize("fault", [OSError(errno.ENOSPC, "No space left on device"),
                                   sqlite3.OperationalError("database or disk is full")])  # fmt: skip
def test_a_full_disk_is_told_as_one(fault):
    assert mlflow_database.reason(fault) == "there is no room left on the disk"
    assert mlflow_database.remedy(fault) == "make room"


def test_a_server_that_is_not_there_is_found_at_once(tmp_path):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    for uri in (f"http://me:secret@127.0.0.1:{port}", f"postgresql+psycopg2://me:secret@127.0.0.1:{port}/mlflow"):
        with pytest.raises(ConfigError, match=r"//127.0.0.1:.*no MLflow server answers .*; start that server, or log"):
            MlflowTracker(uri=uri).ready(tmp_path)


def test_looking_imports_no_mlflow(database, tmp_path):
    code = (
        "import sys; from pathlib import Path; from plugins.tracker.mlflow_database import check_file\n"
        f"check_file(Path({str(database)!r})); print('mlflow' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
