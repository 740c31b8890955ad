"""`make demo` is the first thing that anybody sees: what its reports tell is what its replays show."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

from flows import demo
from flows.case.run_case import run_case
from flows.case_files.case_folder import read_trajectories
from flows.case_files.find_cases import Case
from sgcad_core.config import load
from sgcad_core.formats.sumo.net_xml import parse_net

pytestmark = pytest.mark.slow
DEG = 57.29578


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    """Folders of the three cases under the default config."""
    out = tmp_path_factory.mktemp("demo")
    config = load("fused.yaml", ("tracker=none",))
    found = {}
    for source in sorted(p for p in demo.REPORTS.iterdir() if p.is_dir()):
        run_case(config, Case(source, source.name), out, "digest")
        found[source.name] = out / config.name / source.name
    return found


def rest_of(folder):
    """Where and how every actor ends: x, y (m), turn since the contact (degrees, counterclockwise)."""
    contact_s = json.loads((folder / "result.json").read_text())["collision"]["observed"]["t_s"]
    ends = {}
    for track in read_trajectories(folder / "trajectories.csv"):
        at = round(contact_s / 0.05)
        ends[track.actor] = track.x_m[-1], track.y_m[-1], (track.heading_rad[-1] - track.heading_rad[at]) * DEG
    return ends


def inside(polygon, x, y):
    odd = False
    for (x0, y0), (x1, y1) in zip(polygon, [*polygon[1:], polygon[0]], strict=True):
        if (y0 > y) != (y1 > y) and x < x0 + (y - y0) * (x1 - x0) / (y1 - y0):
            odd = not odd
    return odd


def test_v1_rotates_counterclockwise_and_rests_off_the_north_edge(shown):
    folder = shown["across-the-centerline"]
    assert "V1 rotated counterclockwise and came to rest off the north edge" in (folder / "report.txt").read_text()
    _, y, turn = rest_of(folder)["V1"]
    assert 10 < turn < 180
    assert y > 3.6  # one lane each way: the road's edge


def test_both_rest_in_the_intersection(shown):
    from lxml import etree

    folder = shown["left-turn-at-signal"]
    assert "Both vehicles came to rest in the intersection" in (folder / "report.txt").read_text()
    root = etree.parse(str(folder / "road.net.xml")).getroot()
    (shape,) = (j.get("shape") for j in root.iter("junction") if j.get("type") == "traffic_light")
    polygon = [tuple(map(float, point.split(","))) for point in shape.split()]
    around = [(x, y) for x in (-1.0, 0.0, 1.0) for y in (-1.0, 0.0, 1.0)]  # as for the account: within 1.5 m of it
    ends = rest_of(folder).values()
    assert all(any(inside(polygon, x + dx, y + dy) for dx, dy in around) for x, y, _ in ends)


def test_both_rest_facing_east_in_the_right_lane(shown):
    folder = shown["rear-end-on-arterial"]
    assert "came to final rest facing east in the right lane" in (folder / "report.txt").read_text()
    graph = parse_net((folder / "road.net.xml").read_text())
    rightmost = min(lane.shape[:, 1].mean() for edge in graph.edges.values() for lane in edge.lanes)
    for _, y, turn in rest_of(folder).values():
        assert abs(y - rightmost) < 0.8
        assert abs(turn) < 5


def test_the_demo_ends_with_three_pictures_and_two_commands(tmp_path, monkeypatch):
    monkeypatch.delenv("SGCAD_CONFIG")
    done = subprocess.run([sys.executable, "-m", "flows.demo", tmp_path / "out"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("Reads 3 crash reports in ")
    assert "configs/fused.yaml" in done.stdout
    assert done.stdout.count("as the report tells") == 3
    pictures = [line.strip() for line in done.stdout.splitlines() if line.endswith("picture.png")]
    assert [Path(p).is_file() for p in pictures] == [True] * 3
    assert [word in done.stdout.splitlines()[-2:][i] for i, word in enumerate(("sgcad run", "sgcad explain"))] == [
        True
    ] * 2
