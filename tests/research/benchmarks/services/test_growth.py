"""Growth per case: a leak is seen, noise and what a batch takes once are none."""

import random

import pytest

from research.benchmarks.services.growth import WHAT, Look, cases, keep, read_looks, slope, table


def looks(leak: float, count: int = 600, pid: float = 7.0) -> list[Look]:
    """Two looks a case of a process that takes `leak` more each case, wavers by 20 and takes 1,000 once at first."""
    rng = random.Random(1)

    def value(case: int) -> float:
        return 5000 + leak * case + rng.gauss(0, 20) + min(case, 20) * 50

    return [{"pid": pid, "done": i // 2, **{name: value(i // 2) for name in WHAT}} for i in range(count)]


@pytest.mark.parametrize("leak", [0.0, 2.0, 40.0])
def test_a_leak_is_found_within_its_interval_and_none_where_there_is_none(leak):
    by, half = slope(looks(leak), "main_kb")
    assert abs(by - leak) < 1.5 * half
    assert 0 < half < 0.2


def test_looks_that_follow_each_other_do_not_make_it_surer():
    often = [look for look in looks(1.0) for _ in range(50)]
    assert slope(often, "main_kb")[1] > 0.5 * slope(looks(1.0), "main_kb")[1]


def test_a_batch_that_was_gone_on_with_is_measured_by_its_last_process():
    before = looks(400.0, pid=6.0)
    assert slope([*before, *looks(0.0)], "main_kb") == slope(looks(0.0), "main_kb")


def test_few_looks_give_no_slope():
    with pytest.raises(ValueError, match=r"8 looks fall into .* of 20 spans: use more cases"):
        slope(looks(0.0, 8), "main_kb")


def test_looks_are_kept_as_they_come(tmp_path):
    told = looks(1.0, 100)
    for look in told:
        keep(tmp_path / "looks.csv", look)
    assert read_looks(tmp_path / "looks.csv") == told
    assert table(told).count("+-") == len(WHAT)


def test_cases_are_reports_that_differ(tmp_path):
    cases(tmp_path, 12)
    texts = [file.read_text() for file in sorted(tmp_path.glob("*/report.txt"))]
    assert len(set(texts)) == 12
    assert all(len(text) > 100 for text in texts)


def test_of_cheap_cases_one_in_ten_tells_a_crash(tmp_path):
    cases(tmp_path, 20, cheap=True)
    told = [len(file.read_text()) > 100 for file in sorted(tmp_path.glob("*/report.txt"))]
    assert told == [number % 10 == 1 for number in range(20)]
