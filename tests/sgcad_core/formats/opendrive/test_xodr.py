"""OpenDRIVE: checked, looked up."""

from __future__ import annotations

import math
import subprocess

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from sgcad_core import settings as paths
from sgcad_core.formats.opendrive.checks.check_control import lanes_of
from sgcad_core.formats.opendrive.checks.check_file import xodr_findings
from sgcad_core.formats.opendrive.checks.road_index import lane_index
from sgcad_core.formats.opendrive.geometry import Pose, arc_lengths_of, end_pose, hermite
from tests.sgcad_core.formats.road_samples import NAMED, compiled


def changed(name, change):
    root = etree.fromstring(compiled(name).xodr.encode())
    change(root)
    return etree.tostring(root).decode()


@pytest.mark.parametrize("name", NAMED)
def test_written_networks_have_no_findings(name):
    assert [f.line() for f in xodr_findings(compiled(name).xodr)] == []


@given(st.floats(-math.pi, math.pi), st.floats(0.5, 80), st.floats(-2.6, 2.6))
@settings(max_examples=100, deadline=None)
def test_the_cubic_begins_and_ends_in_its_poses(bearing, distance, turn):
    start = Pose(3.0, -2.0, 0.7)
    end = Pose(3 + distance * math.cos(bearing), -2 + distance * math.sin(bearing), 0.7 + turn)
    geometry = etree.Element("geometry", x="3", y="-2", hdg="0.7", length="1")
    poly = etree.SubElement(geometry, "paramPoly3", pRange="normalized")
    for name, value in zip(("aU", "bU", "cU", "dU", "aV", "bV", "cV", "dV"), hermite(start, end), strict=True):
        poly.set(name, repr(value))
    found = end_pose(geometry)
    assert math.dist(found[:2], end[:2]) < 1e-6
    assert abs(math.remainder(found.heading_rad - end.heading_rad, 2 * math.pi)) < 1e-6
    assert arc_lengths_of([geometry])[0] >= distance - 1e-6


@pytest.mark.parametrize("name", NAMED)
def test_roads_of_a_junction_are_named_by_the_roads_that_they_join(name):
    root = etree.fromstring(compiled(name).xodr.encode())
    names = {road.get("id"): road.get("name") for road in root.findall("road")}
    for road in root.findall("road"):
        if road.get("junction") != "-1":
            came, goes = (road.find(f"link/{side}").get("elementId") for side in ("predecessor", "successor"))
            assert road.get("name") == f"{names[came]} to {names[goes]}"


# ------------------------------------------------------------------ findings
def drop_stop_line_references(root):
    for signal in root.iterfind(".//signal"):
        for reference in signal.findall("reference"):
            signal.remove(reference)


def test_a_sign_whose_id_is_no_number_is_found():
    found = xodr_findings(changed("stop", lambda r: r.find(".//signal").set("id", "hub_3")))
    assert [(f.what, f.value) for f in found] == [("a signal's id is no number", "hub_3")]


