"""From a checked batch to its end: what is done already, the workers, the server, the flow, in this order.

Knows when to import Prefect, and that a batch with nothing left to do needs none.
"""

from __future__ import annotations

from collections.abc import Sequence

from flows import tracking
from flows.batch import Batch, Crew, Job
from flows.chain import Ending
from flows.server import prefect_server
from flows.tracking import OnEnding
from sgcad_core import settings


def evaluate(batch: Batch, on_ending: OnEnding) -> None:
    """Run a batch. Raises MissingTool, ConfigError (disk full), KeyboardInterrupt; finished cases stay."""
    settings.quiet_libraries()
    plan = batch.plan()
    crew = Crew(batch)
    if (done := _all_done(plan, crew)) is not None:
        for job, ending in done:
            on_ending(job, ending, "")
        return
    try:
        with prefect_server() as server:
            crew.begin(plan)
            from flows.evaluate import run_flow

            if server:
                server.wait()
            run_flow(batch, plan, crew, on_ending)
    except BaseException:
        crew.stop()
        raise
    crew.close()


def _all_done(plan: Sequence[Job], crew: Crew) -> list[tuple[Job, Ending]] | None:
    """Endings of a batch whose cases are all finished and tracked; None if there is anything to do."""
    done = []
    for job in plan:
        ending = crew.reusable(job)
        if ending is None or not tracking.tracked(job):
            return None
        done.append((job, ending))
    return done
