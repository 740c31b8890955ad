"""`sgcad export` and `sgcad video` on a case that the product made: files, their content, errors."""

import pickle
import subprocess
import sys

import numpy as np
import pytest
from PIL import Image
from typer.testing import CliRunner

from flows.case.run_case import run_case
from flows.case_files.find_cases import cases_of
from flows.cli import app
from flows.export.film import film
from flows.export.finished_case import FinishedCase
from sgcad_core.config import load
from sgcad_core.errors import ConfigError, MissingTool
from sgcad_core.formats.openscenario.check import xosc_findings
from sgcad_core.formats.xml import parse_xml

REPORT = (
    "V1, a passenger car, was traveling east on Oak Street, a two-lane road, approaching a four-leg intersection "
    "controlled by stop signs on Oak Street. V2, a pickup truck, was traveling north on Elm Avenue at 35 mph. V1 "
    "failed to yield and entered the intersection. The front of V2 struck the right side of V1."
)


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A finished case, made once."""
    place = tmp_path_factory.mktemp("export")
    (place / "yield.txt").write_text(REPORT)
    (case,) = cases_of([place / "yield.txt"])
    ended = run_case(load("template.yaml", ("tracker=none",)), case, place / "runs", "made")
    assert ended.result["status"] == "generated"
    return place / "runs" / "template" / "yield"


def run(*arguments):
    return CliRunner().invoke(app, [*map(str, arguments)])


def exported(made, *arguments):
    ended = run("export", made, *arguments)
    assert ended.exit_code == 0, ended.output
    return ended.output.split()


def test_every_case_has_a_file_for_a_stack_beside_it(made):
    text = (made / "ego.xosc").read_text()
    assert xosc_findings(text, (made / "road.xodr").read_text()) == []
    assert "V2 (responder) is the ego" in text
    assert "<LanePosition" in text
    assert xosc_findings((made / "ego_carla.xosc").read_text(), (made / "road.xodr").read_text()) == []
    assert (made / "run_esmini.sh").stat().st_mode & 0o100


def test_scripts_that_start_the_players_are_sound(made):
    assert subprocess.run(["sh", "-n", made / "run_esmini.sh"], check=False).returncode == 0
    started = subprocess.run([sys.executable, made / "run_carla.py"], capture_output=True, text=True, check=False)
    assert "SCENARIO_RUNNER_ROOT" in started.stderr


def test_esmini_script_gives_the_ego_the_wanted_driver(made, tmp_path):
    player = tmp_path / "esmini"
    player.write_text("#!/bin/sh\ncat $2\n")
    player.chmod(0o755)
    about = {"ESMINI": str(player), "EGO": "ACCController", "PATH": "/usr/bin:/bin"}
    told = subprocess.run([made / "run_esmini.sh"], env=about, capture_output=True, text=True, check=True).stdout
    assert 'name="EgoController" parameterType="string" value="ACCController"' in told


def test_scenario_names_its_source_date_and_assumptions(made):
    text = (made / "scenario.xosc").read_text()
    header = parse_xml(text, "made").find("FileHeader")
    assert header.get("description").startswith("yield: V2 front strikes V1 right")
    assert not header.get("date").startswith("2000")
    assert "<!-- Assumed: roads.S.lanes_forward = 1 -->" in text


def test_config_may_name_another_ego_or_none(tmp_path):
    (tmp_path / "yield.txt").write_text(REPORT)
    (case,) = cases_of([tmp_path / "yield.txt"])
    for ego, there in (("initiator", "V1 (initiator)"), ("V9", None), ("none", None)):
        run_case(load("template.yaml", ("tracker=none", f"ego={ego}")), case, tmp_path / "runs", ego)
        file = tmp_path / "runs" / "template" / "yield" / "ego.xosc"
        assert (there in file.read_text()) if there else not file.exists()


def test_export_gives_the_asked_actor_to_the_stack(made):
    files = exported(made, "--ego", "V1")
    assert {f.rsplit("/", 1)[1] for f in files} == {"ego.xosc", "ego_carla.xosc", "run_esmini.sh", "run_carla.py"}
    folder = made / "export" / "ego" / "V1"
    assert "V1 (initiator) is the ego" in (folder / "ego.xosc").read_text()
    assert (folder / "road.xodr").read_text() == (made / "road.xodr").read_text()


def test_dsl_tells_actors_paths_and_movements_side_by_side(made):
    (file,) = exported(made, "--format", "dsl")
    text = (made / "export" / "dsl" / "yield.osc").read_text()
    assert file.endswith("yield.osc")
    assert "    v2: vehicle with:" in text
    assert "    do parallel:" in text
    assert "            v2_1: v2.drive(duration: 4." in text
    assert "# V1 right meets V2 front at 4.20 s." in text


def test_commonroad_file_has_a_problem_for_the_ego_and_the_others_as_obstacles(made):
    exported(made, "--format", "commonroad")
    root = parse_xml((made / "export" / "commonroad" / "yield.xml").read_text(), "made")
    assert root.get("commonRoadVersion") == "2020a"
    assert len(root.findall("planningProblem")) == len(root.findall("dynamicObstacle")) == 1
    lanelets = {one.get("id") for one in root.findall("lanelet")}
    assert {e.get("ref") for e in root.iter("successor", "predecessor", "adjacentLeft")} <= lanelets


def test_scenarionet_record_has_every_actor_the_map_and_the_ego(made):
    exported(made, "--format", "scenarionet")
    record = pickle.loads((made / "export" / "scenarionet" / "sd_sgcad_v1_yield.pkl").read_bytes())  # noqa: S301
    script = FinishedCase(made).script
    assert set(record["tracks"]) == {"V1", "V2"}
    assert record["metadata"]["sdc_id"] == "V2"
    assert record["tracks"]["V1"]["state"]["position"][:, :2] == pytest.approx(
        script.trajectories[0].points.astype(np.float32), abs=1e-4
    )
    assert any(feature["type"].startswith("LANE") for feature in record["map_features"].values())


def test_film_shows_the_whole_time_with_the_report_and_the_verdict(made, tmp_path):
    (file,) = film(made, tmp_path, ["gif"], 10)
    shots = Image.open(file)
    end = float(FinishedCase(made).script.trajectories[0].t_s[-1])
    assert shots.n_frames == pytest.approx(10 * end + 11, abs=12)  # equal pictures are joined
    first = np.asarray(shots.convert("RGB"))
    shots.seek(shots.n_frames - 1)
    assert (first != np.asarray(shots.convert("RGB"))).any()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("--format", "scenic"), "no such format; formats: ego, commonroad, dsl, scenarionet"),
        (("--ego", "V7"), "no actor 'V7'; it has V1, V2"),
        (("--openscenario", "2.0"), "versions: 1.0, 1.1, 1.2, 1.3"),
    ],
)
def test_wrong_wishes_are_named_with_what_there_is(made, arguments, said):
    ended = run("export", made, *arguments)
    assert isinstance(ended.exception, ConfigError)
    assert said in str(ended.exception)


def test_film_without_ffmpeg_says_what_to_install(made, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(MissingTool, match=r"sg-cadvlm\[video\]"):
        film(made, tmp_path, ["mp4"], 20)
