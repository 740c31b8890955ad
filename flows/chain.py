"""One case from report to folder: read, retrieve, road, scenario, simulate, measure, draw, write.

Knows the interfaces, not the plugins, and no Prefect: it runs in a thread, a worker process or a test
alike. Here is the boundary that keeps a batch alive: whatever one case dies of is that case's result.
"""

from __future__ import annotations

import time
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from flows import picture, player, sharing, store
from flows.cases import Case
from flows.sharing import Sharing
from flows.view import View
from sgcad_core.asking.refine import Call, OnAttempt, Refinement, Write, outcome_of, run_at_once
from sgcad_core.config import Config
from sgcad_core.errors import ConfigError, MissingTool, SgcadError
from sgcad_core.execution.judgement import Judgement, judge
from sgcad_core.interfaces import Ask, RoadWriter, ScenarioWriter
from sgcad_core.metrics import measure
from sgcad_core.records import (
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
from sgcad_core.result import CaseRecord, result_of

T = TypeVar("T")


@dataclass(frozen=True)
class Ending:
    """What a caller learns of a finished case; the rest is on disk. `reused`: nothing had to be done.

    Attempts and calls are those made here and now, without the ones taken from a shelf.
    """

    result: dict[str, Any]
    attempts: tuple[Attempt, ...] = ()
    calls: tuple[Call, ...] = ()
    reused: bool = False


@dataclass
class _Run:
    """A case on its way: what is known so far, whatever comes next."""

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
    """Attempts made here and now; the others were taken from the shelf, and so were the steps in `shared`."""
    shared: list[str] = field(default_factory=list)
    failure: str = ""
    trace: str = ""

    def go(self) -> None:
        """Run the stages; how they ended stands in the fields. Raises MissingTool and ConfigError only."""
        try:
            self._stages()
        except (MissingTool, ConfigError):
            raise
        except SgcadError as fault:
            self.failure = str(fault)
        except Exception as fault:  # noqa: BLE001 - the case's boundary: a bug costs one case, not the batch
            self.fail(fault)

    def _stages(self) -> None:
        source = self.case.source
        self.report = report = self._single("read", lambda: self.config.report_reader.read(source), source.name)
        passages = self._passages(report, "road")
        network = self._stage(self._road(report, passages), report, passages)
        if isinstance(network, RoadNetwork):
            passages = self._passages(report, "scenario")
            scenario = self._stage(self._scenario(report, passages, network), report, passages, network)
            if isinstance(scenario, Scenario):
                self._execute(scenario, network)

    def _execute(self, scenario: Scenario, network: RoadNetwork) -> None:
        simulator = self.config.simulator
        self.execution = self._single("simulate", lambda: simulator.execute(scenario, network), scenario, network)
        with self._clock("measure"):
            self.metrics = measure(self.execution, scenario)
        if self.config.judge:
            with self._clock("judge"):
                self.judgement = judge(self.config.judge, self.execution, scenario, network)
            self.metrics["judge"] = self.judgement.summary()

    def _stage(self, refinement: Refinement, *content: Any) -> RoadNetwork | Scenario | None:
        """Refine, as far as the shelf does not know how that ends; the time is that of the attempts themselves."""
        name = refinement.stage
        with self._clock(name):
            turns, known = sharing.refined(self.sharing, refinement, self.case.id, *content)
        self.seconds[name] = sum(turn.attempt.seconds for turn in turns)
        self.calls += [call for turn in turns[known:] for call in turn.calls]
        self.fresh += [turn.attempt for turn in turns[known:]]
        self.shared += [name] if known == len(turns) else []
        self.outcomes[name] = outcome = outcome_of(name, turns)
        return outcome.artifact if outcome.status == "written" else None

    def _single(self, step: str, compute: Callable[[], T], *content: Any) -> T:
        """A step without attempts."""
        with self._clock(step):
            value, seconds, known = sharing.timed(self.sharing, step, compute, self.case.id, *content)
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
        with self._clock("retrieve"):
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
            write=write,
            validators=self.config.validators_of(stage),
            evidence_of=lambda generation: Evidence(report=report, network=net, generation=generation),
            ask=ask_of(self.config) if writer.asks_model else None,
            max_attempts=self.config.max_attempts,
            on_attempt=self.on_attempt,
            case=self.case.id,
            show_findings=self.config.show_findings,
            hold_findings=self.config.hold_findings,
        )

    @contextmanager
    def _clock(self, step: str) -> Iterator[None]:
        started = time.perf_counter()
        try:
            yield
        finally:
            self.seconds[step] = self.seconds.get(step, 0.0) + time.perf_counter() - started

    def record(self) -> CaseRecord:
        """Everything known, for result.json and the player."""
        notes = self.report.notes if self.report else ()
        reading = self.report.reading if self.report else None
        about = self.case.id, self.config.name, self.outcomes, self.execution, self.failure, notes, self.seconds
        return CaseRecord(*about, reading, self.judgement, bool(self.report and self.report.diagrams))

    def attempts(self) -> tuple[Attempt, ...]:
        """Attempts of all stages in order."""
        return tuple(a for outcome in self.outcomes.values() for a in outcome.attempts)

    def leave(self, folder: Path) -> dict[str, Any]:
        """Write the case's files into a folder, result.json last; the result."""
        record = self.record()
        store.write_report(folder, self.report)
        store.write_attempts(folder, self.attempts())
        if record.network:
            store.write_network(folder, record.network)
        if record.scenario:
            store.write_scenario(folder, record.scenario)
        if self.execution:
            store.write_trajectories(folder / "trajectories.csv", self.execution.trajectories)
        if self.metrics is not None:
            self._hand_over(folder, record)
            store.write_json(folder / "metrics.json", self.metrics)
        if self.trace:
            (folder / "error.txt").write_text(self.trace, encoding="utf-8", errors="replace")
        self._draw(folder, record)
        result = result_of(self.record())
        if self.sharing:
            result["shared"] = self.shared
        store.write_json(folder / "result.json", result)
        return result

    def _hand_over(self, folder: Path, record: CaseRecord) -> None:
        """What the contact was like, and what the config's drivers made of it (`drive`), into the metrics."""
        if self.metrics is None or not (
            record.scenario and record.network and record.network.net_xml and self.execution
        ):
            return
        from flows.drives import stage

        with self._clock("measure"):
            self.metrics["exact"] |= stage.contact(record)
        if self.config.drive:
            with self._clock("drive"):
                self.metrics["drive"] = stage.driven(self.config.drive, record, folder)

    def _draw(self, folder: Path, record: CaseRecord) -> None:
        """player.html and picture.png of an executed case."""
        if record.network and record.scenario and record.execution and self.report:
            with self._clock("draw"):
                view = View.of(record, self.report, self.metrics or {}, result_of(record))
                (folder / "player.html").write_text(player.page(view), encoding="utf-8")
                (folder / "picture.png").write_bytes(picture.png(view))

    def fail(self, fault: Exception) -> None:
        """Make this a failed case whose reason is a fault that nobody foresaw."""
        self.failure = f"unexpected {type(fault).__name__}: {fault} (see error.txt)"
        self.trace = "".join(traceback.format_exception(fault))


