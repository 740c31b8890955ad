"""All services on this machine: `python -m deploy.local up | down | status` (`make up`, `make down`).

Logs and notes are in `<out>/services`. `up` starts services that do not run; `down` ends them and leaves results,
databases and logs. No service listens beyond this machine.
"""

from __future__ import annotations

import argparse
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import httpx
import psutil

from deploy import services
from deploy.serve import serve
from deploy.services import Ports, Service
from flows import health
from flows.health import Running
from sgcad_core import settings
from sgcad_core.errors import ConfigError, MissingTool, SgcadError
from sgcad_core.system.locks import lock_file

START_S = 240.0
"""Time limit of a start; the first one makes databases: 20 s on two idle cores, minutes on busy ones."""
STOP_S = 20.0
"""Time for a normal end; after that the process is killed."""
LAST_LINES = 15
LOOK_S = 0.5
DEPLOYED = "deployed.yaml"


def wanted(out: Path, ports: Ports, limit: int = 3) -> tuple[Service, ...]:
    """The services of one machine, in the order in which they start."""
    home = health.services_folder(out) / "prefect"
    artifacts = (out / "mlflow-artifacts").as_uri()
    api = services.api_of("127.0.0.1", ports.server)
    return (
        services.server(home, ports.server),
        services.mlflow(f"sqlite:///{out / 'mlflow.db'}", artifacts, ports.mlflow),
        services.worker(home, api, ports.worker, out, limit),
    )


# ------------------------------------------------------------------ up
def up(out: Path, ports: Ports, limit: int = 3) -> dict[str, Running]:
    """Start missing services, deploy, wait for all health checks. Raises ConfigError (port), MissingTool (start)."""
    out = out.resolve()
    with _alone(health.services_folder(out)) as folder:
        asked = wanted(out, ports, limit)
        there = health.noted(folder)
        missing = [s for s in asked if not (s.name in there and there[s.name].alive())]
        _check_ports(missing)
        _start_and_wait([s for s in missing if s.name != "worker"], folder)
        api = f"{health.noted(folder)['server'].address}/api"
        if missing or not _is_deployed(folder):
            _deploy(folder, api)
        _start_and_wait([s for s in missing if s.name == "worker"], folder)
        _wait_for_worker(api, folder)
        if "://" not in inbox_of(out):
            Path(inbox_of(out)).mkdir(parents=True, exist_ok=True)
        return health.noted(folder)


def inbox_of(out: Path) -> str:
    """The inbox's address: the variable SGCAD_INBOX, else the folder inbox of the results."""
    named = settings.environment("SGCAD_INBOX")
    return named if "://" in named else str(settings.ROOT / (named or out.resolve() / "inbox"))


def _wait_for_worker(api: str, folder: Path) -> None:
    """Wait until the server lists a worker, which is later than the worker's health check."""
    deadline = time.monotonic() + START_S
    while not _hears_a_worker(api):
        if time.monotonic() > deadline:
            raise MissingTool(f"the server lists no worker:\n{_last_words(folder / 'worker.log')}")
        time.sleep(LOOK_S)


def _hears_a_worker(api: str) -> bool:
    try:
        return bool(health.workers_online(api))
    except httpx.HTTPError:  # the server is busy: it is asked again
        return False


def _check_ports(asked: Sequence[Service]) -> None:
    """Raises ConfigError naming every port that another program has."""
    taken = [s for s in asked if _is_taken(s.port)]
    if taken:
        which = "; ".join(f"port {s.port} of the {s.name} is taken by another program" for s in taken)
        flags = " ".join(f"--{s.name}-port N" for s in taken)
        raise ConfigError(f"{which}: end it, or choose another with `python -m deploy.local up {flags}`")


def _is_taken(port: int) -> bool:
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except OSError:
            return True
    return False


def _start_and_wait(asked: Sequence[Service], folder: Path) -> None:
    started = [start(service, folder) for service in asked]
    deadline = time.monotonic() + START_S
    for running in started:
        wait(running, deadline)


def start(service: Service, folder: Path) -> Running:
    """Start a service in a session of its own and write its note."""
    log = folder / f"{service.name}.log"
    with log.open("ab") as out:
        process = subprocess.Popen(  # noqa: S603 - our own services
            service.command,
            cwd=settings.ROOT,
            env=settings.subprocess_environment() | dict(service.environment),
            stdin=subprocess.DEVNULL,
            stdout=out,
            stderr=out,
            start_new_session=True,
        )
    born = psutil.Process(process.pid).create_time()
    running = Running(service.name, process.pid, born, service.address, service.health, str(log))
    running.write(folder)
    return running


