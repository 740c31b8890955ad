"""What stands last in the prompt of a further attempt: what failed and why, in the answer before and in earlier ones.

A model hears faults, and questions that rest on a sentence; what is only odd is left to the simulation. Of findings
that exclude each other one is put. Knows findings and JSON answers; no validator, no model.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator, Sequence
from itertools import product
from typing import Any

from sgcad_core.case.records import Attempt, Finding, Hold
from sgcad_core.findings import SOFT
from sgcad_core.record_base import Value

_PREVIOUS = "Your previous answer was:"
_FAULTY = "Your previous answer cannot be used as it is. Faults found:"
_ONCE_MORE = "Look once more at these places of the report:"
_FORMER = "Earlier answers to the same, and why each failed (do not go back to them):"
_MEND = "Look at the evidence again, mend every fault, keep what was right, and give the whole answer anew."
_SETTLE = "Nothing else is asked: keep what is right, and give the whole answer anew."
_QUOTED = 300
"""Most characters of a quoted sentence."""
_SHOWN = 160
"""Most characters of an earlier value."""
_MOST_FORMER = 12
"""Most lines on earlier answers, the newest kept."""
_STEP = re.compile(r"\.?(?:([A-Za-z_]\w*)|\[(\d+)\])")
_ORDER = ("refuse", "repair", *SOFT, "note")


def repair_of(attempts: Sequence[Attempt]) -> str:
    """What the next attempt hears of all former ones of its stage; empty where there is nothing to hear."""
    if not attempts or not (findings := put_to_model(attempts[-1].findings)):
        return ""
    return repair_text(attempts[-1].answer, findings, attempts[:-1])


def repair_text(previous: str, findings: Sequence[Finding], former: Sequence[Attempt] = ()) -> str:
    """The answer before (if known), its faults, the sentences it is asked about, and earlier answers that failed."""
    faults = [f for f in findings if f.severity not in SOFT]
    asked = [f for f in findings if f.severity in SOFT]
    parts = [f"{_PREVIOUS}\n{previous.strip()}"] if previous.strip() else []
    parts += [f"{_FAULTY}\n{_numbered(map(_fault, faults))}"] if faults else []
    parts += [f"{_ONCE_MORE}\n{_numbered(map(_question, asked))}"] if asked else []
    tried = list(_failed(previous, former))[-_MOST_FORMER:]
    parts += ["\n".join([_FORMER, *tried])] if tried else []
    return "\n\n".join([*parts, _MEND if faults else _SETTLE])


def put_to_model(findings: Iterable[Finding]) -> tuple[Finding, ...]:
    """What a model hears of these findings: faults, and soft ones with a sentence; none that excludes a graver one."""
    heard = [f for f in findings if f.severity == "repair" or (f.severity in SOFT and f.told is not None)]
    kept: list[Finding] = []
    for finding in sorted(heard, key=lambda f: _ORDER.index(f.severity)):
        if not any(exclude(finding, other) for other in kept):
            kept.append(finding)
    return tuple(f for f in heard if f in kept)


# ------------------------------------------------------------------ findings as a set
def exclude(one: Finding, other: Finding) -> bool:
    """Whether no answer can do as both say: their holds leave nothing, or they tell one field two values."""
    if one.told and other.told and one.told.field == other.told.field and one.told.value != other.told.value:
        return True
    return any(_exclude(a, b) for a, b in product(one.holds, other.holds))


def _exclude(a: Hold, b: Hold) -> bool:
    if a.items != b.items:
        return False
    if any(x.at_most is not None and x.at_most < y.at_least for x, y in ((a, b), (b, a))):
        return True
    if not a.either or not b.either or not _one_item(a, b):
        return False
    return all(
        any(not set(values) & set(second[name]) for name, values in first.items() if name in second)
        for first, second in product(a.either, b.either)
    )


def _one_item(a: Hold, b: Hold) -> bool:
    """Whether both surely speak of one item: in one place, or with one key of which both allow one value only."""
    if a.at is not None or b.at is not None:
        return a.at == b.at and not a.key and not b.key
    return bool(a.key) and a.key == b.key and a.values == b.values and len(a.values) == 1


# ------------------------------------------------------------------ earlier answers
def _failed(previous: str, former: Sequence[Attempt]) -> Iterator[str]:
    """A line for each fault of an earlier answer, and for each question upon which its value was changed."""
    for attempt in former:
        for finding in put_to_model(attempt.findings):
            value = value_at(attempt.answer, finding.where)
            changed = value is not None and value != value_at(previous, finding.where)
            if finding.severity == "repair" or changed:
                said = finding.value if value is None else json.dumps(value, separators=(",", ":"), ensure_ascii=False)
                where = finding.where or "answer"
                yield f"- attempt {attempt.number}, {where} = {_short(said, _SHOWN)}: {_why(finding)}"


def value_at(answer: str, where: str) -> Any | None:
    """The value of a JSON answer at a finding's place (`contacts[0]`, `V1.maneuver`, `actor V1`); None: not there."""
    try:
        found: Any = json.loads(answer)
    except (ValueError, RecursionError):
        return None
    at = 0
    where = where.removeprefix("actor ")
    while at < len(where):
        step = _STEP.match(where, at)
        if step is None:
            return None
        found = _stepped(found, step[1], step[2])
        if found is None:
            return None
        at = step.end()
    return found if where else None


def _stepped(found: Any, name: str | None, index: str | None) -> Any | None:
    if index is not None:
        return found[int(index)] if isinstance(found, list) and int(index) < len(found) else None
    if not isinstance(found, dict):
        return None
    if name in found:
        return found[name]
    lists = (part for part in found.values() if isinstance(part, list))
    return next((one for part in lists for one in part if isinstance(one, dict) and one.get("id") == name), None)


# ------------------------------------------------------------------ words
def _fault(finding: Finding) -> str:
    """A fault, with the sentence on which it rests."""
    if finding.told is None:
        return finding.line()
    return f"{finding.line()}; the report: {_short(finding.told.sentence, _QUOTED)!r}"


def _question(finding: Finding) -> str:
    """A question with the sentence that it rests on; the answer may stand."""
    if finding.told is None:
        return finding.line()
    told, where = finding.told, f" at {finding.where}" if finding.where else ""
    value = f"your value {finding.value!r}" if finding.value else "your answer"
    return (
        f"This sentence may tell {_told(finding)}: {_short(told.sentence, _QUOTED)!r} ({finding.what}{where}). "
        f"Keep {value} if the words of the report tell it, or change it; decide by the words alone."
    )


def _why(finding: Finding) -> str:
    if finding.severity == "repair" or finding.told is None:
        return f"[{finding.source}] {finding.what}"
    return f"{finding.what}; the report: {_short(finding.told.sentence, _QUOTED)!r}"


def _told(finding: Finding) -> str:
    return f"{finding.told.field} = {_words(finding.told.value)}" if finding.told else ""


def _words(value: Value) -> str:
    return ", ".join(map(str, value)) if isinstance(value, tuple) else str(value)


def _numbered(lines: Iterable[str]) -> str:
    return "\n".join(f"{i}. {line}" for i, line in enumerate(lines, 1))


def _short(text: str, limit: int) -> str:
    text = " ".join(text.split())
    return text if len(text) <= limit else f"{text[: limit - 3]}..."
