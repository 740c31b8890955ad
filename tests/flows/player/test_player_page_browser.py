"""The player in a real browser: close-up, units, plots, layers, measuring, picking, other runs, the account."""

import json
import re
import shutil

import pytest

from flows.case.run_case import run_case
from flows.case_files.find_cases import Case
from research.checks.mlflow_pages import BROWSERS
from sgcad_core.config import load
from sgcad_core.settings import ROOT
from tests.flows.desk.browser import walking

PROGRAM = next((found for name in BROWSERS if (found := shutil.which(name))), None)
pytestmark = [pytest.mark.slow, pytest.mark.skipif(PROGRAM is None, reason="no Chromium on this machine")]
DEMO = ROOT / "docs" / "demo" / "left-turn-at-signal"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A bundled report with a signal, turn lanes and assumed speeds, run once."""
    out = tmp_path_factory.mktemp("player")
    assert (
        run_case(load("template.yaml", ("tracker=none",)), Case(DEMO, "c1"), out, "d").result["status"] == "generated"
    )
    return out / "template" / "c1"


@pytest.fixture(scope="module")
def tab():
    """One browser for all."""
    with walking(PROGRAM) as walker:
        walker.size(1400, 900)
        yield walker


@pytest.fixture
def page(tab, folder):
    """The player, freshly opened; what the console told of is a fault."""
    tab.faults.clear()
    tab.open(f"file://{folder / 'player.html'}")
    yield tab
    assert tab.faults == []


def text(tab, selector):
    return tab.run(f"document.querySelector({json.dumps(selector)}).textContent")


def picture(tab):
    """What the stage shows, as a fingerprint."""
    return tab.run("document.querySelector('#view').toDataURL()")


def test_close_up_shows_the_two_that_meet_from_near(page):
    assert text(page, "#scale span") in ("20 m", "50 m", "10 m")
    page.key("z")
    page.until("document.querySelector('#scale span').textContent === '2 m'")
    assert text(page, "#clock").startswith("4.20 /")
    page.key("0")
    page.until("document.querySelector('#scale span').textContent !== '2 m'")


def test_speeds_before_and_at_contact_and_their_change_stand_in_one_unit_that_can_be_switched(page):
    head = page.run("[...document.querySelectorAll('#speeds tr:first-child > *')].map(c => c.textContent)")
    assert head == ["", "at the start", "1 s before", "at contact", "delta-v"]
    cells = "[...document.querySelectorAll('#speeds tr')].slice(1).map(r => [...r.children].map(c => c.textContent))"
    mph = page.run(cells)
    assert mph[1][0] == "V2"
    assert mph[1][1] == "35\u00a0mph (assumed)"
    page.key("u")
    kmh = page.run(cells)
    assert all(cell.split()[1] == "km/h" for row in kmh for cell in row[1:])
    assert abs(float(kmh[1][1].split()[0]) - 35 * 1.609) < 1
    assert "km/h" in text(page, "#legend")
    assert "km/h" in text(page, "#plots")


def test_plots_follow_the_clock_and_take_one_to_an_instant(page):
    captions = "[...document.querySelectorAll('#plots figcaption')].map(c => c.textContent)"
    assert [caption.split(":")[0] for caption in page.run(captions)] == ["speed", "clearance", "time to collision"]
    before = page.run(captions)[1]
    page.key("c")
    page.until(f"{captions}[1] !== {json.dumps(before)}")
    assert page.run(captions)[1].startswith("clearance: 0.0 m")
    page.click("#plots canvas")
    page.until("Math.abs(Number(document.querySelector('#time').value) - 92) < 3")


def test_the_legend_tells_speeds_as_they_touch_and_behind_it_none_as_assumed(page):
    table = "[...document.querySelectorAll('#speeds tr')].slice(1).map(r => r.children[3].textContent)"
    legend = "[...document.querySelectorAll('#legend i')].map(c => c.textContent.split(' · ')[1])"
    before = page.run(legend)
    assert any(speed.endswith("(assumed)") for speed in before)
    page.key("c")
    page.until(f"{legend}[0] !== {json.dumps(before[0])}")
    assert [speed.removesuffix(" (assumed)") for speed in page.run(legend)] == page.run(table)
    page.key("ArrowRight")
    page.until(f"!{legend}.some(speed => speed.includes('assumed'))")


@pytest.mark.parametrize("width", [1024, 700, 390])
def test_every_control_stands_whole_on_the_stage(tab, folder, width):
    tab.size(width, 844)
    tab.open(f"file://{folder / 'player.html'}?controls{width}")
    right = tab.run("document.querySelector('#stage').getBoundingClientRect().right")
    controls = "[...document.querySelectorAll('#controls > *')].map(c => c.getBoundingClientRect())"
    assert max(tab.run(f"{controls}.map(r => r.right)")) <= right
    assert tab.run("document.querySelector('#play').offsetWidth") >= 32
    tab.size(1400, 900)


@pytest.mark.parametrize("layer", ["paths", "labels", "rest", "signs", "names", "assumed"])
def test_every_layer_can_be_left_out(page, layer):
    before = picture(page)
    page.run(f"document.querySelector('#layer-{layer}').click()")
    without = picture(page)
    page.run(f"document.querySelector('#layer-{layer}').click()")
    assert without != before == picture(page)


def test_two_presses_measure_in_metres(page):
    page.key("m")
    x, y = page.place("#view")
    before = picture(page)
    for dx in (0, 200):
        page.mouse("mouseMoved", x + dx, y)
        page.mouse("mousePressed", x + dx, y, 1)
        page.mouse("mouseReleased", x + dx, y)
    assert text(page, "#measure") == "measure"
    assert page.run("document.querySelector('#measure').getAttribute('aria-pressed')") == "true"
    assert picture(page) != before


def test_a_picked_vehicle_keeps_its_facts_until_escape(page):
    page.key("z")
    middle = page.place("#view")
    page.mouse("mouseMoved", *middle)
    page.mouse("mousePressed", *middle, 1)
    page.mouse("mouseReleased", *middle)
    page.until("!document.querySelector('#because').hidden")
    page.mouse("mouseMoved", 5, 5)
    assert "start speed" in text(page, "#because")
    assert page.run("document.querySelectorAll('#because .default').length") > 0
    page.key("Escape")
    page.until("document.querySelector('#because').hidden")


def test_another_run_is_laid_over_this_one_or_beside_it_and_a_strange_file_is_refused(page, folder, tmp_path):
    other = tmp_path / "faster.csv"
    lines = (folder / "trajectories.csv").read_text().splitlines()
    shifted = [",".join([c[0], c[1], str(float(c[2]) + 6), *c[3:]]) for c in (line.split(",") for line in lines[1:])]
    other.write_text("\n".join([lines[0], *shifted]))
    before = picture(page)
    give(page, other)
    page.until("document.querySelector('#other').value === '0'")
    over = picture(page)
    page.click("#beside")
    page.until("document.querySelector('#beside').checked")
    assert len({before, over, picture(page)}) == 3
    (tmp_path / "strange.csv").write_text("a,b\n1,2\n")
    give(page, tmp_path / "strange.csv")
    page.until("document.querySelector('#runfault').textContent.includes('no trajectories.csv')")


def give(page, file):
    """Choose a file as a person does."""
    root = page.call("DOM.getDocument")["root"]["nodeId"]
    node = page.call("DOM.querySelector", nodeId=root, selector="#add")["nodeId"]
    page.call("DOM.setFileInputFiles", files=[str(file)], nodeId=node)


def test_every_figure_is_explained_in_a_line(page):
    rows = page.run(
        "[...document.querySelectorAll('#metrics tr')].slice(1).map(r => r.cells[0].innerText.split('\\n'))"
    )
    bare = [name[0] for name in rows if len(name) < 2 and "reason" not in name[0]]
    assert bare == []
    assert any("small even with a collision" in line for name in rows for line in name)


def test_no_figure_is_called_by_its_key(page):
    rows = page.run("[...document.querySelectorAll('#metrics tr')].slice(1).map(r => r.innerText)")
    assert rows
    assert [row for row in rows if re.search(r"\bdrac\b|_| s before s|mps", row)] == []


def test_what_was_not_read_is_marked_with_a_word_beside_the_color(tab, folder, tmp_path):
    def marking(data):
        data["sentences"][0]["mark"] = "unread"

    tab.open(f"file://{changed(folder, tmp_path, marking)}")
    assert text(tab, "#narrative .told.unread .marked") == "not read"
    assert tab.run("!document.querySelector('#marks').hidden")


@pytest.mark.parametrize("width", [1400, 800, 390])
@pytest.mark.parametrize("mode", ["light", "dark"])
def test_the_page_fits_and_can_be_read_in_every_width_and_mode(tab, folder, width, mode):
    tab.size(width, 844)
    tab.theme(mode)
    tab.open(f"file://{folder / 'player.html'}?{width}{mode}")
    assert tab.run("document.documentElement.scrollWidth") <= width
    assert tab.poor() == []
    assert tab.run("getComputedStyle(document.documentElement).colorScheme") == mode
    tab.theme("light")
    tab.size(1400, 900)


def changed(folder, tmp_path, change):
    """The page with other data."""
    html = (folder / "player.html").read_text(encoding="utf-8")
    data = json.loads(re.search(r'id="data">(.*?)</script>', html, re.DOTALL)[1])
    change(data)
    old = html[html.index('id="data">') + 10 :].split("</script>")[0]
    made = tmp_path / "player.html"
    made.write_text(html.replace(old, json.dumps(data).replace("<", "\\u003c")), encoding="utf-8")
    return made


def test_what_lacks_is_amber_open_and_leads_to_its_sentence(tab, folder, tmp_path):
    def lacking(data):
        start = data["sentences"][0]["of"]
        items = [{"kind": "lacks", "text": "a <i>stop</i> sign", "reason": "no place for it", "start": start}]
        sentence = "lacks 1 of 5 things told: 4 are there"
        data["account"] = {
            "verdict": "lacking",
            "sentence": sentence,
            "told": 5,
            "has": 4,
            "lacking": 1,
            "assumed": 0,
            "items": items,
        }

    tab.open(f"file://{changed(folder, tmp_path, lacking)}")
    assert tab.run("document.querySelector('#account').open")
    assert tab.run("document.querySelector('#account').className") == "amber"
    assert text(tab, "#account summary") == "⚠ Lacks 1 of 5 things told: 4 are there"
    assert tab.run("document.querySelector('#verdict').className") != "good"  # nothing is green over what lacks
    assert text(tab, "#lacks") == "a <i>stop</i> sign: no place for it"
    tab.click("#lacks button")
    tab.until("document.querySelector('#narrative .told.lit')")


def test_what_is_whole_is_green_and_closed_and_names_what_was_assumed(page):
    assert page.run("document.querySelector('#account').className") == "whole"
    assert not page.run("document.querySelector('#account').open")
    assert "assumed" in text(page, "#account summary")
    assert text(page, "#assumed").startswith("Assumed: ")


@pytest.mark.parametrize(("told", "marked"), [
    ("Vehicle one met Unit 2.", ["Vehicle one", "Unit 2"]),
    ("Vehicle #1 and V2 and Veh. 2", ["Vehicle #1", "V2", "Veh. 2"]),
    ("Unit two, vehicle number 1, one vehicle, V8", ["Unit two", "vehicle number 1"]),
])  # fmt: skip
def test_vehicles_are_marked_as_reports_name_them(tab, folder, tmp_path, told, marked):
    tab.open(
        f"file://{changed(folder, tmp_path, lambda data: data.update(narrative=told, sentences=[], redactions=[]))}"
    )
    assert tab.run("[...document.querySelectorAll('#narrative mark')].map(m => m.textContent)") == marked


def test_the_small_screen_holds_everything_and_nothing_overflows(page):
    page.size(390, 800, mobile=True)
    try:
        page.until("document.documentElement.scrollWidth <= 392")
    finally:
        page.size(1400, 900)
