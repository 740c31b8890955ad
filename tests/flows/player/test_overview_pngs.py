"""The player and the picture: what they hold, and that nothing in a report becomes code."""

import io
import json
import re
import shutil
import subprocess

import numpy as np
import pytest
from PIL import Image

from flows.player import overview_png, player_page
from flows.player.player_data import View, label_color
from flows.player.road_shapes import drawing_of
from sgcad_core.case.records import (
    ActorInfo,
    Attempt,
    CrashReport,
    Diagram,
    Execution,
    Generation,
    ObservedContact,
    RoadNetwork,
    Scenario,
    StageOutcome,
    Trajectory,
)
from sgcad_core.errors import InvalidOutput
from sgcad_core.records.specs import BehaviorSpec, Contact
from sgcad_core.result import CaseRecord, result_of

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
NET = """<net>
<edge id="a" from="w" to="m"><lane id="a_0" index="0" speed="13.9" length="100" shape="-100,-4.8 0,-4.8"/>
<lane id="a_1" index="1" speed="13.9" length="100" shape="-100,-1.6 0,-1.6"/></edge>
<edge id="b" from="m" to="e"><lane id="b_0" index="0" speed="13.9" length="100" shape="8,-1.6 100,-1.6"/></edge>
<junction id="w" type="dead_end" x="-100" y="0" shape="-100,0 -100,-3.2"/>
<junction id="m" type="traffic_light" x="4" y="0" shape="0,3.2 0,-6.4 8,-3.2 8,3.2"/>
<junction id="e" type="dead_end" x="100" y="0" shape="100,0 100,-3.2"/>
<connection from="a" to="b" fromLane="1" toLane="0" tl="m" linkIndex="0" dir="s" state="o"/></net>"""
EVIL = "V1 struck Vehicle #2.</script><script>document.title='stolen'</script> <b>&amp;"


def png(color):
    out = io.BytesIO()
    Image.new("RGB", (40, 30), color).save(out, format="PNG")
    return out.getvalue()


def track(actor, x0, speed, n=120):
    t = np.arange(n) * 0.05
    x = x0 + np.minimum(speed * t, 40)
    still = {"y_m": np.full(n, -1.6), "heading_rad": np.zeros(n), "speed_mps": np.full(n, speed)}
    return Trajectory(actor=actor, t_s=t, x_m=x, **still)


def view(contact=True, narrative="V1 struck V2.", case="c1", grounding=None):
    infos = tuple(
        ActorInfo(id=a, type=kind, length_m=4.7, width_m=1.8, maneuver=m)
        for a, kind, m in (("V1", "car", "straight"), ("V2", "truck", "stopped"), ("P1", "pedestrian", "other"))
    )
    declared = Contact(striker="V1", struck="V2", striker_area="front", struck_area="back")
    behavior = BehaviorSpec.model_construct(light="day", weather=None, surface="wet")
    scenario = Scenario(xosc="<x/>", actors=infos, declared=declared, behavior=behavior)
    observed = ObservedContact(actor="V1", other="V2", actor_area="front", other_area="back", t_s=3.6)
    tracks = (track("V1", -40, 10), track("V2", 0.5, 0), track("P1", 20, 1))
    execution = Execution(simulator="kinematic", trajectories=tracks, contact=observed if contact else None)
    generation = Generation(text="{}", grounding=grounding or {})
    attempt = Attempt(stage="road", number=1, generation=generation)
    outcomes = {
        "road": StageOutcome(stage="road", status="written", artifact=RoadNetwork(net_xml=NET), attempts=(attempt,)),
        "scenario": StageOutcome(stage="scenario", status="written", artifact=scenario),
    }
    report = CrashReport(case=case, narrative=narrative, diagrams=(Diagram(png=png("red"), width_px=40, height_px=30),))
    record = CaseRecord(case, "template", outcomes, execution, seconds={"road": 0.5})
    return View.of(record, report, {"paper": {"time_to_collision_s": 0.4}, "exact": {}}, result_of(record))


def data_of(page):
    (block,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL)
    return json.loads(block)


def test_the_page_holds_everything_and_asks_the_network_for_nothing():
    page = player_page.page(view())
    assert not re.findall(r'(?:src|href)="(?!data:)', page)
    assert not re.findall(r"https?://", page)
    data = data_of(page)
    assert [a["id"] for a in data["actors"]] == ["V1", "V2", "P1"]
    assert len({a["color"] for a in data["actors"]}) == 3
    assert len(data["actors"][0]["x"]) == len(data["t_s"]) == 120
    assert data["collision"]["observed"]["x"] == pytest.approx(-1.8, abs=0.4)
    assert data["diagrams"][0].startswith("data:image/png;base64,")
    assert data["conditions"] == {"light": "day", "surface": "wet"}
    assert data["metrics"]["paper"]["time_to_collision_s"] == 0.4


