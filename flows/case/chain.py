"""One case from report to simulation: read, retrieve, road, scenario, simulate, measure.

Knows the interfaces, not the plugins, and no Prefect: it runs in a thread, a worker process or a test alike. Here is
the boundary that keeps a batch alive: every fault of one case becomes that case's result.
"""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, field
from typing import Any, TypeVar

from flows.case import person_facts
from flows.case.step_log import Steps
from flows.case_files import stage_cache
from flows.case_files.find_cases import Case
from flows.case_files.stage_cache import Sharing
from sgcad_core.asking.refine import Call, OnAttempt, Refinement, Write, outcome_of, run_at_once
from sgcad_core.asking.second_opinion import with_gist_opinion, with_learned_opinion, with_model_opinion
from sgcad_core.case.records import (
    Attempt,
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
    StageOutcome,
)
from sgcad_core.config import Config
from sgcad_core.errors import ConfigError, MissingTool, SgcadError
from sgcad_core.execution.compare_executions import Judgement, judge
from sgcad_core.interfaces import Ask, RoadWriter, ScenarioWriter
from sgcad_core.metrics import measure
from sgcad_core.records.edits import Edit
from sgcad_core.records.second_reader import LEARNED, WHOLE
from sgcad_core.result import CaseRecord
from sgcad_core.revision import overruled_validators

T = TypeVar("T")


def ask_of(config: Config) -> Ask:
    """The function by which writers ask the config's model; each further attempt uses another seed."""
    backbone, decoder = config.backbone, config.decoder
    if backbone is None or decoder is None:  # config.build refuses this pairing
        lack = "backbone" if backbone is None else "decoder"
        raise ConfigError(f"{config.name}: a model is asked, but there is no {lack}: name one, as mini.yaml does")

    def ask(context: Context, query: Query) -> Generation:
        return backbone.generate(context, query, decoder.at(query.attempt), seed=config.seed + query.attempt - 1)

    return ask


