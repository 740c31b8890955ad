"""State of the services (server, worker, MLflow, deployments), for `sgcad doctor` and `make up`.

Services on this machine are noted in `<out>/services/*.json`, one file each, by deploy/local.py; workers and
deployments are asked of the Prefect server over HTTP.
"""

from __future__ import annotations

import json
import urllib.request
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from http import HTTPStatus
from pathlib import Path
from typing import Any

import httpx
import psutil

from sgcad_core import settings

POOL = "sgcad"
"""The work pool that deploy/prefect.yaml names."""
ASK_S = 20.0
SAME_S = 2.0
"""A process is told again by number and start; the start is known to within the clock's adjustments."""


@dataclass(frozen=True)
class Running:
    """A service started on this machine: process, addresses and log."""

    name: str
    pid: int
    born: float
    address: str
    health: str
    log: str

    def alive(self) -> bool:
        """Whether this process still runs."""
        try:
            process = psutil.Process(self.pid)
            return bool(abs(process.create_time() - self.born) < SAME_S and process.status() != psutil.STATUS_ZOMBIE)
        except psutil.Error:
            return False

    def healthy(self) -> bool:
        """Whether it runs and its health check passes."""
        return self.alive() and answers(self.health)

    def write(self, folder: Path) -> None:
        """Write the service's note into a folder."""
        (folder / f"{self.name}.json").write_text(json.dumps(asdict(self), indent=1) + "\n", encoding="utf-8")


def services_folder(out: Path) -> Path:
    """Folder of the notes and logs of services."""
    return out / "services"


def noted(folder: Path) -> dict[str, Running]:
    """Services noted in a folder, by name; some may have ended since."""
    found = (json.loads(file.read_text(encoding="utf-8")) for file in sorted(folder.glob("*.json")) if file.is_file())
    return {about["name"]: Running(**about) for about in found}


def answers(url: str) -> bool:
    """Whether a URL answers 200. Called often while services start: httpx would take 20 ms each time."""
    try:
        with urllib.request.urlopen(url, timeout=ASK_S) as answer:  # noqa: S310 - an address of our own service
            return bool(answer.status == HTTPStatus.OK)
    except (OSError, ValueError):
        return False


# ------------------------------------------------------------------ what a Prefect server has
def key_of(auth: str = "") -> tuple[str, str] | None:
    """User and password for a server, by default from the variable PREFECT_API_AUTH_STRING."""
    user, _, password = (auth or settings.environment("PREFECT_API_AUTH_STRING")).partition(":")
    return (user, password) if user else None


def _asked(api: str, path: str, auth: str) -> list[dict[str, Any]]:
    """Raises httpx.HTTPError. `auth`: "user:password"."""
    answer = httpx.post(f"{api.rstrip('/')}/{path}", json={}, timeout=ASK_S, auth=key_of(auth))
    answer.raise_for_status()
    found: list[dict[str, Any]] = answer.json()
    return found


def workers_online(api: str, pool: str = POOL, auth: str = "") -> list[str]:
    """Names of the pool's workers that are online; none if there is no such pool. Raises httpx.HTTPError."""
    try:
        workers = _asked(api, f"work_pools/{pool}/workers/filter", auth)
    except httpx.HTTPStatusError as fault:
        if fault.response.status_code == httpx.codes.NOT_FOUND:
            return []
        raise
    return [w["name"] for w in workers if w["status"] == "ONLINE"]


def deployments(api: str, auth: str = "") -> dict[str, str]:
    """The pool's deployments by name, with their schedules in words. Raises httpx.HTTPError."""
    found = _asked(api, "deployments/filter", auth)
    return {d["name"]: _when(d) for d in sorted(found, key=lambda d: d["name"]) if d["work_pool_name"] == POOL}


def _when(deployment: dict[str, Any]) -> str:
    plans = [s["schedule"] for s in deployment["schedules"] if s["active"]]
    if deployment["paused"]:
        return "paused"
    told = (f"cron {p['cron']}" if "cron" in p else f"every {p.get('interval', '?')} s" for p in plans)
    return ", ".join(told) or "by hand"


def server_lines(api: str, auth: str = "") -> Iterator[tuple[bool, str]]:
    """Lines on a server's workers and deployments, each with whether it is as it should be."""
    try:
        workers, deployed = workers_online(api, auth=auth), deployments(api, auth)
    except httpx.HTTPError as fault:
        yield False, f"{api} does not answer ({type(fault).__name__})"
        return
    yield bool(workers), f"workers online: {', '.join(workers) or 'none, so scheduled runs do not start'}"
    listed = ", ".join(f"{name} ({when})" for name, when in deployed.items())
    yield bool(deployed), f"deployments: {listed or 'none; prefect deploy --all --prefect-file deploy/prefect.yaml'}"
