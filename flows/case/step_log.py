"""The log of a case's steps, kept as steps.json in its folder: begin, end and state of each.

The tracker draws a trace from it; a terminal shows the steps as they begin.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from typing import Any

from sgcad_core.case.records import Attempt
from sgcad_core.findings import SOFT

FILE = "steps.json"


@dataclass
class Step:
    """One step, such as "read" or "road[2]"; times in seconds since 1970."""

    name: str
    began_s: float
    ended_s: float = 0.0
    state: str = "Completed"
    message: str = ""
    kept: bool = False
    """Whether a former run's result was taken."""

    def judge(self, attempt: Attempt, kept: bool) -> None:
        """Take the state of an attempt."""
        self.state, self.message = verdict(attempt)
        self.kept = kept

    def told(self) -> dict[str, Any]:
        """The step as JSON."""
        state = "Cached" if self.kept else self.state
        return {
            "name": self.name, "began_s": round(self.began_s, 4), "ended_s": round(self.ended_s, 4), "state": state,
            "message": self.message,
        }  # fmt: skip


OnStep = Callable[[str], None]
"""Called with a step's name when it begins, from the case's own thread; may raise to end the case."""


def ignore_step(name: str) -> None:
    """Ignore the step."""


@dataclass
class StepLog:
    """The steps of one case."""

    tell: OnStep = ignore_step
    steps: list[Step] = field(default_factory=list)

    @contextmanager
    def during(self, name: str) -> Iterator[Step]:
        """Log a step that lasts as long as the block."""
        self.tell(name)
        step = Step(name, time.time())
        try:
            yield step
        except Exception as fault:
            step.state, step.message = "Failed", str(fault)[:500]
            raise
        finally:
            step.ended_s = time.time()
            self.steps.append(step)


def verdict(attempt: Attempt) -> tuple[str, str]:
    """The state of an attempt by its findings, and these in words."""
    found = [f for f in attempt.findings if f.severity != "note"]
    message = "; ".join(f.line() for f in found)[:500]
    if any(f.severity == "refuse" for f in found):
        return "Refused", message
    return "Repair" if any(f.severity not in SOFT for f in found) else "Doubted" if found else "Accepted", message
