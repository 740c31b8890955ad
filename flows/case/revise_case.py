"""A person's facts on one finished case: applied, then planned, simulated, checked and written again in about a second.

    revise(folder, {"roads.N.lanes_forward": 2}, who="ann", why="the drawing shows two")
    undo(folder)

A model is not asked again: its answers are those that the case's folder keeps. A wrong edit
raises WrongEdit and leaves facts.yaml and the case's folder as they were. Edits of one report wait for each other, also
across processes. Knows no Prefect and no page.
"""

from __future__ import annotations

import getpass
import hashlib
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from flows.case import person_facts
from flows.case.chain import CaseRun
from flows.case.facts_journal import both_or_neither, settle, settled
from flows.case.revision_check import check_revision, findings_of
from flows.case.run_case import write_run
from flows.case_files import find_cases
from flows.case_files.case_folder import CONFIG, CaseFolder, read_json
from flows.case_files.find_cases import Case
from sgcad_core.case.records import Finding
from sgcad_core.config import Config, build
from sgcad_core.errors import BadInput, ConfigError, WrongEdit
from sgcad_core.records.edits import Edit, effective
from sgcad_core.result import STAGES, result_of
from sgcad_core.revision.fields import CaseField, fields_of, parsed_edit
from sgcad_core.revision.file import (
    MOST_BYTES,
    facts_lock,
    read_edits,
    report_digest,
    with_new_edits,
    without_last_edits,
    write_edits,
)
from sgcad_core.revision.finding_fields import findings_by_field
from sgcad_core.system import temp_folders
from sgcad_core.system.report_files import facts_file, read_regular
from sgcad_core.system.yaml_faults import YAML_FAULTS

Wanted = Callable[[], bool]
FieldValues = Mapping[str, object]
"""Field -> value, typed or as text; `AS_READ` takes a field's edits back."""


def always() -> bool:
    """A change that is wanted whatever happens."""
    return True


@dataclass(frozen=True)
class Revised:
    """Result of a revision; the rest is in the case's folder."""

    result: dict[str, Any]
    """The content of result.json."""
    findings: Mapping[str, tuple[Finding, ...]]
    """By field, under "" those of no field; the planner's notes are among them."""
    edits: tuple[Edit, ...]
    """The effective edits of the case's report."""
    seconds: float
    stamp: str
    """Fingerprint of the facts as they stand now, for `seen`."""
    changed: bool = True
    """False where the edits change no value: nothing was done."""


@dataclass(frozen=True)
class Opened:
    """A finished case with its report and its config."""

    folder: Path
    source: Path
    config: Config
    former: dict[str, Any]
    specs: person_facts.Specs

    @property
    def case(self) -> Case:
        """The case as the chain knows it."""
        return Case(self.source, self.folder.name)

    @property
    def file(self) -> Path:
        """Path of the report's facts.yaml."""
        return facts_file(self.source)

    def edits(self) -> tuple[Edit, ...]:
        """All edits of its report. Raises BadInput."""
        return read_edits(self.file, report_digest(self.source))


# ------------------------------------------------------------------ looking
def opened(folder: Path, report: Path | None = None) -> Opened:
    """A finished case's folder, such as runs/template/crash-17; `report`: where its report is now, if it was moved.

    Raises BadInput for a folder that is none, or whose report is gone; ConfigError where its config is lost.
    """
    folder = folder.resolve()
    former = CaseFolder(folder.parent.parent, folder.parent.name, folder.name).result()
    if former is None:
        raise BadInput(f"{folder}: no result.json in it: give the folder of a finished case, such as runs/template/x")
    source = report or person_facts.report_path(folder)
    if not source.exists():
        raise BadInput(f"{source}: the report of {folder.name} is gone: put it back, or name it with --report")
    settled(source)
    return Opened(folder, source, _config(folder.parent / CONFIG), former, person_facts.read_specs(folder))


def _config(file: Path) -> Config:
    try:
        return _built(file, file.stat().st_mtime_ns)
    except FileNotFoundError as fault:
        raise ConfigError(f"{file}: the config of these results is gone: run the case again") from fault


@lru_cache(maxsize=8)
def _built(file: Path, changed_ns: int) -> Config:
    """The config of a folder of results; plugins are built once while the file stays as it is."""
    try:
        raw = yaml.safe_load(read_regular(file, most=MOST_BYTES).decode("utf-8"))
    except YAML_FAULTS as fault:
        raise ConfigError(f"{file}: no YAML ({fault}): run the case again") from fault
    if not isinstance(raw, dict):
        raise ConfigError(f"{file}: no config in it: run the case again")
    return build(raw, file.parent.name, str(file))


def editable(folder: Path) -> tuple[CaseField, ...]:
    """The fields of a finished case that can be changed, with their values. Raises BadInput."""
    specs = person_facts.read_specs(folder)
    return fields_of(specs.road, specs.behavior)


def stamp_of(edits: Sequence[Edit]) -> str:
    """Fingerprint of edits: pages with the same stamp show the same facts."""
    return hashlib.sha256("\n".join(edit.model_dump_json() for edit in edits).encode()).hexdigest()[:16]


