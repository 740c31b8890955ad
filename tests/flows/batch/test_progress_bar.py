"""What is shown on the way: a bar that moves with every attempt, lines where there is no terminal."""

from pathlib import Path
from types import SimpleNamespace

import pytest
from rich.progress import Progress

from flows.batch import progress_bar
from flows.batch.progress_bar import BatchProgress
from flows.batch.summary import Tally
from flows.case.run_case import Ending


def job(case):
    return SimpleNamespace(name=f"kit/{case}", case=SimpleNamespace(id=case), config=SimpleNamespace(name="kit"))


def ending(status="generated"):
    return Ending({"status": status, "reason": "", "seconds": {"road": 0.25}})


def tally(count):
    return Tally(SimpleNamespace(configs=("kit",), cases=tuple(range(count)), out=Path()))


def test_the_bar_moves_with_every_attempt_of_a_model():
    bar = Progress()
    watch = BatchProgress(tally(2), 2, bar, bar.add_task("starting", total=2, done=0))
    seen = []
    for attempt in ("road[1]", "road[2]", "road[3]", "scenario[1]", "scenario[2]"):
        watch.step("kit/a", attempt)
        seen.append(bar.tasks[0].completed)
    watch.ended(job("a"), ending())
    seen.append(bar.tasks[0].completed)
    assert seen == sorted(set(seen))
    assert 0 < seen[0] < seen[-2] < seen[-1] == 1


def test_without_a_terminal_every_case_of_a_small_batch_has_a_line(capsys):
    with progress_bar.batch_progress(tally(2)) as watch:
        watch.step("kit/a", "road[1]")
        watch.ended(job("a"), ending())
        watch.ended(job("b"), ending("refused"))
    assert capsys.readouterr().err.splitlines() == ["[1/2] kit/a: generated (0.2 s)", "[2/2] kit/b: refused (0.2 s)"]


def test_without_a_terminal_the_steps_of_a_single_case_have_lines(capsys):
    with progress_bar.batch_progress(tally(1)) as watch:
        for step in ("read", "retrieve[road]", "road[1]", "simulate", "measure"):
            watch.step("kit/a", step)
        watch.ended(job("a"), ending())
    told = ["read", "road[1]", "simulate"]
    lines = [*(f"[0/1] kit/a: {step}" for step in told), "[1/1] kit/a: generated (0.2 s)"]
    assert capsys.readouterr().err.splitlines() == lines


@pytest.mark.parametrize("count", [51, 400])
def test_without_a_terminal_a_large_batch_has_few_lines_and_one_at_its_end(capsys, count):
    with progress_bar.batch_progress(tally(count)) as watch:
        for number in range(count):
            watch.ended(job(str(number)), ending())
    lines = capsys.readouterr().err.splitlines()
    assert lines[-1] == f"[{count}/{count}] {count} generated"
    assert len(lines) <= 2
