"""What a case leaves in its folder: every file, result.json last. Knows the chain's run, which calls it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flows.case import case_folder, person_facts, rule_attempts
from flows.player import overview_png, player_page
from flows.player.player_data import View
from sgcad_core.case.records import Trajectory
from sgcad_core.result import CaseRecord, result_of, seconds_of

if TYPE_CHECKING:
    from flows.case.chain import CaseRun


def leave(run: CaseRun, folder: Path) -> dict[str, Any]:
    """Write the case's files into a folder, result.json last; the result."""
    record = run.record()
    case_folder.write_artifacts(folder, run.report, rule_attempts.with_reading(run.attempts(), record), record)
    if run.metrics is not None:
        _hand_over(run, folder, record)
        case_folder.write_json(folder / "metrics.json", run.metrics)
    if run.trace:
        (folder / "error.txt").write_text(run.trace, encoding="utf-8", errors="replace")
    result = result_of(record) if run.result is None else run.result
    result["impact"] = _impact(record)
    _draw(run, folder, record, result)
    result["seconds"] = seconds_of(record)  # with those of the drawing
    if run.sharing:
        result["shared"] = run.shared
    specs = person_facts.specs_of(record, run.read_alone())
    result["person"] = person_facts.disagreement(specs, run.report.edits if run.report else ())
    case_folder.write_json(folder / person_facts.SPECS, specs)
    case_folder.write_json(folder / "result.json", result)
    return result


def _impact(record: CaseRecord) -> dict[str, Any] | None:
    """Changes of velocity and rest poses of an executed case; None where nothing touches."""
    if not (record.scenario and record.execution and record.network and record.network.net_xml):
        return None
    from flows.drive import drive_stage

    return drive_stage.impact(record)


def _hand_over(run: CaseRun, folder: Path, record: CaseRecord) -> None:
    """What the contact was like, and what the config's drivers made of it (`drive`), into the metrics."""
    drawn = record.network is not None and record.network.net_xml
    if run.metrics is None or not (record.scenario and drawn and run.execution):
        return
    from flows.drive import drive_stage

    with run.clock("measure"):
        run.metrics["exact"] |= drive_stage.contact(record)
    if run.config.drive:
        with run.clock("drive"):
            run.metrics["drive"] = drive_stage.driven(run.config.drive, record, folder)


def _draw(run: CaseRun, folder: Path, record: CaseRecord, result: dict[str, Any]) -> None:
    """player.html and picture.png of an executed case."""
    if record.network and record.scenario and record.execution and run.report:
        with run.clock("draw"):
            view = View.of(record, run.report, run.metrics or {}, result, drives_in(folder))
            (folder / "player.html").write_text(player_page.page(view), encoding="utf-8")
            (folder / "picture.png").write_bytes(overview_png.png(view))


def drives_in(folder: Path) -> dict[str, Sequence[Trajectory]]:
    """What drivers made of the case (flows/drive), by driver and the one who was driven."""
    files = sorted((folder / "drive").glob("*/*/trajectories.csv"))
    return {
        f"{file.parent.parent.name} drives {file.parent.name}": case_folder.read_trajectories(file) for file in files
    }
