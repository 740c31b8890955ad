"""One case from report to simulation: read, retrieve, road, scenario, simulate, measure, judge.

Knows the steps (flows/case/steps.py), not the plugins, and no Prefect: `CaseRun.calls` says whether a step is called
at once or as a task. Here is the boundary that keeps a batch alive: every fault of one case becomes that case's result.
"""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import Any, TypeVar

from flows.case import person_facts, readings, steps
from flows.case.step_log import StepLog
from flows.case.steps import AT_ONCE, Held, Setup, StepCalls
from flows.case_files.find_cases import Case
from flows.case_files.step_keys import StepKeys
from sgcad_core.asking.refine import Refinement, Turn, outcome_of
from sgcad_core.case.records import Attempt, CrashReport, Execution, Passage, StageOutcome
from sgcad_core.config import Config
from sgcad_core.errors import ConfigError, InvalidOutput, MissingTool, PluginFault, SgcadError, SimulationFailed
from sgcad_core.execution.compare_executions import Judgement
from sgcad_core.records.edits import Edit
from sgcad_core.result import CaseRecord, account_so_far

T = TypeVar("T")
_COURSE = ("report", "read_by", "outcomes", "execution", "judgement", "metrics")
"""Fields of a run that follow from its reading of the report."""


@dataclass
class CaseRun:
    """A case while it runs: everything known so far."""

    config: Config
    case: Case
    calls: StepCalls = AT_ONCE
    keys: StepKeys | None = None
    log: StepLog = field(default_factory=StepLog)
    edits: tuple[Edit, ...] | None = None
    """A person's facts; None: those beside the report."""
    answers: Mapping[str, person_facts.KeptAnswers] = field(default_factory=dict)
    """By stage, a model's former answer to this case; the model is not asked again."""
    as_read: dict[str, Any] | None = None
    """The specs before the first edit, where they are known."""
    hold_to: readings.ReadBy | None = None
    """The readers whose reading is taken whatever others have; None: the one whose scenario misses least."""
    read_by: readings.ReadBy = "all"
    """The readers whose reading the scenario is from."""
    report: CrashReport | None = None
    outcomes: dict[str, StageOutcome] = field(default_factory=dict)
    execution: Execution | None = None
    judgement: Judgement | None = None
    metrics: dict[str, Any] | None = None
    seconds: dict[str, float] = field(default_factory=dict)
    shared: list[str] = field(default_factory=list)
    """Steps whose results were kept by another config's run."""
    failure: str = ""
    trace: str = ""
    result: dict[str, Any] | None = None
    """The content of result.json, if it was put together before the files are written."""

    def __post_init__(self) -> None:
        self.setup = Held(Setup(self.config, self.case, self.keys, self.edits, self.answers))

    def go(self) -> None:
        """Run the steps; their results are in the fields. Raises MissingTool and ConfigError only."""
        try:
            if both := self.written():
                self._execute(*both)
            self._try_other_readings()
        except (MissingTool, ConfigError):
            raise
        except PluginFault as fault:
            self.fail(fault, str(fault))
        except SgcadError as fault:
            self.failure = str(fault)
        except Exception as fault:  # noqa: BLE001 - the case's boundary: a bug costs one case, not the batch
            self.fail(fault)

    def written(self) -> tuple[Held[Turn], Held[Turn]] | None:
        """Read the report and write both stages; the attempts that wrote scenario and road, None without both."""
        report = self._call("read", self.calls.read)
        if self.config.second_opinion:
            report = self._call("opinion", self.calls.opinion, report)
        if self.hold_to and self.hold_to != "all":
            report, self.read_by = Held(readings.read_by(report.value, self.hold_to)), self.hold_to
        informed = person_facts.with_person_facts(report.value, self.case.source, self.edits)
        if informed.edits:
            report = Held(informed)
        self.report = report.value
        both = self._both(report)
        if both is None and any(fact.basis == "model" for fact in report.value.reading.facts):
            note = "the second opinion led to no scenario: the rules' reading stands"
            alone = readings.read_by(report.value, "rules")
            self.report = alone.model_copy(update={"notes": (*report.value.notes, note)})
            self.read_by = "rules"
            return self._both(Held(self.report))
        return both

    def _try_other_readings(self) -> None:
        """Take another reading of the report whose scenario has more of what is told, if that of all readers lacks
        something."""
        if self.hold_to or self.report is None or not readings.has_others(self.report):
            return
        first = account_so_far(self.record())
        least = readings.missed(first)
        for readers, report in readings.other_readings(self.report) if least else ():
            kept = {key: getattr(self, key) for key in _COURSE}
            self.report, self.read_by, self.outcomes, self.execution, self.metrics = report, readers, {}, None, None
            with suppress(InvalidOutput, SimulationFailed):
                if both := self._both(Held(report)):
                    self._execute(*both)
            made = account_so_far(self.record())
            if readings.missed(made) < least:
                least = readings.missed(made)
                told = (*report.notes, readings.note_of(readers, made, first))
                self.report = report.model_copy(update={"notes": told})
            else:
                vars(self).update(kept)
            if not least:
                break

    def _both(self, report: Held[CrashReport]) -> tuple[Held[Turn], Held[Turn]] | None:
        """Write the road and the scenario of a report; None if one of them was not written."""
        setup, passages = self.setup.value, self._passages(report, "road")
        road = steps.road_refinement(setup, report.value, passages.value)
        if (network := self._stage(road, self.calls.road, report, passages)) is None:
            return None
        passages = self._passages(report, "scenario")
        refinement = steps.scenario_refinement(setup, report.value, passages.value, steps.network_of(network))
        scenario = self._stage(refinement, self.calls.scenario, report, passages, network)
        return None if scenario is None else (scenario, network)

    def _passages(self, report: Held[CrashReport], stage: str) -> Held[tuple[Passage, ...]]:
        with self.log.during(f"retrieve[{stage}]"):
            passages = self.calls.retrieve(self.setup, report, stage)
        self.seconds["retrieve"] = self.seconds.get("retrieve", 0.0) + passages.seconds
        return passages

    def _stage(
        self,
        refinement: Refinement,
        attempt: Callable[..., Held[Turn]],
        report: Held[CrashReport],
        passages: Held[tuple[Passage, ...]],
        *network: Held[Turn],
    ) -> Held[Turn] | None:
        """Refine a stage, an attempt a step; the attempt that wrote it, None where none did."""
        name, turns = refinement.stage, list[Held[Turn]]()
        while not refinement.ended([turn.value for turn in turns]):
            with self.log.during(f"{name}[{len(turns) + 1}]") as step:
                turns.append(attempt(self.setup, report, passages, tuple(turns), *network))
                step.judge(turns[-1].value.attempt, kept=turns[-1].kept)
        self.seconds[name] = self.seconds.get(name, 0.0) + sum(turn.value.attempt.seconds for turn in turns)
        self.shared += [name] if all(turn.kept for turn in turns) else []
        outcome = outcome_of(name, [turn.value for turn in turns])
        self.outcomes[name] = self.answers[name].among_others(outcome) if name in self.answers else outcome
        return turns[outcome.kept - 1] if outcome.status == "written" else None

    def _execute(self, scenario: Held[Turn], network: Held[Turn]) -> None:
        execution = self._call("simulate", self.calls.simulate, scenario, network)
        self.execution = execution.value
        self.metrics = self._call("measure", self.calls.measure, execution, scenario).value
        if self.config.judge:
            self.judgement = self._call("judge", self.calls.judge, execution, scenario, network).value
            self.metrics["judge"] = self.judgement.summary() if self.judgement else None

    def _call(self, name: str, step: Callable[..., Held[T]], *given: Any) -> Held[T]:
        """A step without attempts."""
        with self.log.during(name) as logged:
            made = step(self.setup, *given)
            logged.kept = made.kept
        self.seconds[name] = self.seconds.get(name, 0.0) + made.seconds
        self.shared += [name] if made.kept else []
        return made

    @contextmanager
    def clock(self, step: str) -> Iterator[None]:
        """Log the block as a step, and add its time to that of the step."""
        started = time.perf_counter()
        try:
            with self.log.during(step):
                yield
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
            answers = person_facts.kept_answers(self.outcomes)
            unedited = CaseRun(self.config, self.case, edits=(), answers=answers, hold_to=self.read_by)
            with suppress(SgcadError):
                unedited.written()
            return person_facts.specs_of(unedited.record())
        return self.as_read

    def fail(self, fault: Exception, said: str = "") -> None:
        """Make this a failed case with a fault's traceback; its reason is `said`, else that the fault is unexpected."""
        self.failure = f"{said or f'unexpected {type(fault).__name__}: {fault}'} (see error.txt)"
        self.trace = "".join(traceback.format_exception(fault))
