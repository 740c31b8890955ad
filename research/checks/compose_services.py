"""The containers' services without containers: `python -m research.checks.compose_services` (`make check-deploy`).

Takes each service's command, environment and health check from compose.yaml, puts ports and folders of this machine in
place of the containers', and starts them in the order of `depends_on`: PostgreSQL from the system's packages, Prefect's
server and MLflow on it, the deployments, a worker. Ends with 0 if every health check passes, a worker is online and all
flows are served. Needs PostgreSQL's `initdb` and `postgres` (Debian: apt-get install postgresql) and the extra `hosts`.
"""

from __future__ import annotations

import argparse
import os
import pwd
import secrets
import shutil
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import psutil

from flows import health
from research.checks import compose_file
from sgcad_core import settings
from sgcad_core.errors import MissingTool, SgcadError

INNER_PORTS = {"postgres:5432": 0, "server:4200": 0, "mlflow:5000": 0, "worker:8080": 0}
START_S, ASK_S = 300.0, 30.0
ORDER = ("postgres", "server", "mlflow", "deployments", "worker")


@dataclass
class Stage:
    """One machine in place of the containers' network: a port for each service, a folder for the volumes."""

    folder: Path
    environment: dict[str, str]
    ports: dict[str, int] = field(default_factory=lambda: {name: _free_port() for name in INNER_PORTS})

    def local(self, text: str) -> str:
        """A text of compose.yaml with this machine's addresses."""
        for name, port in self.ports.items():
            host, inner = name.split(":")
            text = text.replace(f"@{name}", f"@127.0.0.1:{port}").replace(f"//{name}", f"//127.0.0.1:{port}")
            text = text.replace(f"127.0.0.1:{inner}/", f"127.0.0.1:{port}/").replace(f"{host}:{inner},", f"{host}:*,")
        return text.replace("/data", str(self.folder / "data")).replace("0.0.0.0", "127.0.0.1")  # noqa: S104 - the other way

    def argument(self, name: str, text: str) -> str:
        """A word of a service's command; its own port is a word or the end of one."""
        inner = next((n.split(":")[1] for n in self.ports if n.startswith(f"{name}:")), "")
        if inner and text.removeprefix("--port=") == inner:
            return text.removesuffix(inner) + str(self.ports[f"{name}:{inner}"])
        return self.local(text)

    def variables(self, name: str, service: Mapping[str, Any]) -> dict[str, str]:
        """A service's environment, with the variables of this process that programs need."""
        asked = {key: self.local(str(value)) for key, value in (service.get("environment") or {}).items()}
        if file := asked.get("MLFLOW_AUTH_CONFIG_PATH"):  # its folder is the volume's
            text = self.local((settings.ROOT / file).read_text(encoding="utf-8"))
            asked["MLFLOW_AUTH_CONFIG_PATH"] = str(self.folder / "mlflow_auth.ini")
            Path(asked["MLFLOW_AUTH_CONFIG_PATH"]).write_text(text, encoding="utf-8")
        if name == "worker":
            asked["PREFECT_WORKER_WEBSERVER_PORT"] = str(self.ports["worker:8080"])
        kept = ("PATH", "HOME", "LANG", "LD_LIBRARY_PATH", "VIRTUAL_ENV")
        return {key: os.environ[key] for key in kept if key in os.environ} | QUIET | asked


QUIET = {
    "PREFECT_SERVER_ANALYTICS_ENABLED": "false",
    "DO_NOT_TRACK": "1",
    "MLFLOW_DISABLE_TELEMETRY": "true",
    "MLFLOW_SERVER_ENABLE_JOB_EXECUTION": "false",
    "HF_HUB_OFFLINE": "1",
}
"""What the Dockerfile sets."""


def check(folder: Path) -> Iterator[str]:
    """Start all services; a line for each that is well. Raises MissingTool at the first that is not."""
    needs()
    password, key = secrets.token_hex(12), f"sgcad:{secrets.token_hex(12)}"
    stage = Stage(
        folder, {"POSTGRES_PASSWORD": password, "MLFLOW_PASSWORD": password, "PREFECT_AUTH": key, "SERVER_PORT": "4200"}
    )
    found = compose_file.services(stage.environment)
    (folder / "data").mkdir()
    with ExitStack() as stack:
        for name in ORDER:
            started = time.monotonic()
            if name == "postgres":
                stack.enter_context(postgres(stage, found[name]))
            elif name == "deployments":
                _run_service(stage, name, found[name])
            else:
                _keep(stack, stage, name, found[name])
            yield f"{name}: well after {time.monotonic() - started:.0f} s"
        yield from _online(stage, key)
        yield from _report(stage, key)


