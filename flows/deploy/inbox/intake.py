"""The inbox: which reports are ready, which worker takes them, where they are moved, each exactly once.

    <address>/report.txt ...       put there by users: .txt, .xml, .pdf, or a folder a case
    <address>/done|refused|failed/<case>/    the report and outcome.json, afterwards
    <address>/.inbox/claims        the workers of the reports (flows/deploy/inbox/claims.py)
    <address>/.inbox/ledger        one file per finished content: no content runs twice

A report is identified by the digest of its content, not by its name. Order at the end of a case: ledger, move, claim;
the next look finishes what a process killed in between has left.
"""

from __future__ import annotations

import hashlib
import json
import shutil
import time
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any, NamedTuple

from flows.case_files.find_cases import SUFFIXES, Case, safe_id
from flows.deploy.inbox.claims import ALONE_FROM, MAX_TAKES, Claim, Claims
from flows.deploy.storage import HIDDEN, Entry, Place, Stamp
from sgcad_core.result import counts_of

LEDGER = f"{HIDDEN}/ledger"
UNREAD = "unread"
FOLDERS = {"generated": "done", "refused": "refused", "exhausted": "failed", "failed": "failed", UNREAD: UNREAD}
"""Status of a case -> folder its report is moved to; `unread`: no reader takes it."""
UNFINISHED = (".part", ".partial", ".tmp", ".temp", ".crdownload", ".filepart", ".swp", "~")
"""Endings that programs give to unfinished files."""
LITTER_S = 3600.0
LOOK_S = 1.0
"""Time between two looks at a watched inbox."""

OnResult = Callable[[Case, dict[str, Any]], None]
Do = Callable[[Sequence[Case], OnResult], None]
"""Runs cases and reports each as it ends, from one thread."""


class Taken(NamedTuple):
    """A report that this worker has claimed, with a private copy of its content."""

    entry: Entry
    claim: Claim
    case: Case