# ------------------------------------------------------------------ changing
def revise(
    folder: Path,
    edits: FieldValues,
    *,
    who: str = "",
    why: str = "",
    seen: str | None = None,
    report: Path | None = None,
    wanted: Wanted = always,
) -> Revised:
    """Apply a person's facts to a finished case and write its result files again.

    `who`: the user's name unless given. `seen`: the `stamp` of the facts that the person saw; others are refused.
    `wanted` is asked before anything is written. Raises WrongEdit (nothing was changed), BadInput, ConfigError.
    """
    started = time.perf_counter()
    case = opened(folder, report)
    new = _edits(edits, who, why)
    temp_folders.remove_leftover_folders()  # of an edit that was killed
    with facts_lock(case.source):
        settle(case.file)
        before = _unchanged(case.edits(), seen)
        after = with_new_edits(before, new)
        if after == before:
            return _as_it_stands(case, before, started)
        return _written(case, before, after, {edit.field for edit in new}, started, wanted=wanted)


def undo(folder: Path, *, seen: str | None = None, report: Path | None = None, wanted: Wanted = always) -> Revised:
    """Undo the last revision of a case's report, by any author. Raises WrongEdit where there is none."""
    started = time.perf_counter()
    case = opened(folder, report)
    temp_folders.remove_leftover_folders()  # of an edit that was killed
    with facts_lock(case.source):
        settle(case.file)
        before = _unchanged(case.edits(), seen)
        if not before:
            raise WrongEdit(f"{case.folder.name}: there is nothing to undo: none of its facts was changed")
        return _written(case, before, without_last_edits(before), set(), started, wanted=wanted)


def note(source: Path, edits: FieldValues, *, who: str = "", why: str = "") -> tuple[Edit, ...]:
    """Keep facts beside a report without running anything; the next run uses them. Raises WrongEdit, BadInput."""
    new = _edits(edits, who, why)
    with facts_lock(source):
        settle(facts_file(source))
        digest = report_digest(source)
        after = with_new_edits(read_edits(facts_file(source), digest), new)
        write_edits(facts_file(source), after, digest)
    return effective(after)


def _edits(given: FieldValues, who: str, why: str) -> tuple[Edit, ...]:
    """Typed edits of one moment. Raises WrongEdit with every fault found."""
    faults: list[str] = []
    found: list[Edit] = []
    now = datetime.now(UTC)
    for field, raw in given.items():
        try:
            name, value = parsed_edit(field, raw)
            found.append(Edit(field=name, value=value, who=who or _user(), when=now, why=why[:1000]))
        except WrongEdit as fault:
            faults.append(str(fault))
    if faults or not found:
        raise WrongEdit("\n".join(faults) or "no fact is given: --set FIELD=VALUE; --list names the fields")
    return tuple(found)


def _user() -> str:
    try:
        return getpass.getuser()
    except (KeyError, OSError):  # a container whose user has no name
        return ""


def _unchanged(edits: tuple[Edit, ...], seen: str | None) -> tuple[Edit, ...]:
    """The edits, if they are those that were seen."""
    if seen is None or seen == stamp_of(edits):
        return edits
    last = f"{edits[-1].who or 'a person'} changed {edits[-1].field}" if edits else "the last edit was undone"
    raise WrongEdit(f"the facts of this case have changed meanwhile ({last}): load it again, then repeat the change")


# ------------------------------------------------------------------ running
def _written(
    case: Opened,
    before: tuple[Edit, ...],
    after: tuple[Edit, ...],
    new: set[str],
    started: float,
    *,
    wanted: Wanted,
) -> Revised:
    """Run the case with other edits; keep edits and results, or neither."""
    as_read = _as_read(case, before) if after else None
    hold_to = case.specs.read_by
    run = CaseRun(case.config, case.case, edits=after, answers=_kept(case), as_read=as_read, hold_to=hold_to)
    run.go()
    findings = findings_of(run)
    result = run.result = result_of(run.record())
    check_revision(case.former, result, findings, [e for e in after if e.field in new], undoing=not new)
    if not wanted():
        raise WrongEdit(f"{case.folder.name}: this change is not waited for any more; nothing was changed")
    with both_or_neither(case.file, case.folder):
        write_edits(case.file, after, report_digest(case.source))
        digest = find_cases.digest_of(case.case, case.config)
        result = write_run(run, CaseFolder(case.folder.parent.parent, case.config.name, case.folder.name), digest)
    specs = person_facts.read_specs(case.folder)
    said = findings_by_field(findings, specs.road, specs.behavior, after)
    return Revised(result, said, effective(after), time.perf_counter() - started, stamp_of(after))


def _as_read(case: Opened, before: tuple[Edit, ...]) -> dict[str, Any] | None:
    """The specs before the first edit; None: not known here, so the chain finds them."""
    if before:
        return case.specs.as_read
    return read_json(case.folder / person_facts.SPECS)


def _kept(case: Opened) -> dict[str, person_facts.KeptAnswers]:
    """The answers that a model gave, by stage. Raises BadInput where a stage has none yet."""
    asks = {"road": case.config.road_writer.asks_model, "scenario": case.config.scenario_writer.asks_model}
    asked = [stage for stage in STAGES if asks[stage]]
    return {stage: person_facts.read_kept_answers(case.folder, stage, case.specs.kept.get(stage, 0)) for stage in asked}


def _as_it_stands(case: Opened, edits: tuple[Edit, ...], started: float) -> Revised:
    return Revised(case.former, {}, effective(edits), time.perf_counter() - started, stamp_of(edits), changed=False)
