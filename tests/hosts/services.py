"""What the hub serves: PostgreSQL, Prefect's server and MLflow's on it, object storage, Dask's scheduler; a worker."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import httpx

from tests.hosts.network import HUB, Network, postgres_programs

ROOT = Path(__file__).resolve().parent.parent.parent
API = f"http://{HUB}:4200/api"
MLFLOW = f"http://{HUB}:5000"
STORAGE = f"http://{HUB}:9000"
BUCKET = "studies"
SCHEDULER = f"tcp://{HUB}:8786"
START_S = 300.0

COMMON = {
    "PYTHONPATH": str(ROOT),
    "PWD": str(ROOT),
    "PREFECT_API_URL": API,
    "PREFECT_SERVER_ANALYTICS_ENABLED": "false",
    "DO_NOT_TRACK": "1",
    "MLFLOW_DISABLE_TELEMETRY": "true",
    "HF_HUB_OFFLINE": "1",
    "AWS_ACCESS_KEY_ID": "none",
    "AWS_SECRET_ACCESS_KEY": "none",
    "AWS_DEFAULT_REGION": "us-east-1",
    "AWS_ENDPOINT_URL": STORAGE,
    "DASK_DISTRIBUTED__COMM__TIMEOUTS__TCP": "15s",  # 30 by default: a host without network is given up
    "FSSPEC_S3": '{"config_kwargs": {"connect_timeout": 5, "read_timeout": 10, "retries": {"max_attempts": 2}}}',
}


def python(*words: str) -> list[str]:
    """A module of this environment."""
    return [sys.executable, "-m", *words]


def postgres(net: Network) -> None:
    """A cluster of its own with one database for each server."""
    programs = postgres_programs()
    assert programs is not None
    data = net.folder / "postgres"
    data.mkdir()
    subprocess.run(["chown", "postgres:postgres", str(data)], check=True)
    make = [programs / "initdb", "--pgdata", data, "--auth", "trust", "--username", "sgcad", "--encoding", "UTF8"]
    become = ["setpriv", "--reuid=postgres", "--regid=postgres", "--clear-groups"]
    subprocess.run([*become, *make], check=True, capture_output=True, cwd="/")
    with (data / "pg_hba.conf").open("a") as rules:
        rules.write("host all all 10.77.0.0/24 trust\n")
    quick = ["-c", "fsync=off", "-c", "max_connections=200"]  # the machine's disk is no part of this test
    command = [str(programs / "postgres"), "-D", str(data), "-h", HUB, "-k", str(data), *quick]
    net.start("hub", command, {"PWD": "/"}, user="postgres")
    for name in ("prefect", "mlflow"):
        made = [str(programs / "createdb"), "--host", str(data), "--username", "sgcad", name]
        until(f"database {name}", lambda made=made: subprocess.run(made, capture_output=True).returncode == 0)


def serve(net: Network) -> None:
    """Start the hub's services and wait until they answer."""
    postgres(net)
    database = f"postgresql+asyncpg://sgcad@{HUB}/prefect"
    net.start(
        "hub", python("prefect", "server", "start", "--host", HUB, "--no-ui"),
        COMMON | {"PREFECT_SERVER_DATABASE_CONNECTION_URL": database},
    )  # fmt: skip
    net.start(
        "hub", python("mlflow", "server", "--host", HUB, "--port", "5000", "--workers", "1", "--allowed-hosts", "*",
                      "--backend-store-uri", f"postgresql://sgcad@{HUB}/mlflow",
                      "--artifacts-destination", f"s3://{BUCKET}/mlflow"),
        COMMON | {"MLFLOW_S3_ENDPOINT_URL": STORAGE, "MLFLOW_SERVER_ENABLE_JOB_EXECUTION": "false"},
    )  # fmt: skip
    net.start("hub", python("moto.server", "--host", HUB, "--port", "9000"), COMMON)
    net.start("hub", python("distributed.cli.dask_scheduler", "--host", HUB, "--no-dashboard"), COMMON)
    for address in (f"{STORAGE}/", f"{API}/health", f"{MLFLOW}/health"):
        until(address, lambda address=address: answers(address))
    httpx.put(f"{STORAGE}/{BUCKET}", timeout=30).raise_for_status()


def worker(net: Network, host: str) -> subprocess.Popen[bytes]:
    """A host's Dask worker, one case at a time, which its system starts again whenever it ends."""
    words = python("distributed.cli.dask_worker", SCHEDULER, "--name", host, "--nthreads", "1", "--no-dashboard")
    return net.start(host, ["sh", "-c", 'while :; do "$@"; sleep 1; done', "sh", *words], COMMON)


def answers(address: str) -> bool:
    """Whether something speaks HTTP there."""
    try:
        return httpx.get(address, timeout=5).status_code < 500
    except httpx.HTTPError:
        return False


def until(what: str, there: Callable[[], bool], patience_s: float = START_S) -> None:
    """Wait for something. Raises TimeoutError that names it."""
    deadline = time.monotonic() + patience_s
    while not there():
        if time.monotonic() > deadline:
            raise TimeoutError(f"{what}: not within {patience_s:.0f} s")
        time.sleep(0.5)
