"""The one refinement loop: write, judge, ask again with the findings; every attempt is kept.

Knows records, errors and validators; no format, no model, no Prefect. Refinement is not retry: each attempt sees what
was wrong with all before. Hard findings are asked about until they are mended or ten attempts are made. Questions are
put once, with their sentence: an answer that stands by its value settles them. Doubts are not put to a model. A writer
that asks no model gives the same answer twice, so it gets one attempt, and a second one if it mends what was found.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

from sgcad_core.asking.repairs import repair_of
from sgcad_core.asking.schema_holds import narrowed_schema
from sgcad_core.case.records import (
    Attempt,
    Context,
    Evidence,
    Finding,
    Generation,
    Hold,
    Query,
    RoadNetwork,
    Scenario,
    Severity,
    Stage,
    StageOutcome,
)
from sgcad_core.errors import InvalidOutput, Refused
from sgcad_core.findings import SOFT
from sgcad_core.interfaces import Ask, Validator

MAX_ATTEMPTS = 10
"""Most attempts of a stage; configs may set fewer."""
DOUBTFUL_ATTEMPTS = 3
"""Most attempts from the first usable artifact on; the one with the fewest questions and doubts is taken."""
MENDING_ATTEMPTS = 2
"""Attempts of a writer that asks no model and mends what was found."""

_ASKING = ("repair", *SOFT)
"""Severities of findings that start another attempt."""

Artifact = RoadNetwork | Scenario
Write = Callable[[tuple[Finding, ...], Ask, int], Artifact]
"""Findings of the attempt before, how to ask, the attempt's number (from 1). Raises InvalidOutput or Refused."""


@dataclass(frozen=True)
class Call:
    """One question to the model and its answer."""

    query: Query
    generation: Generation


@dataclass(frozen=True)
class Turn:
    """One attempt and what came of it; `artifact` is None if nothing usable was written."""

    attempt: Attempt
    artifact: Artifact | None = None
    refused: Refused | None = None
    calls: tuple[Call, ...] = ()

    def count(self, severity: Severity) -> int:
        """Number of findings of a severity."""
        return sum(f.severity == severity for f in self.attempt.findings)

    @property
    def usable(self) -> bool:
        """Whether nothing has to be repaired."""
        return self.artifact is not None and self.refused is None and not self.count("repair")

    @property
    def rank(self) -> tuple[bool | int, ...]:
        """The less the better: usable ones first, then those with the fewest faults, questions and doubts."""
        faults = self.count("repair"), self.count("question"), self.count("doubt")
        return not self.usable, self.artifact is None, *faults


@dataclass
class _Recorder:
    """An `Ask` that labels queries with case, stage and attempt and keeps what was asked and answered.

    `repair`, the attempt before with its findings, joins the label, so that no writer has to carry it.
    """

    ask: Ask
    label: dict[str, object]
    holds: tuple[Hold, ...] = ()
    """What the answers are held to, where a query asks for an answer of a schema."""
    queries: list[Query] = field(default_factory=list)
    calls: list[Call] = field(default_factory=list)

    def __call__(self, context: Context, query: Query) -> Generation:
        labeled = query.model_copy(update=self.label)
        if self.holds and query.answer_schema is not None:
            labeled = labeled.model_copy(update={"answer_schema": narrowed_schema(query.answer_schema, self.holds)})
        self.queries.append(labeled)
        generation = self.ask(context, labeled)
        self.calls.append(Call(labeled, generation))
        return generation


def no_model(context: Context, query: Query) -> Generation:
    """The `Ask` of a writer that asks no model. Raises TypeError: such a writer is wrongly declared."""
    raise TypeError("a writer with asks_model = False asked a model; set asks_model = True and name a backbone")


