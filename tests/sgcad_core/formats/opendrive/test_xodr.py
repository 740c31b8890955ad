"""OpenDRIVE: mended, checked, looked up."""

from __future__ import annotations

import math
import subprocess

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lxml import etree

from sgcad_core import settings as paths
from sgcad_core.errors import InvalidOutput
from sgcad_core.formats.opendrive.geometry import Pose, arc_lengths_of, end_pose, hermite
from sgcad_core.formats.opendrive.mend import lane_index, mend, xodr_findings
from sgcad_core.formats.sumo.net_xml import parse_net
from tests.sgcad_core.formats.road_samples import NAMED, compiled


def changed(name, change):
    root = etree.fromstring(compiled(name).xodr.encode())
    change(root)
    return etree.tostring(root).decode()


# ------------------------------------------------------------------ mending
@pytest.mark.parametrize("name", NAMED)
def test_mended_networks_have_no_findings(name):
    assert [f.line() for f in xodr_findings(compiled(name).xodr)] == []


@pytest.mark.parametrize("name", NAMED)
def test_mending_twice_changes_nothing(name):
    assert mend(compiled(name).xodr) == compiled(name).xodr


def test_the_version_is_1_7():
    header = etree.fromstring(compiled("stop").xodr.encode()).find("header")
    assert (header.get("revMajor"), header.get("revMinor")) == ("1", "7")


def test_curves_get_their_arc_length_back():
    def spoil(root):
        for geometry in root.iterfind("road/planView/geometry[paramPoly3]"):
            geometry.set("length", f"{float(geometry.get('length')) * 1.01:.6f}")

    spoiled = changed("curve", spoil)
    assert any("arc length" in f.what for f in xodr_findings(spoiled))
    assert xodr_findings(mend(spoiled)) == []


def test_a_connector_that_misses_its_lanes_is_drawn_anew():
    def spoil(root):
        for geometry in root.xpath("road[@junction!='-1'][1]/planView/geometry[1]"):
            geometry.set("x", str(float(geometry.get("x")) + 0.5))

    spoiled = changed("signal", spoil)
    assert any("gap between two linked lanes" in f.what for f in xodr_findings(spoiled))
    assert xodr_findings(mend(spoiled)) == []


def test_links_to_what_is_not_there_are_dropped():
    def spoil(root):
        for link in root.xpath("road[@junction='-1']/link"):
            if link.find("predecessor") is None:
                etree.SubElement(link, "predecessor", elementType="junction", elementId="999")

    spoiled = changed("stop", spoil)
    assert xodr_findings(spoiled)
    assert xodr_findings(mend(spoiled)) == []


def test_objects_get_a_z_offset():
    def spoil(root):
        objects = root.find("road/objects")
        etree.SubElement(objects, "object", id="1", s="1", t="0", type="crosswalk")

    assert xodr_findings(changed("stop", spoil))
    assert xodr_findings(mend(changed("stop", spoil))) == []


def test_a_two_way_left_turn_lane_is_bidirectional():
    root = etree.fromstring(compiled("center_lane").xodr.encode())
    edge = root.xpath("road[userData/@value='E']")[0]
    types = {int(lane.get("id")): lane.get("type") for lane in edge.iterfind("lanes/laneSection/right/lane")}
    assert types == {-1: "bidirectional", -2: "driving", -3: "driving"}


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


def test_lane_centers_lie_where_sumo_has_them():
    graph = parse_net(compiled("signal").net_xml)
    root = etree.fromstring(compiled("signal").xodr.encode())
    for edge in graph.edges.values():
        plan = root.xpath(f"road[userData/@value='{edge.id}']/planView/geometry[1]")[0]
        heading = float(plan.get("hdg"))
        for lane in edge.lanes:
            t = -(len(edge.lanes) - lane.index - 0.5) * lane.width_m
            x, y = Pose(float(plan.get("x")), float(plan.get("y")), heading).left(t)
            assert np.allclose(lane.shape[0], (x, y), atol=0.01)


# ------------------------------------------------------------------ findings
@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda r: r.find("road").attrib.pop("length"), "length"),
        (lambda r: r.find("road").set("length", "-1"), "length"),
        (lambda r: r.find("road").set("length", "7"), "length is not that"),
        (lambda r: r.find("junction/connection").set("incomingRoad", "999"), "No match found for key"),
        (lambda r: r.find("junction/connection/laneLink").set("from", "-9"), "no lane of that road"),
        (lambda r: r.find("road/lanes//link/successor").set("id", "-9"), "a lane that is not there"),
        (lambda r: r.remove(r.find("junction")), "not in the file"),
        (lambda r: r.findall("road")[1].set("id", r.find("road").get("id")), "Duplicate key"),
        (lambda r: r.find("road/planView/geometry").set("x", "500"), "gap"),
    ],
)
def test_every_fault_is_found(change, message):
    found = xodr_findings(changed("signal", change))
    assert any(message in f.what for f in found)


@pytest.mark.parametrize("text", ["", "rubbish", "<OpenDRIVE/>", "<net/>", "<!DOCTYPE a []><OpenDRIVE/>"])
def test_rubbish_is_a_finding_for_the_checker_and_invalid_output_for_the_mender(text):
    assert xodr_findings(text)
    with pytest.raises(InvalidOutput, match=r"well-formed|no OpenDRIVE|entities"):
        mend(text)


# ------------------------------------------------------------------ look-up
def test_the_index_knows_roads_lanes_and_lengths():
    index = lane_index(compiled("signal").xodr)
    entry = index.by_edge("N")
    assert entry.lanes_at(0.0) == {-1, -2, -3}
    assert entry.junction == "-1"
    assert index.fault(entry.id, -1, entry.length_m) == ""
    assert "beyond" in index.fault(entry.id, -1, entry.length_m + 1)
    assert "lanes: -3, -2, -1" in index.fault(entry.id, -4, 1.0)
    assert "not in the .xodr" in index.fault("nowhere")
    assert index.by_edge("nowhere") is None


QC = paths.ROOT / ".venv-qc" / "bin" / "python"


@pytest.mark.slow
@pytest.mark.skipif(not QC.exists(), reason="ASAM's checkers are not installed (make qc)")
def test_asams_checkers_find_nothing(tmp_path):
    for name in NAMED:
        (tmp_path / f"{name}.xodr").write_text(compiled(name).xodr, encoding="utf-8")
    command = [str(QC), str(paths.ROOT / "deploy" / "qc.py"), str(tmp_path)]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