def test_a_sign_that_leads_into_no_junction_is_found():
    def turn(root):
        sign = root.find(".//signal[@type='R1-1']")
        road = sign.getparent().getparent()
        for name in [j for j in root.iterfind("junction") if j.get("name") == "hub"]:
            for connection in name.findall("connection"):
                if connection.get("incomingRoad") == road.get("id"):
                    inner = root.find(f"road[@id='{connection.get('connectingRoad')}']")
                    name.remove(connection)
                    root.remove(inner)

    assert any("lead into no junction" in f.what for f in xodr_findings(changed("all_way_stop", turn)))


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda r: r.find("road").attrib.pop("length"), "length"),
        (lambda r: r.find("road").set("length", "-1"), "length"),
        (lambda r: r.find("road").set("length", "7"), "length is not that"),
        (lambda r: r.find("junction/connection").set("incomingRoad", "999"), "No match found for key"),
        (lambda r: r.find("junction/connection/laneLink").set("from", "-9"), "no lane of that road"),
        (lambda r: r.find("road/lanes//link/successor").set("id", "-9"), "a lane that is not there"),
        (lambda r: r.find("road[@junction='1']/planView/geometry").set("x", "9"), "a gap between two linked lanes"),
        (lambda r: r.find("road[@junction='1']/planView/geometry[paramPoly3]").set("length", "9"), "arc length"),
        (lambda r: r.find(".//signal").set("id", r.findall(".//signal")[1].get("id")), "Duplicate key"),
        (lambda r: r.find(".//signal").set("s", "900"), "stands beyond its road"),
        (lambda r: r.find(".//signal/validity").set("fromLane", "-9"), "lanes that are not there"),
        (lambda r: r.find(".//signal").remove(r.find(".//signal/validity")), "holds for no lane"),
        (lambda r: r.find(".//signal[@orientation='+']").set("orientation", "-"), "drive the other way"),
        (lambda r: r.find(".//signal/reference").set("elementId", "77"), "refers to no object"),
        (drop_stop_line_references, "a stop line belongs to no signal"),
        (lambda r: r.find(".//signal[reference]/validity").set("fromLane", "-2"), "lanes that no signal stops"),
        (lambda r: r.remove(r.find("controller")), "has no controller"),
        (lambda r: r.find("controller/control").set("signalId", "99"), "No match found for key"),
        (lambda r: r.find("junction/controller").set("id", "99"), "a controller that is not there"),
        (lambda r: r.find("junction").remove(r.find("junction/controller")), "belongs to no junction"),
        (lambda r: r.remove(r.find("junction")), "not in the file"),
        (lambda r: r.findall("road")[1].set("id", r.find("road").get("id")), "Duplicate key"),
        (lambda r: r.find("road[@junction='1']/planView/geometry").set("x", "500"), "gap"),
    ],
)
def test_every_fault_is_found(change, message):
    found = xodr_findings(changed("signal", change))
    assert any(message in f.what for f in found)


@pytest.mark.parametrize("text", ["", "rubbish", "<OpenDRIVE/>", "<net/>", "<!DOCTYPE a []><OpenDRIVE/>"])
def test_rubbish_is_a_finding(text):
    assert xodr_findings(text)


# ------------------------------------------------------------------ look-up
def test_the_index_knows_roads_lanes_and_lengths():
    index = lane_index(compiled("stop").xodr)
    entry = index.by_edge("N")
    assert index.by_edge("-N") is entry
    assert entry.lanes_at(0.0) == {-1, -2, 1, 2}
    assert entry.junction == "-1"
    assert index.fault(entry.id, -1, entry.length_m) == ""
    assert "beyond" in index.fault(entry.id, -1, entry.length_m + 1)
    assert "lanes: -2, -1, 1, 2" in index.fault(entry.id, -4, 1.0)
    assert "not in the .xodr" in index.fault("nowhere")
    assert index.by_edge("nowhere") is None
    assert (index.lane("N", 0), index.lane("N", 1), index.lane("-N", 0), index.lane("-N", 1)) == (
        (entry.id, -2), (entry.id, -1), (entry.id, 2), (entry.id, 1)
    )  # fmt: skip


QC = paths.ROOT / ".venv-qc" / "bin" / "python"


@pytest.mark.slow
@pytest.mark.skipif(not QC.exists(), reason="ASAM's checkers are not installed (make qc)")
def test_asams_checkers_find_nothing(tmp_path):
    for name in NAMED:
        (tmp_path / f"{name}.xodr").write_text(compiled(name).xodr, encoding="utf-8")
    command = [str(QC), str(paths.ROOT / "research" / "checks" / "asam_checkers.py"), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.mark.parametrize("odd", ["INF", "-INF", "nan", "1e400", "x"])
def test_a_lane_whose_number_is_none_is_no_traceback(odd):
    xodr = compiled("stop").xodr
    assert lane_index(xodr.replace('<lane id="-1"', f'<lane id="{odd}"')).roads.keys() == lane_index(xodr).roads.keys()


def test_a_signal_for_a_billion_lanes_takes_no_memory():
    told = etree.fromstring('<signal><validity fromLane="-1e300" toLane="1e300"/></signal>')
    assert len(lanes_of(told)) == 2000
