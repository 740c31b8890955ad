"""Makes the work pool and deploys every flow of prefect.yaml on a Prefect server.

python -m deploy.serve     # on the server that PREFECT_API_URL names: the container `deployments`
"""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import httpx

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
    body = {"name": health.POOL, "type": "process"}
    try:
        answer = httpx.post(f"{api}/work_pools/", json=body, timeout=LIMIT_S, auth=health.key_of())
    except httpx.HTTPError as fault:
        raise MissingTool(f"{api} does not answer ({type(fault).__name__}): is PREFECT_API_URL right?") from fault
    if answer.status_code not in (httpx.codes.CREATED, httpx.codes.CONFLICT):
        raise MissingTool(f"{api}: no work pool can be made: {answer.status_code} {answer.text[:500]}")


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
