"""Who avoids what, on the page of a study of drivers: real cases, really driven, a table of letters and frames."""

import io
import re

import pytest
from PIL import Image
from typer.testing import CliRunner

from flows.case.run_case import run_case
from flows.case_files.find_cases import Case
from flows.cli import app
from flows.results.reading import load_study
from flows.results.report.drive_cards import by_difference, card, columns_of, drives_of
from flows.results.report.drive_frames import drive_frames
from flows.results.table import tables_of
from sgcad_core.config import load
from sgcad_core.settings import ROOT

DEMO = ROOT / "docs" / "demo"
CASES = ("left-turn-at-signal", "rear-end-on-arterial")


@pytest.fixture(scope="module")
def driven(tmp_path_factory):
    """A folder of runs: two demo reports, each handed over to two drivers in both roles."""
    out = tmp_path_factory.mktemp("driven")
    for driver in ("script", "aeb"):
        for case in CASES:
            config = load("template.yaml", ("tracker=none", f"drive.drivers={driver}"))
            folder = out / "runs" / driver
            assert run_case(config, Case(DEMO / case, case), folder, "d").result["status"] == "generated"
            (folder / "template" / case).rename(out / "runs" / f"{driver}-{case}")
        (out / "study" / driver).mkdir(parents=True)
        for case in CASES:
            (out / "runs" / f"{driver}-{case}").rename(out / "study" / driver / case)
    return out / "study"


def test_every_drive_of_a_study_is_found_with_who_was_driven(driven):
    drives = drives_of(load_study(driven))
    assert len(drives) == 2 * 2 * 2
    assert {d.driver for d in drives} == {"script", "aeb"}
    assert all((d.folder / "drive.json").is_file() for d in drives)
    assert {d.outcome for d in drives if d.driver == "script"} == {"unchanged"}
    assert [c[2] for c in columns_of(drives)] == ["initiator", "initiator", "responder", "responder"]


def test_cases_on_which_drivers_differ_come_first(driven):
    drives = drives_of(load_study(driven))
    order = by_difference(drives)
    spread = [
        sum(len({d.outcome for d in drives if d.case == c and d.role == r}) for r in ("initiator", "responder"))
        for c in order
    ]
    assert spread == sorted(spread, reverse=True)


def test_the_page_says_who_avoids_what_and_leads_to_every_drive(driven):
    ended = CliRunner().invoke(app, ["report", str(driven), "--figures", str(driven.parent / "figures")])
    assert ended.exit_code == 0, ended.output
    text = (driven / "report.html").read_text()
    links = re.findall(r'<td class="o \w+" title="[^"]+"><a href="([^"]+)">[AMUWLF]</a>', text)
    assert len(links) == 8
    assert all((driven / link).is_file() for link in links)
    assert text.count('<section class="card" id="drives">') == 1
    assert "Script and drive side by side: the responder" in text
    assert {"drives_initiator", "drives_responder"} <= {f.stem for f in (driven.parent / "figures").iterdir()}


def test_frames_of_script_and_drive_stand_side_by_side_a_row_a_driver(driven):
    made = drive_frames(tables_of(load_study(driven)))
    assert [p.key for p in made] == ["drives_initiator", "drives_responder"]
    for plot in made:
        assert plot.png is not None
        wide, high = Image.open(io.BytesIO(plot.png)).size
        assert wide > high > 400


def test_a_study_that_hands_nothing_over_has_neither_card_nor_frames(study):
    folder = study({"a": {"c1": {"status": "refused"}}})
    assert card(load_study(folder), folder / "report.html") == ""
    assert drive_frames(tables_of(load_study(folder))) == []


def test_results_of_older_versions_have_letters_without_links(study):
    folder = study({"a": {"c1": {}}})
    text = card(load_study(folder), folder / "report.html")
    assert '<td class="o avoided" title="reference drives the initiator: avoided">A</td>' in text
    assert "href" not in text
