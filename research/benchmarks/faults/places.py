"""A place of its own for every trial: cases, results, Prefect's home, temporary folder, and a mark on its processes.

Knows the file system and processes; nothing of what is run.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
import time
import uuid
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import psutil

from sgcad_core import settings

MARK = "SGCAD_FAULTS"
END_S = 90.0
"""Until the children of a killed command have ended: a worker finishes its case first."""


@dataclass(frozen=True)
class Place:
    """A folder for one trial. Every process started here, and its children, carry `mark` in their environment."""

    folder: Path
    home: Path | None = None
    """A Prefect home to begin with a copy of; None: begin with none, as on a new machine."""
    stays: bool = False
    """The folder may be there from an earlier call."""
    mark: str = field(default_factory=lambda: uuid.uuid4().hex)

    def __post_init__(self) -> None:
        self.folder.mkdir(parents=True, exist_ok=self.stays)
        self.temporary.mkdir(exist_ok=self.stays)
        if self.home:
            shutil.copytree(self.home, self.prefect)

    @property
    def temporary(self) -> Path:
        """What is TMPDIR there."""
        return self.folder / "tmp"

    @property
    def prefect(self) -> Path:
        """Prefect's home there."""
        return self.folder / "prefect"

    def environment(self) -> dict[str, str]:
        """For the processes."""
        kept = {k: v for k, v in os.environ.items() if not k.startswith(("PREFECT_", "MLFLOW_"))}
        own = {MARK: self.mark, "TMPDIR": str(self.temporary), "PREFECT_HOME": str(self.prefect)}
        own |= {
            "PYTHONPATH": str(settings.ROOT),
            "MPLCONFIGDIR": str(self.folder / "matplotlib"),
            "OMP_NUM_THREADS": "1",
        }
        own |= {"TORCHINDUCTOR_CACHE_DIR": str(self.folder / "inductor")}
        return kept | own

    def start(
        self, arguments: Sequence[str], more: Mapping[str, str] | None = None, limits: Sequence[str] = ()
    ) -> subprocess.Popen[bytes]:
        """Start Python in a session of its own, under a program such as prlimit; what it says goes to `said.log`."""
        with (self.folder / "said.log").open("ab") as log:
            return subprocess.Popen(  # noqa: S603 - our own interpreter and module
                [*limits, sys.executable, *arguments],
                cwd=self.folder,
                env=self.environment() | dict(more or {}),
                stdin=subprocess.DEVNULL,
                stdout=log,
                stderr=log,
                start_new_session=True,
            )

    def said(self) -> str:
        """What the commands have said so far."""
        file = self.folder / "said.log"
        return file.read_text(encoding="utf-8", errors="replace") if file.is_file() else ""

    def alive(self) -> list[psutil.Process]:
        """Processes that carry the mark and have not ended."""
        return list(_marked(self.mark))

    def wait_for_all(self, patience_s: float = END_S) -> list[str]:
        """Wait until no process is left; command lines of those that stay, which are then ended."""
        deadline = time.monotonic() + patience_s
        while (there := self.alive()) and time.monotonic() < deadline:
            time.sleep(0.2)
        told = [_line(process) for process in there]
        for process in there:
            process.kill()
        return told

    @contextmanager
    def as_temporary(self) -> Iterator[None]:
        """This process takes the trial's temporary folder for its own meanwhile."""
        before, tempfile.tempdir = tempfile.tempdir, str(self.temporary)
        try:
            yield
        finally:
            tempfile.tempdir = before

    def leftovers(self) -> list[str]:
        """Names of what lies in the temporary folder."""
        return sorted(p.name for p in self.temporary.iterdir())

    def remove(self) -> None:
        """Away with all of it."""
        shutil.rmtree(self.folder, ignore_errors=True)


def _marked(mark: str) -> Iterator[psutil.Process]:
    for process in psutil.process_iter():
        try:
            if process.environ().get(MARK) == mark and process.status() != psutil.STATUS_ZOMBIE:
                yield process
        except psutil.Error:
            continue


def _line(process: psutil.Process) -> str:
    try:
        return " ".join(process.cmdline())[:160]
    except psutil.Error:
        return f"process {process.pid}"
