"""The steps of a case as plain functions: read, retrieve, attempts, simulate, measure, judge.

Each takes and returns `Held` values. `flows/case/chain.py` puts them in order, and calls them at once (`AT_ONCE`) or as
the Prefect tasks of `flows/batch/step_tasks.py`, which are these functions. Knows no Prefect and no folder.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import wraps
from typing import Any, Concatenate, Generic, ParamSpec, TypeVar, cast

from flows.case import person_facts
from flows.case_files.find_cases import Case
from flows.case_files.step_keys import StepKeys
from sgcad_core.asking.refine import Refinement, Turn, Write
from sgcad_core.asking.second_opinion import with_gist_opinion, with_learned_opinion, with_model_opinion
from sgcad_core.case.records import (
    Context,
    CrashReport,
    Evidence,
    Execution,
    Generation,
    Passage,
    Query,
    RoadNetwork,
    Scenario,
    Stage,
)
from sgcad_core.config import Config
from sgcad_core.errors import ConfigError, ProcessDied, ServerSilent
from sgcad_core.execution import compare_executions
from sgcad_core.execution.compare_executions import Judgement
from sgcad_core.interfaces import Ask, RoadWriter, ScenarioWriter
from sgcad_core.metrics import measure as measured
from sgcad_core.records.edits import Edit
from sgcad_core.records.second_reader import LEARNED, WHOLE
from sgcad_core.revision import overruled_validators

T = TypeVar("T")
P = ParamSpec("P")

PASSING = (ProcessDied, ServerSilent)
"""Faults that a repeated step may not meet again."""
RETRY_DELAYS_S = (0.5, 2.0)
"""Pauses before a step is tried again (`may_be_retried`); each is one retry."""


class Held(Generic[T]):
    """A value handed from step to step, with the seconds that its making took.

    No dataclass and no model: Prefect visits every element of those when they are a task's parameters. By its identity
    Prefect knows which step it is from. `kept`: a former run's result was taken.
    """

    __slots__ = ("__weakref__", "kept", "seconds", "value")

    def __init__(self, value: T, seconds: float = 0.0, kept: bool = False) -> None:
        self.value, self.seconds, self.kept = value, seconds, kept


@dataclass(frozen=True)
class Setup:
    """What all steps of a case share."""

    config: Config
    case: Case
    keys: StepKeys | None = None
    """The keys under which results of steps are kept for other configs; None: they are not."""
    edits: tuple[Edit, ...] | None = None
    """A person's facts; None: those beside the report."""
    answers: Mapping[str, person_facts.KeptAnswers] = field(default_factory=dict)
    """By stage, a model's former answer to this case; the model is not asked again."""


def step(work: Callable[Concatenate[Setup, P], T]) -> Callable[Concatenate[Held[Setup], P], Held[T]]:
    """A function of a setup as a step, which takes and returns held values and knows its time."""

    @wraps(work)
    def timed(setup: Held[Setup], /, *given: P.args, **named: P.kwargs) -> Held[T]:
        started = time.perf_counter()
        return Held(work(setup.value, *given, **named), time.perf_counter() - started)

    return timed


# ------------------------------------------------------------------ the steps
@step
def read(setup: Setup) -> CrashReport:
    """The report as its reader gives it. Raises BadInput."""
    return setup.config.report_reader.read(setup.case.source)


@step
def opinion(setup: Setup, report: Held[CrashReport]) -> CrashReport:
    """The report with the second opinion that the config names."""
    wanted = setup.config.second_opinion
    if wanted == LEARNED:
        return with_learned_opinion(report.value)
    if wanted == WHOLE:
        return with_model_opinion(report.value, ask_of(setup.config))
    return with_gist_opinion(report.value, wanted, ask_of(setup.config))


@step
def retrieve(setup: Setup, report: Held[CrashReport], stage: str) -> tuple[Passage, ...]:
    """Passages of documentation and real junctions for a stage."""
    return setup.config.retriever.retrieve(report.value.narrative, stage)


@step
def road(
    setup: Setup, report: Held[CrashReport], passages: Held[tuple[Passage, ...]], turns: Sequence[Held[Turn]]
) -> Turn:
    """The attempt at a road network after those in `turns`."""
    return road_refinement(setup, report.value, passages.value).next_turn([turn.value for turn in turns])


@step
def scenario(
    setup: Setup,
    report: Held[CrashReport],
    passages: Held[tuple[Passage, ...]],
    turns: Sequence[Held[Turn]],
    network: Held[Turn],
) -> Turn:
    """The attempt at a scenario after those in `turns`, on the network of a road attempt."""
    refinement = scenario_refinement(setup, report.value, passages.value, network_of(network))
    return refinement.next_turn([turn.value for turn in turns])


