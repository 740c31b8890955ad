"""Made reports for tests, and what they are read by."""

from collections.abc import Callable, Iterator
from functools import lru_cache
from random import Random

import pytest

from research.generator import report as reports
from research.generator.crash.crash import sample_crash
from research.generator.crash.world import Crash
from research.generator.report import Report, make_report


def text_report(seed: int, held_out: bool = False, length: float = 1.0) -> Report:
    """The report of a seed in words alone, made once for all tests that read it: 9 ms and 25 KB each.

    Not for tests that change phrases or how reports are made, nor for those that change the report.
    """
    return _made(seed, held_out, length)


@lru_cache(maxsize=16_384)
def _made(seed: int, held_out: bool, length: float) -> Report:
    return make_report(seed, held_out, length, {"text": 1.0})


def only(monkeypatch: pytest.MonkeyPatch, wanted: Callable[[Crash], bool]) -> None:
    """From here on a test's reports are of wanted crashes alone: a crash is sampled in a tenth of a report's time."""

    def sampled(rng: Random) -> Crash:
        while not wanted(crash := sample_crash(rng)):
            pass
        return crash

    monkeypatch.setattr(reports, "sample_crash", sampled)


def sentences(report: Report) -> Iterator[tuple[str, frozenset[str]]]:
    """The sentences of a narrative, without the blanks around them, and the facts that each tells."""
    begun = 0
    for end, facts in report.sentences:
        yield report.narrative[begun:end].strip(), facts
        begun = end
