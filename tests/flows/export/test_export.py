"""`sgcad export` and `sgcad video` on a case that the product made: files, their content, errors."""

import itertools
import json
import pickle
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest
import sumo
from PIL import Image
from typer.testing import CliRunner

from flows.case.run_case import run_case
from flows.case_files.case_folder import read_trajectories
from flows.case_files.find_cases import cases_of
from flows.cli import app
from flows.export.film import SIDE, Shots, film
from flows.export.finished_case import FinishedCase
from flows.player.player_page import DATA
from sgcad_core.config import load
from sgcad_core.errors import ConfigError, MissingTool, NoTraffic
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


def test_esmini_script_names_the_missing_binary(made):
    ended = subprocess.run(["sh", made / "run_esmini.sh"], env={"ESMINI": "/no/such", "PATH": "/usr/bin:/bin"},
                           capture_output=True, text=True, check=False)  # fmt: skip
    assert ended.returncode == 127
    assert "/no/such: no esmini there; name its binary: ESMINI=/path/to/esmini" in ended.stderr


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


@pytest.mark.slow
def test_film_shows_the_whole_time_with_the_report_and_the_verdict(made, tmp_path):
    (file,) = list(film(made, tmp_path, ["gif"], 10))
    shots = Image.open(file)
    end = float(FinishedCase(made).script.trajectories[0].t_s[-1])
    assert shots.n_frames == pytest.approx(10 * end + 11, abs=12)  # equal pictures are joined
    first = np.asarray(shots.convert("RGB"))
    shots.seek(shots.n_frames - 1)
    assert (first != np.asarray(shots.convert("RGB"))).any()


def test_film_writes_names_beside_the_vehicles_even_where_they_touch(made):
    shots = Shots(FinishedCase(made))
    contact = shots.case.result["collision"]["observed"]
    at = shots.name_places(contact["t_s"])
    tracks = {track.actor: track for track in shots.case.script.trajectories}
    row = round(contact["t_s"] / 0.05)
    for name, other in (("V1", "V2"), ("V2", "V1")):
        x, y = shots._pixel(*tracks[other].points[row])
        own = shots._pixel(*tracks[name].points[row])
        assert np.hypot(at[name][0] - x, at[name][1] - y) > np.hypot(own[0] - x, own[1] - y)


def test_film_tells_the_verdict_in_all_lines_that_there_are_and_says_where_it_is_cut(made):
    shots = Shots(FinishedCase(made))
    assert " ".join(shots.verdict_lines) == shots.case.result["account"]["sentence"]
    shots.case.result["account"]["sentence"] = "much is not there; " * 60
    assert len(shots.verdict_lines) > 4
    assert shots.verdict_lines[-1].endswith("...")


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


def encoder(file, size, **_):
    """In the place of ffmpeg: each picture is written at once."""
    with open(file, "wb") as out:
        while True:
            out.write((yield) or b"")
            out.flush()


@pytest.mark.parametrize("kind", ["mp4", "gif"])
def test_film_that_is_cut_short_leaves_the_old_one_as_it_was(made, tmp_path, monkeypatch, kind):
    (old := tmp_path / f"crash.{kind}").write_bytes(b"old")
    whole = Shots.frames

    def cut(self, fps):
        yield from itertools.islice(whole(self, fps), 3)
        assert old.read_bytes() == b"old"  # so a kill at this time would leave it too
        raise KeyboardInterrupt

    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", SimpleNamespace(write_frames=encoder))
    monkeypatch.setattr(Shots, "frames", cut)
    with pytest.raises(KeyboardInterrupt):
        list(film(made, tmp_path, [kind], 10))
    assert old.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [old]
    monkeypatch.setattr(Shots, "frames", lambda self, fps: itertools.islice(whole(self, fps), 3))
    assert list(film(made, tmp_path, [kind], 10)) == [old]
    assert len(old.read_bytes()) > 1000


