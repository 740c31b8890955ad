"""`sgcad revise`: a person's facts applied to one finished case. Answers go to stdout.

Heavy modules are imported inside, so that --help is quick.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from flows.case.revise_case import Revised
    from sgcad_core.revision import CaseField

Case = Annotated[Path, typer.Argument(help="A finished case's folder, such as runs/template/x; with --later a report.")]
Sets = Annotated[
    list[str] | None,
    typer.Option("--set", help="FIELD=VALUE, such as roads.N.lanes_forward=2; may be given several times."),
]
Why = Annotated[str, typer.Option("--why", help="The reason, kept with the fact.")]
Who = Annotated[str, typer.Option("--who", help="Author of the edits; default: the user's name.")]
Undo = Annotated[bool, typer.Option("--undo", help="Undo the last revision.")]
Listed = Annotated[bool, typer.Option("--list", help="List every field with its value and its allowed values.")]
Report = Annotated[Path | None, typer.Option("--report", help="Path of the report, if it was moved.")]
Later = Annotated[bool, typer.Option("--later", help="Only keep the facts beside a report; the next run uses them.")]


def revise(
    case: Case, sets: Sets = None, why: Why = "", who: Who = "", undo: Undo = False, listed: Listed = False,
    report: Report = None, later: Later = False,
) -> None:  # fmt: skip
    """Change facts of a finished case by hand; the case is planned, simulated, checked and written again.

    The facts are kept in facts.yaml beside the report and override every reader in later runs of any config. A wrong
    fact is refused with its reason and changes nothing. FIELD=as_read restores the value that was read.
    """
    from flows.case import revise_case
    from sgcad_core.errors import ConfigError

    if sum((bool(sets), undo, listed)) != 1:
        raise ConfigError("give one of --set FIELD=VALUE (several are allowed), --undo or --list")
    if listed:
        typer.echo("\n".join(_fields(case)))
    elif later:
        if undo:
            raise ConfigError("--later keeps facts; with --undo give a finished case's folder")
        edits = revise_case.note(report or case, _given(sets or ()), who=who, why=why)
        typer.echo(f"kept for the next run: {len(edits)} facts of {(report or case).name}")
    elif undo:
        typer.echo("\n".join(_told(revise_case.undo(case, report=report))))
    else:
        typer.echo("\n".join(_told(revise_case.revise(case, _given(sets or ()), who=who, why=why, report=report))))


def _given(sets: list[str] | tuple[str, ...]) -> dict[str, object]:
    """FIELD=VALUE texts as a mapping. Raises ConfigError for one without a value."""
    from sgcad_core.errors import ConfigError

    pairs = [text.partition("=") for text in sets]
    if wrong := [text for text, pair in zip(sets, pairs, strict=True) if not pair[0] or not pair[1]]:
        raise ConfigError(f"--set {wrong[0]!r}: expected FIELD=VALUE, such as roads.N.lanes_forward=2")
    return {field: value for field, _, value in pairs}


def _told(revised: Revised) -> list[str]:
    """The result of a revision in lines for people."""
    from flows.terminal import escape_plain
    from sgcad_core.case.verdict_told import verdict_sentence
    from sgcad_core.result import as_declared

    result = revised.result
    as_told = {True: ", as declared", False: ", not as declared", None: ""}[as_declared(result)]
    end = f"{result['case']}: {result['status']}{as_told}" + (f" ({result['reason']})" if result["reason"] else "")
    lines = [end if revised.changed else f"{end}; nothing was changed: the facts had these values already"]
    lines += [verdict] if (verdict := verdict_sentence(result)) else []
    lines += [f"  {edit.line()}" for edit in revised.edits] or ["  no fact is a person's"]
    findings = {finding.line(): None for said in revised.findings.values() for finding in said}
    lines += [f"  {line}" for line in findings]
    return [escape_plain(line) for line in (*lines, f"in {revised.seconds:.1f} s")]


def _fields(case: Path) -> list[str]:
    """One line per field: name, value, allowed values, meaning."""
    from flows.case.revise_case import editable

    return [f"{f.name} = {_value(f.value)}  [{_range(f)}]  {f.kind.about}" for f in editable(case)]


def _value(value: object) -> str:
    if isinstance(value, tuple):
        return ", ".join(value) or "usual"
    if isinstance(value, bool):
        return str(value).lower()
    return "open" if value is None else str(value)


def _range(field: CaseField) -> str:
    kind = field.kind
    if field.choices:
        return ("list of " if kind.form == "list" else "") + ", ".join(field.choices)
    if kind.least is not None and kind.most is not None:
        return f"{kind.least:g} to {kind.most:g}{', null' if kind.optional else ''}"
    return "true, false" if kind.form == "flag" else kind.form
