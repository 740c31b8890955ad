"""Makes the work pool, deploys every flow of prefect.yaml and makes the automation of dead_runs.yaml.

python -m deploy.serve     # on the server that PREFECT_API_URL names: the container `deployments`
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from typing import Any

import httpx
import yaml

from deploy import services
from flows import health
from sgcad_core import settings
from sgcad_core.errors import MissingTool

LIMIT_S = 300.0


def serve(api: str, home: Path | None = None, work: Path = settings.ROOT) -> None:
    """Make the pool and deploy the flows; repeating it is safe. Raises MissingTool with the server's message.

    `home` is Prefect's folder; flow runs start in the folder `work`, which is where relative paths begin.
    """
    _make_pool(api)
    _make_automation(api)
    environment = settings.subprocess_environment() | {**services.QUIET, "PREFECT_API_URL": api}
    if home:
        environment["PREFECT_HOME"] = str(home)
    done = subprocess.run(  # noqa: S603 - our own command
        services.deploy_command(), cwd=work, env=environment, capture_output=True, text=True, timeout=LIMIT_S
    )
    if done.returncode:
        raise MissingTool(f"`prefect deploy --all` fails:\n{(done.stdout + done.stderr)[-2000:]}")


def _make_pool(api: str) -> None:
    """Make the work pool unless it exists; the first worker adds its settings."""
    _asked(api, "POST", "work_pools/", {"name": health.POOL, "type": "process"}, httpx.codes.CONFLICT)


def _make_automation(api: str) -> None:
    """Make the automation of dead_runs.yaml. One that is as it should be is left: an update forgets what it watches."""
    wanted = yaml.safe_load(services.DEAD_RUNS.read_text(encoding="utf-8"))
    found = _asked(api, "POST", "automations/filter", {"automations": {"name": {"any_": [wanted["name"]]}}}).json()
    for automation in found:
        if not _holds(automation, wanted):
            _asked(api, "PUT", f"automations/{automation['id']}", wanted)
    if not found:
        _asked(api, "POST", "automations/", wanted)


def _holds(found: Any, wanted: Any) -> bool:
    """Whether a server's answer has what was asked for; it adds keys of its own."""
    if isinstance(wanted, dict):
        return isinstance(found, dict) and all(key in found and _holds(found[key], wanted[key]) for key in wanted)
    if isinstance(wanted, list):
        return len(found) == len(wanted) and all(map(_holds, found, wanted))
    return bool(found == wanted)


def _asked(api: str, method: str, path: str, body: dict[str, Any], fine: int = 0) -> httpx.Response:
    """The server's answer. Raises MissingTool with its message; the status `fine` is no fault."""
    try:
        answer = httpx.request(method, f"{api}/{path}", json=body, timeout=LIMIT_S, auth=health.key_of())
    except httpx.HTTPError as fault:
        raise MissingTool(f"{api} does not answer ({type(fault).__name__}): is PREFECT_API_URL right?") from fault
    if not answer.is_success and answer.status_code != fine:
        raise MissingTool(f"{api}/{path}: {answer.status_code} {answer.text[:500]}")
    return answer


def main() -> int:
    """Exit code: 0, or 2 with a message."""
    try:
        serve(settings.prefect_url().rstrip("/"), work=Path(settings.environment("SGCAD_WORK") or settings.ROOT))
    except MissingTool as fault:
        sys.stderr.write(f"deploy: error: {fault}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
