"""The judge's figures over a folder of runs, with a program that stands in for esmini."""

from __future__ import annotations

import json
import shutil

import numpy as np
import pytest

from flows.case_files import case_folder
from research.benchmarks.scenes.judge import main
from sgcad_core.formats.openscenario.writing.background import with_background
from sgcad_core.formats.openscenario.writing.writer import write_xosc
from tests.plugins.simulator.fake_esmini import log, make
from tests.sgcad_core.formats.xosc_samples import actor, trajectory

K = np.arange(60)
ACTORS = [actor("V1"), actor("V2")]
MOVES = [trajectory("V1", K * 0.5 + 1.4, 0), trajectory("V2", K * 0.0 + 13.4, 0)]
DECLARED = {"striker": "V1", "struck": "V2", "striker_area": "front", "struck_area": "back"}


@pytest.fixture
def runs(tmp_path):
    case = tmp_path / "runs" / "template" / "c1"
    case.mkdir(parents=True)
    (case / "scenario.xosc").write_text(write_xosc(ACTORS, MOVES, None))
    (case / "road.xodr").write_text("<OpenDRIVE/>")
    case_folder.write_trajectories(case / "trajectories.csv", MOVES)
    result = {"case": "c1", "actors": [a.model_dump() for a in ACTORS], "collision": {"declared": DECLARED}}
    (case / "result.json").write_text(json.dumps(result))
    return tmp_path / "runs"


def judged(runs, tmp_path, *bodies):
    return main([str(runs), "--path", str(make(tmp_path, log(*bodies)))])


def test_a_player_that_agrees_is_counted_as_agreeing(runs, tmp_path, capsys):
    assert judged(runs, tmp_path, ("V1", 0.0, 0.0, 0.0, 10.0, 1.4), ("V2", 12.0, 0.0, 0.0, 0.0, 1.4)) == 0
    row = next(line.split() for line in capsys.readouterr().out.splitlines() if "esmini" in line)
    assert row == ["runs", "esmini", "1/1", "1/1", "0.0000", "0.0000", "1/1"]


def test_a_copy_that_a_tracker_keeps_is_not_counted(runs, tmp_path, capsys):
    shutil.copytree(runs / "template" / "c1", runs / "mlflow-artifacts" / "1" / "run" / "artifacts")
    judged(runs, tmp_path, ("V1", 0.0, 0.0, 0.0, 10.0, 1.4), ("V2", 12.0, 0.0, 0.0, 0.0, 1.4))
    assert " 1/1 " in next(line for line in capsys.readouterr().out.splitlines() if "esmini" in line)


def put_traffic(case, folder):
    """Its files with one more vehicle, written to a folder; the record of the traffic."""
    info = ACTORS[0].model_copy(update={"id": "traffic1"})
    track = MOVES[0].model_copy(update={"actor": "traffic1", "y_m": MOVES[0].y_m + 20.0})
    (folder / "scenario.xosc").write_text(with_background((case / "scenario.xosc").read_text(), [info], [track]))
    case_folder.write_trajectories(folder / "trajectories.csv", MOVES, [track])
    return {"vehicles": [info.model_dump()]}


def test_vehicles_of_the_traffic_are_judged_too(runs, tmp_path, capsys):
    case = runs / "template" / "c1"
    result = json.loads((case / "result.json").read_text())
    (case / "result.json").write_text(json.dumps(result | {"traffic": put_traffic(case, case)}))
    crash = ("V1", 0.0, 0.0, 0.0, 10.0, 1.4), ("V2", 12.0, 0.0, 0.0, 0.0, 1.4)
    assert judged(runs, tmp_path, *crash, ("traffic1", 0.0, 20.0, 0.0, 10.0, 1.4)) == 0
    assert judged(runs, tmp_path, *crash, ("traffic1", 0.0, 21.0, 0.0, 10.0, 1.4)) == 1
    assert "traffic1 at 0.00 s is 1.000 m beside our playing" in " ".join(capsys.readouterr().out.split())


def test_traffic_that_was_put_around_a_case_afterwards_is_judged_with_it(runs, tmp_path, capsys):
    case = runs / "template" / "c1"
    around = case / "export" / "traffic" / "light"
    around.mkdir(parents=True)
    (around / "traffic.json").write_text(json.dumps(put_traffic(case, around)))
    shutil.copy(case / "road.xodr", around)
    both = ("V1", 0.0, 0.0, 0.0, 10.0, 1.4), ("V2", 12.0, 0.0, 0.0, 0.0, 1.4), ("traffic1", 0.0, 20.0, 0.0, 10.0, 1.4)
    assert judged(runs, tmp_path, *both) == 0
    assert " 2/2 " in next(line for line in capsys.readouterr().out.splitlines() if "esmini" in line)
    (around / "traffic.json").write_text("{")
    assert judged(runs, tmp_path, *both) == 2
    assert "traffic.json: cannot be read" in capsys.readouterr().err


def test_one_that_does_not_is_told_with_actor_and_time(runs, tmp_path, capsys):
    """It takes the box's center for the rear axle, as players did with our former files."""
    assert judged(runs, tmp_path, ("V1", 0.0, 0.0, 0.0, 10.0, 0.0), ("V2", 12.0, 9.0, 0.0, 0.0, 0.0)) == 1
    out = capsys.readouterr().out
    assert "0/1" in out
    assert "V2 at 0.00 s is 9.108 m beside our playing (limit 0.01 m)" in " ".join(out.split())
    assert "the first contact is not the declared one, but none" in " ".join(out.split())


def test_a_folder_without_runs_and_a_binary_that_is_not_there_are_told(tmp_path, capsys, monkeypatch):
    (tmp_path / "empty").mkdir()
    assert judged(tmp_path / "empty", tmp_path) == 2
    assert "no scenario.xosc with a trajectories.csv beside it" in capsys.readouterr().err
    assert main([str(tmp_path), "--path", "/no/such"]) == 2
    assert "'/no/such' is no program that can be run" in capsys.readouterr().err
