"""Changes: what is asked is done and shown, what is wrong is refused with its reason, and nothing is lost meanwhile."""

import json
import os
import shutil
import signal
import threading
from pathlib import Path

import pytest

from flows.case import revise_case
from flows.desk.index import version_of
from flows.desk.mending import CaseChanged, Mender, Order
from flows.desk.views import edit_form
from sgcad_core.errors import SimulationFailed

CASE = "left-turn-at-signal"


@pytest.fixture
def key(config):
    return f"{config.name}/{CASE}"


def result(config):
    return json.loads((config / CASE / "result.json").read_text())


def lanes(config, road):
    return next(s["lanes_forward"] for s in result(config)["network"]["segments"] if s["id"] == road)


@pytest.mark.slow
def test_an_edit_is_planned_simulated_shown_signed_and_taken_back(page, key, config):
    before = page(key)
    answer = before.change(**{"roads.N.lanes_forward": 2})
    assert (answer.status_code, answer.json()["status"]) == (200, "generated")
    assert lanes(config, "N") == 2
    after = page(key)
    assert after.version != before.version
    assert "Changed by people" in after.text
    assert "roads.N.lanes_forward = 2" in after.text
    assert "ann" in after.text
    assert "1 mended" in page(key).client.get("/").text
    assert page(key).change("undo").status_code == 200
    assert lanes(config, "N") == 3
    assert "Changed by people" not in page(key).text
    assert page(key).change("undo").json()["text"].endswith("none of its facts was changed")


@pytest.mark.slow
def test_a_wrong_edit_is_refused_with_its_reason_and_changes_nothing(page, key, config):
    version = version_of(config / CASE)
    for field, value, reason in (
        ("roads.N.lanes_forward", 99, "integer from"),
        ("roads.XX.lanes_forward", 2, "there is no"),
        ("vehicles.V2.start_lane", 7, "lane"),
        ("vehicles.V1.maneuver", "fly", "one of"),
        ("no.such.field", 1, "there is no such field"),
    ):
        answer = page(key).change(**{field: value})
        assert (answer.status_code, reason in answer.json()["text"]) == (422, True), answer.text
    assert version_of(config / CASE) == version


def test_a_change_of_what_somebody_else_changed_is_refused(page, key, config):
    mine = page(key)
    text = (config / CASE / "result.json").read_text()
    (config / CASE / "result.json").write_text(text + " ")  # a batch ran the case again
    answer = mine.change(**{"roads.N.lanes_forward": 2})
    assert (answer.status_code, "changed on disk since you opened it" in answer.json()["text"]) == (409, True)


@pytest.mark.slow
def test_of_two_people_at_once_one_is_told_to_look_again(page, key, config):
    mine, yours = page(key), page(key)
    codes = []

    def change(seen, limit):
        codes.append(seen.change(**{"roads.W.speed_limit_mph": limit}).status_code)

    calls = [threading.Thread(target=change, args=given) for given in ((mine, 25), (yours, 45))]
    for call in calls:
        call.start()
    for call in calls:
        call.join()
    assert sorted(codes) == [200, 409]
    assert len(revise_case.opened(config / CASE).edits()) == 1


def test_a_report_that_is_gone_is_told_of(page, key, runs):
    mine = page(key)
    shutil.rmtree(runs.parent / "reports" / CASE)
    answer = mine.change(**{"roads.N.lanes_forward": 2})
    assert (answer.status_code, "is gone" in answer.json()["text"]) == (422, True)
    assert "cannot be changed here" in page(key).text


@pytest.mark.slow
def test_running_again_keeps_what_people_said(page, key, config):
    page(key).change(**{"roads.N.lanes_forward": 2})
    answer = page(key).change("rerun")
    assert answer.status_code == 200, answer.text
    assert lanes(config, "N") == 2


@pytest.mark.parametrize(
    "body", [b"", b"[]", b'{"version": 1}', b'{"version": "x", "more": 1}', b'{"version": "x", "edits": {"a": {}}}']
)
def test_what_is_no_change_is_told(client, page, key, body):
    answer = client.post(f"/edit/{key}", content=body, headers={"x-desk-token": page(key).token})
    assert (answer.status_code, "Reload it" in answer.json()["text"]) == (400, True)


# ------------------------------------------------------------------ the process
def _kill(order):
    os.kill(os.getpid(), signal.SIGSEGV)


def test_the_death_of_the_process_changes_nothing_and_kills_nothing(config):
    mender = Mender(f"{__name__}:_kill")
    order = Order("revise", config / CASE, {"roads.N.lanes_forward": 2})
    for _ in range(2):  # the next change gets a new process
        with pytest.raises(SimulationFailed, match="died of SIGSEGV"):
            mender.change(order, version_of(order.folder))
    mender.close()


def test_a_change_that_was_overtaken_starts_no_process(tmp_path):
    mender = Mender("no.such:module")
    with pytest.raises(CaseChanged, match="make it again"):
        mender.change(Order("revise", tmp_path), "another")


def test_the_forms_are_those_of_the_revision(config):
    fields = revise_case.editable(config / CASE)
    groups = edit_form.groups_with((), fields, (), {"roads.N.median": ["odd"]})
    rows = {row.field: row for group in groups for row in group.facts}
    assert set(rows) == {f.name for f in fields if not f.name.endswith(".present")}
    asked = json.loads(rows["roads.N.lanes_forward"].edit)
    assert (asked["form"], asked["value"], asked["least"]) == ("integer", 3, 0)
    assert sorted(json.loads(rows["vehicles.V1.exit_road"].edit)["choices"]) == ["E", "N", "S", "W"]
    assert rows["roads.N.median"].findings == ("odd",)
    removable = {group.thing: group.remove for group in groups if group.remove}
    assert removable["V1"] == "vehicles.V1.present"


def test_what_can_be_added_is_what_is_not_there(config):
    words = [a.words for a in edit_form.additions(revise_case.editable(config / CASE))]
    assert {"vehicle V3", "pedestrian P1", "contact 2", "road NE"} <= set(words)
    assert "road N" not in words


def test_what_is_said_of_a_whole_thing_is_said_once(config):
    fields = revise_case.editable(config / CASE)
    said = {f.name: ["V1 steers aside"] for f in fields if f.name.startswith("vehicles.V1.")}
    groups = {g.thing: g for g in edit_form.groups_with((), fields, (), said)}
    assert groups["V1"].findings == ("V1 steers aside",)
    assert not any(row.findings for row in groups["V1"].facts)


def test_folders_here_are_the_ones_meant(config):
    assert Path(revise_case.opened(config / CASE).source).is_relative_to(config.parent.parent)
