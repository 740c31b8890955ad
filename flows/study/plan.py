"""A study checked whole and laid out: every arm's config, every case, every job, and study.json.

    made = plan(load_study("alpha"), out=Path("runs"), cases=[Path("my-cases")])
    made.write()                        # runs/studies/alpha/study.json
    made.batch, made.jobs               # what flows.study.run_study does, whole or in parts

Starts nothing. The layout depends on the study, the cases and the code only, so that several hosts that plan
the same study find the same jobs under the same names.
"""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

from flows.batch.plan_batch import Batch, Job, batch_over
from flows.batch.tracking import machine
from flows.case_files import case_folder
from flows.case_files.find_cases import Case, cases_in, config_digest, dataset_digest
from flows.case_files.folder_cases import left_out
from flows.study.published import publication
from flows.study_file.arm_config import config_of
from flows.study_file.spec import Arm, Study, fault_lines
from sgcad_core import settings
from sgcad_core.config import Config, build
from sgcad_core.errors import ConfigError

DOCUMENT = "study.json"
SHELF = ".stages"


@dataclass(frozen=True)
class Plan:
    """Everything that a study will do. `jobs` are all of its jobs, arm by arm."""

    study: Study
    batch: Batch
    jobs: tuple[Job, ...]
    truth: Path | None = None
    folders: tuple[Path, ...] = ()
    overrides: tuple[str, ...] = ()

    @property
    def folder(self) -> Path:
        """Where the study lies: <out>/studies/<name>."""
        return self.batch.out

    def jobs_named(self, names: Iterable[str]) -> tuple[Job, ...]:
        """Jobs by name ("<arm>/<case>"), in the study's order. Raises ConfigError for one that is not there."""
        wanted = set(names)
        found = tuple(job for job in self.jobs if job.name in wanted)
        if missing := sorted(wanted - {job.name for job in found}):
            raise ConfigError(f"study {self.study.name}: no such job: {', '.join(missing)}; jobs are <arm>/<case>")
        return found

    def document(self) -> dict[str, Any]:
        """The content of study.json."""
        return {
            "study": self.study.name,
            "title": self.study.title,
            "reference": self.study.reference,
            "truth": str(self.truth) if self.truth else None,
            "again": {
                "file": str(self.study.file.resolve()),
                "cases": [str(folder.resolve()) for folder in self.folders],
                "set": list(self.overrides),
            },
            "cases": [case.id for case in self.batch.cases],
            "dataset_digest": dataset_digest(self.batch.cases),
            "arms": [_told_of(*pair) for pair in zip(self.study.arms, self.batch.configs, strict=True)],
            "package": version("sg-cadvlm"),
            "git_commit": machine.git_commit(),
            "hardware": machine.hardware(),
        }

    def write(self) -> Path:
        """Write study.json, whole or not at all; its path."""
        file = self.folder / DOCUMENT
        partial = self.folder / f".{DOCUMENT}.partial"
        case_folder.write_json(partial, self.document())
        partial.replace(file)
        return file


def plan(
    study: Study,
    out: Path,
    *,
    cases: Sequence[Path] = (),
    truth: Path | None = None,
    overrides: Sequence[str] = (),
    jobs: int | None = None,
    fresh: bool = False,
) -> Plan:
    """Check a study and lay it out. Raises ConfigError with every fault; only empty folders are made.

    `cases` are folders of cases and `truth` a folder of true networks, in place of the study's own. `overrides`
    hold for all arms, whose own ones come after them.
    """
    faults = list(study.faults)
    found = _cases(study, cases, faults)
    truth = _truth(study, truth, faults)
    configs = [_config(study, arm, out, overrides, faults) for arm in study.arms]
    faults += _unpublished(study)
    loaded = tuple(config for config in configs if config is not None)
    if jobs is not None and jobs < 1:
        faults.append(f"--jobs {jobs}: at least 1 is needed")
    if faults:
        raise ConfigError(fault_lines(study.file, faults))
    folder = folder_of(study.name, out)
    batch = batch_over(found, loaded, folder, jobs, fresh)
    folders = tuple(cases) or study.cases
    batch = dataclasses.replace(batch, flow="study", title=study.name, shelf=folder / SHELF, left=left_out(folders))
    return Plan(study, batch, batch.plan(), truth, folders, tuple(overrides))


