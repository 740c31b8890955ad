"""The figures of traffic over a folder of runs: an untouched crash passes, errors are told."""

from flows.case.run_case import run_case
from flows.case_files.find_cases import cases_of
from research.benchmarks.handover.traffic import Figures, _compare, main
from sgcad_core.case.traffic import Traffic
from sgcad_core.config import load
from tests.sgcad_core.formats.xosc_samples import actor
from tests.sgcad_core.handover.scenes import crossing

REPORT = (
    "V1, a passenger car, was traveling east on Oak Street, a two-lane road, approaching a four-leg intersection. V2, "
    "a pickup truck, was traveling north on Elm Avenue at 35 mph. The front of V2 struck the right side of V1."
)


def test_a_run_is_measured_and_its_crash_stays(tmp_path, capsys):
    (tmp_path / "side.txt").write_text(REPORT)
    (case,) = cases_of([tmp_path / "side.txt"])
    run_case(load("template.yaml", ("tracker=none",)), case, tmp_path / "runs", "made")
    assert main([str(tmp_path / "runs"), "--density", "light"]) == 0
    out = capsys.readouterr().out
    assert "1 cases, 1 with traffic" in out
    assert "our player: same crash 1 of 1; vehicles that touch an actor: 0" in out


def test_a_touch_and_another_crash_are_counted():
    script, figures = crossing(), Figures()
    through = script.trajectories[0].model_copy(update={"actor": "traffic1"})
    traffic = Traffic(density="light", seed=1, wanted=1, vehicles=(actor("traffic1"),), trajectories=(through,))
    away = script.trajectories[1].model_copy(update={"x_m": script.trajectories[1].x_m + 50})
    _compare(figures, "ours", script, traffic, (script.trajectories[0], away, through))
    assert (figures.same["ours"], figures.touches["ours"]) == (0, 1)
    assert any("traffic1 touches V1" in line for line in figures.lines())


def test_a_folder_without_cases_is_told(tmp_path, capsys):
    assert main([str(tmp_path)]) == 2
    assert "no executed case" in capsys.readouterr().err
