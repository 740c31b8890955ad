"""`sgcad explain`: the facts read from a report, sentence by sentence, then the inferred and the assumed facts.

Reads a case's folder (result.json), or a report. Asks no model.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from sgcad_core.account import Disagreement
from sgcad_core.case.records import Conflict, CrashReport, Fact
from sgcad_core.case.verdict_told import verdict_sentence
from sgcad_core.errors import BadInput
from sgcad_core.records.timeline import Act
from sgcad_core.registry import plugin_class

_SHOWN = 20
"""Most conflicts of an attempt that are listed."""


def explain(source: Path) -> str:
    """The whole account as text. Raises BadInput for a path that is neither a case's folder nor a report."""
    if (source / "result.json").is_file():
        return _of_run(source)
    reader = plugin_class("report_reader", "auto")()
    report: CrashReport = reader.read(source)  # type: ignore[attr-defined]
    return account(source.name, _sentences(report), report.reading.facts, report.reading.timeline)


def _of_run(folder: Path) -> str:
    try:
        result = json.loads((folder / "result.json").read_text(encoding="utf-8"))
        facts = tuple(Fact.model_validate(row) for row in result["facts"])
        acts = tuple(Act.model_validate(row) for row in result.get("timeline", ()))
        places = [(s["start"], s["end"], s["text"]) for s in result["sentences"]]
    except (OSError, ValueError, KeyError, TypeError, ValidationError) as fault:
        raise BadInput(
            f"{folder}: result.json tells no facts ({type(fault).__name__}): run the case again with this version"
        ) from fault
    title = f"{result['case']} ({result['config']})"
    if verdict := verdict_sentence(result):
        title += f"\n{verdict}"
    told = account(title, places, facts, acts)
    return "\n".join([told, *_disputed(result.get("disagreements") or ()), *_conflicts(folder)])


def _conflicts(folder: Path) -> list[str]:
    """Where a model's rows with and without the report wanted other tokens, by attempt, and whose was written."""
    lines: list[str] = []
    for file in sorted(folder.glob("attempts/*/attempt.json")):
        try:
            generation = json.loads(file.read_text(encoding="utf-8")).get("generation") or {}
            found = list(map(Conflict.model_validate, generation.get("conflicts") or ()))
        except (OSError, ValueError, AttributeError) as fault:
            raise BadInput(f"{file}: tells no attempt ({type(fault).__name__}): run the case again") from fault
        if found:
            won = Counter(one.winner for one in found)
            counts = ", ".join(f"{who} {won[who]}" for who in ("evidence", "prior", "neither") if won[who])
            lines += ["", f"Evidence against prior, {file.parent.name}: {len(found)} tokens; won: {counts}"]
            lines += [f"    {one.line()}" for one in found[:_SHOWN]]
            lines += [f"    and {len(found) - _SHOWN} more"] if len(found) > _SHOWN else []
    return lines


def _disputed(found: Sequence[Mapping[str, Any]]) -> list[str]:
    """What two readers read differently, with the sentence's place and both confidences."""
    lines = ["", "Readers differ:"] if found else []
    for one in map(Disagreement.model_validate, found):
        place = f", from [{one.start}-{one.end}]" if one.start is not None else ""
        lines.append(f"    {one.line()}  (confidence {one.kept_confidence:g} against {one.confidence:g}{place})")
    return lines


def _sentences(report: CrashReport) -> list[tuple[int, int, str]]:
    return [(s.start, s.end, report.reading.text_of(s)) for s in report.reading.sentences]


def account(
    title: str, sentences: Sequence[tuple[int, int, str]], facts: Sequence[Fact], timeline: Sequence[Act] = ()
) -> str:
    """Each sentence (begin, end, text) with the facts that it states, then inferred facts, what is assumed, and the
    timeline."""
    lines = [title, ""]
    for start, end, text in sentences:
        lines += [f"[{start}-{end}] {text}", *_rows(f for f in facts if f.status == "stated" and f.start == start)]
    groups = {
        "Inferred": [f for f in facts if f.status == "inferred" and f.basis == "text"],
        "Answered by the model": [f for f in facts if f.basis in ("model", "diagram")],
        "Assumed": [f for f in facts if f.status == "default"],
    }
    for name, group in groups.items():
        lines += ["", f"{name}:", *_rows(group)] if group else []
    lines += ["", "Timeline:", *(f"    {_moment(act)}" for act in timeline)] if timeline else []
    return "\n".join(lines)


def _moment(act: Act) -> str:
    """One act of the timeline: when, who, what, and from which words."""
    words = f'  ("{act.words}")' if act.words else ""
    return f"{act.phase:6s}  {act.actor}  {act.line()}{'  <- at the crash' if act.decides else ''}{words}"


def _rows(facts: Iterator[Fact] | Sequence[Fact]) -> list[str]:
    return [f"    {f.field} = {_shown(f)}  ({f.rule}, confidence {f.confidence:g}{_ground(f)})" for f in facts]


def _shown(fact: Fact) -> str:
    told = ", ".join(fact.value) if isinstance(fact.value, tuple) else str(fact.value)
    return f"{told} (assumed)" if fact.status == "default" else told


def _ground(fact: Fact) -> str:
    place = f", from [{fact.start}-{fact.end}]" if fact.status == "inferred" and fact.start is not None else ""
    return place + (f", {fact.nats:.2f} nats" if fact.nats is not None else "")
