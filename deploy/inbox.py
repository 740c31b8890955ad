"""The inbox of one machine while its services run: its address, and the start and end of its watching run.

Uses Prefect's HTTP interface.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import httpx

from flows import health
from flows.deploy.defaults import inbox_address
from flows.deploy.storage import Place
from sgcad_core import settings
from sgcad_core.errors import MissingTool

DEPLOYMENT = "inbox/inbox"


def place() -> str:
    """The inbox's address; on this machine its folder, which is made."""
    address = inbox_address(None)
    found = Place(str(settings.ROOT / address) if "://" not in address else address)
    if found.is_local:
        Path(found.root).mkdir(parents=True, exist_ok=True)
        return found.root
    return address


def begin(api: str) -> None:
    """Start a run that watches the inbox, unless one runs; the schedule would start it up to ten minutes later."""
    place()
    if not _runs(api, ("PENDING", "RUNNING")):
        _asked(api, f"deployments/{_deployment(api)}/create_flow_run", {"state": {"type": "SCHEDULED"}})


def end(api: str) -> None:
    """Cancel the watching run: its process ends with the worker and cannot tell the server."""
    try:
        for run in _runs(api, ("PENDING", "RUNNING")):
            _asked(api, f"flow_runs/{run['id']}/set_state", {"state": {"type": "CANCELLED"}, "force": True})
    except MissingTool:
        return  # the server has ended as well


def _deployment(api: str) -> str:
    flow, _, name = DEPLOYMENT.partition("/")
    return str(_asked(api, f"deployments/name/{flow}/{name}", None)["id"])


def _runs(api: str, states: tuple[str, ...]) -> list[dict[str, Any]]:
    body = {
        "deployments": {"id": {"any_": [_deployment(api)]}},
        "flow_runs": {"state": {"type": {"any_": list(states)}}},
    }
    found: list[dict[str, Any]] = _asked(api, "flow_runs/filter", body)
    return found


def _asked(api: str, path: str, body: dict[str, Any] | None) -> Any:
    """GET without a body, else POST. Raises MissingTool with the server's message."""
    try:
        method = "GET" if body is None else "POST"
        answer = httpx.request(method, f"{api}/{path}", json=body, timeout=health.ASK_S, auth=health.key_of())
        answer.raise_for_status()
    except httpx.HTTPError as fault:
        raise MissingTool(f"{api}/{path}: the server gives no valid answer: {fault}; is it running?") from fault
    return answer.json()