def test_a_page_is_small():
    assert len(player_page.page(view())) < 300_000


def test_nothing_in_a_report_becomes_markup():
    page = player_page.page(view(narrative=EVIL, case="<img src=x onerror=alert(1)>"))
    assert page.count("</script>") == 2
    assert "<img src=x" not in page
    assert data_of(page)["narrative"] == EVIL


def test_slots_of_the_page_cannot_be_filled_from_a_report():
    page = player_page.page(view(narrative="/*SCRIPT*/ %DATA% /*STYLE*/", case="%DATA%"))
    assert data_of(page)["narrative"] == "/*SCRIPT*/ %DATA% /*STYLE*/"


def test_an_execution_without_contact_has_no_contact_mark():
    made = view(contact=False)
    assert made.contact_point() is None
    assert data_of(player_page.page(made))["collision"]["observed"] is None


def test_nothing_executed_cannot_be_shown():
    made = view()
    bare = CaseRecord("c", "k", made.record.outcomes)
    with pytest.raises(ValueError, match="case c: it was not executed"):
        View.of(bare, made.report, {}, {})


def test_the_drawing_has_lanes_lines_and_stop_lines():
    drawing = drawing_of(NET)
    assert [s.width_m for s in drawing.strips] == [3.2] * 4
    assert len(drawing.areas) == 1
    styles = [line.style for line in drawing.lines]
    assert {style: styles.count(style) for style in styles} == {"edge": 2, "center": 2, "lane": 1, "stop": 1}
    stop = next(line for line in drawing.lines if line.style == "stop")
    assert stop.points[:, 0] == pytest.approx([-0.5, -0.5])
    assert sorted(stop.points[:, 1]) == pytest.approx([-3.0, -0.2])


def test_a_network_that_is_none_cannot_be_drawn():
    with pytest.raises(InvalidOutput, match="net_xml"):
        drawing_of("<nothing/>")


@pytest.mark.parametrize("shape", ["0,0 x,1 2,2", "0,0 1 2,2", "0,0 1,1 2,"])
def test_odd_places_of_a_network_are_refused(shape):
    net = NET.replace("</net>", f'<junction id="odd" type="priority" x="0" y="0" shape="{shape}"/></net>')
    with pytest.raises(InvalidOutput, match="net_xml: a place"):
        drawing_of(net)


@pytest.mark.parametrize("contact", [True, False])
def test_the_picture_shows_everyone_in_color(contact):
    made = view(contact=contact)
    image = Image.open(io.BytesIO(overview_png.png(made))).convert("RGB")
    assert image.size == (704, 704)
    colors = {color for _, color in image.getcolors(maxcolors=1 << 20)}
    for mover in made.movers:
        label = label_color(mover.color)
        assert tuple(int(label[i : i + 2], 16) for i in (1, 3, 5)) in colors
    assert ((0xD7, 0x26, 0x3D) in colors) is contact


def test_the_frame_holds_every_path():
    (x, _), half = overview_png.frame(view())
    assert half >= 25
    assert x - half < -40 < x + half
    assert x - half < 26 < x + half


def test_the_frame_of_long_paths_is_150_m_around_their_contact(monkeypatch):
    monkeypatch.setattr(overview_png, "MOST_M", 30.0)
    made = view(contact=True)
    middle, half = overview_png.frame(made)
    assert half == 30.0
    assert middle == made.contact_point()
    monkeypatch.setattr(overview_png, "MARGIN_M", 200.0)
    assert overview_png.frame(view(contact=False))[1] > 200


@pytest.mark.slow
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium to look with")
def test_the_page_runs_in_a_browser_and_stops_no_script(tmp_path):
    file = tmp_path / "player.html"
    file.write_text(player_page.page(view(narrative=EVIL, grounding={"$.legs[0].lanes_in": 1.5, "$.x": -0.5})))
    shown = subprocess.run(
        [
            CHROMIUM, "--headless", "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
            "--disable-background-networking", "--disable-component-update", "--disable-sync",
            f"--user-data-dir={tmp_path / 'profile'}", "--virtual-time-budget=3000", "--dump-dom", f"file://{file}#t=3.6",
        ],
        capture_output=True, text=True, timeout=120,
    ).stdout  # fmt: skip
    assert "V1 front → V2 back at 3.60 s · as declared ✓" in shown
    assert "3.60 / 5.95 s" in shown
    assert "<title>c1 · template</title>" in shown
    assert "road.$.legs[0].lanes_in  1.50" in shown
    assert re.search(r"<mark[^>]*>Vehicle #2</mark>", shown)
    assert "<b>&amp;" not in shown.split('id="narrative"')[1].split("</div>")[0]
