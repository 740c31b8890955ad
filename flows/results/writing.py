"""Tables as text for a terminal, as CSV with one figure per line, and as LaTeX with booktabs.

Published figures have columns of their own in all three.
"""

from __future__ import annotations

import csv
import io
from collections.abc import Iterator, Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Console
from rich.table import Table as Grid

from flows.results.measures import Measure
from flows.results.table import Cell, Row, Table, Tables
from flows.study.published import publication
from flows.terminal import escape

SIGNIFICANT = 0.05
COLUMN = 16
"""Characters that a column of figures takes in a terminal, at least."""
HOW = (
    "Brackets: 95 % interval, cases resampled (BCa bootstrap; of a share on which all cases agree exact binomial; of "
    "anything else on which they agree none). n: cases. p: paired test against the reference arm on the cases both "
    "have (exact McNemar of shares, permutation of means), Holm-corrected over the arms."
)
FIELDS = (
    "table", "arm", "label", "done", "of", "measure", "unit", "value", "low", "high", "interval", "n", "p_holm",
    "reference", "published", "published_table", "published_label",
)  # fmt: skip


def number(value: float, measure: Measure) -> str:
    """A figure with the measure's digits."""
    return f"{value:.{measure.digits}f}"


def bracket(cell: Cell, measure: Measure) -> str:
    """[low, high]; empty without an interval, as for cases that are all alike."""
    if cell.interval is None or cell.interval.low == cell.interval.high:
        return ""
    return f"[{number(cell.interval.low, measure)}, {number(cell.interval.high, measure)}]"


def p_text(p: float) -> str:
    """A p value to print; never 0."""
    return "p<0.001" if p < 0.001 else f"p={p:.3f}" if p < 0.1 else f"p={p:.2f}"


def header(measure: Measure) -> str:
    """Label and unit."""
    return f"{measure.label} ({measure.unit})" if measure.unit else measure.label


# ------------------------------------------------------------------ text
def show(tables: Tables, console: Console) -> None:
    """Print every table with its note, split to the terminal's width."""
    console.print(f"[bold]{escape(tables.study.title)}[/]")
    for remark in tables.remarks:
        console.print(escape(remark))
    for table in tables.tables:
        console.print(f"\n[bold]{escape(table.title)}[/]")
        console.print(escape(table.note))
        for measures in _pieces(table, console.width):
            console.print(_grid(table, measures))
    console.print(escape(HOW))
    if any(table.published(m) for table in tables.tables for m in table.measures):
        console.print(escape(f"Published: {publication().source}."))


def _pieces(table: Table, width: int) -> Iterator[Sequence[Measure]]:
    """Groups of measures that fit side by side into a width."""
    left = width - max((len(row.label) for row in table.rows), default=0) - 12
    taken: list[Measure] = []
    used = 0
    for measure in table.measures:
        wide = max(COLUMN, len(header(measure))) + 2 + (len(measure.label) + 11) * table.published(measure)
        if taken and used + wide > left:
            yield taken
            taken, used = [], 0
        taken.append(measure)
        used += wide
    yield taken


def _grid(table: Table, measures: Sequence[Measure]) -> Grid:
    grid = Grid(box=SIMPLE_HEAD, pad_edge=False, padding=(0, 2, 0, 0))
    grid.add_column("arm")
    grid.add_column("done", justify="right", no_wrap=True)
    for measure in measures:
        grid.add_column(escape(header(measure)), justify="right", no_wrap=True)
        if table.published(measure):
            grid.add_column(f"{escape(measure.label)}\npublished", justify="right", style="italic", no_wrap=True)
    for row in table.rows:
        cells = [piece for m in measures for piece in _texts(table, row, m)]
        name = escape(row.label) + ("\n(reference)" if row.name == table.reference else "")
        grid.add_row(name, f"{row.done}/{row.of}", *cells)
    return grid


def _texts(table: Table, row: Row, measure: Measure) -> Iterator[str]:
    cell = row.cells.get(measure.name)
    yield escape(_lines(cell, measure)) if cell else "-"
    if table.published(measure):
        told = row.published.get(measure.name)
        yield f"{told.value:g}\nTable {told.table}" if told else ""


