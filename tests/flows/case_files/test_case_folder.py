"""The folder of a case appears whole or not at all, and keeps its stable form."""

import csv
import json
import math
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import settings as hypothesis_settings
from hypothesis import strategies as st

from flows.case_files import case_folder
from flows.case_files.case_folder import CaseFolder
from sgcad_core.case.records import (
    Attempt,
    CrashReport,
    Diagram,
    Finding,
    Generation,
    RoadNetwork,
    Scenario,
    Trajectory,
)
from sgcad_core.errors import ConfigError

ANGLE = st.floats(-7, 7)
PLACE = st.floats(-3000, 3000)


def fill(folder, status="generated"):
    (folder / "result.json").write_text(json.dumps({"status": status}))
    (folder / ".digest").write_text("d1")


def test_a_written_folder_is_finished_with_its_digest_alone(tmp_path):
    case = CaseFolder(tmp_path, "k", "c")
    with case.writing() as partial:
        fill(partial)
    assert case.finished("d1") == {"status": "generated"}
    assert case.finished("d2") is None
    assert [p.name for p in case.path.parent.iterdir()] == ["c"]


def test_results_are_for_their_user_alone_until_that_user_shares_them(tmp_path):
    case_folder.check_writable(tmp_path / "runs")
    case = CaseFolder(tmp_path / "runs", "k", "c")
    with case.writing() as partial:
        fill(partial)
    modes = {f.name: f.stat().st_mode & 0o777 for f in (case.out, case.path)}
    assert modes["runs"] == 0o700
    assert modes["c"] & 0o007 == 0


def test_a_write_that_fails_leaves_the_old_folder(tmp_path):
    case = CaseFolder(tmp_path, "k", "c")
    with case.writing() as partial:
        fill(partial)

    def spoil():
        with case.writing() as partial:
            fill(partial, "refused")
            raise OSError(28, "No space left on device")

    with pytest.raises(OSError, match="No space left"):
        spoil()
    assert case.finished("d1") == {"status": "generated"}
    assert [p.name for p in case.path.parent.iterdir()] == ["c"]


def test_a_new_folder_replaces_the_old_one_whole(tmp_path):
    case = CaseFolder(tmp_path, "k", "c")
    for name in ("old.txt", "new.txt"):
        with case.writing() as partial:
            fill(partial)
            (partial / name).write_text("x")
    assert sorted(p.name for p in case.path.iterdir()) == [".digest", "new.txt", "result.json"]
    assert [p.name for p in case.path.parent.iterdir()] == ["c"]


@pytest.mark.parametrize("damage", ["result.json", ".digest"])
def test_a_damaged_folder_is_not_finished(tmp_path, damage):
    case = CaseFolder(tmp_path, "k", "c")
    with case.writing() as partial:
        fill(partial)
    (case.path / damage).write_text("{")
    assert case.finished("d1") is None
    (case.path / damage).unlink()
    assert case.finished("d1") is None


def test_a_killed_writer_leaves_no_case_and_its_rest_is_cleared(tmp_path):
    code = (
        "import os, signal, sys; from pathlib import Path; from flows.case_files.case_folder import CaseFolder\n"
        "with CaseFolder(Path(sys.argv[1]), 'k', 'c').writing() as p:\n"
        "    (p / 'result.json').write_text('{}'); os.kill(os.getpid(), signal.SIGKILL)\n"
    )
    ended = subprocess.run([sys.executable, "-c", code, str(tmp_path)], cwd=case_folder.__file__.rsplit("/", 2)[0])
    assert ended.returncode == -9
    assert CaseFolder(tmp_path, "k", "c").finished("d1") is None
    assert case_folder.clear_partial(tmp_path / "k") == 1
    assert list((tmp_path / "k").iterdir()) == []


def test_the_unfinished_folder_of_a_living_process_is_left_alone(tmp_path):
    with CaseFolder(tmp_path, "k", "c").writing() as partial:
        assert case_folder.clear_partial(tmp_path / "k") == 0
        assert partial.is_dir()
        fill(partial)


def test_the_unfinished_folder_of_a_killed_process_goes_before_its_parent_asks_for_its_end(tmp_path):
    killed = subprocess.Popen([sys.executable, "-c", "import time; print(flush=True); time.sleep(600)"], stdout=-1)
    killed.stdout.readline()
    folder = tmp_path / "k" / f"{case_folder.PARTIAL}{killed.pid}-x"
    folder.mkdir(parents=True)
    assert case_folder.clear_partial(tmp_path / "k") == 0
    killed.kill()
    os.waitid(os.P_PID, killed.pid, os.WEXITED | os.WNOWAIT)
    assert case_folder.clear_partial(tmp_path / "k") == 1
    killed.communicate()


def test_an_output_folder_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "out").write_text("a file")
    with pytest.raises(ConfigError, match=r"--out .*/out: cannot be written"):
        case_folder.check_writable(tmp_path / "out")


