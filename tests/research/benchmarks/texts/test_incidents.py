"""Incident reports are split by hash, scored by what moves, and a success without the told contact is counted."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pytest

from research.benchmarks.texts import incidents
from research.benchmarks.texts.incident_scores import Run, false_success, scores
from research.benchmarks.texts.incidents import table, write_cases
from research.rows.coded_incidents import Incident, is_blind, of_dev, of_pool

TRUTH: dict[str, Any] = {
    "contact": True,
    "subject": {"manoeuvre": "stopped", "areas": ["back_left"], "speed_mph": 0.0},
    "other": {"kind": "vehicle", "manoeuvre": "straight", "areas": ["front"]},
    "road": {"intersection": None},
}


def write_run(folder: Path, reach_m: float, status: str = "generated") -> None:
    """V1 stands at the origin, heading east; V2 comes from the west up to `reach_m`."""
    folder.mkdir(parents=True)
    rows = ["t_s,actor,x_m,y_m,heading_rad,speed_mps"]
    for step in range(60):
        x = min(-20 + 0.5 * step, reach_m)
        rows += [f"{0.05 * step:.2f},V1,0,0,0,0", f"{0.05 * step:.2f},V2,{x:.3f},0,0,{10.0 if x < reach_m else 0.0}"]
    (folder / "trajectories.csv").write_text("\n".join(rows) + "\n")
    actors = [{"id": v, "type": "car", "length_m": 4.7, "width_m": 1.8, "maneuver": "straight"} for v in ("V1", "V2")]
    (folder / "result.json").write_text(json.dumps({"status": status, "actors": actors}))


def scored(folder: Path, **changed: Any) -> Mapping[str, bool]:
    return scores(Run.of(folder), TRUTH | changed)


def test_a_rear_end_crash_as_coded_is_whole(tmp_path: Path) -> None:
    write_run(tmp_path / "a", -4.5)
    found = scored(tmp_path / "a")
    assert found == dict.fromkeys(
        ("generated", "actors", "contact", "subject_manoeuvre", "other_manoeuvre", "areas", "whole"), True
    )
    assert not false_success(Run.of(tmp_path / "a"), TRUTH)


def test_who_never_arrives_is_a_false_success_unless_refused(tmp_path: Path) -> None:
    write_run(tmp_path / "a", -8.0)
    write_run(tmp_path / "b", -8.0, status="exhausted")
    assert scored(tmp_path / "a")["contact"] is False
    assert [false_success(Run.of(tmp_path / name), TRUTH) for name in "ab"] == [True, False]


@pytest.mark.parametrize(
    ("changed", "measure"),
    [
        ({"other": TRUTH["other"] | {"kind": "cyclist"}}, "actors"),
        ({"other": TRUTH["other"] | {"areas": ["left"]}}, "areas"),
        ({"other": TRUTH["other"] | {"manoeuvre": "backing"}}, "other_manoeuvre"),
        ({"subject": TRUTH["subject"] | {"manoeuvre": "straight"}}, "subject_manoeuvre"),
        ({"subject": TRUTH["subject"] | {"manoeuvre": "turn_left"}}, "subject_manoeuvre"),
        ({"contact": False}, "contact"),
        ({"road": {"intersection": True}}, "intersection"),
    ],
)
def test_another_code_is_missed(tmp_path: Path, changed: dict[str, Any], measure: str) -> None:
    write_run(tmp_path / "a", -4.5)
    found = scored(tmp_path / "a", **changed)
    assert found[measure] is False
    assert found["whole"] is False


def test_a_case_that_left_nothing_counts_as_wrong(tmp_path: Path) -> None:
    found = scored(tmp_path / "none")
    assert not any(found.values())


def test_the_pool_is_split_by_hash_and_sampled_among_the_seen(tmp_path: Path) -> None:
    ids = [f"made-{n}" for n in range(60)]
    (tmp_path / "pool.jsonl").write_text("\n".join(json.dumps({"id": i, "text": "x", **TRUTH}) for i in ids))
    blind = {i for i in ids if is_blind(i)}
    assert 3 <= len(blind) <= 20
    found = of_pool(tmp_path / "pool.jsonl", 7)
    assert {i.id for i in found if i.group == "blind"} == blind
    assert sum(i.group == "seen" for i in found) == 7


def test_the_table_names_groups_and_no_report(tmp_path: Path) -> None:
    incidents_made = [Incident("made-1", "x", TRUTH, "blind"), Incident("made-2", "x", TRUTH, "blind")]
    write_run(tmp_path / "made-1", -4.5)
    write_run(tmp_path / "made-2", -8.0)
    (line,) = table(incidents_made, tmp_path)
    assert line.startswith("blind made: generated 1.000 (2), actors 1.000 (2), contact 0.500 (2)")
    assert line.endswith("2 generated; false success 1")
    assert "made-1" not in line


def test_reports_without_an_account_are_left_out_of_a_second_line(tmp_path: Path) -> None:
    made = [Incident("made-1", "x", TRUTH, "dev"), Incident("made-2", "x", TRUTH, "dev")]
    write_run(tmp_path / "made-1", -4.5)
    (tmp_path / "made-2").mkdir()
    refused = {
        "status": "refused",
        "reason": "road: the text gives no account of the crash, only what it says of itself",
    }
    (tmp_path / "made-2" / "result.json").write_text(json.dumps(refused))
    whole, telling = table(made, tmp_path)
    assert whole.startswith("dev made: generated 0.500 (2)")
    assert telling.startswith("dev made with an account: generated 1.000 (1)")


def test_cases_are_written_and_scored_by_the_command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "cases" / "made-1").mkdir(parents=True)
    (tmp_path / "cases" / "made-1" / "report.txt").write_text("A van hit the test vehicle.")
    (tmp_path / "truth").mkdir()
    (tmp_path / "truth" / "made-1.json").write_text(json.dumps(TRUTH))
    assert [i.group for i in of_dev(tmp_path / "cases", tmp_path / "truth")] == ["dev"]
    out = tmp_path / "out"
    write_run(out / "runs" / "template" / "made-1", -4.5)
    arguments = ["x", "--dev", str(tmp_path / "cases"), str(tmp_path / "truth"), "--out", str(out), "--score-only"]
    monkeypatch.setattr("sys.argv", arguments)
    incidents.main()
    assert "dev made: generated 1.000 (1)" in capsys.readouterr().out
    assert (out / "cases" / "made-1" / "report.txt").read_text() == "A van hit the test vehicle."


def test_without_cases_the_command_says_what_to_give(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.argv", ["x", "--out", str(tmp_path)])
    with pytest.raises(SystemExit, match="2"):
        incidents.main()


def test_writing_cases_writes_the_text_alone(tmp_path: Path) -> None:
    write_cases([Incident("made-1", "A van.", TRUTH, "seen")], tmp_path)
    assert [f.name for f in (tmp_path / "made-1").iterdir()] == ["report.txt"]