def needs() -> None:
    """Raises MissingTool where PostgreSQL or its drivers are not installed."""
    if not _postgres_programs():
        raise MissingTool("PostgreSQL is not installed: apt-get install postgresql")
    try:
        import asyncpg  # noqa: F401 - what Prefect's server needs
        import psycopg2  # noqa: F401 - what MLflow needs
    except ImportError as fault:
        raise MissingTool(f"{fault}: pip install -e '.[hosts]'") from fault


# ------------------------------------------------------------------ services
def _keep(stack: ExitStack, stage: Stage, name: str, service: Mapping[str, Any]) -> None:
    log = stage.folder / f"{name}.log"
    process = _start(stage, name, service, log)
    stack.callback(_end, process)
    _wait(process, stage, name, service, log)


def _start(stage: Stage, name: str, service: Mapping[str, Any], log: Path) -> subprocess.Popen[bytes]:
    program, *rest = [stage.argument(name, word) for word in service["command"]]
    command = [sys.executable, *rest] if program == "python" else [sys.executable, "-m", program, *rest]
    with log.open("ab") as out:
        return subprocess.Popen(  # noqa: S603 - the commands of compose.yaml
            command,
            cwd=settings.ROOT,
            env=stage.variables(name, service),
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=out,
            start_new_session=True,
        )


def _run_service(stage: Stage, name: str, service: Mapping[str, Any]) -> None:
    log = stage.folder / f"{name}.log"
    process = _start(stage, name, service, log)
    try:
        if process.wait(START_S):
            raise MissingTool(f"{name} ends with {process.returncode}:\n{_last(log)}")
    finally:
        _end(process)


def _wait(process: subprocess.Popen[bytes], stage: Stage, name: str, service: Mapping[str, Any], log: Path) -> None:
    """Return when the health check of compose.yaml passes."""
    test = [sys.executable if word == "python" else stage.local(word) for word in service["healthcheck"]["test"][1:]]
    deadline = time.monotonic() + START_S
    while process.poll() is None and time.monotonic() < deadline:
        passed = subprocess.run(  # noqa: S603 - the health checks of compose.yaml
            test, cwd=settings.ROOT, env=stage.variables(name, service), capture_output=True
        )
        if passed.returncode == 0:
            return
        time.sleep(1)
    raise MissingTool(f"{name} is not well after {START_S:g} s or has ended:\n{_last(log)}")


def _online(stage: Stage, key: str) -> Iterator[str]:
    api = f"http://127.0.0.1:{stage.ports['server:4200']}/api"
    deadline = time.monotonic() + START_S
    while not health.workers_online(api, auth=key) and time.monotonic() < deadline:
        time.sleep(0.5)
    for fine, line in health.server_lines(api, auth=key):
        if not fine:
            raise MissingTool(line)
        yield line


def _report(stage: Stage, key: str) -> Iterator[str]:
    """One report through the inbox: deployed flow, worker, PostgreSQL, MLflow."""
    inbox = stage.folder / "data" / "runs" / "inbox"
    shutil.copytree(settings.ROOT / "docs" / "demo" / "rear-end-on-arterial", inbox / "one")
    api, auth = f"http://127.0.0.1:{stage.ports['server:4200']}/api", health.key_of(key)
    deployed = httpx.get(f"{api}/deployments/name/inbox/inbox", auth=auth, timeout=ASK_S).json()
    body = {"parameters": {"settle_s": 0}, "state": {"type": "SCHEDULED"}}
    httpx.post(f"{api}/deployments/{deployed['id']}/create_flow_run", json=body, auth=auth, timeout=ASK_S)
    deadline = time.monotonic() + START_S
    while not list(inbox.glob("done/one-*/outcome.json")) and time.monotonic() < deadline:
        time.sleep(0.5)
    if not list(inbox.glob("done/one-*/one")):
        raise MissingTool(
            f"the report in the inbox was not done; the worker says:\n{_last(stage.folder / 'worker.log')}"
        )
    found = f"http://127.0.0.1:{stage.ports['mlflow:5000']}/api/2.0/mlflow/experiments/get-by-name"
    asked = {"experiment_name": "sgcad"}
    if httpx.get(found, params=asked, timeout=ASK_S).status_code != httpx.codes.UNAUTHORIZED:
        raise MissingTool("MLflow answers without a login")
    answer = httpx.get(found, params=asked, timeout=ASK_S, auth=("sgcad", stage.environment["MLFLOW_PASSWORD"]))
    if answer.status_code != httpx.codes.OK:
        raise MissingTool(f"MLflow has no experiment of the report: {answer.text[:500]}")
    yield "a report in the inbox became a scenario, and MLflow has it"