@dataclass(frozen=True)
class Refinement:
    """The parts of one stage's refinement: writer, validators, limits.

    `ask` is None for a writer that asks no model. `evidence_of` gives the validators the evidence for the
    attempt's last generation (None without a model).
    """

    stage: Stage
    write: Write
    validators: Sequence[Validator]
    evidence_of: Callable[[Generation | None], Evidence]
    ask: Ask | None = None
    max_attempts: int = MAX_ATTEMPTS
    case: str = ""
    show_findings: bool = True
    """False: a model too small to read them is asked the same again, and draws anew."""
    hold_findings: bool = False
    """What findings tell exactly, the schema of every later answer of the stage is narrowed to."""
    mends: tuple[Severity, ...] = ()
    """What a writer that asks no model does something about."""

    def run(self) -> tuple[StageOutcome, tuple[Call, ...]]:
        """Refine until written, refused or exhausted; also every model call, in order.

        Of usable attempts the one with the fewest questions and doubts is written, though a later one asked for repair
        or refused. An exhausted
        stage's artifact is that of the attempt with the fewest repair findings (the first of equals), None if there is
        none. Raises MissingTool from a validator.
        """
        turns = self.turns()
        return outcome_of(self.stage, turns), tuple(call for turn in turns for call in turn.calls)

    @property
    def limit(self) -> int:
        """The most attempts that this stage may take."""
        return min(self.max_attempts, MAX_ATTEMPTS if self.ask else MENDING_ATTEMPTS if self.mends else 1)

    def ended(self, turns: Sequence[Turn]) -> bool:
        """Whether nothing comes after these turns."""
        if not turns or len(turns) >= self.limit or turns[-1].refused:
            return bool(turns)
        since = next((len(turns) - i for i, turn in enumerate(turns) if turn.usable), 0)
        return since >= DOUBTFUL_ATTEMPTS or (turns[-1].usable and not self._open(turns))

    def _open(self, turns: Sequence[Turn]) -> bool:
        """Whether the last attempt leaves something soft that another one would hear of.

        A model that reads findings is asked once about each that rests on a sentence; one that does not, draws anew
        while questions are left, or doubts that narrow its schema.
        """
        soft = [f for f in turns[-1].attempt.findings if f.severity in SOFT]
        if not self.ask:
            return any(f.severity in self.mends for f in soft)
        if self.show_findings:
            put = {f.subject for turn in turns[:-1] for f in turn.attempt.findings}
            return any(f.subject not in put for f in soft if f.told)
        return any(f.severity == "question" or (self.hold_findings and f.holds) for f in soft)

    def turns(self, earlier: Sequence[Turn] = ()) -> list[Turn]:
        """All turns to the stage's end, going on from earlier ones of the same stage. Raises MissingTool."""
        turns = list(earlier)
        while not self.ended(turns):
            turns.append(self.next_turn(turns))
        return turns

    def next_turn(self, turns: Sequence[Turn]) -> Turn:
        """The attempt after these; call it while the stage has not `ended`. Raises MissingTool."""
        number = len(turns) + 1
        last = turns[-1].attempt if turns else None
        findings = tuple(f for f in last.findings if f.severity in _ASKING) if last else ()
        repair = repair_of([turn.attempt for turn in turns]) if self.ask and self.show_findings else ""
        holds = _holds(turns) if self.hold_findings else ()
        return self._turn(findings, number, repair, holds)

    def _turn(self, findings: tuple[Finding, ...], number: int, repair: str, holds: tuple[Hold, ...]) -> Turn:
        started = time.perf_counter()
        label = {"case": self.case, "stage": self.stage, "attempt": number, "repair": repair}
        recorder = _Recorder(self.ask or no_model, dict(label), holds)
        artifact: Artifact | None = None
        refused: Refused | None = None
        try:
            artifact = self.write(findings, recorder, number)
            judged = self._judge(artifact, recorder)
            refused = _refusal(judged)
        except InvalidOutput as fault:
            judged = _faults(self.stage, fault)
        except Refused as fault:
            refused = fault
            judged = (Finding(source=self.stage, severity="refuse", what=fault.reason, value=", ".join(fault.missing)),)
        seconds = time.perf_counter() - started
        return Turn(self._attempt(number, recorder, judged, seconds), artifact, refused, tuple(recorder.calls))

    def _judge(self, artifact: Artifact, recorder: _Recorder) -> tuple[Finding, ...]:
        """Findings of all validators in their order, up to the first that refuses."""
        evidence = self.evidence_of(recorder.calls[-1].generation if recorder.calls else None)
        findings: list[Finding] = []
        for validator in self.validators:
            findings += validator.findings(artifact, evidence)
            if _refusal(findings):
                break
        return tuple(findings)

    def _attempt(self, number: int, recorder: _Recorder, findings: tuple[Finding, ...], seconds: float) -> Attempt:
        return Attempt(
            stage=self.stage,
            number=number,
            prompt="\n\n".join(prompt_text(query) for query in recorder.queries),
            answer="\n\n".join(call.generation.text for call in recorder.calls),
            held=recorder.holds,
            findings=findings,
            generation=recorder.calls[-1].generation if recorder.calls else None,
            seconds=seconds,
        )