@dataclass
class Intake:
    """One worker's view of an inbox."""

    place: Place
    claims: Claims
    staging: Path
    settle_s: float = 10.0
    config: str = ""
    out: Path = Path("runs")
    counts: Counter[str] = field(default_factory=Counter)
    _seen: dict[str, tuple[tuple[Stamp, ...], float]] = field(default_factory=dict)
    _digests: dict[Entry, str] = field(default_factory=dict)

    def work(self, do: Do, portion: int, wait_s: float, watch_s: float = 0.0) -> dict[str, int]:
        """Take and run reports until none is left, or none could be taken for `wait_s`; counts by status.

        An empty inbox is watched for new reports until `watch_s` have passed.
        """
        self.place.sweep(LITTER_S, time.time())
        patience, watched = time.monotonic() + wait_s, time.monotonic() + watch_s
        with self.claims.beating():
            while True:
                self.move_unread()
                if taken := self.take(portion):
                    self._do(taken, do)
                    patience = time.monotonic() + wait_s
                elif time.monotonic() < watched:
                    time.sleep(LOOK_S)
                elif not any(_is_report(e) for e in self._waiting()) or time.monotonic() >= patience:
                    self.claims.drop_dead(lambda digest: self._outcome(digest) is not None)
                    return self._counts_now()
                else:
                    time.sleep(min(1.0, max(wait_s, 0.05)))

    def _counts_now(self) -> dict[str, int]:
        left = self._waiting()
        more = {"left": sum(_is_report(e) for e in left), "no_report": sum(not _is_report(e) for e in left)}
        return dict(self.counts) | {name: count for name, count in more.items() if count}

    def _do(self, taken: list[Taken], do: Do) -> None:
        mine = {t.case.id: t for t in taken}
        try:
            do([t.case for t in taken], lambda case, result: self.hand_in(mine.pop(case.id), result))
        finally:
            for rest in mine.values():
                self.claims.release(rest.claim)
                _unstage(rest)

    def move_unread(self) -> None:
        """Move files that no reader takes to `unread`, with the reason in outcome.json."""
        for entry in self._waiting():
            if _is_report(entry) or entry.name.lower().endswith(UNFINISHED) or not self._is_settled(entry):
                continue
            suffix = PurePosixPath(entry.name).suffix or "no suffix"
            reason = (
                f"{entry.name} cannot be read ({suffix}): give {', '.join(sorted(SUFFIXES))}, or a folder with "
                "report.txt and a diagram; a .docx or an e-mail is saved as .txt or .pdf first"
            )
            outcome = {
                "status": UNREAD,
                "reason": reason,
                "missing": [],
                "case": safe_id(entry.name),
                "name": entry.name,
            }
            if self._move_with_outcome(entry, outcome):
                self.counts[UNREAD] += 1

    # ------------------------------------------------------------------ taking
    def take(self, count: int) -> list[Taken]:
        """Claim up to `count` ready reports; a content finished before is moved to its former folder."""
        taken: list[Taken] = []
        for entry in self._ready():
            if len(taken) >= count:
                break
            if got := self._take(entry, alone=not taken):
                taken.append(got)
                if got.claim.number >= ALONE_FROM:
                    break
        return taken

    def _waiting(self) -> list[Entry]:
        """All entries but result folders and entries being moved away; listed before the moves are read."""
        entries = [e for e in self.place.entries() if e.name not in FOLDERS.values()]
        leaving = self.place.leaving()
        return [e for e in entries if e.name not in leaving]

    def _ready(self) -> Iterator[Entry]:
        return (entry for entry in self._waiting() if _is_report(entry) and self._is_settled(entry))

    def _is_settled(self, entry: Entry) -> bool:
        """Whether it was unchanged for long enough, by its dates or, where clocks differ, by this process's clock."""
        if not entry.files or any(f.name.lower().endswith(UNFINISHED) for f in entry.files):
            return False
        if time.time() - entry.newest >= self.settle_s:
            return True
        files, since = self._seen.get(entry.name, ((), 0.0))
        if files != entry.files:
            self._seen[entry.name] = (entry.files, time.monotonic())
            return False
        return time.monotonic() - since >= self.settle_s

    def _take(self, entry: Entry, alone: bool) -> Taken | None:
        content = None if entry in self._digests else self._content(entry)
        digest = self._digests.get(entry) or (_digest(entry, content) if content is not None else "")
        if not digest:
            return None  # another worker has moved it meanwhile
        self._digests[entry] = digest
        if self._known(entry, digest) or (claim := self.claims.take(digest, alone)) is None:
            return None
        content = self._content(entry)
        changed = self.place.entry(entry.name) != entry or content is None or _digest(entry, content) != digest
        if changed or self._known(entry, digest):
            self.claims.release(claim)
            return None
        taken = Taken(entry, claim, _stage(entry, content or {}, digest, self.staging))
        return taken if self._may_be_tried(taken) else None

    def _may_be_tried(self, taken: Taken) -> bool:
        """Whether few enough workers died with it; otherwise it is moved to `failed`."""
        if taken.claim.number <= MAX_TAKES:
            return True
        reason = (
            f"{MAX_TAKES} workers died while they had this report: see their logs; put it into the inbox again to retry"
        )
        self.hand_in(taken, {"status": "failed", "reason": reason, "missing": []})
        return False

    def _content(self, entry: Entry) -> dict[str, bytes] | None:
        found: dict[str, bytes] = {}
        for file in entry.files:
            content = self.place.read(f"{entry.name}/{file.name}" if file.name else entry.name)
            if content is None:
                return None
            found[file.name] = content
        return found

    # ------------------------------------------------------------------ handing in
    def _known(self, entry: Entry, digest: str) -> bool:
        """Whether this content is finished; its report is then moved to its folder."""
        if (outcome := self._outcome(digest)) is None:
            return False
        if self._move_with_outcome(entry, outcome):
            self.counts["again"] += 1
        return True

    def _outcome(self, digest: str) -> dict[str, Any] | None:
        written = self.place.read(f"{LEDGER}/{digest}.json")
        outcome: dict[str, Any] | None = json.loads(written) if written else None
        return outcome

    def hand_in(self, taken: Taken, result: dict[str, Any]) -> None:
        """Record a case's ending and move its report, unless another worker has taken it over."""
        _unstage(taken)
        if not self.claims.is_mine(taken.claim):
            self.claims.stop_renewing(taken.claim)
            self.counts["taken_over"] += 1
            return
        outcome = {key: result.get(key) for key in ("status", "reason", "missing")} | {"account": _account(result)}
        outcome |= {
            "case": taken.case.id,
            "config": self.config,
            "digest": taken.claim.digest,
            "name": taken.entry.name,
            "result": self._result_of(taken.case, result),
        }
        if outcome["status"] != "failed":  # a failed one may be dropped again
            self.place.create(f"{LEDGER}/{taken.claim.digest}.json", _json(outcome))
            outcome = self._outcome(taken.claim.digest) or outcome
        self._move_with_outcome(taken.entry, outcome)
        self.claims.release(taken.claim)
        self.counts[str(outcome["status"])] += 1

    def _result_of(self, case: Case, result: dict[str, Any]) -> str | None:
        """The folder of a case's results; None if none was written."""
        config = result.get("config")
        return str(self.out.resolve() / str(config) / case.id) if config else None

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
    account = counts_of(result)
    if account is None:
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
    """Copy a report into this worker's staging folder. The case's name is made of the report's name and digest."""
    stem = entry.name if entry.is_folder else PurePosixPath(entry.name).stem
    name = safe_id(f"{safe_id(stem)[:80]}-{digest[:12]}")
    source = staging / name / (name if entry.is_folder else f"{name}{PurePosixPath(entry.name).suffix.lower()}")
    for inner, data in content.items():
        file = source / inner if inner else source
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_bytes(data)
    return Case(source, name)


def _unstage(taken: Taken) -> None:
    folder = taken.case.source.parent
    with suppress(FileNotFoundError):
        shutil.rmtree(folder)


def _json(content: dict[str, Any]) -> bytes:
    return (json.dumps(content, indent=1, ensure_ascii=False) + "\n").encode()