def _end(process: subprocess.Popen[bytes]) -> None:
    family = [psutil.Process(process.pid), *psutil.Process(process.pid).children(recursive=True)] if (
        psutil.pid_exists(process.pid)
    ) else []  # fmt: skip
    process.terminate()
    for left in psutil.wait_procs(family, timeout=20)[1]:
        left.kill()
    process.wait()


def _last(log: Path) -> str:
    return log.read_text(errors="replace")[-2000:]


# ------------------------------------------------------------------ PostgreSQL
def _postgres_programs() -> Path | None:
    """The folder of initdb and postgres, the newest of Debian's or the one on the path."""
    debian = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"), key=lambda p: int(p.parent.parent.name))
    onpath = shutil.which("initdb")
    return debian[-1].parent if debian else Path(onpath).parent if onpath else None


@contextmanager
def postgres(stage: Stage, service: Mapping[str, Any]) -> Iterator[None]:
    """A database server with the containers' user, password and databases while the block lasts."""
    programs, environment = _postgres_programs() or Path(), service["environment"]
    user = _plain_user()
    data, password = stage.folder / "postgres", stage.folder / "password"
    password.write_text(environment["POSTGRES_PASSWORD"])
    data.mkdir()
    if user:
        shutil.chown(data, user)
        shutil.chown(password, user)
        stage.folder.chmod(0o755)
    port = stage.ports["postgres:5432"]
    made = [programs / "initdb", "-D", data, "-U", environment["POSTGRES_USER"], "--pwfile", password,
            "--auth=scram-sha-256", "-E", "UTF8", "--locale=C"]  # fmt: skip
    subprocess.run(made, user=user, check=True, capture_output=True)  # noqa: S603 - PostgreSQL's own program
    log = (stage.folder / "postgres.log").open("ab")
    command = [str(programs / "postgres"), "-D", str(data), "-p", str(port), "-h", "127.0.0.1", "-k", str(data)]
    process = subprocess.Popen(command, user=user, stdout=log, stderr=log, start_new_session=True)  # noqa: S603
    try:
        ready = [programs / "pg_isready", "-h", "127.0.0.1", "-p", str(port), *service["healthcheck"]["test"][2:]]
        deadline = time.monotonic() + START_S
        while subprocess.run(ready, capture_output=True).returncode and time.monotonic() < deadline:  # noqa: S603
            time.sleep(0.2)
        address = f"postgresql://{environment['POSTGRES_USER']}:{environment['POSTGRES_PASSWORD']}@127.0.0.1:{port}"
        first, second = f"CREATE DATABASE {environment['POSTGRES_DB']}", settings.ROOT / "deploy" / "databases.sql"
        psql = [str(programs / "psql"), f"{address}/postgres", "-v", "ON_ERROR_STOP=1"]
        subprocess.run([*psql, "-c", first, "-f", str(second)], check=True, capture_output=True)  # noqa: S603 - PostgreSQL's own program
        yield
    finally:
        _end(process)


def _plain_user() -> str | None:
    """PostgreSQL refuses to run as root: the user of Debian's package then."""
    if os.getuid() != 0:
        return None
    try:
        return pwd.getpwnam("postgres").pw_name
    except KeyError as fault:
        raise MissingTool(
            "PostgreSQL does not run as root and there is no user postgres: run as another user"
        ) from fault


def _free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port: int = probe.getsockname()[1]
        return port


def main(arguments: Sequence[str] | None = None) -> int:
    """Print a line a service; 0 if all are well, 1 if one is not, 2 where a program is missing."""
    argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter).parse_args(
        arguments
    )
    try:
        needs()
    except MissingTool as fault:
        sys.stderr.write(f"check: {fault}\n")
        return 2
    with tempfile.TemporaryDirectory(prefix="sgcad-check-") as folder:
        try:
            for line in check(Path(folder)):
                sys.stdout.write(line + "\n")
                sys.stdout.flush()
        except (SgcadError, subprocess.SubprocessError, OSError) as fault:
            sys.stderr.write(f"check: {fault}\n")
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
