"""A study run, whole or in part, and its cost beside its cases.

    cost = run(plan(study, out), on_ending)
    cost = run_jobs(made, made.jobs_named(["alpha_0/c1", "alpha_0/c2"]), on_ending)       # a part, anywhere

Jobs run arm by arm, so that shared stages exist when the next arm needs them.
"""

from __future__ import annotations

import shutil
from collections.abc import Sequence

from flows.batch import run_batch
from flows.batch.case_order import OnStep
from flows.batch.plan_batch import Job
from flows.batch.run_batch import Cost
from flows.batch.tracking.track_cases import OnEnding
from flows.study.plan import Plan


def run(plan: Plan, on_ending: OnEnding, on_step: OnStep | None = None) -> Cost:
    """Write study.json and run all jobs. Raises MissingTool, ConfigError (disk full), KeyboardInterrupt.

    A fresh study deletes the stages shared before.
    """
    if plan.batch.fresh and plan.batch.shelf:
        shutil.rmtree(plan.batch.shelf, ignore_errors=True)
    return run_jobs(plan, plan.jobs, on_ending, on_step)


def run_jobs(plan: Plan, jobs: Sequence[Job], on_ending: OnEnding, on_step: OnStep | None = None) -> Cost:
    """Write study.json and run some of a plan's jobs as one flow run; finished ones are not repeated."""
    plan.write()
    return run_batch.evaluate(plan.batch, on_ending, jobs, on_step)


def cost_line(plan: Plan, cost: Cost) -> str:
    """One line on the time of a study and the share of orchestration (planning, Prefect, tracking)."""
    if not cost.done:
        return f"all cached: {cost.elapsed_s:.1f} s"
    line = f"{cost.done} cases in {cost.elapsed_s:.0f} s"
    if any(config.backbone for config in plan.batch.configs):
        return line
    spent = cost.own_s + (cost.server_s or 0.0)
    share = spent / (cost.elapsed_s * plan.batch.processes)
    server = "" if cost.server_s is not None else ", without the Prefect server's"
    return (
        f"{line}; orchestration {1000 * spent / cost.done:.0f} ms of processor time a case{server}, "
        f"{share:.1%} of the time of {plan.batch.processes} cores"
    )