@dataclass
class CaseRun:
    """A case while it runs: everything known so far."""

    config: Config
    case: Case
    on_attempt: OnAttempt
    sharing: Sharing | None = None
    report: CrashReport | None = None
    outcomes: dict[str, StageOutcome] = field(default_factory=dict)
    execution: Execution | None = None
    judgement: Judgement | None = None
    metrics: dict[str, Any] | None = None
    seconds: dict[str, float] = field(default_factory=dict)
    calls: list[Call] = field(default_factory=list)
    fresh: list[Attempt] = field(default_factory=list)
    """Attempts made by this run; the others were taken from the shelf, as were the steps in `shared`."""
    shared: list[str] = field(default_factory=list)
    failure: str = ""
    trace: str = ""
    edits: tuple[Edit, ...] | None = None
    """A person's facts; None: those beside the report."""
    kept: Mapping[str, person_facts.KeptAnswers] = field(default_factory=dict)
    """By stage, a model's former answer to this case; the model is not asked again."""
    as_read: dict[str, Any] | None = None
    """The specs before the first edit, where they are known."""
    steps: Steps = field(default_factory=Steps)
    result: dict[str, Any] | None = None
    """The content of result.json, if it was put together before the files are written."""

    def go(self) -> None:
        """Run the stages; their results are in the fields. Raises MissingTool and ConfigError only."""
        try:
            self._stages()
        except (MissingTool, ConfigError):
            raise
        except SgcadError as fault:
            self.failure = str(fault)
        except Exception as fault:  # noqa: BLE001 - the case's boundary: a bug costs one case, not the batch
            self.fail(fault)

    def _stages(self) -> None:
        if both := self.written():
            self._execute(*both)

    def written(self) -> tuple[Scenario, RoadNetwork] | None:
        """Read the report and write both stages; None where one of them was not written."""
        source = self.case.source
        read = self._single("read", lambda: self.config.report_reader.read(source), source.name)
        self.report = report = person_facts.with_person_facts(self._seconded(read), source, self.edits)
        both = self._both(report)
        if both is None and any(fact.basis == "model" for fact in report.reading.facts):
            note = "the second opinion led to no scenario: the rules' reading stands"
            self.report = report = report.model_copy(update={"opinion": None, "notes": (*report.notes, note)})
            return self._both(report)
        return both

    def _both(self, report: CrashReport) -> tuple[Scenario, RoadNetwork] | None:
        """Write the road and the scenario of a report; None if one of them was not written."""
        passages = self._passages(report, "road")
        network = self._stage(self._road(report, passages), report, passages)
        if isinstance(network, RoadNetwork):
            passages = self._passages(report, "scenario")
            scenario = self._stage(self._scenario(report, passages, network), report, passages, network)
            if isinstance(scenario, Scenario):
                return scenario, network
        return None

    def _seconded(self, report: CrashReport) -> CrashReport:
        """The report with a second opinion of its gist, where the config wants one."""
        wanted = self.config.second_opinion
        if not wanted:
            return report
        if wanted == LEARNED:
            return self._single("opinion", lambda: with_learned_opinion(report), report)
        if wanted == WHOLE:
            return self._single("opinion", lambda: with_model_opinion(report, ask_of(self.config)), report)
        return self._single("opinion", lambda: with_gist_opinion(report, wanted, ask_of(self.config)), report)

    def _execute(self, scenario: Scenario, network: RoadNetwork) -> None:
        simulator = self.config.simulator
        self.execution = self._single("simulate", lambda: simulator.execute(scenario, network), scenario, network)
        with self.clock("measure"):
            self.metrics = measure(self.execution, scenario)
        if self.config.judge:
            with self.clock("judge"):
                self.judgement = judge(self.config.judge, self.execution, scenario, network)
            self.metrics["judge"] = self.judgement.summary()

    def _stage(self, refinement: Refinement, *content: Any) -> RoadNetwork | Scenario | None:
        """Run a stage's refinement, reusing kept turns; its time is that of the attempts themselves."""
        name = refinement.stage
        with self.clock(name, shown=False):
            turns, known = stage_cache.refined(self.sharing, refinement, self.case.id, *content)
        for number in range(1, known + 1):
            self.steps.taken(f"{name}[{number}]")
        self.seconds[name] = sum(turn.attempt.seconds for turn in turns)
        self.calls += [call for turn in turns[known:] for call in turn.calls]
        self.fresh += [turn.attempt for turn in turns[known:]]
        self.shared += [name] if known == len(turns) else []
        outcome = outcome_of(name, turns)
        self.outcomes[name] = outcome = self.kept[name].among_others(outcome) if name in self.kept else outcome
        return outcome.artifact if outcome.status == "written" else None

    def _single(self, step: str, compute: Callable[[], T], *content: Any) -> T:
        """A step without attempts."""
        with self.clock(step) as state:
            value, seconds, known = stage_cache.timed(self.sharing, step, compute, self.case.id, *content)
            state += ["Cached"] if known else []
        self.seconds[step] = seconds
        self.shared += [step] if known else []
        return value

    def _road(self, report: CrashReport, passages: tuple[Passage, ...]) -> Refinement:
        writer, context = self.config.road_writer, Context.of(report)
        return self._refinement(
            "road", writer, lambda findings, ask, n: writer.write(context, passages, findings, ask, n), report, None
        )

    def _scenario(self, report: CrashReport, passages: tuple[Passage, ...], network: RoadNetwork) -> Refinement:
        writer, context = self.config.scenario_writer, Context.of(report)
        return self._refinement(
            "scenario",
            writer,
            lambda findings, ask, n: writer.write(context, passages, findings, ask, n, network),
            report,
            network,
        )

    def _passages(self, report: CrashReport, stage: str) -> tuple[Passage, ...]:
        with self.steps.during(f"retrieve[{stage}]"), self.clock("retrieve", shown=False):
            return self.config.retriever.retrieve(report.narrative, stage)

    def _refinement(
        self,
        stage: Stage,
        writer: RoadWriter | ScenarioWriter,
        write: Write,
        report: CrashReport,
        net: RoadNetwork | None,
    ) -> Refinement:
        return Refinement(
            stage=stage,
            write=person_facts.with_edits(write, report, net, writer),
            validators=overruled_validators(self.config.validators_of(stage), report.edits),
            evidence_of=lambda generation: Evidence(report=report, network=net, generation=generation),
            ask=(self.kept[stage].ask if stage in self.kept else ask_of(self.config)) if writer.asks_model else None,
            max_attempts=1 if stage in self.kept else self.config.max_attempts,
            on_attempt=lambda name, turn: self.on_attempt(name, lambda: self.steps.attempt(name, turn)),
            case=self.case.id,
            show_findings=self.config.show_findings,
            hold_findings=self.config.hold_findings,
        )

    @contextmanager
    def clock(self, step: str, shown: bool = True) -> Iterator[list[str]]:
        """Add the time of the block to a step's; the step is logged if `shown`."""
        started = time.perf_counter()
        try:
            with ExitStack() as told:
                yield told.enter_context(self.steps.during(step)) if shown else []
        finally:
            self.seconds[step] = self.seconds.get(step, 0.0) + time.perf_counter() - started

    def record(self) -> CaseRecord:
        """Everything known about the case, for result.json and the player."""
        notes = self.report.notes if self.report else ()
        reading = self.report.reading if self.report else None
        about = self.case.id, self.config.name, self.outcomes, self.execution, self.failure, notes, self.seconds
        places = self.report.places if self.report else ()
        return CaseRecord(*about, reading, self.judgement, bool(self.report and self.report.diagrams), places)

    def attempts(self) -> tuple[Attempt, ...]:
        """Attempts of all stages in order."""
        return tuple(a for outcome in self.outcomes.values() for a in outcome.attempts)

    def read_alone(self) -> dict[str, Any] | None:
        """The specs that the case would have without its edits; None where there are no edits."""
        if self.as_read is None and self.report and self.report.edits:
            unedited = CaseRun(
                self.config, self.case, run_at_once, edits=(), kept=person_facts.kept_answers(self.outcomes)
            )
            with suppress(SgcadError):
                unedited.written()
            return person_facts.specs_of(unedited.record())
        return self.as_read

    def fail(self, fault: Exception) -> None:
        """Make this a failed case whose reason is an unexpected fault."""
        self.failure = f"unexpected {type(fault).__name__}: {fault} (see error.txt)"
        self.trace = "".join(traceback.format_exception(fault))