def ask_of(config: Config) -> Ask:
    """How writers of this config speak to its model; a later attempt draws with another seed."""
    backbone, decoder = config.backbone, config.decoder
    if backbone is None or decoder is None:  # config.build refuses this pairing
        lack = "backbone" if backbone is None else "decoder"
        raise ConfigError(f"{config.name}: a model is asked, but there is no {lack}: name one, as mini.yaml does")

    def ask(context: Context, query: Query) -> Generation:
        return backbone.generate(context, query, decoder.at(query.attempt), seed=config.seed + query.attempt - 1)

    return ask


def run_case(
    config: Config,
    case: Case,
    out: Path,
    digest: str,
    on_attempt: OnAttempt = run_at_once,
    *,
    sharing: Sharing | None = None,
) -> Ending:
    """Run one case and leave its folder. Raises MissingTool, ConfigError (a folder that cannot be written)."""
    run = _Run(config, case, on_attempt, sharing)
    run.go()
    result = _leave(run, store.CaseFolder(out, config.name, case.id), digest)
    return Ending(result, tuple(run.fresh), tuple(run.calls))


def leave_failed(config: Config, case: Case, out: Path, digest: str, reason: str) -> Ending:
    """The folder of a case whose process died, with the reason. The report is not read again: it may be the cause."""
    run = _Run(config, case, run_at_once, failure=reason)
    return Ending(_leave(run, store.CaseFolder(out, config.name, case.id), digest))


def _leave(run: _Run, folder: store.CaseFolder, digest: str) -> dict[str, Any]:
    try:
        return _write(run, folder, digest)
    except OSError as fault:
        raise ConfigError(
            f"{folder.path}: cannot be written ({fault.strerror}); make room or choose another --out; "
            "run again to go on where it stopped"
        ) from fault
    except Exception as fault:  # noqa: BLE001 - what cannot be drawn or written down costs one case, not the batch
        bare = _Run(run.config, run.case, run_at_once, report=run.report, seconds=run.seconds)
        bare.fail(fault)
        return _write(bare, folder, digest)


def _write(run: _Run, folder: store.CaseFolder, digest: str) -> dict[str, Any]:
    """Write the folder. A failed case gets no digest that matches: running again tries it again."""
    with folder.writing() as partial:
        result = run.leave(partial)
        mark = digest if result["status"] != "failed" else ""
        (partial / store.DIGEST).write_text(mark, encoding="utf-8")
    return result
