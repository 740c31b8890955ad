"""One HTML file per study: tables, figures and the case gallery; it needs no network and no server.

Put together from report.html, report.css and report.js. Cases are in a JSON block and reach the page as text, never as
markup, so a narrative cannot become code; text in markup is escaped here.
"""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Sequence
from functools import cache
from html import escape
from pathlib import Path

from flows.results.measures import Measure
from flows.results.report.drive_cards import card
from flows.results.report.gallery import gallery
from flows.results.report.plots import Plot
from flows.results.table import Cell, Row, Table, Tables
from flows.results.writing import HOW, SIGNIFICANT, bracket, header, number, p_text
from flows.study.published import publication
from flows.terminal import counted
from sgcad_core.result import counts_of

HERE = Path(__file__).parent
SLOT = re.compile(r"%TITLE%|%LEAD%|%TABLES%|%FIGURES%|%DATA%|/\*STYLE\*/|/\*SCRIPT\*/")


def page(tables: Tables, plots: Sequence[Plot], place: Path) -> str:
    """The whole page as text. `place`: its path, for links to players."""
    data = json.dumps(gallery(tables, place), ensure_ascii=False, separators=(",", ":"))
    parts = {
        "%TITLE%": escape(tables.study.title),
        "%LEAD%": _lead(tables),
        "%TABLES%": "\n".join(map(_table, tables.tables)) + _how(tables) + card(tables.study, place),
        "%FIGURES%": "\n".join(map(_figure, plots)),
        "/*STYLE*/": _part("report.css"),
        "/*SCRIPT*/": _part("report.js"),
        "%DATA%": data.replace("<", "\\u003c"),
    }
    return SLOT.sub(lambda slot: parts[slot[0]], _part("report.html"))  # in one pass: contents hold no slots


@cache
def _part(name: str) -> str:
    return (HERE / name).read_text(encoding="utf-8")


def _lead(tables: Tables) -> str:
    """Progress, remarks, and where the runs come from."""
    study, about = tables.study, tables.study.about
    done, of = study.progress()
    known = [("version", about.get("package")), ("commit", str(about.get("git_commit") or "")[:10])]
    known += [("cases digest", str(about.get("dataset_digest") or "")[:12])]
    known += [(str(k), v) for k, v in (about.get("hardware") or {}).items() if isinstance(v, str | int | float)]
    facts = " · ".join(f"{escape(str(k))} {escape(str(v))}" for k, v in known if v)
    share = 100 * done / of if of else 0
    bar = f'<div class="progress" title="{done} of {of} runs"><i style="width:{share:.1f}%"></i></div>'
    return (
        _accounts(tables)
        + bar
        + "".join(f"<p>{escape(r)}</p>" for r in tables.remarks)
        + f'<p class="facts">{facts}</p>'
    )


def _accounts(tables: Tables) -> str:
    """Per arm the number of scenarios that lack nothing told: the first lines of the page."""
    told = []
    for arm in tables.study.arms:
        known = [a for ran in tables.study.ran.get(arm.name, {}).values() if (a := counts_of(ran.result))]
        if known:
            whole, lacking = sum(a["verdict"] == "whole" for a in known), sum(a["lacking"] for a in known)
            good = whole == len(known)
            are = "is" if lacking == 1 else "are"
            words = "nothing told is lacking" if good else f"{counted(lacking, 'thing')} told {are} lacking"
            told.append(
                f'<p class="account {"good" if good else "amber"}">{"✓" if good else "⚠"} {escape(arm.label)}: '
                f"{words}; {whole} of {len(known)} scenarios have all that their report tells, "
                f"{sum(a['assumed'] for a in known)} things are assumed</p>"
            )
    return "".join(told)


# ------------------------------------------------------------------ tables
def _table(table: Table) -> str:
    heads = ["<th>arm</th>"]
    for m in table.measures:
        heads.append(f"<th>{escape(header(m))}</th>")
        if table.published(m):
            heads.append(f'<th class="pub">{escape(m.label)}<small>published</small></th>')
    rows = "\n".join(_row(table, row) for row in table.rows)
    return (
        f'<section class="card" id="table-{escape(table.key)}"><h3>{_code(table.title)}</h3>'
        f'<p class="note">{_code(table.note)}</p><div class="scroll"><table><thead><tr>{"".join(heads)}</tr></thead>'
        f"<tbody>{rows}</tbody></table></div></section>"
    )


def _row(table: Table, row: Row) -> str:
    mark = '<span class="ref">reference</span>' if row.name == table.reference else ""
    done = "" if row.done == row.of else f"<small>{row.done} of {row.of} done</small>"
    cells = [f'<th scope="row">{escape(row.label)} {mark}{done}</th>']
    for m in table.measures:
        cells.append(_cell(row.cells.get(m.name), m))
        if table.published(m):
            told = row.published.get(m.name)
            title = f' title="{escape(row.published_label)}"' if told else ""
            cells.append(f'<td class="pub"{title}>' + (_published(told.value, told.table) if told else "") + "</td>")
    return f"<tr>{''.join(cells)}</tr>"


def _published(value: float, table: int) -> str:
    return f"<b>{value:g}</b><small>Table {table}</small>"


def _cell(cell: Cell | None, measure: Measure) -> str:
    if cell is None:
        return '<td class="none">–</td>'
    tested = ""
    if cell.p is not None:
        strong = ' class="sig"' if cell.p < SIGNIFICANT else ""
        tested = f" · <span{strong}>{escape(p_text(cell.p))}</span>"
    return (
        f"<td><b>{number(cell.value, measure)}</b>{_span(cell, measure)}"
        f"<small>{bracket(cell, measure)}</small><small>n={cell.n}{tested}</small></td>"
    )


def _span(cell: Cell, measure: Measure) -> str:
    """A percentage and its interval on a line from 0 to 100."""
    if measure.unit != "%" or cell.interval is None:
        return ""
    low, high = cell.interval.low, cell.interval.high
    return (
        f'<span class="span"><i style="left:{low:.1f}%;width:{max(high - low, 0.8):.1f}%"></i>'
        f'<u style="left:{cell.value:.1f}%"></u></span>'
    )


def _code(text: str) -> str:
    """Escaped, with `words` in code style."""
    return re.sub(r"`([^`]+)`", r"<code>\1</code>", escape(text))


def _how(tables: Tables) -> str:
    told = [HOW]
    if any(t.published(m) for t in tables.tables for m in t.measures):
        told += [f"Published figures stand in columns of their own: {publication().source}.", publication().note]
    return "".join(f'<p class="how">{escape(line)}</p>' for line in told)


# ------------------------------------------------------------------ figures
def _figure(plot: Plot) -> str:
    """The figure, or why there is none."""
    if plot.png is None:
        told = f"<h3>{escape(plot.title)}</h3><p>Left out: {escape(plot.reason)}.</p>"
        return f'<section class="card absent">{told}</section>'
    data = base64.b64encode(plot.png).decode("ascii")
    return (
        f'<section class="card" id="figure-{escape(plot.key)}"><h3>{escape(plot.title)}</h3>'
        f'<div class="scroll"><img loading="lazy" alt="{escape(plot.title)}" src="data:image/png;base64,{data}"></div>'
        f'<p class="note">{_code(plot.caption)}</p></section>'
    )
