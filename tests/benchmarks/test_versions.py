"""The benchmark of versions: our files play alike at 1.0 to 1.3, and a version that does not is counted."""

from __future__ import annotations

import json

import pytest

from benchmarks import versions
from flows import store
from sgcad_core.execution.scenario import compile_scenario
from tests.sgcad_core.formats.xosc_samples import CROSSING, crossroads, trajectory


@pytest.fixture
def runs(tmp_path):
    scenario = compile_scenario(CROSSING, crossroads())
    case = tmp_path / "runs" / "c1"
    case.mkdir(parents=True)
    (case / "road.xodr").write_text(crossroads().xodr)
    store.write_trajectories(case / "trajectories.csv", scenario.planned)
    (case / "result.json").write_text(json.dumps({"actors": [a.model_dump() for a in scenario.actors]}))
    return tmp_path / "runs"


def test_our_files_play_alike_in_all_versions_and_encodings(runs, capsys):
    assert versions.main([str(runs)]) == 0
    out = capsys.readouterr().out
    timed = next(line.split("|") for line in out.splitlines() if line.startswith("| timed"))
    assert [cell.strip() for cell in timed[2:4]] == ["1 of 1", "0.000000"]
    assert float(timed[4]) < 0.1
    assert "| events | 1 of 1 | 0.000000 | - |" in out


def test_a_version_that_plays_otherwise_is_counted(runs, capsys, monkeypatch):
    write = versions.write_xosc

    def shifted(actors, moves, behavior, version="1.2", handover=None):
        move = moves[0].model_copy(update={"x_m": moves[0].x_m + 0.25 * (version == "1.0")})
        return write(actors, [move, *moves[1:]], behavior, version=version, handover=handover)

    monkeypatch.setattr(versions, "write_xosc", shifted)
    assert versions.main([str(runs)]) == 1
    assert "| timed | 0 of 1 | 0.250000 |" in capsys.readouterr().out


def test_motions_of_unlike_length_are_infinitely_apart():
    one = [trajectory("V1", [0.0, 1.0, 2.0], 0.0)]
    assert versions.most_m(one, [trajectory("V1", [0.0, 1.0], 0.0)]) == float("inf")
    assert versions.most_m(one, [trajectory("V1", [0.0, 1.0, 2.5], 0.0)]) == 0.5


def test_a_folder_without_runs_is_told(tmp_path, capsys):
    assert versions.main([str(tmp_path)]) == 2
    assert "no trajectories.csv beside a road.xodr" in capsys.readouterr().err
