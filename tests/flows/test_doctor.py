"""What `sgcad doctor` finds without starting anything."""

import os
import sqlite3
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest

from flows import doctor
from flows.service_checks import CheckFailed


def apart(name, out, **variables):
    """A check as the command runs it: in a process of its own, no server named."""
    environment = {k: v for k, v in os.environ.items() if not k.startswith("PREFECT_API")} | variables
    code = f"""
from pathlib import Path
from flows.doctor import check_apart
from sgcad_core.errors import SgcadError
try:
    print("ok", check_apart({name!r}, Path({str(out)!r}), False))
except SgcadError as fault:
    print("wrong", fault)
"""
    ended = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout.splitlines()[-1]


def database(folder, *rows):
    with sqlite3.connect(folder / "prefect.db") as made:
        made.execute("CREATE TABLE flow_run (id TEXT, state_type TEXT, start_time TEXT)")
        made.executemany("INSERT INTO flow_run VALUES (?, ?, ?)", rows)
    made.close()


def test_no_server_and_no_database_is_made(tmp_path):
    said = apart("flow", tmp_path, PREFECT_HOME=str(tmp_path))
    assert said.startswith("ok Prefect imports; the first batch makes its database")
    assert not list(tmp_path.glob("prefect.db*"))


@pytest.mark.slow
def test_runs_of_killed_batches_are_told_from_the_database(tmp_path):
    new = time.strftime("%Y-%m-%d %H:%M:%S.000000", time.gmtime(time.time() - 60))
    old = "2020-01-01 00:00:00.000000"
    database(tmp_path, ("a", "RUNNING", old), ("b", "COMPLETED", old), ("c", "RUNNING", new), ("d", "RUNNING", None))
    said = apart("flow", tmp_path, PREFECT_HOME=str(tmp_path))
    assert said.startswith("ok ")
    assert "; 1 runs of killed batches still say RUNNING, remove them: prefect flow-run delete a ..." in said


@pytest.mark.slow
def test_a_file_that_is_no_database_of_prefects_is_named(tmp_path):
    (tmp_path / "prefect.db").write_text("no database " * 100)
    said = apart("flow", tmp_path, PREFECT_HOME=str(tmp_path))
    assert said.startswith(f"wrong {tmp_path}/prefect.db: Prefect's database cannot be used (file is not a database)")


@pytest.mark.slow
def test_a_file_that_is_no_database_of_mlflows_is_named(tmp_path):
    (tmp_path / "mlflow.db").write_text("no database " * 100)
    assert apart("tracking", tmp_path).startswith(f"wrong {tmp_path}/mlflow.db: this is no database of MLflow's")


def test_checks_run_side_by_side_and_are_told_in_their_order(monkeypatch, tmp_path, capsys):
    meeting = threading.Barrier(2, timeout=30)

    def meet(out: Path) -> str:
        meeting.wait()
        return "met"

    def fail(out: Path) -> str:
        raise CheckFailed("no room: make some")

    monkeypatch.setattr(doctor, "CHECKS", {"one": meet, "home": fail, "two": meet, "three": meet})
    monkeypatch.setattr(doctor, "SIDE_BY_SIDE", ("two", "one", "three"))
    monkeypatch.setattr(doctor, "NEEDS", {"three": {"home"}})
    assert doctor.examine(tmp_path) is False
    lines = [line.split(" (")[0].split() for line in capsys.readouterr().out.splitlines()]
    assert [" ".join(line) for line in lines] == [
        "ok one: met", "wrong home: no room: make some", "ok two: met", "not checked three: repair home first",
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("services", "url", "real"), [(False, "", ""), (False, "http://x/api", "flow"), (True, "", "flow tracking")]
)
def test_a_real_flow_runs_where_a_server_is_named_or_services_are_asked(monkeypatch, tmp_path, services, url, real):
    monkeypatch.setenv("PREFECT_API_URL", url)
    monkeypatch.setattr(doctor, "CHECKS", dict.fromkeys(("flow", "tracking"), lambda out: "quick"))
    monkeypatch.setattr(doctor, "REAL", dict.fromkeys(("flow", "tracking"), lambda out: "real"))
    told = {name: doctor.check_apart(name, tmp_path, services) for name in ("flow", "tracking")}
    assert " ".join(name for name, said in told.items() if said == "real") == real