@step
def simulate(setup: Setup, scenario: Held[Turn], network: Held[Turn]) -> Execution:
    """The execution of a written scenario. Raises SimulationFailed."""
    return setup.config.simulator.execute(scenario_of(scenario), network_of(network))


@step
def measure(setup: Setup, execution: Held[Execution], scenario: Held[Turn]) -> dict[str, Any]:
    """The criticality metrics of an execution."""
    return measured(execution.value, scenario_of(scenario))


@step
def judge(setup: Setup, execution: Held[Execution], scenario: Held[Turn], network: Held[Turn]) -> Judgement | None:
    """The verdict of the config's second simulator; None where it names none."""
    if (simulator := setup.config.judge) is None:
        return None
    return compare_executions.judge(simulator, execution.value, scenario_of(scenario), network_of(network))


def network_of(turn: Held[Turn]) -> RoadNetwork:
    """The road network that an attempt wrote."""
    return cast("RoadNetwork", turn.value.artifact)


def scenario_of(turn: Held[Turn]) -> Scenario:
    """The scenario that an attempt wrote."""
    return cast("Scenario", turn.value.artifact)


# ------------------------------------------------------------------ how they are called
def may_be_retried(fault: BaseException) -> bool:
    """Whether a step may succeed when it is repeated: a process died, which need not be the report's fault, or a server
    gave no answer."""
    return isinstance(fault, PASSING)


def retried(work: Callable[P, T]) -> Callable[P, T]:
    """A step that is repeated where that may help."""

    @wraps(work)
    def patient(*given: P.args, **named: P.kwargs) -> T:
        for delay_s in RETRY_DELAYS_S:
            try:
                return work(*given, **named)
            except PASSING:
                time.sleep(delay_s)
        return work(*given, **named)

    return patient


@dataclass(frozen=True)
class StepCalls:
    """How the steps are called: at once, or as Prefect tasks."""

    read: Callable[[Held[Setup]], Held[CrashReport]]
    opinion: Callable[[Held[Setup], Held[CrashReport]], Held[CrashReport]]
    retrieve: Callable[[Held[Setup], Held[CrashReport], str], Held[tuple[Passage, ...]]]
    road: Callable[..., Held[Turn]]
    scenario: Callable[..., Held[Turn]]
    simulate: Callable[..., Held[Execution]]
    measure: Callable[..., Held[dict[str, Any]]]
    judge: Callable[..., Held[Judgement | None]]


AT_ONCE = StepCalls(
    read, retried(opinion), retrieve, retried(road), retried(scenario), retried(simulate), measure, judge
)


# ------------------------------------------------------------------ a stage's parts
def ask_of(config: Config) -> Ask:
    """The function by which writers ask the config's model; each further attempt uses another seed."""
    backbone, decoder = config.backbone, config.decoder
    if backbone is None or decoder is None:  # config.build refuses this pairing
        lack = "backbone" if backbone is None else "decoder"
        raise ConfigError(f"{config.name}: a model is asked, but there is no {lack}: name one, as mini.yaml does")

    def ask(context: Context, query: Query) -> Generation:
        return backbone.generate(context, query, decoder.at(query.attempt), seed=config.seed + query.attempt - 1)

    return ask


def road_refinement(setup: Setup, report: CrashReport, passages: tuple[Passage, ...]) -> Refinement:
    """The refinement of a case's road network."""
    writer, context = setup.config.road_writer, Context.of(report)
    return _refinement(
        setup, "road", writer, lambda findings, ask, n: writer.write(context, passages, findings, ask, n), report, None
    )


def scenario_refinement(
    setup: Setup, report: CrashReport, passages: tuple[Passage, ...], network: RoadNetwork
) -> Refinement:
    """The refinement of a case's scenario on a network."""
    writer, context = setup.config.scenario_writer, Context.of(report)
    return _refinement(
        setup,
        "scenario",
        writer,
        lambda findings, ask, n: writer.write(context, passages, findings, ask, n, network),
        report,
        network,
    )


def _refinement(
    setup: Setup,
    stage: Stage,
    writer: RoadWriter | ScenarioWriter,
    write: Write,
    report: CrashReport,
    network: RoadNetwork | None,
) -> Refinement:
    config, answers = setup.config, setup.answers.get(stage)
    return Refinement(
        stage=stage,
        write=person_facts.with_edits(write, report, network, writer),
        validators=overruled_validators(config.validators_of(stage), report.edits),
        evidence_of=lambda generation: Evidence(report=report, network=network, generation=generation),
        ask=(answers.ask if answers else ask_of(config)) if writer.asks_model else None,
        max_attempts=1 if answers else config.max_attempts,
        case=setup.case.id,
        show_findings=config.show_findings,
        hold_findings=config.hold_findings,
        mends=writer.mends,
    )
