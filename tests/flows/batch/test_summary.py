"""What is told of a batch at its end, and what of its results is kept for that."""

import tracemalloc
from pathlib import Path
from types import SimpleNamespace

from flows.batch import summary
from flows.case.run_case import Ending

CASES = 24


def job(case):
    return SimpleNamespace(name=f"kit/{case}", case=SimpleNamespace(id=case), config=SimpleNamespace(name="kit"))


def result(number):
    """Every third case lacks something, every fourth is refused; every one has much that no summary tells."""
    items = [{"kind": kind, "text": f"{kind} {number}", "reason": ""} for kind in ("told", "lacks", "assumed")]
    account = {"verdict": "lacking" if number % 3 else "whole", "told": 3, "has": 2, "lacking": number % 3}
    return {
        "case": str(number),
        "status": "generated" if number % 4 else "refused",
        "reason": "no account of a crash",
        "seconds": {"road": 0.5},
        "collision": {"declared": {"striker": "V1"}, "realised": bool(number % 5), "observed": "x" * 1000},
        "account": account | {"assumed": 1, "items": items},
        "notes": [{"kind": "limit", "text": f"120 mph at most ({number})"}, {"kind": "other", "text": "x" * 1000}],
        "person": {"facts": 2, "disagreed": number % 2},
        "facts": ["x" * 50_000 + str(number)],
    }


def tally():
    cases = tuple(SimpleNamespace(id=str(number)) for number in range(CASES))
    return summary.Tally(
        SimpleNamespace(configs=(SimpleNamespace(name="kit"),), cases=cases, out=Path("o"), left=("cases/notes.docx",))
    )


def told(capsys):
    made = tally()
    for number in range(CASES):
        made.add(job(str(number)), Ending(result(number), reused=number == 1))
    summary.show(made)
    return capsys.readouterr().out, made.exit_code(), made.in_words()


def test_what_is_no_case_is_named(capsys):
    shown, _, _ = told(capsys)
    assert "left out, 1 beside the cases: cases/notes.docx; a case is a folder or .pdf, .txt, .xml" in shown


def test_a_long_batch_is_told_as_if_all_was_kept(capsys, monkeypatch):
    brief = told(capsys)
    monkeypatch.setattr(summary, "FEW", CASES)
    assert told(capsys) == brief
    assert brief[1:] == (0, "18 generated, 6 refused")
    assert "kit/1: lacks lacks 1" in brief[0]
    assert "120 mph at most (3)" in brief[0]


def test_a_long_batch_keeps_little_of_a_result():
    made = tally()
    tracemalloc.start()
    for number in range(CASES):
        made.add(job(str(number)), Ending(result(number) | {"sentences": "x" * 50_000 + str(number)}))
    kept = tracemalloc.get_traced_memory()[0]
    tracemalloc.stop()
    assert kept / CASES < 5_000
