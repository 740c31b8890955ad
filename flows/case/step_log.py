"""The log of a case's steps: begin, end, state, and the steps before each.

Steps are reported as they happen (`Steps.tell`) and kept (`Steps.done`), so that a worker process can return them.
flows/batch/prefect_tasks.py shows them in Prefect.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from typing import Literal

from sgcad_core.asking.refine import Turn
from sgcad_core.case.records import Attempt

Kind = Literal["completed", "cancelled", "failed"]

WAITS_FOR: Mapping[str, tuple[str, ...]] = {
    "opinion": ("read",),
    "retrieve[road]": ("opinion", "read"),
    "road": ("retrieve[road]",),
    "retrieve[scenario]": ("opinion", "read"),
    "scenario": ("retrieve[scenario]", "road"),
    "simulate": ("scenario",),
    "judge": ("simulate",),
    "measure": ("simulate",),
    "drive": ("measure",),
    "draw": ("measure", "judge", "drive"),
    "track": ("draw",),
}
"""Steps that a step needs: of a stage its last attempt, of "opinion" and "read" the first one found."""
_FIRST_OF = ("opinion", "read")


@dataclass(frozen=True)
class Step:
    """One step, such as "read" or "road[2]"; times in seconds since 1970, `ended` None while it runs."""

    name: str
    began: float
    ended: float | None = None
    state: str = "Completed"
    kind: Kind = "completed"
    message: str = ""
    after: tuple[str, ...] = ()


OnStep = Callable[[Step], None]
"""Called when a step begins (`ended` is None) and when it has ended, from the case's own thread."""


def ignore_step(step: Step) -> None:
    """Ignore the step."""


@dataclass
class Steps:
    """The steps of one case."""

    tell: OnStep = ignore_step
    done: list[Step] = field(default_factory=list)

    @contextmanager
    def during(self, name: str) -> Iterator[list[str]]:
        """Log a step that lasts as long as the block; the block may append its state's name to the list.

        An earlier step of the same name is continued.
        """
        state: list[str] = []
        begun = self._begin(name)
        try:
            yield state
        except Exception as fault:
            self._end(replace(begun, state="Failed", kind="failed", message=str(fault)[:500]))
            raise
        self._end(replace(begun, state=state[-1] if state else begun.state))

    def attempt(self, name: str, work: Callable[[], Turn]) -> Turn:
        """Log an attempt, whose state is its verdict."""
        begun = self._begin(name)
        try:
            turn = work()
        except Exception as fault:
            self._end(replace(begun, state="Failed", kind="failed", message=str(fault)[:500]))
            raise
        self._end(judged(begun, turn.attempt))
        return turn

    def taken(self, name: str) -> None:
        """Log a step whose result was taken from the shelf."""
        begun = self._begin(name)
        self._end(replace(begun, state="Cached", message="made for another config before"))

    def _begin(self, name: str) -> Step:
        before = next((step for step in self.done if step.name == name), None)
        began = before.began if before else time.time()
        self.done = [step for step in self.done if step is not before]
        step = Step(name, began, after=waits_for(name, [step.name for step in self.done]))
        self.tell(step)
        return step

    def _end(self, step: Step) -> None:
        ended = replace(step, ended=time.time())
        self.done.append(ended)
        self.tell(ended)


def waits_for(name: str, seen: Sequence[str]) -> tuple[str, ...]:
    """The steps that one waits for among those seen; the last one where it names none."""
    stage, _, number = name.partition("[")
    if number[:-1].isdigit() and int(number[:-1]) > 1:
        return (f"{stage}[{int(number[:-1]) - 1}]",)
    needed = WAITS_FOR.get(name) or WAITS_FOR.get(stage, ())
    found = [last for wanted in needed if (last := _last(wanted, seen))]
    if len(found) > 1 and all(one in _FIRST_OF for one in found):
        found = found[:1]
    return tuple(found) or tuple(seen[-1:])


def _last(wanted: str, seen: Sequence[str]) -> str:
    """The step of that name, or the stage's attempt with the highest number; "" where there is none."""
    attempts = [s for s in seen if _attempt_of(s) == wanted]
    return max(attempts, key=lambda s: int(s.partition("[")[2][:-1]), default=wanted if wanted in seen else "")


def _attempt_of(name: str) -> str:
    stage, _, number = name.partition("[")
    return stage if number[:-1].isdigit() else ""


def judged(step: Step, attempt: Attempt) -> Step:
    """A step with the state of its attempt: completed unless it refused."""
    found = [f for f in attempt.findings if f.severity != "note"]
    message = "; ".join(f.line() for f in found)[:500]
    if any(f.severity == "refuse" for f in found):
        return replace(step, state="Refused", kind="cancelled", message=message)
    name = "Repair" if any(f.severity != "doubt" for f in found) else "Doubted" if found else "Accepted"
    return replace(step, state=name, message=message)
