"""A case that runs elsewhere: sent with its report, run in a scratch folder, given back as a packed folder.

The task keeps the packed folder in the store under a key of the job's digest, so that a batch whose starter was killed
finds finished cases as Cached. Import after `settings.quiet_libraries()`.
"""

from __future__ import annotations

import hashlib
import io
import os
import tarfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from prefect import task
from prefect.cache_policies import CachePolicy
from prefect.client.schemas.objects import State
from prefect.context import TaskRunContext
from prefect.transactions import get_transaction

from flows.batch.case_order import Order, config_key, config_of
from flows.batch.case_task import run_steps, silence_prefect, state_of
from flows.batch.kept_results import KeptRecords, own_record
from flows.batch.plan_batch import Job
from flows.batch.remote import store
from flows.case import person_facts
from flows.case.run_case import Ending
from flows.case.steps import Held
from flows.case_files import find_cases
from flows.case_files.case_folder import CaseFolder
from flows.case_files.find_cases import Case
from sgcad_core.errors import BadInput, ConfigError
from sgcad_core.system import report_files
from sgcad_core.system.temp_folders import temp_folder


@dataclass(frozen=True)
class SentCase:
    """An order with the files of its report by their names, and the config's digest on the starter's machine."""

    order: Order
    files: Mapping[str, bytes]
    is_folder: bool
    """Whether the report is a folder, not a file."""
    config_digest: str

    @property
    def key(self) -> str:
        """The key of the case's result in the store."""
        return hashlib.sha256(f"case {self.order.job} {self.order.digest}".encode()).hexdigest()


# ------------------------------------------------------------------ the starter
def sent(order: Order, config_digest: str) -> SentCase:
    """An order with its report. Raises BadInput for a report of which `can_be_sent` is false."""
    source, is_folder = order.case.source, order.case.source.is_dir()
    root = source if is_folder else source.parent
    files = {str(f.relative_to(root)): report_files.read_regular(f, root) for f in _files(source)}
    case = Case(Path(order.case.id if is_folder else source.name), order.case.id)
    return SentCase(replace(order, case=case, out=Path()), files, is_folder, config_digest)


def can_be_sent(source: Path) -> bool:
    """Whether a report's files can be read as its reader would; other reports are read here, which says why not."""
    try:
        return all(_is_plain(file, source) for file in _files(source))
    except (BadInput, OSError):
        return False


def _files(source: Path) -> Iterator[Path]:
    if source.is_dir():
        yield from report_files.files_below(source)
        return
    yield source
    if (facts := report_files.facts_file(source)).is_file():
        yield facts


def _is_plain(file: Path, source: Path) -> bool:
    inside = report_files.leads_inside(file, source if source.is_dir() else source.parent)
    small = report_files.is_regular(file) and file.stat().st_size <= report_files.MAX_FILE_BYTES
    return inside and small and os.access(file, os.R_OK)


def receive(job: Job, content: bytes) -> Ending:
    """Unpack a finished case into its folder. Raises ConfigError where the folder cannot be written."""
    try:
        with job.folder.writing() as partial:
            with tarfile.open(fileobj=io.BytesIO(content), mode="r:gz") as archive:
                archive.extractall(partial, filter="data")
            person_facts.write_report_path(partial, job.folder.path, job.case.source)
    except (OSError, tarfile.TarError) as fault:
        raise ConfigError(
            f"{job.folder.path}: cannot be written ({fault}); run again to go on where it stopped"
        ) from fault
    return Ending(job.folder.result() or {})


# ------------------------------------------------------------------ the worker
@dataclass
class CasePolicy(CachePolicy):
    """The key of a sent case; a kept result that is damaged or foreign is removed."""

    def compute_key(
        self, task_ctx: TaskRunContext, inputs: dict[str, Any], flow_parameters: dict[str, Any], **kwargs: Any
    ) -> str | None:
        """The key of a task run."""
        key = str(inputs["order"].value.key)
        storage = task_ctx.result_store.result_storage
        if (content := own_record(storage, key)) and KeptRecords().loads(content) is None:
            store.remove(storage, key)
        return key


@task(
    name="case",
    task_run_name="{name}",
    cache_policy=CasePolicy(),
    persist_result=True,
    result_serializer=KeptRecords(),
    cache_result_in_memory=False,
)
def sent_case(name: str, order: Any) -> State[Any]:
    """One report under one config, on another process or machine: read, road, scenario, simulate, measure, judge."""
    return run_sent(order)


def run_sent(order: Held[SentCase]) -> State[Any]:
    """The body of `sent_case`, in a module that workers import. Raises ConfigError on a machine that differs."""
    asked = order.value
    silence_prefect()
    _check_same(asked)
    with temp_folder("case") as scratch:
        mine = _unpacked(asked, scratch)
        ending = run_steps(mine, limited=False, alone=_is_alone())
        content = packed(CaseFolder(mine.out, mine.name, mine.case.id).path)
    if ending.result["status"] == "failed" and (kept := get_transaction()):
        kept.write_on_commit = False  # the next batch repeats a failed case
    return state_of(ending, Held(content))


_digests: dict[str, str] = {}
"""Digests of configs on this machine."""


def _check_same(asked: SentCase) -> None:
    """Raise ConfigError if this machine would compute another result."""
    order, config = asked.order, config_of(asked.order)
    key = config_key(order.raw, order.name)
    here = _digests.get(key) or _digests.setdefault(key, find_cases.config_digest(config))
    if here != asked.config_digest:
        raise ConfigError(
            f"{order.job}: a worker would compute another result than the starter asks for (digest of the config "
            f"{here[:12]}, not {asked.config_digest[:12]}): install the same version of the package, its plugins "
            "and the files that the configuration names on every machine"
        )


def _unpacked(asked: SentCase, scratch: Path) -> Order:
    """The order with its report in a folder of this machine."""
    source = scratch / "report" / asked.order.case.source
    root = source if asked.is_folder else source.parent
    root.mkdir(parents=True)
    for name, content in asked.files.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_bytes(content)
    return replace(asked.order, case=Case(source, asked.order.case.id), out=scratch / "out")


def packed(folder: Path) -> bytes:
    """A case folder as one archive."""
    packet = io.BytesIO()
    with tarfile.open(fileobj=packet, mode="w:gz", compresslevel=1) as archive:
        for path in sorted(folder.iterdir()):
            archive.add(path, arcname=path.name)
    return packet.getvalue()


def _is_alone() -> bool:
    """Whether this is a Dask worker with one case at a time, which is started again when its process ends."""
    from distributed import get_worker

    try:
        worker = get_worker()
    except ValueError:
        return False
    return bool(worker.nanny and worker.state.nthreads == 1)
