"""All services of one machine: started once, found well, used, and ended."""

import os
import socket
import sys
import time

import httpx
import psutil
import pytest

from deploy import local
from deploy.services import Ports
from flows import doctor, health
from sgcad_core import settings
from sgcad_core.errors import ConfigError, MissingTool


def free_ports(count):
    probes = [socket.socket() for _ in range(count)]
    for probe in probes:
        probe.bind(("127.0.0.1", 0))
    ports = [probe.getsockname()[1] for probe in probes]
    for probe in probes:
        probe.close()
    return ports


def test_a_taken_port_is_named_and_nothing_starts(tmp_path):
    with socket.socket() as other:
        other.bind(("127.0.0.1", 0))
        other.listen()
        taken = other.getsockname()[1]
        with pytest.raises(ConfigError, match=rf"port {taken} of the mlflow is taken .*--mlflow-port N"):
            local.up(tmp_path, Ports(*free_ports(1), taken, *free_ports(1)))
    assert health.noted(health.services_folder(tmp_path)) == {}


def test_down_where_nothing_runs_ends_nothing(tmp_path, capsys):
    assert local.down(tmp_path) == []
    assert local.main(["status", "--out", str(tmp_path)]) == 0
    assert "no service was started here" in capsys.readouterr().out


def test_a_service_that_ended_is_neither_alive_nor_well(tmp_path):
    running = health.Running("server", 2**22 + 1, 0.0, "http://127.0.0.1:9", "http://127.0.0.1:9/api/health", "log")
    health.services_folder(tmp_path).mkdir()
    running.write(health.services_folder(tmp_path))
    assert not running.healthy()
    with pytest.raises(doctor.CheckFailed, match="server not well, see log"):
        doctor.CHECKS["services"](tmp_path)


def test_a_service_that_ends_at_once_is_told_with_its_last_words(tmp_path):
    from deploy.services import Service

    command = (sys.executable, "-c", "import sys; sys.exit('no room for a server')")
    started = local.start(Service("server", command, 1, "", "http://127.0.0.1:9/"), tmp_path)
    with pytest.raises(MissingTool, match=r"(?s)the server has ended; .*no room for a server"):
        local.wait(started, time.monotonic() + 60)


def test_a_worker_gets_the_results_folder(tmp_path):
    worker = local.wanted(tmp_path / "X", Ports())[-1]
    assert worker.environment["SGCAD_OUT"] == str(tmp_path / "X")


def test_the_inbox_is_in_the_results_folder_unless_it_is_named(tmp_path, monkeypatch):
    monkeypatch.delenv("SGCAD_INBOX", raising=False)
    assert local.inbox_of(tmp_path / "X") == str(tmp_path / "X" / "inbox")
    monkeypatch.setenv("SGCAD_INBOX", "s3://reports/new")
    assert local.inbox_of(tmp_path / "X") == "s3://reports/new"


def asked(first, path, body):
    """The server's answer."""
    answer = httpx.post(f"{first['server'].address}/api/{path}", json=body, timeout=60)
    answer.raise_for_status()
    return answer.json()


def until(found, patience_s):
    """The first answer that is one. Fails after a time."""
    deadline = time.monotonic() + patience_s
    while time.monotonic() < deadline:
        if answer := found():
            return answer
        time.sleep(0.5)
    raise AssertionError(f"nothing in {patience_s} s")


def services_only(test):
    """Marks a test that starts every service."""
    reason = "starts every service; run by `make check-deploy`"
    return pytest.mark.slow(pytest.mark.skipif("SGCAD_SERVICES" not in os.environ, reason=reason)(test))


@pytest.fixture
def plain(monkeypatch):
    """No settings of the person who runs the tests."""
    for name in ("PREFECT_API_URL", "PREFECT_HOME", "SGCAD_INBOX", "SGCAD_OUT", "SGCAD_CASES", "SGCAD_OVERRIDES"):
        monkeypatch.delenv(name, raising=False)


@services_only
def test_a_run_whose_worker_is_killed_crashes_soon_and_the_next_one_works(tmp_path, plain):
    out, ports = tmp_path / "runs", Ports(*free_ports(3))
    report = (settings.ROOT / "docs" / "demo" / "rear-end-on-arterial" / "report.txt").read_text()
    try:
        first = local.up(out, ports)
        for number in range(3):
            (out / "inbox" / f"r{number}.txt").write_text(f"{report}\nReport {number}.")
        running = {"flow_runs": {"state": {"type": {"any_": ["RUNNING"]}}}}
        until(lambda: list(out.glob("inbox/.inbox/tries/*")), 150)
        (run,) = asked(first, "flow_runs/filter", running)
        worker = psutil.Process(first["worker"].pid)
        for process in [worker, *worker.children(recursive=True)]:
            process.kill()
        killed = time.monotonic()
        this = {"flow_runs": {"id": {"any_": [run["id"]]}, "state": {"type": {"any_": ["CRASHED"]}}}}
        (run,) = until(lambda: asked(first, "flow_runs/filter", this), 150)
        sys.stdout.write(f"crashed {time.monotonic() - killed:.0f} s after the kill\n")
        assert "No heartbeat for 75 s" in run["state"]["message"]
        local.up(out, ports)
        until(lambda: len(list(out.glob("inbox/done/*/outcome.json"))) == 3, 300)
        assert len(asked(first, "automations/filter", {})) == 1
        assert len(list(out.glob("fused/*/result.json"))) == 3
        assert list(out.glob("**/mlflow.db")) == [out / "mlflow.db"]
        assert "failed to process" not in (out / "services" / "worker.log").read_text()
    finally:
        local.down(out)


@services_only
def test_up_starts_everything_once_and_deploys_and_down_ends_it(tmp_path, plain):
    out, ports = tmp_path / "runs", Ports(*free_ports(3))
    try:
        first = local.up(out, ports)
        assert local.up(out, ports) == first
        assert all(service.healthy() for service in first.values())
        said = doctor.CHECKS["services"](out)
        assert "worker well" in said
        assert "inbox (cron * * * * *)" in said
        assert "reindex (cron 0 3 * * 0)" in said
        family = [p for s in first.values() for p in psutil.Process(s.pid).children(recursive=True)]
    finally:
        ended = local.down(out)
    assert ended == ["worker", "mlflow", "server"]
    assert (out / "mlflow.db").is_file()
    assert not psutil.wait_procs(family, timeout=30)[1]
    assert not any(s.alive() for s in first.values())