def _lines(cell: Cell, measure: Measure) -> str:
    under = f"n={cell.n}" + (f" {p_text(cell.p)}" if cell.p is not None else "")
    return "\n".join((number(cell.value, measure), bracket(cell, measure), under))


# ------------------------------------------------------------------ CSV
def as_csv(tables: Tables) -> str:
    """One line a figure; full precision, so that tables from two machines can be compared to the digit."""
    out = io.StringIO()
    writer = csv.DictWriter(out, FIELDS, lineterminator="\n")
    writer.writeheader()
    for table in tables.tables:
        for row in table.rows:
            for measure in table.measures:
                writer.writerow({key: _no_formula(value) for key, value in _record(table, row, measure).items()})
    return out.getvalue()


def _no_formula(value: object) -> object:
    """A text that a spreadsheet would compute, escaped by an apostrophe."""
    return f"'{value}" if isinstance(value, str) and value.startswith(("=", "+", "-", "@", "\t", "\r")) else value


def _record(table: Table, row: Row, measure: Measure) -> dict[str, object]:
    cell, told = row.cells.get(measure.name), row.published.get(measure.name)
    record: dict[str, object] = {
        "table": table.key, "arm": row.name, "label": row.label, "done": row.done, "of": row.of,
        "measure": measure.name, "unit": measure.unit, "reference": table.reference or "",
    }  # fmt: skip
    if cell:
        record |= {"value": cell.value, "n": cell.n, "p_holm": "" if cell.p is None else cell.p}
        if cell.interval:
            record |= {"low": cell.interval.low, "high": cell.interval.high, "interval": cell.interval.method}
    if told:
        record |= {"published": told.value, "published_table": told.table, "published_label": row.published_label}
    return record


# ------------------------------------------------------------------ LaTeX
def as_latex(tables: Tables) -> str:
    """One table environment a table; needs booktabs."""
    return "\n".join([r"% needs \usepackage{booktabs}", *(_latex(tables, table) for table in tables.tables)])


def _latex(tables: Tables, table: Table) -> str:
    columns = [m for m in table.measures for _ in range(1 + table.published(m))]
    heads = []
    for m in table.measures:
        heads.append(_tex(header(m)))
        heads += [r"\emph{published}"] if table.published(m) else []
    body = [" & ".join([_tex(row.label), *_tex_cells(table, row)]) + r" \\" for row in table.rows]
    done, of = tables.study.progress()
    caption = f"{table.title}. {table.note} {_how(table)} {done} of {of} runs done."
    return "\n".join([
        r"\begin{table}[ht]", r"\centering", r"\footnotesize", rf"\caption{{{_tex(caption)}}}",
        rf"\label{{tab:{tables.study.name}_{table.key}}}", rf"\begin{{tabular}}{{l{'c' * len(columns)}}}", r"\toprule",
        " & ".join(["Arm", *heads]) + r" \\", r"\midrule", *body, r"\bottomrule", r"\end{tabular}", r"\end{table}", "",
    ])  # fmt: skip


def _how(table: Table) -> str:
    told = "Brackets: 95 % bootstrap interval over cases; subscript: n."
    return told + (f" Asterisk: p < 0.05 against {table.reference}, paired, Holm." if table.reference else "")


def _tex_cells(table: Table, row: Row) -> Iterator[str]:
    for measure in table.measures:
        cell, told = row.cells.get(measure.name), row.published.get(measure.name)
        if cell:
            star = "^{*}" if cell.p is not None and cell.p < SIGNIFICANT else ""
            yield rf"${number(cell.value, measure)}{star}_{{{cell.n}}}$ {{\scriptsize {bracket(cell, measure)}}}"
        else:
            yield "--"
        if table.published(measure):
            yield rf"\emph{{{told.value:g}}}" if told else ""


def _tex(text: str) -> str:
    """Text safe for LaTeX."""
    special = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}", "<": "$<$", ">": "$>$"}
    special |= {c: rf"\{c}" for c in "&%$#_{}"} | {"`": ""}
    return "".join(special.get(c, c) for c in text)
