"""The readings of a report that are tried as wholes: all readers, the rules with the learned one, the rules alone.

Field by field the surer reader is taken (sgcad_core/reading/second_reader); whether the values go together shows only
in the scenario. So where that lacks something, the other readings are tried too, and the one whose scenario has most of
what is told is kept. A case that a person mends holds to the reading that was kept before. Knows reports and accounts;
no steps.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Literal

from sgcad_core.account import Account, is_unsure
from sgcad_core.case.records import CrashReport

ReadBy = Literal["all", "learned", "rules"]
"""Readers of a reading: all of them, the rules with the learned one, the rules alone."""
_CALLED: dict[ReadBy, str] = {
    "learned": "the reading of the rules and the learned reader",
    "rules": "the rules' reading",
}
_MANY = 3
"""Vehicles of a crash of which other readings are tried at most."""


def has_others(report: CrashReport) -> bool:
    """Whether a second reader changed something; not of a crash of many vehicles, whose search takes long."""
    if report.opinion is None or len(report.reading.crash.vehicles) > _MANY:
        return False
    return any(fact.basis == "model" for fact in report.reading.facts)


def read_by(report: CrashReport, readers: ReadBy) -> CrashReport:
    """The report as so many of its readers have it."""
    opinion = report.opinion
    if opinion is None or readers == "all":
        return report
    if not opinion.guesses:
        return report.model_copy(update={"opinion": None})
    fewer = {"answered": None} if readers == "learned" else {"taken": False}
    return report.model_copy(update={"opinion": opinion.model_copy(update=fewer)})


def other_readings(report: CrashReport) -> Iterator[tuple[ReadBy, CrashReport]]:
    """(readers, report) of each other reading of a report with a second reader's opinion; none twice."""
    seen = [report.reading.facts]
    learned = report.opinion is not None and report.opinion.guesses
    others: tuple[ReadBy, ...] = ("learned", "rules") if learned else ("rules",)
    for readers in others:
        other = read_by(report, readers)
        if other.reading.facts not in seen:
            seen.append(other.reading.facts)
            yield readers, other


def missed(account: Account) -> float:
    """The number of things that keep a scenario from being right as far as told; infinite where there is none. Values
    that were read and are unsure do not count: another reading is no remedy for words that mean two things."""
    if account.verdict == "none":
        return float("inf")
    some = (item for item in account.items if not is_unsure(item))
    return float(sum(item.kind in ("lacks", "contradicts", "guessed") for item in some))


def note_of(readers: ReadBy, kept: Account, before: Account) -> str:
    """The remark that another reading than the fused one was kept."""
    was = "came to no scenario" if before.verdict == "none" else f"misses {missed(before):.0f}"
    return (
        f"{_CALLED[readers]} is kept: its scenario misses {missed(kept):.0f} of what is told, that of all readers {was}"
    )
