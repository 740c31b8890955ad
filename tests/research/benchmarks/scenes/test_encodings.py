"""The benchmark of both encodings: what it counts, and that a player which strays is told."""

from __future__ import annotations

import json

import numpy as np
import pytest

from flows.case_files import case_folder
from research.benchmarks.scenes.encodings import _away, main
from sgcad_core.execution.scenario import compile_scenario
from tests.plugins.simulator.fake_esmini import log, make
from tests.sgcad_core.formats.xosc_samples import CROSSING, crossroads, trajectory


@pytest.fixture
def runs(tmp_path):
    scenario = compile_scenario(CROSSING, crossroads())
    case = tmp_path / "runs" / "template" / "c1"
    case.mkdir(parents=True)
    (case / "road.xodr").write_text(crossroads().xodr)
    case_folder.write_trajectories(case / "trajectories.csv", scenario.planned)
    declared = scenario.declared.model_dump()
    actors = [a.model_dump() for a in scenario.actors]
    (case / "result.json").write_text(json.dumps({"case": "c1", "actors": actors, "collision": {"declared": declared}}))
    return tmp_path / "runs"


def rows(out):
    found = [[cell.strip() for cell in line.split("|")[1:-1]] for line in out.splitlines() if line.startswith("| ")]
    return {row[0]: row[1:] for row in found}


def test_our_player_is_near_and_sees_the_contact(runs, capsys):
    assert main([str(runs)]) == 0
    out = capsys.readouterr().out
    told = rows(out)["ours"]
    assert told[:3] == ["1 of 1", "3 of 3", "3 of 3"]
    assert float(told[4]) < 0.5
    assert "1 cases, 3 actors" in out
    assert "AssignRouteAction" in out


def test_a_judge_that_strays_is_named(runs, tmp_path, capsys):
    """It leaves all actors at the origin."""
    bodies = [(name, 0.0, 0.0, 0.0, 0.0, 1.4) for name in ("V1", "V2", "P1")]
    judge = make(tmp_path, log(*bodies, steps=200))
    assert main([str(runs), "--judge", "esmini", "--path", str(judge), "--cases"]) == 1
    out = capsys.readouterr().out
    assert rows(out)["esmini"][:2] == ["0 of 1", "0 of 3"]
    assert "esmini: c1 V1: " in out
    assert "esmini: c1: first contact" in out


def test_bends_are_no_straights():
    angle = np.linspace(0, 1.5, 60)
    bend = trajectory("V1", 20 * np.sin(angle), 20 - 20 * np.cos(angle), angle)
    ahead = trajectory("V1", np.arange(60) * 0.5, 0.0)
    assert not _away(bend, bend, 9.0)[1].any()
    assert _away(ahead, ahead, 9.0)[1].all()


def test_a_folder_without_runs_and_a_judge_that_is_not_there_are_told(tmp_path, capsys):
    assert main([str(tmp_path)]) == 2
    assert "no trajectories.csv beside a road.xodr" in capsys.readouterr().err
    assert main([str(tmp_path), "--judge", "esmini", "--path", "/no/such"]) == 2
    assert "'/no/such' is no program that can be run" in capsys.readouterr().err