def wait(running: Running, deadline: float) -> None:
    """Return when a service's health check passes. Raises MissingTool with its last lines if it ends or is silent."""
    while running.alive() and time.monotonic() < deadline:
        if health.answers(running.health):
            return
        time.sleep(LOOK_S)
    how = f"is silent after {START_S:g} s" if running.alive() else "has ended"
    raise MissingTool(f"the {running.name} {how}; {running.log} says:\n{_last_words(Path(running.log))}")


def _last_words(log: Path) -> str:
    return "\n".join(log.read_text(errors="replace").splitlines()[-LAST_LINES:])


def _deploy(folder: Path, api: str) -> None:
    """Deploy the flows and keep a copy of what was deployed."""
    serve(api, folder / "prefect")
    (folder / DEPLOYED).write_bytes(_deployments())


def _is_deployed(folder: Path) -> bool:
    """Whether deployments and automation are unchanged since they were made."""
    last = folder / DEPLOYED
    return last.is_file() and last.read_bytes() == _deployments()


def _deployments() -> bytes:
    return services.DEPLOYMENTS.read_bytes() + b"---\n" + services.DEAD_RUNS.read_bytes()


# ------------------------------------------------------------------ down
def down(out: Path) -> list[str]:
    """End the running services, the worker first; their names. Results and logs stay."""
    with _alone(health.services_folder(out.resolve())) as folder:
        there = health.noted(folder)
        ended = []
        for name in sorted(there, key=["worker", "mlflow", "server"].index):
            if there[name].alive():
                stop(there[name])
                ended.append(name)
            (folder / f"{name}.json").unlink()
        return ended


def stop(running: Running) -> None:
    """End a service and its child processes: SIGTERM first, then SIGKILL; the flow runs of a worker before itself."""
    process = psutil.Process(running.pid)
    family = [process, *process.children(recursive=True)]
    if running.name == "worker":  # which would kill them before they have told the server
        _signal(process.children(), psutil.Process.terminate)
    _signal([process], psutil.Process.terminate)
    _signal([p for p in family if p.is_running()], psutil.Process.kill)


def _signal(processes: list[psutil.Process], how: Callable[[psutil.Process], None]) -> None:
    """Send a signal and wait for the processes to end, at most STOP_S."""
    for process in processes:
        with suppress(psutil.NoSuchProcess):
            how(process)
    psutil.wait_procs(processes, timeout=STOP_S)


@contextmanager
def _alone(folder: Path) -> Iterator[Path]:
    """Hold the folder's lock: one `up` or `down` at a time."""
    folder.mkdir(parents=True, exist_ok=True)
    with lock_file(folder / ".lock"):
        yield folder


# ------------------------------------------------------------------ command
def status(out: Path) -> bool:
    """Print one line per service; whether all started services are well."""
    there = health.noted(health.services_folder(out.resolve()))
    for running in there.values():
        _say(f"{running.name:8} {'well' if running.healthy() else 'WRONG'}  {running.address}  log: {running.log}")
    if not there:
        _say("no service was started here; `make up` starts them")
    return all(running.healthy() for running in there.values())


def _say(line: str) -> None:
    sys.stdout.write(line + "\n")


def _asked(arguments: Sequence[str] | None) -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Services on this machine.")
    parser.add_argument("what", choices=("up", "down", "status"))
    parser.add_argument("--out", type=Path, default=Path("runs"), help="results, databases, logs")
    parser.add_argument("--limit", type=int, default=3, help="flow runs at a time")
    for name in ("server", "mlflow", "worker"):
        parser.add_argument(f"--{name}-port", type=int, default=getattr(Ports(), name))
    return parser.parse_args(arguments)


def main(arguments: Sequence[str] | None = None) -> int:
    """The command; its exit code."""
    asked = _asked(arguments)
    try:
        if asked.what == "up":
            found = up(asked.out, Ports(asked.server_port, asked.mlflow_port, asked.worker_port), asked.limit)
            status(asked.out)
            _say(
                f"inbox: {inbox_of(asked.out)}: put in .txt, .xml, .pdf files or one folder per case; read every minute"
            )
            _say(f"results: {asked.out.resolve()}; reports go to done/, refused/, failed/, unread/ with outcome.json")
            _say(f"export PREFECT_API_URL={found['server'].address}/api")
        elif asked.what == "down":
            _say(f"ended: {', '.join(down(asked.out)) or 'nothing ran'}")
        else:
            return 0 if status(asked.out) else 1
    except SgcadError as fault:
        sys.stderr.write(f"deploy: error: {fault}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
