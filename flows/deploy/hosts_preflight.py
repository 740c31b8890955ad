"""A study handed to the workers of many hosts: what has to be there before Prefect is imported.

    away.run(plan(study, out), Away("s3://bucket/alpha"), on_ending)       # sgcad study alpha --hosts s3://bucket/alpha

Knows when to import Prefect; see flows/deploy/shards.py for the rest and docs/scale.md for how to set it up.
"""

from __future__ import annotations

from dataclasses import dataclass

from flows.batch.track_cases import OnEnding
from flows.server import answers
from flows.study.plan import Plan
from sgcad_core import settings
from sgcad_core.errors import ConfigError, MissingTool


@dataclass(frozen=True)
class Away:
    """Where the hosts meet (an fsspec address that all of them reach) and which deployment they serve."""

    address: str
    deployment: str = "shard/shard"
    shards: int | None = None


def run(plan: Plan, away: Away, on_ending: OnEnding) -> list[str]:
    """Run a study on whatever hosts serve the deployment; which shards were submitted again, and why.

    Raises ConfigError, MissingTool (no server, no storage), KeyboardInterrupt; what is marked stays done.
    """
    if plan.batch.fresh:
        raise ConfigError("--fresh with --hosts: marks of finished cases lie at the address; give --hosts a new one")
    url = settings.prefect_url()
    if not url or not answers(url):
        said = f"{url} does not answer" if url else "none is named"
        raise MissingTool(
            f"--hosts needs a Prefect server that every host reaches, and {said}: export PREFECT_API_URL=http://.../api"
        )
    settings.quiet_libraries()
    from flows.deploy.shards import Hosts, study_on_hosts

    return study_on_hosts(plan, Hosts(away.address, away.deployment, away.shards), on_ending)


def resubmitted_lines(again: list[str]) -> str:
    """One line a shard that had to be submitted again."""
    return "\n".join(f"submitted again: {line}" for line in again)
