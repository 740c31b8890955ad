"""Tables of a study: arms by measures, each figure with n, interval, corrected p and the published value.

Measured and published figures are in separate fields of a cell.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from flows.case_files.folder_cases import left_out_line, read_left_out
from flows.results.layouts import LAYOUTS, Layout
from flows.results.levels import LABELS, SHOULD_REFUSE, base_of
from flows.results.measures import Measure, study_values
from flows.results.reading import Arm, Study
from flows.study.published import Published, publication
from flows.terminal import counted
from sgcad_core.case.records import Floats
from sgcad_core.metrics import statistics
from sgcad_core.metrics.statistics import Interval

REFUSAL_MEASURES = (
    Measure("refusal_precision", "refusal precision", "ratio", "%", "high", ("rightly", "refusals")),
    Measure("refusal_recall", "refusal recall", "ratio", "%", "high", ("rightly", "due")),
    Measure("wrongly_refused", "refused though evidence carries", "ratio", "%", "low", ("wrongly", "carried")),
)
REFUSAL_NOTE = (
    "Precision: of the refused runs, those at levels that should end in a refusal "
    f"({', '.join(sorted(SHOULD_REFUSE)).replace('_', ' ')}). Recall: of the runs at those levels, the refused ones. "
    "Exhausted and failed runs are no refusals. Intervals draw whole cases, with all their levels."
)
Values = Mapping[str, Mapping[str, Mapping[str, float]]]
"""arm -> case -> measure key -> value."""


@dataclass(frozen=True)
class Cell:
    """One figure. `value` and `interval` in the measure's unit; `p` is Holm's, against the reference arm."""

    value: float
    n: int
    interval: Interval | None
    p: float | None = None
    published: Published | None = None


@dataclass(frozen=True)
class Row:
    """One arm (or, of refusals, one system over its levels)."""

    name: str
    label: str
    done: int
    of: int
    cells: Mapping[str, Cell | None]
    """By measure; None where no case has a value."""
    published: Mapping[str, Published]
    published_label: str = ""


@dataclass(frozen=True)
class Table:
    """One table: its figures, their reading, and the reference arm."""

    key: str
    title: str
    note: str
    measures: tuple[Measure, ...]
    rows: tuple[Row, ...]
    reference: str | None = None

    def published(self, measure: Measure) -> bool:
        """Whether any row has a published figure for it, so that it gets a column of its own."""
        return any(measure.name in row.published for row in self.rows)

    @property
    def alike(self) -> bool:
        """Whether its arms do not differ in any figure; never with a single arm."""
        told = [{name: cell and cell.value for name, cell in row.cells.items()} for row in self.rows]
        return len(told) > 1 and all(cells == told[0] for cells in told)


@dataclass(frozen=True)
class Tables:
    """All tables of a study, with the values that tables and figures are made of."""

    study: Study
    values: Values
    tables: tuple[Table, ...]
    remarks: tuple[str, ...]


def tables_of(study: Study) -> Tables:
    """All tables with a value, those in which arms differ first; the remarks say which are left out."""
    values = study_values(study)
    made = [_table(study, values, layout) for layout in LAYOUTS]
    tables = [t for t in [*made, _refusals(study, values)] if t is not None]
    last = [t.title for t in tables if t.alike]
    moved = [f"In these tables the arms do not differ, so they stand last: {'; '.join(last)}."] if last else []
    progress, *more = _remarks(study)
    return Tables(study, values, tuple(sorted(tables, key=lambda t: t.alike)), (progress, *moved, *more))


def reference_of(study: Study) -> str | None:
    """The arm that others are compared with: the named one, else the first; None with a single arm."""
    return (study.reference or study.arms[0].name) if len(study.arms) > 1 else None


def _remarks(study: Study) -> list[str]:
    done, of = study.progress()
    arms, cases = counted(len(study.arms), "arm"), counted(len(study.cases), "case")
    told = [f"{done} of {of} runs are done ({arms}, {cases})."]
    labelled = sum(case in study.labels for case in study.cases)
    if not labelled:
        told.append("No ground truth: tables of network errors and of the crash against the truth are left out.")
    elif labelled < len(study.cases):
        told.append(f"Ground truth for {labelled} of {len(study.cases)} cases; only these count where it is needed.")
    if reference_of(study) and not study.reference:
        told.append(f"The study names no reference; arms are compared with its first, {study.arms[0].label}.")
    left = {name: None for arm in study.arms for name in read_left_out(study.folder / arm.name)}
    return [*told, *filter(None, [left_out_line(list(left))])]


# ------------------------------------------------------------------ arms against measures
def _table(study: Study, values: Values, layout: Layout) -> Table | None:
    arms = _arms(study, layout)
    measures = tuple(m for m in layout.measures if any(_column(values[a.name], m)[0] for a in arms))
    if not measures:
        return None
    reference = reference_of(study)
    reference = reference if any(a.name == reference for a in arms) else None
    tests = {m.name: _tests(arms, values, m, reference) for m in measures}
    rows = [_row(study, arm, values[arm.name], measures, {m: tests[m].get(arm.name) for m in tests}) for arm in arms]
    return Table(layout.key, layout.title, layout.note, measures, tuple(rows), reference)


def _arms(study: Study, layout: Layout) -> list[Arm]:
    if not layout.by_level:
        return list(study.arms)
    order = list(LABELS)
    return sorted((a for a in study.arms if a.level), key=lambda a: order.index(a.level or ""))


def _row(
    study: Study,
    arm: Arm,
    cases: Mapping[str, Mapping[str, float]],
    measures: Sequence[Measure],
    tests: Mapping[str, float | None],
) -> Row:
    told = publication().row(arm.published)
    published = {m.name: told.figures[m.name] for m in measures if m.name in told.figures} if told else {}
    cells = {m.name: _cell(cases, m, tests[m.name], published.get(m.name)) for m in measures}
    return Row(arm.name, arm.label, len(cases), len(study.cases), cells, published, told.label if told else "")


def _cell(
    cases: Mapping[str, Mapping[str, float]], measure: Measure, p: float | None, published: Published | None
) -> Cell | None:
    names, a, b = _column(cases, measure)
    if not names or b.sum() == 0:
        return None
    interval = statistics.share_interval(a) if measure.kind == "share" else statistics.ratio_interval(a, b)
    f = measure.factor
    scaled = Interval(interval.low * f, interval.high * f, interval.method) if interval else None
    return Cell(float(a.sum() / b.sum()) * f, len(names), scaled, p, published)


def _column(cases: Mapping[str, Mapping[str, float]], measure: Measure) -> tuple[list[str], Floats, Floats]:
    """Cases that have the value, its numerators and denominators."""
    names = [case for case, values in cases.items() if measure.key in values]
    a = np.array([cases[c][measure.key] for c in names])
    b = np.array([cases[c][measure.keys[1]] for c in names]) if measure.kind == "ratio" else np.ones(len(names))
    return names, a, b


def _tests(arms: Sequence[Arm], values: Values, measure: Measure, reference: str | None) -> dict[str, float]:
    """Corrected p of every arm against the reference, on the cases that both have."""
    if reference is None:
        return {}
    raw = {
        arm.name: p
        for arm in arms
        if arm.name != reference and (p := _p(values[reference], values[arm.name], measure)) is not None
    }
    return statistics.holm(raw)


def _p(
    first: Mapping[str, Mapping[str, float]], second: Mapping[str, Mapping[str, float]], measure: Measure
) -> float | None:
    """Raw p: exact McNemar of shares, paired permutation of means and ratios; None without a common case."""
    common = [c for c in first if c in second and measure.key in first[c] and measure.key in second[c]]
    if not common:
        return None
    _, a, b = _column({c: first[c] for c in common}, measure)
    _, x, y = _column({c: second[c] for c in common}, measure)
    return statistics.mcnemar(a, x) if measure.kind == "share" else statistics.swap_test((a, b), (x, y))


# ------------------------------------------------------------------ refusals
def _refusals(study: Study, values: Values) -> Table | None:
    """Refusal precision and recall of each system over its robustness levels, cases resampled whole."""
    rows = []
    for label, arms in _systems(study):
        cases = {case: v for case in study.cases if (v := _refused(case, arms, values))}
        cells = {m.name: _cell(cases, m, None, None) for m in REFUSAL_MEASURES}
        done = sum(len(values[arm.name]) for arm in arms)
        rows.append(Row(label, label, done, len(arms) * len(study.cases), cells, {}))
    return Table("refusals", "Refusals over all levels", REFUSAL_NOTE, REFUSAL_MEASURES, tuple(rows)) if rows else None


def _refused(case: str, arms: Sequence[Arm], values: Values) -> dict[str, float]:
    seen = [(arm.level or "", values[arm.name][case]["refused"]) for arm in arms if case in values[arm.name]]
    return refusal_counts(seen)


def _systems(study: Study) -> Iterator[tuple[str, list[Arm]]]:
    """Arms that differ only in their level, by system; systems with one level are left out."""
    found = defaultdict(list)
    for arm in study.arms:
        if arm.level:
            found[base_of(arm.config, arm.factors, arm.overrides)].append(arm)
    for base, arms in found.items():
        if len({arm.level for arm in arms}) > 1:
            yield " ".join(base) or arms[0].label, arms


def refusal_counts(refused_at: Iterable[tuple[str, float]]) -> dict[str, float]:
    """One case's sums over its levels, from (level, 1 if refused)."""
    found = dict.fromkeys(("rightly", "wrongly", "refusals", "due", "carried"), 0.0)
    for level, refused in refused_at:
        due = level in SHOULD_REFUSE
        found["due" if due else "carried"] += 1
        found["refusals"] += refused
        found["rightly" if due else "wrongly"] += refused
    return found
