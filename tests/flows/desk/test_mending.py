"""Changes: what is asked is done and shown, what is wrong is refused with its reason, and nothing is lost meanwhile."""

import json
import os
import shutil
import signal
import socket
import threading
import time
from pathlib import Path

import pytest

from flows.case import revise_case
from flows.case_files.case_version import version_of
from flows.desk import mending
from flows.desk.command import server_of, socket_at
from flows.desk.mending import CaseChanged, ChangeResult, DeskBusy, Mender, Order
from flows.desk.views import edit_form
from sgcad_core.errors import SimulationFailed, WrongEdit

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
        ("vehicles.V2.start_lane", 99, "lane"),
        ("vehicles.V1.maneuver", "fly", "one of"),
        ("roads.N.lanes_forward", "!!int ''", "is no value"),
        ("roads.N.lanes_forward", "[" * 5000, "is no value"),
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


def _slow(order):
    time.sleep(1.5)
    if not order.wanted():
        raise WrongEdit("given up")
    return ChangeResult("generated", {}, 1.5, True)


def test_a_change_in_line_is_answered_in_time_and_the_worker_goes_on(config, monkeypatch):
    monkeypatch.setattr(mending, "WAIT_S", 0.5)
    mender, order = Mender(f"{__name__}:_slow"), Order("revise", config / CASE)
    first = threading.Thread(target=mender.change, args=(order, version_of(order.folder)))
    first.start()
    time.sleep(0.2)
    began = time.monotonic()
    with pytest.raises(DeskBusy, match="was not made: try again"):
        mender.change(order, version_of(order.folder))
    assert time.monotonic() - began < 1.2
    first.join()
    assert mender.said(order.folder) == {}
    mender.close()


def test_too_many_changes_in_line_are_turned_away_at_once(config, monkeypatch):
    monkeypatch.setattr(mending, "WAITING", 1)
    mender, order = Mender(f"{__name__}:_slow"), Order("revise", config / CASE)
    first = threading.Thread(target=mender.change, args=(order, version_of(order.folder)))
    first.start()
    time.sleep(0.2)
    with pytest.raises(DeskBusy, match="wait already"):
        mender.change(Order("revise", config / "rear-end-on-arterial"), "")
    first.join()
    mender.close()


def test_a_change_without_a_client_is_neither_kept_in_line_nor_made(config, tmp_path):
    mender = Mender(f"{__name__}:_slow")
    gone = Order("revise", config / CASE, permit=tmp_path / "permit")
    with pytest.raises(WrongEdit, match="given up"):  # a worker was idle: it asks before it writes
        mender.change(gone, version_of(gone.folder))
    there = Order("revise", config / CASE)
    first = threading.Thread(target=mender.change, args=(there, version_of(there.folder)))
    first.start()
    time.sleep(0.2)
    with pytest.raises(WrongEdit, match="given up while it waited"):
        mender.change(gone, version_of(gone.folder))
    first.join()
    mender.close()


def test_only_an_idle_worker_is_warmed(config):
    mender = Mender(f"{__name__}:_slow")
    for name in ("a", "b", "c", "d"):
        mender.warm(config.parent / name / "case")
    assert len(mender._warmed) == mending.WORKERS
    mender.close()


@pytest.mark.slow
def test_an_edit_whose_client_has_gone_changes_nothing(page, key, config):
    """A client that ends its connection at once, on a server of its own."""
    mine, before = page(key), version_of(config / CASE)
    app = mine.client.app
    listening = socket_at("127.0.0.1", 0)
    server = server_of(app)
    serving = threading.Thread(target=server.run, kwargs={"sockets": [listening]})
    serving.start()
    body = json.dumps({"version": mine.version, "edits": {"roads.N.lanes_forward": 2}}).encode()
    head = (
        f"POST /edit/{key} HTTP/1.1\r\nHost: localhost\r\nContent-Length: {len(body)}\r\nX-Desk-Token: {mine.token}"
        f"\r\nCookie: sgcad_desk={mine.client.cookies['sgcad_desk']}\r\n\r\n"
    )
    with socket.create_connection(listening.getsockname()) as client:
        client.sendall(head.encode() + body)
        time.sleep(0.5)
    deadline = time.monotonic() + 60
    mender = app.state.desk.mender
    while mender._in_line._value < mending.WAITING and time.monotonic() < deadline:
        time.sleep(0.1)
    server.should_exit = True
    serving.join()
    assert mender._in_line._value == mending.WAITING
    assert version_of(config / CASE) == before
    assert not revise_case.opened(config / CASE).edits()


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
