"""result.json: the result of one case in the stable form that scripts rely on.

Pure functions on records; knows the .net.xml reader for counting roads. Writes no file.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from sgcad_core.account import Account, Note, account_of
from sgcad_core.account.inputs import ExecutedCase
from sgcad_core.account.notes import notes_of
from sgcad_core.account.second_opinion import disagreements_of
from sgcad_core.case.records import Execution, Fact, Generation, RoadNetwork, Scenario, StageOutcome, sizes_of
from sgcad_core.execution.compare_executions import Judgement
from sgcad_core.execution.contact import avoided, closest_approach, first_with, realised
from sgcad_core.execution.scenario_facts import actor_facts_written, road_facts_written
from sgcad_core.formats.sumo.net_xml import parse_net
from sgcad_core.reading.inference.reading_limits import limit_notes
from sgcad_core.reading.text.traced_text import redactions
from sgcad_core.records.edits import by_person
from sgcad_core.records.timeline import Act, as_settled
from sgcad_core.roads.lane_graph import network_figures, segments

if TYPE_CHECKING:
    from sgcad_core.reading.reading import Reading

Status = Literal["generated", "refused", "exhausted", "failed"]
STATUSES: tuple[Status, ...] = ("generated", "refused", "exhausted", "failed")
STAGES = ("road", "scenario")


@dataclass(frozen=True)
class CaseRecord:
    """Everything known of one case when it ends, however it ends.

    `failure` is the reason of a case that neither generated nor was declined. `seconds` maps steps (read,
    retrieve, road, scenario, simulate, measure, draw, files) to wall time.
    """

    case: str
    config: str
    outcomes: Mapping[str, StageOutcome] = field(default_factory=dict)
    execution: Execution | None = None
    failure: str = ""
    notes: tuple[str, ...] = ()
    seconds: Mapping[str, float] = field(default_factory=dict)
    reading: Reading | None = None
    """What the rules read of the narrative."""
    judgement: Judgement | None = None
    drawn: bool = False
    """Whether the report has a drawing that the writers were shown."""
    places: tuple[tuple[int, int, int], ...] = ()
    """`CrashReport.places`: where words about persons were replaced or left out."""

    @property
    def network(self) -> RoadNetwork | None:
        """The written network (not the best attempt of an exhausted stage)."""
        artifact = self._written("road")
        return artifact if isinstance(artifact, RoadNetwork) else None

    @property
    def scenario(self) -> Scenario | None:
        """The written scenario."""
        artifact = self._written("scenario")
        return artifact if isinstance(artifact, Scenario) else None

    def _written(self, stage: str) -> RoadNetwork | Scenario | None:
        outcome = self.outcomes.get(stage)
        return outcome.artifact if outcome is not None and outcome.status == "written" else None


def result_of(record: CaseRecord) -> dict[str, Any]:
    """The content of result.json, JSON-able."""
    status, reason, missing = _end(record)
    judged = {"judge": record.judgement.summary()} if record.judgement else {}
    facts, notes = facts_of(record), case_notes(record)
    account = case_account(record, status, facts, notes)
    return {
        "case": record.case,
        "config": record.config,
        "status": status,
        "reason": reason,
        "missing": list(missing),
        "attempts": {s: len(record.outcomes[s].attempts) if s in record.outcomes else 0 for s in STAGES},
        "network": _network(record.network),
        **_place(record.network),
        "actors": [actor.model_dump() for actor in record.scenario.actors] if record.scenario else [],
        "collision": _collision(record.scenario, record.execution),
        "near_crash": _near_crash(record.scenario, record.execution),
        **judged,
        "grounding": _grounding(record.outcomes),
        "sentences": _sentences(record.reading),
        "redactions": redactions(record.places),
        "timeline": [act.model_dump(mode="json") for act in _timeline(record.reading, facts)],
        "facts": [fact.model_dump(mode="json") for fact in facts],
        "seconds": seconds_of(record),
        "account": account.summary(),
        "disagreements": [one.model_dump(mode="json") for one in account.disagreements],
        "notes": [note.model_dump(mode="json") for note in notes],
    }


def _sentences(reading: Reading | None) -> list[dict[str, Any]]:
    """The sentences that facts point to: places in the narrative as it was written, the text as it was read."""
    if reading is None:
        return []
    told = reading.sentences
    return [{"start": s.start, "end": s.end, "role": s.role, "text": reading.text_of(s)} for s in told]


def _timeline(reading: Reading | None, facts: Sequence[Fact]) -> tuple[Act, ...]:
    """States and acts in the order of the crash, as they stand after a model's or a person's answer."""
    return as_settled(reading.timeline, facts) if reading else ()


def seconds_of(record: CaseRecord) -> dict[str, float]:
    """What every step took so far."""
    return {step: round(seconds, 4) for step, seconds in record.seconds.items()}


def facts_of(record: CaseRecord) -> tuple[Fact, ...]:
    """Every fact that is known: as read of the narrative, then of the roads and actors that were written."""
    if record.reading is None:
        return ()
    found = list(record.reading.facts)
    network, scenario = record.network, record.scenario
    if network is not None:
        found += road_facts_written(network, record.reading, _answer(record, "road"), record.drawn)
    if network is not None and scenario is not None:
        answer = _answer(record, "scenario")
        found += actor_facts_written(scenario, network, record.reading, answer, record.drawn)
    return by_person(found, record.reading.edits)


def _answer(record: CaseRecord, stage: str) -> Generation | None:
    attempt = record.outcomes[stage].told_by
    return attempt.generation if attempt else None


_ROLLED_RAD = math.radians(60.0)
"""Roll from which a vehicle has left its wheels for good."""
_GENERATED: tuple[Status, str, Sequence[str]] = ("generated", "", ())


def _end(record: CaseRecord) -> tuple[Status, str, Sequence[str]]:
    if record.failure:
        return "failed", record.failure, ()
    for stage in STAGES:
        outcome = record.outcomes.get(stage)
        if outcome is None:
            return "failed", f"the {stage} stage never ran", ()
        if outcome.status == "refused" or outcome.status == "exhausted":
            return outcome.status, f"{stage}: {outcome.reason}", outcome.missing
    if record.execution is None:
        return "failed", "the scenario was never executed", ()
    if record.scenario and record.scenario.declared and record.execution.contact is None:
        return "exhausted", "scenario: the declared contact does not come about when the scenario runs", ()
    if record.scenario and record.scenario.near_crash:
        touched = record.execution.contact is not None
        return ("exhausted", "scenario: in a near crash somebody touches when it runs", ()) if touched else _GENERATED
    if _stays_upright(record):
        return "exhausted", "scenario: the vehicle that is told to roll over stays on its wheels when it runs", ()
    if _subject_untouched(record):
        return "exhausted", "scenario: nobody touches the report's subject when the scenario runs", ()
    return _GENERATED


def _stays_upright(record: CaseRecord) -> bool:
    """Whether a report without a contact tells that its vehicle rolls over, and it does not."""
    told = record.reading.crash.untouched if record.reading else None
    if told is None or told.kind != "rollover" or record.execution is None:
        return False
    mine = next((t for t in record.execution.trajectories if t.actor == told.vehicle), None)
    return mine is None or mine.roll_rad is None or float(np.abs(mine.roll_rad).max()) < _ROLLED_RAD


def _subject_untouched(record: CaseRecord) -> bool:
    """Whether the report states a contact of its subject and none occurs; only for reports without vehicle numbers."""
    crash = record.reading.crash if record.reading else None
    if crash is None or record.scenario is None or record.execution is None or not crash.unnumbered:
        return False
    subject = crash.vehicles[0].id if crash.vehicles else ""
    if all(subject not in (c.striker, c.struck) for c in crash.contacts):
        return False
    sizes = sizes_of(record.scenario.actors)
    mine = next((t for t in record.execution.trajectories if t.actor == subject), None)
    others = [t for t in record.execution.trajectories if t.actor != subject]
    return mine is not None and first_with(mine, others, sizes) is None


def _network(network: RoadNetwork | None) -> dict[str, Any] | None:
    if network is None or network.net_xml is None:
        return None
    graph = parse_net(network.net_xml)
    figures = network_figures(graph)
    return {
        "source": network.source,
        "intersections": figures.intersections,
        "components": figures.components,
        "mean_lanes": round(figures.mean_lanes, 4),
        "segments": segments(graph),
    }


def _place(network: RoadNetwork | None) -> dict[str, Any]:
    """The real place, or why it is not used; nothing where no maps were given."""
    if network is None or network.place is None:
        return {}
    return {"place": {"sentence": network.place.sentence, **network.place.model_dump(mode="json")}}


def _collision(scenario: Scenario | None, execution: Execution | None) -> dict[str, Any]:
    declared = scenario.declared if scenario else None
    observed = execution.contact if execution else None
    return {
        "declared": declared.model_dump() if declared else None,
        "realised": realised(declared, observed),
        "observed": observed.model_dump() if observed else None,
    }


def _near_crash(scenario: Scenario | None, execution: Execution | None) -> dict[str, Any] | None:
    """What was avoided and how, the clearance that was declared, and the closest approach that came of it."""
    near = scenario.near_crash if scenario else None
    if scenario is None or near is None:
        return None
    pair = near.conflict.striker, near.conflict.struck
    closest = closest_approach(execution.trajectories, sizes_of(scenario.actors), pair) if execution else None
    declared = near.model_dump(mode="json", exclude={"clearance_m"})
    basis = "default" if near.clearance_m is None else "told"
    return {
        "declared": declared | {"clearance_m": near.closest_m, "clearance_basis": basis},
        "realised": avoided(near, execution.contact if execution else None, closest),
        "observed": closest.model_dump() if closest else None,
    }


def as_declared(result: Mapping[str, Any]) -> bool | None:
    """Whether a generated case's contact, or its near crash, came about as declared; None where it declares neither."""
    if result.get("status") != "generated":
        return None
    collision, near = result.get("collision") or {}, result.get("near_crash")
    if collision.get("declared"):
        return bool(collision["realised"])
    return bool(near["realised"]) if near else None


