"""A drive's page in a real browser: the script over the drive or beside it, speeds and times to collision of both."""

import json
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
CAPTIONS = "[...document.querySelectorAll('#plots figcaption')].map(c => c.textContent)"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A bundled report, handed over once."""
    out, report = tmp_path_factory.mktemp("drive"), ROOT / "docs" / "demo" / "left-turn-at-signal"
    config = load("template.yaml", ("tracker=none", "drive.drivers=aeb"))
    assert run_case(config, Case(report, "c1"), out, "d").result["status"] == "generated"
    return out / "template" / "c1"


@pytest.fixture(scope="module")
def tab():
    with walking(PROGRAM) as walker:
        walker.size(1400, 900)
        yield walker


def picture(tab):
    return tab.run("document.querySelector('#view').toDataURL()")


def test_the_script_lies_over_the_drive_with_speeds_and_ttc_of_both(tab, folder):
    page = next(folder.glob("drive/aeb/*/drive.html"))
    tab.faults.clear()
    tab.open(f"file://{page}")
    assert tab.run("document.querySelector('#other').selectedOptions[0].textContent") == "script"
    speed, clearance, ttc = tab.run(CAPTIONS)
    assert speed.count("/") == 2  # two road users, in the drive and in the script
    assert all(", script " in caption for caption in (speed, clearance, ttc))
    over = picture(tab)
    tab.click("#beside")
    tab.until("document.querySelector('#beside').checked")
    assert picture(tab) != over
    tab.run("document.querySelector('#other').value = ''; document.querySelector('#other').onchange({target: "
            "document.querySelector('#other')})")  # fmt: skip
    assert all("script" not in caption for caption in tab.run(CAPTIONS))
    assert tab.faults == []


def test_in_the_drive_braking_shows_as_another_speed_than_the_scripts(tab, folder):
    told = [json.loads(f.read_text()) for f in folder.glob("drive/aeb/*/drive.json")]
    braked = next(t for t in told if t["braked_s"])
    tab.open(f"file://{folder / 'drive' / 'aeb' / braked['ego'] / 'drive.html'}")
    tab.key("c")
    drive, script = tab.run(CAPTIONS)[0].removesuffix(" mph").removeprefix("speed: ").split(", script ")
    assert drive != script


def test_the_case_player_draws_a_chosen_drive_with_its_own_lines(tab, folder):
    tab.faults.clear()
    tab.open(f"file://{folder / 'player.html'}")
    assert all("drives" not in caption for caption in tab.run(CAPTIONS))
    tab.run("document.querySelector('#other').value = '0'; document.querySelector('#other').onchange({target: "
            "document.querySelector('#other')})")  # fmt: skip
    assert all(", aeb drives V" in caption for caption in tab.run(CAPTIONS))
    assert tab.faults == []


def test_the_page_of_a_drive_says_its_outcome_and_goes_on_behind_the_contact(tab, folder):
    told = next(t for f in folder.glob("drive/aeb/*/drive.json") if (t := json.loads(f.read_text()))["contact"])
    tab.open(f"file://{folder / 'drive' / 'aeb' / told['ego'] / 'drive.html'}")
    assert tab.run("document.querySelector('#verdict').textContent").startswith(told["outcome"])
    assert tab.run("document.querySelector('#verdict').className") != "good"
    assert tab.run("Number(document.querySelector('#time').max)") >= round(told["contact"]["t_s"] / 0.05) + 55
    assert (
        tab.run("[...document.querySelectorAll('.card')].filter(c => !c.hidden && !c.querySelector('td, button'))")
        == []
    )
    assert "did not yield" in tab.run("document.querySelector('#rules').textContent") or told["ego"] == "V2"


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_a_drive_can_be_read_in_the_light_and_in_the_dark(tab, folder, theme):
    tab.theme(theme)
    tab.open(f"file://{next(folder.glob('drive/aeb/*/drive.html'))}?{theme}")
    assert tab.poor() == []
    tab.theme("light")


def test_the_stage_goes_dark_with_the_page_also_while_it_is_open(tab, folder):
    corner = "[...document.querySelector('#view').getContext('2d').getImageData(2, 2, 1, 1).data.slice(0, 3)]"
    tab.theme("light")
    tab.open(f"file://{next(folder.glob('drive/aeb/*/drive.html'))}?stage")
    assert min(tab.run(corner)) > 200
    tab.theme("dark")
    tab.until(f"Math.max(...{corner}) < 80")
    tab.theme("light")


def test_a_drive_says_before_what_it_braked(folder):
    for file in folder.glob("drive/*/*/drive.json"):
        told, page = json.loads(file.read_text()), (file.parent / "drive.html").read_text()
        if told["braked_s"]:
            end = "the contact" if told["contact"] else "the closest approach"
            assert f"It began to brake {told['braked_s']:.2f} s before {end}" in page
