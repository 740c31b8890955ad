"""Summary of a batch on stdout: a table, reasons, paths; of a single case also its contact and account."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table
from rich.text import Text

from flows.batch import second_simulator
from flows.batch.plan_batch import Batch, Job
from flows.case import case_in_words
from flows.case.run_case import Ending
from flows.case_files.case_folder import CaseFolder
from flows.case_files.folder_cases import left_out_line
from flows.terminal import escape
from sgcad_core.result import STATUSES, as_declared, counts_of

MAX_REASONS = 10
"""Reasons printed at the end; all of them stand in the result.json files."""

TABLE_WIDTH = 104
"""Columns without a terminal; rich would take 80 and drop a column."""


FEW = 10
"""Up to this number of endings whole results are kept; a result takes about 50 kB of memory."""
_KEPT = ("case", "status", "reason", "seconds", "judge", "person", "near_crash")


@dataclass
class Tally:
    """Endings of a batch, counted config by config."""

    batch: Batch
    endings: list[tuple[Job, Ending]] = field(default_factory=list)
    untracked: list[str] = field(default_factory=list)
    statuses: Counter[str] = field(default_factory=Counter)

    def add(self, job: Job, ending: Ending, untracked: str = "") -> None:
        """Count one ending."""
        whole = len(self.batch.configs) * len(self.batch.cases) <= FEW
        self.endings.append((job, Ending(ending.result if whole else _brief(ending.result), reused=ending.reused)))
        self.statuses[ending.result["status"]] += 1
        if untracked:
            self.untracked.append(f"{job.name}: {untracked}")

    def exit_code(self) -> int:
        """1 if a case failed or was exhausted, else 0."""
        return int(self.statuses["failed"] + self.statuses["exhausted"] > 0)

    def in_words(self) -> str:
        """Counts of the statuses so far, in words."""
        return ", ".join(f"{self.statuses[status]} {status}" for status in STATUSES if self.statuses[status])

    def of(self, config: str) -> list[Ending]:
        """Endings of one config."""
        return [ending for job, ending in self.endings if job.config.name == config]

    def first_player(self) -> str | None:
        """Path of the first player.html, in the order of the cases."""
        batch = self.batch
        folders = (CaseFolder(batch.out, config.name, case.id) for config in batch.configs for case in batch.cases)
        pages = (folder.path / "player.html" for folder in folders)
        return next((str(page) for page in pages if page.is_file()), None)


def _brief(result: Mapping[str, Any]) -> dict[str, Any]:
    """The part of a result that the summary of a long batch needs."""
    found = {key: result[key] for key in _KEPT if key in result}
    if "collision" in result:
        found["collision"] = {key: result["collision"][key] for key in ("declared", "realised")}
    if account := result.get("account"):
        lacking = [item for item in account["items"] if item["kind"] == "lacks"]
        found["account"] = {**account, "items": lacking}
    found["disagreements"] = result.get("disagreements", ())
    return found | {"notes": [note for note in result.get("notes", ()) if note["kind"] == "limit"]}


def show(tally: Tally) -> None:
    """Print the table, the reasons and the paths of the results."""
    console = Console(emoji=False, highlight=False)
    console.width = max(console.width, TABLE_WIDTH)
    console.print(_table(tally))
    second_simulator.show(console, {c.name: [e.result for e in tally.of(c.name)] for c in tally.batch.configs})
    told = [*_accounts(tally), *_reasons(tally), *_limits(tally), *_people(tally)]
    if line := left_out_line(tally.batch.left):
        console.print(escape(line), soft_wrap=True)
    for line in [*told, *case_in_words.lines([ending.result for _, ending in tally.endings])]:
        console.print(escape(line), soft_wrap=True)
    console.print(escape(f"results: {tally.batch.out}"), soft_wrap=True)
    if page := tally.first_player():
        console.print(escape(f"look at: {page}"), soft_wrap=True)
    if tally.untracked:
        lost = f"{len(tally.untracked)} not logged; run the same command again to log them; {tally.untracked[0]}"
        console.print(escape(lost), soft_wrap=True)


def _table(tally: Tally) -> Table:
    table = Table(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 2, 0, 0))
    table.add_column("config", overflow="fold", min_width=12)
    for name in (*STATUSES, "as declared", "all told", "reused", "s/case"):
        table.add_column(name, justify="right", no_wrap=True)
    for config in tally.batch.configs:
        endings = tally.of(config.name)
        counts = [str(sum(e.result["status"] == status for e in endings)) for status in STATUSES]
        reused = sum(e.reused for e in endings)
        whole, seconds = _whole(endings), _seconds(endings)
        table.add_row(escape(config.name), *counts, _realised(endings), whole, str(reused), seconds)
    return table


def _whole(endings: list[Ending]) -> Text:
    """Number of scenarios that lack nothing told; green if that is all of them."""
    known = [account for e in endings if (account := counts_of(e.result))]
    whole = sum(account["verdict"] == "whole" for account in known)
    if not known:
        return Text("-")
    return Text(f"{whole}/{len(known)}", style="green" if whole == len(known) else "yellow")


def _accounts(tally: Tally) -> list[str]:
    """Sums of what the scenarios have and lack, and the first that lack something; empty for a single case."""
    known = [(job, account) for job, e in tally.endings if (account := counts_of(e.result))]
    if len(tally.endings) < 2 or not known:
        return []
    sums = {name: sum(account[name] for _, account in known) for name in ("told", "has", "lacking", "assumed")}
    lines = ["of {told} things told the scenarios have {has} and lack {lacking}; {assumed} are assumed".format(**sums)]
    lacking = [(job, account) for job, account in known if account["verdict"] == "lacking"]
    return lines + _first([f"{job.name}: lacks {case_in_words.lacking_in_words(a, 3)}" for job, a in lacking])


def _realised(endings: list[Ending]) -> str:
    """Number of executed cases whose declared contact or near crash was observed, of those that declare one."""
    declared = [hit for e in endings if (hit := as_declared(e.result)) is not None]
    return f"{sum(declared)}/{len(declared)}" if declared else "-"


def _seconds(endings: list[Ending]) -> str:
    spent = [sum(e.result["seconds"].values()) for e in endings]
    return f"{sum(spent) / len(spent):.2f}" if spent else "-"


def _limits(tally: Tally) -> list[str]:
    """The first notes on limits of the program; empty for a single case, whose notes are printed anyway."""
    if len(tally.endings) < 2:
        return []
    noted = ((job.name, note) for job, e in tally.endings for note in e.result["notes"])
    told = [f"{name}: {note['text']}" for name, note in noted if note["kind"] == "limit"]
    return _first(told)


def _people(tally: Tally) -> list[str]:
    """Number of facts given by people, and of those that were read differently."""
    said = [given for _, e in tally.endings if (given := e.result.get("person") or {}).get("facts")]
    if not said:
        return []
    facts, wrong = (sum(given[key] for given in said) for key in ("facts", "disagreed"))
    return [f"facts by people: {facts} in {len(said)} cases, {wrong} of them read otherwise (facts.yaml)"]


def _reasons(tally: Tally) -> list[str]:
    """The first reasons of cases that were not generated."""
    told = [
        f"{job.name}: {ending.result['status']}: {ending.result['reason']}"
        for job, ending in tally.endings
        if ending.result["status"] != "generated"
    ]
    return _first(told)


def _first(lines: list[str]) -> list[str]:
    """The first lines, shortened, and the number of the others."""
    more = [f"... and {len(lines) - MAX_REASONS} more"] if len(lines) > MAX_REASONS else []
    return [line[:400] for line in lines[:MAX_REASONS]] + more
