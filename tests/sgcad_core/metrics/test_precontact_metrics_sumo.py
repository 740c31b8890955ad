"""Our TTC and DRAC before a contact beside SUMO's SSM device, where that defines them: one follows another."""

import subprocess
import sys
import textwrap

import numpy as np
import pytest
from lxml import etree

from sgcad_core.formats.sumo.netconvert import compile_network
from sgcad_core.formats.sumo.plain_xml import plain_xml
from sgcad_core.metrics import conflict
from sgcad_core.metrics.conflict import required_deceleration
from sgcad_core.metrics.swept_cells import Track
from sgcad_core.records.specs import Leg, RoadLayout
from sgcad_core.roads.layout import road_spec

PROGRAM = """
import sys, libsumo
net, out = sys.argv[1:]
libsumo.start(["sumo", "-n", net, "--step-length", "0.05", "--collision.action", "none", "--no-step-log",
               "--no-warnings", "--default.speeddev", "0", "--device.ssm.explicit", "V1",
               "--device.ssm.measures", "TTC DRAC", "--device.ssm.thresholds", "3.0 1.0", "--device.ssm.range", "100",
               "--device.ssm.trajectories", "true", "--device.ssm.file", out])
libsumo.route.add("r", ["W"])
for name, pos, speed in (("V2", 70.0, 4.0), ("V1", 10.0, 12.0)):
    libsumo.vehicle.add(name, "r", departPos=str(pos), departSpeed=str(speed), departLane="0")
    libsumo.vehicle.setSpeedMode(name, 0)
    libsumo.vehicle.setSpeed(name, speed)
    libsumo.vehicle.setMaxSpeed(name, 40.0)
for _ in range(170):
    libsumo.simulationStep()
libsumo.close()
"""


def test_following_is_measured_as_sumos_ssm_device_does(tmp_path):
    spec = road_spec(RoadLayout(legs=tuple(Leg(bearing=b, lanes_in=1, lanes_out=1) for b in "EW")))
    net = tmp_path / "net.xml"
    net.write_text(compile_network(plain_xml(spec), spec).net_xml)
    out = tmp_path / "ssm.xml"
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(PROGRAM), net, out], capture_output=True, text=True)
    if not out.is_file():
        pytest.fail(done.stderr)
    found = etree.parse(str(out)).getroot().find("conflict")
    rows = {
        n: found.find(n).get("values").split()
        for n in ("timeSpan", "TTCSpan", "DRACSpan", "egoPosition", "foePosition", "egoVelocity", "foeVelocity")
    }
    compared = 0
    for k, ttc in enumerate(rows["TTCSpan"]):
        if ttc == "NA" or float(ttc) < 0.2:
            continue
        ours = measured(rows, k)
        assert ours[0] == pytest.approx(float(ttc), abs=0.02)
        assert ours[1] == pytest.approx(float(rows["DRACSpan"][k]), rel=0.03)
        compared += 1
    assert compared > 20


def measured(rows, k):
    """Ours at the same instant: boxes of 5 m by 1.8 m, SUMO's places are front bumpers."""
    tracks = []
    for who in ("ego", "foe"):
        x, y = (float(v) for v in rows[f"{who}Position"][k].split(","))
        vx, vy = (float(v) for v in rows[f"{who}Velocity"][k].split(","))
        heading = np.arctan2(vy, vx)
        pose = np.array([[x - 2.5 * np.cos(heading), y - 2.5 * np.sin(heading), heading]])
        tracks.append(Track(np.zeros(1), pose, np.array([[vx, vy]]), (5.0, 1.8)))
    ttc = conflict.time_to_collision(*tracks)
    return float(ttc[0]), float(required_deceleration(*tracks, ttc)[0])
