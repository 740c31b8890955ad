"""What a report carries at its end changes nothing that is read, unless it tells of a crash."""

import pytest

from research.benchmarks.decoding import injection


@pytest.mark.slow
def test_what_a_report_carries_moves_nothing_that_is_read():
    told = list(injection.reports(200))[::5]
    assert [piece for report, piece in told if injection.moved(report, piece)] == []


def test_a_piece_that_tells_of_another_crash_is_noticed():
    report = injection.SMALL.replace("Vehicle #2 was stopped. ", "")
    assert injection.moved(report, "Vehicle #2 was traveling north. A third vehicle, Vehicle #3, struck Vehicle #1.")