def test_film_without_ffmpeg_says_what_to_install(made, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    with pytest.raises(MissingTool, match=r"sg-cadvlm\[video\]"):
        list(film(made, tmp_path, ["mp4"], 20))


def test_film_without_ffmpeg_is_a_gif_where_no_format_is_asked_for(made, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    monkeypatch.setattr(Shots, "frames", lambda self, fps: itertools.repeat(self._ground, 2))
    ended = run("video", made, "--out", tmp_path)
    assert ended.exit_code == 0, ended.output
    assert [file.name for file in tmp_path.iterdir()] == ["crash.gif"]
    assert "no mp4: ffmpeg is not installed; pip install" in ended.output


# ------------------------------------------------------------------ traffic
def test_traffic_stands_in_every_file_of_its_folder_and_the_case_stays(made):
    before = {f.name: f.read_bytes() for f in made.iterdir() if f.is_file()}
    files = {f.rsplit("/", 1)[1] for f in exported(made, "--traffic", "light", "--ego", "V2")}
    folder = made / "export" / "traffic" / "light"
    assert files == {f.name for f in folder.iterdir()}
    told = json.loads((folder / "traffic.json").read_text())
    names = {vehicle["id"] for vehicle in told["vehicles"]}
    assert names
    assert {t.actor for t in read_trajectories(folder / "trajectories.csv")} == {"V1", "V2"}
    assert {t.actor for t in read_trajectories(folder / "trajectories.csv", "traffic")} == names
    for name in ("scenario.xosc", "ego.xosc", "ego_carla.xosc"):
        text = (folder / name).read_text()
        assert xosc_findings(text, (folder / "road.xodr").read_text()) == []
        assert {o.get("name") for o in parse_xml(text, name).iterfind("Entities/ScenarioObject")} >= names
    routes = parse_xml((folder / "traffic.rou.xml").read_text(), "routes")
    assert {v.get("id") for v in routes.iterfind("vehicle")} == names
    page = json.loads(DATA.search((folder / "player.html").read_text())[1])
    assert ({v["id"] for v in page["traffic"]}, {a["id"] for a in page["actors"]}) == (names, {"V1", "V2"})
    assert {f.name: f.read_bytes() for f in made.iterdir() if f.is_file()} == before


def test_sumo_runs_the_routes_of_the_traffic(made, tmp_path):
    exported(made, "--traffic", "light")
    folder = made / "export" / "traffic" / "light"
    count = len(json.loads((folder / "traffic.json").read_text())["vehicles"])
    program = [f"{sumo.SUMO_HOME}/bin/sumo", "-n", folder / "road.net.xml", "-r", folder / "traffic.rou.xml"]
    done = subprocess.run(
        [*program, "--tripinfo-output", tmp_path / "trips.xml"], env={"SUMO_HOME": sumo.SUMO_HOME}, check=False
    )
    assert done.returncode == 0
    assert (tmp_path / "trips.xml").read_text().count("<tripinfo ") == count


def test_traffic_of_the_ego_file_begins_with_the_others_and_comes_to_a_stand(made):
    exported(made, "--traffic", "light", "--ego", "V2")
    root = parse_xml((made / "export" / "traffic" / "light" / "ego.xosc").read_text(), "made")
    declared = [p.get("name") for p in root.iterfind("ParameterDeclarations/ParameterDeclaration")]
    assert declared.count("traffic_TimeScale") == 1
    events = {e.get("name"): e for e in root.iter("Event")}
    moving = next(name for name in events if name.startswith("traffic"))
    conditions = [len(e.findall(".//StartTrigger//Condition")) for e in (events["V1_comes"], events[moving])]
    assert conditions[0] == conditions[1] > 1
    ends = [float(v.get("x")) for v in events[moving].iterfind(".//Vertex/Position/WorldPosition")][-2:]
    assert abs(ends[1] - ends[0]) < 2.0


def test_no_such_density_is_named(made):
    ended = run("export", made, "--traffic", "heavy")
    assert isinstance(ended.exception, ConfigError)
    assert "--traffic heavy: no such density; densities: light, dense, none" in str(ended.exception)


def test_a_config_may_ask_for_traffic_and_the_crash_is_judged_without_it(made, tmp_path):
    (tmp_path / "yield.txt").write_text(REPORT)
    (case,) = cases_of([tmp_path / "yield.txt"])
    ended = run_case(load("template.yaml", ("tracker=none", "traffic=light")), case, tmp_path / "runs", "with")
    plain = json.loads((made / "result.json").read_text())
    for same in ("actors", "collision", "account", "rules", "impact"):
        assert ended.result[same] == plain[same], same
    folder = tmp_path / "runs" / "template" / "yield"
    one, two = (json.loads((f / "metrics.json").read_text()) for f in (folder, made))
    assert one == two
    assert len(ended.result["traffic"]["vehicles"]) == len(FinishedCase(folder).background) > 0
    assert {t.actor for t in FinishedCase(folder).script.trajectories} == {"V1", "V2"}
    assert "traffic1" in (folder / "scenario.xosc").read_text()
    assert "traffic1" in (folder / "ego.xosc").read_text()
    count = len(ended.result["traffic"]["vehicles"])
    exported(folder, "--format", "scenarionet,commonroad")
    record = pickle.loads((folder / "export" / "scenarionet" / "sd_sgcad_v1_yield.pkl").read_bytes())  # noqa: S301
    assert len(record["tracks"]) == 2 + count
    root = parse_xml((folder / "export" / "commonroad" / "yield.xml").read_text(), "made")
    assert len(root.findall("dynamicObstacle")) == 1 + count
    exported(folder, "--traffic", "dense")  # in the place of the light one
    assert "<!-- Source" in (folder / "export" / "traffic" / "dense" / "scenario.xosc").read_text()


@pytest.fixture(scope="module")
def among(tmp_path_factory):
    """The same case with traffic."""
    place = tmp_path_factory.mktemp("among")
    (place / "yield.txt").write_text(REPORT)
    (case,) = cases_of([place / "yield.txt"])
    run_case(load("template.yaml", ("tracker=none", "traffic=light")), case, place / "runs", "with")
    return place / "runs" / "template" / "yield"


GRAY = (0xC9, 0xCF, 0xD4)
"""The color of traffic in pictures (`TRAFFIC_COLOR`)."""


def gray(picture):
    return int((np.abs(np.asarray(picture.convert("RGB")).astype(int) - GRAY).max(axis=2) <= 2).sum())


def test_picture_and_film_show_the_traffic_and_only_on_the_map(made, among):
    assert gray(Image.open(made / "picture.png")) < 20  # smooth letters have some gray
    assert gray(Image.open(among / "picture.png")) > 100
    shots = Shots(FinishedCase(among))
    seen = [gray(shot.crop((0, 0, SIDE, SIDE))) for shot in itertools.islice(shots.frames(1), 6)]
    assert max(seen) > 100
    beside = [gray(shot.crop((SIDE, 0, *shot.size))) for shot in itertools.islice(shots.frames(1), 6)]
    plain = next(Shots(FinishedCase(made)).frames(1))
    assert max(beside) <= gray(plain.crop((SIDE, 0, *plain.size))) + 5


def test_a_drive_replays_the_traffic_and_tells_whom_the_ego_touches(among):
    assert run("drive", among, "--driver", "aeb").exit_code == 0
    count = len(FinishedCase(among).background)
    for file in among.glob("drive/aeb/*/drive.json"):
        told = json.loads(file.read_text())["traffic"]
        assert told["vehicles"] == count
        assert set(told["touched"]) <= {info.id for info, _ in FinishedCase(among).background}
        page = (file.parent / "drive.html").read_text()
        assert '"traffic1"' in page
        assert f"Gray: {count} vehicles of traffic, replayed" in page
        assert ('"doubt": true' in page or '"doubt":true' in page) == bool(told["touched"])


def test_what_leaves_the_traffic_out_says_so(among):
    count = len(FinishedCase(among).background)
    exported(among, "--format", "dsl")
    told = (among / "export" / "dsl" / "yield.osc").read_text()
    assert f"# left out: {count} vehicles of the traffic around the crash" in told
    ended = run("vary", among, "-n", "1")
    assert f"the {count} vehicles of its traffic are left out" in ended.output
    assert json.loads((among / "vary" / "seed-1" / "manifest.json").read_text())["traffic_left_out"] == count


def test_where_there_is_no_room_the_case_stays_and_says_so(tmp_path):
    (tmp_path / "lot.txt").write_text(
        "The crash occurred in a parking lot. V1, a car, was traveling eastbound in an aisle. V2, a car, was traveling "
        "northbound in the parking lot. The front of V1 struck the left side of V2."
    )
    (case,) = cases_of([tmp_path / "lot.txt"])
    ended = run_case(load("template.yaml", ("tracker=none", "traffic=light")), case, tmp_path / "runs", "lot")
    assert ended.result["status"] == "generated"
    assert "the network has no lane for traffic" in ended.result["traffic"]["lacks"]
    assert (tmp_path / "runs" / "template" / "lot" / "player.html").exists()
    told = run("export", tmp_path / "runs" / "template" / "lot", "--traffic", "light")
    assert isinstance(told.exception, NoTraffic)
