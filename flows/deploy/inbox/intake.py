"""The inbox: which reports are ready, and where they are moved, each exactly once.

    <address>/report.txt ...                 put there by users: .txt, .xml, .pdf, or a folder a case
    <address>/done|refused|failed/<case>/    the report and outcome.json, afterwards
    <address>/.inbox/ledger                  one file per finished content: no content runs twice
    <address>/.inbox/tries                   how often a content was begun and not ended: it may kill the process

A report is identified by the digest of its content, not by its name. Order at the end of a case: tries, ledger, move;
the next look finishes what a killed process has left. One process works an inbox at a time (inbox.py).
"""

from __future__ import annotations

import hashlib
import json
import logging
import shutil
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple

from flows.batch.plan_batch import MAX_JOBS
from flows.case_files.find_cases import Case, safe_id
from flows.case_files.folder_cases import SUFFIXES
from flows.deploy.storage import HIDDEN, Entry, Place, Stamp
from sgcad_core.result import counts_of

LEDGER, TRIES = f"{HIDDEN}/ledger", f"{HIDDEN}/tries"
MAX_TRIES = 3
"""Begun so often and never ended, a report counts as failed; from the second try it runs alone."""
PORTION = 32
"""Reports per start of worker processes. At most MAX_JOBS of them, in their order, are under suspicion after a kill."""
UNREAD = "unread"
FOLDERS = {"generated": "done", "refused": "refused", "exhausted": "failed", "failed": "failed", UNREAD: UNREAD}
"""Status of a case -> folder its report is moved to; `unread`: no reader takes it."""
UNFINISHED = (".part", ".partial", ".tmp", ".temp", ".crdownload", ".filepart", ".swp", "~")
"""Endings that programs give to unfinished files."""
LOOK_S = 0.2

OnResult = Callable[[Case, dict[str, Any]], None]
Do = Callable[[Sequence[Case], OnResult], None]
"""Runs cases and reports each as it ends, from one thread."""


class Taken(NamedTuple):
    """A report with a private copy of its content, and how often it was begun before."""

    entry: Entry
    digest: str
    case: Case
    tries: int


