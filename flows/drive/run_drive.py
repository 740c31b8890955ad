"""One script, one ego, one driver: the drive and its files. A finished drive is not repeated.

    drive/<driver>/<ego>/   drive.json, trajectories.csv, drive.html

The other files of the case stay as they are.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, cast

from flows.case_files import case_folder
from flows.case_files.find_cases import code_digest
from flows.drive.script_of_case import egos, script_of
from flows.drive.traffic_of_drive import touched
from sgcad_core.config import DriverEntry
from sgcad_core.errors import SgcadError
from sgcad_core.handover.avoidance import avoidance
from sgcad_core.handover.drive import Drive, drive
from sgcad_core.handover.outcome import judge_drive, time_series
from sgcad_core.handover.relative_clock import RELEASE_S
from sgcad_core.handover.script import Script, Staging, staging_for
from sgcad_core.system import temp_folders
from sgcad_core.system.private_folders import open_as_parent

FOLDER = "drive"


@dataclass(frozen=True)
class Order:
    """The drivers, egos and options to apply to every case."""

    drivers: tuple[DriverEntry, ...]
    ego: str = ""
    roles: tuple[str, ...] = ("initiator", "responder")
    release_s: float = RELEASE_S
    factor: float = 1.0
    role_of: Mapping[str, str] = field(default_factory=dict)
    fresh: bool = False
    pages: bool = True


def drive_folder(folder: Path, order: Order) -> list[dict[str, Any]]:
    """Run a finished case's drives; the contents of their drive.json files. Raises BadInput, ConfigError."""
    script = script_of(folder, order.role_of)
    told = (folder / "trajectories.csv").read_bytes() + (folder / "road.net.xml").read_bytes()
    told += (script.xosc or "").encode()
    return drive_script(script, order, folder / FOLDER, hashlib.sha256(told).hexdigest())


def drive_script(script: Script, order: Order, place: Path, content: str = "") -> list[dict[str, Any]]:
    """Run a script's drives. `content`: digest of the script's files; "": finished drives are not reused."""
    found = []
    for ego, role in egos(script, order.ego, order.roles):
        told: _StagedEgo | None = None
        for entry in order.drivers:
            target = place / entry.label / ego
            digest = _digest(content, entry, order, ego, role)
            done = _done(target, digest) if content and not order.fresh else None
            if done is None and told is None:
                told = _StagedEgo.of(script, ego)
            found.append(done or _drive_one(cast("_StagedEgo", told), order, entry, role, target, digest))
    return found


@dataclass(frozen=True, eq=False)
class _StagedEgo:
    """An ego's staging and its last moments to avoid the contact: the same for all drivers."""

    staging: Staging
    avoidance: dict[str, Any] | None

    @staticmethod
    def of(script: Script, ego: str) -> _StagedEgo:
        staging = staging_for(script, ego)
        could = avoidance(staging)
        return _StagedEgo(staging, could.model_dump(mode="json") if could else None)


def _digest(content: str, entry: DriverEntry, order: Order, ego: str, role: str) -> str:
    about = [content, entry.raw, type(entry.driver).version, order.release_s, order.factor, ego, role]
    return hashlib.sha256(json.dumps([*about, code_digest(asks_model=False)], default=str).encode()).hexdigest()


def _done(target: Path, digest: str) -> dict[str, Any] | None:
    told = case_folder.read_json(target / "drive.json")
    return told if told.get("digest") == digest else None


def _drive_one(
    told: _StagedEgo, order: Order, entry: DriverEntry, role: str, target: Path, digest: str
) -> dict[str, Any]:
    started, staging = time.perf_counter(), told.staging
    about: dict[str, Any] = {
        "case": staging.script.case, "driver": entry.label, "fields": entry.raw, "ego": staging.ego, "role": role,
        "release_s": order.release_s, "factor": order.factor, "digest": digest,
        "script_contact_s": round(staging.contact_s, 3) if staging.contact else None,
    }  # fmt: skip
    try:
        driven = drive(staging, entry.driver, release_s=order.release_s, factor=order.factor)
    except SgcadError as fault:
        return about | {"outcome": "failed", "reason": str(fault)}
    about |= judge_drive(driven).model_dump(mode="json") | {"avoidance": told.avoidance}
    if staging.script.background:
        about |= {"traffic": {"vehicles": len(staging.script.background), "touched": touched(driven)}}
    about |= {"seconds": round(time.perf_counter() - started, 4)}
    _write_drive(driven, about | {"series": time_series(driven)}, target, order)
    return about


def _write_drive(driven: Drive, told: Mapping[str, Any], target: Path, order: Order) -> None:
    """The drive's files, whole or not at all."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with temp_folders.folder_beside(target) as partial:
        open_as_parent(partial)
        case_folder.write_trajectories(partial / "trajectories.csv", driven.trajectories)
        if order.pages:
            from flows.drive.page import page

            (partial / "drive.html").write_text(page(driven, told), encoding="utf-8")
        case_folder.write_json(partial / "drive.json", told)
        shutil.rmtree(target, ignore_errors=True)
        partial.rename(target)


def first_page(folders: Sequence[Path], order: Order) -> Path | None:
    """drive.html of the first case that has one, of the first driver that drove it."""
    places = (folder / FOLDER / entry.label for folder in folders for entry in order.drivers)
    return next((page for place in places for page in sorted(place.glob("*/drive.html"))), None)


def drive_folders(folders: Sequence[Path], order: Order, jobs: int) -> Iterator[dict[str, Any]]:
    """Drive many cases, some at a time; results as they come, in the order of the folders, failures among them.

    Results are not kept: with many cases the caller counts them.
    """
    if jobs <= 1 or len(folders) == 1:
        for folder in folders:
            yield from _safely(folder, order)
        return
    from concurrent.futures import ProcessPoolExecutor
    from functools import partial
    from multiprocessing import get_context

    with ProcessPoolExecutor(jobs, mp_context=get_context("spawn")) as pool:
        work = partial(_safely, order=order)
        for found in pool.map(work, folders):
            yield from found


def _safely(folder: Path, order: Order) -> list[dict[str, Any]]:
    try:
        return drive_folder(folder, order)
    except SgcadError as fault:
        return [{"case": folder.name, "driver": "", "role": "", "ego": "", "outcome": "failed", "reason": str(fault)}]