def folder_of(name: str, out: Path) -> Path:
    """Where a study of this name lies."""
    return out.resolve() / "studies" / name


def arms_of(study: Study, out: Path, overrides: Sequence[str] = ()) -> tuple[Config, ...]:
    """The arms' configs alone, without cases. Raises ConfigError with every fault."""
    faults = [*study.faults, *_unpublished(study)]
    configs = [_config(study, arm, out, overrides, faults) for arm in study.arms]
    if faults:
        raise ConfigError(fault_lines(study.file, faults))
    return tuple(config for config in configs if config is not None)


def described(study: Study, overrides: Sequence[str] = ()) -> str:
    """A study in words, one line an arm. Raises ConfigError with every fault of its arms."""
    configs = arms_of(study, Path(), overrides)
    width = max(len(arm.name) for arm in study.arms)
    based = f"; extends {study.extends}" if study.extends else ""
    lines = [f"study {study.name}: {study.title}; {len(configs)} arms{based}"]
    return "\n".join([*lines, *(f"  {a.name:<{width}}  {' '.join([_plain(a.config), *a.set])}" for a in study.arms)])


def _cases(study: Study, named: Sequence[Path], faults: list[str]) -> tuple[Case, ...]:
    folders = tuple(named) or study.cases
    if not folders:
        faults.append("no cases: give --cases DIR (a folder of case folders), or `cases: [DIR]` in the study")
        return ()
    try:
        return cases_in(folders)
    except ConfigError as fault:
        faults.append(str(fault))
        return ()


def _truth(study: Study, named: Path | None, faults: list[str]) -> Path | None:
    truth = named or study.truth
    if truth is None:
        return None
    if not truth.exists():
        faults.append(f"truth {truth}: no such folder; give the folder with the true networks of the cases")
    return truth.resolve()


def _unpublished(study: Study) -> list[str]:
    """Arms that name a row of the published figures that is not there."""
    rows = publication().rows
    wrong = [arm for arm in study.arms if arm.published is not None and arm.published not in rows]
    return [f"arm {a.name!r}: published {a.published!r} is no row; there are: {', '.join(rows)}" for a in wrong]


def _config(study: Study, arm: Arm, out: Path, overrides: Sequence[str], faults: list[str]) -> Config | None:
    """An arm's config under the arm's name; None and a fault where it cannot be built."""
    try:
        config = config_of(study, arm, before=tuple(overrides))
        raw = copy.deepcopy(config.raw)
        raw["tracker"] = _tracker(config, study, out)
        return build(raw, arm.name, arm.config)
    except ConfigError as fault:
        faults.append(f"arm {arm.name!r}: {fault}")
        return None


def _tracker(config: Config, study: Study, out: Path) -> Any:
    """The tracker's entry with the study as its experiment, and its database in the output folder unless named."""
    entry = config.raw["tracker"]
    entry = {"name": entry} if isinstance(entry, str) else dict(entry)
    fields = type(config.tracker).model_fields
    if "experiment" in fields:
        entry["experiment"] = f"study/{study.name}"
    if "database" in fields and config.tracker.model_dump().get("database") is None:
        entry["database"] = str(out.resolve() / "mlflow.db")
    return entry


def _told_of(arm: Arm, config: Config) -> dict[str, Any]:
    """An arm in study.json."""
    return {
        "name": arm.name,
        "label": arm.label or arm.name,
        "config": _plain(arm.config),
        "set": list(arm.set),
        "digest": config_digest(config),
        "published": arm.published,
        "factors": dict(arm.factors),
    }


def _plain(config: str) -> str:
    """A config's path under configs/ where it lies there: no machine's paths."""
    path = Path(config).resolve()
    return str(path.relative_to(settings.CONFIGS)) if path.is_relative_to(settings.CONFIGS) else config
