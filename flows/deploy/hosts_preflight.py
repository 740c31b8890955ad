"""A study on many hosts: the checks before Prefect is imported (flows/deploy/shards.py does the rest).

    hosts_preflight.run(plan(study, out), Hosts("s3://bucket/alpha"), on_ending)    # sgcad study alpha --hosts s3://...

docs/scale.md says how to set the hosts up.
"""

from __future__ import annotations

from flows.batch.track_cases import OnEnding
from flows.server import answers
from flows.study.plan import Plan
from flows.study.watch_shards import Hosts
from sgcad_core import settings
from sgcad_core.errors import ConfigError, MissingTool


def run(plan: Plan, hosts: Hosts, on_ending: OnEnding) -> list[str]:
    """Run a study on the hosts that serve the deployment; the shards submitted again, with reasons.

    Raises ConfigError, MissingTool (no server, no storage), KeyboardInterrupt; marked cases stay finished.
    """
    if plan.batch.fresh:
        raise ConfigError(
            "--fresh with --hosts: the address holds marks of finished cases; give --hosts another address"
        )
    url = settings.prefect_url()
    if not url or not answers(url):
        said = f"{url} does not answer" if url else "none is named"
        raise MissingTool(
            f"--hosts needs a Prefect server that every host reaches, and {said}: export PREFECT_API_URL=http://.../api"
        )
    settings.quiet_libraries()
    from flows.deploy.shards import study_on_hosts

    return study_on_hosts(plan, hosts, on_ending)


def resubmitted_lines(again: list[str]) -> str:
    """One line per shard that was submitted again."""
    return "\n".join(f"submitted again: {line}" for line in again)
