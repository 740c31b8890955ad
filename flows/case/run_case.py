"""A case run and written to its folder: every file, result.json last, for every ending."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from flows.case import person_facts
from flows.case.chain import CaseRun
from flows.case.step_log import FILE, OnStep, StepLog, ignore_step
from flows.case.steps import AT_ONCE, StepCalls
from flows.case_files import case_folder
from flows.case_files.find_cases import Case
from flows.case_files.step_keys import StepKeys
from flows.drive import drive_stage
from flows.export import ego_files, traffic_files
from flows.player import overview_png, player_page
from flows.player.player_data import View
from sgcad_core.case.density import NO_TRAFFIC
from sgcad_core.case.records import Attempt, RoadNetwork, Scenario, Trajectory
from sgcad_core.config import Config
from sgcad_core.errors import ConfigError, InvalidOutput, NoTraffic, SimulationFailed
from sgcad_core.execution.traffic_written import CrashWithTraffic
from sgcad_core.formats.openscenario.writing.header import stamped
from sgcad_core.handover.script import Script
from sgcad_core.records.facts import Fact
from sgcad_core.result import CaseRecord, facts_of, result_of, seconds_of

_ROAD = ("roads.", "junction.")
NO_MODEL = "No model was asked. Read by rules, each with the sentence [begin-end) that it is from:"


@dataclass(frozen=True)
class Ending:
    """A finished case as its caller sees it; the rest is on disk. `reused`: it was finished before."""

    result: dict[str, Any]
    reused: bool = False


def run_case(
    config: Config,
    case: Case,
    out: Path,
    digest: str,
    calls: StepCalls = AT_ONCE,
    *,
    keys: StepKeys | None = None,
    tell: OnStep = ignore_step,
) -> Ending:
    """Run one case and write its folder. Raises MissingTool, ConfigError (a folder that cannot be written)."""
    run = CaseRun(config, case, calls, keys, StepLog(tell))
    run.go()
    return Ending(write_run(run, case_folder.CaseFolder(out, config.name, case.id), digest))


def write_failed(config: Config, case: Case, out: Path, digest: str, reason: str) -> Ending:
    """Write the folder of a case whose process died, with the reason; the report is not read, it may be the cause."""
    run = CaseRun(config, case, failure=reason)
    return Ending(write_run(run, case_folder.CaseFolder(out, config.name, case.id), digest))


def write_run(run: CaseRun, folder: case_folder.CaseFolder, digest: str) -> dict[str, Any]:
    """Write the folder of a case that has run; its result. Raises ConfigError where it cannot be written."""
    try:
        return _write(run, folder, digest)
    except OSError as fault:
        raise ConfigError(
            f"{folder.path}: cannot be written ({fault.strerror}); make room or choose another --out; "
            "run again to go on where it stopped"
        ) from fault
    except Exception as fault:  # noqa: BLE001 - what cannot be drawn or written down costs one case, not the batch
        bare = CaseRun(run.config, run.case, report=run.report, seconds=run.seconds)
        bare.fail(fault)
        return _write(bare, folder, digest)


def _write(run: CaseRun, folder: case_folder.CaseFolder, digest: str) -> dict[str, Any]:
    """Write the folder. A failed case gets an empty digest, so that the next run repeats it."""
    with folder.writing() as partial:
        result = write_files(run, partial)
        mark = digest if result["status"] != "failed" else ""
        (partial / case_folder.DIGEST).write_text(mark, encoding="utf-8")
        person_facts.write_report_path(partial, folder.path, run.case.source)
    return result


# ------------------------------------------------------------------ the files
def write_files(run: CaseRun, folder: Path) -> dict[str, Any]:
    """Write the case's files into a folder, result.json last; returns the result."""
    record = run.record()
    script = drive_stage.script_or_none(record)
    rules = drive_stage.rules(script) if script else None
    case_folder.write_artifacts(folder, run.report, with_reading(run.attempts(), record), record)
    if run.metrics is not None:
        if rules:
            run.metrics["rules"] = rules.counts
        _hand_over(run, folder, record, script)
        case_folder.write_json(folder / "metrics.json", run.metrics)
    if run.trace:
        (folder / "error.txt").write_text(run.trace, encoding="utf-8", errors="replace")
    result = result_of(record) if run.result is None else run.result
    result["impact"] = drive_stage.impact(script, record) if script else None
    result["rules"] = rules.findings if rules else []
    made = _add_traffic(run, folder, record, script, result)
    _draw(run, folder, record, result, made)
    _hand_to_a_stack(run, folder, record, script, result, made)
    result["seconds"] = seconds_of(record)  # with those of the drawing
    if run.keys:
        result["shared"] = run.shared
    specs = person_facts.specs_of(record, run.read_alone()) | {"read_by": run.read_by}
    result["person"] = person_facts.disagreement(specs, run.report.edits if run.report else ())
    case_folder.write_json(folder / person_facts.SPECS, specs)
    case_folder.write_json(folder / FILE, [step.told() for step in run.log.steps])
    case_folder.write_json(folder / "result.json", result)
    return result


