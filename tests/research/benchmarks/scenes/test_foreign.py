"""The benchmark of foreign files: which sets are played, which files are blind, what is told."""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pytest

from research.benchmarks.scenes import foreign
from research.benchmarks.scenes.foreign_judge import apart
from sgcad_core.formats.openscenario.reading.files import Variation, play_file
from tests.sgcad_core.formats.xosc_samples import scenario, world


@pytest.mark.parametrize(("count", "chosen"), [(1, [0]), (5, [0, 1, 2, 3, 4]), (101, [0, 25, 50, 75, 100])])
def test_first_last_and_some_between_are_played(count, chosen):
    assert foreign.chosen_sets(count) == chosen


def test_a_third_of_the_names_is_blind():
    share = np.mean([foreign.blind(Path(f"{i}.xosc")) for i in range(3000)])
    assert 0.28 < share < 0.39


def test_totals_name_what_is_refused(tmp_path, monkeypatch, capsys):
    (tmp_path / "a.xosc").write_text(scenario({"V1": world(0, 0)}))
    (tmp_path / "b.xosc").write_text(scenario({"V1": world(0, 0)}).replace("WorldPosition", "GeoPosition"))
    monkeypatch.setattr(sys, "argv", ["foreign", str(tmp_path), "--all"])
    foreign.main()
    out = capsys.readouterr().out
    assert "plays: 1 of 2, 1 of them with notes" in out
    assert "refused: 1 x <GeoPosition>" in out


def test_distance_from_the_judge_is_that_of_box_centers(tmp_path):
    file = tmp_path / "a.xosc"
    file.write_text(scenario({"V1": world(0, 0)}, speeds={"V1": 2}))
    played, _ = play_file(Variation(file, {}))
    t_s = np.arange(81) * 0.05
    judge = {"V1": np.column_stack((t_s, 2 * t_s, t_s * 0 + 0.5 * (t_s > 1.01), t_s * 0))}
    found = apart(played, judge, 0.05)
    assert found.worst_m == pytest.approx(0.5)
    assert found.first_s == pytest.approx(1.05)
    assert apart(played, {"V9": judge["V1"]}, 0.05) is None
