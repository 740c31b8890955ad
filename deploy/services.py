"""Commands, ports and health addresses of the long-running services. Starts nothing."""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from flows.health import POOL
from flows.server import BULK
from sgcad_core import settings

QUIET = {
    "PREFECT_SERVER_ANALYTICS_ENABLED": "false",
    "DO_NOT_TRACK": "1",
    "MLFLOW_DISABLE_TELEMETRY": "true",
    "MLFLOW_SERVER_ENABLE_JOB_EXECUTION": "false",
    "PYTHONUNBUFFERED": "1",
}
"""No telemetry, no processes for MLflow's background jobs, logs line by line."""

DEPLOYMENTS = settings.ROOT / "deploy" / "prefect.yaml"
DEAD_RUNS = settings.ROOT / "deploy" / "dead_runs.yaml"


@dataclass(frozen=True)
class Service:
    """One process: its command, its page (`address`) and its health check (`health`)."""

    name: str
    command: tuple[str, ...]
    port: int
    address: str
    health: str
    environment: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Ports:
    """Ports of the services; the worker's answers health checks only."""

    server: int = 4200
    mlflow: int = 5000
    worker: int = 4201


def api_of(host: str, port: int) -> str:
    """The value of PREFECT_API_URL for a server."""
    return f"http://{host}:{port}/api"


def server(home: Path, port: int, host: str = "127.0.0.1", database: str = "") -> Service:
    """Prefect's server; `database` such as postgresql+asyncpg://..., by default sqlite in `home`."""
    environment = {"PREFECT_HOME": str(home), "PREFECT_UI_API_URL": api_of(host, port), **BULK, **QUIET}
    if database:
        environment["PREFECT_API_DATABASE_CONNECTION_URL"] = database
    command = ("prefect", "server", "start", "--host", host, "--port", str(port))
    return Service("server", _here(command), port, f"http://{host}:{port}", f"{api_of(host, port)}/health", environment)


def mlflow(store: str, artifacts: str, port: int, host: str = "127.0.0.1") -> Service:
    """MLflow's server over a database (sqlite:///..., postgresql://...), handing out artifacts from an address."""
    command = (
        "mlflow", "server", "--backend-store-uri", store, "--artifacts-destination", artifacts,
        "--host", host, "--port", str(port), "--workers", "1",
    )  # fmt: skip
    return Service("mlflow", _here(command), port, f"http://{host}:{port}", f"http://{host}:{port}/health", dict(QUIET))


def worker(home: Path, api: str, port: int, out: Path, limit: int = 2) -> Service:
    """A worker that runs up to `limit` flow runs at a time, each in a process of its own; results go to `out`."""
    command = (
        "prefect", "worker", "start", "--pool", POOL, "--type", "process", "--name", "local",
        "--limit", str(limit), "--with-healthcheck", "--install-policy", "never",
    )  # fmt: skip
    environment = {
        "PREFECT_HOME": str(home),
        "PREFECT_API_URL": api,
        "PREFECT_WORKER_WEBSERVER_HOST": "127.0.0.1",
        "PREFECT_WORKER_WEBSERVER_PORT": str(port),
        "SGCAD_OUT": str(out),
        **QUIET,
    }
    address = f"work pool {POOL!r}, {limit} flow runs at a time"
    return Service(name="worker", command=_here(command), port=port, address=address, environment=environment,
                   health=f"http://127.0.0.1:{port}/health")  # fmt: skip


def deploy_command() -> tuple[str, ...]:
    """The command that deploys every flow of deploy/prefect.yaml, run in the checkout."""
    return _here(("prefect", "--no-prompt", "deploy", "--all", "--prefect-file", str(DEPLOYMENTS)))


def _here(command: tuple[str, ...]) -> tuple[str, ...]:
    """The command run by this interpreter, independent of PATH."""
    return (sys.executable, "-m", *command)