def refine(
    stage: Stage,
    write: Write,
    validators: Sequence[Validator],
    evidence_of: Callable[[Generation | None], Evidence],
    *,
    ask: Ask | None = None,
    max_attempts: int = MAX_ATTEMPTS,
) -> StageOutcome:
    """Refine one stage; `Refinement.run` without the calls."""
    return Refinement(stage, write, validators, evidence_of, ask, max_attempts).run()[0]


def prompt_text(query: Query) -> str:
    """A query as it is kept in attempts/: task, passages, the place of the evidence, repair.

    The evidence itself (report.txt, diagram.png) lies beside it once and is not repeated here.
    """
    parts = [query.task, *(f"[{p.kind} {p.id}] {p.text}" for p in query.passages)]
    parts += ["[the crash report and its diagrams stand here]"]
    parts += [query.repair] if query.repair else []
    return "\n\n".join(parts)


def _holds(turns: Sequence[Turn]) -> tuple[Hold, ...]:
    """What all findings tell exactly, each once, newest first: of two that exclude each other the first is kept."""
    found: list[Hold] = []
    for turn in reversed(turns):
        heard = _ASKING if turn.usable else ("repair", "question")  # a doubt may come of what is to be repaired
        told = (hold for f in turn.attempt.findings if f.severity in heard for hold in f.holds)
        found += [hold for hold in told if hold not in found]
    return tuple(found)


def _refusal(findings: Sequence[Finding]) -> Refused | None:
    """The refusal that findings amount to, naming all the evidence that lacks."""
    refusing = [f for f in findings if f.severity == "refuse"]
    if not refusing:
        return None
    missing = [f.value or f.where or f.what for f in refusing]
    return Refused("; ".join(f.what for f in refusing), list(dict.fromkeys(missing)))


def _faults(stage: Stage, fault: InvalidOutput) -> tuple[Finding, ...]:
    """The findings of an unusable answer; at least one of them asks for repair."""
    if any(f.severity == "repair" for f in fault.findings):
        return fault.findings
    return (*fault.findings, Finding(source=stage, what=str(fault) or "unusable answer"))


def outcome_of(stage: Stage, turns: Sequence[Turn]) -> StageOutcome:
    """How a stage with these turns ended."""
    attempts = tuple(turn.attempt for turn in turns)
    best = min(turns, key=lambda turn: turn.rank)
    if best.usable:
        return StageOutcome(
            stage=stage, status="written", artifact=best.artifact, attempts=attempts, kept=best.attempt.number
        )
    last = turns[-1]
    if last.refused:
        return StageOutcome(
            stage=stage, status="refused", attempts=attempts, reason=last.refused.reason, missing=last.refused.missing
        )
    return StageOutcome(
        stage=stage, status="exhausted", artifact=best.artifact, attempts=attempts,
        kept=best.attempt.number if best.artifact else 0, reason=_exhausted(best, len(turns)),
    )  # fmt: skip


def _exhausted(best: Turn, count: int) -> str:
    findings = [f.line() for f in best.attempt.findings if f.severity == "repair"]
    more = f" and {len(findings) - 1} more" if len(findings) > 1 else ""
    return f"{count} attempt(s); nearest was attempt {best.attempt.number}: {findings[0]}{more}"
