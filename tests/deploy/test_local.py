"""All services of one machine: started once, found well, used, and ended."""

import os
import socket
import time

import psutil
import pytest

from deploy import local
from deploy.services import Ports
from flows import doctor, health
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
    import sys

    from deploy.services import Service

    command = (sys.executable, "-c", "import sys; sys.exit('no room for a server')")
    started = local.start(Service("server", command, 1, "", "http://127.0.0.1:9/"), tmp_path)
    with pytest.raises(MissingTool, match=r"(?s)the server has ended; .*no room for a server"):
        local.wait(started, time.monotonic() + 60)


@pytest.mark.slow
@pytest.mark.skipif("SGCAD_SERVICES" not in os.environ, reason="starts every service; run by `make check-deploy`")
def test_up_starts_everything_once_and_deploys_and_down_ends_it(tmp_path, monkeypatch):
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
        family = [p for s in first.values() for p in psutil.Process(s.pid).children(recursive=True)]
    finally:
        ended = local.down(out)
    assert ended == ["worker", "mlflow", "server"]
    assert (out / "mlflow.db").is_file()
    assert not psutil.wait_procs(family, timeout=30)[1]
    assert not any(s.alive() for s in first.values())