def _hand_over(run: CaseRun, folder: Path, record: CaseRecord, script: Script | None) -> None:
    """Add the figures of the contact and the config's drives (`drive`) to the metrics."""
    if run.metrics is None or script is None:
        return
    with run.clock("measure"):
        run.metrics["exact"] |= drive_stage.contact(script, record)
    if run.config.drive:
        with run.clock("drive"):
            run.metrics["drive"] = drive_stage.driven(run.config.drive, record, folder)


def _add_traffic(
    run: CaseRun, folder: Path, record: CaseRecord, script: Script | None, result: dict[str, Any]
) -> CrashWithTraffic | None:
    """Add the config's traffic to an executed case; where there is no room for it, say so and leave the case as it
    is."""
    if script is None or run.config.traffic == NO_TRAFFIC:
        return None
    xodr = record.network.xodr if record.network else None
    wanted = run.config.traffic, run.config.seed, run.config.simulator
    try:
        with run.clock("traffic"):
            made = traffic_files.traffic_around_script(script, xodr, *wanted)
    except (NoTraffic, SimulationFailed, InvalidOutput) as fault:
        result["traffic"] = {
            "density": run.config.traffic,
            "seed": run.config.seed,
            "vehicles": [],
            "lacks": str(fault),
        }
        return None
    traffic_files.write_motion(folder, script, made.traffic)
    result["traffic"] = made.traffic.summary()
    return made


def _draw(
    run: CaseRun, folder: Path, record: CaseRecord, result: dict[str, Any], made: CrashWithTraffic | None
) -> None:
    """player.html and picture.png of an executed case."""
    if record.network and record.scenario and record.execution and run.report:
        with run.clock("draw"):
            view = View.of(record, run.report, run.metrics or {}, result, drives_in(folder))
            view = view.among(made.traffic.background if made else ())
            (folder / "player.html").write_text(player_page.page(view), encoding="utf-8")
            (folder / "picture.png").write_bytes(overview_png.png(view))


def _hand_to_a_stack(
    run: CaseRun, folder: Path, record: CaseRecord, script: Script | None, result: dict[str, Any],
    made: CrashWithTraffic | None,
) -> None:  # fmt: skip
    """Name source, date and assumptions in scenario.xosc, and write ego.xosc of an executed case."""
    if record.scenario is None or record.scenario.xosc is None:
        return
    with run.clock("files"):
        source = ego_files.source_of(result)
        xosc = made.xosc if made and made.xosc else record.scenario.xosc
        (folder / "scenario.xosc").write_text(stamped(xosc, source), encoding="utf-8")
        if script and run.config.ego != ego_files.NO_EGO:
            background = made.traffic.background if made else ()
            ego_files.write_beside_case(folder, script, record, run.config, source, background)


def drives_in(folder: Path) -> dict[str, Sequence[Trajectory]]:
    """Trajectories of the case's drives (flows/drive) by driver and ego."""
    files = sorted((folder / "drive").glob("*/*/trajectories.csv"))
    return {
        f"{file.parent.parent.name} drives {file.parent.name}": case_folder.read_trajectories(file) for file in files
    }


# ------------------------------------------------------------------ attempts that asked no model
def with_reading(attempts: Iterable[Attempt], record: CaseRecord) -> tuple[Attempt, ...]:
    """The attempts; those without a model get the facts of their stage as prompt and their specs as answer."""
    facts = facts_of(record)
    return tuple(a if a.prompt or a.answer or a.generation else _told(a, facts, record) for a in attempts)


def _told(attempt: Attempt, facts: Iterable[Fact], record: CaseRecord) -> Attempt:
    mine = [f for f in facts if f.field.startswith(_ROAD) == (attempt.stage == "road")]
    lines = [NO_MODEL, "", *map(_line, mine)] if mine else [NO_MODEL, "", "nothing of this stage is told"]
    return attempt.model_copy(update={"prompt": "\n".join(lines) + "\n", "answer": _written(attempt, record)})


def _line(fact: Fact) -> str:
    value = ", ".join(fact.value) if isinstance(fact.value, tuple) else fact.value
    place = f" [{fact.start}-{fact.end}]" if fact.start is not None else ""
    assumed = " (assumed)" if fact.status == "default" else ""
    return f"{fact.field} = {value}{assumed}  {fact.basis}, {fact.status}: {fact.rule}{place}"


def _written(attempt: Attempt, record: CaseRecord) -> str:
    """The written specs as JSON with the writer's notes; in words where nothing was written."""
    outcome = record.outcomes[attempt.stage]
    artifact = outcome.artifact if outcome.kept in (0, attempt.number) else None
    parts = list(_specs(artifact))
    return "\n".join(parts) + "\n" if parts else f"nothing was written: {outcome.reason or 'see findings.json'}\n"


def _specs(artifact: RoadNetwork | Scenario | None) -> Iterator[str]:
    if isinstance(artifact, RoadNetwork) and artifact.spec:
        yield artifact.spec.model_dump_json(indent=1, exclude_defaults=True)
    elif isinstance(artifact, RoadNetwork):
        yield f"a network that no spec describes ({artifact.source}); see road.net.xml"
    if isinstance(artifact, Scenario):
        yield artifact.behavior.model_dump_json(indent=1) if artifact.behavior else "a scenario without a behavior spec"
        yield from artifact.notes