def test_a_file_system_that_takes_no_folder_is_refused():
    with pytest.raises(ConfigError, match="--out /proc/sgcad: cannot be written"):
        case_folder.check_writable(Path("/proc/sgcad"))


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write anywhere")
def test_an_output_folder_without_permission_is_refused(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(ConfigError, match=r"cannot be written \(Permission denied"):
        case_folder.check_writable(tmp_path / "out")


def test_a_nearly_full_disk_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(case_folder, "MIN_FREE_MB", 2**40)
    with pytest.raises(ConfigError, match=r"MB free, .* are needed; free some or choose another disk"):
        case_folder.check_writable(tmp_path)


def test_a_tracker_is_noted_once_and_apart_from_others(tmp_path):
    case = CaseFolder(tmp_path, "k", "c")
    with case.writing() as partial:
        fill(partial)
    assert not case.tracked("mlflow {}")
    case.mark_tracked("mlflow {}")
    assert case.tracked("mlflow {}")
    assert not case.tracked("jsonl {}")


# ------------------------------------------------------------------ files
@given(st.lists(st.tuples(PLACE, PLACE, ANGLE, st.floats(0, 60)), min_size=1, max_size=40))
@hypothesis_settings(max_examples=40, deadline=None)
def test_trajectories_keep_a_tenth_of_a_millimetre(tmp_path_factory, rows):
    file = tmp_path_factory.mktemp("csv") / "trajectories.csv"
    values = np.array(rows)
    t = np.arange(len(rows)) * 0.05
    columns = dict(zip(("x_m", "y_m", "heading_rad", "speed_mps"), values.T, strict=True))
    case_folder.write_trajectories(file, [Trajectory(actor=actor, t_s=t, **columns) for actor in ("V2", "V1")])
    read = list(csv.DictReader(file.open()))
    assert list(read[0]) == ["t_s", "actor", "x_m", "y_m", "heading_rad", "speed_mps"]
    assert [r["actor"] for r in read] == ["V2", "V1"] * len(rows)
    mine = [r for r in read if r["actor"] == "V1"]
    assert [float(r["t_s"]) for r in mine] == pytest.approx(list(t), abs=1e-9)
    for row, (x, y, heading, speed) in zip(mine, rows, strict=True):
        assert float(row["x_m"]) == pytest.approx(x, abs=1e-6)
        assert float(row["y_m"]) == pytest.approx(y, abs=1e-6)
        assert float(row["heading_rad"]) == pytest.approx(heading, abs=1e-6)
        assert float(row["speed_mps"]) == pytest.approx(speed, abs=1e-4)


def test_every_attempt_has_its_folder(tmp_path):
    findings = (Finding(source="xsd", what="no lane", where="edge a", value="0", remedy="add a lane"),)
    generation = Generation(text="{}", grounding={"$.a": 0.5}, prompt_tokens=7, model_calls=1, seconds=1.5)
    one = Attempt(stage="road", number=1, prompt="p", answer="a\ud800", findings=findings, generation=generation)
    case_folder.write_attempts(tmp_path, [one, Attempt(stage="scenario", number=10)])
    assert sorted(p.name for p in (tmp_path / "attempts").iterdir()) == ["road-01", "scenario-10"]
    road = tmp_path / "attempts" / "road-01"
    assert (road / "prompt.txt").read_text() == "p"
    assert (road / "answer.txt").read_text() == "a?"
    assert json.loads((road / "findings.json").read_text())[0]["remedy"] == "add a lane"
    assert json.loads((road / "attempt.json").read_text())["generation"]["grounding"] == {"$.a": 0.5}


def test_a_report_that_could_not_be_read_leaves_an_empty_text(tmp_path):
    case_folder.write_report(tmp_path, None)
    assert (tmp_path / "report.txt").read_text() == ""


def test_all_diagrams_are_kept(tmp_path):
    diagrams = tuple(Diagram(png=bytes([n]), width_px=1, height_px=1) for n in (1, 2))
    case_folder.write_report(tmp_path, CrashReport(case="c", narrative="n", diagrams=diagrams))
    assert [(tmp_path / name).read_bytes() for name in ("diagram.png", "diagram-2.png")] == [b"\x01", b"\x02"]


def test_only_what_was_compiled_is_written(tmp_path):
    case_folder.write_network(tmp_path, RoadNetwork(net_xml="<net/>"))
    case_folder.write_scenario(tmp_path, Scenario(routes_xml="<routes/>", actors=()))
    assert sorted(p.name for p in tmp_path.iterdir()) == ["road.net.xml", "scenario.rou.xml"]


def test_json_that_strict_readers_refuse_is_not_written(tmp_path):
    with pytest.raises(ValueError, match="JSON compliant"):
        case_folder.write_json(tmp_path / "x.json", {"ttc": math.inf})