@dataclass
class Intake:
    """The work of one flow run on an inbox; `tell` writes to its log."""

    place: Place
    staging: Path
    settle_s: float = 10.0
    config: str = ""
    out: Path = Path("runs")
    tell: Callable[[str], None] = logging.getLogger(__name__).warning
    counts: Counter[str] = field(default_factory=Counter)
    _seen: dict[str, tuple[tuple[Stamp, ...], float]] = field(default_factory=dict)
    _stuck: set[str] = field(default_factory=set)

    def work(self, do: Do) -> dict[str, int]:
        """Take and run reports until none is ready; counts by status, and of the entries that are left."""
        while True:
            if taken := self.take():
                self._do(taken, do)
            elif any(e.newest > time.time() and _is_report(e) for e in self._waiting()):
                time.sleep(LOOK_S)  # of a later date than now: settled by our own clock
            else:
                left = Counter("left" if _is_report(e) else "no_report" for e in self._waiting())
                return dict(self.counts + left)

    def _do(self, taken: list[Taken], do: Do) -> None:
        mine, coming = {t.case.id: t for t in taken}, iter(taken)

        def begin(count: int) -> None:
            for one in islice(coming, count):
                self.place.write(f"{TRIES}/{one.digest}", str(one.tries + 1).encode())

        def end(case: Case, result: dict[str, Any]) -> None:
            self._hand_in(mine.pop(case.id), result)
            begin(1)

        try:
            begin(MAX_JOBS)
            do([t.case for t in taken], end)
        finally:  # interrupted, not killed: no report is to blame
            for rest in mine.values():
                self.place.remove(f"{TRIES}/{rest.digest}")
                _unstage(rest.case)

    def _move_unread(self, entry: Entry) -> None:
        """Move a file that no reader takes to `unread`, with the reason in outcome.json."""
        reason = (
            f"{entry.name} cannot be read ({PurePosixPath(entry.name).suffix or 'no suffix'}): give "
            f"{', '.join(sorted(SUFFIXES))}, or a folder with report.txt and a diagram; a .docx or an e-mail is "
            "saved as .txt or .pdf first"
        )
        about = {"reason": reason, "missing": [], "case": safe_id(entry.name), "name": entry.name}
        self.counts[UNREAD] += self._move_with_outcome(entry, {"status": UNREAD} | about)

    @contextmanager
    def _costing(self, entry: Entry) -> Iterator[None]:
        """Around the handling of one report: a fault costs this report alone, and is told in outcome.json and log."""
        try:
            yield
        except Exception as fault:  # noqa: BLE001 - whatever it is, the others are worked on
            self._stuck.add(entry.name)
            self.counts["stuck"] += 1
            reason = f"{entry.name} stays in the inbox: {type(fault).__name__}: {fault}"
            outcome = {"status": "failed", "reason": reason, "name": entry.name}
            self.tell(reason.encode("ascii", "backslashreplace").decode())
            try:
                self.place.write(f"failed/{safe_id(entry.name)}/outcome.json", _json(outcome))
            except (OSError, ValueError) as another:
                self.tell(f"its outcome.json cannot be written either: {type(another).__name__}")

    # ------------------------------------------------------------------ taking
    def take(self) -> list[Taken]:
        """Ready reports; one that was begun before alone. A content finished before is moved to its former folder."""
        taken: list[Taken] = []
        for entry in self._waiting():
            if len(taken) >= PORTION or any(t.tries for t in taken):
                break
            if self._is_settled(entry):
                with self._costing(entry):
                    if _is_report(entry):
                        taken += self._take(entry, taken)
                    else:
                        self._move_unread(entry)
        return taken

    def _waiting(self) -> list[Entry]:
        """All entries but result folders and those that a fault keeps here."""
        return [e for e in self.place.entries() if e.name not in FOLDERS.values() and e.name not in self._stuck]

    def _is_settled(self, entry: Entry) -> bool:
        """Whether it was unchanged for long enough, by its dates or, where clocks differ, by this process's clock."""
        names = [entry.name, *(f.name for f in entry.files)]
        if not entry.files or any(name.lower().endswith(UNFINISHED) for name in names):
            return False
        if time.time() - entry.newest >= self.settle_s:
            return True
        files, since = self._seen.get(entry.name, ((), 0.0))
        if files != entry.files:
            self._seen[entry.name] = (entry.files, time.monotonic())
            return False
        return time.monotonic() - since >= self.settle_s

    def _take(self, entry: Entry, others: Sequence[Taken]) -> Iterator[Taken]:
        content = {file.name: self.place.read(entry.path(file)) for file in entry.files}
        whole = {name: data for name, data in content.items() if data is not None}
        if whole.keys() != content.keys() or self.place.entry(entry.name) != entry:
            return  # changed meanwhile: another look
        digest = _digest(entry, whole)
        tries = int(self.place.read(f"{TRIES}/{digest}") or 0)
        if any(other.digest == digest for other in others) or self._known(entry, digest) or (tries and others):
            return
        taken = Taken(entry, digest, _stage(entry, whole, digest, self.staging), tries)
        if tries < MAX_TRIES:
            yield taken
            return
        reason = f"the process was killed {tries} times at work on it: see the logs; drop it again to retry"
        self._hand_in(taken, {"status": "failed", "reason": reason, "missing": []})

    # ------------------------------------------------------------------ handing in
    def _known(self, entry: Entry, digest: str) -> bool:
        """Whether this content is finished; its report is then moved to its folder."""
        if (written := self.place.read(f"{LEDGER}/{digest}.json")) is None:
            return False
        self.counts["again"] += self._move_with_outcome(entry, json.loads(written))
        self.place.remove(f"{TRIES}/{digest}")
        return True

    def _hand_in(self, taken: Taken, result: dict[str, Any]) -> None:
        """Record a case's ending and move its report."""
        with self._costing(taken.entry):
            _unstage(taken.case)
            self.place.remove(f"{TRIES}/{taken.digest}")
            outcome = {key: result.get(key) for key in ("status", "reason", "missing")} | {"account": _account(result)}
            outcome |= {
                "case": taken.case.id, "config": self.config, "digest": taken.digest, "name": taken.entry.name,
                "result": str(self.out.resolve() / result["config"] / taken.case.id) if "config" in result else None,
            }  # fmt: skip
            if outcome["status"] != "failed":  # a failed one may be dropped again
                self.place.write(f"{LEDGER}/{taken.digest}.json", _json(outcome))
            self._move_with_outcome(taken.entry, outcome)
            self.counts[str(outcome["status"])] += 1

    def _move_with_outcome(self, entry: Entry, outcome: dict[str, Any]) -> bool:
        """Move a report beside its outcome, unless it was changed or moved meanwhile."""
        folder = f"{FOLDERS[outcome['status']]}/{outcome['case']}"
        if self.place.entry(entry.name) != entry:
            return False
        self.place.write(f"{folder}/outcome.json", _json(outcome))
        try:
            self.place.move(entry, f"{folder}/{entry.name}")
        except FileNotFoundError:
            return False
        return True


def _account(result: dict[str, Any]) -> dict[str, Any] | None:
    """The account of the scenario with all things that lack; None without a scenario."""
    if (account := counts_of(result)) is None:
        return None
    counts = {key: account[key] for key in ("verdict", "told", "has", "lacking", "assumed")}
    return counts | {"lacks": [f"{i['text']}: {i['reason']}" for i in account["items"] if i["kind"] == "lacks"]}


def _is_report(entry: Entry) -> bool:
    """Whether its name is that of a report."""
    if entry.name.lower().endswith(UNFINISHED):
        return False
    return entry.is_folder or PurePosixPath(entry.name).suffix.lower() in SUFFIXES


def _digest(entry: Entry, content: dict[str, bytes]) -> str:
    """Digest of an entry's content: names and contents within a folder, suffix and content of a file."""
    found = hashlib.sha256(PurePosixPath(entry.name).suffix.lower().encode() if not entry.is_folder else b"/")
    for name, data in sorted(content.items()):
        found.update(f"\n{name}\n{len(data)}\n".encode("utf-8", "surrogateescape") + data)
    return found.hexdigest()


def _stage(entry: Entry, content: dict[str, bytes], digest: str, staging: Path) -> Case:
    """Copy a report into the staging folder. The case's name is made of the report's name and digest."""
    stem = entry.name if entry.is_folder else PurePosixPath(entry.name).stem
    name = safe_id(f"{safe_id(stem)[:80]}-{digest[:12]}")
    source = staging / name / (name if entry.is_folder else f"{name}{PurePosixPath(entry.name).suffix.lower()}")
    for inner, data in content.items():
        file = source / inner if inner else source
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(data)
    return Case(source, name)


def _unstage(case: Case) -> None:
    shutil.rmtree(case.source.parent, ignore_errors=True)


def _json(content: dict[str, Any]) -> bytes:
    """As UTF-8; a byte of a name that is none stays as an escape that JSON reads back."""
    return (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode("utf-8", "backslashreplace")
