"""Outcomes of a study's drives by case, driver and role, and the card that shows them.

Outcomes come from metrics.json (`drive`), pages from the case's folder. Knows no driver.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path
from typing import NamedTuple
from urllib.parse import quote

from flows.results.reading import Arm, FinishedCase, Study
from sgcad_core.handover.outcome import OUTCOMES
from sgcad_core.kinds import CRASH_ROLES

ENDED = (*OUTCOMES, "failed")
NOTE = (
    "A line a case, those on which drivers differ most first; a column a driver and role. A avoided, M mitigated, "
    "U unchanged, W worse, L lost (the conflict never came about: no credit), F failed. A letter leads to the drive's "
    "page, script and drive one over the other. Outcomes are explained in docs/drivers.md."
)


class StudyDrive(NamedTuple):
    """One drive of a study; `ego`: the driven actor ("" in results of older versions)."""

    arm: str
    case: str
    driver: str
    role: str
    ego: str
    outcome: str
    folder: Path

    @property
    def column(self) -> tuple[str, str, str]:
        """Its column in the table: arm, driver, role."""
        return self.arm, self.driver, self.role


def drives_of(study: Study) -> list[StudyDrive]:
    """Every drive that the study's cases have, in the order of arms and cases."""
    return [d for arm in study.arms for ran in study.ran[arm.name].values() for d in _of(ran)]


def _of(ran: FinishedCase) -> Iterator[StudyDrive]:
    for driver, roles in (ran.metrics.get("drive") or {}).items():
        for role, told in roles.items():
            outcome = next((o for o in ENDED if told.get(o)), "")
            if outcome:
                ego = str(told.get("ego") or "")
                yield StudyDrive(ran.arm, ran.case, driver, role, ego, outcome, ran.folder / "drive" / driver / ego)


def columns_of(drives: Sequence[StudyDrive]) -> list[tuple[str, str, str]]:
    """(arm, driver, role) in the order of roles, then of arms."""
    found = dict.fromkeys(d.column for d in drives)
    return sorted(found, key=lambda c: CRASH_ROLES.index(c[2]) if c[2] in CRASH_ROLES else len(CRASH_ROLES))


def by_difference(drives: Sequence[StudyDrive]) -> list[str]:
    """Cases, those with most different outcomes within a role first."""
    seen: dict[str, dict[str, set[str]]] = {}
    for d in drives:
        seen.setdefault(d.case, {}).setdefault(d.role, set()).add(d.outcome)
    return sorted(seen, key=lambda case: -sum(len(outcomes) - 1 for outcomes in seen[case].values()))


# ------------------------------------------------------------------ the card
def card(study: Study, place: Path) -> str:
    """The table as HTML; "" where nothing was handed over. `place`: the page, for links to drives."""
    drives = drives_of(study)
    if not drives:
        return ""
    columns = columns_of(drives)
    at = {(d.case, *d.column): d for d in drives}
    rows = "\n".join(_row(case, [at.get((case, *c)) for c in columns], place) for case in by_difference(drives))
    return (
        '<section class="card" id="drives"><h3>Outcomes by driver</h3>'
        f'<p class="note">{escape(NOTE)}</p><div class="scroll drives"><table><thead>{_head(study, columns)}'
        f"{_sums(drives, columns)}</thead><tbody>{rows}</tbody></table></div></section>"
    )


def _head(study: Study, columns: Sequence[tuple[str, str, str]]) -> str:
    labels = {arm.name: arm for arm in study.arms}
    cells = "".join(
        f"<th>{escape(_named(labels[arm], driver))}<small>{role}</small></th>" for arm, driver, role in columns
    )
    return f"<tr><th>case</th>{cells}</tr>"


def _named(arm: Arm, driver: str) -> str:
    """An arm has one driver as a rule: its label says which."""
    return arm.label if arm.label != arm.name or driver == arm.name else f"{arm.name}: {driver}"


def _sums(drives: Sequence[StudyDrive], columns: Sequence[tuple[str, str, str]]) -> str:
    cells = []
    for column in columns:
        mine = [d.outcome for d in drives if d.column == column]
        counts = ", ".join(f"{mine.count(o)} {o}" for o in ENDED if o in mine)
        cells.append(f'<th title="{counts}">{mine.count("avoided")} of {len(mine)}<small>avoided</small></th>')
    return f"<tr><th>all</th>{''.join(cells)}</tr>"


def _row(case: str, drives: Sequence[StudyDrive | None], place: Path) -> str:
    return f'<tr><th scope="row">{escape(case)}</th>{"".join(_cell(d, place) for d in drives)}</tr>'


def _cell(drive: StudyDrive | None, place: Path) -> str:
    if drive is None:
        return '<td class="none">–</td>'
    letter, page = drive.outcome[0].upper(), drive.folder / "drive.html"
    words = escape(f"{drive.driver} drives {drive.ego or 'the'} {drive.role}: {drive.outcome}")
    if drive.ego and page.is_file():
        letter = f'<a href="{quote(os.path.relpath(page, place.parent))}">{letter}</a>'
    return f'<td class="o {drive.outcome}" title="{words}">{letter}</td>'
