"""All services of one machine: started once, found well, used, and ended."""

import json
import shutil
import socket
import time

import httpx
import psutil
import pytest

from deploy import local
from deploy.services import Ports
from flows import doctor
from flows.deployments import health
from sgcad_core import settings
from sgcad_core.errors import ConfigError, MissingTool

DEADLINE_S = 300.0


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
    assert "nothing was started here" in capsys.readouterr().out


def test_a_service_that_ended_is_neither_alive_nor_well(tmp_path):
    running = health.Running("server", 2**22 + 1, 0.0, "http://127.0.0.1:9", "http://127.0.0.1:9/api/health", "log")
    health.services_folder(tmp_path).mkdir()
    running.write(health.services_folder(tmp_path))
    assert not running.healthy()
    with pytest.raises(doctor.Trouble, match="server not well, see log"):
        doctor.CHECKS["services"](tmp_path)


def test_a_service_that_ends_at_once_is_told_with_its_last_words(tmp_path):
    import sys

    from deploy.services import Service

    command = (sys.executable, "-c", "import sys; sys.exit('no room for a server')")
    started = local.start(Service("server", command, 1, "", "http://127.0.0.1:9/"), tmp_path)
    with pytest.raises(MissingTool, match=r"(?s)the server has ended; .*no room for a server"):
        local.wait(started, time.monotonic() + 60)


def run_inbox(api, inbox, out):
    """Start the deployed flow as the schedule does; its last state."""
    deployed = httpx.get(f"{api}/deployments/name/inbox/inbox", timeout=30).json()
    parameters = {"address": str(inbox), "config": str(out.parent / "least.yaml"), "out": str(out), "settle_s": 0}
    body = {"parameters": parameters | {"wait_s": 0}, "state": {"type": "SCHEDULED"}}
    started = httpx.post(f"{api}/deployments/{deployed['id']}/create_flow_run", json=body, timeout=30).json()
    deadline = time.monotonic() + DEADLINE_S
    while time.monotonic() < deadline:
        run = httpx.get(f"{api}/flow_runs/{started['id']}", timeout=30).json()
        if run["state_type"] in ("COMPLETED", "FAILED", "CRASHED"):
            return run["state_type"]
        time.sleep(0.5)
    return "still running"


@pytest.mark.slow
def test_up_starts_everything_once_deploys_and_the_worker_does_a_report(tmp_path, monkeypatch):
    for name in ("PREFECT_API_URL", "PREFECT_HOME"):
        monkeypatch.delenv(name, raising=False)
    out, ports = tmp_path / "runs", Ports(*free_ports(3))
    try:
        first = local.up(out, ports)
        assert local.up(out, ports) == first
        assert all(service.healthy() for service in first.values())
        said = doctor.CHECKS["services"](out)
        assert "worker well" in said
        assert "inbox (cron */10 * * * *)" in said
        assert "reindex (cron 0 3 * * 0)" in said
        inbox = tmp_path / "inbox"
        shutil.copytree(settings.ROOT / "docs" / "demo" / "rear-end-on-arterial", inbox / "one")
        least = "\n".join(
            ["report_reader: auto", "retriever: none", "road_writer: template", "scenario_writer: rules",
             "validators: []", "simulator: kinematic", "tracker: none"]
        )  # fmt: skip
        (tmp_path / "least.yaml").write_text(least)
        assert run_inbox(f"http://127.0.0.1:{ports.server}/api", inbox, out) == "COMPLETED"
        (result,) = (out / "least").glob("one-*/result.json")
        assert json.loads(result.read_text())["status"] == "generated"
        family = [p for s in first.values() for p in psutil.Process(s.pid).children(recursive=True)]
    finally:
        ended = local.down(out)
    assert ended == ["worker", "mlflow", "server"]
    assert result.is_file()
    assert not psutil.wait_procs(family, timeout=30)[1]
    assert not any(s.alive() for s in first.values())