def counts_of(result: Mapping[str, Any]) -> Mapping[str, Any] | None:
    """The account of a result (`verdict`, `told`, `has`, `lacking`, `assumed`, `items`); None where there is no
    scenario to hold to the report, or the result is of a version without accounts."""
    account: Mapping[str, Any] | None = result.get("account")
    return account if account and account["verdict"] != "none" else None


def _grounding(outcomes: Mapping[str, StageOutcome]) -> dict[str, float]:
    """Grounding of the answer fields that stand, nats; keys are "<stage>.<path>"."""
    found: dict[str, float] = {}
    for stage, outcome in outcomes.items():
        generation = outcome.told_by.generation if outcome.told_by else None
        found |= {f"{stage}.{path}": round(v, 4) for path, v in generation.grounding.items()} if generation else {}
    return found


def account_so_far(record: CaseRecord) -> Account:
    """The account of a case as it stands."""
    return case_account(record, _end(record)[0], facts_of(record), case_notes(record))


def case_account(record: CaseRecord, status: Status, facts: Sequence[Fact], notes: Sequence[Note]) -> Account:
    """The account of a case; of one that is not generated only what its writers were asked about."""
    network, scenario, execution, reading = record.network, record.scenario, record.execution, record.reading
    told = {stage: attempt for stage, outcome in record.outcomes.items() if (attempt := outcome.told_by)}
    models = {attempt.stage for attempt in told.values() if attempt.generation}
    asked = [one for a in told.values() for one in disagreements_of(a.findings, facts, models, a.stage)]
    if status != "generated" or not (network and network.net_xml and scenario and execution and reading):
        return account_of(None, facts, asked=asked)
    made = ExecutedCase(reading, network, scenario, execution, record.drawn)
    return account_of(made, facts, notes, asked, models)


def case_notes(record: CaseRecord) -> list[Note]:
    """The remarks of all steps, in order."""
    told = [attempt for outcome in record.outcomes.values() if (attempt := outcome.told_by)]
    facts = {fact.field: fact for fact in record.reading.facts} if record.reading else {}
    notes = notes_of("reader", record.notes, facts)
    notes += notes_of("limit", limit_notes(record.reading) if record.reading else (), facts)
    for finding in (f for attempt in told for f in attempt.findings if f.severity in ("doubt", "note")):
        notes += notes_of("finding", [finding.line()], facts, finding.where)
    notes += notes_of("held", [f"{a.stage}: held to {hold.line()}" for a in told for hold in a.held], facts)
    notes += notes_of("judge", record.judgement.lines() if record.judgement else (), facts)
    place = record.network.place if record.network else None
    notes += notes_of("place", [place.sentence] if place else (), facts)
    return notes + notes_of("plan", record.scenario.notes if record.scenario else (), facts)
