"""The command's own Prefect server: where it can keep its database, and how its end is told."""

from __future__ import annotations

import subprocess
import sys
from contextlib import suppress

import psutil
import pytest

from flows.server import Server, prefect_server
from sgcad_core.errors import MissingTool


def test_a_home_that_is_not_there_is_named_before_anything_starts(monkeypatch, tmp_path):
    """Before, it was called the server's fault, after half a minute."""
    for name in ("PREFECT_HOME", "PREFECT_API_URL"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(tmp_path / "nowhere"))
    with pytest.raises(MissingTool, match=rf"your home folder {tmp_path}/nowhere does not exist.* HOME .*PREFECT_HOME"):
        prefect_server().__enter__()
    assert not (tmp_path / "nowhere").exists()


@pytest.mark.slow
def test_a_server_that_ends_by_itself_is_not_called_killed(monkeypatch, tmp_path):
    """The thread that waits for its parent's end held a lock, and the interpreter aborted with signal 6."""
    (tmp_path / "prefect.db").write_text("no database " * 100)
    monkeypatch.setenv("PREFECT_HOME", str(tmp_path))
    server = Server()
    try:
        with pytest.raises(MissingTool, match=r"does not start \(ended with code 3\)"):
            server.wait()
    finally:
        server.stop()


@pytest.mark.slow
def test_a_server_ends_with_its_parent(monkeypatch, tmp_path):
    monkeypatch.setenv("PREFECT_HOME", str(tmp_path))
    parent = "import os; from flows.server import Server; s = Server(); s.wait(); print(s.process.pid, flush=True); "
    ended = subprocess.run([sys.executable, "-c", parent + "os._exit(0)"], capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    with suppress(psutil.NoSuchProcess):
        psutil.Process(int(ended.stdout)).wait(20)
