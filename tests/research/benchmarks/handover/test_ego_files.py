"""The count of ego files on one made case: met where driven as told, missed where the ego does not come."""

import pytest

from flows.case.run_case import run_case
from flows.case_files.find_cases import cases_of
from research.benchmarks.handover import ego_files
from sgcad_core.config import load

REPORT = (
    "V1, a passenger car, was traveling east on Mill Road, a two-lane road, approaching a four-leg intersection. V2, a "
    "van, was traveling north on Dale Street at 30 mph. The front of V1 struck the left side of V2."
)


@pytest.fixture(scope="module")
def runs(tmp_path_factory):
    place = tmp_path_factory.mktemp("ego_files")
    (place / "mill.txt").write_text(REPORT)
    (case,) = cases_of([place / "mill.txt"])
    assert (
        run_case(load("template.yaml", ("tracker=none",)), case, place / "runs", "made").result["status"] == "generated"
    )
    return place / "runs"


def figures(runs, capsys, *more):
    code = ego_files.main([str(runs), *more])
    return code, capsys.readouterr().out


def test_ego_driven_as_told_counts_as_met_on_the_same_sides(runs, capsys):
    code, said = figures(runs, capsys)
    assert code == 0
    assert said.startswith("cases 1; loaded 1; with a crash 1; met 1; sides 1")


def test_ego_that_starts_later_meets_it_too(runs, capsys):
    assert "sides 1" in figures(runs, capsys, "--late", "3")[1]


def test_ego_that_never_comes_is_counted_as_missed_and_named(runs, capsys):
    said = figures(runs, capsys, "--pace", "0.01")[1]
    assert said.startswith("mill: missed: nothing instead of V1 front and V2 left")
    assert "met" not in said.splitlines()[1]
